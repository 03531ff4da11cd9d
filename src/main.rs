//! The `mpjr` command.

use clap::{Parser, Subcommand};
use mpjr::cli::fit;

/// Transient viscoelastic contact with friction.
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Fit(fit::FitArgs),
}

fn main() {
    let Command::Fit(args) = Cli::parse().command;
    if let Err(error) = fit::run(&args) {
        eprintln!("{error}");
        std::process::exit(error.exit_code());
    }
}
