//! `mpjr run`: one scene, from its file to its results.

use std::path::{Path, PathBuf};

use clap::Args;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Root};

use super::case::{self, Job};
use super::interrupt::Interrupt;
use super::origin::{self, Origin};
use super::progress::Progress;
use super::telling::Telling;
use super::terminal::{answer, doubt, tell};
use super::{json, summary};
use crate::composition::Compliances;
use crate::error::{Error, Result};
use crate::parallel::{agree, share_text};
use crate::petsc::Session;
use crate::scene::{self, Source};
use crate::warnings::Warning;

/// The arguments of `mpjr run`.
#[derive(Args)]
pub struct RunArguments {
    /// The scene
    scene: PathBuf,
    /// Where the results go [default: the scene's stem + .h5, in the current directory]
    #[arg(short, long, value_name = "FILE.h5")]
    out: Option<PathBuf>,
    /// Change a key of the scene, such as layer.depth=0.5 or phase.slide.velocity=0.1
    #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
    /// Go on from the checkpoint of a run that was stopped, with the same scene and results
    #[arg(long)]
    resume: bool,
    /// Begin anew where a run was stopped, and drop what it had come to
    #[arg(long, conflicts_with = "resume")]
    restart: bool,
    /// Print the summary as one JSON object on standard output, and nothing else there
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    telling: Telling,
    /// PETSc options, such as -ksp_type gmres -pc_type gamg
    #[arg(last = true, value_name = "PETSC OPTIONS")]
    petsc: Vec<String>,
}

/// Solves the scene on all ranks of the launcher.
pub fn run(arguments: &RunArguments) -> Result<()> {
    arguments.telling.begin(arguments.json);
    let interrupt = Interrupt::watch()?;
    super::in_session(&arguments.petsc, |session, world| solve((session, world), &interrupt, arguments))
}

/// Reads, builds, runs and records; the error is the same on all ranks but for one inside a library.
fn solve(
    (session, world): (&Session, &SimpleCommunicator),
    interrupt: &Interrupt,
    arguments: &RunArguments,
) -> Result<()> {
    let file = &arguments.scene;
    let open = |file: &Path| share_text(world, || scene::open(file));
    let source = Source { file: file.clone(), overrides: arguments.set.clone() };
    let scene = scene::read_with(&open(file)?, &source, &open)?;
    let out = arguments.out.clone().unwrap_or_else(|| default_output(file));
    let mut origin = Origin::Rest;
    if arguments.resume {
        let mine = if world.rank() == 0 { origin::is_complete(&out, &scene, file).map(u8::from) } else { Ok(0) };
        let mut complete = agree(world, mine)?;
        world.process_at_rank(0).broadcast_into(&mut complete);
        if complete != 0 {
            if world.rank() == 0 {
                tell(format_args!("{}: this run is complete; there is nothing to go on with", out.display()));
            }
            return Ok(());
        }
        origin = Origin::Checkpoint;
    } else if !arguments.restart {
        agree(world, if world.rank() == 0 { origin::refuse_unfinished(&out) } else { Ok(()) })?;
    }

    let job = Job {
        session,
        comm: world,
        interrupt,
        scene: &scene,
        file,
        out: &out,
        origin,
        compliances: &Compliances::default(),
        keep_state: false,
        doubt: &doubt,
    };
    let done = case::solve(&job, |steps| Progress::new(steps, world.rank() == 0))?;
    if world.rank() == 0 {
        for option in session.unused_options() {
            doubt(&Warning::new(format!("-{option}"), "this PETSc option was never asked for; is it misspelt?"));
        }
        tell(summary::outcome(&scene, &done));
        tell(format_args!("results:       {}", out.display()));
        if arguments.json {
            answer(json::outcome(&scene, &done, &out));
        }
    }
    let judged = done.result.and_then(|()| arguments.telling.judge_together(world, done.warnings.len()));
    judged.map_err(|error| match error {
        Error::Solver(text) => {
            Error::Solver(format!("{}: {text}; {} holds the results up to there", file.display(), out.display()))
        }
        Error::Doubtful(text) => {
            Error::Doubtful(format!("{}: {text}; {} holds the results", file.display(), out.display()))
        }
        other => other,
    })
}

/// The scene's stem + `.h5` in the current directory.
pub(super) fn default_output(scene: &Path) -> PathBuf {
    let mut name = scene.file_stem().unwrap_or_default().to_owned();
    name.push(".h5");
    PathBuf::from(name)
}
