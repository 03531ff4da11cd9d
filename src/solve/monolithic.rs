//! All unknowns at once: the reference strategy, which works for everything.

mod bordered;
mod borders;
mod start;

use nalgebra::{SMatrix, SVector};

use super::accepted::AcceptedFace;
use super::body::{Body, rows_of};
use super::condensed::LARGE_FACE;
use super::face::ContactFace;
use super::traction::{self, Behind};
use super::woodbury::Woodbury;
use super::{BulkFields, Contact, TransientProblem, Work};
use crate::bulk::Bulk;
use crate::energy::Energy;
use crate::error::Result;
use crate::interface::Interface;
use crate::loading::{DIRECTIONS, Mount, Phase, Placement};
use crate::petsc::{Gather, Matrix, Step, Vector, Verdict};
use crate::snapshot::Snapshot;

pub use bordered::Bordered;

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
    pub fn new(
        bulk: Bulk,
        body: Body<D>,
        (interface, mounts): (Interface<D>, [Option<Mount>; DIRECTIONS]),
        layout: &Vector,
        tolerance: f64,
    ) -> Result<Self> {
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
        let accepted = AcceptedFace::new(interface, mounts);
        Ok(Self {
            face: ContactFace::new(accepted, gather, rows.iter().map(|&(_, local)| local).collect(), &held),
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
        self.face.gone = [0.0; DIRECTIONS];
        let small = D * self.rows.len() <= LARGE_FACE;
        if self.starts && small && (self.is_stiff(step)? || self.falls(step, u)?) {
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
        Ok(self.face.accepted.departure(step, &ends, self.face.placed(step)?))
    }

    fn approach_under(&mut self, force: f64, duration: f64) -> Result<f64> {
        self.face.accepted.interface.place(Placement::default())?;
        let interface = self.face.interface();
        let known = self.inverse.compliance(&self.bulk, duration, interface.face())?;
        let behind = known.map(|(compliance, secant)| Behind { interface, compliance, secant });
        behind.map_or(Ok(0.0), |behind| traction::approach_under(&behind, force))
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
