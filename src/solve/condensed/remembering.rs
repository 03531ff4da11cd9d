//! A body whose interior has a memory of its own: parts that relax differently, such as a constant bulk modulus.
//!
//! At a step length dt the bulk is A u = b - P R with A = sum_p c_p K_p, b = -sum_p K_p h_p from the accepted state
//! (h_p = y_p at u = 0), P from the face into the body, and so on the face
//!
//! ```text
//! y = u - u0,   u0 = (A^-1 b)_G,     c = 1,     C = (A^-1)_GG
//! ```
//!
//! One factorisation per step length; per step one solve for u0, and one for the interior once R is known. The whole
//! body is on rank 0: at the sizes where a direct solve is the method, more ranks do not make the solves faster.

use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Root};

use super::super::BulkFields;
use super::super::body::{Body, Region, Solid};
use super::super::face::ContactFace;
use super::Backing;
use super::compliance::Compliance;
use crate::bulk::Bulk;
use crate::element::plane::Split;
use crate::element::quad4::Stiffness;
use crate::energy::BodyEnergy;
use crate::error::Result;
use crate::interface::Residual;
use crate::mesh::Cell;
use crate::parallel::agree;
use crate::petsc::{Cholesky, Matrix, Step, Vector};
use crate::snapshot::{NaturalOrder, Snapshot};

/// How many step lengths are kept factorised: that of the phase, and that of a step which was cut or split.
const KEPT: usize = 2;

/// Where the compliance at a step length comes from.
pub enum Source {
    /// The Schur complement of the body.
    Schur,
    /// The block-circulant structure of a periodic layer of so many columns; cells from the top down.
    Periodic(PeriodicColumn),
}

/// One column of a periodic layer.
pub struct PeriodicColumn {
    /// Its cells, from the top down.
    cells: Vec<(Split<8>, Region)>,
    /// How many such columns there are.
    pub columns: usize,
}

impl PeriodicColumn {
    /// Of a layer's mesh, whose first cells are those of one column.
    pub fn new(solid: &Solid, [columns, rows]: [usize; 2]) -> Self {
        let split = |cell: usize| match solid.mesh.cells[cell] {
            Cell::Quadrilateral(corners) => Some((solid.quadrilateral(corners), solid.region(cell))),
            Cell::Triangle(_) => None,
        };
        Self { cells: (0..rows).filter_map(split).collect(), columns }
    }

    /// The cells' stiffness with each part of the bulk times its factor.
    pub fn stiffness(&self, factors: &[f64]) -> Vec<Stiffness> {
        let with = |(split, region): &(Split<8>, Region)| {
            let relaxed = region.relaxed(factors);
            split.with(relaxed.shear, relaxed.bulk)
        };
        self.cells.iter().map(with).collect()
    }
}

/// A body with an interior memory.
pub struct Remembering {
    comm: SimpleCommunicator,
    /// On rank 0.
    interior: Option<Interior>,
    /// For the step that was prepared, on all ranks.
    softness: f64,
    /// Length and beginning of the step that was prepared, s.
    prepared: Option<f64>,
    /// On all ranks; only where it is asked for.
    energy: Option<BodyEnergy>,
}

/// The whole body, on the one rank that solves it.
struct Interior {
    bulk: Bulk,
    body: Body,
    source: Source,
    /// First row of each face node.
    rows: Vec<usize>,
    kept: Vec<i32>,
    tangent: Matrix,
    /// The accepted displacements, m.
    u: Vector,
    /// Step lengths that are factorised, the last used first.
    solvers: Vec<Solver>,
    load: Vector,
    free: Vector,
    /// u0, per component of the face.
    face: Vec<f64>,
    zero: Vector,
    work: Vector,
}

/// A at one step length.
struct Solver {
    dt: f64,
    factor: Cholesky,
    compliance: Compliance,
}

impl Remembering {
    /// At rest; `whole` is the body with its bulk, on rank 0 of `comm` (both made for that rank alone).
    pub fn new(comm: &SimpleCommunicator, whole: Option<(Bulk, Body)>, source: Source) -> Result<Self> {
        let interior = whole.map(|(bulk, body)| Interior::new(bulk, body, source)).transpose();
        Ok(Self {
            comm: comm.duplicate(),
            interior: agree(comm, interior)?,
            softness: 0.0,
            prepared: None,
            energy: None,
        })
    }
}

impl Backing for Remembering {
    fn prepare(&mut self, step: Step) -> Result<()> {
        if self.prepared == Some(step.dt) {
            return Ok(());
        }
        let mine = self.interior.as_mut().map_or(Ok(0.0), |interior| interior.prepare(step));
        self.softness = agree(&self.comm, mine)?;
        self.comm.process_at_rank(0).broadcast_into(&mut self.softness);
        self.prepared = Some(step.dt);
        Ok(())
    }

    fn free(&mut self, _step: Step, u: &Vector, _rate: &Vector, y: &mut Vector) -> Result<()> {
        y.copy_from(u)?;
        // On all ranks: PETSc keeps norms until it sees a vector written to, on each rank for itself.
        let mut y = y.view_mut()?;
        if let Some(interior) = &self.interior {
            for (y, free) in y.iter_mut().zip(&interior.face) {
                *y -= free;
            }
        }
        Ok(())
    }

    fn secant(&self) -> f64 {
        1.0
    }

    fn compliance(&self) -> Option<&Compliance> {
        self.interior.as_ref().and_then(|interior| interior.solvers.first()).map(|solver| &solver.compliance)
    }

    fn softness(&self) -> f64 {
        self.softness
    }

    fn takes_forces(&self) -> bool {
        true
    }

