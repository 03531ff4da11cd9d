//! Steady sliding of a rigid periodic profile, fully slipping, over a viscoelastic bonded layer.
//!
//! In the frame of the indenter, xi = x - v t, nothing changes, and a field e^{ik xi} is felt by the layer at the
//! frequency w = -k v. With q = f p everywhere (f of the sign of v) the indentation under the pressure is
//!
//! ```text
//! d_k = lambda(k) p_k,   lambda = C_zz - i f C_xz + 1/alpha   at the moduli of w = -k v
//! gap = h - D + d >= 0,   p >= 0,   p gap = 0
//! ```
//!
//! so that the mean (k = 0) obeys the fully relaxed moduli at any speed. With a penalty alpha the gap is the one that
//! the penalised contact closes, h - D + d + p/alpha; 1/alpha = 0 is the rigid limit. The hysteretic force is the
//! integral of p dh/dx: positive when the profile's rising side carries more, which resists motion along +x.

use nalgebra::{Complex, DMatrix, DVector};

use super::layer::Layer;
use super::periodic::{Harmonic, kernel};
use super::solid::Solid;
use crate::error::{Error, Result};

/// What slides over what.
#[derive(Debug, Clone, PartialEq)]
pub struct Sliding {
    /// The layer.
    pub layer: Layer,
    /// Its material.
    pub solid: Solid,
    /// One period along x, m.
    pub width: f64,
    /// Speed of the indenter along +x, m/s; 0 and infinity are the relaxed and the instantaneous limits.
    pub velocity: f64,
    /// Friction coefficient f; q = f p with the sign of the velocity (0 counts as positive).
    pub friction: f64,
    /// 1/alpha, m/Pa; 0 = rigid contact.
    pub softness: f64,
}

/// What is held while sliding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Load {
    /// The normal approach D, m.
    Approach(f64),
    /// The pressure averaged over the period, Pa.
    MeanPressure(f64),
}

/// A steady state, forces over one period.
#[derive(Debug, Clone, PartialEq)]
pub struct Steady {
    /// D, m.
    pub approach: f64,
    /// Integral of p, N/m.
    pub normal: f64,
    /// Integral of q, N/m.
    pub tangential: f64,
    /// Integral of p dh/dx, N/m.
    pub hysteretic: f64,
    /// Length in contact, m, to the spacing of the nodes.
    pub contact_width: f64,
    /// Pressure at the nodes xi_i = i width/n, Pa; empty for the closed form.
    pub pressure: Vec<f64>,
}

impl Sliding {
    /// lambda(k), m/Pa.
    pub fn symbol(&self, k: f64) -> Complex<f64> {
        // At infinite speed the mean is still at rest: 0 x infinity must be 0.
        let w = if k == 0.0 { 0.0 } else { -k * self.velocity };
        let compliance = self.layer.compliance(k, self.solid.moduli(w));
        compliance.sliding(self.signed_friction()) + self.softness
    }

    fn signed_friction(&self) -> f64 {
        self.friction * if self.velocity < 0.0 { -1.0 } else { 1.0 }
    }

    /// Full contact with the harmonic profile, exactly: d = D - h gives p_0 = (D - g_0)/lambda(0) and
    /// p_k = g_0/(2 lambda(k)), so that the hysteretic force is -(1/2) width k g_0^2 Im(1/lambda(k)).
    ///
    /// An error if the least pressure p_0 - g_0/|lambda(k)| is negative: then the contact is partial.
    pub fn full_contact(&self, profile: Harmonic, load: Load) -> Result<Steady> {
        let k = std::f64::consts::TAU / profile.wavelength;
        let (mean_compliance, lambda) = (self.symbol(0.0).re, self.symbol(k));
        let (approach, mean) = match load {
            Load::Approach(approach) => (approach, (approach - profile.amplitude) / mean_compliance),
            Load::MeanPressure(mean) => (profile.amplitude + mean_compliance * mean, mean),
        };
        let least = mean - profile.amplitude / lambda.norm();
        if least < 0.0 {
            return Err(Error::Domain(format!("full contact would need tension: the least pressure is {least} Pa")));
        }
        let normal = mean * self.width;
        Ok(Steady {
            approach,
            normal,
            tangential: self.signed_friction() * normal,
            hysteretic: -0.5 * self.width * k * profile.amplitude.powi(2) * lambda.inv().im,
            contact_width: self.width,
            pressure: Vec::new(),
        })
    }

