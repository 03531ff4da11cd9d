//! What a step costs under each strategy: `cargo bench --bench strategies [-- CELLS...]`, one rank.
//!
//! The scene of `runs/eva-one-arm.toml` with few steps, of the length that it has there while sliding. Each case runs in
//! a process of its own, so that its memory is its own; the monolithic strategy first as it would be with an LU
//! factorisation at each Newton iteration (PETSc options `-ksp_type preonly -pc_type lu`), then as it is. Ratios of one
//! run hold better than seconds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use mpjr::petsc::{Session, peak_memory};
use mpjr::scene::{self, Source};
use mpjr::solution;

/// The argument before what a child process shall run: options of PETSc in one word, then changes of the scene.
const CHILD: &str = "--case";

/// Name, PETSc options, changes of the scene.
const CASES: [(&str, &str, &[&str]); 5] = [
    ("refactoring", "-ksp_type preonly -pc_type lu", &["solver.strategy=monolithic"]),
    ("monolithic", "", &["solver.strategy=monolithic"]),
    ("condensed", "", &["solver.strategy=condensed"]),
    ("condensed, constant bulk", "", &["solver.strategy=condensed", "material.poisson_rule=constant_bulk_modulus"]),
    ("condensed, free sides", "", &["solver.strategy=condensed", "layer.sides=free"]),
];

/// What every case changes.
const FEW_STEPS: [&str; 5] = [
    "phase.indent.steps=4",
    "phase.slide.distance=0.04",
    "phase.slide.steps=8",
    "output.bulk_at=[]",
    "output.energy=false",
];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.first().is_some_and(|first| first == CHILD) {
        return child(&arguments[1], &arguments[2..]);
    }
    let chosen: Vec<usize> = arguments.iter().filter_map(|word| word.parse().ok()).collect();
    println!(
        "one rank; times in s; ratio: of a step to one that refactorises; bytes per unknown beyond an idle process"
    );
    println!(
        "{:>6} {:>25} {:>7} {:>7} {:>8} {:>9} {:>9} {:>9} {:>7} {:>8}",
        "cells", "", "newton", "factors", "solves", "set-up", "assembly", "step", "ratio", "bytes"
    );
    for cells in if chosen.is_empty() { vec![64, 128, 256] } else { chosen } {
        let mut reference = f64::NAN;
        for (name, petsc, changes) in CASES {
            let run = run(cells, petsc, changes);
            if reference.is_nan() {
                reference = run.step;
            }
            println!(
                "{:>6} {name:>25} {:>7} {:>7} {:>8} {:>9.2e} {:>9.2e} {:>9.2e} {:>7.1} {:>8.0}",
                format!("{cells}^2"),
                run.newton,
                run.factorisations,
                run.solves,
                run.set_up,
                run.assembly,
                run.step,
                reference / run.step,
                run.memory / (2 * cells * cells) as f64,
            );
        }
    }
}

/// What a child process says of its run.
struct Run {
    newton: f64,
    factorisations: f64,
    solves: f64,
    /// s
    set_up: f64,
    /// s per step
    assembly: f64,
    /// s
    step: f64,
    /// bytes
    memory: f64,
}

fn run(cells: usize, petsc: &str, changes: &[&str]) -> Run {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.env("OMP_NUM_THREADS", "1").env("OPENBLAS_NUM_THREADS", "1").args([CHILD, petsc]);
    command.arg(format!("layer.cells=[{cells},{cells}]")).args(FEW_STEPS).args(changes);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let numbers: Vec<f64> = text.split_whitespace().map(|word| word.parse().unwrap()).collect();
    let [newton, factorisations, solves, set_up, assembly, step, memory] = numbers.try_into().unwrap();
    Run { newton, factorisations, solves, set_up, assembly, step, memory }
}

fn child(petsc: &str, changes: &[String]) {
    let options: Vec<String> = petsc.split_whitespace().map(str::to_owned).collect();
    let session = Session::start(&options).unwrap();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("runs/eva-one-arm.toml");
    let source = Source { file: file.clone(), overrides: changes.to_vec() };
    let scene = scene::read(&scene::open(&file).unwrap(), &source).unwrap();
    let idle = peak_memory() as f64;
    let begun = Instant::now();
    let counts = solution::solve(&session.world(), &scene).unwrap().counts;
    let set_up = begun.elapsed() - counts.total;
    let per_step = |time: std::time::Duration| time.as_secs_f64() / counts.steps as f64;
    println!(
        "{} {} {} {} {} {} {}",
        counts.newton,
        counts.work.factorisations,
        counts.work.solves,
        set_up.as_secs_f64(),
        per_step(counts.assembly),
        per_step(counts.total),
        peak_memory() as f64 - idle,
    );
}
