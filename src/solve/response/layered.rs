//! A periodic layer with memory: by wavenumber, without any sparse matrix. One sweep through the depth before Newton's
//! method and one back after it are a step's only solve.

use mpi::topology::SimpleCommunicator;

use super::super::body::{Body, Region, Solid};
use super::super::{BulkFields, Work};
use super::compliance::Compliance;
use super::remembering::{Inside, Solvers};
use super::sparse::unprepared;
use super::waves::{Elimination, Operator, Transform, Wave};
use crate::bulk::{Account, Products, Series};
use crate::element::plane::Split;
use crate::energy::BodyEnergy;
use crate::error::Result;
use crate::mesh::Cell;
use crate::petsc::{Step, Vector};
use crate::rheology::{Factors, Memory};
use crate::snapshot::Snapshot;

/// One column of a periodic layer.
pub struct PeriodicColumn {
    /// Its cells, from the top down.
    cells: Vec<(Split<8>, Region)>,
    /// How many such columns there are.
    columns: usize,
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

    /// The stiffness with each part of the bulk times its factor.
    fn operator(&self, factors: &[f64]) -> Operator {
        let with = |(split, region): &(Split<8>, Region)| {
            let relaxed = region.relaxed(factors);
            split.with(relaxed.shear, relaxed.bulk)
        };
        Operator::new(&self.cells.iter().map(with).collect::<Vec<_>>(), self.columns)
    }

    /// At the instantaneous moduli, of a bulk of one part.
    fn elimination(&self) -> Result<Elimination> {
        Elimination::new(&self.operator(&[1.0]))
    }

    /// The compliance of the face at the instantaneous moduli, of a bulk of one part.
    pub fn compliance(&self) -> Result<Compliance> {
        Compliance::of_periodic_layer(&self.elimination()?, self.columns)
    }
}

/// An unloaded periodic layer below its face, of a bulk of one part.
pub struct Below {
    elimination: Elimination,
    transform: Transform,
}

impl Below {
    /// The layer of these columns.
    pub fn new(column: &PeriodicColumn) -> Result<Self> {
        Ok(Self { elimination: column.elimination()?, transform: Transform::new(column.columns) })
    }

    /// The displacements of the layer on this rank, for x, z of each face node.
    pub fn extend(&self, face: &[f64], body: &Body) -> Result<Vector> {
        vector(&self.elimination.below(&self.transform.forward(face)?), &self.transform, body)
    }
}

/// Waves as a vector of the body, of which each rank takes its own part.
fn vector(waves: &[Wave], transform: &Transform, body: &Body) -> Result<Vector> {
    let rows = waves.len() / transform.waves();
    let numbering = body.numbering();
    let mut vector = body.vector()?;
    let mut values = vector.view_mut()?;
    for row in 0..rows {
        let of_row = transform.inverse(waves.iter().skip(row).step_by(rows))?;
        for (column, pair) in of_row.chunks_exact(2).enumerate() {
            // Nodes run column by column, downward in each, with the clamped one last.
            if let Some(local) = numbering.local((column * (rows + 1) + row) as u32) {
                values[2 * local..2 * local + 2].copy_from_slice(pair);
            }
        }
    }
    drop(values);
    Ok(vector)
}

/// How the parts of a body relax.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxations {
    /// The relaxation times of all arms, s.
    pub times: Vec<f64>,
    /// The update of the arms.
    pub rule: Memory,
    /// Per part; none = elastic.
    pub series: Vec<Option<Series>>,
}

impl Relaxations {
    fn factors(&self, dt: f64) -> Vec<Factors> {
        self.times.iter().map(|time| self.rule.factors(dt / time)).collect()
    }
}

/// The whole layer, on the one rank that solves it. Its fields are waves.
pub struct Layered {
    /// For output.
    solid: Solid,
    body: Option<Body>,
    columns: usize,
    rows: usize,
    relaxations: Relaxations,
    parts: Vec<Operator>,
    transform: Transform,
    /// The accepted displacements, m.
    u: Vec<Wave>,
    /// The accepted elongations of the arms, m.
    elongations: Vec<Vec<Wave>>,
    solvers: Solvers<Solver>,
    /// The load of the step that was prepared, swept up to the face.
    swept: Vec<Wave>,
    work: Vec<Wave>,
    /// u_free, per component of the face.
    face: Vec<f64>,
    /// Only where it is asked for.
    account: Option<Account>,
}

