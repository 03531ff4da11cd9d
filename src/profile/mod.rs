//! Rigid profiles: the elevation h(x) of the indenter above its lowest point, and its slope.

mod smooth;

use crate::error::Result;

pub use smooth::{Circle, Harmonic, Parabola, Wedge};

/// A rigid profile.
pub trait Profile {
    /// h(x), m >= 0 at its lowest point, and dh/dx, at x, m, in the indenter's own frame.
    ///
    /// # Errors
    /// [`Error::Domain`](crate::error::Error::Domain) where the profile is not known.
    fn at(&self, x: f64) -> Result<Elevation>;
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
