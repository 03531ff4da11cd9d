//! Newton's linear system of each point by itself: a preconditioner where more points are in contact than a dense factor is worth.

use nalgebra::{SMatrix, SVector};

use super::linear::Linearised;

/// The systems of the points, inverted: of y = r - n dp as a dense factor has them.
pub struct Pointwise<const D: usize>(Vec<SMatrix<f64, D, D>>);

impl<const D: usize> Pointwise<D> {
    /// `own` gives the motion of a point under a unit traction on itself, m/Pa.
    pub fn new(points: &[Linearised<D>], own: impl Fn(usize) -> SMatrix<f64, D, D>) -> Self {
        let inverse = |(i, point): (usize, &Linearised<D>)| {
            let [moved, resting] = point.rows();
            let system = moved * own(i) * point.dragging() + resting;
            if point.active { system.try_inverse() } else { None }.unwrap_or_else(SMatrix::identity)
        };
        Self(points.iter().enumerate().map(inverse).collect())
    }

    /// dt of J dt = b, about.
    pub fn solve(&self, points: &[Linearised<D>], b: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        let solved =
            |((point, inverse), b): ((&Linearised<D>, &SMatrix<f64, D, D>), &SVector<f64, D>)| match point.active {
                true => point.dragged(&(inverse * point.combined(b))),
                false => *b,
            };
        points.iter().zip(&self.0).zip(b).map(solved).collect()
    }
}
