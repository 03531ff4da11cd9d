//! Takes what a run reports to its file and its terminal.

use std::path::PathBuf;

use mpi::topology::SimpleCommunicator;

use super::interrupt::Interrupt;
use super::origin::{save_counts, save_rows};
use super::progress::{Progress, Stage};
use crate::error::{Error, Result};
use crate::output::bulk::Frame;
use crate::output::checkpoint::{self, Checkpoint};
use crate::output::{self, HistoryRow, Recorder, Status};
use crate::parallel::{agree, any};
use crate::petsc::Vector;
use crate::scene::Scene;
use crate::snapshot::Snapshot;
use crate::solution::{self, Whole};
use crate::solve::{Counts, Observer, Report, TransientProblem};
use crate::warnings::{Doubts, Warning};

/// The observer of a run; only rank 0 has a recorder.
pub struct Recording<'a> {
    world: &'a SimpleCommunicator,
    recorder: Option<Recorder>,
    /// Planned steps between interface profiles; 0 = only at the ends of phases.
    interface_every: usize,
    scene: &'a Scene,
    progress: Progress,
    checkpoints: Checkpoints<'a>,
    planned_steps: usize,
    last: HistoryRow,
}

/// When and where the state of a run is kept.
pub struct Checkpoints<'a> {
    /// The result file that they belong to.
    pub results: PathBuf,
    /// Planned steps between them; 0 = only on a signal.
    pub every: usize,
    /// The signal.
    pub interrupt: &'a Interrupt,
    /// The resolved scene.
    pub scene: String,
    /// When the run began, as the result file has it.
    pub started: String,
}

impl<'a> Recording<'a> {
    /// Records into the recorder of the communicator's rank 0, an interface profile after so many planned steps of the
    /// scene, and shows on `progress`.
    pub fn new(
        (world, recorder): (&'a SimpleCommunicator, Option<Recorder>),
        (interface_every, scene): (usize, &'a Scene),
        checkpoints: Checkpoints<'a>,
        progress: Progress,
    ) -> Self {
        let last = HistoryRow::default();
        Self { world, recorder, interface_every, scene, progress, checkpoints, planned_steps: 0, last }
    }

    /// The same after so many planned steps.
    pub fn after(self, planned_steps: usize) -> Self {
        Self { planned_steps, ..self }
    }

    /// Keeps the state at the end of the run, whose solution is `u`. Collective.
    pub fn keep_state(&self, problem: &mut dyn TransientProblem, u: &Vector, counts: Counts) -> Result<()> {
        let mut snapshot = Snapshot::default();
        problem.save(u, &mut snapshot)?;
        self.write(snapshot, counts)
    }

    /// Keeps the state where one is due, and stops the run where that is asked for.
    fn checkpoint(&self, report: &mut Report<'_>) -> Result<()> {
        let Some(next) = report.next else { return Ok(()) };
        let stop = any(self.world, self.checkpoints.interrupt.requested());
        let due = report.planned && self.planned_steps.checked_rem(self.checkpoints.every) == Some(0);
        if !stop && !due {
            return Ok(());
        }
        let mut snapshot = Snapshot::default();
        report.problem.save(report.u, &mut snapshot)?;
        next.save(&mut snapshot);
        self.write(snapshot, report.counts)?;
        if !stop {
            return Ok(());
        }
        Err(Error::Stopped(format!(
            "stopped by a signal at t = {:.6} s; {} holds the state: go on with --resume",
            report.time,
            checkpoint::beside(&self.checkpoints.results).display()
        )))
    }

    /// Writes the checkpoint, after all rows that it counts.
    fn write(&self, mut snapshot: Snapshot, counts: Counts) -> Result<()> {
        save_counts(&mut snapshot, counts, self.planned_steps);
        let mine = self.recorder.as_ref().map_or(Ok(()), |recorder| {
            save_rows(&mut snapshot, recorder.sync()?);
            let Checkpoints { results, scene, started, .. } = &self.checkpoints;
            let fields = snapshot.fields().to_vec();
            checkpoint::write(results, &Checkpoint { scene: scene.clone(), started: started.clone(), fields })
        });
        agree(self.world, mine)
    }

    /// Adds to the file, and gives, what its history says besides the doubts that there were before; on the rank that
    /// writes.
    pub fn doubt(&self, doubts: &Doubts) -> Result<Vec<Warning>> {
        let Some(recorder) = &self.recorder else { return Ok(Vec::new()) };
        let after = doubts.after(self.scene, &recorder.rows()?);
        let all: Vec<String> = doubts.before.iter().chain(&after).map(ToString::to_string).collect();
        recorder.set_warnings(&all)?;
        Ok(after)
    }

    /// Closes the file with `status`, compressed where nothing is to go on from it (`last`); also gives the last row of the
    /// history.
    pub fn finish(self, status: Status, last: bool) -> (Result<()>, HistoryRow) {
        let close = |recorder: Recorder| match (status, last) {
            (Status::Complete, true) => recorder.finish_packed(),
            _ => recorder.finish(status),
        };
        let closed = self.recorder.map_or(Ok(()), close);
        (closed, self.last)
    }

    /// Leaves the terminal as it was.
    pub fn end_progress(&self) {
        self.progress.finish();
    }

    /// The step's row of the history, and its interface profile where one is due.
    fn record(&mut self, report: &mut Report<'_>) -> Result<()> {
        // Where each rank has a part of the face all have to say what they have of it.
        let asked = self.recorder.is_some() || report.problem.contact()?.team().is_parted();
        if !asked {
            return Ok(());
        }
        self.last = solution::row(report)?;
        let due = report.planned && self.planned_steps.checked_rem(self.interface_every) == Some(0);
        let frame = match due || report.phase_end {
            true => Some(solution::frame(report, Whole::OnFirst)?),
            false => None,
        };
        let Some(recorder) = &self.recorder else { return Ok(()) };
        recorder.history(self.last)?;
        frame.map_or(Ok(()), |frame| recorder.interface(frame))?;
        self.progress.show(&Stage {
            done: self.scene.steps_until(report.phase, report.time),
            phase: &self.scene.phases[report.phase].name,
            time: report.time,
            normal_force: self.last.normal_force,
            tangential_force: self.last.tangential_force,
            newton: report.newton,
            phase_end: report.phase_end,
        });
        Ok(())
    }
}

impl Observer for Recording<'_> {
    fn observe(&mut self, mut report: Report<'_>) -> Result<()> {
        self.planned_steps += usize::from(report.planned);
        let mine = self.record(&mut report);
        agree(self.world, mine)?;
        if report.bulk_output {
            let fields = agree(self.world, solution::bulk(&mut report))?;
            let (displacement, stress) = solution::components(&fields);
            let (time, nodes, temperature) = (report.time, &fields.nodes, &fields.temperature);
            let frame = Frame { time, nodes, displacement: &displacement, stress: &stress, temperature };
            output::bulk::write(self.world, self.recorder.as_ref(), &frame)?;
        }
        self.checkpoint(&mut report)
    }
}
