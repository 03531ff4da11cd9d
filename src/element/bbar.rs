//! The four-node quadrilateral with mean dilatation (B-bar), for Poisson ratios up to 1/2.
//!
//! Hughes, Int. J. Numer. Methods Eng. 15 (1980) 1413. The dilatation tr(e) at every point is replaced by its mean
//! over the element,
//!
//! ```text
//! B-bar = B_dev + (1/3) 1 d',     d'u = (1/A) integral of div u
//! K_dev = integral of B' D_dev B  (as for the Q4: D_dev sees B_dev only),     K_vol = A d d'
//! ```
//!
//! so an element is asked for one condition of incompressibility instead of four: it does not lock. The mean stress is
//! constant in each element. It can alternate from element to element, a mode that does almost no work; the mean over
//! the cells around a node, which is what is written, removes it.

use nalgebra::{SVector, Vector2, Vector4};

use super::plane::{self, Answer, Split};
use super::quad4::{extrapolate, gauss_points, stiffness as quad4_stiffness, strain, strain_operator};

/// K_dev and K_vol; corners in m, unknowns as for the Q4.
pub fn stiffness(corners: &[Vector2<f64>; 4]) -> Split<8> {
    let (d, area) = mean_dilatation(corners);
    Split { volumetric: d * d.transpose() * area, ..quad4_stiffness(corners) }
}

/// d, 1/m, of d'u = mean of div u, and the area, m^2.
fn mean_dilatation(corners: &[Vector2<f64>; 4]) -> (SVector<f64, 8>, f64) {
    let (mut integral, mut area) = (SVector::zeros(), 0.0);
    for point in gauss_points() {
        let (b, det) = strain_operator(corners, point);
        integral += (b.row(0) + b.row(1)).transpose() * det;
        area += det;
    }
    (integral / area, area)
}

/// Stress (xx, zz, yy, xz), Pa, at the four corners: the deviator from the Gauss points, extrapolated; the mean stress
/// K d'u of the element.
pub fn corner_stress(corners: &[Vector2<f64>; 4], shear: Answer<'_, 8>, bulk: Answer<'_, 8>) -> [Vector4<f64>; 4] {
    let mean = bulk.modulus * mean_dilatation(corners).0.dot(bulk.displacement);
    extrapolate(gauss_points().map(|point| {
        let (b, _) = strain_operator(corners, point);
        plane::stress(shear.modulus, &strain(&b, shear.displacement), mean)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::plane::trials;

    #[test]
    fn exactly_three_rigid_body_modes() {
        trials::exactly_three_rigid_body_modes(&trials::distorted(), &stiffness(&trials::distorted()));
    }

    #[test]
    fn a_linear_field_is_exact() {
        let u = trials::linear(&trials::distorted(), &stiffness(&trials::distorted()));
        let answer = |modulus| Answer { modulus, displacement: &u };
        for stress in corner_stress(&trials::distorted(), answer(trials::SHEAR), answer(trials::BULK)) {
            assert!((stress - trials::linear_stress()).norm() < 1e-14);
        }
    }

    /// Bending u = (x z, -x^2/2) is deviatoric in the mean: free of volumetric energy here, full of it in the Q4,
    /// which is how that locks.
    #[test]
    fn bending_costs_no_volumetric_energy() {
        let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|p| Vector2::new(p[0], p[1]));
        let u = trials::field::<8>(&square, |p| Vector2::new(p.x * p.y, -p.x * p.x / 2.0));
        let energy = |split: Split<8>| u.dot(&(split.volumetric * u));
        assert!(energy(stiffness(&square)).abs() < 1e-15);
        assert!((energy(quad4_stiffness(&square)) - 4.0 / 3.0).abs() < 1e-14);
    }
}
