//! Takes what a run reports to its file and its terminal.

use mpi::topology::SimpleCommunicator;

use super::progress::{Progress, Stage};
use crate::error::Result;
use crate::loading::Phase;
use crate::output::bulk::Frame;
use crate::output::{self, HistoryRow, InterfaceFrame, Recorder, Status};
use crate::parallel::agree;
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
        let mut contact = report.problem.contact()?;
        let totals = contact.totals()?;
        self.last = HistoryRow {
            time: report.time,
            phase: report.phase,
            approach: contact.placement.approach,
            sliding: contact.placement.sliding,
            normal_force: totals.normal_force,
            tangential_force: totals.tangential_force,
            hysteretic_force: totals.hysteretic_force,
            contact_fraction: totals.contact_fraction,
            stick_fraction: totals.stick_fraction,
            max_penetration: totals.max_penetration,
            newton_iterations: report.newton,
            ..HistoryRow::default()
        };
        recorder.history(self.last)?;
        let due = report.planned && self.planned_steps.checked_rem(self.interface_every) == Some(0);
        if due || report.phase_end {
            let fields = contact.fields()?;
            let component = |i: usize| contact.surface.displacement.iter().skip(i).step_by(2).copied().collect();
            recorder.interface(InterfaceFrame {
                time: report.time,
                pressure: fields.pressure,
                shear: fields.shear,
                gap: fields.gap,
                slip_rate: fields.slip_rate,
                displacement_x: component(0),
                displacement_z: component(1),
            })?;
        }
        self.progress.show(&Stage {
            done: self.planned_steps,
            phase: &self.phases[report.phase].name,
            time: report.time,
            normal_force: totals.normal_force,
            tangential_force: totals.tangential_force,
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
