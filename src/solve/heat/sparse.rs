//! Heat in a body of any shape: one sparse factor per step length, one solve per step.

use mpi::topology::SimpleCommunicator;

use super::conductor::Conductor;
use super::{Heat, Medium};
use crate::error::Result;
use crate::mesh::{Mesh, Numbering, Source};
use crate::petsc::{Cholesky, Matrix, Pattern, Vector};
use crate::snapshot::Snapshot;
use crate::solve::body::{Cells, Solid};
use crate::solve::response::{Solvers, unprepared};

/// The body, one temperature to an unknown of its mesh.
pub struct SparseConductor {
    /// Which unknowns are held.
    held: Vec<bool>,
    /// Of each node of the face.
    face_unknowns: Vec<usize>,
    /// K without the rows and columns of what is held, and m on its diagonal.
    parts: [Matrix; 2],
    tangent: Matrix,
    /// m, J/m/K; also of what is held.
    capacity: Vec<f64>,
    /// The sum of K over the held rows, of each column that is not held.
    drain: Vec<f64>,
    /// Whether C_T is asked for, which has the whole face then.
    convects: bool,
    theta: Vector,
    load: Vector,
    solvers: Solvers<Solver>,
    face: Vec<f64>,
    /// The power of the source in what is held.
    past: f64,
}

/// m/dt + K at one step length.
struct Solver {
    factor: Cholesky,
    /// C_T between the nodes of the face that are not held, column after column; empty where nothing convects.
    compliance: Vec<f64>,
}

impl SparseConductor {
    /// On this rank alone.
    pub fn new<const D: usize>(solid: &Solid<D>, heat: &Heat) -> Result<Self> {
        let comm = SimpleCommunicator::self_comm();
        let cells = solid.cells();
        let numbering = Numbering::new(&comm, &cells.mesh)?;
        // One rank has them all in the order of the mesh.
        let held = if heat.base.is_some() {
            base(&solid.source, &cells.mesh)
        } else {
            vec![false; cells.mesh.unknown_nodes()]
        };
        let pattern = Pattern { block: 1, ..numbering.pattern(&cells.mesh) };
        let matrix = || Matrix::new(&comm, &pattern);
        let (mut parts, unknowns) = ([matrix()?, matrix()?], cells.mesh.unknown_nodes());
        let (mut capacity, mut drain) = (vec![0.0; unknowns], vec![0.0; unknowns]);
        for cell in 0..cells.mesh.cells.len() {
            add(&cells, (cell, &heat.media), &mut parts, (&mut capacity, &mut drain), &held)?;
        }
        let rows: Vec<i32> = (0..unknowns).filter(|&unknown| held[unknown]).map(|unknown| unknown as i32).collect();
        for (part, diagonal) in parts.iter_mut().zip([heat.media[0].conductivity, 0.0]) {
            part.assemble()?;
            part.fix(&rows, diagonal)?;
        }
        let mut tangent = parts[0].duplicate()?;
        tangent.declare_positive_definite()?;
        let face_unknowns: Vec<usize> = cells.mesh.face.unknown.iter().map(|&unknown| unknown as usize).collect();
        Ok(Self {
            theta: Vector::new(&comm, unknowns)?,
            load: Vector::new(&comm, unknowns)?,
            face: vec![0.0; face_unknowns.len()],
            solvers: Solvers::new(),
            past: 0.0,
            convects: heat.convection.is_some(),
            held,
            face_unknowns,
            parts,
            tangent,
            capacity,
            drain,
        })
    }

    /// The places on the face of its nodes that are not held.
    fn free(&self) -> impl Iterator<Item = usize> {
        (0..self.face_unknowns.len()).filter(|&node| !self.held[self.face_unknowns[node]])
    }

    fn over_free(&self, of: impl Fn(usize) -> f64) -> f64 {
        (0..self.held.len()).filter(|&unknown| !self.held[unknown]).map(of).sum()
    }
}

/// Adds a cell.
fn add<const D: usize>(
    cells: &Cells<D>,
    (cell, media): (usize, &[Medium]),
    parts: &mut [Matrix; 2],
    (capacity, drain): (&mut [f64], &mut [f64]),
    held: &[bool],
) -> Result<()> {
    let Medium { conductivity, capacity: holds } = media[usize::from(cells.mesh.regions[cell])];
    let unit = cells.conduction(cell);
    let unknowns = cells.mesh.cell_unknowns(cell);
    let corners: Vec<i32> = unknowns.corners().iter().map(|&unknown| unknown as i32).collect();
    let count = corners.len();
    let conductance: Vec<f64> = unit.conductance.iter().map(|k| conductivity * k).collect();
    let mut mass = vec![0.0; count * count];
    for (a, &row) in unknowns.corners().iter().enumerate() {
        mass[a * count + a] = holds * unit.capacity[a];
        capacity[row as usize] += holds * unit.capacity[a];
        for (b, &column) in unknowns.corners().iter().enumerate().filter(|(_, column)| !held[**column as usize]) {
            drain[column as usize] += if held[row as usize] { conductance[a * count + b] } else { 0.0 };
        }
    }
    parts[0].add_blocks(&corners, &conductance)?;
    parts[1].add_blocks(&corners, &mass)
}

