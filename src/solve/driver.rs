//! Steps a problem through its loading history under PETSc's TS.

use std::time::{Duration, Instant};

use super::adapt::{self, Controller};
use super::{Observer, Report, TransientProblem, Work};
use crate::error::{Error, Result};
use crate::loading::{Adaptive, Phase, SHORTEST, Target};
use crate::petsc::{Accepted, Attempt, CUT, Implicit, Integrator, Judgement, Matrix, Next, Step, Vector, Verdict};
use crate::snapshot::Snapshot;

/// Newton iterations per attempt: from stick to slip under a sharp regularisation a step takes up to fifty.
pub const MAX_NEWTON: usize = 60;
/// The same where a contact may jump, which is followed on the way.
pub const MAX_NEWTON_OF_JUMPS: usize = 400;

/// How often in succession a step may be cut by four.
const MAX_CUTS: usize = 8;

/// How often a planned step may be cut, all its pieces together: pieces grow back by two, so that one which needs a 32nd
/// of the planned step throughout is cut about twenty times.
const MOST_CUTS: usize = 40;

/// A problem on its way through its phases.
pub struct Driver<'a> {
    problem: &'a mut dyn TransientProblem,
    observer: &'a mut dyn Observer,
    phases: &'a [Phase],
    phase: usize,
    target: usize,
    /// The end of the last accepted step, s.
    now: f64,
    /// The length of the next step, s; none = as planned.
    dt: Option<f64>,
    /// Cuts of the planned step so far.
    cuts: usize,
    /// Of an adaptive phase.
    controller: Controller,
    /// The error of the last attempt in an adaptive phase, over what is allowed.
    error: f64,
    /// Newton iterations of the step so far.
    newton: usize,
    counts: Counts,
}

/// Where a run stands between two steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Position {
    /// Index of the phase of the next step.
    pub phase: usize,
    /// Index of the planned step within the phase.
    pub target: usize,
    /// The end of the last accepted step, s.
    pub now: f64,
    /// The length of the next step, s.
    pub dt: f64,
    /// Cuts of the planned step so far.
    pub cuts: usize,
    /// What chooses the steps of an adaptive phase.
    pub controller: Controller,
}

impl Position {
    /// Adds the position to a snapshot.
    pub fn save(&self, snapshot: &mut Snapshot) {
        let Self { phase, target, now, dt, cuts, controller } = self;
        let [last, error] = controller.save();
        snapshot.put("position", vec![*phase as f64, *target as f64, *now, *dt, *cuts as f64, last, error]);
    }

    /// The position that a snapshot holds.
    pub fn restore(snapshot: &Snapshot) -> Result<Self> {
        let [phase, target, now, dt, cuts, last, error] = snapshot.numbers("position")?;
        let controller = Controller::restore([last, error]);
        Ok(Self { phase: phase as usize, target: target as usize, now, dt, cuts: cuts as usize, controller })
    }

    /// The beginning of a phase; none beyond the last.
    pub fn start_of(phases: &[Phase], index: usize) -> Option<Self> {
        let phase = phases.get(index)?;
        let first = phase.steps.first()?;
        let dt = phase.adaptive.map_or(first.dt, |adaptive| adapt::landing(adaptive.first, first.dt));
        Some(Self { phase: index, target: 0, now: phase.start, dt, cuts: 0, controller: Controller::new() })
    }
}

/// What a run took.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Counts {
    /// Accepted steps.
    pub steps: usize,
    /// Accepted steps that were pieces of a planned one.
    pub pieces: usize,
    /// Attempts that were rejected: Newton's method failed, or the error was too large.
    pub rejected: usize,
    /// Newton iterations, those of rejected attempts included.
    pub newton: usize,
    /// What the problem did for it.
    pub work: Work,
    /// Residuals and tangents.
    pub assembly: Duration,
    /// What the observer took.
    pub output: Duration,
    /// All of it, from the first step to the last.
    pub total: Duration,
}

