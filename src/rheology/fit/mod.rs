//! Identification of a Prony series from measured moduli.
//!
//! M(t) = M_inst \[mu_0 + sum mu_i exp(-t/tau_i)\], Bonari and Paggi (2020), section 2.3: first the moduli alone, at
//! trial times, which is a linear problem; then moduli and times together from there, iterated to a relative change of
//! 1e-15 or until no step gains any more. Several sets of trial times are tried, because the second problem has more
//! than one local minimum. What is ours: the choice of trial times, the logarithmic unknowns, the ladder of
//! [`auto`], and everything said of how far to trust the result.

pub mod auto;
mod linear;
mod nonlinear;
pub mod quality;
mod samples;

use std::cmp::Ordering;

pub use auto::{Ladder, Rung};
pub use quality::{Uncertainty, Undetermined};
pub use samples::{Samples, Test};

use self::nonlinear::{Bounds, Minimum, Moduli, minimise};
use super::{Arm, Band, Prony};
use crate::error::{Error, Result};

/// What is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Residuals {
    /// Series minus data: the largest moduli count most. What the paper did.
    Linear,
    /// ln(series/data): every decade of the modulus counts the same.
    Relative,
}

impl Residuals {
    /// Relative where the moduli span more than a decade, so that the small ones count; a modulus of 0 has no logarithm.
    pub fn natural(samples: &Samples) -> Self {
        let least = samples.values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = samples.values.iter().copied().fold(0.0, f64::max);
        if least > 0.0 && most > 10.0 * least { Self::Relative } else { Self::Linear }
    }
}

/// Why the iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The residual norm or the unknowns changed by less than 1e-15 of themselves.
    RelativeChange,
    /// No step lowers the residual norm any further in double precision.
    Stagnation,
    /// Neither, within the evaluations allowed.
    EvaluationLimit,
}

/// An identified series and how far to trust it.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// M(0), Pa, of the modulus that was measured.
    pub instantaneous: f64,
    /// Weights and times, ascending in time.
    pub series: Prony,
    /// Arms asked for that the data gave no weight, and that were left out.
    pub dropped: usize,
    /// Why the iteration ended.
    pub stop: Stop,
    /// How often the residuals were evaluated on the way to this minimum.
    pub evaluations: usize,
    /// The sum of the squared residuals, Pa^2 or pure numbers.
    pub cost: f64,
    /// Series over data minus one, at each value; storage and then loss for a dynamic test.
    pub deviation: Vec<f64>,
    /// What the data say of each unknown.
    pub uncertainty: Uncertainty,
}

impl Fit {
    /// The root mean square of the relative deviations.
    pub fn rms_deviation(&self) -> f64 {
        let finite = self.deviation.iter().filter(|d| d.is_finite());
        (finite.clone().map(|d| d * d).sum::<f64>() / finite.count().max(1) as f64).sqrt()
    }

    /// The largest relative deviation.
    pub fn max_deviation(&self) -> f64 {
        self.deviation.iter().filter(|d| d.is_finite()).fold(0.0, |most, d| d.abs().max(most))
    }
}

/// How many unknowns a series of `arms` arms has: a modulus and a time each, and the long-term modulus.
pub fn unknowns(arms: usize) -> usize {
    2 * arms + 1
}

