//! The body condensed onto its contact face, which is solved for its tractions (super::traction).
//!
//! TS's solution is the tractions, F(t, T, dT/dt) = G with neither rate nor shift: an equation whose history is kept when TS
//! has accepted the step. The unknowns live on rank 0, and the other ranks follow and help when bulk fields are asked for; or, of a large
//! periodic face in space, on the ranks that have its points ([`crate::parallel::Team`]): then all do the same, each with its own points,
//! and what is decided is decided by totals over all.

mod checkpoint;
mod jump;
mod linear;
mod stage;
mod unknowns;

use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Root};
use nalgebra::SVector;

use super::accepted::AcceptedFace;
use super::response::{Response, unprepared};
use super::traction::{self, Behind, Outcome, Sites};
use super::{BulkFields, Contact, Tempered, TransientProblem, Work};
use crate::energy::Energy;
use crate::error::Result;
use crate::interface::{Interface, State};
use crate::loading::{DIRECTIONS, Mount, Phase, Placement, Support};
use crate::parallel::{Team, share_numbers};
use crate::petsc::{Gather, Matrix, Step, Vector, Verdict};
use crate::snapshot::Snapshot;
use jump::Jump;
use linear::Linear;
use stage::Stage;
pub use unknowns::Freedom;
use unknowns::{tractions, write};

/// Faces with more components than this are solved by GMRES: of a periodic layer with a preconditioner by Fourier
/// transforms, else with an older factor, so that a step costs the square of the components in contact and not the cube.
pub const LARGE_FACE: usize = 1200;
/// The same where there are Fourier transforms.
pub const LARGE_PERIODIC_FACE: usize = 200;
/// Newton steps after which a step that is not solved is begun anew, from softer laws.
const PATIENCE: usize = 20;

/// The contact problem on the face alone.
pub struct Condensed<const D: usize, R> {
    comm: SimpleCommunicator,
    face: AcceptedFace<D>,
    response: R,
    tolerance: f64,
    way: Way,
    /// Brings vectors of the face's nodes to all ranks, once it was asked for.
    gather: Option<Gather>,
    /// u_free, and the accepted u, of the face's nodes.
    free: Vector,
    displacement: Vector,
    /// The accepted tractions of this rank's points, and those a step before, Pa.
    accepted: Vec<SVector<f64, D>>,
    before: Vec<SVector<f64, D>>,
    /// How large the accepted tractions are, in the norm of the convergence test.
    scale: f64,
    /// The step that is being solved; none before its first residual.
    stage: Option<Stage<D>>,
    linear: Linear<D>,
    /// Whether a factor may serve for later tangents.
    reuse: bool,
    /// How often bulk fields were asked for.
    recoveries: usize,
    /// Transforms that the response had made before: other scenes may share it.
    transforms: usize,
    /// What of the indenter's place may be unknown.
    freedom: Freedom,
    /// Whether a jump was refused since the last accepted step.
    jumps: bool,
}

/// How the equations of a step are solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// By Newton's method.
    Newton,
    /// By conjugate gradients on the pressures, each run of which is a step of Newton's method: see
    /// [`traction::pressures`]. Of a flat periodic face without friction under an indenter whose place is given.
    Pressures,
    /// By Newton's method and GMRES, where no matrix of the body is held and a product with C is a solve with it.
    Products,
}

/// What [`Condensed::along`] gives.
type Gone<const D: usize> = (Vec<SVector<f64, D>>, Vec<SVector<f64, D>>, SVector<f64, D>);

impl<const D: usize, R: Response<D>> Condensed<D, R> {
    /// At rest. `layout` has the components of each face node, on rank 0 or on the rank that has it; `tolerance` is relative to the tractions.
    pub fn new(
        comm: &SimpleCommunicator,
        (interface, mounts): (Interface<D>, [Option<Mount>; DIRECTIONS]),
        response: R,
        layout: &Vector,
        (tolerance, freedom, way): (f64, Freedom, Way),
    ) -> Result<Self> {
        let components = D * interface.nodes_everywhere();
        let points = if layout.local_len() > 0 { interface.points().count() } else { 0 };
        let transforms = response.work().transforms;
        Ok(Self {
            comm: comm.duplicate(),
            face: AcceptedFace::new(interface, mounts),
            response,
            tolerance,
            way,
            gather: None,
            free: layout.like()?,
            displacement: layout.like()?,
            accepted: vec![SVector::zeros(); points],
            before: vec![SVector::zeros(); points],
            scale: 0.0,
            stage: None,
            linear: Linear::default(),
            reuse: components > LARGE_FACE || way == Way::Products,
            recoveries: 0,
            transforms,
            freedom,
            jumps: false,
        })
    }

