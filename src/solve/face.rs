//! The contact face of a problem whose unknowns are distributed: its trial and accepted states.
//!
//! What both strategies share: they differ in what stands behind the face.

use nalgebra::{Matrix2, Vector2};

use super::Contact;
use crate::energy::FaceEnergy;
use crate::error::{Error, Result};
use crate::friction::{Friction, Slip};
use crate::interface::{Exchange, Fields, Interface, Residual, Station, Surface, Tangent};
use crate::loading::{Phase, Placement};
use crate::petsc::{Gather, Step, Vector, Verdict};
use crate::snapshot::Snapshot;

/// The contact face, known whole on every rank.
pub struct ContactFace {
    interface: Interface,
    gather: Gather,
    /// The first local row of each face node in a solution vector, where this rank owns it.
    rows: Vec<Option<usize>>,
    /// 0 for the held components of each face node, 1 for the free ones.
    free: Vec<Vector2<f64>>,
    phase: Option<Phase>,
    accepted: State,
    trial: State,
    /// Contact forces at the trial state, internal minus external, N/m; zero where a component is held.
    pub residual: Residual,
    /// Their derivatives at the trial state; zero where a component is held.
    pub tangent: Tangent,
    first_norm: f64,
    /// Whether the first guess was within the noise.
    settled: bool,
    /// Only where the energy is asked for.
    exchange: Option<Exchange>,
}

/// The face at some state.
struct State {
    surface: Surface,
    placement: Placement,
    /// How large the contact forces are, in the norm of the convergence test.
    scale: f64,
}

impl ContactFace {
    /// At rest. `gather` brings x, z of each face node out of a solution vector, where they are in the local `rows`; `held`
    /// says which of them are held.
    pub fn new(interface: Interface, gather: Gather, rows: Vec<Option<usize>>, held: &[[bool; 2]]) -> Self {
        let at_rest = || State { surface: Surface::at_rest(held.len()), placement: Placement::default(), scale: 0.0 };
        Self {
            accepted: at_rest(),
            trial: at_rest(),
            free: held.iter().map(|[x, z]| Vector2::new(f64::from(!x), f64::from(!z))).collect(),
            interface,
            gather,
            rows,
            phase: None,
            residual: Residual::new(),
            tangent: Tangent::default(),
            first_norm: 0.0,
            settled: false,
            exchange: None,
        }
    }

    /// Keeps account of the energy from here on, at rest.
    pub fn keep_account(&mut self) {
        self.exchange = Some(Exchange::new(&self.interface));
    }

    /// The energy that went through at the accepted state, where it is kept account of.
    pub fn energy(&self) -> Option<FaceEnergy> {
        self.exchange.as_ref().map(Exchange::energy)
    }

    /// The laws on the face.
    pub fn interface(&self) -> &Interface {
        &self.interface
    }

    /// What the following steps are driven by.
    pub fn begin(&mut self, phase: Phase) {
        self.phase = Some(phase);
    }

    /// Makes `residual` hold at a trial state.
    pub fn try_residual(&mut self, step: Step, u: &Vector, rate: &Vector) -> Result<()> {
        self.try_state(step, u, rate)?;
        self.interface.residual(self.trial.placement, &self.trial.surface, &mut self.residual)?;
        self.mask_residual();
        Ok(())
    }

    fn mask_residual(&mut self) {
        for (force, free) in self.residual.iter_mut().zip(&self.free) {
            force.component_mul_assign(free);
        }
    }

    /// Makes `tangent` hold at a trial state.
    pub fn try_tangent(&mut self, step: Step, u: &Vector, rate: &Vector) -> Result<()> {
        self.try_state(step, u, rate)?;
        let Self { interface, trial, tangent, free, .. } = self;
        interface.tangent(trial.placement, &trial.surface, 1.0 / step.dt, tangent)?;
        let mask = |row: usize, column: usize, block: &mut Matrix2<f64>| {
            block.component_mul_assign(&(free[row] * free[column].transpose()));
        };
        for (node, block) in tangent.diagonal.iter_mut().enumerate() {
            mask(node, node, block);
        }
        for (edge, coupling) in interface.face().edges.iter().zip(&mut tangent.coupling) {
            for ((row, column), block) in edge.directions().into_iter().zip(coupling) {
                mask(row, column, block);
            }
        }
        Ok(())
    }

