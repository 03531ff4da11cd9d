//! The augmented Lagrangian: contact without penetration from a soft penalty.
//!
//! ```text
//! p = max(0, lambda + alpha e)        e the penetration, lambda >= 0 the multiplier of the point
//! ```
//!
//! A step is solved with given multipliers, which are then set to the pressures found, and solved again (Uzawa), until
//! the pressures leave the multipliers nearly as they are: then e = 0 where p > 0. Uzawa's iteration reduces what is
//! left of e at compliance C by 1/(1 + alpha C), which is little for short waves under a soft penalty; so wherever an
//! iteration reduces it by less than four the penalty becomes ten times as high from then on (Nocedal and Wright,
//! Numerical Optimization, Framework 17.3; Bertsekas 1982). The pressures depend on it no more than the tolerance says.

use crate::error::{Error, Result};
use crate::loading::Placement;

/// Multipliers, and the penalty that they have come with.
#[derive(Debug, Clone, PartialEq)]
pub struct Multipliers {
    /// lambda of each point, Pa.
    pub pressure: Vec<f64>,
    /// alpha, Pa/m
    pub penalty: f64,
}

/// The multipliers of a run.
pub struct Augmentation {
    /// See [`Augmentation::new`].
    tolerance: f64,
    accepted: Multipliers,
    trial: Multipliers,
    /// The attempted step that `trial` belongs to.
    attempt: Option<Placement>,
    /// How often `trial` was moved in this attempt.
    rounds: usize,
    /// What the iteration before left, m.
    left: f64,
}

/// Rounds of one step before the run gives up.
const MOST_ROUNDS: usize = 50;

impl Augmentation {
    /// At rest, beginning with a penalty in Pa/m. The iteration ends when no penetration, nor the separation of a point
    /// that still carries a pressure, is above `tolerance` times the largest displacement of the face in the contact.
    pub fn new(tolerance: f64, penalty: f64, points: usize) -> Self {
        let accepted = Multipliers { pressure: vec![0.0; points], penalty };
        Self { tolerance, trial: accepted.clone(), accepted, attempt: None, rounds: 0, left: f64::INFINITY }
    }

    /// Those to solve an attempted step with.
    pub fn multipliers(&self) -> &Multipliers {
        &self.trial
    }

    /// Begins a step from the accepted multipliers, unless it is the one that is being attempted.
    pub fn attempt(&mut self, placement: Placement) {
        if self.attempt == Some(placement) {
            return;
        }
        if self.rounds > 0 {
            self.trial.clone_from(&self.accepted);
        }
        (self.attempt, self.rounds, self.left) = (Some(placement), 0, f64::INFINITY);
    }

    /// Takes note of a solution of the attempted step: the pressures, Pa, and the largest displacement of the face
    /// normal to itself in the contact, m. Whether it must be solved again, with other multipliers.
    pub fn update(&mut self, pressure: &[f64], deepest: f64) -> Result<bool> {
        let trial = &mut self.trial;
        let changes = pressure.iter().zip(&trial.pressure).map(|(p, lambda)| (p - lambda).abs());
        let left = changes.fold(0.0, f64::max) / trial.penalty;
        if left <= self.tolerance * deepest {
            return Ok(false);
        }
        if self.rounds == MOST_ROUNDS {
            return Err(Error::Solver(format!(
                "the multipliers of the contact have not settled in {MOST_ROUNDS} rounds: {left:.1e} m of penetration \
                 are left; try a larger contact.augmentation_tolerance"
            )));
        }
        trial.pressure.copy_from_slice(pressure);
        if left > 0.25 * self.left {
            trial.penalty *= 10.0;
        }
        self.left = left;
        self.rounds += 1;
        Ok(true)
    }

    /// Takes the accepted multipliers to those that the step was solved with.
    pub fn commit(&mut self) {
        self.accepted.clone_from(&self.trial);
        self.rounds = 0;
    }

    /// The accepted multipliers.
    pub fn accepted(&self) -> &Multipliers {
        &self.accepted
    }

    /// Takes the accepted multipliers from elsewhere.
    pub fn restore(&mut self, accepted: Multipliers) {
        self.trial.clone_from(&accepted);
        self.accepted = accepted;
        self.attempt = None;
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const PLACEMENT: Placement =
        Placement { approach: 1e-3, sliding: 0.0, sliding_rate: 0.0, approach_rate: 0.0, dt: 0.1, resolution: 0.0 };

    /// Two points on springs of compliance C, pressed 1 mm deep: p = (lambda + alpha D)/(1 + alpha C), in the end D/C.
    #[test]
    fn presses_springs_all_the_way() {
        let compliance = [1e-4, 1e-6];
        let mut augmentation = Augmentation::new(1e-7, 1e4, 2);
        augmentation.attempt(PLACEMENT);
        let solve = |multipliers: &Multipliers| -> Vec<f64> {
            let Multipliers { pressure, penalty } = multipliers;
            let at = |i: usize| (pressure[i] + penalty * 1e-3) / (1.0 + penalty * compliance[i]);
            vec![at(0), at(1)]
        };
        let mut rounds = 0;
        while augmentation.update(&solve(augmentation.multipliers()), 1e-3).unwrap() {
            rounds += 1;
        }
        assert!(rounds <= 12, "{rounds}");
        for (pressure, c) in solve(augmentation.multipliers()).iter().zip(compliance) {
            assert!((pressure * c / 1e-3 - 1.0).abs() < 1e-6, "{pressure}");
        }
        // What was not committed is forgotten in another step, what was is where it begins.
        augmentation.attempt(Placement { dt: 0.2, ..PLACEMENT });
        assert_eq!(augmentation.multipliers(), &Multipliers { pressure: vec![0.0; 2], penalty: 1e4 });
        assert!(augmentation.update(&[1.0, 2.0], 1e-3).unwrap());
        augmentation.commit();
        augmentation.attempt(PLACEMENT);
        assert_eq!(augmentation.multipliers().pressure, [1.0, 2.0]);
    }
}
