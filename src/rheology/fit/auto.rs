//! The number of arms: one more for as long as it pays.

use super::quality::{Undetermined, undetermined};
use super::{Fit, Residuals, Samples, identify, unknowns};
use crate::error::{Error, Result};
use crate::rheology::Band;

/// The gain in the Bayesian information criterion that another arm must bring: Kass and Raftery, J. Am. Stat. Assoc.
/// 90 (1995) 773, call more than 10 very strong evidence.
pub const GAIN: f64 = 10.0;
/// The root mean square deviation from the data below which no measurement asks for another arm.
pub const FINE: f64 = 1e-4;
/// The most arms of a ladder: 1.2 to a decade of the data, but 20 at least and 50 at most.
pub fn most(samples: &Samples) -> usize {
    let decades = samples.times().map_or(0.0, Band::decades);
    ((1.2 * decades).ceil() as usize).clamp(20, 50)
}

/// One length of the series.
#[derive(Debug, Clone, PartialEq)]
pub struct Rung {
    /// The best series of this length.
    pub fit: Fit,
    /// N ln(cost/N) + k ln N with N values and k unknowns, Schwarz, Ann. Stat. 6 (1978) 461.
    pub bic: f64,
}

/// Why the ladder ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The next arm lowers the criterion by less than [`GAIN`], or carries nothing; the rung before it is the choice.
    NoLongerPays,
    /// The series is within [`FINE`] of the data.
    Fine,
    /// The next arm would leave no value to check the series with.
    DataExhausted,
    /// The data do not determine the next series; the last rung is that one.
    Undetermined(Undetermined),
    /// [`most`] arms.
    Most,
}

/// Series of 1, 2, 3, ... arms and the choice among them.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    /// In order of length; the last may be the one that did not pay.
    pub rungs: Vec<Rung>,
    /// The index of the choice.
    pub chosen: usize,
    /// Why there are no more.
    pub end: End,
}

/// Lengthens the series until another arm no longer pays.
pub fn climb(samples: &Samples, residuals: Residuals) -> Result<Ladder> {
    let values = samples.values.len();
    let mut rungs: Vec<Rung> = Vec::new();
    for arms in 1..=most(samples) {
        // One value more than unknowns, or any data would be met exactly.
        if values <= unknowns(arms) {
            return ended(rungs, End::DataExhausted, values);
        }
        let fit = identify(samples, arms, residuals, rungs.last().map(|rung| &rung.fit))?;
        let rung = Rung { bic: criterion(samples, residuals, &fit), fit };
        let pays = rungs.last().is_none_or(|last| last.bic - rung.bic > GAIN && rung.fit.dropped == 0);
        let fine = rung.fit.rms_deviation() < FINE;
        let flaw = undetermined(samples, &rung.fit);
        rungs.push(rung);
        let before = rungs.len().checked_sub(2);
        if let (false, Some(chosen)) = (pays, before) {
            return Ok(Ladder { chosen, rungs, end: End::NoLongerPays });
        }
        if let Some(flaw) = flaw {
            let chosen = before.ok_or_else(|| Error::Domain(format!("the data determine no arm: {flaw}")))?;
            return Ok(Ladder { chosen, rungs, end: End::Undetermined(flaw) });
        }
        if fine {
            return ended(rungs, End::Fine, values);
        }
    }
    ended(rungs, End::Most, values)
}

/// The series of `arms` arms; if the data do not determine that many, the longest one that they determine and of which
/// the last arm pays. The others count as dropped.
pub fn at_most(samples: &Samples, arms: usize, residuals: Residuals) -> Result<Fit> {
    let mut first = None;
    let mut best: Option<Rung> = None;
    let mut next = arms;
    while next > 0 {
        let fewer = next;
        let fit = identify(samples, fewer, residuals, None)?;
        next = fewer.min(fit.series.arms.len().max(1)) - 1;
        if let Some(flaw) = undetermined(samples, &fit) {
            first = first.or(Some(flaw));
            continue;
        }
        let rung = Rung { bic: criterion(samples, residuals, &fit), fit };
        match best {
            Some(longer) if rung.bic - longer.bic > GAIN => return Ok(counting(longer.fit, arms)),
            _ if fewer == arms && rung.fit.dropped == 0 => return Ok(rung.fit),
            _ => best = Some(rung),
        }
    }
    let flaw = first.map_or_else(String::new, |flaw| format!(": {flaw}"));
    let best = best.ok_or_else(|| Error::Domain(format!("the data determine no arm{flaw}")))?;
    Ok(counting(best.fit, arms))
}

/// With all that are missing of the arms asked for as dropped.
fn counting(fit: Fit, asked: usize) -> Fit {
    Fit { dropped: asked - fit.series.arms.len(), ..fit }
}

fn ended(rungs: Vec<Rung>, end: End, values: usize) -> Result<Ladder> {
    let chosen = rungs.len().checked_sub(1).ok_or_else(|| {
        Error::Domain(format!("{values} values; an arm has {} unknowns and one more value checks it", unknowns(1)))
    })?;
    Ok(Ladder { rungs, chosen, end })
}

fn criterion(samples: &Samples, residuals: Residuals, fit: &Fit) -> f64 {
    let n = samples.values.len() as f64;
    let scale = match residuals {
        Residuals::Linear => samples.values.iter().fold(0.0, |most: f64, value| most.max(value.abs())),
        Residuals::Relative => 1.0,
    };
    // Residuals at the round-off of the data say nothing of another arm.
    let variance = (fit.cost / n).max((1e-10 * scale).powi(2));
    n * variance.ln() + unknowns(fit.series.arms.len()) as f64 * n.ln()
}