    fn keep_account(&mut self, _layout: &Vector) -> Result<()> {
        if let Some(interior) = &mut self.interior {
            interior.bulk.keep_account();
        }
        self.energy = Some(BodyEnergy::default());
        Ok(())
    }

    fn energy(&self) -> Option<BodyEnergy> {
        self.energy
    }

    fn commit(&mut self, step: Step, _u: &Vector, residual: &Residual) -> Result<()> {
        let mine = self.interior.as_mut().map_or(Ok(()), |interior| interior.commit(step, residual));
        self.prepared = None;
        agree(&self.comm, mine)?;
        self.share_energy();
        Ok(())
    }

    fn save(&mut self, _order: &mut NaturalOrder, snapshot: &mut Snapshot) -> Result<()> {
        let mine = self.interior.as_ref().map_or(Ok(()), |interior| interior.save(snapshot));
        agree(&self.comm, mine)
    }

    fn restore(&mut self, _order: &NaturalOrder, snapshot: &Snapshot, _u: &Vector) -> Result<()> {
        self.prepared = None;
        let mine = self.interior.as_mut().map_or(Ok(()), |interior| interior.restore(snapshot));
        agree(&self.comm, mine)?;
        self.share_energy();
        Ok(())
    }

    fn bulk_fields(&mut self, _face: &mut ContactFace, _u: &Vector) -> Result<BulkFields> {
        let mine = self.interior.as_mut().map_or(Ok(BulkFields::default()), Interior::fields);
        agree(&self.comm, mine)
    }
}

impl Remembering {
    /// Gives every rank the energy of the body. Collective.
    fn share_energy(&mut self) {
        let Some(energy) = &mut self.energy else { return };
        let mine = self.interior.as_ref().and_then(|interior| interior.bulk.energy()).unwrap_or_default();
        let mut numbers = [mine.stored, mine.dissipated];
        self.comm.process_at_rank(0).broadcast_into(&mut numbers[..]);
        let [stored, dissipated] = numbers;
        *energy = BodyEnergy { stored, dissipated };
    }
}

impl Interior {
    fn new(bulk: Bulk, body: Body, source: Source) -> Result<Self> {
        let (mesh, numbering) = (body.mesh(), body.numbering());
        let rows: Vec<usize> =
            mesh.face.unknown.iter().map(|&unknown| 2 * numbering.global[unknown as usize] as usize).collect();
        let kept = Compliance::free_rows(&body).into_iter().map(|(_, row)| row).collect();
        let mut tangent = bulk.new_tangent()?;
        tangent.declare_positive_definite()?;
        let vector = || body.vector();
        Ok(Self {
            u: vector()?,
            load: vector()?,
            free: vector()?,
            zero: vector()?,
            work: vector()?,
            face: vec![0.0; 2 * rows.len()],
            solvers: Vec::new(),
            bulk,
            source,
            rows,
            kept,
            tangent,
            body,
        })
    }

    /// Brings solver and free response to a step from the accepted state; gives the softness of the face.
    fn prepare(&mut self, step: Step) -> Result<f64> {
        match self.solvers.iter().position(|solver| solver.dt == step.dt) {
            Some(place) => self.solvers[..=place].rotate_right(1),
            None => {
                let solver = self.solver(step.dt)?;
                self.solvers.insert(0, solver);
                self.solvers.truncate(KEPT);
            }
        }
        // h_p is y_p at u = 0, where du/dt = -u_n / dt.
        self.work.copy_from(&self.u)?;
        self.work.scale(-1.0 / step.dt)?;
        self.bulk.force(step, &self.zero, &self.work, &mut self.load)?;
        self.load.scale(-1.0)?;
        self.solvers[0].factor.solve(&self.load, &mut self.free)?;
        let values = self.free.view()?;
        for (pair, &row) in self.face.chunks_exact_mut(2).zip(&self.rows) {
            pair.copy_from_slice(&values[row..row + 2]);
        }
        Ok(self.solvers[0].compliance.largest())
    }

    fn solver(&mut self, dt: f64) -> Result<Solver> {
        self.bulk.tangent(dt, &mut self.tangent)?;
        let (factor, compliance) = match &self.source {
            Source::Schur => {
                let (factor, inverse) = Cholesky::with_inverse_schur(&self.tangent, &self.kept)?;
                (factor, Compliance::from_free(&self.body, &inverse))
            }
            Source::Periodic(column) => {
                let cells = column.stiffness(&self.bulk.secants(dt));
                (Cholesky::new(&self.tangent)?, Compliance::of_periodic_columns(&cells, column.columns))
            }
        };
        Ok(Solver { dt, factor, compliance })
    }

    /// u = A^-1 (b - P R), and the arms with it.
    fn commit(&mut self, step: Step, residual: &Residual) -> Result<()> {
        let mut load = self.load.view_mut()?;
        for (force, &row) in residual.iter().zip(&self.rows) {
            load[row] -= force.x;
            load[row + 1] -= force.y;
        }
        drop(load);
        self.solvers[0].factor.solve(&self.load, &mut self.u)?;
        self.bulk.commit(step, &self.u)
    }

    fn save(&self, snapshot: &mut Snapshot) -> Result<()> {
        let mut order = self.body.natural_order(&self.u)?;
        order.save("body", &self.u, snapshot)?;
        self.bulk.save(&mut order, snapshot)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let order = self.body.natural_order(&self.u)?;
        order.restore("body", &mut self.u, snapshot)?;
        self.bulk.restore(&order, snapshot, &self.u)
    }

    fn fields(&mut self) -> Result<BulkFields> {
        let Self { bulk, body, u, .. } = self;
        let mut effective = Vec::new();
        bulk.effective(u, |y| {
            effective.push(body.around(y)?);
            Ok(())
        })?;
        body.fields(u, &effective)
    }
}
