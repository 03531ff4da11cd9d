//! The commands of `mpjr`, one module each.

mod check;
mod fit;
mod progress;
mod record;
mod run;
mod summary;

use clap::{Parser, Subcommand};

use crate::error::Result;

/// Transient viscoelastic contact with friction, by interface finite elements with embedded profiles (MPJR).
///
/// Every command also works under `mpirun -n N`.
#[derive(Parser)]
#[command(name = "mpjr", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Solve one scene and write its HDF5 file
    Run(run::RunArguments),
    /// Read and check a scene, and say what a run would do; solves nothing
    Check(check::CheckArguments),
    /// Identify a Prony series from measured data or from the fractional power law
    Fit(fit::FitArgs),
}

/// Reads the command line, does what it says, and returns the exit code: 0 done, 2 scene or command line wrong,
/// 3 no convergence, 4 a file could not be read or written, 1 anything else.
pub fn main() -> i32 {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(message) => {
            if is_first_process() {
                // Nothing is left to do when even the terminal cannot be written to.
                let _ = message.print();
            }
            return if message.use_stderr() { 2 } else { 0 };
        }
    };
    let outcome: Result<()> = match arguments.command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        // It needs no solver, so that one process does it for all.
        Command::Fit(arguments) => {
            if is_first_process() {
                fit::run(&arguments)
            } else {
                Ok(())
            }
        }
    };
    match outcome {
        Ok(()) => 0,
        Err(error) => {
            if is_first_process() {
                eprintln!("mpjr: {error}");
            }
            error.exit_code()
        }
    }
}

/// Whether this process is alone or rank 0 of its launcher: known without MPI, so that what needs no solver starts none.
fn is_first_process() -> bool {
    ["OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"]
        .iter()
        .find_map(|name| std::env::var(name).ok())
        .is_none_or(|rank| rank == "0")
}
