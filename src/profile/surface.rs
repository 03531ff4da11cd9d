//! Rigid profiles over a face: what the points of the contact see of the indenter.

use nalgebra::Vector2;

use super::Profile;
use crate::error::Result;

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
