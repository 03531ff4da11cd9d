//! An indenter held by a force instead of an approach.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::loads::PHASES;
use common::program::{Outcome, Run, assert_same};

/// A layer of 1 m x 1 m, one arm of the paper's Table 1, nu = 0.3 constant, under an indenter by its formula.
fn layer(cells: &str, formula: &str) -> String {
    format!(
        r#"
[layer]
width = 1.0
depth = 1.0
cells = {cells}
sides = "periodic"
[material]
shear_modulus = 568.498
poisson_ratio = 0.3
arms = [ {{ weight = 0.579, time = 0.817 }} ]
poisson_rule = "constant_ratio"
[indenter]
profile = "expression"
formula = "{formula}"
[contact]
"#
    )
}

/// A jump to 0.5 N/m, held.
const HELD: &str = r#"
[[phase]]
name = "jump"
duration = 1e-9
steps = 1
normal_force = 0.5
[[phase]]
name = "creep"
duration = 5.0
steps = 50
"#;

/// Under a flat indenter, with a penalty.
fn flat() -> String {
    layer("[16, 8]", "0*x") + "penalty = 1e6\n" + HELD
}

/// D = N (C0 j(t) + 1/alpha), C0 = H (1 - 2 nu)/(2 G (1 - nu)), j = (1 - mu_1 exp(-mu_0 t/tau))/mu_0 the creep of the layer: 2.51789e-4 m at
/// once, 5.7111e-4 after 5 s. Then, in 50, 100 steps, backward Euler is off by 3.1e-3, 1.5e-3 of it and the exponential memory by 3.6e-5,
/// 9.0e-6: of first and second order. By both strategies.
#[test]
fn a_layer_creeps_under_a_step_of_load() {
    let compliance = 0.4 / (2.0 * 568.498 * 0.7);
    let creep = |t: f64| (1.0 - 0.579 * (-0.421 * t / 0.817f64).exp()) / 0.421;
    let exact = |t: f64| 0.5 * (compliance * creep(t) + 1e-6);
    assert!((exact(0.0) - 2.51789e-4).abs() < 1e-9 && (exact(5.0) - 5.7111e-4).abs() < 1e-8);
    let apart = |strategy: &str, memory: &str, steps: usize| {
        let run = Run::new(&flat())
            .set(format!("solver.strategy={strategy}"))
            .set(format!("material.memory={memory}"))
            .set(format!("phase.creep.steps={steps}"))
            .done();
        assert!((run.at(1e-9, "approach") / exact(0.0) - 1.0).abs() < 1e-8);
        assert!(run.history("normal_force").iter().skip(1).all(|force| (force / 0.5 - 1.0).abs() < 1e-12));
        run.last("approach") / exact(5.0) - 1.0
    };
    for strategy in ["condensed", "monolithic"] {
        for (memory, [coarse, fine], order) in
            [("backward_euler", [-3.1e-3, -1.5e-3], 1.0), ("exponential", [-3.6e-5, -9.0e-6], 2.0)]
        {
            let found = [apart(strategy, memory, 50), apart(strategy, memory, 100)];
            println!("{strategy}, {memory}: {found:?}");
            assert!(
                (found[0] / coarse - 1.0).abs() < 0.05 && (found[1] / fine - 1.0).abs() < 0.05,
                "{strategy}, {memory}: {found:?}"
            );
            assert!(((found[0] / found[1]).log2() - order).abs() < 0.1, "{strategy}, {memory}: {found:?}");
        }
    }
}

/// A cosine under 0.5 N/m, frictionless, no penetration: by Lee and Radok over Westergaard's contact of a deep layer, s^2 =
/// sin^2(pi a/L) = N j(t)/(L p*), D = C0 N j/L + g0 s^2 (1 - ln s^2), p* = pi E* g0/L: 5.089689e-4 and 9.732573e-4 m, 0.29195 and 0.46491
/// of the face after 0 and 5 s; this layer is softer by 1.0e-4 and 7e-5.
#[test]
fn a_cosine_sinks_in_as_lee_and_radok_say() {
    let scene = layer("[256, 128]", "5e-4*(1-cos(2*pi*x))") + HELD;
    let run = Run::new(&scene).set("phase.creep.steps=100").done();
    for (t, approach, fraction) in
        [(1e-9, 5.089689e-4 * (1.0 - 1.0e-4), 0.29195), (5.0, 9.732573e-4 * (1.0 - 7e-5), 0.46491)]
    {
        let found = [run.at(t, "approach"), run.at(t, "contact_fraction")];
        println!("{t} s: {found:?}");
        assert!(
            (found[0] / approach - 1.0).abs() < 1e-4 && (found[1] - fraction).abs() < 2.0 / 256.0,
            "{t} s: {found:?}"
        );
    }
}

/// Under a wave, with Coulomb's law.
fn rubbed() -> String {
    layer("[48, 24]", "1e-3+5e-4*(1-cos(2*pi*x))")
        + "[friction]\nlaw = \"coulomb\"\ncoefficient = 0.2\n[solver]\ntolerance = 1e-11\n"
}

fn history() -> Run {
    Run::new(&(rubbed() + PHASES))
}

