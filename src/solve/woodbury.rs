//! Solves with the monolithic tangent by a factor of the bulk alone (Sherman, Morrison and Woodbury).
//!
//! The tangent is J = A + P T P', with A the bulk's at this step length, T the contact's and P from the face into the
//! body. A changes with the step length only, and only by a factor where all moduli relax alike, A = l A0. So one
//! Cholesky factorisation serves for every Newton iteration and step, with friction or without:
//!
//! ```text
//! (l + C T) x_G = (A0^-1 b)_G,     x = A0^-1 (b - P T x_G) / l,     C = (A0^-1)_GG
//! ```
//!
//! C is had by blocks of columns, when a node of theirs first comes into contact; of a face that repeats itself along every
//! direction the columns of one node are those of all, moved along. What round-off leaves is for the
//! Krylov method around it. Nothing here depends on earlier steps, to the last digit.

use std::ops::Range;

use mpi::collective::SystemOperation;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives};

use super::face::ContactFace;
use super::on_face::{Factor, SparseColumns};
use super::response::Compliance;
use crate::bulk::Bulk;
use crate::error::{Error, Result};
use crate::mesh::{Face, Grid, apart};
use crate::petsc::{Cholesky, Matrix, Vector};

/// Columns of C that are had together, which takes a fraction of the time of as many single solves.
const BLOCK: usize = 32;

/// J^-1.
pub struct Woodbury<const D: usize> {
    comm: SimpleCommunicator,
    /// Per component of the face, its global row, and its local one where this rank owns it.
    rows: Vec<(i32, Option<usize>)>,
    /// The components of the face in the order of their global rows.
    ascending: Vec<usize>,
    /// Which of them are held: their columns of C are none.
    held: Vec<bool>,
    base: Option<Base<D>>,
    /// The contact at the last tangent; none = not factorised since.
    contact: Option<Factor>,
    work: Vector,
    /// Factorisations, and solves with them.
    pub done: [usize; 2],
}

/// A0 and C.
struct Base<const D: usize> {
    /// The secant of each part of the bulk over that of the first.
    ratios: Vec<f64>,
    factor: Cholesky,
    compliance: Compliance<D>,
    /// Which of its columns are known.
    known: Vec<bool>,
    /// How many nodes there are along each direction, where the face repeats itself from one to the next.
    repeats: Option<Vec<usize>>,
    /// l of the last tangent: the secant of the first part.
    scale: f64,
}

impl<const D: usize> Woodbury<D> {
    /// Costs nothing until the first solve.
    pub fn new(
        comm: &SimpleCommunicator,
        rows: Vec<(i32, Option<usize>)>,
        held: Vec<bool>,
        layout: &Vector,
    ) -> Result<Self> {
        let mut ascending: Vec<usize> = (0..rows.len()).collect();
        ascending.sort_unstable_by_key(|&place| rows[place].0);
        let work = layout.like()?;
        Ok(Self { comm: comm.duplicate(), rows, ascending, held, base: None, contact: None, work, done: [0; 2] })
    }

    /// To be called when the contact's tangent has changed.
    pub fn renew(&mut self) {
        self.contact = None;
    }

    /// C and l at step length `dt`, all of C. Collective.
    pub fn compliance(&mut self, bulk: &Bulk, dt: f64, face: &Face<D>) -> Result<Option<(&Compliance<D>, f64)>> {
        self.factorise(bulk, dt, face)?;
        self.complete(|_| true)?;
        Ok(self.base.as_ref().map(|base| (&base.compliance, base.scale)))
    }

    /// x = A^-1 b at the step length of the last [`Self::compliance`]. Collective.
    pub fn solve_bulk(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        let Some(base) = &self.base else { return Err(Error::Internal("no factor of the bulk".into())) };
        base.factor.solve(b, x)?;
        self.done[1] += 1;
        x.scale(1.0 / base.scale)
    }

