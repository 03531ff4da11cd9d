//! A preconditioner for Newton's linear system on a large periodic face, by Fourier transforms.
//!
//! With the rows combined (super::linear) the pressures and the shears of such a face are nearly two systems, and each is nearly
//! a convolution on the points that it is solved on:
//!
//! ```text
//! dp = P [(1 - theta) + theta rho_n C_nn(k)]^-1 P' b_n                        P onto the points in contact
//! r  = (1 - Th) b_t + Th^(1/2) [rho_t C_tt(k) + kappa]^-1 Th^(1/2) b_t,       kappa = 0.3 mean of (1 - Th)/Th
//! ```
//!
//! C grows like the wavelength, so that what the borders of contact and stick take from this costs GMRES a few iterations that
//! hardly grow with the number of nodes; one iteration costs n log n. Where all slips there is nothing to transform for r.

use nalgebra::Vector2;

use super::super::response::{Compliance, Transform};
use super::linear::Linearised;
use crate::error::Result;

/// How much of what friction gives way by on average is given to all points: with a mean of reciprocals in place of the
/// reciprocal of a mean, less than all of it.
const SOFTNESS: f64 = 0.3;

/// M^-1.
pub struct Fourier {
    transform: Transform,
    /// Per wavenumber, for r and for dp.
    inverses: Vec<[f64; 2]>,
    sticks: bool,
}

impl Fourier {
    /// For the points of a flat face with equal `weight`s, and what their laws are; none where the compliance is not that of a
    /// periodic layer.
    pub fn new(compliance: &Compliance, secant: f64, points: &[Linearised<2>], weight: f64) -> Option<Self> {
        let (transform, waves) = compliance.waves()?;
        let per_traction = weight / secant;
        let active: Vec<_> = points.iter().filter(|point| point.active).collect();
        let (soft, stiff) = active.first().map_or((1.0, 0.0), |point| (point.soft, point.stiff));
        let rho = active.iter().map(|point| modulus(point)).fold(0.0, f64::max);
        let shares = || active.iter().map(|point| (share(point), 1.0 - share(point)));
        let (give, square) =
            shares().fold((0.0, 0.0), |(give, square), (th, slack)| (give + th * slack, square + th * th));
        let kappa = if square > 0.0 { SOFTNESS * give / square } else { 0.0 };
        let inverse = |c: &nalgebra::Matrix2<f64>| {
            let [along, normally] = [c[(0, 0)], c[(1, 1)]].map(|c| c * per_traction);
            [1.0 / (rho * along + kappa), 1.0 / (soft + stiff * normally)]
        };
        Some(Self { transform: transform.clone(), inverses: waves.iter().map(inverse).collect(), sticks: square > 0.0 })
    }

    /// dt = M^-1 b
    pub fn solve(&self, points: &[Linearised<2>], b: &[Vector2<f64>]) -> Result<Vec<Vector2<f64>>> {
        let combined: Vec<_> = points.iter().zip(b).map(|(point, b)| point.combined(b)).collect();
        let load = |(point, b): (&Linearised<2>, &Vector2<f64>)| match point.active {
            true => [if self.sticks { share(point).sqrt() * b.x } else { 0.0 }, b.y],
            false => [0.0; 2],
        };
        let loads: Vec<f64> = points.iter().zip(&combined).flat_map(load).collect();
        let mut waves = self.transform.forward(&loads)?;
        for (wave, inverses) in waves.iter_mut().zip(&self.inverses) {
            for (component, inverse) in inverses.iter().enumerate() {
                wave.row_mut(component).scale_mut(*inverse);
            }
        }
        let solved = self.transform.inverse(waves.iter())?;
        let of = |((point, b), y): ((&Linearised<2>, &Vector2<f64>), &[f64; 2])| {
            if !point.active {
                return *b;
            }
            let [slack, _] = point.slack;
            let stick = if self.sticks { share(point).sqrt() * y[0] } else { 0.0 };
            point.dragged(&Vector2::new(slack * b.x + stick, y[1]))
        };
        Ok(points.iter().zip(&combined).zip(solved.as_chunks().0).map(of).collect())
    }
}

/// Th along e; none where friction falls.
fn share(point: &Linearised<2>) -> f64 {
    (1.0 - point.slack[0]).max(0.0)
}

/// rho_t
fn modulus(point: &Linearised<2>) -> f64 {
    let held = 1.0 - point.slack[0];
    if held > 0.0 { point.grip[0] / held } else { 0.0 }
}
