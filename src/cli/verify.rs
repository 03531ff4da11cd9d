//! `mpjr verify`: scenes with a known answer, solved afresh and compared.

use std::time::Instant;

use clap::Args;
use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::summary::seconds;
use super::terminal::tell;
use crate::error::{Error, Result};
use crate::verify::{self, Row, Tally};

/// The arguments of `mpjr verify`.
#[derive(Args)]
pub struct VerifyArguments {
    /// Only what fits in fifteen seconds
    #[arg(long)]
    quick: bool,
    /// Only the cases whose name contains this
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// PETSc options
    #[arg(last = true, value_name = "PETSC OPTIONS")]
    petsc: Vec<String>,
}

/// Solves all cases on all ranks; rank 0 prints the table. Exit code 1 if anything differs by more than its tolerance.
pub fn run(arguments: &VerifyArguments) -> Result<()> {
    super::in_session(&arguments.petsc, |_, world| compare(world, arguments))
}

fn compare(world: &SimpleCommunicator, arguments: &VerifyArguments) -> Result<()> {
    let begun = Instant::now();
    let prints = world.rank() == 0;
    let mut cases = verify::cases(arguments.quick)?;
    if let Some(text) = &arguments.only {
        cases.retain(|case| case.name.contains(text));
        if cases.is_empty() {
            return Err(Error::Usage(format!("--only {text:?}: no case has this in its name")));
        }
    }
    if prints {
        tell(header());
    }
    let mut tally = Tally::default();
    for case in &cases {
        let since = Instant::now();
        let rows = verify::solve(world, case)?;
        tally.add(&rows);
        if prints {
            let took = seconds(since.elapsed().as_secs_f64());
            tell(format_args!("{} [{}; {took}]", case.name, case.source));
            rows.iter().for_each(|row| tell(line(row)));
        }
    }
    if prints {
        tell(format_args!("{tally} in {}", seconds(begun.elapsed().as_secs_f64())));
    }
    tally.verdict()
}

fn header() -> String {
    let columns = ["quantity", "computed", "exact", "difference", "tolerance"];
    let [quantity, computed, exact, difference, tolerance] = columns;
    format!("  {quantity:<44} {computed:>14} {exact:>14} {difference:>11} {tolerance:>10}  verdict  tolerance is for")
}

fn line(row: &Row) -> String {
    format!(
        "  {:<44} {:>14} {:>14} {:>+11.2e} {:>10.2e}  {:<7}  {}",
        row.quantity,
        number(row.computed),
        number(row.exact),
        row.difference(),
        row.tolerance,
        if row.passes() { "pass" } else { "FAIL" },
        row.reason
    )
}

/// Seven digits, without an exponent where that is readable.
fn number(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || (1e-3..1e4).contains(&size) => format!("{value:.6}"),
        _ => format!("{value:.6e}"),
    }
}
