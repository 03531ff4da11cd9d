//! The contact face of a problem whose unknowns are all displacements, distributed: its trial state.

use nalgebra::{SMatrix, SVector};

use super::accepted::AcceptedFace;
use crate::element::mpjr::{Relative, Traction};
use crate::error::Result;
use crate::interface::{Interface, Residual, Tangent, Trial};
use crate::loading::{DIRECTIONS, Placement};
use crate::petsc::{Gather, Step, Vector, Verdict};
use crate::snapshot::Snapshot;

/// The contact face, known whole on every rank.
pub struct ContactFace<const D: usize> {
    /// At the accepted state.
    pub accepted: AcceptedFace<D>,
    gather: Gather,
    /// The first local row of each face node in a solution vector, where this rank owns it.
    rows: Vec<Option<usize>>,
    /// 0 for the held components of each face node, 1 for the free ones.
    free: Vec<SVector<f64, D>>,
    trial: Trial,
    placement: Placement,
    /// How far an indenter that is held is beyond where it was thought to be, in each direction, m.
    pub gone: [f64; DIRECTIONS],
    /// Contact forces at the trial state, internal minus external, N/m; zero where a component is held.
    pub residual: Residual<D>,
    /// Their derivatives at the trial state; zero where a component is held.
    pub tangent: Tangent<D>,
    /// How large the contact forces are at the accepted state, in the norm of the convergence test.
    scale: f64,
    first_norm: f64,
}

impl<const D: usize> ContactFace<D> {
    /// At rest. `gather` brings the components of each face node out of a solution vector, where they are in the local `rows`; `held`
    /// says which of them are held.
    pub fn new(accepted: AcceptedFace<D>, gather: Gather, rows: Vec<Option<usize>>, held: &[[bool; D]]) -> Self {
        Self {
            accepted,
            gather,
            rows,
            free: held.iter().map(|held| SVector::from(held.map(|held| f64::from(!held)))).collect(),
            trial: Trial::at_rest(D * held.len()),
            placement: Placement::default(),
            gone: [0.0; DIRECTIONS],
            residual: Residual::new(),
            tangent: Tangent::default(),
            scale: 0.0,
            first_norm: 0.0,
        }
    }

    /// The laws on the face.
    pub fn interface(&self) -> &Interface<D> {
        &self.accepted.interface
    }

    /// Where the indenter is at the trial state.
    pub fn at(&self) -> Placement {
        self.placement
    }

    /// How each point has moved at the trial state, and the tractions there.
    pub fn answers(&mut self) -> Result<Vec<(Relative<D>, Traction<D>)>> {
        self.accepted.interface.answers(self.placement, &self.trial)
    }

    /// What each point gives its nodes, of them what is free; 0 elsewhere.
    pub fn at_free_nodes(&self, points: impl Iterator<Item = SVector<f64, D>>) -> Vec<SVector<f64, D>> {
        let mut nodes = vec![SVector::zeros(); self.free.len()];
        for (i, force) in points.enumerate() {
            self.interface().points().shares(i).iter().for_each(|&(node, share)| nodes[node] += force * share);
        }
        nodes.iter_mut().zip(&self.free).for_each(|(node, free)| node.component_mul_assign(free));
        nodes
    }

    /// Makes `residual` hold at a trial state.
    pub fn try_residual(&mut self, step: Step, u: &Vector) -> Result<()> {
        self.try_state(step, u)?;
        self.accepted.interface.residual(self.placement, &self.trial, &mut self.residual)?;
        for (force, free) in self.residual.iter_mut().zip(&self.free) {
            force.component_mul_assign(free);
        }
        Ok(())
    }

    /// Makes `tangent` hold at a trial state.
    pub fn try_tangent(&mut self, step: Step, u: &Vector) -> Result<()> {
        self.try_state(step, u)?;
        let Self { accepted: AcceptedFace { interface, .. }, trial, placement, tangent, free, .. } = self;
        interface.tangent(*placement, trial, tangent)?;
        let mask = |row: usize, column: usize, block: &mut SMatrix<f64, D, D>| {
            block.component_mul_assign(&(free[row] * free[column].transpose()));
        };
        for (node, block) in tangent.diagonal.iter_mut().enumerate() {
            mask(node, node, block);
        }
        for (&(row, column), block) in interface.pairs().iter().zip(&mut tangent.coupling) {
            mask(row, column, block);
        }
        Ok(())
    }

