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

use nalgebra::SVector;
use rustfft::num_complex::Complex;

use super::super::response::{Compliance, Kernel, Patch, Transform};
use super::linear::Linearised;
use crate::error::Result;
use crate::parallel::Team;

/// How much of what friction gives way by on average is given to all points: with a mean of reciprocals in place of the
/// reciprocal of a mean, less than all of it.
const SOFTNESS: f64 = 0.3;

/// Shares of stick below which a point is taken to slide freely.
const LEAST_SHARE: f64 = 0.1;

/// M^-1: what it is made of beside the compliance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fourier {
    /// 1 - theta, and theta rho_n and rho_t times what a force of the compliance is of a traction.
    soft: f64,
    stiff: f64,
    grip: f64,
    kappa: f64,
    sticks: bool,
}

impl Fourier {
    /// For the points of a flat face with equal `weight`s, and what their laws are; none where the compliance is not that of a
    /// periodic layer. Collective.
    pub fn new<const D: usize>(
        compliance: &Compliance<D>,
        secant: f64,
        points: &[Linearised<D>],
        weight: f64,
    ) -> Option<Self> {
        let (transform, _) = compliance.waves()?;
        let team = transform.team();
        let per_traction = weight / secant;
        let active = || points.iter().filter(|point| point.active);
        let [soft, stiff] = normal(team, active);
        let [rho] = team.most([active().map(modulus).fold(0.0, f64::max)]);
        // Along the slip and, in space, across it, where a point that slides is soft too.
        let shares = || {
            active()
                .flat_map(|point| point.slack.into_iter().take(D - 1))
                .map(|slack| (share(slack), 1.0 - share(slack)))
        };
        let (give, square) =
            shares().fold((0.0, 0.0), |(give, square), (th, slack)| (give + th * slack, square + th * th));
        let [give, square] = team.sum([give, square]);
        // Where all slides there is next to nothing to transform.
        let sticks = team.any(shares().any(|(th, _)| th > LEAST_SHARE));
        let kappa = if sticks { SOFTNESS * give / square } else { 0.0 };
        Some(Self { soft, stiff: stiff * per_traction, grip: rho * per_traction, kappa, sticks })
    }

    /// What it makes of a wave.
    fn act<const D: usize>(&self, kernel: &Kernel<D>, wave: usize, w: &mut [Complex<f64>; D]) {
        w[D - 1] /= self.soft + self.stiff * kernel.entry(wave, D - 1, D - 1);
        if !self.sticks {
            return;
        }
        let given = |i: usize| self.grip * kernel.entry(wave, i, i) + self.kappa;
        if D == 2 {
            w[0] /= given(0);
            return;
        }
        let (a, b, c) = (given(0), self.grip * kernel.entry(wave, 0, 1), given(1));
        let share = 1.0 / (a * c - b * b);
        (w[0], w[1]) = ((w[0] * c - w[1] * b) * share, (w[1] * a - w[0] * b) * share);
    }

    /// dt = M^-1 b on a patch of points, in place of b; all others have nothing.
    pub fn solve<const D: usize>(
        &self,
        (transform, kernel): (&Transform<D>, &Kernel<D>),
        (patch, points): (&Patch, &[Linearised<D>]),
        b: &mut [f64],
        room: &mut Vec<f64>,
    ) -> Result<()> {
        room.resize(b.len(), 0.0);
        for ((point, b), load) in points.iter().zip(b.chunks_exact_mut(D)).zip(room.chunks_exact_mut(D)) {
            if !point.active {
                load.fill(0.0);
                continue;
            }
            let combined = point.combined(&SVector::from_column_slice(b));
            let tangential = point.tangential(&combined);
            let normal = point.normal * point.normal.dot(&combined);
            load.copy_from_slice((self.held(point, tangential) + normal).as_slice());
            b.copy_from_slice(point.scaled(point.slack, tangential).as_slice());
        }
        let components = if self.sticks { 0..D } else { D - 1..D };
        transform.filter_patch(patch, room, (components.clone(), components), |wave, w| self.act(kernel, wave, w))?;
        let active = points.iter().zip(b.chunks_exact_mut(D)).zip(room.chunks_exact(D));
        for ((point, b), y) in active.filter(|((point, _), _)| point.active) {
            let (given, y) = (SVector::from_column_slice(b), SVector::from_column_slice(y));
            let held = self.held(point, point.tangential(&y)) + point.normal * point.normal.dot(&y);
            b.copy_from_slice(point.dragged(&(given + held)).as_slice());
        }
        Ok(())
    }

    /// Th^(1/2) v of what is tangential.
    fn held<const D: usize>(&self, point: &Linearised<D>, v: SVector<f64, D>) -> SVector<f64, D> {
        if !self.sticks {
            return SVector::zeros();
        }
        point.scaled(point.slack.map(|slack| share(slack).sqrt()), v)
    }
}

/// 1 - theta and theta rho_n: the same of all points but where they wear, each as much as it slips, or are pulled; then their means. What
/// pulls across a gap counts for none: the face is to be stiff where it is closed.
fn normal<'a, const D: usize, I: Iterator<Item = &'a Linearised<D>>>(team: &Team, active: impl Fn() -> I) -> [f64; 2] {
    let pressed = || active().filter(|point| point.stiff > 0.0);
    let first = pressed().next().map_or([f64::NEG_INFINITY; 2], |point| [point.soft, point.stiff]);
    let varies = pressed().any(|point| point.wearing != [0.0; 2] || point.stiff != first[1]);
    let [soft, stiff, varies] = team.most([first[0], first[1], f64::from(u8::from(varies))]);
    if soft == f64::NEG_INFINITY {
        return [1.0, 0.0];
    }
    if varies == 0.0 {
        return [soft, stiff];
    }
    let (soft, stiff) = pressed().fold((0.0, 0.0), |sum, point| (sum.0 + point.soft, sum.1 + point.stiff));
    let [soft, stiff, count] = team.sum([soft, stiff, pressed().count() as f64]);
    [soft / count, stiff / count]
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
