//! Rigid profiles: the elevation h(x) of the indenter's lower surface above its datum, and its slope.

mod expression;
pub mod map;
pub mod profilometer;
mod relief;
mod rough;
mod rough_surface;
mod sampled;
mod smooth;
mod solids;
mod surface;
mod survey;

use std::rc::Rc;

use crate::error::Result;

pub use expression::Formula;
pub use map::HeightMap;
pub use relief::Relief;
pub use rough::{Rms, Rough, Roughness};
pub use rough_surface::RoughSurface;
pub use sampled::{BLEND, Point, Sampled, WALL};
pub use smooth::{Circle, Harmonic, Parabola, Wedge};
pub use solids::{Cone, Paraboloid, Sphere, Waves};
pub use surface::{Extruded, Height, RepeatedSurface, Section, Surface, SurfaceFormula};
pub use survey::Survey;

/// A rigid profile.
pub trait Profile {
    /// h(x), m, and dh/dx at x, m, in the indenter's own frame. Contact begins where the approach reaches h: the
    /// lowest point is 0 for every profile but expressions and sampled ones, which say their own datum.
    ///
    /// # Errors
    /// [`Error::Domain`](crate::error::Error::Domain) where the profile is not known.
    fn at(&self, x: f64) -> Result<Elevation>;
}

impl Profile for Box<dyn Profile> {
    fn at(&self, x: f64) -> Result<Elevation> {
        (**self).at(x)
    }
}

impl Profile for Rc<dyn Profile> {
    fn at(&self, x: f64) -> Result<Elevation> {
        (**self).at(x)
    }
}

/// A point of a profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elevation {
    /// h, m
    pub height: f64,
    /// dh/dx
    pub slope: f64,
}

/// A profile repeated with a period: x is brought to the period around `centre`.
pub struct Repeated<P> {
    /// What is repeated.
    pub profile: P,
    /// m
    pub centre: f64,
    /// m
    pub period: f64,
}

impl<P: Profile> Profile for Repeated<P> {
    fn at(&self, x: f64) -> Result<Elevation> {
        let offset = x - self.centre;
        self.profile.at(self.centre + offset - self.period * (offset / self.period).round())
    }
}
