//! Flanks that never touch, and a glassy modulus that no step meets.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::program::Run;

/// A flat punch with flanks, pressed on rubber and dragged.
const PUNCH: &str = r#"
[layer]
width = 0.04
depth = 0.01
cells = [160, 24]
grading = 4.0
sides = "free"
[material]
young_modulus = 2e6
poisson_ratio = 0.45
arms = [ { weight = 0.3, time = 0.01 }, { weight = 0.3, time = 0.1 } ]
poisson_rule = "constant_ratio"
[indenter]
profile = "expression"
formula = "SLOPE*max(0, abs(x-0.015)-0.004)"
[contact]
[friction]
law = "coulomb"
coefficient = 0.5
[[phase]]
name = "press"
duration = 0.5
steps = 25
approach = 2e-4
[[phase]]
name = "drag"
velocity = 0.01
distance = 0.01
steps = 50
"#;

/// The flanks are beside the contact: whatever their slope, the slope under the contact is that of the flat, and nothing but it
/// enters the hysteretic force. (With the mean slope of the kinks it is -28 N/m for each unit of slope.) The energy
/// balances within 1 % of the work. N differs by where a gentle flank touches, 3e-4.
#[test]
fn flanks_that_do_not_touch_resist_nothing() {
    let run = |slope: &str| Run::new(&PUNCH.replace("SLOPE", slope)).done();
    let steep = run("1000.0");
    for slope in ["1.0", "10.0", "1000.0"] {
        let flanked = run(slope);
        let force = flanked.last("normal_force");
        println!("{slope}: N = {force}, hysteretic = {}", flanked.last("hysteretic_force"));
        assert!(flanked.last("hysteretic_force").abs() < 1e-9 * force);
        assert!((force / steep.last("normal_force") - 1.0).abs() < 1e-3);
        assert!(flanked.last("energy/imbalance").abs() < 1e-2 * flanked.last("energy/external_work"));
    }
}

/// An arm that takes all but 1e-12 of the modulus within 1e-9 s: the penalty of a tolerance follows what the steps meet, so
/// that N is within that tolerance of contact without penetration. (Following the glassy modulus it left no digit of N.)
#[test]
fn a_penalty_follows_the_modulus_that_the_steps_meet() {
    let scene = PUNCH.replace("SLOPE*max(0, abs(x-0.015)-0.004)", "25*(x-0.015)^2").replace(
        "arms = [ { weight = 0.3, time = 0.01 }, { weight = 0.3, time = 0.1 } ]",
        "arms = [ { weight = 0.999999999999, time = 1e-9 } ]",
    );
    let scene = scene.replace("young_modulus = 2e6", "young_modulus = 2e18");
    let exact = Run::new(&scene).done().at(0.5, "normal_force");
    let soft = Run::new(&scene.replace("[contact]", "[contact]\ntolerance = 1e-2")).done().at(0.5, "normal_force");
    println!("{exact} N/m without penetration, {soft} with a tolerance of 1 %");
    assert!(exact > 1.0 && (soft / exact - 1.0).abs() < 1e-2, "{soft} {exact}");
}