    /// x = J^-1 b at step length `dt` and the face's tangent. Collective.
    pub fn solve(
        &mut self,
        (bulk, dt): (&Bulk, f64),
        face: &mut ContactFace<D>,
        b: &Vector,
        x: &mut Vector,
    ) -> Result<()> {
        if self.contact.is_none() {
            self.factorise(bulk, dt, face.interface().face())?;
            self.update(face)?;
        }
        let (Some(base), Some(contact)) = (&self.base, &self.contact) else {
            return Err(Error::Internal("no factor of the bulk".into()));
        };
        base.factor.solve(b, x)?;
        let right = face.gather(x)?;
        let mut on_face = vec![0.0; right.len()];
        contact.solve(&base.compliance, &right, &mut on_face)?;
        self.work.copy_from(b)?;
        let mut load = self.work.view_mut()?;
        for (place, force) in contact.columns().multiply(|place| on_face[place]) {
            if let (_, Some(row)) = self.rows[place] {
                load[row] -= force;
            }
        }
        drop(load);
        base.factor.solve(&self.work, x)?;
        self.done[1] += 2;
        x.scale(1.0 / base.scale)
    }

    /// Makes A0 serve for the step length.
    fn factorise(&mut self, bulk: &Bulk, dt: f64, face: &Face<D>) -> Result<()> {
        let secants = bulk.secants(dt);
        let scale = secants[0];
        let ratios: Vec<f64> = secants.iter().map(|secant| secant / scale).collect();
        if let Some(base) = self.base.as_mut().filter(|base| base.ratios == ratios) {
            base.scale = scale;
            return Ok(());
        }
        // Frees the old factor before the new one is made.
        self.base = None;
        let mut matrix: Matrix = bulk.new_tangent()?;
        matrix.declare_positive_definite()?;
        bulk.sum(&ratios, &mut matrix)?;
        self.done[0] += 1;
        self.base = Some(Base {
            ratios,
            factor: Cholesky::new(&matrix)?,
            compliance: Compliance::unknown(face),
            known: vec![false; self.rows.len()],
            repeats: face
                .grid
                .as_ref()
                .filter(|grid| grid.is_periodic() && !self.held.contains(&true))
                .map(Grid::counts),
            scale,
        });
        Ok(())
    }

    /// Makes `contact` hold for the face's tangent.
    fn update(&mut self, face: &ContactFace<D>) -> Result<()> {
        let columns = SparseColumns::new(&face.tangent, face.interface().pairs(), 0.0);
        self.complete(|block| columns.rows().any(|row| block.contains(&row)))?;
        let Some(base) = &self.base else { return Ok(()) };
        self.contact = Some(Factor::new(&base.compliance, columns, base.scale)?);
        Ok(())
    }

    /// Makes the columns of C known that are in a block that is needed.
    fn complete(&mut self, needed: impl Fn(&Range<usize>) -> bool) -> Result<()> {
        let order = self.rows.len();
        // In whole blocks, always the same ones: then a column has the same digits whatever came before it.
        for first in (0..order).step_by(BLOCK) {
            let block = first..order.min(first + BLOCK);
            match &self.base {
                Some(base) if !base.known[first] && needed(&block) => {
                    let one_for_all = base.repeats.is_some();
                    self.learn(if one_for_all { 0..D } else { block })?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Makes the columns of a block known, and those that are the same from other nodes.
    fn learn(&mut self, block: Range<usize>) -> Result<()> {
        let Some(base) = &mut self.base else { return Ok(()) };
        let columns: Vec<i32> = block.clone().map(|place| self.rows[place].0).collect();
        let entries = if self.comm.size() == 1 {
            let all: Vec<i32> = self.ascending.iter().map(|&place| self.rows[place].0).collect();
            base.factor.inverse_entries(&self.comm, &all, &columns)?
        } else {
            let local: Vec<Option<usize>> = self.ascending.iter().map(|&place| self.rows[place].1).collect();
            let own = base.factor.solved_entries(&self.comm, &local, &columns)?;
            let mut entries = vec![0.0; own.len()];
            self.comm.all_reduce_into(&own[..], &mut entries[..], SystemOperation::sum());
            entries
        };
        self.done[1] += block.len();
        for (column, entries) in block.zip(entries.chunks_exact(self.rows.len())) {
            if !self.held[column] {
                base.compliance.set_column(column, &self.ascending, entries);
            }
            base.known[column] = true;
        }
        if let Some(counts) = &base.repeats {
            base.compliance.repeat_first_node(|i, j| apart(counts, i, j));
            base.known.fill(true);
        }
        Ok(())
    }
}