    /// The ranks that share the face.
    fn team(&self) -> &Team {
        self.face.interface.team()
    }

    /// What is behind the face, on the ranks that have it.
    fn behind(&self) -> Option<Behind<'_, D>> {
        let (interface, secant) = (&self.face.interface, self.response.secant());
        self.response.compliance().map(|compliance| Behind { interface, compliance, secant })
    }

    /// Within a phase the tractions go on as they did, or along with the indenter where that goes far in a step. A change that the
    /// tolerance allows says nothing of where they go: going on with it, a contact that rests would not stay as it is.
    fn predict(&self, step: Step, u: &mut Vector) -> Result<()> {
        let Some(last) = self.face.goes_on_from(step)? else { return Ok(()) };
        let points = self.face.interface.points();
        let way = self.face.placement(step)?.sliding_rate * step.dt;
        let predicted: Vec<SVector<f64, D>> = match points.carried(&self.accepted, way) {
            Some(carried) => carried,
            None => {
                let share = step.dt / last;
                let changes = self.accepted.iter().zip(&self.before).map(|(now, before)| now - before);
                let squares =
                    changes.clone().zip(points.all()).map(|(change, point)| point.weight * change.norm_squared());
                let [square] = self.team().sum([squares.sum::<f64>()]);
                if square.sqrt() <= self.tolerance * self.scale {
                    return Ok(());
                }
                self.accepted.iter().zip(changes).map(|(now, change)| now + change * share).collect()
            }
        };
        if self.face.interface.adhesion().is_some() {
            return write(u, predicted.into_iter());
        }
        // No tension.
        let pressed =
            predicted.iter().zip(points.all()).map(|(t, point)| t - point.normal * point.normal.dot(t).max(0.0));
        write(u, pressed)
    }

    /// What a Newton step takes off: tractions, motions, and how far the indenter goes.
    fn along(&self, behind: &Behind<'_, D>, sites: &Sites<D>, decrement: &Vector) -> Result<Gone<D>> {
        let (gone, decrement) = (self.shift(sites, decrement)?, tractions::<D>(decrement, self.accepted.len())?);
        let mut moved = match &self.linear.touching {
            Some(touching) => touching.moves(behind, sites, &decrement)?,
            None => behind.moves(&decrement)?,
        };
        if gone.iter().any(|gone| *gone != 0.0) {
            moved.iter_mut().zip(sites).for_each(|(moved, site)| *moved += traction::against(site, &gone));
        }
        Ok((decrement, moved, gone))
    }

    /// What may be left of G, in its norm, where the step is solved: see [`TransientProblem::test`].
    fn allowed(&self) -> f64 {
        let Some(Stage { trial, first, .. }) = &self.stage else { return 0.0 };
        let scale = self.scale.max(trial.size());
        let reference = if scale > 0.0 { scale } else { first.unwrap_or(trial.norm()) };
        (self.tolerance * reference).max(trial.noise())
    }

    /// The displacements of the nodes under tractions, m, and the forces, N/m; on the ranks that have points.
    fn displaced(&self, tractions: &[SVector<f64, D>]) -> Result<(Vec<f64>, Vec<f64>)> {
        match self.behind() {
            Some(behind) => behind.displaced(tractions, &self.free.view()?),
            None => Ok((Vec::new(), Vec::new())),
        }
    }

    /// The laws at the tractions of a vector.
    fn outcome(&self, u: &Vector) -> Result<Outcome<D>> {
        let Some((behind, stage)) = self.behind().zip(self.stage.as_ref()) else {
            return Ok(Outcome::none());
        };
        let (sites, tractions) = (&stage.sites, tractions::<D>(u, self.accepted.len())?);
        let shift = self.shift(sites, u)?;
        // What is tried on the way knows no motion along the face where the laws ask for none.
        let known = self.team().all_say(tractions == stage.trial.tractions && shift == stage.trial.shift);
        if known && !behind.is_normal_alone() {
            return Ok(stage.trial.clone());
        }
        let motions = behind.motions(&self.displaced(&tractions)?.0, &tractions);
        let motions =
            motions.iter().zip(sites).map(|(motion, site)| motion + traction::against(site, &shift)).collect();
        Ok(self.with_laws(stage, |laws| Outcome::new(sites, tractions, (motions, shift), laws)))
    }

    /// How far the indenter has gone on in each direction, m, on every rank. Collective.
    fn gone(&self, stage: &Stage<D>, shift: SVector<f64, D>) -> [f64; DIRECTIONS] {
        let mut gone: [f64; DIRECTIONS] = std::array::from_fn(|direction| shift.dot(&traction::axis(direction)));
        if stage.placement.supports.iter().any(Option::is_some) {
            self.comm.process_at_rank(0).broadcast_into(&mut gone[..]);
        }
        gone
    }

    /// Gives every rank the states and displacements of rank 0, unless each has its own. Collective.
    fn share(&self, states: Vec<State<D>>, mut displacement: Vec<f64>) -> (Vec<State<D>>, Vec<f64>) {
        if self.comm.size() == 1 || self.team().is_parted() {
            return (states, displacement);
        }
        let mut list = Vec::new();
        states.iter().for_each(|state| state.write(&mut list));
        list.resize(State::<D>::NUMBERS * self.face.interface.points().count(), 0.0);
        displacement.resize(self.face.displacement().len(), 0.0);
        self.comm.process_at_rank(0).broadcast_into(&mut list[..]);
        self.comm.process_at_rank(0).broadcast_into(&mut displacement[..]);
        (list.chunks_exact(State::<D>::NUMBERS).map(State::read).collect(), displacement)
    }

    /// Tractions near those that meet the laws, from others.
    fn start(&self, from: Outcome<D>) -> Result<Outcome<D>> {
        let Some((behind, stage)) = self.behind().zip(self.stage.as_ref()) else { return Ok(from) };
        let operator: traction::Operator<'_, D> = (&|j, rows| behind.influence(j, rows), &|t| behind.moves(t));
        self.with_laws(stage, |laws| traction::start(&stage.sites, from, laws, operator, self.tolerance))
    }

    /// Takes note of a state that was tried, and writes its residual.
    fn tried(&mut self, outcome: Outcome<D>, f: &mut Vector) -> Result<()> {
        let mut values = f.view_mut()?;
        values.fill(0.0);
        for (i, answer) in &outcome.answers {
            values[D * i..][..D].copy_from_slice(answer.excess.as_slice());
        }
        drop(values);
        self.face.interface.count_laws(outcome.in_contact());
        // The force that is too much, over the area; where the place is given, how far the indenter has gone, which is then nowhere.
        let stage = self.stage.as_ref().ok_or_else(unprepared)?;
        let (unbalanced, gone) = (outcome.unbalanced(&stage.sites), Self::entries(&stage.sites, &outcome.shift));
        let held = stage.placement.supports.map(|support| support.is_some());
        self.write_last(std::array::from_fn(|i| if held[i] { unbalanced[i] } else { gone[i] }), f)?;
        let stage = self.stage.as_mut().ok_or_else(unprepared)?;
        let norm = outcome.norm();
        stage.first.get_or_insert(norm);
        stage.trial = outcome;
        Ok(())
    }
}

