//! Heat in a periodic layer, by wave vectors: a tridiagonal chain through the depth for each, as of the mechanics
//! ([`crate::solve::PeriodicColumn`]), with one component.

use nalgebra::SMatrix;

use super::Medium;
use super::conductor::Conductor;
use crate::element::solid::Blocks;
use crate::error::Result;
use crate::snapshot::Snapshot;
use crate::solve::body::Solid;
use crate::solve::response::{Compliance, Elimination, Kernel, Operator, Solvers, Transform, Wave, unprepared};

/// The layer, as waves.
pub struct LayeredConductor {
    transform: Transform<1>,
    /// Rows of nodes that are not held.
    rows: usize,
    /// Of nodes in the mesh.
    all_rows: usize,
    /// K, and m.
    parts: [Operator<1>; 2],
    /// m of each row of one column, the lowest last, J/m/K.
    capacity: Vec<f64>,
    /// K between the lowest free row and a held base, over a column; 0 without.
    drain: f64,
    /// The accepted theta, K.
    theta: Vec<Wave<1>>,
    solvers: Solvers<Solver>,
    /// The load of the step that was prepared, swept up to the face.
    swept: Vec<Wave<1>>,
    /// theta_free
    face: Vec<f64>,
    /// The power of the source in a held base.
    past: f64,
}

/// m/dt + K at one step length.
struct Solver {
    elimination: Elimination<1>,
    compliance: Compliance<1>,
}

impl LayeredConductor {
    /// Of a layer that repeats in all directions of its face, of so much in each region; none of any other body.
    pub fn new<const D: usize>(solid: &Solid<D>, media: &[Medium], held: bool) -> Result<Option<Self>> {
        let Some((column, counts)) = solid.column() else { return Ok(None) };
        let transform = Transform::new(&counts);
        let cells = column.mesh.cells.len();
        let (mut conductances, mut capacities): (Vec<Blocks<1>>, Vec<Blocks<1>>) = (Vec::new(), Vec::new());
        let mut capacity = vec![0.0; cells + 1];
        let mut drain = 0.0;
        for cell in 0..cells {
            let Medium { conductivity, capacity: holds } = media[usize::from(column.mesh.regions[cell])];
            let unit = column.conduction(cell);
            let corners = unit.capacity.len();
            // The lower side comes first (crate::element::Multilinear).
            let lower = |corner: usize| 2 * corner < corners;
            for (corner, unit) in unit.capacity.iter().enumerate() {
                capacity[cell + usize::from(lower(corner))] += holds * unit;
            }
            let between = |i: usize| lower(i / corners) && !lower(i % corners);
            drain = (0..corners * corners).filter(|i| between(*i)).map(|i| conductivity * unit.conductance[i]).sum();
            let block = |value: f64| SMatrix::<f64, 1, 1>::new(value);
            conductances.push(unit.conductance.iter().map(|k| block(conductivity * k)).collect());
            let on_diagonal =
                |i: usize| if i / corners == i % corners { holds * unit.capacity[i % corners] } else { 0.0 };
            capacities.push((0..corners * corners).map(|i| block(on_diagonal(i))).collect());
        }
        let operator = |cells: &[Blocks<1>]| match held {
            true => Operator::new(cells, &transform),
            false => Operator::with_free_base(cells, &transform),
        };
        let parts = [operator(&conductances), operator(&capacities)];
        let rows = parts[0].rows();
        let field = || vec![Wave::zeros(); transform.waves() * rows];
        Ok(Some(Self {
            rows,
            all_rows: cells + 1,
            parts,
            capacity,
            drain: if held { drain } else { 0.0 },
            theta: field(),
            solvers: Solvers::new(),
            swept: field(),
            face: vec![0.0; transform.nodes()],
            past: 0.0,
            transform,
        }))
    }

    /// The sum over the nodes of a row of theta, K.
    fn sum(&self, row: usize) -> f64 {
        self.theta[row][(0, 0)]
    }

    fn columns(&self) -> f64 {
        self.transform.nodes() as f64
    }
}

impl Conductor for LayeredConductor {
    fn begin(&mut self, theta: f64) {
        self.theta.fill(Wave::zeros());
        let uniform = theta * self.columns();
        self.theta[..self.rows].iter_mut().for_each(|wave| wave[(0, 0)] = uniform);
    }

