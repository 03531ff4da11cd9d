//! What stands behind the contact face: how the body moves it.
//!
//! The bulk is linear, so that at a given step length the face's displacements are those that it would have without contact
//! and what the contact forces add through a compliance: u = u_free + C f/c.

mod applied;
mod bulk_memory;
mod compliance;
mod coupled;
mod face_memory;
mod kernel;
mod layered;
mod model;
mod recovery;
mod sparse;
mod transform;
mod travelling;
mod waves;

use super::{BulkFields, Tempered, Work};
use crate::energy::BodyEnergy;
use crate::error::Result;
use crate::petsc::{Gather, Step, Vector};
use crate::snapshot::{NaturalOrder, Snapshot};

pub use applied::Means;
pub use bulk_memory::{BulkMemory, Interior, Solvers};
pub use compliance::Compliance;
pub use coupled::Coupled;
pub use face_memory::{FaceMemory, Relaxation};
pub use kernel::Kernel;
pub use layered::{Layered, PeriodicColumn, Relaxations};
pub use recovery::Recovery;
pub use sparse::{Sparse, unprepared};
pub use transform::{Patch, Transform, Wave};
pub use travelling::{Moving, Travelling};
pub use waves::{Elimination, Operator};

/// What stands behind the face. All ranks call each method together; the compliance is on rank 0, or on all that share the face.
pub trait Response<const D: usize> {
    /// Makes the rest hold for a step of this length from the accepted state.
    fn prepare(&mut self, step: Step) -> Result<()>;
    /// `free` = u_free, m.
    fn free(&mut self, step: Step, free: &mut Vector) -> Result<()>;
    /// c
    fn secant(&self) -> f64;
    /// C, on the ranks that have nodes.
    fn compliance(&self) -> Option<&Compliance<D>>;
    /// What the body did: its memory, and its solves.
    fn work(&self) -> Work;
    /// Keeps account of the energy from here on, at rest; `layout` is that of the face.
    fn keep_account(&mut self, layout: &Vector) -> Result<()>;
    /// The energy at the accepted state, where it is kept account of.
    fn energy(&self) -> Option<BodyEnergy>;
    /// Takes memory and account to the end of an accepted step that ends at `u` under the contact forces `forces` of this rank's nodes.
    fn commit(&mut self, step: Step, u: &Vector, forces: &[f64]) -> Result<()>;
    /// The body, on the rank that has it, where its arms follow the temperature.
    fn tempered(&mut self) -> Option<&mut dyn Tempered> {
        None
    }
    /// Adds the memory to a snapshot; `order` is that of the face.
    fn save(&mut self, order: &mut NaturalOrder, snapshot: &mut Snapshot) -> Result<()>;
    /// Takes the memory at the accepted state `u` from a snapshot that is whole on every rank.
    fn restore(&mut self, order: &NaturalOrder, snapshot: &Snapshot, u: &Vector) -> Result<()>;
    /// The bulk fields at the accepted state `u`; `gather` brings vectors of the face to all ranks.
    fn bulk_fields(&mut self, gather: &mut Gather, u: &Vector) -> Result<BulkFields>;
}
