//! A body whose interior follows its face for all time: a constant Poisson ratio, or no memory.
//!
//! u_I = H u_G with the elastic H, at every step length, so that the arms are needed on the face only:
//!
//! ```text
//! y = mu_0 u + sum_i mu_i z_i+,     c = mu_0 + sum_i mu_i gain_i,     C elastic, instantaneous     (y = u, c = 1 without memory)
//! ```
//!
//! The energy needs S = C^-1 on these displacements: the forces that the elastic body would answer them with. That is
//! known on y, where it is the contact forces F, and so, by the same recursion as that of the displacements, on all:
//!
//! ```text
//! F = mu_0 S u + sum_i mu_i S z_i+,     S z_i+ = decay_i S z_i + gain_i (S u+ - S u)
//! ```

use std::rc::Rc;

use super::super::{BulkFields, Work};
use super::Response;
use super::compliance::Compliance;
use super::recovery::Recovery;
use crate::bulk::{Account, Arms, Series};
use crate::energy::BodyEnergy;
use crate::error::Result;
use crate::petsc::{Gather, Step, Vector};
use crate::snapshot::{NaturalOrder, Snapshot};

/// How the body relaxes as a whole.
pub struct Relaxation {
    /// The arms, on the layout of the face.
    pub arms: Arms,
    /// Their weights.
    pub series: Series,
}

/// A body that follows its face.
pub struct FaceMemory<const D: usize> {
    /// The elastic compliance at the instantaneous moduli, on rank 0.
    pub compliance: Option<Rc<Compliance<D>>>,
    /// None = elastic.
    pub relaxation: Option<Relaxation>,
    /// What is behind the face.
    pub recovery: Recovery<D>,
    /// c for the step that was prepared; 1 without memory.
    pub secant: f64,
    /// Only where the energy is asked for.
    pub account: Option<FaceAccount>,
}

/// The energy of a body that follows its face.
pub struct FaceAccount {
    /// One part.
    account: Account,
    /// F, N/m
    forces: Vector,
    /// S u and S z_i, N/m; none without memory.
    loads: Option<Arms>,
    work: Vector,
}

impl<const D: usize> Response<D> for FaceMemory<D> {
    fn prepare(&mut self, step: Step) -> Result<()> {
        if let Some(Relaxation { arms, series }) = &self.relaxation {
            self.secant = series.secant(&arms.factors(step.dt));
        }
        Ok(())
    }

    /// Where y = 0.
    fn free(&mut self, step: Step, free: &mut Vector) -> Result<()> {
        free.set(0.0)?;
        if let Some(Relaxation { arms, series }) = &mut self.relaxation {
            let answer = arms.answering(series, step, free)?;
            return free.copy_from(answer);
        }
        Ok(())
    }

    fn secant(&self) -> f64 {
        self.secant
    }

    fn compliance(&self) -> Option<&Compliance<D>> {
        self.compliance.as_deref()
    }

    fn work(&self) -> Work {
        let memory_fields = self.relaxation.as_ref().map_or(0, |relaxation| relaxation.arms.len());
        let transforms = self.compliance.as_ref().map_or(0, |compliance| compliance.transforms());
        let applied = self.compliance.as_ref().and_then(|compliance| compliance.applied());
        let (factorisations, solves) = applied.map_or((0, 0), |applied| (1, applied.solves()));
        Work { memory_fields, transforms, factorisations, solves, ..Work::default() }
    }

    fn keep_account(&mut self, layout: &Vector) -> Result<()> {
        let arms = self.relaxation.as_ref().map(|relaxation| &relaxation.arms);
        self.account = Some(FaceAccount {
            account: Account::new(std::iter::once(arms.map_or(0, Arms::len))),
            forces: layout.like()?,
            loads: arms.map(|arms| arms.at_rest(layout)).transpose()?,
            work: layout.like()?,
        });
        Ok(())
    }

    fn energy(&self) -> Option<BodyEnergy> {
        self.account.as_ref().map(|kept| kept.account.energy())
    }

    fn commit(&mut self, step: Step, u: &Vector, forces: &[f64]) -> Result<()> {
        if let Some(account) = &mut self.account {
            account.spend(self.relaxation.as_mut(), step, (u, forces))?;
        }
        self.relaxation.as_mut().map_or(Ok(()), |relaxation| relaxation.arms.commit(step, u))
    }

    fn save(&mut self, order: &mut NaturalOrder, snapshot: &mut Snapshot) -> Result<()> {
        if let Some(account) = &self.account {
            account.save(order, snapshot)?;
        }
        self.relaxation.as_ref().map_or(Ok(()), |relaxation| relaxation.arms.save("arm", order, snapshot))
    }

    fn restore(&mut self, order: &NaturalOrder, snapshot: &Snapshot, u: &Vector) -> Result<()> {
        if let Some(account) = &mut self.account {
            account.restore(order, snapshot)?;
        }
        self.relaxation.as_mut().map_or(Ok(()), |relaxation| relaxation.arms.restore("arm", order, snapshot, u))
    }

    fn bulk_fields(&mut self, gather: &mut Gather, u: &Vector) -> Result<BulkFields> {
        let displacement = gather.all(u)?;
        let effective = match &mut self.relaxation {
            Some(Relaxation { arms, series }) => Some(gather.all(arms.accepted(series, u)?)?),
            None => None,
        };
        self.recovery.fields(&displacement, effective.as_deref())
    }
}

impl FaceAccount {
    /// Takes the account to the end of an accepted step that ends at `u` under the contact forces `on_face`.
    fn spend(
        &mut self,
        relaxation: Option<&mut Relaxation>,
        step: Step,
        (u, on_face): (&Vector, &[f64]),
    ) -> Result<()> {
        let Self { account: Account { parts, dissipated }, forces, loads, work } = self;
        forces.view_mut()?.copy_from_slice(on_face);
        match (relaxation, loads) {
            (Some(Relaxation { arms, series }), Some(loads)) => {
                work.copy_from(loads.answering(series, step, forces)?)?;
                *dissipated += arms.spend(series, step, u, loads.change(work)?, &mut parts[0])?;
                loads.commit(step, work)
            }
            _ => {
                parts[0].long_term = 0.5 * u.dot(forces)?;
                Ok(())
            }
        }
    }

    fn save(&self, order: &mut NaturalOrder, snapshot: &mut Snapshot) -> Result<()> {
        self.account.save(snapshot);
        let Some(loads) = &self.loads else { return Ok(()) };
        order.save("load", loads.last(), snapshot)?;
        loads.save("load", order, snapshot)
    }

    fn restore(&mut self, order: &NaturalOrder, snapshot: &Snapshot) -> Result<()> {
        self.account.restore(snapshot)?;
        let Some(loads) = &mut self.loads else { return Ok(()) };
        order.restore("load", &mut self.work, snapshot)?;
        loads.restore("load", order, snapshot, &self.work)
    }
}
