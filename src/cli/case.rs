//! One scene, from its typed form to its results: what `mpjr run` and `mpjr sweep` have in common.

use std::path::Path;
use std::time::{Instant, SystemTime};

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::interrupt::Interrupt;
use super::origin::{Begun, Origin};
use super::progress::Progress;
use super::record::{Checkpoints, Recording};
use super::summary::Outcome;
use crate::composition::{self, Compliances, Meshed, Outline, Problem};
use crate::error::{Error, Result};
use crate::loading::Phase;
use crate::output::{
    BulkPlan, Extra, HistoryRow, Metadata, Plan, Recorder, Status, checkpoint, clock, reader::Results,
};
use crate::parallel::agree;
use crate::petsc::Session;
use crate::scene::{self, Scene, Wearing};
use crate::solution;
use crate::solve::Driver;
use crate::warnings::{Doubts, Warning};

/// What to solve, by whom, and where the results go.
pub struct Job<'a> {
    /// MPI and PETSc.
    pub session: &'a Session,
    /// The ranks that solve it.
    pub comm: &'a SimpleCommunicator,
    /// What may stop it.
    pub interrupt: &'a Interrupt,
    /// The scene.
    pub scene: &'a Scene,
    /// The file that it was read from: others are looked for beside it.
    pub file: &'a Path,
    /// The result file.
    pub out: &'a Path,
    /// Where it starts from.
    pub origin: Origin<'a>,
    /// What runs before this one had computed.
    pub compliances: &'a Compliances,
    /// Whether the state at the end is kept in the checkpoint, for other runs to go on from.
    pub keep_state: bool,
    /// Told each warning, on rank 0.
    pub doubt: &'a dyn Fn(&Warning),
}

/// What came of it.
pub struct Done {
    /// Whether the solver got to the end.
    pub result: Result<()>,
    /// What it took.
    pub outcome: Outcome,
    /// The last row of the history.
    pub last: HistoryRow,
    /// All warnings, on rank 0.
    pub warnings: Vec<Warning>,
    /// Whether its vectors have two components along the face.
    pub in_space: bool,
}

/// Solves the scene and records it; `progress` is shown where it is not silent. Collective.
///
/// # Errors
/// When there was nothing to solve with or no file to write to. Every rank returns the same.
pub fn solve(job: &Job<'_>, progress: impl FnOnce(usize) -> Progress) -> Result<Done> {
    let (comm, scene) = (job.comm, job.scene);
    let (clock, started) = (Instant::now(), SystemTime::now());
    // First what the scene may be refused for.
    let parts = composition::prepare(comm, scene, job.file)?;
    let outline = (comm.rank() == 0).then(|| Outline::of(scene, &parts.mesh));
    let doubts = outline.as_ref().map(|outline| Doubts::of(scene, outline, &parts.shape));
    let unknowns = outline.map_or(0, |outline| outline.unknowns);
    let problem = composition::assemble(comm, scene, (parts.mesh, parts.shape.surface), job.compliances)?;
    let Problem { mut strategy, mut tangent, mut u, phases, mut integrator, mesh } = problem;
    let first = solution::first_row(strategy.as_ref());
    let begun = job.origin.load(comm, job.out, &phases)?;
    if let Some(begun) = &begun {
        strategy.restore(&begun.snapshot, &mut u)?;
    }
    let open = |doubts: &Doubts| open(job, (started, &first), (&mesh, doubts), &phases, begun.as_ref());
    let recorder = agree(comm, doubts.as_ref().map(open).transpose())?;
    doubts.iter().flat_map(|doubts| &doubts.before).for_each(job.doubt);
    let started = match (job.origin, &begun) {
        (Origin::Checkpoint, Some(begun)) => begun.started.clone(),
        _ => clock::iso_utc(started),
    };
    let checkpoints = Checkpoints {
        results: job.out.to_owned(),
        every: scene.output.checkpoint_every,
        interrupt: job.interrupt,
        scene: scene.to_toml(),
        started,
    };
    let progress = progress(scene.steps());
    let every = scene.output.interface_every;
    let done = begun.as_ref().map_or(0, |begun| begun.planned_steps);
    let mut recording = Recording::new((comm, recorder), (every, scene), checkpoints, progress).after(done);
    let setup = clock.elapsed();
    let mut driver = Driver::new(strategy.as_mut(), &mut recording, &phases);
    if let Some(begun) = &begun {
        driver = driver.at(begun.position, begun.counts);
    }
    let mut result = driver.run(&mut integrator, &mut tangent, &mut u);
    let counts = driver.counts();
    if result.is_ok() && job.keep_state {
        result = recording.keep_state(strategy.as_mut(), &u, counts);
    }
    let status = match &result {
        Ok(()) => Status::Complete,
        Err(Error::Solver(_) | Error::Domain(_)) => Status::NotConverged,
        Err(_) => Status::Stopped,
    };
    let outcome = Outcome { status, ranks: comm.size(), unknowns, setup, total: clock.elapsed(), counts };
    recording.end_progress();
    let mut doubted = Ok(());
    let mut warnings = Vec::new();
    if let Some(doubts) = doubts {
        // A run that goes on later has its say at its end.
        let after = if status == Status::Stopped { Ok(Vec::new()) } else { recording.doubt(&doubts) };
        warnings = doubts.before;
        doubted = after.map(|after| {
            after.iter().for_each(job.doubt);
            warnings.extend(after);
        });
    }
    let (finished, last) = recording.finish(status, !job.keep_state);
    // What the solver says comes first; a file that could not be closed matters only when it did its work.
    let result = result.and(agree(comm, doubted.and(finished)));
    if result.is_ok() && !job.keep_state && comm.rank() == 0 {
        // It has done its work; one that stays does no harm.
        let _ = checkpoint::remove(job.out);
    }
    Ok(Done { result, outcome, last, warnings, in_space: mesh.is_in_space() })
}

