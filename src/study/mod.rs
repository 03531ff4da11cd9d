//! Accuracy against cost: a scene solved over ladders of settings, one at a time, and what is cheapest for an error.
//!
//! The error of a run against a finer one is the largest difference of a force over the history, at the moments of the
//! coarser run (the finer one in between by straight lines), relative to the largest value that the force has in the
//! finer run. It is that of N or of Q, the larger one; without friction, of N or of the hysteretic force.
//!
//! Errors of settings that are changed together are taken to add up, and their costs to multiply; what is advised is
//! then solved and measured against the finest rungs of all ladders together.

pub mod advice;
pub mod figure;
pub mod ladder;
pub mod roughness;
mod softness;

use std::path::Path;
use std::time::Instant;

use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Root};

use crate::error::{Error, Result};
use crate::output::HistoryRow;
use crate::parallel::share_text;
use crate::petsc;
use crate::scene::{self, Scene, Source};
use crate::solution::{self, Solution};
use crate::warnings::Warning;

use ladder::Ladder;

/// The scene that is studied.
pub struct Subject<'a> {
    comm: &'a SimpleCommunicator,
    /// The content of its file.
    pub text: String,
    /// The file, and what is changed of it throughout.
    pub source: Source,
}

impl<'a> Subject<'a> {
    /// Reads the scene on all ranks of `comm`.
    pub fn read(comm: &'a SimpleCommunicator, source: Source) -> Result<Self> {
        let text = share_text(comm, || scene::open(&source.file))?;
        Ok(Self { comm, text, source })
    }

    /// The scene with further changes, `key=value` as after `--set`. Collective.
    pub fn with(&self, changes: &[String]) -> Result<Scene> {
        let overrides = self.source.overrides.iter().chain(changes).cloned().collect();
        let open = |file: &Path| share_text(self.comm, || scene::open(file));
        scene::read_with(&self.text, &Source { file: self.source.file.clone(), overrides }, &open)
    }
}

/// One scene solved.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// N, Q and so on.
    pub history: Vec<HistoryRow>,
    /// Accepted steps.
    pub steps: usize,
    /// Newton iterations.
    pub newton: usize,
    /// From the scene to the end, s, on rank 0.
    pub seconds: f64,
    /// The largest resident memory of rank 0 while it ran, bytes.
    pub memory: f64,
    /// What is doubtful about it.
    pub warnings: Vec<Warning>,
}

/// The hysteretic force counts in full where it comes to this share of N, and in proportion where it is less: a symmetric
/// profile at rest and an elastic body have nothing of it but round-off and the mesh's error.
const HYSTERETIC: f64 = 1e-3;

/// The largest differences of the forces between two histories, over the largest value of each.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Difference {
    /// Of N.
    pub normal: f64,
    /// Of Q.
    pub tangential: f64,
    /// Of the hysteretic force.
    pub hysteretic: f64,
    /// By how much the hysteretic force counts, 0 to 1.
    pub weight: f64,
}

impl Difference {
    /// Of `coarse` from `fine`.
    pub fn between(coarse: &[HistoryRow], fine: &[HistoryRow]) -> Self {
        let largest = |force: fn(&HistoryRow) -> f64| fine.iter().map(|row| force(row).abs()).fold(0.0, f64::max);
        let of = |force: fn(&HistoryRow) -> f64| {
            let largest = largest(force);
            let off = coarse.iter().map(|row| (force(row) - at(fine, row.time, force)).abs()).fold(0.0, f64::max);
            if off == 0.0 { 0.0 } else { off / largest }
        };
        Self {
            normal: of(|row| row.normal_force),
            tangential: of(|row| row.tangential_force),
            hysteretic: of(|row| row.hysteretic_force),
            weight: match HYSTERETIC * largest(|row| row.normal_force) {
                full if full > 0.0 => (largest(|row| row.hysteretic_force) / full).min(1.0),
                _ => 0.0,
            },
        }
    }

    /// The one number that counts.
    pub fn error(&self) -> f64 {
        self.normal.max(self.tangential).max(self.weight * self.hysteretic)
    }
}

