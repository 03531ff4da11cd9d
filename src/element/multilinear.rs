//! The bilinear quadrilateral and the trilinear hexahedron, with two Gauss points a direction.
//!
//! Corners run counter-clockwise; those of a hexahedron around its lower side, then around its upper one. It locks as the
//! Poisson ratio nears 1/2, unless the dilatation is its mean ([`super::solid`]).

use nalgebra::SVector;

use super::{Gradients, MOST_CORNERS, Sample, Shape, Values};

/// N_a = product over the directions of (1 + c_a xi)/2.
pub struct Multilinear;

/// c_a, each coordinate -1 or 1.
fn corner<const D: usize>(a: usize) -> SVector<f64, D> {
    let upper = |yes: bool| if yes { 1.0 } else { -1.0 };
    let round = [upper(matches!(a % 4, 1 | 2)), upper(matches!(a % 4, 2 | 3)), upper(a >= 4)];
    SVector::from_fn(|axis, _| round[axis])
}

impl<const D: usize> Shape<D> for Multilinear {
    fn corners(&self) -> usize {
        1 << D
    }

    fn samples(&self) -> Vec<Sample<D>> {
        (0..1 << D).map(|a| Sample { at: corner::<D>(a) / 3.0_f64.sqrt(), weight: 1.0 }).collect()
    }

    fn values(&self, at: &SVector<f64, D>) -> Values {
        let value = |a: usize| (0..D).map(|axis| 0.5 * (1.0 + corner::<D>(a)[axis] * at[axis])).product();
        std::array::from_fn(|a| if a < 1 << D { value(a) } else { 0.0 })
    }

    fn slopes(&self, at: &SVector<f64, D>) -> Gradients<D> {
        let mut slopes = [SVector::zeros(); MOST_CORNERS];
        for (a, slope) in slopes.iter_mut().enumerate().take(1 << D) {
            let c = corner::<D>(a);
            let factor = |axis: usize| 0.5 * (1.0 + c[axis] * at[axis]);
            *slope = SVector::from_fn(|axis, _| {
                (0..D).map(|other| if other == axis { 0.5 * c[axis] } else { factor(other) }).product()
            });
        }
        slopes
    }

    /// The multilinear function through the Gauss points.
    fn at_corner(&self, to: usize) -> Vec<f64> {
        let to = corner::<D>(to) * 3.0_f64.sqrt();
        let share = |a: usize| (0..D).map(|axis| 0.5 * (1.0 + corner::<D>(a)[axis] * to[axis])).product();
        (0..1 << D).map(share).collect()
    }

    fn sides(&self) -> &'static [&'static [usize]] {
        match D {
            2 => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
            _ => &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]],
        }
    }
}
