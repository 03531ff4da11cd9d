//! A body whose arms follow the temperature of their cells: one assembly and one sparse factorisation whenever that changes.
//!
//! ```text
//! A u = b + P f,   A = sum over cells and moduli of M_c c_p,c K_c,   b = -sum of M_c K_c h_p,c
//! c_p,c = mu_0p + sum_i mu_ip gain_i,c,     h_p,c = sum_i mu_ip (decay_i,c z_i,c - gain_i,c u_n)
//! ```
//!
//! with the factors of each cell's own times a_T(T_c) tau_i; see [`CellArms`]. T_c is that of the accepted state, so that a step is as
//! linear as without heat.

mod cells;

use super::super::body::{Body, Solid};
use super::super::{BulkFields, Tempered, Work};
use super::bulk_memory::Interior;
use super::compliance::Compliance;
use super::layered::Relaxations;
use super::sparse::{FaceRows, unprepared};
use crate::element::solid::row_major;
use crate::energy::BodyEnergy;
use crate::error::Result;
use crate::petsc::{Cholesky, Matrix, Step, Vector};
use crate::rheology::shift::Shift;
use crate::snapshot::Snapshot;
use cells::CellArms;

/// The whole body, on the one rank that solves it.
pub struct Coupled<const D: usize> {
    arms: CellArms<D>,
    body: Body<D>,
    rows: FaceRows<D>,
    kept: Vec<i32>,
    held: Vec<i32>,
    tangent: Matrix,
    /// The accepted displacements, m.
    u: Vector,
    /// For the temperatures as they are.
    solver: Option<Solver<D>>,
    load: Vector,
    free: Vector,
    /// u_free, per component of the face.
    face: Vec<f64>,
    done: Work,
}

/// A at one step length.
struct Solver<const D: usize> {
    dt: f64,
    factor: Cholesky,
    compliance: Compliance<D>,
}

impl<const D: usize> Coupled<D> {
    /// At rest, made for this rank alone; `shifts` of each region, from the temperature that its times are those of.
    pub fn new(solid: &Solid<D>, body: Body<D>, relaxations: Relaxations, shifts: Vec<Option<Shift>>) -> Result<Self> {
        let rows = FaceRows::new(&body);
        let kept = Compliance::free_rows(&body).into_iter().map(|(_, row)| row).collect();
        let mut tangent = body.elastic()?;
        tangent.declare_positive_definite()?;
        Ok(Self {
            arms: CellArms::new(&solid.source, body.cells(), relaxations, shifts),
            u: body.vector()?,
            load: body.vector()?,
            free: body.vector()?,
            face: vec![0.0; rows.components()],
            held: body.held(),
            solver: None,
            done: Work::default(),
            rows,
            kept,
            tangent,
            body,
        })
    }

    /// A, factorised, at this step length.
    fn factorise(&mut self, dt: f64) -> Result<Solver<D>> {
        self.done.factorisations += 1;
        self.tangent.scale(0.0)?;
        for cell in 0..self.body.mesh().cells.len() {
            let corners = self.arms.corners(cell);
            self.tangent.add_blocks(corners, &row_major(&self.arms.tangent(self.body.cells(), cell, dt)))?;
        }
        self.tangent.assemble()?;
        self.tangent.fix(&self.held, self.body.cells().diagonal())?;
        let (factor, inverse) = Cholesky::with_inverse_schur(&self.tangent, &self.kept)?;
        Ok(Solver { dt, factor, compliance: Compliance::from_free(&self.body, &inverse) })
    }
}

impl<const D: usize> Interior<D> for Coupled<D> {
    fn prepare(&mut self, step: Step) -> Result<()> {
        if self.solver.as_ref().is_none_or(|solver| solver.dt != step.dt) {
            // Frees the old one first.
            self.solver = None;
            self.solver = Some(self.factorise(step.dt)?);
        }
        let mut load = self.load.view_mut()?;
        load.fill(0.0);
        self.arms.past(self.body.cells(), step.dt, &self.u.view()?, &mut load);
        self.held.iter().for_each(|&row| load[row as usize] = 0.0);
        drop(load);
        self.solver.as_ref().ok_or_else(unprepared)?.factor.solve(&self.load, &mut self.free)?;
        self.done.solves += 1;
        self.rows.take(&self.free, &mut self.face)
    }

    fn face(&self) -> &[f64] {
        &self.face
    }

    fn compliance(&self) -> Option<&Compliance<D>> {
        self.solver.as_ref().map(|solver| &solver.compliance)
    }

    fn work(&self) -> Work {
        Work { memory_fields: self.arms.len(), ..self.done }
    }

    /// Which is there anyway.
    fn keep_account(&mut self) {}

    fn energy(&self) -> Option<BodyEnergy> {
        Some(self.arms.energy())
    }

    /// u = A^-1 (b + P f), and the arms with it.
    fn commit(&mut self, step: Step, forces: &[f64]) -> Result<()> {
        self.rows.load(forces, &mut self.load)?;
        self.solver.as_ref().ok_or_else(unprepared)?.factor.solve(&self.load, &mut self.free)?;
        self.done.solves += 1;
        self.arms.commit(self.body.cells(), step.dt, [&self.u.view()?, &self.free.view()?]);
        self.u.copy_from(&self.free)
    }

    fn tempered(&mut self) -> Option<&mut dyn Tempered> {
        Some(self)
    }

    fn save(&self, snapshot: &mut Snapshot) -> Result<()> {
        self.body.natural_order(&self.u)?.save("body", &self.u, snapshot)?;
        self.arms.save(snapshot);
        Ok(())
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.solver = None;
        self.body.natural_order(&self.u)?.restore("body", &mut self.u, snapshot)?;
        self.arms.restore(snapshot)
    }

    fn fields(&mut self) -> Result<BulkFields> {
        let Self { body, arms, u, .. } = self;
        let whole = u.view()?.to_vec();
        body.fields_by(u, |cell, _, part| arms.effective(cell, part, &whole))
    }
}

impl<const D: usize> Tempered for Coupled<D> {
    fn temper(&mut self, reference: f64, theta: &[f64]) -> f64 {
        let most = self.arms.temper(reference, theta);
        if most > 0.0 {
            self.solver = None;
        }
        most
    }

    fn spent(&self) -> &[f64] {
        self.arms.spent()
    }
}
