//! All unknowns at once: the reference strategy, which works for everything.

use nalgebra::{Matrix2, Vector2};

use super::body::Body;
use super::{BulkFields, Contact, TransientProblem};
use crate::bulk::Bulk;
use crate::error::{Error, Result};
use crate::interface::{Interface, Residual, Surface, Tangent};
use crate::loading::{Phase, Placement};
use crate::mesh::{Mesh, Numbering};
use crate::petsc::{Gather, Matrix, Step, Vector, Verdict};

/// Bulk and interface in one sparse system.
pub struct Monolithic {
    bulk: Bulk,
    body: Body,
    interface: Interface,
    rows: Rows,
    gather: Gather,
    phase: Option<Phase>,
    tolerance: f64,
    accepted: State,
    trial: State,
    residual: Residual,
    tangent: Tangent,
    base: Base,
    first_norm: f64,
}

/// The contact face at some state.
struct State {
    surface: Surface,
    placement: Placement,
    /// Norm of the contact forces, N/m.
    contact: f64,
}

/// Where the face's unknowns stand in the distributed system.
struct Rows {
    /// Per face node: its global node number, and its first local row where this rank owns it.
    nodes: Vec<(i32, Option<usize>)>,
    /// 0 for the held components of each face node, 1 for the free ones.
    free: Vec<Vector2<f64>>,
}

/// The bulk tangent's blocks under the interface's own, at one step length: what the interface's are added to.
struct Base {
    /// Not a number before the first tangent.
    dt: f64,
    diagonal: Vec<Matrix2<f64>>,
    coupling: Vec<[Matrix2<f64>; 2]>,
}

impl Monolithic {
    /// At rest. `tolerance` is relative, on the residual norm (see [`TransientProblem::test`]).
    pub fn new(bulk: Bulk, body: Body, interface: Interface, layout: &Vector, tolerance: f64) -> Result<Self> {
        let rows = Rows::new(interface.face().unknown.as_slice(), body.mesh(), body.numbering());
        let indices: Vec<i32> = rows.nodes.iter().flat_map(|&(node, _)| [2 * node, 2 * node + 1]).collect();
        let gather = Gather::new(layout, &indices)?;
        let at_rest =
            || State { surface: Surface::at_rest(rows.nodes.len()), placement: Placement::default(), contact: 0.0 };
        Ok(Self {
            accepted: at_rest(),
            trial: at_rest(),
            bulk,
            body,
            interface,
            rows,
            gather,
            phase: None,
            tolerance,
            residual: Residual::new(),
            tangent: Tangent::default(),
            base: Base { dt: f64::NAN, diagonal: Vec::new(), coupling: Vec::new() },
            first_norm: 0.0,
        })
    }

    /// Brings the face's displacements, rates and the indenter's place to the trial state.
    fn try_state(&mut self, step: Step, u: &Vector, rate: &Vector) -> Result<()> {
        let phase = self.phase.as_ref().ok_or_else(|| Error::Internal("no phase has begun".into()))?;
        self.trial.placement = phase.placement(step.t, step.dt);
        self.gather.gather(u, &mut self.trial.surface.displacement)?;
        self.gather.gather(rate, &mut self.trial.surface.rate)
    }
}

impl TransientProblem for Monolithic {
    fn begin(&mut self, phase: Phase) {
        self.phase = Some(phase);
    }

    fn residual(&mut self, step: Step, u: &Vector, rate: &Vector, f: &mut Vector) -> Result<()> {
        self.try_state(step, u, rate)?;
        self.interface.residual(self.trial.placement, &self.trial.surface, &mut self.residual)?;
        let mut square = 0.0;
        for (force, free) in self.residual.iter_mut().zip(&self.rows.free) {
            force.component_mul_assign(free);
            square += force.norm_squared();
        }
        self.trial.contact = square.sqrt();
        self.bulk.force(step, u, rate, f)?;
        let mut values = f.view_mut()?;
        for (force, &(_, local)) in self.residual.iter().zip(&self.rows.nodes) {
            if let Some(row) = local {
                values[row] += force.x;
                values[row + 1] += force.y;
            }
        }
        Ok(())
    }

