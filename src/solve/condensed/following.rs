//! A body whose interior follows its face for all time: a constant Poisson ratio, or no memory.
//!
//! u_I = H u_G with the elastic H, at every step length, so that the arms are needed on the face only:
//!
//! ```text
//! y = mu_0 u + sum_i mu_i z_i+,     c = mu_0 + sum_i mu_i gain_i,     C elastic, instantaneous     (y = u, c = 1 without memory)
//! ```

use std::rc::Rc;

use super::super::face::ContactFace;
use super::super::{BulkFields, Work};
use super::Backing;
use super::compliance::Compliance;
use super::interior::Interior;
use crate::bulk::{Arms, Series};
use crate::error::Result;
use crate::interface::Residual;
use crate::petsc::{Step, Vector};
use crate::snapshot::{NaturalOrder, Snapshot};

/// How the body relaxes as a whole.
pub struct Relaxation {
    /// The arms, on the layout of the face.
    pub arms: Arms,
    /// Their weights.
    pub series: Series,
}

/// A body that follows its face.
pub struct Following {
    /// The elastic compliance at the instantaneous moduli, on rank 0.
    pub compliance: Option<Rc<Compliance>>,
    /// Its largest entry, m per N/m, on all ranks.
    pub softness: f64,
    /// None = elastic.
    pub relaxation: Option<Relaxation>,
    /// What is behind the face.
    pub interior: Interior,
    /// c for the step that was prepared; 1 without memory.
    pub secant: f64,
}

impl Backing for Following {
    fn prepare(&mut self, step: Step) -> Result<()> {
        if let Some(Relaxation { arms, series }) = &self.relaxation {
            self.secant = series.secant(&arms.factors(step.dt));
        }
        Ok(())
    }

    fn free(&mut self, step: Step, u: &Vector, rate: &Vector, y: &mut Vector) -> Result<()> {
        match &mut self.relaxation {
            Some(Relaxation { arms, series }) => y.copy_from(arms.trial((0, series), step, u, rate)?),
            None => y.copy_from(u),
        }
    }

    fn secant(&self) -> f64 {
        self.secant
    }

    fn compliance(&self) -> Option<&Compliance> {
        self.compliance.as_deref()
    }

    fn softness(&self) -> f64 {
        self.softness
    }

    fn takes_forces(&self) -> bool {
        false
    }

    fn work(&self) -> Work {
        let memory_fields = self.relaxation.as_ref().map_or(0, |relaxation| relaxation.arms.len());
        Work { memory_fields, ..Work::default() }
    }

    fn commit(&mut self, step: Step, u: &Vector, _residual: &Residual) -> Result<()> {
        self.relaxation.as_mut().map_or(Ok(()), |relaxation| relaxation.arms.commit(step, u))
    }

    fn save(&mut self, order: &mut NaturalOrder, snapshot: &mut Snapshot) -> Result<()> {
        self.relaxation.as_ref().map_or(Ok(()), |relaxation| relaxation.arms.save(order, snapshot))
    }

    fn restore(&mut self, order: &NaturalOrder, snapshot: &Snapshot, u: &Vector) -> Result<()> {
        self.relaxation.as_mut().map_or(Ok(()), |relaxation| relaxation.arms.restore(order, snapshot, u))
    }

    fn bulk_fields(&mut self, face: &mut ContactFace, u: &Vector) -> Result<BulkFields> {
        let displacement = face.gather(u)?;
        let effective = match &mut self.relaxation {
            Some(Relaxation { arms, series }) => Some(face.gather(arms.accepted(series, u)?)?),
            None => None,
        };
        self.interior.fields(&displacement, effective.as_deref())
    }
}
