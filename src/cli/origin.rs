//! Where a run starts from: rest, its own checkpoint, or the state at the end of phases that it shares with others.

use std::path::Path;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use crate::composition;
use crate::error::{Error, Result};
use crate::loading::Phase;
use crate::output::{self, Left, Rows, checkpoint, left};
use crate::parallel::agree;
use crate::scene::{Scene, differences, obstacles};
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
        let counts = snapshot.numbers("counts")?.map(|count: f64| count as usize);
        let [steps, pieces, rejected, newton, planned_steps] = counts;
        Ok(Some(Begun {
            position,
            counts: Counts { steps, pieces, rejected, newton, ..Counts::default() },
            planned_steps,
            rows: rows_of(&snapshot)?,
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
    let Counts { steps, pieces, rejected, newton, .. } = counts;
    snapshot.put("counts", [steps, pieces, rejected, newton, planned_steps].map(|count| count as f64).to_vec());
}

/// Adds the rows of the result file that count.
pub fn save_rows(snapshot: &mut Snapshot, rows: Rows) {
    snapshot.put("rows", [rows.history, rows.interface, rows.bulk].map(|count| count as f64).to_vec());
    let halves = rows.sums.iter().flat_map(|sum| [sum >> 32, sum & 0xffff_ffff]);
    snapshot.put("sums", halves.map(|half| half as f64).collect());
}

/// The rows of the result file that count, as [`save_rows`] keeps them.
fn rows_of(snapshot: &Snapshot) -> Result<Rows> {
    let [history, interface, bulk] = snapshot.numbers("rows")?.map(|count: f64| count as usize);
    // Sums have more digits than a number holds: each is in two halves.
    let halves: [f64; 6] = snapshot.numbers("sums")?;
    let sums = [0, 2, 4].map(|i| (halves[i] as u64) << 32 | halves[i + 1] as u64);
    Ok(Rows { history, interface, bulk, sums })
}

/// Whether the results are still what the checkpoint beside them counts. To be called on one rank.
pub fn is_intact(results: &Path) -> Result<()> {
    output::intact(results, rows_of(&stored(results)?.0)?)
}

/// Where the phase after the first `count` begins.
fn start_of(phases: &[Phase], count: usize) -> Result<Position> {
    let no_such = || Error::Internal(format!("no phase begins after {count} of {}", phases.len()));
    Position::start_of(phases, count).ok_or_else(no_such)
}

/// Whether results are those of the scene in `file` and of the files that it names, as these are now.
pub fn is_of(left: &Left, scene: &Scene, file: &Path) -> bool {
    differences(&left.scene, &scene.to_toml()).is_empty()
        && composition::inputs(scene, file).is_ok_and(|inputs| inputs == left.inputs)
}

/// Whether the run whose results are at `out` is already complete; an error when it is not one that can go on with the
/// scene in `scene_file`. To be called on one rank.
pub fn is_complete(out: &Path, scene: &Scene, scene_file: &Path) -> Result<bool> {
    let file = out.display();
    let Some(left) = left(out)? else {
        return Err(Error::Usage(format!("{file}: there is nothing to resume; run without --resume")));
    };
    refuse_another_scene(out, &left.scene, scene)?;
    refuse_other_inputs(out, &left.inputs, &composition::inputs(scene, scene_file)?)?;
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

/// Refuses to begin anew where a run was stopped that can go on. To be called on one rank.
pub fn refuse_unfinished(out: &Path) -> Result<()> {
    // What cannot be read is no run that could go on; whether it may be replaced is seen when the file is made.
    let Ok(Some(left)) = left(out) else { return Ok(()) };
    let its_own = |found: &checkpoint::Checkpoint| found.started == left.started;
    if left.status == "complete" || !checkpoint::read(out).ok().flatten().as_ref().is_some_and(its_own) {
        return Ok(());
    }
    Err(Error::Usage(format!(
        "{}: holds a run that was stopped: go on with it by --resume, or drop it and begin anew by --restart",
        out.display()
    )))
}

fn refuse_another_scene(file: &Path, stored: &str, scene: &Scene) -> Result<()> {
    const SHOWN: usize = 4;
    let found = obstacles(stored, &scene.to_toml());
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

/// Both are as [`composition::inputs`] gives them.
fn refuse_other_inputs(file: &Path, there: &str, here: &str) -> Result<()> {
    let Some(other) = here.lines().find(|line| there.lines().all(|known| known != *line)) else { return Ok(()) };
    let key_of = |line: &'_ str| line.rsplit_once(' ').map_or(String::new(), |(key, _)| key.to_owned());
    let key = key_of(other);
    let reason = match there.lines().any(|known| key_of(known) == key) {
        true => format!("the file that {key} names is not what it was when the run began; put that back"),
        false => {
            format!("another version of mpjr wrote it, and it does not tell the content of the file that {key} names")
        }
    };
    Err(Error::Usage(format!("{}: cannot be resumed: {reason}, or run without --resume", file.display())))
}
