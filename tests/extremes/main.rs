//! Numerical stability at the extremes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../common/mpi.rs"]
mod mpi_cases;
mod sample;

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use mpi::topology::SimpleCommunicator;
use mpi_cases::Case;
use mpjr::error::Error;
use mpjr::scene::{self, Source};
use mpjr::solution::{self, Solution};
use sample::{Draw, Sample};

const CASES: &[Case] = &[Case::new("random_scenes", &[1], random_scenes)];

fn main() {
    mpi_cases::main(CASES);
}

fn random_scenes(world: &SimpleCommunicator, _: &Path) {
    let count: usize = std::env::var("MPJR_EXTREMES").ok().and_then(|n| n.parse().ok()).unwrap_or(100);
    let mut draw = Draw(1);
    let mut failures: BTreeMap<String, usize> = BTreeMap::new();
    let (mut converged, mut broken) = (0, 0);
    for i in 0..count {
        let sample = Sample::random(&mut draw);
        let source = Source { file: "extreme.toml".into(), overrides: Vec::new() };
        let scene = scene::read(&sample.scene(1.0, 1.0, 1.0), &source).unwrap_or_else(|error| panic!("{error}\n{}", sample.scene(1.0, 1.0, 1.0)));
        let begun = Instant::now();
        match solution::solve(world, &scene) {
            Ok(solution) => {
                converged += 1;
                if let Err(what) = bounds(&sample, &solution) {
                    broken += 1;
                    println!("{i}: BROKEN {what}: {sample:?}");
                }
            }
            Err(Error::Solver(text)) => {
                println!("{i}: {text} {sample:?}");
                *failures.entry("solver".into()).or_default() += 1;
            }
            Err(other) => {
                println!("{i}: OTHER {other} {sample:?}");
                *failures.entry("other".into()).or_default() += 1;
            }
        }
        let took = begun.elapsed().as_secs_f64();
        if took > 1.0 {
            println!("{i}: took {took} s {sample:?}");
        }
    }
    println!("{converged} of {count} converged, {broken} broken; {failures:?}");
    panic!("see");
}

fn bounds(sample: &Sample, solution: &Solution) -> Result<(), String> {
    for row in &solution.history {
        for value in [row.normal_force, row.tangential_force, row.hysteretic_force, row.max_penetration, row.contact_fraction] {
            if !value.is_finite() {
                return Err(format!("not finite: {row:?}"));
            }
        }
        if row.normal_force < 0.0 || row.tangential_force.abs() > sample.friction * row.normal_force * (1.0 + 1e-9) {
            return Err(format!("forces: {row:?}"));
        }
    }
    for end in &solution.ends {
        for i in 0..end.pressure.len() {
            let (p, q, gap) = (end.pressure[i], end.shear[i], end.gap[i]);
            if !(p >= 0.0) || q.abs() > sample.friction * p * (1.0 + 1e-9) {
                return Err(format!("tractions at node {i}: p {p:e} q {q:e}"));
            }
            if sample.quadrature == "nodal" && gap > 0.0 && p != 0.0 {
                return Err(format!("traction in the gap at node {i}: p {p:e} gap {gap:e}"));
            }
        }
    }
    Ok(())
}
