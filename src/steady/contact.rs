//! The contact problem of steady sliding: one pressure for each node.
//!
//! ```text
//! gap = h - D + d + p/alpha >= 0,   p >= 0,   p gap = 0,     d(k) = C_n(k) p(k) + C_t(k) q(k),   q = q(p)
//! ```
//!
//! Semi-smooth Newton, which is block principal pivoting where q is in proportion to p (Judice and Pires, Computers Oper. Res. 21
//! (1994) 587): the gap is closed where nodes touch, then every node that pulls and every node that penetrates changes side. If their
//! number has not fallen for a while only the last one does (Murty's rule) until it falls. Newton's steps are by GMRES, for which the
//! whole circulant, cut to the nodes that touch, is nearly the inverse.

use nalgebra::{Complex, DVector};

use super::gmres;
use super::spectrum::Spectrum;
use crate::error::{Error, Result};

/// The indentation under each wave of pressure and of shear, m/Pa; waves as in [`Spectrum`].
#[derive(Debug, Clone)]
pub struct Kernel {
    /// C_n
    pub normal: Vec<Complex<f64>>,
    /// C_t, of shear along the velocity.
    pub shear: Vec<Complex<f64>>,
}

/// What is held while sliding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Held {
    /// The approach D, m.
    Approach(f64),
    /// The normal force over the period, N/m, in space N.
    Force(f64),
}

/// What slides on what.
pub struct Contact<'a> {
    /// The transform of the nodes.
    pub spectrum: &'a Spectrum,
    /// The layer.
    pub kernel: &'a Kernel,
    /// 1/alpha, m/Pa; 0 = no penetration.
    pub softness: f64,
    /// h at each node, m.
    pub elevation: &'a [f64],
    /// Of the face at each node, m, in space m^2.
    pub area: f64,
    /// q, Pa, and dq/dp under a pressure.
    pub shear: &'a dyn Fn(f64) -> [f64; 2],
    /// What is held.
    pub held: Held,
}

/// Where it comes to.
#[derive(Debug, Clone, PartialEq)]
pub struct Tractions {
    /// D, m.
    pub approach: f64,
    /// p of each node, Pa.
    pub pressure: Vec<f64>,
    /// The gap that the layer leaves, without the penalty's share, m: negative where the indenter penetrates.
    pub gap: Vec<f64>,
}

/// Rounds of exchanges and corrections at most; half a dozen is usual.
const MOST_ROUNDS: usize = 1000;
/// Rounds that may fail to improve before nodes change sides one at a time.
const PATIENCE: usize = 10;
/// Of each solve: what it leaves is the load of the next.
const SOLVE: f64 = 1e-7;
/// Gaps, beside the approach, and pressures, beside the highest, that are round-off.
const ROUND_OFF: f64 = 1e-12;

