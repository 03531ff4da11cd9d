//! A periodic layer with memory: by wavenumber, without any sparse matrix. One sweep through the depth before Newton's
//! method and one back after it are a step's only solve.

use std::rc::Rc;

use mpi::topology::SimpleCommunicator;
use nalgebra::SMatrix;

use super::super::body::{Body, Region, Solid};
use super::super::{BulkFields, Work};
use super::bulk_memory::{Interior, Solvers};
use super::compliance::Compliance;
use super::kernel::Kernel;
use super::sparse::unprepared;
use super::transform::{Transform, Wave};
use super::waves::{Elimination, Operator, face_compliance};
use crate::bulk::{Account, Products, Series};
use crate::element::solid::{Blocks, Split};
use crate::energy::BodyEnergy;
use crate::error::Result;
use crate::parallel::Team;
use crate::petsc::{Step, Vector};
use crate::rheology::{Factors, Memory};
use crate::snapshot::Snapshot;

/// One column of a periodic layer.
pub struct PeriodicColumn<const D: usize> {
    /// Its cells, from the top down.
    cells: Vec<(Split<D>, Region)>,
    /// How many such columns there are along each axis of the face.
    counts: Vec<usize>,
}

impl<const D: usize> PeriodicColumn<D> {
    /// Of a layer that repeats in all directions of its face; none of any other body.
    pub fn new(solid: &Solid<D>) -> Option<Self> {
        let (column, counts) = solid.column()?;
        let cells = (0..column.mesh.cells.len()).map(|cell| (column.split(cell), column.region(cell)));
        Some(Self { cells: cells.collect(), counts })
    }

    /// The stiffness of its cells with each part of the bulk times its factor.
    fn stiffness(&self, factors: &[f64]) -> Vec<Blocks<D>> {
        let with = |(split, region): &(Split<D>, Region)| {
            let relaxed = region.relaxed(factors);
            split.with(relaxed.shear, relaxed.bulk)
        };
        self.cells.iter().map(with).collect()
    }

    /// The stiffness of each of `count` parts of the bulk by itself.
    pub fn parts(&self, count: usize, transform: &Transform<D>) -> Vec<Operator<D>> {
        let alone = |part: usize| (0..count).map(|other| f64::from(u8::from(other == part))).collect::<Vec<f64>>();
        (0..count).map(|part| Operator::new(&self.stiffness(&alone(part)), transform)).collect()
    }

    /// How many columns there are along each axis of the face.
    pub fn counts(&self) -> &[usize] {
        &self.counts
    }

    /// The transform of its face.
    pub fn transform(&self) -> Transform<D> {
        Transform::new(&self.counts)
    }

    /// The compliance of the face at the instantaneous moduli, of a bulk of one part, parted among the ranks of a team. Collective.
    pub fn compliance(&self, team: &Rc<Team>) -> Result<Compliance<D>> {
        let transform = Transform::among(&self.counts, team.clone());
        let kernel = Kernel::new(team.agree(self.waves(&transform))?.into_iter());
        Ok(Compliance::of_periodic_layer(transform, kernel))
    }

    /// That of each wave vector.
    pub fn waves(&self, transform: &Transform<D>) -> Result<Vec<SMatrix<f64, D, D>>> {
        face_compliance(&self.stiffness(&[1.0]), transform)
    }
}

/// An unloaded periodic layer below its face, of a bulk of one part.
pub struct Below<const D: usize> {
    elimination: Elimination<D>,
    rows: usize,
    transform: Transform<D>,
}

impl<const D: usize> Below<D> {
    /// The layer of these columns.
    pub fn new(column: &PeriodicColumn<D>) -> Result<Self> {
        let transform = column.transform();
        let operator = Operator::new(&column.stiffness(&[1.0]), &transform);
        Ok(Self { elimination: Elimination::new(&operator)?, rows: operator.rows(), transform })
    }

