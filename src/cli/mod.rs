//! The commands of `mpjr`, one module each.

mod case;
mod check;
mod compare;
mod fit;
mod interrupt;
mod json;
mod launcher;
mod manual;
mod material;
mod new;
mod origin;
mod plot;
mod profile;
mod progress;
mod record;
mod run;
mod schema;
mod steady;
mod study;
mod summary;
mod sweep;
mod telling;
mod terminal;
mod verify;

use clap::{Parser, Subcommand};
use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use crate::error::{Error, Result};
use crate::memory;
use crate::petsc::Session;

use launcher::{Launch, is_first_process};
use terminal::warn;

/// Transient viscoelastic contact with friction, by interface finite elements with embedded profiles (MPJR).
///
/// Every command also works under `mpirun -n N`.
#[derive(Parser)]
// mpirun gives its processes a terminal whatever its own output goes to, so that colours would end up in files.
#[command(name = "mpjr", version, color = clap::ColorChoice::Never)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Solve one scene and write its HDF5 file
    Run(run::RunArguments),
    /// Run every case of a sweep; cases that are complete are not run again
    Sweep(sweep::SweepArguments),
    /// Read and check a scene, and say what a run would do; solves nothing
    Check(check::CheckArguments),
    /// Identify a Prony series from measured data or from the fractional power law
    Fit(fit::FitArgs),
    /// Solve a scene over ladders of settings: accuracy against cost, and what is cheapest for an error
    Study(study::StudyArguments),
    /// Solve scenes with a known answer and compare; the exit code is 1 if any differs by more than its tolerance
    Verify(verify::VerifyArguments),
    /// Steady sliding of a periodic layer at each of many velocities, without steps: the friction curve
    Steady(steady::SteadyArguments),
    /// Draw figures from results
    Plot(plot::PlotArguments),
    /// Compare two result files, dataset by dataset
    Compare(compare::CompareArguments),
    /// Write a commented first scene that runs as it is
    New(new::NewArguments),
    /// Print what a shell needs to complete commands and options
    Completions(manual::CompletionsArguments),
    /// Print the manual page, or write one for each command
    Man(manual::ManArguments),
    /// Print the JSON schema of scenes and sweeps, by which editors complete and check them
    Schema(schema::SchemaArguments),
}

/// Reads the command line, does what it says, and returns the exit code: 0 done, 2 scene or command line wrong,
/// 3 no convergence, 4 a file could not be read or written, 5 stopped by a signal, 6 warnings that are denied, 1 anything
/// else, such as a failed `verify`.
pub fn main() -> i32 {
    end_on_panic();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(message) => {
            if is_first_process() {
                // Nothing is left to do when even the terminal cannot be written to.
                let _ = message.print();
            }
            return exit_code(if message.use_stderr() { 2 } else { 0 });
        }
    };
    let outcome: Result<()> = match arguments.command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Sweep(arguments) => sweep::run(&arguments),
        Command::Check(arguments) => on_first_process(|| check::run(&arguments)),
        Command::Plot(arguments) => on_first_process(|| plot::run(&arguments)),
        Command::Schema(arguments) => on_first_process(|| schema::run(&arguments)),
        Command::Compare(arguments) => on_first_process(|| compare::run(&arguments)),
        Command::New(arguments) => on_first_process(|| new::run(&arguments)),
        Command::Completions(arguments) => on_first_process(|| manual::completions(&arguments)),
        Command::Man(arguments) => on_first_process(|| manual::man(&arguments)),
        Command::Fit(arguments) => on_first_process(|| fit::run(&arguments)),
        Command::Study(arguments) => study::run(&arguments),
        Command::Steady(arguments) => steady::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
    };
    match outcome.and_then(|()| terminal::finish()) {
        Ok(()) => 0,
        // Defects may be this process's alone; of anything else the first process tells.
        Err(error @ Error::Internal(_)) if !is_first_process() => error.exit_code(),
        Err(error) => {
            // That it was stopped has been said.
            if is_first_process() && !matches!(error, Error::Stopped(_)) {
                warn(&error);
            }
            exit_code(error.exit_code())
        }
    }
}

/// The exit code of an outcome that all processes share. Only the first process tells it: a launcher ends all of them
/// as soon as one fails, and would cut off the message of the first.
fn exit_code(code: i32) -> i32 {
    if is_first_process() { code } else { 0 }
}

/// What needs no solver: one process does it for all.
fn on_first_process(work: impl FnOnce() -> Result<()>) -> Result<()> {
    if is_first_process() { work() } else { Ok(()) }
}

/// What needs one: MPI and PETSc, with these PETSc options, on all ranks of the launcher.
fn in_session(petsc: &[String], work: impl FnOnce(&Session, &SimpleCommunicator) -> Result<()>) -> Result<()> {
    let launch = Launch::announced();
    memory::refuse_to_start()?;
    let session = Session::start(petsc)?;
    let world = session.world();
    launch.refuse_if_split(world.size() as usize)?;
    let outcome = work(&session, &world);
    abort_if_alone(&world, &outcome);
    if let (Err(error @ Error::Stopped(_)), true) = (&outcome, is_first_process()) {
        // A launcher that was interrupted itself passes nothing on once it is done with MPI.
        warn(error);
    }
    outcome
}

/// From here on a panic, which is always a defect, ends all ranks, as the others would wait for this one for ever.
pub fn end_on_panic() {
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map(|place| format!(" ({place})")).unwrap_or_default();
        let text = panic.payload();
        let literal = text.downcast_ref::<&str>().copied();
        let what = literal.or(text.downcast_ref::<String>().map(String::as_str)).unwrap_or("a panic");
        warn(format_args!("a defect of this program{place}: {what}; please report it with the scene"));
        let code = Error::Internal(String::new()).exit_code();
        if mpi::environment::is_initialized() {
            SimpleCommunicator::world().abort(code);
        }
        std::process::exit(code);
    }));
}

/// Ends all ranks where one has met an error inside a library, for which the others may wait.
fn abort_if_alone(world: &SimpleCommunicator, outcome: &Result<()>) {
    if let Err(error @ Error::Internal(_)) = outcome
        && world.size() > 1
    {
        warn(format_args!("rank {}: {error}", world.rank()));
        world.abort(error.exit_code());
    }
}