    /// Adds to nodes of the face in a vector like the solution.
    pub fn add(&self, increments: impl Iterator<Item = (usize, SVector<f64, D>)>, to: &mut Vector) -> Result<()> {
        let mut values = to.view_mut()?;
        for (node, increment) in increments {
            if let Some(row) = self.rows[node] {
                values[row..].iter_mut().zip(&increment).for_each(|(value, more)| *value += more);
            }
        }
        Ok(())
    }

    /// The Euclidean norm of `residual`, N/m.
    pub fn contact_norm(&self) -> f64 {
        self.residual.iter().map(|force| force.norm_squared()).sum::<f64>().sqrt()
    }

    /// Judges a Newton iterate by the norm of its residual: converged below `tolerance` times the scale of the contact
    /// forces (at this or the accepted state, the larger; without contact, times the first norm of the step), or at
    /// the noise that round-off leaves, `noise` and that of the laws. At least one iteration is made unless the first guess is
    /// as good as round-off, or `started`: has solved the step already.
    pub fn test(&mut self, iteration: usize, norm: f64, tolerance: f64, noise: f64, started: bool) -> Result<Verdict> {
        if iteration == 0 {
            self.first_norm = norm;
        }
        if !norm.is_finite() {
            return Ok(Verdict::Diverged);
        }
        let scale = self.contact_norm().max(self.scale);
        let reference = if scale > 0.0 { scale } else { self.first_norm };
        let share = if iteration == 0 && !started { 8.0 * f64::EPSILON } else { tolerance };
        let converged = norm <= share * reference
            || (iteration > 0 || started)
                && norm <= noise + 8.0 * self.accepted.interface.noise(self.placement, &self.trial)?;
        Ok(if converged { Verdict::Converged } else { Verdict::Iterate })
    }

    /// Takes the accepted state to the end of an accepted step.
    pub fn commit(&mut self, step: Step, u: &Vector) -> Result<()> {
        self.try_state(step, u)?;
        let states = self.accepted.interface.displaced(self.placement, &self.trial)?;
        self.scale = self.contact_norm();
        self.accepted.commit((step.t, self.placement), states, self.trial.end.clone())
    }

    /// Adds the accepted state to a snapshot.
    pub fn save(&self, snapshot: &mut Snapshot) {
        snapshot.put("face-scale", vec![self.scale]);
        self.accepted.save(snapshot);
    }

    /// Takes the accepted state from a snapshot.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        [self.scale] = snapshot.numbers("face-scale")?;
        self.accepted.restore(snapshot)
    }

    /// The components of each face node of a solution vector, on every rank.
    pub fn gather(&mut self, vector: &Vector) -> Result<Vec<f64>> {
        self.gather.all(vector)
    }

    /// Brings the face's displacements and the indenter's place to a trial state.
    pub fn try_state(&mut self, step: Step, u: &Vector) -> Result<()> {
        self.placement = self.placed(step)?;
        self.trial.beginning.copy_from_slice(self.accepted.displacement());
        self.gather.gather(u, &mut self.trial.end)?;
        // What is held stays, whatever round-off the linear solver leaves there.
        let free = self.free.iter().flat_map(|free| free.iter());
        self.trial.end.iter_mut().zip(free).for_each(|(end, free)| *end *= free);
        Ok(())
    }

    /// The same with the indenter as far on as it has gone.
    pub fn placed(&self, step: Step) -> Result<Placement> {
        Ok(self.placement(step)?.gone_on(&self.interface().placement(), self.gone))
    }

    /// Where the indenter is at the end of a step if it goes on as it did, and what slip rates friction can tell apart in it.
    pub fn placement(&self, step: Step) -> Result<Placement> {
        // Slip is a difference of displacements, of which round-off leaves 16 digits; the law is let have six of them.
        const LAST_DIGITS: f64 = 1e-10;
        let placement = self.accepted.placement(step)?;
        if self.interface().friction().is_none() {
            return Ok(placement);
        }
        let farthest = self.accepted.displacement().iter().fold(placement.approach.abs(), |most, u| most.max(u.abs()));
        let resolution = LAST_DIGITS * (farthest / step.dt + placement.sliding_rate.norm());
        Ok(Placement { resolution, ..placement })
    }
}
