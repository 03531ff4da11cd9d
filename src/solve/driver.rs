//! Steps a problem through its loading history under PETSc's TS.

use std::time::{Duration, Instant};

use super::{Observer, Report, TransientProblem, Work};
use crate::error::{Error, Result};
use crate::loading::Phase;
use crate::petsc::{Accepted, Attempt, Implicit, Integrator, Matrix, Next, Step, Vector, Verdict};
use crate::snapshot::Snapshot;

/// Newton iterations per attempt: from stick to slip under a sharp regularisation a step takes up to fifty.
pub const MAX_NEWTON: usize = 60;

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
    /// Newton iterations of the step so far.
    newton: usize,
    /// Only where steps may have to be solved again.
    rounds: Option<Rounds>,
    counts: Counts,
}

/// The rounds of a step that is solved until the problem augments it no more.
struct Rounds {
    /// The accepted solution, from which each round begins.
    start: Vector,
    /// What the last round came to, and how long the step was, s; none before the first.
    last: Vector,
    dt: Option<f64>,
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
}

impl Position {
    /// Adds the position to a snapshot.
    pub fn save(&self, snapshot: &mut Snapshot) {
        snapshot.put("position", vec![self.phase as f64, self.target as f64, self.now, self.dt, self.cuts as f64]);
    }

    /// The position that a snapshot holds.
    pub fn restore(snapshot: &Snapshot) -> Result<Self> {
        let [phase, target, now, dt, cuts] = snapshot.numbers("position")?;
        Ok(Self { phase: phase as usize, target: target as usize, now, dt, cuts: cuts as usize })
    }
}

/// What a run took.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Counts {
    /// Accepted steps.
    pub steps: usize,
    /// Accepted steps that were pieces of a planned one.
    pub pieces: usize,
    /// Newton iterations, those of rejected attempts included.
    pub newton: usize,
    /// How often a step was solved again with other multipliers.
    pub augmentations: usize,
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
            rounds: None,
            counts: Counts::default(),
        }
    }

    /// The same driver at a later position, where `counts` were counted before. The problem must have been restored
    /// to the state there.
    pub fn at(self, position: Position, counts: Counts) -> Self {
        let Position { phase, target, now, dt, cuts } = position;
        Self { phase, target, now, dt: Some(dt), cuts, counts, ..self }
    }

    /// Runs the rest of the history; `u` ends as the last accepted state.
    ///
    /// # Errors
    /// [`Error::Solver`] when a step fails after all cuts; what was accepted before has been observed.
    pub fn run(&mut self, integrator: &mut Integrator, tangent: &mut Matrix, u: &mut Vector) -> Result<()> {
        let Some(phase) = self.phases.get(self.phase) else { return Ok(()) };
        let Some(target) = phase.steps.get(self.target) else { return Ok(()) };
        let first = self.attempt(self.dt.unwrap_or(target.dt));
        self.problem.begin(phase.clone());
        if self.problem.is_augmented() {
            let (mut start, last) = (u.like()?, u.like()?);
            start.copy_from(u)?;
            self.rounds = Some(Rounds { start, last, dt: None });
        }
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
        Attempt { now: self.now, dt, max_cuts: MAX_CUTS.min(MOST_CUTS - self.cuts.min(MOST_CUTS)) }
    }

    /// The step after one that ended at `now` and was `dt` long.
    fn next(&mut self, dt: f64) -> Next {
        let target = self.phases[self.phase].steps[self.target];
        let remaining = target.time - self.now;
        if remaining > 1e-9 * target.dt {
            // Inside a planned step that was cut: grow back by two.
            return Next::Step(self.attempt(remaining.min(2.0 * dt)));
        }
        self.cuts = 0;
        self.now = target.time;
        self.target += 1;
        if self.target == self.phases[self.phase].steps.len() {
            self.target = 0;
            self.phase += 1;
            match self.phases.get(self.phase) {
                Some(phase) => self.problem.begin(phase.clone()),
                None => return Next::Stop,
            }
        }
        Next::Step(self.attempt(self.phases[self.phase].steps[self.target].dt))
    }
}

impl Rounds {
    /// Another round of a step that has come to `u`.
    fn again(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        self.dt = Some(step.dt);
        self.last.copy_from(u)?;
        u.copy_from(&self.start)
    }

    /// The step is accepted at `u`.
    fn over(&mut self, u: &Vector) -> Result<()> {
        self.dt = None;
        self.start.copy_from(u)
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
        match &self.rounds {
            Some(rounds) if rounds.dt == Some(step.dt) => u.copy_from(&rounds.last),
            _ => self.problem.guess(step, u),
        }
    }

    fn limit(&mut self, step: Step, u: &Vector, decrement: &mut Vector) -> Result<bool> {
        self.problem.limit(step, u, decrement)
    }

    fn test(&mut self, iteration: usize, norm: f64) -> Verdict {
        self.problem.test(iteration, norm)
    }

    fn accepted(&mut self, accepted: Accepted, u: &mut Vector) -> Result<Next> {
        self.cuts += accepted.cuts;
        self.newton += accepted.newton;
        if let Some(rounds) = &mut self.rounds {
            if self.problem.augment(accepted.step, u)? {
                rounds.again(accepted.step, u)?;
                self.counts.augmentations += 1;
                return Ok(Next::Step(self.attempt(accepted.step.dt)));
            }
            rounds.over(u)?;
        }
        self.problem.commit(accepted.step, u)?;
        let newton = std::mem::take(&mut self.newton);
        let phase = self.phase;
        let target = self.phases[phase].steps[self.target];
        self.now = accepted.step.t;
        let next = self.next(accepted.step.dt);
        let planned = self.now == target.time;
        self.counts.steps += 1;
        self.counts.pieces += usize::from(!planned);
        self.counts.newton += newton;
        let report = Report {
            phase,
            time: self.now,
            planned,
            phase_end: self.phase != phase,
            bulk_output: target.bulk_output && planned,
            newton,
            counts: self.counts,
            next: match next {
                Next::Step(Attempt { now, dt, .. }) => {
                    Some(Position { phase: self.phase, target: self.target, now, dt, cuts: self.cuts })
                }
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
