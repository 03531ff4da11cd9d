//! Steps a problem through its loading history under PETSc's TS.

use std::time::{Duration, Instant};

use mpi::topology::SimpleCommunicator;

use super::{Observer, Report, TransientProblem};
use crate::error::{Error, Result};
use crate::loading::Phase;
use crate::petsc::{Accepted, Implicit, Integrator, Matrix, Next, Settings, Step, Vector, Verdict};

/// What the driver may do to get through a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Newton iterations per attempt.
    pub max_newton: usize,
    /// How often a step may be cut by four.
    pub max_cuts: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { max_newton: 30, max_cuts: 8 }
    }
}

/// A problem on its way through its phases.
pub struct Driver<'a> {
    problem: &'a mut dyn TransientProblem,
    observer: &'a mut dyn Observer,
    phases: &'a [Phase],
    phase: usize,
    target: usize,
    /// The end of the last accepted step, s.
    now: f64,
    counts: Counts,
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
        Self { problem, observer, phases, phase: 0, target: 0, now: 0.0, counts: Counts::default() }
    }

    /// Runs the whole history from rest; `u` ends as the last accepted state.
    ///
    /// # Errors
    /// [`Error::Solver`] when a step fails after all cuts; what was accepted before has been observed.
    pub fn run(
        &mut self,
        comm: &SimpleCommunicator,
        settings: Settings,
        tangent: &mut Matrix,
        u: &mut Vector,
    ) -> Result<()> {
        let Some(first) = self.phases.first() else { return Ok(()) };
        let start = Step { t: first.steps[0].time, dt: first.steps[0].dt };
        self.problem.begin(first.clone());
        let begun = Instant::now();
        let outcome = Integrator::new(comm, settings)?.solve(self, tangent, u, start);
        self.counts.total = begun.elapsed();
        outcome.map_err(|error| match error {
            Error::Solver(text) => Error::Solver(format!("phase {:?}: {text}", self.phases[self.phase].name)),
            other => other,
        })
    }

    /// What the run took so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// The step after one that ended at `now` and was `dt` long.
    fn next(&mut self, dt: f64) -> Next {
        let target = self.phases[self.phase].steps[self.target];
        let remaining = target.time - self.now;
        if remaining > 1e-9 * target.dt {
            // Inside a planned step that was cut: grow back by two.
            return Next::Step { now: self.now, dt: remaining.min(2.0 * dt) };
        }
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
        Next::Step { now: self.now, dt: self.phases[self.phase].steps[self.target].dt }
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

    fn test(&mut self, iteration: usize, norm: f64) -> Verdict {
        self.problem.test(iteration, norm)
    }

    fn accepted(&mut self, accepted: Accepted, u: &Vector) -> Result<Next> {
        self.problem.commit(accepted.step, u)?;
        let phase = self.phase;
        let target = self.phases[phase].steps[self.target];
        self.now = accepted.step.t;
        let next = self.next(accepted.step.dt);
        let report = Report {
            phase,
            time: self.now,
            planned: self.now == target.time,
            phase_end: self.phase != phase,
            bulk_output: target.bulk_output && self.now == target.time,
            newton: accepted.newton,
            problem: &mut *self.problem,
            u,
        };
        self.counts.steps += 1;
        self.counts.pieces += usize::from(!report.planned);
        self.counts.newton += accepted.newton;
        let begun = Instant::now();
        self.observer.observe(report)?;
        self.counts.output += begun.elapsed();
        Ok(next)
    }
}
