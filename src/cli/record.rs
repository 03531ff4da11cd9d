//! Takes what a run reports to its file and its terminal.

use mpi::topology::SimpleCommunicator;

use super::progress::{Progress, Stage};
use crate::error::Result;
use crate::loading::Phase;
use crate::output::bulk::Frame;
use crate::output::{self, HistoryRow, Recorder, Status};
use crate::parallel::agree;
use crate::solution;
use crate::solve::{Observer, Report};

/// The observer of a run; only rank 0 has a recorder.
pub struct Recording<'a> {
    world: &'a SimpleCommunicator,
    recorder: Option<Recorder>,
    /// Planned steps between interface profiles; 0 = only at the ends of phases.
    interface_every: usize,
    phases: &'a [Phase],
    progress: Progress,
    planned_steps: usize,
    last: HistoryRow,
}

impl<'a> Recording<'a> {
    /// Records into `recorder` and shows on `progress`.
    pub fn new(
        world: &'a SimpleCommunicator,
        recorder: Option<Recorder>,
        interface_every: usize,
        phases: &'a [Phase],
        progress: Progress,
    ) -> Self {
        let last = HistoryRow::default();
        Self { world, recorder, interface_every, phases, progress, planned_steps: 0, last }
    }

    /// Closes the file with `status`; also gives the last row of the history.
    pub fn finish(self, status: Status) -> (Result<()>, HistoryRow) {
        self.progress.finish();
        let closed = self.recorder.map_or(Ok(()), |recorder| recorder.finish(status));
        (closed, self.last)
    }

    /// The step's row of the history, and its interface profile where one is due.
    fn record(&mut self, report: &mut Report<'_>) -> Result<()> {
        let Some(recorder) = &self.recorder else { return Ok(()) };
        self.last = solution::row(report)?;
        recorder.history(self.last)?;
        let due = report.planned && self.planned_steps.checked_rem(self.interface_every) == Some(0);
        if due || report.phase_end {
            recorder.interface(solution::frame(report)?)?;
        }
        self.progress.show(&Stage {
            done: self.planned_steps,
            phase: &self.phases[report.phase].name,
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
            let fields = report.problem.bulk_fields(report.u)?;
            let frame = Frame {
                time: report.time,
                nodes: &fields.nodes,
                displacement: &fields.displacement,
                stress: &fields.stress,
            };
            output::bulk::write(self.world, self.recorder.as_ref(), &frame)?;
        }
        Ok(())
    }
}
