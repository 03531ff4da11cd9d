//! Which settings are cheapest for an error.

use super::{Climbed, Difference, Run, Solver};
use crate::error::Result;

/// Settings for an error, as they were predicted and as they were measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// The error asked for.
    pub target: f64,
    /// The settings, `key=value` as after `--set`.
    pub changes: Vec<String>,
    /// The error against the finest rungs of all ladders together, with what these leave.
    pub error: f64,
    /// s
    pub seconds: f64,
    /// bytes
    pub memory: f64,
}

/// A rung of each ladder.
struct Choice {
    rungs: Vec<usize>,
    error: f64,
    cost: f64,
}

/// All choices, the cheapest first; errors add up and costs multiply.
fn choices(climbed: &[Climbed], base: &Run) -> Vec<Choice> {
    let mut all = vec![Choice { rungs: Vec::new(), error: 0.0, cost: base.seconds }];
    for ladder in climbed {
        let rungs =
            || ladder.rungs.iter().enumerate().filter_map(|(i, rung)| Some((i, rung.run.as_ref()?, rung.error)));
        let extended = |choice: &Choice| {
            rungs()
                .map(|(i, run, error)| Choice {
                    rungs: choice.rungs.iter().copied().chain([i]).collect(),
                    error: choice.error + error,
                    cost: choice.cost * run.seconds / base.seconds,
                })
                .collect::<Vec<_>>()
        };
        all = all.iter().flat_map(extended).collect();
    }
    all.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    all
}

fn changes(climbed: &[Climbed], rungs: impl IntoIterator<Item = usize>) -> Vec<String> {
    climbed.iter().zip(rungs).flat_map(|(ladder, rung)| ladder.ladder.rungs[rung].changes.clone()).collect()
}

/// The finest rung of each ladder that could be solved, all together.
pub fn finest(climbed: &[Climbed]) -> Vec<String> {
    let last = |ladder: &Climbed| ladder.rungs.iter().rposition(|rung| rung.run.is_some()).unwrap_or(0);
    changes(climbed, climbed.iter().map(last))
}

/// The cheapest settings for each of the `targets`, solved and measured against `reference`; none where no choice meets
/// one. `base` is the run of the scene as it is.
pub fn advise(
    solver: &mut Solver<'_>,
    climbed: &[Climbed],
    (base, reference): (&Run, &Run),
    targets: &[f64],
) -> Result<Vec<Option<Advice>>> {
    let all = choices(climbed, base);
    let left: f64 = climbed.iter().map(|ladder| ladder.finest).sum();
    let found = targets.iter().map(|&target| cheapest(solver, climbed, &all, (reference, left), target));
    let found = found.collect::<Result<Vec<_>>>()?;
    // What was found for a smaller error may have turned out cheaper still.
    let best = |&target: &f64| {
        let meeting = found.iter().flatten().filter(|advice| advice.error <= target);
        let cheapest = meeting.min_by(|a, b| a.seconds.total_cmp(&b.seconds));
        cheapest.map(|advice| Advice { target, ..advice.clone() })
    };
    Ok(targets.iter().map(best).collect())
}

/// The first of the choices, by cost, that is predicted to meet the target and then does; of those that cost the same, as clocks
/// go, the most accurate. One that misses it raises what the prediction of the following ones must leave.
fn cheapest(
    solver: &mut Solver<'_>,
    climbed: &[Climbed],
    choices: &[Choice],
    (reference, left): (&Run, f64),
    target: f64,
) -> Result<Option<Advice>> {
    const TRIES: usize = 6;
    const THE_SAME: f64 = 1.1;
    let mut allowed = target;
    for _ in 0..TRIES {
        let mut meeting = choices.iter().filter(|choice| choice.error <= allowed).peekable();
        let dearest = meeting.peek().map_or(0.0, |first| THE_SAME * first.cost);
        let as_cheap = meeting.take_while(|choice| choice.cost <= dearest);
        let Some(choice) = as_cheap.min_by(|a, b| a.error.total_cmp(&b.error)) else { return Ok(None) };
        let changes = changes(climbed, choice.rungs.iter().copied());
        let measured = solver.run(&changes)?.map(|run| {
            let error = Difference::between(&run.history, &reference.history).error() + left;
            Advice { target, changes, error, seconds: run.seconds, memory: run.memory }
        });
        match measured {
            Some(advice) if advice.error <= target => return Ok(Some(advice)),
            Some(advice) => allowed = (allowed * target / advice.error).min(choice.error * 0.999),
            None => allowed = choice.error * 0.999,
        }
    }
    Ok(None)
}