/// The recorder of the run, on the rank that writes.
fn open(
    job: &Job<'_>,
    (started, first): (SystemTime, &HistoryRow),
    (mesh, doubts): (&Meshed, &Doubts),
    phases: &[Phase],
    begun: Option<&Begun>,
) -> Result<Recorder> {
    let scene = job.scene;
    let plan = plan(scene, mesh, phases);
    if let (Origin::Checkpoint, Some(begun)) = (job.origin, begun) {
        let recorder = Recorder::resume(job.out, plan, begun.rows)?;
        recorder.set_scene(&scene.to_toml())?;
        return Ok(recorder);
    }
    let metadata = Metadata {
        title: scene.title.clone(),
        scene: scene.to_toml(),
        inputs: composition::inputs(scene, job.file)?,
        version: env!("CARGO_PKG_VERSION").into(),
        git_commit: env!("MPJR_GIT_COMMIT").into(),
        petsc_version: job.session.petsc_version(),
        ranks: job.comm.size() as usize,
        started,
        warnings: doubts.before.iter().map(ToString::to_string).collect(),
    };
    let recorder = Recorder::create(job.out, &metadata, plan, first)?;
    // One that is left belongs to the file that was replaced.
    checkpoint::remove(job.out)?;
    if let Origin::Shared { results, .. } = job.origin {
        recorder.append(&Results::open(results)?)?;
    }
    Ok(recorder)
}

/// The columns that the history of a scene has besides those that all have.
pub fn extra(scene: &Scene) -> Extra {
    let mounts = scene.mount.map_or([false; 2], |mount| mount.directions().map(|end| end.is_some()));
    let wears = |wear: scene::Wear| wear.of == Wearing::Indenter;
    Extra {
        energy: scene.output.energy,
        mounts,
        heat: scene.heat.is_some(),
        wear: scene.wear.is_some(),
        worn_profile: scene.wear.is_some_and(wears),
        adhesion: scene.adhesion.is_some(),
    }
}

fn plan(scene: &Scene, mesh: &Meshed, phases: &[Phase]) -> Plan {
    let frames = phases.iter().flat_map(|phase| &phase.steps).filter(|target| target.bulk_output).count();
    let steps = scene.steps() + frames;
    let ends = phases.len();
    Plan {
        // A step that is cut adds rows.
        history_rows: 1 + steps + steps / 8,
        phase_names: phases.iter().map(|phase| phase.name.clone()).collect(),
        extra: extra(scene),
        interface_rows: steps.checked_div(scene.output.interface_every).map_or(ends, |rows| rows + ends),
        face: mesh.face(),
        bulk: bulk_plan(scene, mesh, phases),
    }
}

/// The bulk fields to expect; none when the scene asks for none.
fn bulk_plan(scene: &Scene, mesh: &Meshed, phases: &[Phase]) -> Option<BulkPlan> {
    if scene.output.bulk_at.is_empty() {
        return None;
    }
    let frames = phases.iter().flat_map(|phase| &phase.steps).filter(|target| target.bulk_output).count();
    Some(mesh.bulk(frames))
}
