//! Runs the program, and compares all numbers of two result files.

use std::path::Path;
use std::process::{Command, Output};

use mpjr::output::reader::Results;

use super::mpi::mpirun;

/// The program alone, without what MPI does to find other processes.
pub fn mpjr() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mpjr"));
    command.envs([("OMPI_MCA_ess_singleton_isolated", "1"), ("OMPI_MCA_btl", "self"), ("OMP_NUM_THREADS", "1")]);
    command
}

/// The program on several ranks.
pub fn mpjr_on(ranks: usize) -> Command {
    let mut command = mpirun(ranks);
    command.env("OMP_NUM_THREADS", "1").arg(env!("CARGO_BIN_EXE_mpjr"));
    command
}

/// What the command wrote to standard error, after checking its exit code.
pub fn ends_with(command: &mut Command, code: i32) -> String {
    let output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{command:?}\n{}{text}", String::from_utf8_lossy(&output.stdout));
    text
}

/// Standard output, after checking that all went well.
pub fn output_of(command: &mut Command) -> String {
    let output: Output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{command:?}\n{text}{}", String::from_utf8_lossy(&output.stderr));
    text
}

/// Every number of a result file: history, interface and bulk, with a name for messages.
pub fn numbers(path: &Path) -> Vec<(String, Vec<f64>)> {
    let results = Results::open(path).unwrap();
    let file = hdf5::File::open(path).unwrap();
    let mut all = Vec::new();
    for column in file.group("history").unwrap().member_names().unwrap() {
        if column != "energy" {
            all.push((column.clone(), results.history(&column).unwrap()));
        }
    }
    if results.has("history/energy/stored") {
        for column in file.group("history/energy").unwrap().member_names().unwrap() {
            all.push((column.clone(), results.history(&format!("energy/{column}")).unwrap()));
        }
    }
    for group in ["interface", "bulk"] {
        for field in file.group(group).map(|group| group.member_names().unwrap()).unwrap_or_default() {
            let values = if group == "bulk" { results.bulk(&field) } else { results.interface(&field) };
            all.push((format!("{group}/{field}"), values.unwrap().values));
        }
    }
    all
}

/// Both files have the same numbers: bit for bit, or (`within` > 0) to so much of the largest of each list.
pub fn assert_same(one: &Path, other: &Path, within: f64) {
    let (one, other) = (numbers(one), numbers(other));
    assert_eq!(one.len(), other.len());
    for ((name, one), (_, other)) in one.iter().zip(&other) {
        assert_eq!(one.len(), other.len(), "{name}");
        if within == 0.0 {
            let differing = one.iter().zip(other).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
            assert_eq!(differing, 0, "{name}: numbers that differ");
        } else if name != "newton_iterations" {
            // A share of the traction in which most digits cancel counts as that share.
            let least = if name == "traction_oscillation" { 1.0 } else { 0.0 };
            let largest = one.iter().fold(least, |largest: f64, value| largest.max(value.abs()));
            let difference = one.iter().zip(other).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
            assert!(difference <= within * largest, "{name}: {difference:e} of {largest:e}");
        }
    }
}