/// The Prony series of (at most) `arms` arms closest to the data; `previous` is the best series of one arm less, if
/// there is one, and gives one more start.
pub fn identify(samples: &Samples, arms: usize, residuals: Residuals, previous: Option<&Fit>) -> Result<Fit> {
    if arms == 0 || samples.values.len() < unknowns(arms) {
        return Err(Error::Domain(format!(
            "{arms} arms have {} unknowns; {} values cannot determine them",
            unknowns(arms),
            samples.values.len()
        )));
    }
    let scale = samples.values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    if !(scale > 0.0 && scale.is_finite()) {
        return Err(Error::Domain("the moduli must be finite and not all zero".into()));
    }
    let band = samples
        .times()
        .ok_or_else(|| Error::Domain("relaxation times need data at two positive times or frequencies".into()))?;
    // Around 1 Pa, where the logarithms of the unknowns are small.
    let unit = samples.scaled(1.0 / scale);
    let bounds = Bounds::of(band.widened(REACH));
    let minima = starts(&unit, band, arms, residuals, previous)
        .into_iter()
        .map(|start| minimise(&unit, residuals, bounds, start, 400, 1));
    let best = minima.min_by(|a, b| order(a.cost, b.cost));
    let best = best.ok_or_else(|| Error::Internal("no trial times".into()))?;
    let spent = best.evaluations;
    let mut best = minimise(&unit, residuals, bounds, best.moduli, 1000, 20);
    best.evaluations += spent;
    let best = without_idle(&unit, residuals, bounds, best);
    Ok(finish(samples, residuals, scale, arms, best))
}

/// How far past the data a relaxation time may lie.
const REACH: f64 = 10.0;

/// The moduli that belong to several sets of trial times; of many sets only those that come closest to the data.
fn starts(samples: &Samples, band: Band, arms: usize, residuals: Residuals, previous: Option<&Fit>) -> Vec<Moduli> {
    // Long series cost most and know best where the next arm goes.
    let most = if arms > 8 { 3 } else { 8 };
    let sets = trial_times(samples, band, arms, residuals, previous);
    let mut starts: Vec<(f64, Moduli)> = sets
        .into_iter()
        .map(|times| start(samples, residuals, &times))
        .map(|start| (start.cost(samples, residuals), start))
        .collect();
    starts.sort_by(|a, b| order(a.0, b.0));
    starts.truncate(most);
    starts.into_iter().map(|(_, start)| start).collect()
}

/// Finite costs first, ascending.
fn order(a: f64, b: f64) -> Ordering {
    a.is_nan().cmp(&b.is_nan()).then(a.total_cmp(&b))
}

/// The sets of trial times: evenly over the logarithm of the band, inside it and with its ends; gathered from the
/// non-negative spectrum on a dense grid; and the times of the shorter series with one more in every gap.
fn trial_times(
    samples: &Samples,
    band: Band,
    arms: usize,
    residuals: Residuals,
    previous: Option<&Fit>,
) -> Vec<Vec<f64>> {
    let mut sets = vec![band.interior(arms), band.samples(arms), spectrum(samples, band, arms, residuals)];
    if let Some(fit) = previous.filter(|fit| fit.series.arms.len() + 1 == arms) {
        let known: Vec<f64> = fit.series.arms.iter().map(|arm| arm.time).collect();
        let ends = [known[0] / REACH, known[known.len() - 1] * REACH];
        let gaps = known.windows(2).map(|pair| (pair[0] * pair[1]).sqrt());
        sets.extend(gaps.chain(ends).map(|new| [known.clone(), vec![new]].concat()));
    }
    sets
}

/// Trial times where a non-negative least-squares spectrum over many fixed times has its weight: neighbours are
/// merged, the closest first, until `arms` are left.
fn spectrum(samples: &Samples, band: Band, arms: usize, residuals: Residuals) -> Vec<f64> {
    // The spectrum of a broad relaxation reaches a little past the data at both ends.
    let wide = band.widened(3.0);
    let grid = wide.samples(((wide.decades() * 6.0) as usize).clamp(3 * arms, 20 * arms + 40));
    let moduli = linear::moduli(samples, residuals, &grid);
    let mut lines: Vec<(f64, f64)> =
        grid.iter().zip(&moduli[1..]).filter(|line| *line.1 > 0.0).map(|line| (*line.1, line.0.ln())).collect();
    while lines.len() > arms {
        let gap = |i: &usize| lines[i + 1].1 - lines[*i].1;
        let Some(i) = (0..lines.len() - 1).min_by(|i, j| gap(i).total_cmp(&gap(j))) else { break };
        let (left, right) = (lines[i], lines.remove(i + 1));
        let sum = left.0 + right.0;
        lines[i] = (sum, (left.0 * left.1 + right.0 * right.1) / sum);
    }
    let missing = arms - lines.len();
    lines.iter().map(|line| line.1.exp()).chain(band.interior(missing)).collect()
}