impl<const D: usize, R: Response<D>> TransientProblem for Condensed<D, R> {
    fn begin(&mut self, phase: Phase) -> Result<()> {
        self.stage = None;
        self.face.begin(phase)
    }

    fn residual(&mut self, step: Step, u: &Vector, _rate: &Vector, f: &mut Vector) -> Result<()> {
        self.enter(step)?;
        let outcome = self.outcome(u)?;
        self.tried(outcome, f)
    }

    fn tangent(&mut self, step: Step, _u: &Vector, _rate: &Vector, _tangent: &mut Matrix) -> Result<()> {
        self.linearise(step)
    }

    fn multiply(&mut self, v: &Vector, product: &mut Vector) -> Result<()> {
        self.product(v, product)
    }

    fn solve(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        self.solution(b, x)
    }

    fn guess(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        self.predict(step, u)?;
        self.write_last([0.0; DIRECTIONS], u)?;
        let Some(support) = self.face.placement(step)?.supports[0].filter(Support::is_force) else { return Ok(()) };
        // A force that nothing bears yet is brought to where something does.
        self.enter(step)?;
        let outcome = self.outcome(u)?;
        let down = match (&self.stage, outcome.in_contact()) {
            (Some(stage), 0) => traction::touch(&stage.sites, &outcome.motions, support.force) * stage.sites.modulus(),
            _ => 0.0,
        };
        self.write_last([down, 0.0, 0.0], u)
    }

