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

use nalgebra::{SMatrix, SVector};

use super::super::response::{Compliance, Transform};
use super::linear::Linearised;
use crate::error::Result;

/// How much of what friction gives way by on average is given to all points: with a mean of reciprocals in place of the
/// reciprocal of a mean, less than all of it.
const SOFTNESS: f64 = 0.3;

/// Shares of stick below which a point is taken to slide freely.
const LEAST_SHARE: f64 = 0.1;

/// M^-1.
pub struct Fourier<const D: usize> {
    transform: Transform<D>,
    /// Per wave vector, for r and for dp.
    inverses: Vec<SMatrix<f64, D, D>>,
    sticks: bool,
}

impl<const D: usize> Fourier<D> {
    /// For the points of a flat face with equal `weight`s, and what their laws are; none where the compliance is not that of a
    /// periodic layer.
    pub fn new(compliance: &Compliance<D>, secant: f64, points: &[Linearised<D>], weight: f64) -> Option<Self> {
        let (transform, waves) = compliance.waves()?;
        let per_traction = weight / secant;
        let active: Vec<_> = points.iter().filter(|point| point.active).collect();
        let [soft, stiff] = normal(&active);
        let rho = active.iter().map(|point| modulus(point)).fold(0.0, f64::max);
        // Along the slip and, in space, across it, where a point that slides is soft too.
        let slacks = || active.iter().flat_map(|point| point.slack.into_iter().take(D - 1));
        let shares = || slacks().map(|slack| (share(slack), 1.0 - share(slack)));
        let (give, square) =
            shares().fold((0.0, 0.0), |(give, square), (th, slack)| (give + th * slack, square + th * th));
        // Where all slides there is next to nothing to transform.
        let sticks = shares().any(|(th, _)| th > LEAST_SHARE);
        let kappa = if sticks { SOFTNESS * give / square } else { 0.0 };
        let inverse = |c: &SMatrix<f64, D, D>| {
            let system = SMatrix::from_fn(|i, j| match (i + 1 == D, j + 1 == D) {
                (true, true) => soft + stiff * per_traction * c[(i, j)],
                (false, false) if sticks => rho * per_traction * c[(i, j)] + if i == j { kappa } else { 0.0 },
                _ => f64::from(u8::from(i == j)),
            });
            SMatrix::try_inverse(system)
        };
        let inverses = waves.iter().map(inverse).collect::<Option<_>>()?;
        Some(Self { transform: transform.clone(), inverses, sticks })
    }

    /// dt = M^-1 b
    pub fn solve(&self, points: &[Linearised<D>], b: &[SVector<f64, D>]) -> Result<Vec<SVector<f64, D>>> {
        let combined: Vec<_> = points.iter().zip(b).map(|(point, b)| point.combined(b)).collect();
        let mut loads = Vec::with_capacity(D * points.len());
        for (point, b) in points.iter().zip(&combined) {
            let load = match point.active {
                true => self.held(point, point.tangential(b)) + point.normal * point.normal.dot(b),
                false => SVector::zeros(),
            };
            loads.extend(load.iter());
        }
        let mut waves = self.transform.forward(&loads)?;
        waves.iter_mut().zip(&self.inverses).for_each(|(wave, inverse)| *wave = inverse * *wave);
        let solved = self.transform.inverse_of(waves.iter(), if self.sticks { 0..D } else { D - 1..D })?;
        let of = |((point, b), y): ((&Linearised<D>, &SVector<f64, D>), &[f64])| {
            if !point.active {
                return *b;
            }
            let y = SVector::from_column_slice(y);
            let given = point.scaled(point.slack, point.tangential(b));
            point.dragged(&(given + self.held(point, point.tangential(&y)) + point.normal * point.normal.dot(&y)))
        };
        Ok(points.iter().zip(&combined).zip(solved.chunks_exact(D)).map(of).collect())
    }

    /// Th^(1/2) v of what is tangential.
    fn held(&self, point: &Linearised<D>, v: SVector<f64, D>) -> SVector<f64, D> {
        if !self.sticks {
            return SVector::zeros();
        }
        point.scaled(point.slack.map(|slack| share(slack).sqrt()), v)
    }
}

/// 1 - theta and theta rho_n: the same of all points but where they wear, each as much as it slips; then their means.
fn normal<const D: usize>(active: &[&Linearised<D>]) -> [f64; 2] {
    let wears = active.iter().any(|point| point.wearing != [0.0; 2]);
    match active.first() {
        None => [1.0, 0.0],
        Some(point) if !wears => [point.soft, point.stiff],
        _ => [|point: &Linearised<D>| point.soft, |point: &Linearised<D>| point.stiff]
            .map(|of| active.iter().map(|point| of(point)).sum::<f64>() / active.len() as f64),
    }
}

/// Th; none where friction falls.
fn share(slack: f64) -> f64 {
    (1.0 - slack).max(0.0)
}

/// rho_t
fn modulus<const D: usize>(point: &Linearised<D>) -> f64 {
    let of = |(grip, slack): (f64, f64)| if slack < 1.0 { grip / (1.0 - slack) } else { 0.0 };
    point.grip.into_iter().zip(point.slack).take(D - 1).map(of).fold(0.0, f64::max)
}