/// Which unknowns are of the base: the lower face of a layer; of a mesh what is held whole along a side of a cell.
fn base<const D: usize>(source: &Source<D>, mesh: &Mesh<D>) -> Vec<bool> {
    let mut base = vec![false; mesh.unknown_nodes()];
    if let Source::Layer(layer) = source {
        base.iter_mut().skip(layer.rows).step_by(layer.rows + 1).for_each(|base| *base = true);
        return base;
    }
    for cell in 0..mesh.cells.len() {
        for side in mesh.cell_unknowns(cell).sides() {
            if side.iter().all(|&unknown| mesh.held[unknown as usize] == [true; D]) {
                side.iter().for_each(|&unknown| base[unknown as usize] = true);
            }
        }
    }
    base
}

impl Conductor for SparseConductor {
    fn begin(&mut self, theta: f64) {
        // Of a vector that this rank holds whole.
        if let Ok(mut all) = self.theta.view_mut() {
            all.iter_mut().zip(&self.held).for_each(|(place, held)| *place = if *held { 0.0 } else { theta });
        }
    }

    fn prepare(&mut self, dt: f64, source: Option<&[f64]>) -> Result<()> {
        let kept: Vec<i32> = match self.convects {
            true => self.free().map(|node| self.face_unknowns[node] as i32).collect(),
            false => Vec::new(),
        };
        let Self { solvers, parts: [conductance, mass], tangent, .. } = self;
        solvers.select(dt, || {
            tangent.copy_from(conductance)?;
            tangent.add(1.0 / dt, mass)?;
            let (factor, compliance) = match kept.is_empty() {
                true => (Cholesky::new(tangent)?, Vec::new()),
                false => Cholesky::with_inverse_schur(tangent, &kept)?,
            };
            Ok(Solver { factor, compliance })
        })?;
        let (mut load, theta) = (self.load.view_mut()?, self.theta.view()?);
        for (unknown, load) in load.iter_mut().enumerate() {
            let more = source.map_or(0.0, |source| source[unknown]);
            *load = if self.held[unknown] { 0.0 } else { self.capacity[unknown] / dt * theta[unknown] + more };
        }
        drop((load, theta));
        self.past =
            source.map_or(0.0, |source| source.iter().zip(&self.held).filter(|(_, held)| **held).map(|(s, _)| s).sum());
        if self.convects {
            let mut free = self.load.like()?;
            self.solvers.current().ok_or_else(unprepared)?.factor.solve(&self.load, &mut free)?;
            let values = free.view()?;
            self.face = self.face_unknowns.iter().map(|&unknown| values[unknown]).collect();
        }
        Ok(())
    }

    fn face(&self) -> &[f64] {
        &self.face
    }

    fn answer(&self, power: &[f64]) -> Result<Vec<f64>> {
        let compliance = &self.solvers.current().ok_or_else(unprepared)?.compliance;
        let places: Vec<usize> = self.free().collect();
        let mut theta = vec![0.0; power.len()];
        for (column, values) in places.iter().zip(compliance.chunks_exact(places.len().max(1))) {
            for (&row, value) in places.iter().zip(values).filter(|_| power[*column] != 0.0) {
                theta[row] += value * power[*column];
            }
        }
        Ok(theta)
    }

    fn commit(&mut self, power: &[f64]) -> Result<f64> {
        let places: Vec<usize> = self.free().collect();
        let mut load = self.load.view_mut()?;
        places.iter().for_each(|&node| load[self.face_unknowns[node]] += power[node]);
        drop(load);
        self.solvers.current().ok_or_else(unprepared)?.factor.solve(&self.load, &mut self.theta)?;
        let theta = self.theta.view()?;
        // What enters where the face itself is held goes out there.
        let past: f64 =
            (0..power.len()).filter(|&node| self.held[self.face_unknowns[node]]).map(|node| power[node]).sum();
        Ok(self.past + past - self.drain.iter().zip(theta.iter()).map(|(drain, theta)| drain * theta).sum::<f64>())
    }

    fn raise(&mut self, theta: f64) -> Result<()> {
        self.theta.view_mut()?.iter_mut().for_each(|place| *place += theta);
        Ok(())
    }

    fn field(&self) -> Result<Vec<f64>> {
        Ok(self.theta.view()?.to_vec())
    }

    fn content(&self) -> f64 {
        self.theta.view().map_or(f64::NAN, |theta| self.over_free(|unknown| self.capacity[unknown] * theta[unknown]))
    }

    fn capacity(&self) -> f64 {
        self.over_free(|unknown| self.capacity[unknown])
    }

    fn whole(&self) -> f64 {
        self.capacity.iter().sum()
    }

    fn save(&self, snapshot: &mut Snapshot) -> Result<()> {
        snapshot.put("heat-field", self.field()?);
        Ok(())
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let mut all = self.theta.view_mut()?;
        snapshot.fill("heat-field", &mut all)
    }
}
