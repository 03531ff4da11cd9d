//! What a scene's material and loading history are to the laws of viscoelasticity.

use super::{Arm, Material, Phase, PoissonRule, Scene};
use crate::rheology::{self, Band, Poisson, Prony};

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
    let step = phases.iter().map(|phase| phase.duration / phase.expected_steps() as f64).fold(f64::INFINITY, f64::min);
    Band::new(step.min(end / 10.0), end).ok()
}

fn series(arms: &[Arm]) -> Prony {
    Prony { arms: arms.iter().map(|arm| rheology::Arm { weight: arm.weight, time: arm.time }).collect() }
}