impl Contact<'_> {
    /// From where another contact was, if there is one.
    ///
    /// # Errors
    /// [`Error::Solver`] where no contact carries the force, or none was found.
    pub fn solve(&self, start: Option<&Tractions>) -> Result<Tractions> {
        let (mut approach, mut pressure) = match start {
            Some(start) => (start.approach, start.pressure.clone()),
            None => (0.0, vec![0.0; self.elevation.len()]),
        };
        if let Held::Approach(held) = self.held {
            approach = held;
        }
        let mut touching = self.first(&pressure);
        let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
        for _ in 0..MOST_ROUNDS {
            let active: Vec<usize> = (0..touching.len()).filter(|&i| touching[i]).collect();
            let kept: Vec<f64> = active.iter().map(|&i| pressure[i]).collect();
            pressure.fill(0.0);
            active.iter().zip(kept).for_each(|(&i, kept)| pressure[i] = kept);
            self.step(&active, &mut approach, &mut pressure)?;
            let closing = self.closing(approach, &pressure)?;
            let wrong = self.wrong(&touching, approach, (&pressure, &closing));
            let left = active.iter().map(|&i| closing[i].abs()).fold(0.0, f64::max);
            if wrong.is_empty() && left <= ROUND_OFF * self.size(approach) {
                let gap = closing.iter().zip(&pressure).map(|(gap, p)| gap - self.softness * p).collect();
                return Ok(Tractions { approach, pressure, gap });
            }
            if wrong.len() < fewest {
                (fewest, patience) = (wrong.len(), PATIENCE);
            } else {
                patience = patience.saturating_sub(1);
            }
            match (patience, wrong.last()) {
                (0, Some(&last)) => touching[last] = !touching[last],
                _ => wrong.iter().for_each(|&i| touching[i] = !touching[i]),
            }
        }
        Err(Error::Solver(format!("steady sliding: the contact did not settle in {MOST_ROUNDS} rounds")))
    }

    /// The nodes that touch to begin with: those with a pressure, or else half of all, the lowest.
    fn first(&self, pressure: &[f64]) -> Vec<bool> {
        if pressure.iter().any(|&p| p > 0.0) {
            return pressure.iter().map(|&p| p > 0.0).collect();
        }
        let mut sorted = self.elevation.to_vec();
        sorted.sort_by(f64::total_cmp);
        self.elevation.iter().map(|&h| h <= sorted[sorted.len() / 2]).collect()
    }

    /// One step of Newton's method on the nodes that touch.
    fn step(&self, active: &[usize], approach: &mut f64, pressure: &mut [f64]) -> Result<()> {
        if active.is_empty() {
            return match self.held {
                Held::Approach(_) => Ok(()),
                Held::Force(_) => Err(Error::Solver("steady sliding: the whole profile lost contact".into())),
            };
        }
        let nodes = self.elevation.len();
        let slopes: Vec<f64> = active.iter().map(|&i| (self.shear)(pressure[i])[1]).collect();
        let spread = |v: &DVector<f64>| {
            let mut all = vec![0.0; nodes];
            active.iter().zip(v.iter()).for_each(|(&i, v)| all[i] = *v);
            all
        };
        let gather = |all: &[f64]| DVector::from_iterator(active.len(), active.iter().map(|&i| all[i]));
        let product = |v: &DVector<f64>| {
            let dragged = DVector::from_iterator(v.len(), v.iter().zip(&slopes).map(|(v, slope)| v * slope));
            Ok(gather(&self.indentation(spread(v), spread(&dragged))?) + v * self.softness)
        };
        let slope = slopes.iter().sum::<f64>() / slopes.len() as f64;
        let nearly = |v: &DVector<f64>| {
            let mut waves = self.spectrum.waves(&spread(v))?;
            let kernel = self.kernel.normal.iter().zip(&self.kernel.shear);
            waves.iter_mut().zip(kernel).for_each(|(wave, (n, t))| *wave /= n + t * slope + self.softness);
            Ok(gather(&self.spectrum.numbers(&waves)?))
        };
        let solve = |b: &DVector<f64>| gmres::solve((&product, &nearly), b, SOLVE);
        let mut change = solve(&-gather(&self.closing(*approach, pressure)?))?;
        if let Held::Force(force) = self.held {
            let lowered = solve(&DVector::from_element(active.len(), 1.0))?;
            let missing = force / self.area - pressure.iter().sum::<f64>() - change.sum();
            let down = missing / lowered.sum();
            *approach += down;
            change += lowered * down;
        }
        active.iter().zip(change.iter()).for_each(|(&i, change)| pressure[i] += change);
        Ok(())
    }

    /// d, m.
    fn indentation(&self, pressure: Vec<f64>, shear: Vec<f64>) -> Result<Vec<f64>> {
        let mut waves = self.spectrum.waves(&pressure)?;
        let none = shear.iter().all(|&q| q == 0.0);
        waves.iter_mut().zip(&self.kernel.normal).for_each(|(wave, c)| *wave *= c);
        if !none {
            let dragged = self.spectrum.waves(&shear)?;
            let more = dragged.iter().zip(&self.kernel.shear).map(|(wave, c)| wave * c);
            waves.iter_mut().zip(more).for_each(|(wave, more)| *wave += more);
        }
        self.spectrum.numbers(&waves)
    }

    /// h - D + d + p/alpha, m.
    fn closing(&self, approach: f64, pressure: &[f64]) -> Result<Vec<f64>> {
        let shear = pressure.iter().map(|&p| (self.shear)(p)[0]).collect();
        let mut gap = self.indentation(pressure.to_vec(), shear)?;
        let known = self.elevation.iter().zip(pressure);
        gap.iter_mut().zip(known).for_each(|(gap, (h, p))| *gap += h - approach + self.softness * p);
        Ok(gap)
    }

    /// The nodes that pull, or penetrate.
    fn wrong(&self, touching: &[bool], approach: f64, (pressure, closing): (&[f64], &[f64])) -> Vec<usize> {
        let largest = pressure.iter().fold(0.0, |most: f64, p| most.max(p.abs()));
        let size = self.size(approach);
        let wrong = |&i: &usize| match touching[i] {
            true => pressure[i] < -ROUND_OFF * largest,
            false => closing[i] < -ROUND_OFF * size,
        };
        (0..touching.len()).filter(wrong).collect()
    }

    /// What the digits of a gap are taken from, m.
    fn size(&self, approach: f64) -> f64 {
        self.elevation.iter().fold(approach.abs(), |size, h| size.max(h.abs()))
    }
}
