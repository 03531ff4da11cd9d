//! Where a run starts from: rest, its own checkpoint, or the state at the end of phases that it shares with others.

use std::path::Path;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use crate::error::{Error, Result};
use crate::loading::Phase;
use crate::output::{Rows, checkpoint, left};
use crate::parallel::agree;
use crate::scene::{Scene, differences};
use crate::snapshot::Snapshot;
use crate::solve::{Counts, Position};

/// Where a run starts from.
#[derive(Debug, Clone, Copy)]
pub enum Origin<'a> {
    /// Rest; a result file and a checkpoint at the same place are replaced.
    Rest,
    /// The checkpoint beside the result file.
    Checkpoint,
    /// The end of the first phases, which were solved in a run of their own.
    Shared {
        /// The result file of that run.
        results: &'a Path,
        /// How many phases.
        phases: usize,
    },
}

/// A state to go on from; the same on every rank.
pub struct Begun {
    /// The state of the problem.
    pub snapshot: Snapshot,
    /// Where the driver goes on.
    pub position: Position,
    /// What was counted up to there.
    pub counts: Counts,
    /// Planned steps done.
    pub planned_steps: usize,
    /// Rows of the result file that count.
    pub rows: Rows,
    /// When the run began, as the result file has it.
    pub started: String,
}

impl Origin<'_> {
    /// The state to go on from; none at rest. Collective.
    pub fn load(self, comm: &SimpleCommunicator, out: &Path, phases: &[Phase]) -> Result<Option<Begun>> {
        let file = match self {
            Self::Rest => return Ok(None),
            Self::Checkpoint => out,
            Self::Shared { results, .. } => results,
        };
        let mine = if comm.rank() == 0 { stored(file) } else { Ok((Snapshot::default(), String::new())) };
        let (snapshot, started) = agree(comm, mine)?;
        let snapshot = snapshot.shared(comm);
        let position = match self {
            Self::Shared { phases: count, .. } => start_of(phases, count)?,
            _ => Position::restore(&snapshot)?,
        };
        if phases.get(position.phase).and_then(|phase| phase.steps.get(position.target)).is_none() {
            return Err(Error::Usage(format!("{}: its checkpoint is beyond the loading history", file.display())));
        }
        let [steps, pieces, newton, augmentations, planned_steps] =
            snapshot.numbers("counts")?.map(|count: f64| count as usize);
        let [history, interface, bulk] = snapshot.numbers("rows")?.map(|count: f64| count as usize);
        Ok(Some(Begun {
            position,
            counts: Counts { steps, pieces, newton, augmentations, ..Counts::default() },
            planned_steps,
            rows: Rows { history, interface, bulk },
            started,
            snapshot,
        }))
    }
}

/// The state that was left beside a result file, and when its run began.
fn stored(results: &Path) -> Result<(Snapshot, String)> {
    let Some(found) = checkpoint::read(results)? else {
        return Err(Error::Usage(format!(
            "{}: there is no checkpoint ({}) to go on from; run without --resume",
            results.display(),
            checkpoint::beside(results).display()
        )));
    };
    let mut snapshot = Snapshot::default();
    for (name, values) in found.fields {
        snapshot.put(name, values);
    }
    Ok((snapshot, found.started))
}

/// Adds what [`Begun`] holds besides the state of the problem.
pub fn save_counts(snapshot: &mut Snapshot, counts: Counts, planned_steps: usize) {
    let Counts { steps, pieces, newton, augmentations, .. } = counts;
    snapshot.put("counts", [steps, pieces, newton, augmentations, planned_steps].map(|count| count as f64).to_vec());
}

/// Adds the rows of the result file that count.
pub fn save_rows(snapshot: &mut Snapshot, rows: Rows) {
    snapshot.put("rows", [rows.history, rows.interface, rows.bulk].map(|count| count as f64).to_vec());
}

/// Where the phase after the first `count` begins.
fn start_of(phases: &[Phase], count: usize) -> Result<Position> {
    let before = count.checked_sub(1).and_then(|last| phases.get(last)?.steps.last());
    let first = phases.get(count).and_then(|phase| phase.steps.first());
    match (before, first) {
        (Some(before), Some(first)) => {
            Ok(Position { phase: count, target: 0, now: before.time, dt: first.dt, cuts: 0 })
        }
        _ => Err(Error::Internal(format!("no phase begins after {count} of {}", phases.len()))),
    }
}

/// Whether the run whose results are at `out` is already complete; an error when it is not one that can go on. To be
/// called on one rank.
pub fn is_complete(out: &Path, scene: &Scene) -> Result<bool> {
    let file = out.display();
    let Some(left) = left(out)? else {
        return Err(Error::Usage(format!("{file}: there is nothing to resume; run without --resume")));
    };
    refuse_another_scene(out, &left.scene, scene)?;
    if left.status == "complete" {
        return Ok(true);
    }
    let Some(found) = checkpoint::read(out)? else {
        let reason = "the run was stopped before its first checkpoint; run without --resume (output.checkpoint_every = N \
                      writes one after every N steps)";
        return Err(Error::Usage(format!("{file}: {reason}")));
    };
    refuse_another_scene(&checkpoint::beside(out), &found.scene, scene)?;
    if found.started != left.started {
        let reason =
            format!("{}: belongs to another run than {file}; run without --resume", checkpoint::beside(out).display());
        return Err(Error::Usage(reason));
    }
    Ok(false)
}

fn refuse_another_scene(file: &Path, stored: &str, scene: &Scene) -> Result<()> {
    const SHOWN: usize = 4;
    let found = differences(stored, &scene.to_toml());
    if found.is_empty() {
        return Ok(());
    }
    let more = match found.len().saturating_sub(SHOWN) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    let shown: Vec<&str> = found.iter().take(SHOWN).map(String::as_str).collect();
    Err(Error::Usage(format!(
        "{}: is of another scene and cannot be resumed: {}{more}",
        file.display(),
        shown.join("; ")
    )))
}