impl<'a> Driver<'a> {
    /// A driver at the beginning of the history.
    pub fn new(problem: &'a mut dyn TransientProblem, observer: &'a mut dyn Observer, phases: &'a [Phase]) -> Self {
        let (controller, counts) = (Controller::new(), Counts::default());
        Self {
            problem,
            observer,
            phases,
            phase: 0,
            target: 0,
            now: 0.0,
            dt: None,
            cuts: 0,
            newton: 0,
            controller,
            error: 0.0,
            counts,
        }
    }

    /// The same driver at a later position, where `counts` were counted before. The problem must have been restored
    /// to the state there.
    pub fn at(self, position: Position, counts: Counts) -> Self {
        let Position { phase, target, now, dt, cuts, controller } = position;
        Self { phase, target, now, dt: Some(dt), cuts, controller, counts, ..self }
    }

    /// Runs the rest of the history; `u` ends as the last accepted state.
    ///
    /// # Errors
    /// [`Error::Solver`] when a step fails after all cuts; what was accepted before has been observed.
    pub fn run(&mut self, integrator: &mut Integrator, tangent: &mut Matrix, u: &mut Vector) -> Result<()> {
        let Some(phase) = self.phases.get(self.phase) else { return Ok(()) };
        let Some(start) = Position::start_of(self.phases, self.phase) else { return Ok(()) };
        let first = self.attempt(self.dt.unwrap_or(start.dt));
        self.problem.begin(phase.clone())?;
        let begun = Instant::now();
        let outcome = integrator.solve(self, tangent, u, first);
        self.counts.total = begun.elapsed();
        outcome.map_err(|error| match error {
            Error::Solver(text) => Error::Solver(format!("phase {:?}: {text}", self.phases[self.phase].name)),
            other => other,
        })
    }

    /// What the run took so far.
    pub fn counts(&self) -> Counts {
        Counts { work: self.problem.work(), ..self.counts }
    }

    /// The next step, of length `dt`, and how often it may be cut.
    fn attempt(&self, dt: f64) -> Attempt {
        let phase = &self.phases[self.phase];
        // Below that times are not told apart, or no step is tried for the sake of a tolerance.
        let shortest = phase.end() * if phase.adaptive.is_some() { SHORTEST } else { f64::EPSILON };
        let worthwhile = (dt / shortest).log(CUT.recip()).max(0.0) as usize;
        let left = MOST_CUTS - self.cuts.min(MOST_CUTS);
        Attempt { now: self.now, dt, max_cuts: MAX_CUTS.min(left).min(worthwhile) }
    }

    /// What the present phase says of its steps, and where the next of them that is planned ends.
    fn plan(&self) -> (Option<Adaptive>, Target) {
        let phase = &self.phases[self.phase];
        (phase.adaptive, phase.steps[self.target])
    }

    /// The step after one that ended at `now` and was `dt` long, and was rejected before so many times.
    fn next(&mut self, dt: f64, rejected: usize) -> Result<Next> {
        let (adaptive, target) = self.plan();
        let remaining = target.time - self.now;
        let (next, near) = match adaptive {
            Some(adaptive) => {
                self.cuts = 0;
                (self.controller.accepted(&adaptive, (dt, self.error), rejected > 0), dt)
            }
            // Inside a planned step that was cut: grow back by two.
            None => (2.0 * dt, target.dt),
        };
        if remaining > 1e-9 * near {
            let land = if adaptive.is_some() { adapt::landing } else { f64::min };
            return Ok(Next::Step(self.attempt(land(next, remaining))));
        }
        self.cuts = 0;
        self.now = target.time;
        self.target += 1;
        if let Some(target) = self.phases[self.phase].steps.get(self.target) {
            let dt = adaptive.map_or(target.dt, |_| adapt::landing(next, target.time - self.now));
            return Ok(Next::Step(self.attempt(dt)));
        }
        Ok(match Position::start_of(self.phases, self.phase + 1) {
            Some(start) => {
                (self.phase, self.target, self.controller) = (start.phase, start.target, start.controller);
                self.problem.begin(self.phases[self.phase].clone())?;
                Next::Step(self.attempt(start.dt))
            }
            None => {
                (self.phase, self.target) = (self.phase + 1, 0);
                Next::Stop
            }
        })
    }
}

