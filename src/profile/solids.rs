//! Profiles in space with a formula.

use std::f64::consts::PI;

use nalgebra::Vector2;

use super::{Height, Surface};
use crate::error::Result;

/// h = (x - xc)^2/(2 Rx) + (y - yc)^2/(2 Ry).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paraboloid {
    /// Radii of curvature at the apex, m.
    pub radii: Vector2<f64>,
    /// m
    pub centre: Vector2<f64>,
}

/// The lower half of a sphere: h = R - sqrt(R^2 - r^2), and R, its equator, further out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// R, m
    pub radius: f64,
    /// m
    pub centre: Vector2<f64>,
}

/// h = slope r.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// -
    pub slope: f64,
    /// m
    pub centre: Vector2<f64>,
}

/// h = ax (1 - cos(2 pi x/lx)) + ay (1 - cos(2 pi y/ly)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waves {
    /// ax, ay, m
    pub amplitudes: Vector2<f64>,
    /// lx, ly, m
    pub wavelengths: Vector2<f64>,
}

impl Surface for Paraboloid {
    fn at(&self, place: Vector2<f64>) -> Result<Height> {
        let offset = place - self.centre;
        let gradient = offset.component_div(&self.radii);
        Ok(Height { height: 0.5 * offset.dot(&gradient), gradient })
    }
}

impl Surface for Sphere {
    fn at(&self, place: Vector2<f64>) -> Result<Height> {
        let offset = place - self.centre;
        let distance = offset.norm();
        if distance >= self.radius {
            return Ok(Height { height: self.radius, gradient: Vector2::zeros() });
        }
        let root = ((self.radius - distance) * (self.radius + distance)).sqrt();
        // R - root without cancellation near the apex.
        Ok(Height { height: distance * distance / (self.radius + root), gradient: offset / root })
    }
}

impl Surface for Cone {
    fn at(&self, place: Vector2<f64>) -> Result<Height> {
        let offset = place - self.centre;
        let distance = offset.norm();
        let outward = if distance > 0.0 { offset / distance } else { Vector2::zeros() };
        Ok(Height { height: self.slope * distance, gradient: outward * self.slope })
    }
}

impl Surface for Waves {
    fn at(&self, place: Vector2<f64>) -> Result<Height> {
        let mut of = Height { height: 0.0, gradient: Vector2::zeros() };
        for axis in 0..2 {
            let (amplitude, wavelength) = (self.amplitudes[axis], self.wavelengths[axis]);
            // 1 - cos = 2 sin^2 of the half angle keeps the small heights near the crest.
            let half = PI * (place[axis] / wavelength - (place[axis] / wavelength).round());
            of.height += 2.0 * amplitude * half.sin().powi(2);
            of.gradient[axis] = amplitude * 2.0 * PI / wavelength * (2.0 * half).sin();
        }
        Ok(of)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Gradients against central differences, away from the apex of the cone.
    #[test]
    fn gradients_are_derivatives() {
        let centre = Vector2::new(0.1, -0.2);
        let surfaces: [Box<dyn Surface>; 4] = [
            Box::new(Paraboloid { radii: Vector2::new(2.0, 0.5), centre }),
            Box::new(Sphere { radius: 3.0, centre }),
            Box::new(Cone { slope: 0.3, centre }),
            Box::new(Waves { amplitudes: Vector2::new(5e-4, 2e-4), wavelengths: Vector2::new(0.7, 0.3) }),
        ];
        for surface in surfaces {
            for place in [[-1.3, 0.4], [0.05, 0.37], [1.9, -0.6]].map(Vector2::from) {
                for axis in 0..2 {
                    let step = Vector2::ith(axis, 1e-6);
                    let [plus, minus] = [step, -step].map(|step| surface.at(place + step).unwrap().height);
                    assert!(((plus - minus) / 2e-6 - surface.at(place).unwrap().gradient[axis]).abs() < 1e-8);
                }
            }
        }
    }

    /// Near its apex the sphere is the paraboloid of the same radius, to the last digits.
    #[test]
    fn the_sphere_keeps_its_digits_near_the_apex() {
        let centre = Vector2::zeros();
        let sphere = Sphere { radius: 1.0, centre }.at(Vector2::new(1e-9, 2e-9)).unwrap().height;
        assert!((sphere - 2.5e-18).abs() < 1e-32);
    }
}
