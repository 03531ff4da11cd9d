//! What a Newton iteration of the monolithic strategy costs, and how it splits: `cargo bench --bench newton`.
//!
//! Runs the scene of `runs/eva-one-arm.toml` for a few steps at 64, 128 and 256 cells squared with PETSc's own log and
//! prints unknowns, seconds per Newton iteration by part, the share of assembly and output, and the peak memory; then
//! the condensed strategy on the same steps. Ratios of one run hold better than seconds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;
use std::process::Command;

use mpjr::output::reader::Results;

/// Steps of each of the two phases.
const STEPS: usize = 3;

fn main() {
    let directory = tempfile::tempdir().unwrap();
    println!("seconds per Newton iteration, one rank (condensed: per step)");
    println!(
        "{:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8} {:>7} {:>11}",
        "cells", "unknowns", "newton", "assembly", "factor", "solve", "output", "asm+out", "GB", "condensed"
    );
    for cells in [64, 128, 256] {
        let whole = run(directory.path(), cells, "monolithic");
        let face = run(directory.path(), cells, "condensed");
        let newton = whole.newton;
        let assembly = (whole.assembly) / newton;
        let (factor, solve, output) = (whole.factor / newton, whole.solve / newton, whole.output / newton);
        println!(
            "{:>9} {:>9} {:>9} {assembly:>9.2e} {factor:>9.2e} {solve:>9.2e} {output:>9.2e} {:>7.1}% {:>7.2} {:>11.2e}",
            format!("{cells}^2"),
            2 * cells * cells,
            newton,
            100.0 * (assembly + output) / (assembly + factor + solve + output),
            whole.memory,
            face.total / (2 * STEPS) as f64,
        );
    }
}

/// Times of one run, s, and its peak memory, GB.
struct Times {
    newton: f64,
    assembly: f64,
    factor: f64,
    solve: f64,
    output: f64,
    total: f64,
    memory: f64,
}

fn run(directory: &Path, cells: usize, strategy: &str) -> Times {
    let out = directory.join("run.h5");
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs/eva-one-arm.toml");
    let mut command = Command::new(env!("CARGO_BIN_EXE_mpjr"));
    command.env("OMP_NUM_THREADS", "1").env("OPENBLAS_NUM_THREADS", "1").arg("run").arg(scene).arg("--out").arg(&out);
    for change in [
        format!("layer.cells=[{cells},{cells}]"),
        format!("solver.strategy={strategy}"),
        format!("phase.indent.steps={STEPS}"),
        format!("phase.slide.steps={STEPS}"),
        "output.bulk_at=[]".to_owned(),
    ] {
        command.args(["--set", &change]);
    }
    let output = command.args(["--", "-log_view"]).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    // PETSc's log: name, count, ratio, seconds.
    let event = |name: &str| {
        let line = text.lines().find(|line| line.split_whitespace().next() == Some(name));
        line.and_then(|line| line.split_whitespace().nth(3)?.parse().ok()).unwrap_or(0.0)
    };
    let words = text.split_once("time:").map_or("", |(_, rest)| rest).replace('\n', " ");
    let part = |name: &str| duration(words.split_once(name).map_or("", |(_, rest)| rest));
    let newton: f64 = Results::open(&out).unwrap().history("newton_iterations").unwrap().iter().sum();
    Times {
        newton,
        assembly: part("assembly "),
        factor: event("MatLUFactorNum") + event("MatLUFactorSym"),
        solve: event("MatSolve"),
        output: part("output "),
        total: part("assembly ") + part("linear solver ") + part("output "),
        memory: words.split_once("at most ").map_or(0.0, |(_, rest)| rest.split(' ').next().unwrap().parse().unwrap()),
    }
}

/// The duration at the beginning of a text, such as "12 ms", s.
fn duration(text: &str) -> f64 {
    let mut words = text.split_whitespace();
    let value: f64 = words.next().and_then(|word| word.parse().ok()).unwrap_or(0.0);
    match words.next().unwrap_or("").trim_end_matches([',', ';']) {
        "us" => value * 1e-6,
        "ms" => value * 1e-3,
        "min" => value * 60.0,
        _ => value,
    }
}