    /// The contact of any periodic profile x -> (h, dh/dx), on n nodes.
    pub fn solve(&self, n: usize, profile: impl Fn(f64) -> (f64, f64), load: Load) -> Result<Steady> {
        let cell = self.width / n as f64;
        let (elevation, slope): (Vec<f64>, Vec<f64>) = (0..n).map(|i| profile(cell * i as f64)).unzip();
        let problem = Complementarity { kernel: kernel(n, self.width, |k| self.symbol(k)), elevation, load };
        let (approach, pressure) = problem.solve()?;
        let normal = cell * pressure.iter().sum::<f64>();
        Ok(Steady {
            approach,
            normal,
            tangential: self.signed_friction() * normal,
            hysteretic: cell * pressure.iter().zip(&slope).map(|(p, slope)| p * slope).sum::<f64>(),
            contact_width: cell * pressure.iter().filter(|&&p| p > 0.0).count() as f64,
            pressure,
        })
    }
}

/// gap = K p + h - D >= 0, p >= 0, p gap = 0 with the circulant K of a kernel, not symmetric.
struct Complementarity {
    kernel: Vec<f64>,
    elevation: Vec<f64>,
    load: Load,
}

/// Rounds of exchanges after which the search is given up; a dozen is usual.
const MOST_ROUNDS: usize = 2000;

/// Rounds that may fail to improve before nodes are exchanged one at a time.
const PATIENCE: usize = 10;

impl Complementarity {
    /// D and the pressures, by block principal pivoting (Judice and Pires, Computers Oper. Res. 21 (1994) 587).
    ///
    /// Every node that pulls, and every node that penetrates, changes side, all at once; if their number has not
    /// fallen for a while, only the last one does (Murty's rule) until it falls. This ends for every matrix whose
    /// principal minors are positive, symmetric or not, as those of a passive layer are.
    fn solve(&self) -> Result<(f64, Vec<f64>)> {
        let n = self.elevation.len();
        let mut sorted = self.elevation.clone();
        sorted.sort_by(f64::total_cmp);
        // Half the nodes, the lowest: never empty, and not singular where uniform loading meets no compliance.
        let mut touching: Vec<bool> = self.elevation.iter().map(|h| *h <= sorted[n / 2]).collect();
        let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
        for _ in 0..MOST_ROUNDS {
            let (approach, pressure) = self.tractions(&touching)?;
            let wrong = self.wrong(&touching, approach, &pressure);
            let Some(&last) = wrong.last() else { return Ok((approach, pressure)) };
            if wrong.len() < fewest {
                (fewest, patience) = (wrong.len(), PATIENCE);
            } else {
                patience = patience.saturating_sub(1);
            }
            if patience > 0 {
                wrong.iter().for_each(|&i| touching[i] = !touching[i]);
            } else {
                touching[last] = !touching[last];
            }
        }
        Err(Error::Solver(format!("the contact did not settle in {MOST_ROUNDS} rounds")))
    }

    /// D and the pressures that close the gap at the touching nodes.
    fn tractions(&self, touching: &[bool]) -> Result<(f64, Vec<f64>)> {
        let n = touching.len();
        let active: Vec<usize> = (0..n).filter(|&i| touching[i]).collect();
        let mut pressure = vec![0.0; n];
        if active.is_empty() {
            return match self.load {
                Load::Approach(approach) => Ok((approach, pressure)),
                Load::MeanPressure(_) => Err(Error::Solver("the whole profile lost contact".into())),
            };
        }
        let m = active.len();
        let matrix = DMatrix::from_fn(m, m, |a, b| self.kernel[(n + active[a] - active[b]) % n]).lu();
        let solve = |load: DVector<f64>| {
            matrix.solve(&load).ok_or_else(|| Error::Solver("the contact matrix is singular".into()))
        };
        let of_profile = solve(DVector::from_fn(m, |a, _| -self.elevation[active[a]]))?;
        let of_approach = solve(DVector::from_element(m, 1.0))?;
        let approach = match self.load {
            Load::Approach(approach) => approach,
            Load::MeanPressure(mean) => (mean * n as f64 - of_profile.sum()) / of_approach.sum(),
        };
        for (a, &i) in active.iter().enumerate() {
            pressure[i] = of_profile[a] + approach * of_approach[a];
        }
        Ok((approach, pressure))
    }

    /// The nodes that pull or penetrate, by more than round-off.
    fn wrong(&self, touching: &[bool], approach: f64, pressure: &[f64]) -> Vec<usize> {
        let n = touching.len();
        let largest = pressure.iter().fold(0.0f64, |m, p| m.max(p.abs()));
        let deepest = self.elevation.iter().fold(approach.abs(), |m, h| m.max(h.abs()));
        let wrong = |&i: &usize| {
            if touching[i] {
                return pressure[i] < -1e-12 * largest;
            }
            let row = pressure.iter().enumerate().map(|(j, p)| self.kernel[(n + i - j) % n] * p);
            self.elevation[i] - approach + row.sum::<f64>() < -1e-12 * deepest
        };
        (0..n).filter(wrong).collect()
    }
}

#[cfg(test)]
#[path = "steady_tests.rs"]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod tests;
