//! The triangle and the tetrahedron of constant strain.
//!
//! Corners of a triangle run counter-clockwise, those of a tetrahedron so that the first three do as seen from the fourth's
//! opposite side. They converge at the rate of [`super::Multilinear`] with about three times its error, and lock badly as the
//! Poisson ratio nears 1/2, for which no remedy is applied to them.

use nalgebra::SVector;

use super::{Gradients, MOST_CORNERS, Sample, Shape, Values};

/// N_0 = 1 - sum xi, N_a = xi_a.
pub struct Simplex;

impl<const D: usize> Shape<D> for Simplex {
    fn corners(&self) -> usize {
        D + 1
    }

    fn samples(&self) -> Vec<Sample<D>> {
        let volume = 1.0 / (1..=D).product::<usize>() as f64;
        vec![Sample { at: SVector::repeat(1.0 / (D + 1) as f64), weight: volume }]
    }

    fn values(&self, at: &SVector<f64, D>) -> Values {
        let mut values = [0.0; MOST_CORNERS];
        values[0] = 1.0 - at.sum();
        values[1..=D].copy_from_slice(at.as_slice());
        values
    }

    fn slopes(&self, _at: &SVector<f64, D>) -> Gradients<D> {
        let mut slopes = [SVector::zeros(); MOST_CORNERS];
        slopes[0] = SVector::repeat(-1.0);
        for axis in 0..D {
            slopes[axis + 1][axis] = 1.0;
        }
        slopes
    }

    fn at_corner(&self, _corner: usize) -> Vec<f64> {
        vec![1.0]
    }

    fn sides(&self) -> &'static [&'static [usize]] {
        match D {
            2 => &[&[0, 1], &[1, 2], &[2, 0]],
            _ => &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]],
        }
    }
}
