//! The bulk half of the residual: a linear operator with memory.
//!
//! The internal force is a sum over parts (modulus times stiffness, each with its own Prony series):
//!
//! ```text
//! f = sum_p K_p y_p,     y_p = mu_0p u + sum_i mu_ip z_i+
//! z_i+ = decay_i z_i + gain_i dt du/dt              (du/dt = (u+ - u)/dt over the step)
//! ```
//!
//! The bulk is linear, so the arms' elongations z_i are nodal fields and no quadrature point has a history. At a given
//! dt the tangent is the constant matrix sum_p c_p K_p, c_p = mu_0p + sum_i mu_ip gain_i. An elastic bulk has no z.

mod arms;
mod springs;

use crate::energy::BodyEnergy;
use crate::error::Result;
use crate::petsc::{Matrix, Step, Vector};
use crate::rheology::Memory;
use crate::snapshot::{NaturalOrder, Snapshot};

pub use arms::{Arms, Series};
pub use springs::{Account, Products, Springs};

/// A stiffness with its modulus, and how it relaxes.
pub struct Part {
    /// Pa times the unit-modulus stiffness.
    pub stiffness: Matrix,
    /// None = elastic.
    pub series: Option<Series>,
}

/// The linear viscoelastic body. Without arms it keeps no vector of its own but the one it works in.
pub struct Bulk {
    parts: Vec<Part>,
    arms: Option<Arms>,
    /// Only where the energy is asked for.
    account: Option<Account>,
    work: Vector,
}

impl Bulk {
    /// A body at rest. `times` are the relaxation times of the arms, s, that the parts' series refer to.
    pub fn new(parts: Vec<Part>, times: Vec<f64>, rule: Memory, layout: &Vector) -> Result<Self> {
        let arms = if times.is_empty() { None } else { Some(Arms::new(times, rule, layout)?) };
        Ok(Self { parts, arms, account: None, work: layout.like()? })
    }

    /// Keeps account of the energy from here on, at rest.
    pub fn keep_account(&mut self) {
        let arms = |part: &Part| part.series.as_ref().map_or(0, |series| series.weights.len());
        self.account = Some(Account::new(self.parts.iter().map(arms)));
    }

    /// The energy at the accepted state, where it is kept account of.
    pub fn energy(&self) -> Option<BodyEnergy> {
        self.account.as_ref().map(Account::energy)
    }

    /// How many nodal fields carry memory.
    pub fn memory_vectors(&self) -> usize {
        self.arms.as_ref().map_or(0, Arms::len)
    }

    /// f = internal force at the trial state, N/m.
    pub fn force(&mut self, step: Step, u: &Vector, rate: &Vector, f: &mut Vector) -> Result<()> {
        f.set(0.0)?;
        for (index, part) in self.parts.iter().enumerate() {
            let effective = match (&part.series, &mut self.arms) {
                (Some(series), Some(arms)) => arms.trial((index, series), step, u, rate)?,
                _ => u,
            };
            part.stiffness.multiply(effective, &mut self.work)?;
            f.add(1.0, &self.work)?;
        }
        Ok(())
    }

    /// A matrix for [`Self::tangent`] to fill.
    pub fn new_tangent(&self) -> Result<Matrix> {
        self.parts[0].stiffness.duplicate()
    }

    /// c_p at step length `dt`, per part: the factor of K_p in the tangent.
    pub fn secants(&self, dt: f64) -> Vec<f64> {
        let factors = self.arms.as_ref().map(|arms| arms.factors(dt)).unwrap_or_default();
        self.parts.iter().map(|part| part.series.as_ref().map_or(1.0, |series| series.secant(&factors))).collect()
    }

    /// tangent = sum_p c_p K_p at step length `dt`.
    pub fn tangent(&self, dt: f64, tangent: &mut Matrix) -> Result<()> {
        self.sum(&self.secants(dt), tangent)
    }

    /// The diagonal of the tangent at step length `dt`.
    pub fn diagonal(&mut self, dt: f64, diagonal: &mut Vector) -> Result<()> {
        diagonal.set(0.0)?;
        for (part, secant) in self.parts.iter().zip(self.secants(dt)) {
            part.stiffness.diagonal(&mut self.work)?;
            diagonal.add(secant, &self.work)?;
        }
        Ok(())
    }

    /// sum = sum_p factor_p K_p
    pub fn sum(&self, factors: &[f64], sum: &mut Matrix) -> Result<()> {
        for (index, (part, &factor)) in self.parts.iter().zip(factors).enumerate() {
            if index == 0 {
                sum.copy_from(&part.stiffness)?;
                sum.scale(factor)?;
            } else {
                sum.add(factor, &part.stiffness)?;
            }
        }
        Ok(())
    }

    /// Takes the memory to the end of an accepted step.
    pub fn commit(&mut self, step: Step, u: &Vector) -> Result<()> {
        self.spend(step, u)?;
        self.arms.as_mut().map_or(Ok(()), |arms| arms.commit(step, u))
    }

    /// Takes the account to the end of an accepted step.
    fn spend(&mut self, step: Step, u: &Vector) -> Result<()> {
        let Some(account) = &mut self.account else { return Ok(()) };
        for (part, springs) in self.parts.iter().zip(&mut account.parts) {
            match (&part.series, &mut self.arms) {
                (Some(series), Some(arms)) => {
                    part.stiffness.multiply(arms.change(u)?, &mut self.work)?;
                    account.dissipated += arms.spend(series, step, u, &self.work, springs)?;
                }
                _ => {
                    part.stiffness.multiply(u, &mut self.work)?;
                    springs.long_term = 0.5 * u.dot(&self.work)?;
                }
            }
        }
        Ok(())
    }

    /// Adds the memory to a snapshot.
    pub fn save(&self, order: &mut NaturalOrder, snapshot: &mut Snapshot) -> Result<()> {
        if let Some(account) = &self.account {
            account.save(snapshot);
        }
        self.arms.as_ref().map_or(Ok(()), |arms| arms.save("arm", order, snapshot))
    }

    /// Takes the memory at the accepted state `u` from a snapshot.
    pub fn restore(&mut self, order: &NaturalOrder, snapshot: &Snapshot, u: &Vector) -> Result<()> {
        if let Some(account) = &mut self.account {
            account.restore(snapshot)?;
        }
        self.arms.as_mut().map_or(Ok(()), |arms| arms.restore("arm", order, snapshot, u))
    }

    /// Gives each part's effective displacement y_p = mu_0 u + sum mu_i z_i at the accepted state `u`, m.
    pub fn effective(&mut self, u: &Vector, mut take: impl FnMut(&Vector) -> Result<()>) -> Result<()> {
        for part in &self.parts {
            match (&part.series, &mut self.arms) {
                (Some(series), Some(arms)) => take(arms.accepted(series, u)?)?,
                _ => take(u)?,
            }
        }
        Ok(())
    }
}