/// A force of a history at the time `t`, s, by straight lines.
fn at(history: &[HistoryRow], t: f64, force: fn(&HistoryRow) -> f64) -> f64 {
    let after = history.partition_point(|row| row.time < t);
    match (after.checked_sub(1).and_then(|before| history.get(before)), history.get(after)) {
        (Some(a), Some(b)) => force(a) + (force(b) - force(a)) * (t - a.time) / (b.time - a.time),
        (Some(only), None) | (None, Some(only)) => force(only),
        (None, None) => 0.0,
    }
}

/// A ladder climbed.
pub struct Climbed {
    /// The ladder.
    pub ladder: Ladder,
    /// What each rung came to, coarse to fine.
    pub rungs: Vec<Rung>,
    /// The order of convergence, where it is clean; see [`clean_order`].
    pub order: Option<f64>,
    /// The error of the finest rung.
    pub finest: f64,
}

/// One rung.
pub struct Rung {
    /// Its run; none where the solver gave up.
    pub run: Option<Run>,
    /// From the finest rung.
    pub difference: Difference,
    /// The difference and the error of the finest rung together.
    pub error: f64,
}

/// Solves scenes, each only once.
pub struct Solver<'a> {
    subject: &'a Subject<'a>,
    done: Vec<(Scene, Option<Run>)>,
    tell: &'a dyn Fn(&str, Option<&Run>),
    reason: String,
}

impl<'a> Solver<'a> {
    /// On all ranks of the subject. Each run is told to `tell`, with its changes.
    pub fn new(subject: &'a Subject<'a>, tell: &'a dyn Fn(&str, Option<&Run>)) -> Self {
        Self { subject, done: Vec::new(), tell, reason: String::new() }
    }

    /// Why the last run that gave up did so.
    pub fn reason(&self) -> &str {
        &self.reason
    }

    /// The run of the subject with changes; none where the solver gives up. The same on all ranks.
    pub fn run(&mut self, changes: &[String]) -> Result<Option<Run>> {
        let Subject { comm, source, .. } = self.subject;
        let scene = self.subject.with(changes)?;
        if let Some((_, run)) = self.done.iter().find(|(done, _)| *done == scene) {
            return Ok(run.clone());
        }
        petsc::reset_peak_memory();
        let begun = Instant::now();
        let run = match solution::solve_beside(comm, &scene, &source.file) {
            Ok(solution) => {
                let mut cost = [begun.elapsed().as_secs_f64(), petsc::peak_memory() as f64];
                // What is chosen by cost is chosen alike by all.
                comm.process_at_rank(0).broadcast_into(&mut cost);
                let [seconds, memory] = cost;
                let counts = solution.counts;
                let (steps, newton) = (counts.steps, counts.newton);
                let Solution { history, warnings, .. } = solution;
                Some(Run { history, steps, newton, seconds, memory, warnings })
            }
            Err(Error::Solver(reason) | Error::Domain(reason)) => {
                self.reason = reason;
                None
            }
            Err(other) => return Err(other),
        };
        (self.tell)(&changes.join(" "), run.as_ref());
        self.done.push((scene, run.clone()));
        Ok(run)
    }

