//! The answer does not depend on how many ranks compute it, nor on the linear solver: histories, interface profiles and
//! bulk fields on 1, 2, 3 and 4 ranks agree to 1e-8 of the largest value of each field.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::compare::difference;
use common::program::{Outcome, Run};

const SLIDING: &str = include_str!("scenes/sliding.toml");
const PRESSING: &str = include_str!("scenes/pressing.toml");

const HISTORY: [&str; 9] = [
    "time",
    "approach",
    "sliding",
    "normal_force",
    "tangential_force",
    "hysteretic_force",
    "contact_fraction",
    "stick_fraction",
    "max_penetration",
];
const ENERGY: [&str; 6] =
    ["external_work", "stored", "viscoelastic_dissipation", "friction_dissipation", "penalty", "imbalance"];
const INTERFACE: [&str; 6] = ["pressure", "shear", "gap", "slip_rate", "displacement_x", "displacement_z"];

/// All unknowns, distributed.
fn monolithic(scene: &str) -> Run {
    Run::new(scene).set("solver.strategy=\"monolithic\"")
}

/// Periodic sides, friction that starts from rest, one arm at a constant Poisson ratio.
fn sliding() -> Run {
    monolithic(SLIDING)
        .set("layer.cells=[24,16]")
        .set("phase.indent.steps=10")
        .set("phase.slide.steps=20")
        .set("phase.slide.distance=0.2")
        .set("output.bulk_at=[\"indent\", 11.0, \"slide\"]")
}

/// Free sides, a circle, two arms at a constant bulk modulus, Gauss points, and a tangential oscillation.
fn circle() -> Run {
    let scene = SLIDING
        .replace(
            "profile = \"harmonic\"\namplitude = 5e-4\nwavelength = 1.0",
            "profile = \"circle\"\nradius = 2.0\ncentre = 0.43",
        )
        .replace("sides = \"periodic\"", "sides = \"free\"\ngrading = 4.0")
        .replace("constant_ratio", "constant_bulk_modulus")
        .replace("velocity = 0.1\ndistance = 1.0", "duration = 2.0\ntangential = { amplitude = 5e-4, cycles = 1.25 }");
    monolithic(&scene)
        .set("layer.cells=[21,10]")
        .set("contact.quadrature=\"gauss\"")
        .set("material.arms=[{ weight = 0.3, time = 0.4 }, { weight = 0.4, time = 3.0 }]")
        .set("phase.indent.approach=2e-3")
        .set("phase.indent.steps=8")
        .set("phase.slide.steps=20")
        .set("output.bulk_at=[\"indent\", \"slide\"]")
}

/// Frictionless and elastic, fixed sides, a parabola.
fn elastic() -> Run {
    let scene = PRESSING
        .replace(
            "profile = \"harmonic\"\namplitude = 5e-4\nwavelength = 1.0",
            "profile = \"parabola\"\nradius = 2.0\ncentre = 0.43",
        )
        .replace("sides = \"periodic\"", "sides = \"fixed\"");
    monolithic(&scene).set("layer.cells=[20,12]").set("output.bulk_at=[\"indent\"]")
}

/// Asserts that two runs agree in everything they wrote, to `tolerance` of the largest value of each field. What should
/// be zero by symmetry is round-off in both, measured by the normal force.
fn assert_same(one: &Outcome, other: &Outcome, tolerance: f64) -> f64 {
    let (one, other) = (one.results(), other.results());
    let scale = one.history("normal_force").unwrap().iter().fold(0.0f64, |most, n| most.max(*n));
    let mut worst = 0.0f64;
    let mut compare = |name: &str, a: &[f64], b: &[f64]| {
        let zero = a.iter().chain(b).all(|value| value.abs() < 1e-12 * scale);
        let apart = if zero && name.ends_with("force") { 0.0 } else { difference(a, b) };
        assert!(apart < tolerance, "{name}: {apart:e}");
        worst = worst.max(apart);
    };
    for name in HISTORY {
        compare(name, &one.history(name).unwrap(), &other.history(name).unwrap());
    }
    let (works, energies) = (one.history("energy/external_work").unwrap(), ENERGY.map(|name| format!("energy/{name}")));
    for name in energies {
        // Relative to the work: the small ones are differences of large ones.
        let [a, b] = [&one, &other].map(|results| results.history(&name).unwrap());
        let share = |values: &[f64]| values.iter().chain(&works).copied().collect::<Vec<_>>();
        compare(&name, &share(&a), &share(&b));
    }
    for name in INTERFACE {
        compare(name, &one.interface(name).unwrap().values, &other.interface(name).unwrap().values);
    }
    assert!(one.bulk("time").unwrap().rows > 0);
    for name in ["time", "coordinates", "cells", "displacement", "stress"] {
        compare(name, &one.bulk(name).unwrap().values, &other.bulk(name).unwrap().values);
    }
    worst
}

/// Runs a scene on 1 to 4 ranks and compares.
fn assert_same_on_ranks(scene: impl Fn() -> Run) {
    let alone = scene().done();
    assert_eq!(alone.results().number("mpi_ranks").unwrap(), 1.0);
    for ranks in [2, 3, 4] {
        let together = scene().ranks(ranks).done();
        assert_eq!(together.results().number("mpi_ranks").unwrap(), ranks as f64);
        println!("{ranks} ranks: {:e}", assert_same(&alone, &together, 1e-8));
    }
}

#[test]
fn sliding_with_friction_and_memory() {
    assert_same_on_ranks(sliding);
}

#[test]
fn circle_on_free_sides_with_constant_bulk_modulus() {
    assert_same_on_ranks(circle);
}

#[test]
fn frictionless_elastic() {
    assert_same_on_ranks(elastic);
}

/// The face is solved by one rank; the interior is recovered by all, by waves where it is a periodic layer and by a sparse
/// factorisation where it is not.
#[test]
fn condensed_recovers_the_interior_on_all_ranks() {
    let condensed = || sliding().set("solver.strategy=\"condensed\"");
    assert_same_on_ranks(condensed);
    assert_same_on_ranks(|| condensed().set("layer.sides=\"free\""));
}

/// More ranks than columns of cells: some may own little or nothing.
#[test]
fn more_ranks_than_the_mesh_is_worth() {
    let tiny = || elastic().set("layer.cells=[2,1]");
    let alone = tiny().done();
    for ranks in [2, 4] {
        assert_same(&alone, &tiny().ranks(ranks).done(), 1e-8);
    }
}

/// Krylov solvers with algebraic multigrid, selected by PETSc options. Their error stays below the Newton tolerance
/// asked for here (1e-11 of the contact force): 1e-8 of each field.
#[test]
fn krylov_solvers_give_the_same() {
    for (scene, options) in [
        (elastic as fn() -> Run, "-ksp_type cg -pc_type gamg -ksp_rtol 1e-10"),
        (sliding, "-ksp_type gmres -pc_type gamg -ksp_rtol 1e-12"),
    ] {
        let direct = scene().set("solver.tolerance=1e-11").done();
        for ranks in [1, 2] {
            let iterative = scene().set("solver.tolerance=1e-11").petsc(options).ranks(ranks).done();
            assert!(!iterative.stderr.contains("PETSc option"), "{}", iterative.stderr);
            println!("{options} on {ranks}: {:e}", assert_same(&direct, &iterative, 1e-8));
        }
    }
}