    fn tangent(&mut self, step: Step, u: &Vector, rate: &Vector, tangent: &mut Matrix) -> Result<()> {
        self.try_state(step, u, rate)?;
        let Self { interface, trial, rows, base, .. } = self;
        interface.tangent(trial.placement, &trial.surface, 1.0 / step.dt, &mut self.tangent)?;
        if base.dt != step.dt {
            self.bulk.tangent(step.dt, tangent)?;
            base.read(step.dt, rows, interface, tangent)?;
        }
        for (node, block) in self.tangent.diagonal.iter().enumerate() {
            if let (global, Some(_)) = rows.nodes[node] {
                let block = base.diagonal[node] + rows.mask(node, node, block);
                tangent.insert_block(global, global, &block)?;
            }
        }
        let edges = interface.face().edges.iter().zip(&base.coupling);
        for ((edge, base), coupling) in edges.zip(&self.tangent.coupling) {
            for ((row, column), side) in edge.directions().into_iter().zip(0..) {
                if let (global, Some(_)) = rows.nodes[row] {
                    let block = base[side] + rows.mask(row, column, &coupling[side]);
                    tangent.insert_block(global, rows.nodes[column].0, &block)?;
                }
            }
        }
        tangent.assemble()
    }

    /// Converged when the norm is below `tolerance` times that of the contact forces (now or at the accepted state;
    /// without contact, times the first norm of the step), or at what round-off in the gap leaves. At least one
    /// iteration is made unless the first guess is as good as round-off.
    fn test(&mut self, iteration: usize, norm: f64) -> Verdict {
        if iteration == 0 {
            self.first_norm = norm;
        }
        if !norm.is_finite() {
            return Verdict::Diverged;
        }
        let contact = self.trial.contact.max(self.accepted.contact);
        let reference = if contact > 0.0 { contact } else { self.first_norm };
        let noise = 8.0 * self.interface.noise(self.trial.placement, &self.trial.surface);
        let tolerance = if iteration == 0 { 8.0 * f64::EPSILON } else { self.tolerance };
        if norm <= (tolerance * reference).max(noise) { Verdict::Converged } else { Verdict::Iterate }
    }

    fn commit(&mut self, step: Step, u: &Vector) -> Result<()> {
        self.bulk.commit(step, u)?;
        let before = std::mem::take(&mut self.accepted.surface.displacement);
        self.accepted.surface.displacement = vec![0.0; before.len()];
        self.gather.gather(u, &mut self.accepted.surface.displacement)?;
        let surface = &mut self.accepted.surface;
        for ((rate, new), old) in surface.rate.iter_mut().zip(&surface.displacement).zip(&before) {
            *rate = (new - old) / step.dt;
        }
        let phase = self.phase.as_ref().ok_or_else(|| Error::Internal("no phase has begun".into()))?;
        self.accepted.placement = phase.placement(step.t, step.dt);
        self.accepted.contact = self.trial.contact;
        Ok(())
    }

    fn contact(&mut self) -> Result<Contact<'_>> {
        let State { surface, placement, .. } = &self.accepted;
        Ok(Contact { interface: &mut self.interface, placement: *placement, surface })
    }

    fn bulk_fields(&mut self, u: &Vector) -> Result<BulkFields> {
        self.body.fields(&mut self.bulk, u)
    }
}

impl Rows {
    fn new(unknowns: &[u32], mesh: &Mesh, numbering: &Numbering) -> Self {
        let nodes = unknowns
            .iter()
            .map(|&unknown| (numbering.global[unknown as usize], numbering.local(unknown).map(|node| 2 * node)))
            .collect();
        let free = |&unknown: &u32| {
            let [x, z] = mesh.held[unknown as usize];
            Vector2::new(f64::from(!x), f64::from(!z))
        };
        Self { nodes, free: unknowns.iter().map(free).collect() }
    }

    /// The block with the rows and columns of held components cleared.
    fn mask(&self, row: usize, column: usize, block: &Matrix2<f64>) -> Matrix2<f64> {
        block.component_mul(&(self.free[row] * self.free[column].transpose()))
    }
}

impl Base {
    /// Reads the blocks out of a bulk tangent that was just made for `dt`.
    fn read(&mut self, dt: f64, rows: &Rows, interface: &Interface, tangent: &Matrix) -> Result<()> {
        let block = |row: usize, column: usize| match rows.nodes[row] {
            (global, Some(_)) => tangent.block(global, rows.nodes[column].0),
            _ => Ok(Matrix2::zeros()),
        };
        self.diagonal = (0..rows.nodes.len()).map(|node| block(node, node)).collect::<Result<_>>()?;
        let edges = &interface.face().edges;
        self.coupling = edges
            .iter()
            .map(|edge| {
                let [(a, b), (c, d)] = edge.directions();
                Ok([block(a, b)?, block(c, d)?])
            })
            .collect::<Result<_>>()?;
        self.dt = dt;
        Ok(())
    }
}
