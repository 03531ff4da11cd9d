//! A body whose interior has a memory of its own: parts that relax differently, such as a constant bulk modulus.
//!
//! At a step length dt the bulk is A u = b + P f with A = sum_p c_p K_p, b = -sum_p K_p h_p from the accepted state
//! (h_p = y_p at u = 0), P from the face into the body, and so on the face
//!
//! ```text
//! u_free = (A^-1 b)_G,     c = 1,     C = (A^-1)_GG
//! ```
//!
//! One factorisation per step length. The whole body is on rank 0: at the sizes where a direct solve is the method,
//! more ranks do not make the solves faster. A layer that is solved wave by wave may be parted among all ranks.

use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Root};

use super::super::{BulkFields, Tempered, Work};
use super::Response;
use super::compliance::Compliance;
use crate::energy::BodyEnergy;
use crate::error::Result;
use crate::parallel::agree;
use crate::petsc::{Gather, Step, Vector};
use crate::snapshot::{NaturalOrder, Snapshot};

/// The body with its memory, whole on one rank or parted among all: then the calls are collective.
pub trait Interior<const D: usize> {
    /// Makes u_free and C hold for a step of this length from the accepted state.
    fn prepare(&mut self, step: Step) -> Result<()>;
    /// u_free of each face node, m.
    fn face(&self) -> &[f64];
    /// C; none before the first step was prepared.
    fn compliance(&self) -> Option<&Compliance<D>>;
    /// What it did: its memory, and its solves.
    fn work(&self) -> Work;
    /// Keeps account of the energy from here on, at rest.
    fn keep_account(&mut self);
    /// The energy at the accepted state, where it is kept account of.
    fn energy(&self) -> Option<BodyEnergy>;
    /// Takes the body to the end of the step that was prepared, under the contact forces `forces` on the face nodes, N/m.
    fn commit(&mut self, step: Step, forces: &[f64]) -> Result<()>;
    /// Itself, where its arms follow the temperature.
    fn tempered(&mut self) -> Option<&mut dyn Tempered> {
        None
    }
    /// Adds the accepted state to a snapshot.
    fn save(&self, snapshot: &mut Snapshot) -> Result<()>;
    /// Takes the accepted state from a snapshot.
    fn restore(&mut self, snapshot: &Snapshot) -> Result<()>;
    /// The bulk fields at the accepted state.
    fn fields(&mut self) -> Result<BulkFields>;
}

/// How many step lengths are kept factorised: that of the phase, and that of a step which was cut or split.
const KEPT: usize = 2;

/// What was factorised for a step length, the last used first.
pub struct Solvers<T> {
    kept: Vec<(f64, T)>,
}

impl<T> Solvers<T> {
    /// None yet.
    pub fn new() -> Self {
        Self { kept: Vec::new() }
    }

    /// Brings that for `dt` to the front, made if it is not kept.
    pub fn select(&mut self, dt: f64, make: impl FnOnce() -> Result<T>) -> Result<()> {
        match self.kept.iter().position(|(other, _)| *other == dt) {
            Some(place) => self.kept[..=place].rotate_right(1),
            None => {
                self.kept.truncate(KEPT - 1);
                self.kept.insert(0, (dt, make()?));
            }
        }
        Ok(())
    }

    /// The one selected last.
    pub fn current(&self) -> Option<&T> {
        self.kept.first().map(|(_, solver)| solver)
    }
}

/// A body with an interior memory.
pub struct BulkMemory<const D: usize> {
    comm: SimpleCommunicator,
    /// On rank 0, or on all ranks, each with its part.
    inside: Option<Box<dyn Interior<D>>>,
    /// Length of the step that was prepared, s.
    prepared: Option<f64>,
    /// On all ranks; only where it is asked for.
    energy: Option<BodyEnergy>,
}

impl<const D: usize> BulkMemory<D> {
    /// At rest; `inside` is on rank 0 of `comm`, or on all that share it.
    pub fn new(comm: &SimpleCommunicator, inside: Option<Box<dyn Interior<D>>>) -> Self {
        Self { comm: comm.duplicate(), inside, prepared: None, energy: None }
    }
}

impl<const D: usize> Response<D> for BulkMemory<D> {
    fn prepare(&mut self, step: Step) -> Result<()> {
        if self.prepared == Some(step.dt) {
            return Ok(());
        }
        let mine = self.inside.as_mut().map_or(Ok(()), |inside| inside.prepare(step));
        agree(&self.comm, mine)?;
        self.prepared = Some(step.dt);
        Ok(())
    }

    fn free(&mut self, _step: Step, free: &mut Vector) -> Result<()> {
        let mut values = free.view_mut()?;
        if let Some(inside) = &self.inside {
            values.copy_from_slice(inside.face());
        }
        Ok(())
    }

    fn secant(&self) -> f64 {
        1.0
    }

    fn compliance(&self) -> Option<&Compliance<D>> {
        self.inside.as_ref().and_then(|inside| inside.compliance())
    }

    fn work(&self) -> Work {
        self.inside.as_ref().map_or_else(Work::default, |inside| inside.work())
    }

    fn keep_account(&mut self, _layout: &Vector) -> Result<()> {
        if let Some(inside) = &mut self.inside {
            inside.keep_account();
        }
        self.energy = Some(BodyEnergy::default());
        Ok(())
    }

    fn energy(&self) -> Option<BodyEnergy> {
        self.energy
    }

    fn commit(&mut self, step: Step, _u: &Vector, forces: &[f64]) -> Result<()> {
        let mine = self.inside.as_mut().map_or(Ok(()), |inside| inside.commit(step, forces));
        self.prepared = None;
        agree(&self.comm, mine)?;
        self.share_energy();
        Ok(())
    }

    fn tempered(&mut self) -> Option<&mut dyn Tempered> {
        self.inside.as_mut().and_then(|inside| inside.tempered())
    }

    fn save(&mut self, _order: &mut NaturalOrder, snapshot: &mut Snapshot) -> Result<()> {
        let mine = self.inside.as_ref().map_or(Ok(()), |inside| inside.save(snapshot));
        agree(&self.comm, mine)
    }

    fn restore(&mut self, _order: &NaturalOrder, snapshot: &Snapshot, _u: &Vector) -> Result<()> {
        self.prepared = None;
        let mine = self.inside.as_mut().map_or(Ok(()), |inside| inside.restore(snapshot));
        agree(&self.comm, mine)?;
        self.share_energy();
        Ok(())
    }

    fn bulk_fields(&mut self, _gather: &mut Gather, _u: &Vector) -> Result<BulkFields> {
        let mine = self.inside.as_mut().map_or(Ok(BulkFields::default()), |inside| inside.fields());
        agree(&self.comm, mine)
    }
}

impl<const D: usize> BulkMemory<D> {
    /// Gives every rank the energy of the body. Collective.
    fn share_energy(&mut self) {
        let Some(energy) = &mut self.energy else { return };
        let mine = self.inside.as_ref().and_then(|inside| inside.energy()).unwrap_or_default();
        let mut numbers = [mine.stored, mine.dissipated];
        self.comm.process_at_rank(0).broadcast_into(&mut numbers[..]);
        let [stored, dissipated] = numbers;
        *energy = BodyEnergy { stored, dissipated };
    }
}