/// A at one step length.
struct Solver {
    elimination: Elimination,
    compliance: Compliance,
}

impl Layered {
    /// At rest.
    pub fn new(solid: Solid, column: &PeriodicColumn, relaxations: Relaxations) -> Self {
        let count = relaxations.series.len();
        let alone = |part: usize| (0..count).map(|other| f64::from(u8::from(other == part))).collect::<Vec<f64>>();
        let parts = (0..count).map(|part| column.operator(&alone(part))).collect();
        let (columns, rows) = (column.columns, column.cells.len());
        let field = || vec![Wave::zeros(); (columns / 2 + 1) * rows];
        Self {
            solid,
            body: None,
            columns,
            rows,
            parts,
            transform: Transform::new(columns),
            u: field(),
            elongations: relaxations.times.iter().map(|_| field()).collect(),
            solvers: Solvers::new(),
            swept: field(),
            work: field(),
            face: vec![0.0; 2 * columns],
            relaxations,
            account: None,
        }
    }

    /// Takes the account to the end of a step that ends at the displacements `swept`.
    fn spend(&mut self, step: Step) {
        let Some(account) = &mut self.account else { return };
        let Relaxations { times, rule, series } = &self.relaxations;
        let of_step = |time: &f64| (rule.factors(step.dt / time), rule.losses(step.dt / time));
        let arms: Vec<_> = times.iter().map(of_step).collect();
        for ((work, new), old) in self.work.iter_mut().zip(&self.swept).zip(&self.u) {
            *work = new - old;
        }
        let elastic = Series { long_term: 1.0, weights: Vec::new() };
        for ((part, series), springs) in self.parts.iter().zip(series).zip(&mut account.parts) {
            // v = -K du, and so all products with it.
            let mut v = vec![Wave::zeros(); self.u.len()];
            part.subtract_product(&self.work, &mut v);
            let dot = |field: &[Wave]| -dot(field, &v, (self.columns, self.rows));
            let change = dot(&self.work);
            let products = Products {
                sum: change + 2.0 * dot(&self.u),
                change,
                arms: self.elongations.iter().map(|elongation| dot(elongation)).collect(),
            };
            account.dissipated += springs.advance(series.as_ref().unwrap_or(&elastic), &products, &arms);
        }
    }

    /// work = `displacement` u + sum_i `weights`_i z_i
    fn combine(&mut self, displacement: f64, weights: impl Iterator<Item = f64>) {
        self.work.iter_mut().zip(&self.u).for_each(|(work, u)| *work = u * displacement);
        for (weight, elongation) in weights.zip(&self.elongations).filter(|(weight, _)| *weight != 0.0) {
            self.work.iter_mut().zip(elongation).for_each(|(work, z)| *work += z * weight);
        }
    }
}

impl Inside for Layered {
    fn prepare(&mut self, step: Step) -> Result<()> {
        let factors = self.relaxations.factors(step.dt);
        let Self { relaxations, parts, columns, solvers, .. } = self;
        solvers.select(step.dt, || {
            let secant = |series: &Option<Series>| series.as_ref().map_or(1.0, |series| series.secant(&factors));
            let secants: Vec<f64> = relaxations.series.iter().map(secant).collect();
            let elimination = Elimination::new(&Operator::sum(parts, &secants))?;
            Ok(Solver { compliance: Compliance::of_periodic_layer(&elimination, *columns)?, elimination })
        })?;
        self.swept.fill(Wave::zeros());
        for part in 0..self.parts.len() {
            if let Some(series) = self.relaxations.series[part].clone() {
                // h_p is y_p at u = 0.
                let decayed = series.weights.iter().zip(&factors).map(|(weight, factor)| weight * factor.decay);
                self.combine(-series.gain(&factors), decayed);
                self.parts[part].subtract_product(&self.work, &mut self.swept);
            }
        }
        let elimination = &self.solvers.current().ok_or_else(unprepared)?.elimination;
        elimination.sweep(&mut self.swept);
        self.face = self.transform.inverse(elimination.at_face(&self.swept).iter())?;
        Ok(())
    }

