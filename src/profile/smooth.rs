//! Profiles with a formula.

use std::f64::consts::PI;

use super::{Elevation, Profile};
use crate::error::Result;

/// h = amplitude (1 - cos(2 pi x / wavelength)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    /// g_0, m; the profile is 2 g_0 from crest to trough.
    pub amplitude: f64,
    /// m
    pub wavelength: f64,
}

/// h = (x - centre)^2 / (2 radius).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parabola {
    /// Radius of curvature at the apex, m.
    pub radius: f64,
    /// m
    pub centre: f64,
}

/// The lower arc of a circle: h = R - sqrt(R^2 - (x - centre)^2), and R, its equator, further out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// R, m
    pub radius: f64,
    /// m
    pub centre: f64,
}

/// h = slope |x - centre|.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wedge {
    /// -
    pub slope: f64,
    /// m
    pub centre: f64,
}

impl Profile for Harmonic {
    fn at(&self, x: f64) -> Result<Elevation> {
        // 1 - cos = 2 sin^2 of the half angle keeps the small heights near the crest.
        let half = PI * (x / self.wavelength - (x / self.wavelength).round());
        Ok(Elevation {
            height: 2.0 * self.amplitude * half.sin().powi(2),
            slope: self.amplitude * 2.0 * PI / self.wavelength * (2.0 * half).sin(),
        })
    }
}

impl Profile for Parabola {
    fn at(&self, x: f64) -> Result<Elevation> {
        let offset = x - self.centre;
        Ok(Elevation { height: offset * offset / (2.0 * self.radius), slope: offset / self.radius })
    }
}

impl Profile for Circle {
    fn at(&self, x: f64) -> Result<Elevation> {
        let offset = x - self.centre;
        if offset.abs() >= self.radius {
            return Ok(Elevation { height: self.radius, slope: 0.0 });
        }
        let root = ((self.radius - offset) * (self.radius + offset)).sqrt();
        // R - root without cancellation near the apex.
        Ok(Elevation { height: offset * offset / (self.radius + root), slope: offset / root })
    }
}

impl Profile for Wedge {
    fn at(&self, x: f64) -> Result<Elevation> {
        let offset = x - self.centre;
        let sign = if offset == 0.0 { 0.0 } else { offset.signum() };
        Ok(Elevation { height: self.slope * offset.abs(), slope: self.slope * sign })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Slopes against central differences, away from kinks.
    #[test]
    fn slopes_are_derivatives() {
        let profiles: [Box<dyn Profile>; 4] = [
            Box::new(Harmonic { amplitude: 5e-4, wavelength: 0.7 }),
            Box::new(Parabola { radius: 2.0, centre: 0.1 }),
            Box::new(Circle { radius: 2.0, centre: 0.1 }),
            Box::new(Wedge { slope: 0.3, centre: 0.1 }),
        ];
        for profile in profiles {
            for x in [-1.3, -0.2, 0.05, 0.37, 1.9] {
                let step = 1e-6;
                let numeric = (profile.at(x + step).unwrap().height - profile.at(x - step).unwrap().height) / 2e-6;
                assert!((numeric - profile.at(x).unwrap().slope).abs() < 1e-8);
            }
        }
    }

    /// The arc near its apex is the parabola of the same radius: no digit is lost to cancellation.
    #[test]
    fn the_arc_keeps_its_digits_near_the_apex() {
        let (circle, parabola) = (Circle { radius: 1.0, centre: 0.0 }, Parabola { radius: 1.0, centre: 0.0 });
        let (a, b) = (circle.at(1e-9).unwrap().height, parabola.at(1e-9).unwrap().height);
        assert!((a - b).abs() < 1e-15 * b);
    }
}