    /// The displacements of the layer on this rank, for those of each face node.
    pub fn extend(&self, face: &[f64], body: &Body<D>) -> Result<Vector> {
        let below = self.elimination.below(&self.transform.forward(face)?);
        let mut vector = body.vector()?;
        write((&below, self.rows), &self.transform, Some((body, &mut vector)))?;
        Ok(vector)
    }
}

/// Writes waves to a vector of the body, of which each rank takes its own part; where the waves are parted, the first rank has the body.
fn write<const D: usize>(
    (waves, rows): (&[Wave<D>], usize),
    transform: &Transform<D>,
    body: Option<(&Body<D>, &mut Vector)>,
) -> Result<()> {
    let mut to = body.map(|(body, vector)| Ok((body.numbering(), vector.view_mut()?))).transpose()?;
    for row in 0..rows {
        let of_row = transform.team().collected(transform.inverse(|wave| &waves[wave * rows + row])?);
        let Some((numbering, values)) = &mut to else { continue };
        for (column, node) in of_row.chunks_exact(D).enumerate() {
            // Nodes run column by column, downward in each, with the clamped one last.
            if let Some(local) = numbering.local((column * (rows + 1) + row) as u32) {
                values[D * local..][..D].copy_from_slice(node);
            }
        }
    }
    Ok(())
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

/// The whole layer on the one rank that solves it, or the waves of each of the ranks that share it. Its fields are waves.
pub struct Layered<const D: usize> {
    /// For output.
    solid: Solid<D>,
    body: Option<Body<D>>,
    rows: usize,
    relaxations: Relaxations,
    parts: Vec<Operator<D>>,
    transform: Transform<D>,
    /// The accepted displacements, m.
    u: Vec<Wave<D>>,
    /// The accepted elongations of the arms, m.
    elongations: Vec<Vec<Wave<D>>>,
    solvers: Solvers<Solver<D>>,
    /// The load of the step that was prepared, swept up to the face.
    swept: Vec<Wave<D>>,
    work: Vec<Wave<D>>,
    /// u_free, per component of the face.
    face: Vec<f64>,
    /// Only where it is asked for.
    account: Option<Account>,
}

/// A at one step length.
struct Solver<const D: usize> {
    elimination: Elimination<D>,
    compliance: Compliance<D>,
}

impl<const D: usize> Layered<D> {
    /// At rest, parted among the ranks of a team.
    pub fn new(solid: Solid<D>, column: &PeriodicColumn<D>, relaxations: Relaxations, team: &Rc<Team>) -> Self {
        let count = relaxations.series.len();
        let transform = Transform::among(column.counts(), team.clone());
        let parts = column.parts(count, &transform);
        let rows = column.cells.len();
        let field = || vec![Wave::zeros(); transform.waves() * rows];
        Self {
            solid,
            body: None,
            rows,
            parts,
            u: field(),
            elongations: relaxations.times.iter().map(|_| field()).collect(),
            solvers: Solvers::new(),
            swept: field(),
            work: field(),
            face: vec![0.0; D * transform.nodes_here()],
            relaxations,
            account: None,
            transform,
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
            let dot = |field: &[Wave<D>]| -dot(field, &v, &self.transform, self.rows);
            let change = dot(&self.work);
            let products = Products {
                sum: change + 2.0 * dot(&self.u),
                change,
                arms: self.elongations.iter().map(|elongation| dot(elongation)).collect(),
            };
            account.dissipated += springs.advance(series.as_ref().unwrap_or(&elastic), &products, &arms);
        }
    }

    /// `work` as a vector of the body, where it is. Collective.
    fn of_body(&self, body: Option<&Body<D>>) -> Result<Option<Vector>> {
        let mut vector = body.map(Body::vector).transpose()?;
        write((&self.work, self.rows), &self.transform, body.zip(vector.as_mut()))?;
        Ok(vector)
    }

    /// work = `displacement` u + sum_i `weights`_i z_i
    fn combine(&mut self, displacement: f64, weights: impl Iterator<Item = f64>) {
        self.work.iter_mut().zip(&self.u).for_each(|(work, u)| *work = u * displacement);
        for (weight, elongation) in weights.zip(&self.elongations).filter(|(weight, _)| *weight != 0.0) {
            self.work.iter_mut().zip(elongation).for_each(|(work, z)| *work += z * weight);
        }
    }
}

impl<const D: usize> Interior<D> for Layered<D> {
    fn prepare(&mut self, step: Step) -> Result<()> {
        let factors = self.relaxations.factors(step.dt);
        let Self { relaxations, parts, transform, solvers, .. } = self;
        let team = transform.team().clone();
        solvers.select(step.dt, || {
            let secant = |series: &Option<Series>| series.as_ref().map_or(1.0, |series| series.secant(&factors));
            let secants: Vec<f64> = relaxations.series.iter().map(secant).collect();
            let elimination = team.agree(Elimination::new(&Operator::sum(parts, &secants)))?;
            let kernel = Kernel::new(elimination.face());
            Ok(Solver { compliance: Compliance::of_periodic_layer(transform.clone(), kernel), elimination })
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
        let at_face = elimination.at_face(&self.swept);
        self.face = self.transform.inverse(|wave| &at_face[wave])?;
        Ok(())
    }

    fn face(&self) -> &[f64] {
        &self.face
    }

    fn compliance(&self) -> Option<&Compliance<D>> {
        self.solvers.current().map(|solver| &solver.compliance)
    }

    fn work(&self) -> Work {
        let transforms = self.transform.counted();
        Work { memory_fields: self.elongations.len(), transforms, ..Work::default() }
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
        let team = self.transform.team();
        let flat = |waves: &[Wave<D>]| team.collected(waves.iter().flat_map(|wave| wave.as_slice()).copied().collect());
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
            let mut flat = vec![0.0; 2 * D * waves.len()];
            let per_wave = 2 * D * self.rows;
            snapshot.fill_part(
                &name,
                per_wave * self.transform.first_wave(),
                per_wave * self.transform.all_waves(),
                &mut flat,
            )?;
            for (wave, values) in waves.iter_mut().zip(flat.chunks_exact(2 * D)) {
                wave.copy_from_slice(values);
            }
        }
        Ok(())
    }

    fn fields(&mut self) -> Result<BulkFields> {
        let team = self.transform.team().clone();
        let made = match self.body.take() {
            None if team.is_first() => Body::new(SimpleCommunicator::self_comm(), &self.solid).map(Some),
            body => Ok(body),
        };
        let mut body = team.agree(made)?;
        self.combine(1.0, std::iter::empty());
        let u = self.of_body(body.as_ref())?;
        let mut effective = Vec::new();
        for series in self.relaxations.series.clone() {
            match series {
                Some(series) => self.combine(series.long_term, series.weights.into_iter()),
                None => self.combine(1.0, std::iter::empty()),
            }
            effective.push(self.of_body(body.as_ref())?);
        }
        let fields = body.as_mut().zip(u).map_or(Ok(BulkFields::default()), |(body, u)| {
            let around =
                effective.iter().flatten().map(|effective| body.around(effective)).collect::<Result<Vec<_>>>()?;
            body.fields(&u, &around)
        });
        self.body = body;
        fields
    }
}

/// The sum over all nodes of the product of two fields.
fn dot<const D: usize>(a: &[Wave<D>], b: &[Wave<D>], transform: &Transform<D>, rows: usize) -> f64 {
    let waves = a.chunks_exact(rows).zip(b.chunks_exact(rows)).enumerate();
    let of_wave = |(k, (a, b)): (usize, (&[Wave<D>], &[Wave<D>]))| {
        transform.stands_for(k) * a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>()
    };
    let [sum] = transform.team().sum([waves.map(of_wave).sum::<f64>()]);
    sum / transform.nodes() as f64
}
