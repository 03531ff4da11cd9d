//! A body with memory of any shape: by a sparse factorisation, or multigrid, two solves per step beside the products with C.

use std::cell::Cell;
use std::rc::Rc;

use super::super::body::Body;
use super::super::{BulkFields, Work};
use super::applied::Means;
use super::bulk_memory::{Interior, Solvers};
use super::compliance::Compliance;
use crate::bulk::Bulk;
use crate::energy::BodyEnergy;
use crate::error::{Error, Result};
use crate::petsc::{Accuracy, Cholesky, Matrix, Step, Vector};
use crate::snapshot::Snapshot;

/// The whole body, on the one rank that solves it.
pub struct Sparse<const D: usize> {
    bulk: Bulk,
    body: Body<D>,
    rows: FaceRows<D>,
    kept: Vec<i32>,
    means: Means,
    tangent: Matrix,
    /// The accepted displacements, m.
    u: Vector,
    solvers: Solvers<Solver<D>>,
    load: Vector,
    free: Vector,
    /// u_free, per component of the face.
    face: Vec<f64>,
    zero: Vector,
    work: Vector,
    done: Work,
    /// Solves so far.
    solves: Rc<Cell<usize>>,
}

/// A at one step length.
struct Solver<const D: usize> {
    /// None where C is known by its products: then these have the inverse.
    factor: Option<Cholesky>,
    compliance: Compliance<D>,
}

impl<const D: usize> Solver<D> {
    fn new(body: &Body<D>, tangent: &Matrix, kept: &[i32], counted: (Means, Rc<Cell<usize>>)) -> Result<Self> {
        if counted.0 != Means::Dense {
            return Ok(Self { factor: None, compliance: Compliance::by_solves(body, tangent, counted)? });
        }
        let (factor, inverse) = Cholesky::with_inverse_schur(tangent, kept)?;
        Ok(Self { factor: Some(factor), compliance: Compliance::from_free(body, &inverse) })
    }

    /// u = A^-1 b
    fn solve(&self, b: &Vector, u: &mut Vector, solves: &Cell<usize>) -> Result<()> {
        match (&self.factor, self.compliance.applied()) {
            (Some(factor), _) => {
                solves.set(solves.get() + 1);
                factor.solve(b, u)
            }
            (None, Some(applied)) => applied.solve(b, u, Accuracy::Whole),
            (None, None) => Err(unprepared()),
        }
    }
}

impl<const D: usize> Sparse<D> {
    /// At rest; both made for this rank alone.
    pub fn new(bulk: Bulk, body: Body<D>, means: Means) -> Result<Self> {
        let rows = FaceRows::new(&body);
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
            done: Work::default(),
            solves: Rc::default(),
            face: vec![0.0; rows.components()],
            solvers: Solvers::new(),
            bulk,
            rows,
            kept,
            means,
            tangent,
            body,
        })
    }
}

impl<const D: usize> Interior<D> for Sparse<D> {
    fn prepare(&mut self, step: Step) -> Result<()> {
        let Self { solvers, bulk, tangent, kept, means, body, done, solves, .. } = self;
        solvers.select(step.dt, || {
            done.factorisations += 1;
            bulk.tangent(step.dt, tangent)?;
            Solver::new(body, tangent, kept, (*means, solves.clone()))
        })?;
        // h_p is y_p at u = 0, where du/dt = -u_n / dt.
        self.work.copy_from(&self.u)?;
        self.work.scale(-1.0 / step.dt)?;
        self.bulk.force(step, &self.zero, &self.work, &mut self.load)?;
        self.load.scale(-1.0)?;
        self.solvers.current().ok_or_else(unprepared)?.solve(&self.load, &mut self.free, &self.solves)?;
        self.rows.take(&self.free, &mut self.face)
    }

    fn face(&self) -> &[f64] {
        &self.face
    }

    fn compliance(&self) -> Option<&Compliance<D>> {
        self.solvers.current().map(|solver| &solver.compliance)
    }

    fn work(&self) -> Work {
        Work { memory_fields: self.bulk.memory_vectors(), solves: self.solves.get(), ..self.done }
    }

    fn keep_account(&mut self) {
        self.bulk.keep_account();
    }

    fn energy(&self) -> Option<BodyEnergy> {
        self.bulk.energy()
    }

    /// u = A^-1 (b + P f), and the arms with it.
    fn commit(&mut self, step: Step, forces: &[f64]) -> Result<()> {
        self.rows.load(forces, &mut self.load)?;
        self.solvers.current().ok_or_else(unprepared)?.solve(&self.load, &mut self.u, &self.solves)?;
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
        self.body.fields_with_memory(&mut self.bulk, &self.u)
    }
}

/// Where the nodes of the face are among the unknowns of a body that one rank has whole.
pub struct FaceRows<const D: usize>(Vec<usize>);

impl<const D: usize> FaceRows<D> {
    /// The first row of each.
    pub fn new(body: &Body<D>) -> Self {
        let (mesh, numbering) = (body.mesh(), body.numbering());
        Self(mesh.face.unknown.iter().map(|&unknown| D * numbering.global[unknown as usize] as usize).collect())
    }

    /// How many components the face has.
    pub fn components(&self) -> usize {
        D * self.0.len()
    }

    /// face = what is the face's of a vector of the body.
    pub fn take(&self, whole: &Vector, face: &mut [f64]) -> Result<()> {
        let values = whole.view()?;
        for (node, &row) in face.chunks_exact_mut(D).zip(&self.0) {
            node.copy_from_slice(&values[row..][..D]);
        }
        Ok(())
    }

    /// load += P f, for forces on the nodes of the face.
    pub fn load(&self, forces: &[f64], load: &mut Vector) -> Result<()> {
        let mut load = load.view_mut()?;
        for (force, &row) in forces.chunks_exact(D).zip(&self.0) {
            load[row..].iter_mut().zip(force).for_each(|(load, force)| *load += force);
        }
        Ok(())
    }
}

/// A defect: nothing was factorised.
pub fn unprepared() -> Error {
    Error::Internal("no step was prepared".into())
}