    fn search(&mut self, _step: Step, u: &mut Vector, decrement: &Vector, f: &mut Vector) -> Result<()> {
        let stage = self.stage.as_mut().ok_or_else(unprepared)?;
        stage.newton += 1;
        let astray = stage.newton == PATIENCE && !self.reuse;
        let stage = self.stage.as_ref().ok_or_else(unprepared)?;
        let outcome = match self.behind() {
            Some(_) if self.jumps(stage, decrement)? => self.jump(decrement)?,
            Some(_) if astray => self.start(stage.trial.clone())?,
            Some(behind) => {
                let sites = &stage.sites;
                let (taken, moved, gone) = self.along(&behind, sites, decrement)?;
                let along = (&taken[..], &moved[..], gone);
                // On the way down to a touch nothing says how far.
                let touches = stage.trial.in_contact() > 0;
                let forced = stage.placement.supports[0].is_some_and(|support| support.is_force());
                let falls = forced && !touches && self.face.interface.adhesion().is_none();
                self.with_laws(stage, |laws| match falls {
                    true => stage.trial.taken(sites, along, (1.0, laws)),
                    false => traction::length(sites, &stage.trial, along, laws).0,
                })
            }
            None => stage.trial.clone(),
        };
        let stage = self.stage.as_ref().ok_or_else(unprepared)?;
        write(u, outcome.tractions.iter().copied())?;
        self.write_last(Self::entries(&stage.sites, &outcome.shift), u)?;
        self.tried(outcome, f)
    }

    /// Converged below the tolerance times the tractions (of this or the accepted state, the larger; without any, times the
    /// first norm of the step), or at what round-off leaves. At least one iteration is made unless the first guess is as good as
    /// round-off, or nothing moves: what the accepted tractions then leave is of the step before, which was allowed it.
    fn test(&mut self, iteration: usize, _norm: f64) -> Verdict {
        let mut verdict = 0;
        let there = |stage: &&Stage<D>| !stage.sites.is_empty() && stage.jump.as_ref().is_none_or(Jump::is_free);
        if let Some(stage) = self.stage.as_ref().filter(there) {
            let trial = &stage.trial;
            let norm = trial.norm();
            let allowed = match iteration {
                0 if self.rests(stage, trial) => norm,
                0 => trial.noise(),
                _ => self.allowed(),
            };
            verdict = match norm {
                norm if !norm.is_finite() => 2,
                norm if norm <= allowed && self.jumped(stage) => 3,
                norm if norm <= allowed => 1,
                _ => 0,
            };
        }
        if verdict == 1 && self.falls() {
            verdict = 0;
        }
        self.comm.process_at_rank(0).broadcast_into(&mut verdict);
        self.jumps |= verdict == 3;
        match verdict {
            0 => Verdict::Iterate,
            1 => Verdict::Converged,
            _ => Verdict::Diverged,
        }
    }