impl Implicit for Driver<'_> {
    fn residual(&mut self, step: Step, u: &Vector, rate: &Vector, f: &mut Vector) -> Result<()> {
        let begun = Instant::now();
        let outcome = self.problem.residual(step, u, rate, f);
        self.counts.assembly += begun.elapsed();
        outcome
    }

    fn jacobian(&mut self, step: Step, u: &Vector, rate: &Vector, jacobian: &mut Matrix) -> Result<()> {
        let begun = Instant::now();
        let outcome = self.problem.tangent(step, u, rate, jacobian);
        self.counts.assembly += begun.elapsed();
        outcome
    }

    fn multiply(&mut self, v: &Vector, product: &mut Vector) -> Result<()> {
        self.problem.multiply(v, product)
    }

    fn solve(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        self.problem.solve(b, x)
    }

    fn guess(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        self.problem.guess(step, u)
    }

    fn limit(&mut self, step: Step, u: &Vector, decrement: &mut Vector) -> Result<bool> {
        self.problem.limit(step, u, decrement)
    }

    fn search(&mut self, step: Step, u: &mut Vector, decrement: &Vector, f: &mut Vector) -> Result<()> {
        let begun = Instant::now();
        let outcome = self.problem.search(step, u, decrement, f);
        self.counts.assembly += begun.elapsed();
        outcome
    }

    fn test(&mut self, iteration: usize, norm: f64) -> Verdict {
        self.problem.test(iteration, norm)
    }

    fn advice(&self) -> &'static str {
        self.problem.advice()
    }

    fn judge(&mut self, step: Step, u: &Vector) -> Result<Judgement> {
        let phase = &self.phases[self.phase];
        let Some(adaptive) = &phase.adaptive else { return Ok(Judgement::Accept) };
        self.error = self.controller.error(adaptive, step.dt, self.problem.departure(step, u)?);
        if self.error <= 1.0 {
            return Ok(Judgement::Accept);
        }
        let fraction = Controller::retry(self.error);
        match fraction * step.dt > SHORTEST * phase.end() {
            true => Ok(Judgement::Retry(fraction)),
            false => Err(Error::Solver(format!(
                "the local error of a step of {:.3e} s to t = {:.6e} s is {:.1e} times what the tolerance allows, and no \
                 shorter one is tried: give a larger tolerance, or steps",
                step.dt, step.t, self.error
            ))),
        }
    }

    fn accepted(&mut self, accepted: Accepted, u: &mut Vector) -> Result<Next> {
        self.cuts += accepted.cuts;
        self.counts.rejected += accepted.cuts;
        self.newton += accepted.newton;
        self.problem.commit(accepted.step, u)?;
        let newton = std::mem::take(&mut self.newton);
        let phase = self.phase;
        let (adaptive, target) = self.plan();
        self.now = accepted.step.t;
        let next = self.next(accepted.step.dt, accepted.cuts)?;
        let reached = self.now == target.time;
        let planned = reached || adaptive.is_some();
        self.counts.steps += 1;
        self.counts.pieces += usize::from(!planned);
        self.counts.newton += newton;
        let report = Report {
            phase,
            time: self.now,
            dt: accepted.step.dt,
            planned,
            phase_end: self.phase != phase,
            bulk_output: target.bulk_output && reached,
            newton,
            counts: self.counts,
            next: match next {
                Next::Step(Attempt { now, dt, .. }) => Some(Position {
                    phase: self.phase,
                    target: self.target,
                    now,
                    dt,
                    cuts: self.cuts,
                    controller: self.controller,
                }),
                Next::Stop => None,
            },
            problem: &mut *self.problem,
            u,
        };
        let begun = Instant::now();
        self.observer.observe(report)?;
        self.counts.output += begun.elapsed();
        Ok(next)
    }
}