/// The best moduli at `times`. What comes out as zero starts small instead: its logarithm must be finite.
fn start(samples: &Samples, residuals: Residuals, times: &[f64]) -> Moduli {
    let moduli = linear::moduli(samples, residuals, times);
    let least = 1e-3 * moduli.iter().fold(1e-3, |most: f64, value| most.max(*value));
    Moduli {
        spring: Some(moduli[0].max(least)),
        arms: moduli[1..].iter().map(|modulus| modulus.max(least)).zip(times.iter().copied()).collect(),
    }
}

/// The same minimum with fewer unknowns, where some of them are zero, which a logarithm never gets to, or do the same.
fn without_idle(samples: &Samples, residuals: Residuals, bounds: Bounds, found: Minimum) -> Minimum {
    let linear = linear::moduli(samples, residuals, &found.moduli.times());
    let shares = found.moduli.shares(samples);
    let idle = |share: f64, best: f64| best == 0.0 || share < 1e-9;
    let spring = found.moduli.spring.filter(|_| !idle(shares[0], linear[0]));
    let active = found.moduli.arms.iter().zip(shares[1..].iter().zip(&linear[1..]));
    let arms = merged(active.filter(|(_, (share, best))| !idle(**share, **best)).map(|(arm, _)| *arm).collect());
    let fewer = Moduli { spring, arms };
    if fewer == found.moduli || fewer.arms.is_empty() && fewer.spring.is_none() {
        return found;
    }
    let mut again = minimise(samples, residuals, bounds, fewer, 1000, 20);
    again.evaluations += found.evaluations;
    let noise = (1e-14 * samples.values.len() as f64).powi(2);
    if again.cost <= found.cost * (1.0 + 1e-6) + noise { again } else { found }
}

/// Arms of times that are the same to 1e-3, by ascending time, as one arm each.
fn merged(mut arms: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    arms.sort_by(|a, b| a.1.total_cmp(&b.1));
    arms.dedup_by(|next, kept| {
        let same = next.1 < kept.1 * 1.001;
        if same {
            kept.0 += next.0;
        }
        same
    });
    arms
}

/// From the minimum in units of `scale` to the series, with what is to be said of it.
fn finish(samples: &Samples, residuals: Residuals, scale: f64, asked: usize, minimum: Minimum) -> Fit {
    let mut moduli = minimum.moduli;
    moduli.arms.sort_by(|a, b| a.1.total_cmp(&b.1));
    moduli.spring = moduli.spring.map(|spring| spring * scale);
    moduli.arms.iter_mut().for_each(|arm| arm.0 *= scale);
    let instantaneous = moduli.instantaneous();
    let mut arms: Vec<Arm> =
        moduli.arms.iter().map(|&(modulus, time)| Arm { weight: modulus / instantaneous, time }).collect();
    // Without a long-term modulus the weights sum to 1; round-off must not take them past it.
    let excess = arms.iter().map(|arm| arm.weight).sum::<f64>() - 1.0;
    if let Some(largest) = arms.iter_mut().max_by(|a, b| a.weight.total_cmp(&b.weight)).filter(|_| excess > 0.0) {
        largest.weight -= 2.0 * excess;
    }
    let deviation =
        moduli.predict(samples).iter().zip(&samples.values).map(|(model, value)| model / value - 1.0).collect();
    let cost = moduli.cost(samples, residuals);
    Fit {
        instantaneous,
        dropped: asked - arms.len(),
        series: Prony { arms },
        stop: minimum.stop,
        evaluations: minimum.evaluations,
        deviation,
        uncertainty: quality::uncertainty(&moduli, samples, residuals),
        cost,
    }
}
