//! All unknowns at once: the reference strategy, which works for everything.

use nalgebra::{SMatrix, SVector};

use super::body::{Body, rows_of};
use super::condensed::LARGE_FACE;
use super::face::ContactFace;
use super::traction::{self, Behind, Held, Laws, Outcome};
use super::woodbury::Woodbury;
use super::{BulkFields, Contact, TransientProblem, Work};
use crate::bulk::Bulk;
use crate::energy::Energy;
use crate::error::Result;
use crate::interface::Interface;
use crate::loading::Phase;
use crate::petsc::{Gather, Matrix, Step, Vector, Verdict};
use crate::snapshot::Snapshot;

/// Bulk and interface in one sparse system: the residual is the force on every node.
pub struct Monolithic<const D: usize> {
    bulk: Bulk,
    body: Body<D>,
    face: ContactFace<D>,
    /// Per face node: its global node number, and its first local row where this rank owns it.
    rows: Vec<(i32, Option<usize>)>,
    base: Base<D>,
    inverse: Woodbury<D>,
    round_off: RoundOff,
    /// Whether stiff laws are met by the guess, for which `inverse` factorises the bulk.
    starts: bool,
    /// Whether the last guess met the laws.
    started: bool,
    /// Length of the step that the last tangent is for, s.
    dt: f64,
    tolerance: f64,
    /// How often bulk fields were asked for.
    recoveries: usize,
}

/// What the digits of the displacements leave of the bulk's forces.
struct RoundOff {
    /// The step length that `stiffness` is for, s.
    dt: f64,
    /// The diagonal of the bulk's tangent, N/m per m.
    stiffness: Vector,
    product: Vector,
    /// In the norm of the convergence test, N/m.
    force: f64,
}

/// The bulk tangent's blocks under the interface's own, at one step length: what the interface's are added to.
struct Base<const D: usize> {
    /// Not a number before the first tangent.
    dt: f64,
    diagonal: Vec<SMatrix<f64, D, D>>,
    /// Per pair of [`Interface::pairs`].
    coupling: Vec<SMatrix<f64, D, D>>,
}

impl<const D: usize> Monolithic<D> {
    /// At rest. `tolerance` is relative to the contact forces, on the residual norm.
    pub fn new(bulk: Bulk, body: Body<D>, interface: Interface<D>, layout: &Vector, tolerance: f64) -> Result<Self> {
        let (mesh, numbering) = (body.mesh(), body.numbering());
        let unknowns = &interface.face().unknown;
        let row = |&unknown: &u32| (numbering.global[unknown as usize], numbering.local(unknown).map(|node| D * node));
        let rows: Vec<_> = unknowns.iter().map(row).collect();
        let held: Vec<_> = unknowns.iter().map(|&unknown| mesh.held[unknown as usize]).collect();
        let indices = rows_of::<D>(rows.iter().map(|&(node, _)| node));
        let gather = Gather::new(layout, &indices)?;
        let components = rows
            .iter()
            .flat_map(|&(node, local)| (0..D).map(move |i| (D as i32 * node + i as i32, local.map(|row| row + i))));
        let inverse = Woodbury::new(body.comm(), components.collect(), held.as_flattened().to_vec(), layout)?;
        Ok(Self {
            face: ContactFace::new(interface, gather, rows.iter().map(|&(_, local)| local).collect(), &held),
            bulk,
            body,
            rows,
            base: Base { dt: f64::NAN, diagonal: Vec::new(), coupling: Vec::new() },
            inverse,
            round_off: RoundOff { dt: f64::NAN, stiffness: layout.like()?, product: layout.like()?, force: 0.0 },
            starts: false,
            started: false,
            dt: f64::NAN,
            tolerance,
            recoveries: 0,
        })
    }

    /// Lets guesses meet laws that are too stiff for Newton's method. That takes the factor of the bulk, so only where it is
    /// made for the linear systems anyway.
    pub fn starts_from_the_laws(&mut self) {
        self.starts = true;
    }

    /// Whether the laws are too stiff for Newton's method on displacements from where the face was: the penalty beside the body,
    /// or the way of the indenter in a step beside the slip over which friction turns.
    fn is_stiff(&mut self, step: Step) -> Result<bool> {
        const PENALTY: f64 = 1e2;
        const TURNS: f64 = 5.0;
        let placement = self.face.placement(step)?;
        let way = placement.sliding_rate.norm().max(placement.approach_rate.abs()) * step.dt;
        if self.face.interface().friction().is_some_and(|law| way > TURNS * law.sharpness(step.dt)) {
            return Ok(true);
        }
        self.round_off.prepare(&mut self.bulk, step.dt)?;
        let stiffness = self.face.gather(&self.round_off.stiffness)?;
        // At a node with its neighbours held, which is stiffer than the body.
        let softness = 1.0 / stiffness.into_iter().fold(f64::INFINITY, f64::min);
        Ok(self.face.interface().stiffest() * softness > PENALTY)
    }