    fn face(&self) -> &[f64] {
        &self.face
    }

    fn compliance(&self) -> Option<&Compliance> {
        self.solvers.current().map(|solver| &solver.compliance)
    }

    fn work(&self) -> Work {
        Work { memory_fields: self.elongations.len(), ..Work::default() }
    }

    fn keep_account(&mut self) {
        let arms = self.relaxations.series.iter().map(|series| series.as_ref().map_or(0, |_| self.elongations.len()));
        self.account = Some(Account::new(arms));
    }

    fn energy(&self) -> Option<BodyEnergy> {
        self.account.as_ref().map(Account::energy)
    }

    fn commit(&mut self, step: Step, forces: &[f64]) -> Result<()> {
        for (swept, force) in self.swept.iter_mut().step_by(self.rows).zip(self.transform.forward(forces)?) {
            *swept += force;
        }
        self.solvers.current().ok_or_else(unprepared)?.elimination.complete(&mut self.swept);
        self.spend(step);
        for (elongation, factor) in self.elongations.iter_mut().zip(self.relaxations.factors(step.dt)) {
            for ((z, new), old) in elongation.iter_mut().zip(&self.swept).zip(&self.u) {
                *z = *z * factor.decay + (new - old) * factor.gain;
            }
        }
        std::mem::swap(&mut self.u, &mut self.swept);
        Ok(())
    }

    fn save(&self, snapshot: &mut Snapshot) -> Result<()> {
        if let Some(account) = &self.account {
            account.save(snapshot);
        }
        let flat = |waves: &[Wave]| waves.iter().flat_map(|wave| wave.as_slice()).copied().collect();
        snapshot.put("waves", flat(&self.u));
        for (index, elongation) in self.elongations.iter().enumerate() {
            snapshot.put(format!("waves-arm-{index}"), flat(elongation));
        }
        Ok(())
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        if let Some(account) = &mut self.account {
            account.restore(snapshot)?;
        }
        let names = std::iter::once("waves".to_owned()).chain((0..).map(|index| format!("waves-arm-{index}")));
        for (name, waves) in names.zip(std::iter::once(&mut self.u).chain(&mut self.elongations)) {
            let mut flat = vec![0.0; 4 * waves.len()];
            snapshot.fill(&name, &mut flat)?;
            for (wave, values) in waves.iter_mut().zip(flat.chunks_exact(4)) {
                wave.copy_from_slice(values);
            }
        }
        Ok(())
    }

    fn fields(&mut self) -> Result<BulkFields> {
        let mut body = match self.body.take() {
            Some(body) => body,
            None => Body::new(SimpleCommunicator::self_comm(), self.solid.clone())?,
        };
        self.combine(1.0, std::iter::empty());
        let u = vector(&self.work, &self.transform, &body)?;
        let mut effective = Vec::new();
        for series in self.relaxations.series.clone() {
            match series {
                Some(series) => self.combine(series.long_term, series.weights.into_iter()),
                None => self.combine(1.0, std::iter::empty()),
            }
            effective.push(body.around(&vector(&self.work, &self.transform, &body)?)?);
        }
        let fields = body.fields(&u, &effective);
        self.body = Some(body);
        fields
    }
}

/// The sum over all nodes of the product of two fields.
fn dot(a: &[Wave], b: &[Wave], (columns, rows): (usize, usize)) -> f64 {
    let waves = a.chunks_exact(rows).zip(b.chunks_exact(rows)).enumerate();
    let of_wave = |(k, (a, b)): (usize, (&[Wave], &[Wave]))| {
        let twice = if k == 0 || 2 * k == columns { 1.0 } else { 2.0 };
        twice * a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>()
    };
    waves.map(of_wave).sum::<f64>() / columns as f64
}