    fn departure(&mut self, step: Step, u: &Vector) -> Result<f64> {
        let mut ends = self.displaced(&tractions::<D>(u, self.accepted.len())?)?.0;
        ends.resize(self.face.displacement().len(), 0.0);
        if !self.team().is_parted() {
            self.comm.process_at_rank(0).broadcast_into(&mut ends[..]);
        }
        let stage = self.stage.as_ref().ok_or_else(unprepared)?;
        let gone = self.gone(stage, stage.trial.shift);
        let placed = stage.placement.gone_on(&self.face.interface.placement(), gone);
        let departure = self.face.departure(step, &ends, placed);
        // However short the step, a jump is as long: what is to be located is when it comes.
        Ok(self.face.jump(&placed, &ends).map_or(departure, |usual| departure.min(usual)))
    }

    fn approach_under(&mut self, force: f64, duration: f64) -> Result<f64> {
        self.response.prepare(Step { t: duration, dt: duration })?;
        self.face.interface.place(Placement::default())?;
        let approach = || self.behind().map(|behind| traction::approach_under(&behind, force)).transpose();
        if self.team().is_parted() {
            return Ok(approach()?.unwrap_or(0.0));
        }
        Ok(share_numbers(&self.comm, || Ok(approach()?.into_iter().collect()))?.first().copied().unwrap_or(0.0))
    }

    /// What is accepted are the tractions that the laws made of the last ones: they keep the laws to the last digit.
    fn commit(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        self.enter(step)?;
        let outcome = self.outcome(u)?;
        let stage = self.stage.take().ok_or_else(unprepared)?;
        self.jumps = false;
        let gone = (self.gone(&stage, outcome.shift), self.freedom.height);
        let placement = self.face.placed(step.t, stage.placement, gone)?;
        let (met, states) = self.ends(&stage, &outcome);
        let (displacement, forces) = self.displaced(&met)?;
        self.scale = outcome.size();
        write(u, met.iter().copied())?;
        // TS takes the next solution as a change of this one, so that its digits depend on it.
        self.write_last([0.0; DIRECTIONS], u)?;
        self.before = std::mem::replace(&mut self.accepted, met);
        self.displacement.view_mut()?.copy_from_slice(&displacement);
        let (states, displacement) = self.share(states, displacement);
        self.face.commit((step.t, placement), states, displacement)?;
        self.response.commit(step, &self.displacement, &forces)
    }

    fn advice(&self) -> &'static str {
        match self.jumps {
            true => {
                "friction weakens there as it slips, so that the indenter jumps, and a shorter step jumps as far: give \
                 mount.tangential a mass, which takes time for it, or friction.coefficient values that rise again with v"
            }
            false => super::ADVICE,
        }
    }

    fn keep_account(&mut self, _layout: &Vector) -> Result<()> {
        self.face.keep_account()?;
        self.response.keep_account(&self.displacement)
    }

    fn keep_heat(&mut self) {
        self.face.keep_heat();
    }

    fn warm(&mut self, face: &[f64]) {
        self.face.interface.warm(face);
    }

    fn tempered(&mut self) -> Option<&mut dyn Tempered> {
        self.response.tempered()
    }

    fn energy(&self) -> Option<Energy> {
        self.face.energy().zip(self.response.energy()).map(|(face, body)| Energy::new(face, body))
    }

    fn save(&mut self, _u: &Vector, snapshot: &mut Snapshot) -> Result<()> {
        self.write_state(snapshot)
    }

    fn restore(&mut self, snapshot: &Snapshot, u: &mut Vector) -> Result<()> {
        self.read_state(snapshot, u)
    }

    fn contact(&mut self) -> Result<Contact<'_>> {
        Ok(self.face.contact())
    }

    fn bulk_fields(&mut self, _u: &Vector) -> Result<BulkFields> {
        self.recoveries += 1;
        let gather = match &mut self.gather {
            Some(gather) => gather,
            none => {
                let components: Vec<i32> = (0..(D * self.face.interface.nodes_everywhere()) as i32).collect();
                none.insert(Gather::new(&self.displacement, &components)?)
            }
        };
        self.response.bulk_fields(gather, &self.displacement)
    }

    fn work(&self) -> Work {
        let work = self.response.work();
        Work {
            tangential_laws: self.face.interface.tangential_laws(),
            recoveries: self.recoveries,
            transforms: work.transforms - self.transforms,
            ..work
        }
    }
}