    /// Climbs a ladder: the errors of its rungs against the finest that could be solved.
    ///
    /// # Errors
    /// [`Error::Solver`] when none could be.
    pub fn climb(&mut self, ladder: Ladder) -> Result<Climbed> {
        let changes: Vec<Vec<String>> = ladder.rungs.iter().map(|rung| rung.changes.clone()).collect();
        let runs = changes.iter().map(|changes| self.run(changes)).collect::<Result<Vec<_>>>()?;
        let Some(finest) = runs.iter().rev().flatten().next().cloned() else {
            return Err(Error::Solver(format!("no rung of the ladder {:?} could be solved", ladder.name)));
        };
        let differences: Vec<Option<Difference>> =
            runs.iter().map(|run| run.as_ref().map(|run| Difference::between(&run.history, &finest.history))).collect();
        let between = |pair: &[Option<Run>]| match pair {
            [Some(coarse), Some(fine)] => Some(Difference::between(&coarse.history, &fine.history).error()),
            _ => None,
        };
        let exact = ladder.exact && runs.last().is_some_and(Option::is_some);
        // What falls by a constant ratio from rung to rung: what they change, or how far they are from the limit.
        let successive: Option<Vec<f64>> = match exact {
            true => differences.iter().rev().skip(1).rev().map(|off| off.map(|off| off.error())).collect(),
            false => runs.windows(2).map(between).collect(),
        };
        let order = match (&successive, ladder.ratio) {
            (Some(successive), Some(ratio)) => clean_order(successive, ratio),
            _ => None,
        };
        let last = successive.as_ref().and_then(|successive| successive.last().copied()).unwrap_or(0.0);
        let left = match (order, ladder.ratio) {
            _ if exact => 0.0,
            (Some(order), Some(ratio)) => last / (ratio.powf(order) - 1.0),
            // What first order would leave after a refinement by two.
            (None, Some(_)) => last,
            // Alternatives are no refinements.
            (_, None) => 0.0,
        };
        let rung = |(run, difference): (Option<Run>, Option<Difference>)| {
            let difference = difference.unwrap_or_default();
            Rung { error: difference.error() + left, run, difference }
        };
        let rungs = runs.into_iter().zip(differences).map(rung).collect();
        Ok(Climbed { ladder, rungs, order, finest: left })
    }
}

/// The order p of a quantity whose changes between rungs, each finer by `ratio`, are `successive`: their logarithms fall
/// by p ln(ratio). Clean where the last two such orders lie within 0.4 and above 0.4, or where the only one is within 0.1
/// of 1 or 2.
pub fn clean_order(successive: &[f64], ratio: f64) -> Option<f64> {
    let orders: Vec<f64> = successive.windows(2).map(|pair| (pair[0] / pair[1]).ln() / ratio.ln()).collect();
    let clean = match orders.as_slice() {
        [] => false,
        [only] => [1.0, 2.0].iter().any(|whole| (only - whole).abs() < 0.1),
        [.., before, last] => (last - before).abs() < 0.4 && *last > 0.4 && *before > 0.4,
    };
    orders.last().copied().filter(|_| clean)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 + h^2 has order 2; changes that fall unevenly have none, and two of them tell only of a whole order.
    #[test]
    fn orders_that_are_clean() {
        let changes: Vec<f64> = (0..3).map(|i| 0.25f64.powi(i)).collect();
        assert!((clean_order(&changes, 2.0).unwrap_or(0.0) - 2.0).abs() < 1e-12);
        assert_eq!(clean_order(&[1.0, 0.1, 0.09], 2.0), None);
        assert!((clean_order(&[1.0, 0.1], 10.0).unwrap_or(0.0) - 1.0).abs() < 1e-12);
        assert_eq!(clean_order(&[1.0, 0.3], 10.0), None);
        assert_eq!(clean_order(&[1.0, 1.0, 1.0], 2.0), None);
        assert_eq!((clean_order(&[1.0], 2.0), clean_order(&[1.0, 0.0, 0.0], 2.0)), (None, None));
    }

    /// The largest difference over the history, between the rows of the finer one by straight lines.
    #[test]
    fn differences_are_relative_to_the_largest_value() {
        let row = |time: f64, normal_force: f64, tangential_force: f64| HistoryRow {
            time,
            normal_force,
            tangential_force,
            ..HistoryRow::default()
        };
        let fine = [row(0.0, 0.0, 0.0), row(1.0, 2.0, 0.5), row(2.0, 4.0, -1.0)];
        let coarse = [row(0.0, 0.0, 0.0), row(1.5, 3.4, -0.25)];
        let difference = Difference::between(&coarse, &fine);
        assert!((difference.normal - 0.1).abs() < 1e-15 && difference.tangential.abs() < 1e-15);
        assert!((difference.error() - 0.1).abs() < 1e-15);
    }
}