    /// Makes `u`, the accepted state, a start at which the tractions meet the laws.
    fn start(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        let (mut load, mut change, mut accepted) = (u.like()?, u.like()?, u.like()?);
        accepted.copy_from(u)?;
        self.bulk.force(step, u, &change, &mut load)?;
        self.inverse.compliance(&self.bulk, step.dt, self.face.interface().face())?;
        self.inverse.solve_bulk(&load, &mut change)?;
        u.add(-1.0, &change)?;
        let free = self.face.gather(u)?;
        let Some((forces, displacements)) = self.settle(step, free)? else { return Ok(()) };
        load.set(0.0)?;
        self.on_face(&forces, &mut load)?;
        self.inverse.solve_bulk(&load, &mut change)?;
        u.add(1.0, &change)?;
        // What round-off in the factor left.
        let (mut rate, mut force) = (u.like()?, u.like()?);
        rate.copy_from(u)?;
        rate.combine(-1.0 / step.dt, &accepted, 1.0 / step.dt)?;
        self.bulk.force(step, u, &rate, &mut force)?;
        load.add(-1.0, &force)?;
        self.inverse.solve_bulk(&load, &mut change)?;
        u.add(1.0, &change)?;
        self.started = true;
        self.on_face(&displacements, u)
    }

    /// The forces on the nodes of the face and their displacements where the laws hold, on every rank. Collective.
    fn settle(&mut self, step: Step, free: Vec<f64>) -> Result<Option<(Vec<f64>, Vec<f64>)>> {
        let placement = self.face.placement(step)?;
        self.face.accepted.interface.place(placement)?;
        let interface = self.face.interface();
        let Some((compliance, secant)) = self.inverse.compliance(&self.bulk, step.dt, interface.face())? else {
            return Ok(None);
        };
        let behind = Behind { interface, compliance, secant };
        let sites = behind.sites(&self.face.accepted, placement, &free);
        let resolution = placement.resolution * step.dt;
        let laws = Laws {
            penalty: interface.penalty(),
            friction: interface.friction(),
            wear: None,
            dt: step.dt,
            resolution,
            held: Held::default(),
        };
        let normals = interface.points().all().iter().map(|point| point.normal);
        let tractions: Vec<SVector<f64, D>> =
            interface.states().iter().zip(normals).map(|(state, normal)| state.on_layer(&normal)).collect();
        let at_rest = behind.at_points(&free);
        let moved = |t: &[SVector<f64, D>]| -> Result<Vec<SVector<f64, D>>> {
            Ok(behind.moves(t)?.iter().zip(&at_rest).map(|(moved, free)| moved + free).collect())
        };
        let first = Outcome::new(&sites, tractions.clone(), (moved(&tractions)?, SVector::zeros()), laws);
        let operator: traction::Operator<'_, D> = (&|j, rows| behind.influence(j, rows), &|t| behind.moves(t));
        // To the last digits: what displacements make of the tractions is more than they are off.
        let outcome = traction::start(&sites, first, laws, operator, f64::EPSILON)?;
        let (mut displacements, forces) = behind.displaced(&outcome.met(&sites), &free)?;
        if let Some(penalty) = interface.penalty() {
            for (i, (site, answer)) in sites.iter().zip(&outcome.answers).enumerate().filter(|(_, (_, a))| a.active) {
                if let [(node, _)] = interface.points().shares(i) {
                    let motion = answer.motion(site, penalty);
                    displacements[D * node..][..D].copy_from_slice(motion.as_slice());
                }
            }
        }
        Ok(Some((forces, displacements)))
    }

    /// Sets the face's nodes in a vector of the body.
    fn on_face(&self, from: &[f64], to: &mut Vector) -> Result<()> {
        let mut values = to.view_mut()?;
        for (node, &(_, local)) in from.chunks_exact(D).zip(&self.rows) {
            if let Some(row) = local {
                values[row..][..D].copy_from_slice(node);
            }
        }
        Ok(())
    }
}

impl RoundOff {
    /// Makes `stiffness` hold for a step length.
    fn prepare(&mut self, bulk: &mut Bulk, dt: f64) -> Result<()> {
        if self.dt != dt {
            bulk.diagonal(dt, &mut self.stiffness)?;
            self.dt = dt;
        }
        Ok(())
    }

    /// Makes `force` hold for displacements: some units in the last place of each force that holds a node.
    fn take(&mut self, bulk: &mut Bulk, dt: f64, u: &Vector) -> Result<()> {
        self.prepare(bulk, dt)?;
        let (stiffness, u, mut product) = (self.stiffness.view()?, u.view()?, self.product.view_mut()?);
        for ((product, k), u) in product.iter_mut().zip(stiffness.iter()).zip(u.iter()) {
            *product = k * u;
        }
        drop(product);
        self.force = 8.0 * f64::EPSILON * self.product.norm()?;
        Ok(())
    }
}

impl<const D: usize> TransientProblem for Monolithic<D> {
    fn begin(&mut self, phase: Phase) -> Result<()> {
        self.face.accepted.begin(phase)
    }

