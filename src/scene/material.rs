//! What a scene's material and loading history are to the laws of viscoelasticity.

use super::{Arm, Material, Motion, Phase, PoissonRule, Scene};
use crate::rheology::{self, Band, Loading, Poisson, Prony, Ramp};

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
        if let Some(next) = phase.approach.filter(|next| *next != reached) {
            approach.push(Ramp { from: start, to: end, rate: (next - reached) / phase.duration });
            reached = next;
        }
        sliding.extend(ramps_of(phase, start));
        moments.extend(some_steps(phase).map(|t| start + t));
        start = end;
    }
    Some(Loading { band, directions: vec![approach, sliding], moments })
}

/// How a phase slides; a sinusoid by the chords of its first quarter cycles.
fn ramps_of(phase: &Phase, start: f64) -> Vec<Ramp> {
    const MOST: usize = 64;
    match phase.motion {
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
            (0..((4.0 * cycles).ceil() as usize).min(MOST)).map(chord).collect()
        }
    }
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