/// Forces rise linearly from what there is, are held by phases that say nothing, and Coulomb's law holds in gross sliding; an
/// approach goes on from where a force left the indenter; at no force it stops at the last touch. The energy balances.
#[test]
fn force_and_approach_take_turns() {
    let run = history().done();
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
    assert!(near(run.at(2.0, "normal_force"), 0.25) && near(run.at(3.0, "normal_force"), 0.5));
    let (time, force, approach) = (run.history("time"), run.history("normal_force"), run.history("approach"));
    assert!(time.iter().zip(&force).filter(|(t, _)| (3.0..18.0).contains(*t)).all(|(_, force)| near(*force, 0.5)));
    assert!(near(run.at(18.0, "tangential_force"), 0.1) && near(run.at(20.0, "tangential_force"), -0.04));
    assert!(near(run.at(19.0, "approach"), 2.4e-3) && run.at(18.1, "approach") > run.at(18.0, "approach"));
    let middle = 0.5 * (run.at(19.0, "normal_force") + 0.2);
    assert!(near(run.at(19.5, "normal_force"), middle));
    assert!(run.at(21.0, "normal_force") < 1e-12 && run.last("normal_force") < 1e-12);
    assert!(approach.iter().all(|approach| (0.0..=2.4e-3 + 1e-15).contains(approach)));
    let imbalance = run.last("energy/imbalance") / run.last("energy/external_work");
    println!("imbalance {imbalance:.1e}");
    assert!(imbalance.abs() < 1e-4, "{imbalance}");
}

/// The approach that a ramp of the load traced gives that load when it is replayed step by step; and 1 to 3 ranks agree.
#[test]
fn a_load_is_that_of_its_approach() {
    let scene = rubbed();
    let loaded = Run::new(&(scene.clone() + "[[phase]]\nduration = 2.0\nsteps = 20\nnormal_force = 0.5\n")).done();
    let approach = loaded.history("approach");
    let steps = approach.iter().skip(1).map(|d| format!("[[phase]]\nduration = 0.1\nsteps = 1\napproach = {d:?}\n"));
    let replayed = Run::new(&(scene + &steps.collect::<String>())).done();
    for (a, b) in loaded.history("normal_force").iter().zip(replayed.history("normal_force")) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    let alone = history().done();
    for ranks in [2, 3] {
        let together = history().ranks(ranks).done();
        for column in ["approach", "normal_force", "tangential_force"] {
            let pairs = alone.history(column).into_iter().zip(together.history(column));
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-9), "{ranks} ranks: {column}");
        }
    }
}

/// Steps that are chosen follow forces and approaches that take turns, by a share of the greatest penetration, 1.4e-3 m, that is known before the
/// first step; against 16 times the planned steps. One to four ranks choose the same.
#[test]
fn chosen_steps_follow_a_force() {
    let fine = history();
    let counts = [("near", 2), ("load", 20), ("slide", 60), ("sink", 10), ("back", 20), ("off", 10), ("rest", 10)];
    let fine =
        counts.iter().fold(fine, |run, (name, steps)| run.set(format!("phase.{name}.steps={}", 16 * steps))).done();
    let chosen = |tolerance: f64| {
        let each = |run: Run, (name, _): &(&str, i32)| {
            run.set(format!("phase.{name}.steps=")).set(format!("phase.{name}.tolerance={tolerance:?}"))
        };
        counts.iter().fold(history(), each)
    };
    let ends = [1.0, 3.0, 18.0, 19.0, 20.0, 21.0, 24.0];
    let mut last = f64::INFINITY;
    for tolerance in [1e-2, 1e-3, 1e-4] {
        let run = chosen(tolerance).done();
        let apart = |column: &str, size: f64| {
            let off = |time: &f64| (run.at(*time, column) - fine.at(*time, column)).abs() / size;
            ends.iter().map(off).fold(0.0, f64::max)
        };
        let found = [apart("approach", 1.4e-3), apart("normal_force", 0.5), apart("tangential_force", 0.1)];
        println!("{tolerance}: {found:?} in {} steps", run.history("time").len() - 1);
        let worst = found.into_iter().fold(0.0, f64::max);
        assert!(worst < 0.2 * tolerance && worst < last, "{tolerance}: {found:?}");
        last = worst;
        if tolerance == 1e-3 {
            for ranks in [2, 4] {
                let together = chosen(tolerance).ranks(ranks).done();
                let file = |run: &Outcome| run.directory.path().join("scene.h5");
                assert_same(&file(&run), &file(&together), 1e-9);
            }
        }
    }
}

/// A force that only a body thicker than this one could bear ends the run with code 3, and says so; tension, and a force beside an
/// approach, are errors of the scene.
#[test]
fn a_load_that_no_contact_carries_is_refused() {
    for strategy in ["condensed", "monolithic"] {
        let pressed = Run::new(&flat()).set("phase.jump.normal_force=5e3").set(format!("solver.strategy={strategy}"));
        let outcome = pressed.run();
        assert_eq!(outcome.code, 3, "{outcome:?}");
        assert!(outcome.stderr.contains("which no contact carries"), "{}", outcome.stderr);
    }
    for (set, message) in [
        (
            "phase.jump.normal_force=-1.0",
            "phase.jump.normal_force: must be a compressive force in N/m, at least 0, got -1.0",
        ),
        ("phase.jump.approach=1e-3", "phase.jump.normal_force: give approach or normal_force, not both"),
    ] {
        let outcome = Run::new(&flat()).set(set).run();
        assert!(outcome.code == 2 && outcome.stderr.contains(message), "{set}: {}", outcome.stderr);
    }
}
