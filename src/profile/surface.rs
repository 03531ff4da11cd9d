//! Rigid profiles over a face: what the points of the contact see of the indenter.

use std::rc::Rc;

use nalgebra::Vector2;

use super::{Elevation, Profile};
use crate::error::{Error, Result};
use crate::expression::{Dual, Expression};

/// The indenter's lower surface.
pub trait Surface {
    /// h(x, y), m, and its gradient, in the indenter's own frame; the plane is that of y = 0.
    ///
    /// # Errors
    /// [`Error::Domain`](crate::error::Error::Domain) where the profile is not known.
    fn at(&self, place: Vector2<f64>) -> Result<Height>;
}

/// A point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Height {
    /// h, m
    pub height: f64,
    /// dh/dx, dh/dy
    pub gradient: Vector2<f64>,
}

/// A profile that is the same for every y.
pub struct Extruded<P>(pub P);

impl<P: Profile> Surface for Extruded<P> {
    fn at(&self, place: Vector2<f64>) -> Result<Height> {
        let elevation = self.0.at(place.x)?;
        Ok(Height { height: elevation.height, gradient: Vector2::new(elevation.slope, 0.0) })
    }
}

impl Surface for Box<dyn Surface> {
    fn at(&self, place: Vector2<f64>) -> Result<Height> {
        (**self).at(place)
    }
}

impl Surface for Rc<dyn Surface> {
    fn at(&self, place: Vector2<f64>) -> Result<Height> {
        (**self).at(place)
    }
}

/// A surface along one line.
pub struct Section<S> {
    /// What is cut.
    pub surface: S,
    /// Where, m.
    pub y: f64,
}

impl<S: Surface> Profile for Section<S> {
    fn at(&self, x: f64) -> Result<Elevation> {
        let Height { height, gradient } = self.surface.at(Vector2::new(x, self.y))?;
        Ok(Elevation { height, slope: gradient.x })
    }
}

/// A surface repeated with a period along each axis that has one: the place is brought to the periods around `centre`.
pub struct RepeatedSurface<S> {
    /// What is repeated.
    pub surface: S,
    /// m
    pub centre: Vector2<f64>,
    /// m; none = it does not repeat.
    pub periods: [Option<f64>; 2],
}

impl<S: Surface> Surface for RepeatedSurface<S> {
    fn at(&self, place: Vector2<f64>) -> Result<Height> {
        let mut nearest = place;
        for (axis, period) in self.periods.iter().enumerate() {
            if let Some(period) = period {
                nearest[axis] -= period * ((place[axis] - self.centre[axis]) / period).round();
            }
        }
        self.surface.at(nearest)
    }
}

/// h(x, y) = the value of an expression, and its gradient by differentiation while it is evaluated.
#[derive(Debug, Clone)]
pub struct SurfaceFormula {
    /// Of two variables, x and y in m; its value in m.
    pub expression: Expression,
}

impl Surface for SurfaceFormula {
    /// Where the value or the gradient is not finite, the profile is not known.
    fn at(&self, place: Vector2<f64>) -> Result<Height> {
        let [x, y] = [place.x, place.y];
        let along_x = self.expression.at(&[Dual::variable(x), Dual::constant(y)]);
        let along_y = self.expression.at(&[Dual::constant(x), Dual::variable(y)]);
        let (height, gradient) = (along_x.value, Vector2::new(along_x.slope, along_y.slope));
        match height.is_finite() && gradient.iter().all(|slope| slope.is_finite()) {
            true => Ok(Height { height, gradient }),
            false => Err(Error::Domain(format!(
                "is {height}, with slopes {} and {}, at x = {x:?}, y = {y:?} m, where all must be finite",
                gradient.x, gradient.y
            ))),
        }
    }
}
