//! What a scene's material and loading history are to the laws of viscoelasticity.

use nalgebra::Vector2;

use super::{Arm, Material, Motion, Phase, PoissonRule, Scene, Shifting};
use crate::rheology::{self, Band, Loading, Poisson, Prony, Ramp, Shift};

impl From<Shift> for Shifting {
    fn from(shift: Shift) -> Self {
        match shift {
            Shift::Wlf { reference, c1, c2 } => {
                Self::Wlf { reference_temperature: reference, temperature: reference, c1, c2 }
            }
            Shift::Arrhenius { reference, activation_energy } => {
                Self::Arrhenius { reference_temperature: reference, temperature: reference, activation_energy }
            }
        }
    }
}

impl Shifting {
    /// The law.
    pub fn law(self) -> Shift {
        match self {
            Self::Wlf { reference_temperature: reference, c1, c2, .. } => Shift::Wlf { reference, c1, c2 },
            Self::Arrhenius { reference_temperature: reference, activation_energy, .. } => {
                Shift::Arrhenius { reference, activation_energy }
            }
        }
    }
}

impl Material {
    /// Whether nothing relaxes.
    pub fn is_elastic(&self) -> bool {
        self.arms.is_empty() && self.bulk_arms.is_empty()
    }

    /// G(t)/G(0).
    pub fn shear_series(&self) -> Prony {
        series(&self.arms)
    }

    /// K(t)/K(0), as the rule has it.
    pub fn bulk_series(&self) -> Prony {
        match self.poisson_rule {
            Some(PoissonRule::ConstantRatio) => self.shear_series(),
            Some(PoissonRule::BulkArms) => series(&self.bulk_arms),
            Some(PoissonRule::ConstantBulkModulus) | None => Prony::default(),
        }
    }

    /// The Poisson ratio as it goes with time.
    pub fn poisson(&self) -> Poisson {
        Poisson { instantaneous: self.poisson_ratio, shear: self.shear_series(), bulk: self.bulk_series() }
    }
}

impl Scene {
    /// The times that the loading history visits.
    pub fn band(&self) -> Option<Band> {
        band(&self.phases)
    }
}

/// From the shortest step to the end of the history, s, and at least a decade; none where these are no times.
pub(super) fn band(phases: &[Phase]) -> Option<Band> {
    let end: f64 = phases.iter().map(|phase| phase.duration).sum();
    Band::new(super::shortest_step(phases).min(end / 10.0), end).ok()
}

/// The ramps of the approach and of the sliding, and when their forces are looked at.
pub(super) fn loading(phases: &[Phase]) -> Option<Loading> {
    let band = band(phases)?;
    let (mut approach, mut sliding, mut moments) = (Vec::new(), Vec::new(), Vec::new());
    let (mut start, mut reached) = (0.0, 0.0);
    for phase in phases {
        let end = start + phase.duration;
        let mut from = start;
        for (local, next) in some(&phase.approaches()) {
            let to = start + local;
            if next != reached && to > from {
                approach.push(Ramp { from, to, rate: (next - reached) / (to - from) });
            }
            (from, reached) = (to, next);
        }
        sliding.extend(ramps_of(phase, start));
        moments.extend(some_steps(phase).map(|t| start + t));
        start = end;
    }
    Some(Loading { band, directions: vec![approach, sliding], moments })
}

/// The most ramps that stand for a phase.
const MOST_RAMPS: usize = 64;

/// How a phase slides; a sinusoid by the chords of its first quarter cycles.
fn ramps_of(phase: &Phase, start: f64) -> Vec<Ramp> {
    match &phase.motion {
        Motion::Measured(record) => chords(&record.slid(), start),
        Motion::Velocity(velocity) if velocity.amax() == 0.0 => Vec::new(),
        Motion::Velocity(velocity) => vec![Ramp { from: start, to: start + phase.duration, rate: velocity.norm() }],
        Motion::Tangential { amplitude, cycles, .. } => {
            let amplitude = amplitude.norm();
            let quarter = 0.25 * phase.duration / cycles;
            let chord = |k: usize| Ramp {
                from: start + k as f64 * quarter,
                to: start + (phase.duration).min((k + 1) as f64 * quarter),
                rate: if matches!(k % 4, 0 | 3) { amplitude } else { -amplitude } / quarter,
            };
            (0..((4.0 * cycles).ceil() as usize).min(MOST_RAMPS)).map(chord).collect()
        }
    }
}

/// The ramps of a measured path without where it turns back, from row to row.
fn chords(rows: &[(f64, Vector2<f64>)], start: f64) -> Vec<Ramp> {
    let chord = |pair: &[(f64, Vector2<f64>)]| {
        let [from, to] = [pair[0].0, pair[1].0];
        Ramp { from: start + from, to: start + to, rate: (pair[1].1 - pair[0].1).norm() / (to - from) }
    };
    some(rows).windows(2).map(chord).collect()
}

/// Some rows of many, evenly, and the last one.
fn some<T: Copy>(rows: &[T]) -> Vec<T> {
    let every = rows.len().div_ceil(MOST_RAMPS).max(1);
    let last = rows.len().saturating_sub(1);
    rows.iter().enumerate().filter(|(row, _)| row % every == 0 || *row == last).map(|(_, row)| *row).collect()
}

/// The ends of the first steps of a phase, and then of ever fewer, s after its beginning.
fn some_steps(phase: &Phase) -> impl Iterator<Item = f64> {
    let (count, duration) = (phase.expected_steps(), phase.duration);
    let next = move |step: &usize| Some((step + 1).max(step + step / 8)).filter(|next| *next <= count);
    std::iter::successors(Some(1), next).chain([count]).map(move |step| duration * step as f64 / count as f64)
}

fn series(arms: &[Arm]) -> Prony {
    Prony { arms: arms.iter().map(|arm| rheology::Arm { weight: arm.weight, time: arm.time }).collect() }
}