    fn prepare(&mut self, dt: f64, source: Option<&[f64]>) -> Result<()> {
        let Self { parts, transform, solvers, .. } = self;
        solvers.select(dt, || {
            let elimination = Elimination::of_rows_that_hold(&Operator::sum(parts, &[1.0, 1.0 / dt]))?;
            let kernel = Kernel::new(elimination.face());
            Ok(Solver { compliance: Compliance::of_periodic_layer(transform.clone(), kernel), elimination })
        })?;
        let rates: Vec<f64> = self.capacity.iter().map(|m| m / dt).collect();
        for (swept, theta) in self.swept.chunks_exact_mut(self.rows).zip(self.theta.chunks_exact(self.rows)) {
            swept.iter_mut().zip(theta).zip(&rates).for_each(|((swept, theta), rate)| *swept = theta * *rate);
        }
        for row in 0..source.map_or(0, |_| self.rows) {
            let of_row: Vec<f64> =
                source.iter().flat_map(|s| s.iter().skip(row).step_by(self.all_rows)).copied().collect();
            for (swept, wave) in
                self.swept.iter_mut().skip(row).step_by(self.rows).zip(self.transform.forward(&of_row)?)
            {
                *swept += wave;
            }
        }
        let held = if self.rows < self.all_rows { self.rows } else { usize::MAX };
        self.past = source.map_or(0.0, |s| s.iter().skip(held).step_by(self.all_rows).sum());
        let elimination = &self.solvers.current().ok_or_else(unprepared)?.elimination;
        elimination.sweep(&mut self.swept);
        let at_face = elimination.at_face(&self.swept);
        self.face = self.transform.inverse(|wave| &at_face[wave])?;
        Ok(())
    }

    fn face(&self) -> &[f64] {
        &self.face
    }

    fn answer(&self, power: &[f64]) -> Result<Vec<f64>> {
        let mut theta = vec![0.0; power.len()];
        let compliance = &self.solvers.current().ok_or_else(unprepared)?.compliance;
        compliance.add_displacements(power.iter().copied().enumerate(), &mut theta, 0..1)?;
        Ok(theta)
    }

    fn commit(&mut self, power: &[f64]) -> Result<f64> {
        for (swept, wave) in self.swept.iter_mut().step_by(self.rows).zip(self.transform.forward(power)?) {
            *swept += wave;
        }
        self.solvers.current().ok_or_else(unprepared)?.elimination.complete(&mut self.swept);
        std::mem::swap(&mut self.theta, &mut self.swept);
        Ok(self.past - self.drain * self.sum(self.rows - 1))
    }

    fn raise(&mut self, theta: f64) -> Result<()> {
        let uniform = theta * self.columns();
        self.theta[..self.rows].iter_mut().for_each(|wave| wave[(0, 0)] += uniform);
        Ok(())
    }

    fn field(&self) -> Result<Vec<f64>> {
        let mut field = vec![0.0; self.all_rows * self.transform.nodes()];
        for row in 0..self.rows {
            let of_row = self.transform.inverse(|wave| &self.theta[wave * self.rows + row])?;
            field.iter_mut().skip(row).step_by(self.all_rows).zip(of_row).for_each(|(place, theta)| *place = theta);
        }
        Ok(field)
    }

    fn content(&self) -> f64 {
        (0..self.rows).map(|row| self.capacity[row] * self.sum(row)).sum()
    }

    fn capacity(&self) -> f64 {
        self.columns() * self.capacity[..self.rows].iter().sum::<f64>()
    }

    fn whole(&self) -> f64 {
        self.columns() * self.capacity.iter().sum::<f64>()
    }

    fn save(&self, snapshot: &mut Snapshot) -> Result<()> {
        snapshot.put("heat-waves", self.theta.iter().flat_map(|wave| wave.as_slice()).copied().collect());
        Ok(())
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let mut flat = vec![0.0; 2 * self.theta.len()];
        snapshot.fill("heat-waves", &mut flat)?;
        self.theta.iter_mut().zip(flat.chunks_exact(2)).for_each(|(wave, values)| wave.copy_from_slice(values));
        Ok(())
    }
}
