//! `mpjr compare`: in what two result files differ.

use std::path::PathBuf;

use clap::Args;

use super::terminal::tell;
use crate::error::{Error, Result};
use crate::output::reader::{Field, Results};

/// The arguments of `mpjr compare`.
#[derive(Args)]
pub struct CompareArguments {
    /// A result file
    #[arg(value_name = "A.h5")]
    one: PathBuf,
    /// Another
    #[arg(value_name = "B.h5")]
    other: PathBuf,
    /// The exit code is 1 if a number differs by more than this share of the largest of its dataset in A.h5, or if datasets
    /// are missing or of another shape [default: everything is accepted]
    #[arg(long, value_name = "SHARE")]
    tolerance: Option<f64>,
}

/// What comes of one dataset.
enum Comparison {
    /// Only one file has it, or the numbers of numbers differ.
    Unlike(String),
    /// The largest difference, relative to the largest number of the first, and the row that it is in.
    Alike { absolute: f64, relative: f64, row: usize },
}

/// Prints the largest differences.
pub fn run(arguments: &CompareArguments) -> Result<()> {
    let tolerance = arguments.tolerance.unwrap_or(f64::INFINITY);
    if tolerance.is_nan() || tolerance < 0.0 {
        return Err(Error::Usage(format!("--tolerance {tolerance}: must be a share, at least 0")));
    }
    let (one, other) = (Results::open(&arguments.one)?, Results::open(&arguments.other)?);
    let mut names = one.datasets()?;
    names.extend(other.datasets()?);
    names.sort();
    names.dedup();
    tell(format_args!("{:44} {:>12} {:>12}  row", "dataset", "absolute", "relative"));
    let mut beyond = 0;
    for name in &names {
        match compare(name, &one, &other)? {
            Comparison::Unlike(reason) => {
                beyond += usize::from(arguments.tolerance.is_some());
                tell(format_args!("/{name:43} {reason}"));
            }
            Comparison::Alike { absolute, relative, row } => {
                let is_beyond = relative.is_nan() || relative > tolerance;
                beyond += usize::from(is_beyond);
                let mark = if is_beyond { "  beyond the tolerance" } else { "" };
                tell(format_args!("/{name:43} {absolute:12.3e} {relative:12.3e}  {row}{mark}"));
            }
        }
    }
    match beyond {
        0 => Ok(()),
        count => Err(Error::Mismatch(format!(
            "{count} of {} datasets of {} differ from those of {} by more than {tolerance:e}",
            names.len(),
            arguments.one.display(),
            arguments.other.display()
        ))),
    }
}

fn compare(name: &str, one: &Results, other: &Results) -> Result<Comparison> {
    for (results, path) in [(one, one.path()), (other, other.path())] {
        if !results.has(name) {
            return Ok(Comparison::Unlike(format!("is not in {}", path.display())));
        }
    }
    let (one, other) = (one.field(name)?, other.field(name)?);
    if (one.rows, one.columns) != (other.rows, other.columns) {
        let shape = |field: &Field| format!("{} x {}", field.rows, field.columns);
        return Ok(Comparison::Unlike(format!("{} there, {} here", shape(&one), shape(&other))));
    }
    let largest = one.values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let mut found = Comparison::Alike { absolute: 0.0, relative: 0.0, row: 0 };
    let mut worst = 0.0;
    for (index, (a, b)) in one.values.iter().zip(&other.values).enumerate() {
        let absolute = (a - b).abs();
        // What is no number in one file only differs by no number.
        let differs = absolute > worst || absolute.is_nan() && a.to_bits() != b.to_bits();
        if differs {
            worst = absolute;
            let relative = if largest > 0.0 { absolute / largest } else { f64::INFINITY };
            found = Comparison::Alike { absolute, relative, row: index / one.columns.max(1) };
        }
    }
    Ok(found)
}
