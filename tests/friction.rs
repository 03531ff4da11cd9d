//! Coefficients of friction by formulas and tables, and limits of the shear.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::program::Run;
use common::scene::{COSINE, TWO_ARMS, Text, WAVE, coulomb, elastic, layer, phase, regularised};

/// A nearly incompressible deep layer under a wave, elastic; slid by whole cells.
static FULL_SLIP: Text = Text::new(|| {
    let layer = layer("1.0", "2.0", "[256, 128]") + "grading = 8.0\nelement = \"q4_bbar\"\n";
    let friction = coulomb("\"0.3*(max(p, 1e-9)/0.1)^-0.25\"");
    let load = phase("load", 2) + "duration = 1.0\nnormal_force = 0.05\n";
    let slide = phase("slide", 4) + "velocity = 0.046875\ndistance = 0.046875\n";
    layer + &elastic("568.498", "0.4999") + COSINE + &friction + &load + &slide
});

/// In full slip q = f p of Westergaard's pressure under 0.05 N/m: f = 0.3 (p/0.1)^-0.25 gives 9.25938e-3 N/m, a limit of 0.02 Pa on
/// f = 0.3 gives 1.508493e-3 N/m. On 256 nodes the edge of the contact is known to a cell: 2e-3 of the first, one node under the limit,
/// 0.02/256 N/m, of the second.
#[test]
fn full_slip_has_the_shear_of_its_pressure() {
    let power = Run::new(&FULL_SLIP).done().last("tangential_force");
    let capped = Run::new(&FULL_SLIP).set("friction.coefficient=0.3").set("friction.shear_limit=0.02").done();
    let capped = capped.last("tangential_force");
    println!("{power:e} {capped:e}");
    assert!((power / 9.25938e-3 - 1.0).abs() < 2e-3, "{power}");
    assert!((capped - 1.508493e-3).abs() < 0.02 / 256.0, "{capped}");
}

/// Pressed, slid, lifted and pressed again, with friction that knows rate, pressure and distance.
static HISTORY: Text = Text::new(|| {
    let coefficient = "\"0.2 + 0.02*ln(1 + v/0.01) + 0.1*exp(-s/0.05) - 0.01*min(p, 2)\"";
    let friction = regularised("1e6", coefficient) + "shear_limit = 0.25\n";
    let again = phase("again", 4) + "duration = 1.0\napproach = 1e-3\nvelocity = 0.05\n";
    let material = TWO_ARMS.replace(", { weight = 0.4, time = 2.0 }", "");
    let rest = "[solver]\ntolerance = 1e-11\n";
    layer("1.0", "0.7", "[24, 12]")
        + &material
        + COSINE
        + &friction
        + &WAVE.replace("steps = 6", "steps = 16")
        + &again
        + rest
});

/// Both strategies solve the same equations, with the regularised laws and what a point has slid: 1e-8 of the largest force.
#[test]
fn both_strategies_know_rate_pressure_and_distance() {
    for law in ["coulomb_tanh", "coulomb_elastic_slip"] {
        let scene = match law {
            "coulomb_tanh" => HISTORY.clone(),
            _ => HISTORY.replace("regularisation = 1e-3", "elastic_slip = 1e-5").replace("coulomb_tanh", law),
        };
        let [condensed, monolithic] = ["condensed", "monolithic"]
            .map(|strategy| Run::new(&scene).set(format!("solver.strategy={strategy}")).done());
        for column in ["normal_force", "tangential_force"] {
            let (a, b) = (condensed.history(column), monolithic.history(column));
            let largest = a.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let apart = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(largest > 0.03 && apart < 1e-8 * largest, "{law} {column}: {apart:e} of {largest:e}");
        }
    }
}

/// What a point has slid is kept while it is out of contact: after 0.2 m of sliding at 0.3, another 0.2 m and a lift, a coefficient that has fallen
/// to 0.1 stays there. Full contact slips all over: Q = f N.
#[test]
fn slid_distance_outlasts_the_contact() {
    let scene = HISTORY
        .replace("\"0.2 + 0.02*ln(1 + v/0.01) + 0.1*exp(-s/0.05) - 0.01*min(p, 2)\"", "\"0.3 - 0.2*step(s, 0.2)\"");
    let scene = scene.replace("shear_limit = 0.25", "").replace("5e-4", "5e-6");
    let run = Run::new(&scene).done();
    let share = |time: f64| run.at(time, "tangential_force") / run.at(time, "normal_force");
    assert!((share(2.0) - 0.3).abs() < 1e-9 && (share(4.0) - 0.1).abs() < 1e-9, "{} {}", share(2.0), share(4.0));
    assert_eq!(run.at(6.0, "normal_force"), 0.0);
    assert!((run.last("tangential_force") / run.last("normal_force") - 0.1).abs() < 1e-9);
}

/// A table in a file is the curve through its points; the scene that a result holds has it in full and gives the same bits without
/// the file.
#[test]
fn a_table_is_taken_into_the_scene() {
    let coefficient = "coefficient = \"0.3*(max(p, 1e-9)/0.1)^-0.25\"";
    let by_formula = FULL_SLIP.replace(coefficient, "coefficient = \"0.3 - 2*min(v, 0.05)\"");
    let by_table = FULL_SLIP.replace(coefficient, "coefficient = \"table('f.csv', v)\"").replace('\'', "\\\"");
    let run = Run::new(&by_table);
    std::fs::write(run.directory().join("f.csv"), "v (m/s),f\n0,0.3\n0.05,0.2\n").unwrap();
    let run = run.done();
    let exact = Run::new(&by_formula).done().last("tangential_force");
    assert!((run.last("tangential_force") / exact - 1.0).abs() < 1e-12);
    let resolved = run.results().text("scene").unwrap();
    let again = Run::new(&resolved).done();
    assert_eq!(again.last("tangential_force"), run.last("tangential_force"));
    let missing = Run::new(&by_table).run();
    assert_eq!(missing.code, 4);
    missing.assert_single_message("cannot be read");
}

/// A formula that is negative at a state of the contact ends the run there with code 3, names the state once and keeps the results
/// before it.
#[test]
fn a_negative_coefficient_is_an_error() {
    let run = Run::new(&FULL_SLIP).set("friction.coefficient=0.3 - 10*v").run();
    assert_eq!(run.code, 3);
    run.assert_single_message("friction.coefficient is -0.");
    assert!((run.last("normal_force") / 0.05 - 1.0).abs() < 1e-9);
}
