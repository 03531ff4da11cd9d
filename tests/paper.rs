//! The study of the paper (Bonari and Paggi, Lubricants 8 (2020) 107): what its scenes must show.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::Path;

use common::program::{Outcome, Run};
use mpjr::rheology::fit::{Residuals, Samples, identify};
use mpjr::rheology::{Band, Fractional};
use mpjr::scene::sweep::{self, Sweep};

const LAYER: &str = include_str!("../runs/paper-layer.toml");

/// The layer of the study with the arms of Table 1 and a Poisson rule, on few cells and in few steps.
fn layer(arms: usize, rule: &str) -> Run {
    let file = common::directory(&format!("runs/materials/eva-{arms}.toml"));
    Run::new(LAYER).set(format!("material={{ file = {file:?}, poisson_rule = {rule:?} }}"))
}

fn approach_alone(run: Run) -> Run {
    run.set("phase.onset.steps=1").set("phase.slide.steps=1")
}

/// The materials of the study are what least squares on G = E/2 at fifty times from 0.1 to 10 s give: to 1e-7, of which a
/// minimum in double precision tells 1e-8.
#[test]
fn the_materials_are_those_of_table_1() {
    let law = Fractional::new(814.7 / 2.0, 0.226).unwrap();
    let time = Band::new(0.1, 10.0).unwrap().samples(50);
    let samples = Samples::relaxation(time.clone(), time.iter().map(|&t| law.relaxation(t)).collect());
    let cases = cases("runs/paper-study.toml").cases;
    for arms in 1..=3 {
        let material = cases.iter().map(|case| &case.scene.materials[0]).find(|m| m.arms.len() == arms).unwrap();
        let fit = identify(&samples, arms, Residuals::Linear, None).unwrap();
        let fitted = fit.series.arms.iter().flat_map(|arm| [arm.weight, arm.time]).chain([fit.instantaneous]);
        let kept = material.arms.iter().flat_map(|arm| [arm.weight, arm.time]).chain([material.shear_modulus]);
        let off = fitted.zip(kept).map(|(fitted, kept)| (fitted / kept - 1.0).abs()).fold(0.0, f64::max);
        println!("{arms} arms: off by {off:.1e}");
        assert!(off < 1e-7 && material.poisson_ratio == 0.0, "{arms} arms: {off}");
    }
}

/// At t0 friction that sticks leaves an antisymmetric shear, of at most 0.1852 to 0.1854 Pa (constant ratio; found by other
/// codes on 128 to 512 cells), and p(0) = 1.195 Pa on 128 cells. A law that creeps at 1e-4 m/s leaves 0.006 and 1.013 Pa.
#[test]
fn the_approach_sticks() {
    let outcome = approach_alone(layer(1, "constant_ratio")).set("solver.tolerance=1e-12").done();
    let results = outcome.results();
    let (pressure, shear) = (results.interface("pressure").unwrap(), results.interface("shear").unwrap());
    let (p, q) = (pressure.row(0), shear.row(0));
    let largest = q.iter().fold(0.0f64, |most, q| most.max(q.abs()));
    let crest = p.iter().copied().fold(0.0, f64::max);
    println!("max |q| {largest}, p(0) {crest}, N {}", outcome.at(10.0, "normal_force"));
    assert!((largest - 0.1853).abs() < 3e-4 && (crest - 1.195).abs() < 1e-3, "{largest} {crest}");
    // The crest is at x = 0, and node m - i lies opposite node i.
    let opposite = |i: usize| q[(q.len() - i) % q.len()];
    assert!((0..q.len()).all(|i| (q[i] + opposite(i)).abs() < 1e-8 * largest));
}

/// Nothing of the approach knows of the velocity that follows: to the last bit.
#[test]
fn the_approach_does_not_know_the_velocity() {
    let force = |velocity: &str| {
        let run = layer(1, "constant_bulk_modulus").set("layer.cells=[32,16]");
        let run = run.set(format!("phase.onset.velocity={velocity}")).set(format!("phase.slide.velocity={velocity}"));
        approach_alone(run).done().at(10.0, "normal_force")
    };
    assert_eq!(force("0.001").to_bits(), force("1.0").to_bits());
}

/// Steady Q at 2.154e-2 m/s (64 x 64 cells), N/m, with one, two and three arms: with a constant bulk modulus it grows with
/// the number of arms, as the paper says; with a constant ratio it falls.
#[test]
fn the_order_of_the_arms_is_that_of_the_poisson_rule() {
    for (rule, known) in
        [("constant_bulk_modulus", [0.0847, 0.0877, 0.0914]), ("constant_ratio", [0.0595, 0.0526, 0.0497])]
    {
        for (arms, known) in (1..).zip(known) {
            let run = layer(arms, rule).set("layer.cells=[64,64]").set("phase.indent.steps=25");
            let found: Outcome = run.set("phase.onset.steps=25").set("phase.slide.steps=500").done();
            let force = found.last("tangential_force");
            println!("{rule}, {arms}: {force}");
            assert!((force - known).abs() < 2e-4, "{rule}, {arms} arms: {force}");
        }
    }
}

/// The sweeps of the study: three materials at ten velocities and six bounds; one law of friction and, for a material, one
/// approach.
#[test]
fn the_velocities_of_a_material_share_the_approach() {
    for (name, count) in [("paper-study", 36), ("paper-study-constant-ratio", 36), ("paper-study-0.3", 18)] {
        let cases = cases(&format!("runs/{name}.toml"));
        assert_eq!(cases.cases.len(), count, "{name}");
        let first = &cases.cases[0].scene;
        for case in &cases.cases {
            assert_eq!((&case.scene.friction, &case.scene.phases[0]), (&first.friction, &first.phases[0]), "{name}");
        }
    }
}

fn cases(path: &str) -> Sweep {
    let file = common::directory(path);
    let text = std::fs::read_to_string(&file).unwrap();
    sweep::receive(&sweep::read(&text, Path::new(&file)).unwrap()).unwrap()
}
