//! The energy in the springs of a body's part, and what its dashpots take from it.
//!
//! ```text
//! stored:            e_0 = 1/2 mu_0 u'K u,   e_i = 1/2 mu_i z_i'K z_i
//! lost over a step:  mu_i (held z_i'K z_i + 2 mixed z_i'K du + fresh du'K du)        see [`Losses`]
//! ```
//!
//! All follow from v = K du, the change of the force that a displacement would answer with: one product with the matrix
//! per step, however many arms there are, and none where v is known from the forces.

use crate::energy::BodyEnergy;
use crate::error::Result;
use crate::rheology::{Factors, Losses};
use crate::snapshot::Snapshot;

use super::Series;

/// The springs of one part, J/m.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Springs {
    /// e_0
    pub long_term: f64,
    /// e_i
    pub arms: Vec<f64>,
}

/// What v = K du does on the displacements of a step, J/m.
#[derive(Debug, Clone, PartialEq)]
pub struct Products {
    /// (u + u+).v
    pub sum: f64,
    /// du.v
    pub change: f64,
    /// z_i.v, z_i at the beginning of the step; any number where the arm weighs nothing.
    pub arms: Vec<f64>,
}

/// The energy of a body.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Account {
    /// Per part.
    pub parts: Vec<Springs>,
    /// Lost in all dashpots since t = 0, J/m.
    pub dissipated: f64,
}

impl Springs {
    /// Takes the springs to the end of a step; gives what the dashpots took, J/m.
    pub fn advance(&mut self, series: &Series, products: &Products, arms: &[(Factors, Losses)]) -> f64 {
        let Products { sum, change, arms: on } = products;
        self.long_term += 0.5 * series.long_term * sum;
        let mut lost = 0.0;
        for (((energy, weight), (factors, losses)), on) in self.arms.iter_mut().zip(&series.weights).zip(arms).zip(on) {
            if *weight == 0.0 {
                continue;
            }
            let Factors { decay, gain } = factors;
            lost += 2.0 * losses.held * *energy + weight * (2.0 * losses.mixed * on + losses.fresh * change);
            *energy = decay * decay * *energy + weight * gain * (decay * on + 0.5 * gain * change);
        }
        lost
    }

    fn stored(&self) -> f64 {
        self.long_term + self.arms.iter().sum::<f64>()
    }
}

impl Account {
    /// Of a body at rest, whose parts have so many arms.
    pub fn new(arms: impl Iterator<Item = usize>) -> Self {
        Self { parts: arms.map(|arms| Springs { long_term: 0.0, arms: vec![0.0; arms] }).collect(), dissipated: 0.0 }
    }

    /// What is in it.
    pub fn energy(&self) -> BodyEnergy {
        BodyEnergy { stored: self.parts.iter().map(Springs::stored).sum(), dissipated: self.dissipated }
    }

    /// Adds the account to a snapshot.
    pub fn save(&self, snapshot: &mut Snapshot) {
        let parts = self.parts.iter().flat_map(|part| std::iter::once(part.long_term).chain(part.arms.iter().copied()));
        snapshot.put("body-energy", std::iter::once(self.dissipated).chain(parts).collect());
    }

    /// Takes the account from a snapshot.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let parts = self.parts.iter_mut().flat_map(|part| std::iter::once(&mut part.long_term).chain(&mut part.arms));
        let places: Vec<&mut f64> = std::iter::once(&mut self.dissipated).chain(parts).collect();
        let mut values = vec![0.0; places.len()];
        snapshot.fill("body-energy", &mut values)?;
        places.into_iter().zip(values).for_each(|(place, value)| *place = value);
        Ok(())
    }
}