    /// Takes `u`, the accepted state, to where Newton's method had better begin. What is behind the face need not be
    /// predicted, because it is linear.
    ///
    /// Within a phase the face goes on as it did, and nodes of which friction expects a slip rate go with the indenter
    /// at that. Not so where the indenter goes so far in the step that all will slip anyway: ten times what the drag, f
    /// of the pressure, displaces by the measure of what the pressure does.
    pub fn predict(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        let prediction = self.prediction(step)?;
        self.add(prediction.into_iter().enumerate(), u)
    }

    /// What [`Self::predict`] adds to each node of the face, m.
    fn prediction(&mut self, step: Step) -> Result<Vec<Vector2<f64>>> {
        let phase = self.phase()?;
        // A quarter of the step, against round-off: the one before was half as long or longer.
        let goes_on = if step.t - 1.25 * step.dt > phase.start { step.dt } else { 0.0 };
        let drive = phase.placement(step.t, step.dt).sliding_rate;
        let Self { interface, accepted: State { surface, placement, .. }, free, .. } = self;
        let mut prediction: Vec<_> =
            surface.rate.as_chunks().0.iter().map(|&[x, z]| Vector2::new(x, z) * goes_on).collect();
        let Some(law) = interface.friction().copied() else { return Ok(prediction) };
        let normal = surface.displacement.iter().skip(1).step_by(2);
        let deepest = normal.fold(0.0, |most: f64, u| most.max(u.abs()));
        if (drive * step.dt).abs() > 10.0 * law.coefficient() * deepest {
            return Ok(prediction);
        }
        let Fields { pressure, slip_rate, stuck, .. } = interface.fields(*placement, surface)?;
        for node in (0..prediction.len()).filter(|&node| pressure[node] > 0.0 && free[node].x > 0.0) {
            let slip = Slip { rate: slip_rate[node], dt: 0.0, stuck: stuck[node], resolution: 0.0 };
            if let Some(rate) = law.expected(slip, drive) {
                prediction[node].x = (drive - rate) * step.dt;
            }
        }
        Ok(prediction)
    }

    /// Whether the laws are too stiff for Newton's method from where the face was, before a body of the given softness, m
    /// per N/m: penalty beside the body's stiffness, or rates of the indenter beside the friction law's own.
    pub fn is_stiff(&self, step: Step, softness: f64) -> Result<bool> {
        const PENALTY: f64 = 1e4;
        const RATE: f64 = 500.0;
        let placement = self.placement(step)?;
        let rate = placement.sliding_rate.abs().max(placement.approach_rate.abs());
        let sharp = |law: &Friction| rate > RATE * law.sharpness(step.dt);
        Ok(self.interface.stiffest() * softness > PENALTY || self.interface.friction().is_some_and(sharp))
    }

    /// The points of the contact in a step from the accepted state.
    pub fn stations(&mut self, step: Step) -> Result<Vec<Station>> {
        let placement = self.placement(step)?;
        self.interface.stations(placement, &self.accepted.surface)
    }

    /// Bends the Newton step from `u` to `u` - `decrement` at the nodes of the face where it overruns friction; whether
    /// there were any.
    pub fn limit(&mut self, step: Step, u: &Vector, decrement: &mut Vector) -> Result<bool> {
        if self.interface.friction().is_none() {
            return Ok(false);
        }
        let (from, less) = (self.gather(u)?, self.gather(decrement)?);
        let from = self.surface_at(step, from);
        let to = from.displacement.iter().zip(&less).map(|(u, less)| u - less).collect();
        let to = self.surface_at(step, to);
        let placement = self.placement(step)?;
        let limits = self.interface.limit(placement, [&from, &to])?;
        self.add(limits.iter().map(|&(node, increment)| (node, -increment)), decrement)?;
        Ok(!limits.is_empty())
    }