    fn residual(&mut self, step: Step, u: &Vector, rate: &Vector, f: &mut Vector) -> Result<()> {
        self.face.try_residual(step, u)?;
        self.bulk.force(step, u, rate, f)?;
        self.round_off.take(&mut self.bulk, step.dt, u)?;
        self.face.add(self.face.residual.iter().copied().enumerate(), f)
    }

    fn tangent(&mut self, step: Step, u: &Vector, _rate: &Vector, tangent: &mut Matrix) -> Result<()> {
        self.face.try_tangent(step, u)?;
        let Self { face, rows, base, .. } = self;
        if base.dt != step.dt {
            self.bulk.tangent(step.dt, tangent)?;
            base.read(step.dt, rows, face.interface(), tangent)?;
        }
        for ((base, block), row) in base.diagonal.iter().zip(&face.tangent.diagonal).zip(rows.iter()) {
            if let (global, Some(_)) = *row {
                tangent.insert_block(global, global, &(base + block))?;
            }
        }
        let pairs = face.interface().pairs().iter().zip(&base.coupling);
        for ((&(row, column), base), coupling) in pairs.zip(&face.tangent.coupling) {
            if let (global, Some(_)) = rows[row] {
                tangent.insert_block(global, rows[column].0, &(base + coupling))?;
            }
        }
        self.inverse.renew();
        self.dt = step.dt;
        tangent.assemble()
    }

    fn solve(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        self.inverse.solve((&self.bulk, self.dt), &mut self.face, b, x)
    }

    fn guess(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        self.started = false;
        let small = D * self.rows.len() <= LARGE_FACE;
        if self.starts && small && self.is_stiff(step)? {
            return self.start(step, u);
        }
        // The face goes on as it did; what is behind it need not be predicted, because it is linear.
        if self.face.accepted.goes_on_from(step)?.is_some() {
            let rates = self.face.accepted.rate().chunks_exact(D);
            let increments = rates.map(|rate| SVector::from_column_slice(rate) * step.dt).enumerate();
            self.face.add(increments, u)?;
        }
        Ok(())
    }

    fn test(&mut self, iteration: usize, norm: f64) -> Verdict {
        let judged = self.face.test(iteration, norm, self.tolerance, self.round_off.force, self.started);
        judged.unwrap_or(Verdict::Diverged)
    }

    fn departure(&mut self, step: Step, u: &Vector) -> Result<f64> {
        let ends = self.face.gather(u)?;
        Ok(self.face.accepted.departure(step, &ends))
    }

    fn commit(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        self.bulk.commit(step, u)?;
        self.face.commit(step, u)
    }

    fn keep_account(&mut self, _layout: &Vector) -> Result<()> {
        self.bulk.keep_account();
        self.face.accepted.keep_account()
    }

    fn keep_heat(&mut self) {
        self.face.accepted.keep_heat();
    }

    fn warm(&mut self, face: &[f64]) {
        self.face.accepted.interface.warm(face);
    }

    fn energy(&self) -> Option<Energy> {
        self.face.accepted.energy().zip(self.bulk.energy()).map(|(face, body)| Energy::new(face, body))
    }

    fn save(&mut self, u: &Vector, snapshot: &mut Snapshot) -> Result<()> {
        let mut order = self.body.natural_order(u)?;
        order.save("u", u, snapshot)?;
        self.bulk.save(&mut order, snapshot)?;
        self.face.save(snapshot);
        Ok(())
    }

    fn restore(&mut self, snapshot: &Snapshot, u: &mut Vector) -> Result<()> {
        let order = self.body.natural_order(u)?;
        order.restore("u", u, snapshot)?;
        self.bulk.restore(&order, snapshot, u)?;
        self.face.restore(snapshot)
    }

    fn contact(&mut self) -> Result<Contact<'_>> {
        Ok(self.face.accepted.contact())
    }

    fn bulk_fields(&mut self, u: &Vector) -> Result<BulkFields> {
        self.recoveries += 1;
        self.body.fields_with_memory(&mut self.bulk, u)
    }

    fn work(&self) -> Work {
        Work {
            memory_fields: self.bulk.memory_vectors(),
            tangential_laws: self.face.interface().tangential_laws(),
            recoveries: self.recoveries,
            factorisations: self.inverse.done[0],
            solves: self.inverse.done[1],
            transforms: 0,
        }
    }
}

impl<const D: usize> Base<D> {
    /// Reads the blocks out of a bulk tangent that was just made for `dt`.
    fn read(
        &mut self,
        dt: f64,
        rows: &[(i32, Option<usize>)],
        interface: &Interface<D>,
        tangent: &Matrix,
    ) -> Result<()> {
        let block = |row: usize, column: usize| match rows[row] {
            (global, Some(_)) => tangent.block(global, rows[column].0),
            _ => Ok(SMatrix::zeros()),
        };
        self.diagonal = (0..rows.len()).map(|node| block(node, node)).collect::<Result<_>>()?;
        self.coupling = interface.pairs().iter().map(|&(row, column)| block(row, column)).collect::<Result<_>>()?;
        self.dt = dt;
        Ok(())
    }
}
