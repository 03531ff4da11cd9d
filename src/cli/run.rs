//! `mpjr run`: one scene, from its file to its results.

use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

use clap::Args;
use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::progress::Progress;
use super::record::Recording;
use super::summary::{self, Outcome};
use crate::composition::{self, Problem};
use crate::error::{Error, Result};
use crate::loading::Phase;
use crate::mesh::Mesh;
use crate::output::{BulkPlan, HistoryRow, Metadata, Plan, Recorder, Status};
use crate::parallel::{agree, share_text};
use crate::petsc::Session;
use crate::scene::{self, Scene, Source};
use crate::solve::Driver;

/// The arguments of `mpjr run`.
#[derive(Args)]
pub struct RunArguments {
    /// The scene
    scene: PathBuf,
    /// Where the results go [default: the scene's stem + .h5, in the current directory]
    #[arg(long, value_name = "FILE.h5")]
    out: Option<PathBuf>,
    /// Change a key of the scene, such as layer.depth=0.5 or phase.slide.velocity=0.1
    #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
    /// PETSc options, such as -ksp_type gmres -pc_type gamg
    #[arg(last = true, value_name = "PETSC OPTIONS")]
    petsc: Vec<String>,
}

/// Solves the scene on all ranks of the launcher.
pub fn run(arguments: &RunArguments) -> Result<()> {
    let session = Session::start(&arguments.petsc)?;
    let world = session.world();
    let outcome = solve(&session, &world, arguments);
    if let Err(error @ Error::Internal(_)) = &outcome
        && world.size() > 1
    {
        // The other ranks may wait for this one inside a library.
        eprintln!("mpjr: rank {}: {error}", world.rank());
        world.abort(error.exit_code());
    }
    outcome
}

/// Reads, builds, runs and records; the error is the same on all ranks but for one inside a library.
fn solve(session: &Session, world: &SimpleCommunicator, arguments: &RunArguments) -> Result<()> {
    let started = SystemTime::now();
    let clock = Instant::now();
    let file = &arguments.scene;
    let text = share_text(world, || {
        std::fs::read_to_string(file).map_err(|error| Error::file(file, format!("cannot be read: {error}")))
    })?;
    let scene = scene::read(&text, &Source { file: file.clone(), overrides: arguments.set.clone() })?;
    let out = arguments.out.clone().unwrap_or_else(|| default_output(file));

    let problem = composition::build(world, &scene, file)?;
    let Problem { mut strategy, mut tangent, mut u, phases, settings, mesh } = problem;
    let steps = phases.iter().map(|phase| phase.steps.len()).sum();
    let metadata = Metadata {
        title: scene.title.clone(),
        scene: scene.to_toml(),
        version: env!("CARGO_PKG_VERSION").into(),
        git_commit: env!("MPJR_GIT_COMMIT").into(),
        petsc_version: session.petsc_version(),
        ranks: world.size() as usize,
        started,
    };
    let plan = Plan {
        // A step that is cut adds rows.
        history_rows: 1 + steps + steps / 8,
        phase_names: phases.iter().map(|phase| phase.name.clone()).collect(),
        energy: false,
        interface_rows: interface_rows(&scene, steps),
        interface_x: mesh.face.x.clone(),
        bulk: bulk_plan(&scene, &mesh, &phases),
    };
    let created = if world.rank() == 0 {
        Recorder::create(&out, &metadata, plan, &HistoryRow::default()).map(Some)
    } else {
        Ok(None)
    };
    let recorder = agree(world, created)?;
    let progress = Progress::new(steps, world.rank() == 0);
    let mut recording = Recording::new(world, recorder, scene.output.interface_every, &phases, progress);
    let setup = clock.elapsed();
    let mut driver = Driver::new(strategy.as_mut(), &mut recording, &phases);
    let result = driver.run(world, settings, &mut tangent, &mut u);
    let counts = driver.counts();

    let status = match &result {
        Ok(()) => Status::Complete,
        Err(Error::Solver(_) | Error::Domain(_)) => Status::NotConverged,
        Err(_) => Status::Stopped,
    };
    let outcome = Outcome { status, ranks: world.size(), setup, total: clock.elapsed(), counts };
    let (finished, last) = recording.finish(status);
    if world.rank() == 0 {
        print!("{}", summary::outcome(&scene, &outcome, &last));
        for option in session.unused_options() {
            println!("warning:       PETSc option -{option} was never asked for: is it misspelt?");
        }
        println!("results:       {}", out.display());
    }
    let kept = result.map_err(|error| match error {
        Error::Solver(text) => {
            Error::Solver(format!("{}: {text}; {} holds the results up to there", file.display(), out.display()))
        }
        other => other,
    });
    // What the solver says comes first; a file that could not be closed matters only when it did its work.
    kept.and(agree(world, finished))
}

/// The scene's stem + `.h5` in the current directory.
fn default_output(scene: &Path) -> PathBuf {
    let mut name = scene.file_stem().unwrap_or_default().to_owned();
    name.push(".h5");
    PathBuf::from(name)
}

/// Interface profiles to expect.
fn interface_rows(scene: &Scene, steps: usize) -> usize {
    let ends = scene.phases.len();
    steps.checked_div(scene.output.interface_every).map_or(ends, |rows| rows + ends)
}

/// The bulk fields to expect; none when the scene asks for none.
fn bulk_plan(scene: &Scene, mesh: &Mesh, phases: &[Phase]) -> Option<BulkPlan> {
    if scene.output.bulk_at.is_empty() {
        return None;
    }
    Some(BulkPlan {
        frames: phases.iter().flat_map(|phase| &phase.steps).filter(|target| target.bulk_output).count(),
        coordinates: mesh.nodes.iter().map(|node| [node.x, node.y]).collect(),
        cells: mesh.cells.iter().map(|cell| cell.four().map(i64::from)).collect(),
    })
}