    /// Adds to x, z of nodes of the face in a vector like the solution. On all ranks: PETSc keeps norms until it sees a
    /// vector written to, on each rank for itself.
    pub fn add(&self, increments: impl Iterator<Item = (usize, Vector2<f64>)>, to: &mut Vector) -> Result<()> {
        let mut values = to.view_mut()?;
        for (node, increment) in increments {
            if let Some(row) = self.rows[node] {
                values[row] += increment.x;
                values[row + 1] += increment.y;
            }
        }
        Ok(())
    }

    /// Whether the first guess was within the noise, so that a Newton step from it could only add to that.
    pub fn is_settled(&self) -> bool {
        self.settled
    }

    /// The face at given displacements at the end of a step.
    fn surface_at(&self, step: Step, displacement: Vec<f64>) -> Surface {
        let accepted = &self.accepted.surface.displacement;
        let rate = displacement.iter().zip(accepted).map(|(new, old)| (new - old) / step.dt).collect();
        Surface { displacement, rate }
    }

    /// The Euclidean norm of `residual`, N/m.
    pub fn contact_norm(&self) -> f64 {
        self.residual.iter().map(|force| force.norm_squared()).sum::<f64>().sqrt()
    }

    /// Says how large the contact forces of the trial state are, in the norm of the convergence test.
    pub fn set_scale(&mut self, scale: f64) {
        self.trial.scale = scale;
    }

    /// Judges a Newton iterate by the norm of its residual: converged below `tolerance` times the scale of the contact
    /// forces (at this or the accepted state, the larger; without contact, times the first norm of the step), or at
    /// the `noise` that round-off leaves, which is asked for only where it decides. At least one iteration is made unless
    /// the first guess is as good as round-off.
    pub fn test(&mut self, iteration: usize, norm: f64, tolerance: f64, noise: impl FnOnce(&Self) -> f64) -> Verdict {
        if iteration == 0 {
            self.first_norm = norm;
        }
        if !norm.is_finite() {
            return Verdict::Diverged;
        }
        let scale = self.trial.scale.max(self.accepted.scale);
        let reference = if scale > 0.0 { scale } else { self.first_norm };
        let converged = match iteration {
            // A start that is only within the noise has no tangent yet, by which the forces are refined.
            0 => {
                let exact = norm <= 8.0 * f64::EPSILON * reference;
                self.settled = !exact && norm <= noise(self);
                exact
            }
            _ => norm <= tolerance * reference || norm <= noise(self),
        };
        if converged { Verdict::Converged } else { Verdict::Iterate }
    }

    /// The force norm that round-off in the gap leaves, N/m.
    pub fn noise(&self) -> f64 {
        8.0 * self.interface.noise(self.trial.placement, &self.trial.surface)
    }

    /// How far `u`, at the end of a step from the accepted state, is from where the accepted rates would have taken the
    /// face, m: the root mean square of d = u - u' - v' dt over as many nodes as carry the displacement,
    /// (sum d^2 / sum u^2)^1/2 max |u|, so that a small contact on a long face counts for what it is.
    pub fn departure(&mut self, step: Step, u: &Vector) -> Result<f64> {
        let ends = self.gather(u)?;
        let Surface { displacement, rate } = &self.accepted.surface;
        let starts = displacement.iter().zip(rate);
        let departed: f64 = ends.iter().zip(starts).map(|(end, (u, v))| (end - u - v * step.dt).powi(2)).sum();
        let displaced: f64 = ends.iter().map(|u| u * u).sum();
        let largest = ends.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        Ok(if displaced > 0.0 { (departed / displaced).sqrt() * largest } else { departed.sqrt() })
    }

    /// Takes the accepted state to the end of an accepted step.
    pub fn commit(&mut self, step: Step, u: &Vector) -> Result<()> {
        let placement = self.placement(step)?;
        let State { surface, .. } = &mut self.accepted;
        let mut before = vec![0.0; surface.displacement.len()];
        std::mem::swap(&mut before, &mut surface.displacement);
        self.gather.gather(u, &mut surface.displacement)?;
        for ((rate, new), old) in surface.rate.iter_mut().zip(&surface.displacement).zip(&before) {
            *rate = (new - old) / step.dt;
        }
        if let Some(exchange) = &mut self.exchange {
            exchange.advance(&mut self.interface, placement, surface)?;
        }
        self.interface.commit(placement, surface)?;
        self.accepted.placement = Placement { dt: 0.0, ..placement };
        self.accepted.scale = self.trial.scale;
        Ok(())
    }

    /// Whether a step that was solved by `u` must be solved again, with other multipliers.
    pub fn augment(&mut self, step: Step, u: &Vector) -> Result<bool> {
        self.trial.placement = self.placement(step)?;
        self.gather.gather(u, &mut self.trial.surface.displacement)?;
        self.interface.augment(self.trial.placement, &self.trial.surface)
    }

    /// Makes `residual` hold at the accepted state.
    pub fn accepted_residual(&mut self) -> Result<()> {
        let State { surface, placement, .. } = &self.accepted;
        self.interface.residual(*placement, surface, &mut self.residual)?;
        self.mask_residual();
        Ok(())
    }

    /// Adds the accepted state to a snapshot; the displacements are part of the solution.
    pub fn save(&self, snapshot: &mut Snapshot) {
        let State { surface, placement, scale } = &self.accepted;
        let Placement { approach, sliding, sliding_rate, approach_rate, resolution, dt: _ } = placement;
        snapshot.put("face", vec![*approach, *sliding, *sliding_rate, *approach_rate, *resolution, *scale]);
        snapshot.put("face-rate", surface.rate.clone());
        self.interface.save(snapshot);
        if let Some(exchange) = &self.exchange {
            exchange.save(snapshot);
        }
    }

    /// Takes the accepted state, whose solution is `u`, from a snapshot.
    pub fn restore(&mut self, snapshot: &Snapshot, u: &Vector) -> Result<()> {
        let [approach, sliding, sliding_rate, approach_rate, resolution, scale] = snapshot.numbers("face")?;
        self.accepted.placement = Placement { approach, sliding, sliding_rate, approach_rate, resolution, dt: 0.0 };
        self.accepted.scale = scale;
        snapshot.fill("face-rate", &mut self.accepted.surface.rate)?;
        self.interface.restore(snapshot)?;
        if let Some(exchange) = &mut self.exchange {
            exchange.restore(snapshot, self.accepted.placement)?;
        }
        self.gather.gather(u, &mut self.accepted.surface.displacement)
    }

    /// The contact at the accepted state.
    pub fn contact(&mut self) -> Contact<'_> {
        let State { surface, placement, .. } = &self.accepted;
        Contact { interface: &mut self.interface, placement: *placement, surface }
    }

    /// x, z of each face node of a solution vector, on every rank.
    pub fn gather(&mut self, vector: &Vector) -> Result<Vec<f64>> {
        let mut values = vec![0.0; 2 * self.free.len()];
        self.gather.gather(vector, &mut values)?;
        Ok(values)
    }

    /// The Euclidean norm of the face's displacements at the trial state, m.
    pub fn trial_norm(&self) -> f64 {
        self.trial.surface.displacement.iter().map(|u| u * u).sum::<f64>().sqrt()
    }

    /// Brings the face's displacements, rates and the indenter's place to a trial state.
    fn try_state(&mut self, step: Step, u: &Vector, rate: &Vector) -> Result<()> {
        self.trial.placement = self.placement(step)?;
        self.gather.gather(u, &mut self.trial.surface.displacement)?;
        self.gather.gather(rate, &mut self.trial.surface.rate)
    }

    /// Where the indenter is at the end of a step, and what slip rates friction can tell apart in it.
    fn placement(&self, step: Step) -> Result<Placement> {
        // Slip is a difference of displacements, of which round-off leaves 16 digits; the law is let have six of them.
        const LAST_DIGITS: f64 = 1e-10;
        let placement = self.phase()?.placement(step.t, step.dt);
        if self.interface.friction().is_none() {
            return Ok(placement);
        }
        let farthest =
            self.accepted.surface.displacement.iter().fold(placement.approach.abs(), |most, u| most.max(u.abs()));
        let resolution = LAST_DIGITS * (farthest / step.dt + placement.sliding_rate.abs());
        Ok(Placement { resolution, ..placement })
    }

    fn phase(&self) -> Result<&Phase> {
        self.phase.as_ref().ok_or_else(|| Error::Internal("no phase has begun".into()))
    }
}
