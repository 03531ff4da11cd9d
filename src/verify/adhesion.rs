//! Adhesion: a cylinder and a wave pulled off an elastic layer, in the limit of a short range.

use std::f64::consts::PI;

use super::setting::{Indenter, Phase, Setting, elastic};
use super::{Case, Row};
use crate::scene::{Adhesion, AdhesionLaw, Bond};
use crate::solution::Solution;

/// G, Pa; nu.
const SHEAR: f64 = 568.498;
const POISSON: f64 = 0.3;
/// w, J/m^2.
const WORK: f64 = 1.80349e-4;
/// Of the parabola, m.
const RADIUS: f64 = 50.6606;
/// Of the wave, m.
const AMPLITUDE: f64 = 5e-4;
/// Of the bilinear law, m: its cohesive zone, pi E* w/(4 sigma_0^2), is 0.0113 m long, a fifth of half a contact, and 3.3 cells.
const RANGE: f64 = 8e-5;
const ZONE: &str = "the cohesive zone, a fifth of half the contact's width";

pub fn cases() -> Vec<Case> {
    vec![cylinder(), wave()]
}

/// E* = 2 G/(1 - nu), Pa.
fn modulus() -> f64 {
    2.0 * SHEAR / (1.0 - POISSON)
}

/// Pressed by 2e-4 m and pulled off, without friction.
fn pulled(indenter: Indenter) -> Setting {
    let phases = vec![Phase::press(1.0, 20, 2e-4), Phase::press(1.0, 130, -3.2e-4)];
    let adhesion = Adhesion { law: AdhesionLaw::Bilinear, work: WORK, range: RANGE, friction: Bond::None };
    Setting {
        cells: [288, 64],
        grading: 8.0,
        indenter,
        penalty: None,
        adhesion: Some(adhesion),
        ..Setting::new(288, elastic(SHEAR, POISSON), phases)
    }
}

/// The least force, N/m, and what is left of force and contact at the end.
fn least(solution: &Solution) -> [f64; 3] {
    let least = solution.history.iter().map(|row| row.normal_force).fold(f64::INFINITY, f64::min);
    [least, solution.last().normal_force, solution.last().contact_fraction]
}

fn pull_off(name: &str, source: &'static str, indenter: Indenter, (exact, within): (f64, f64)) -> Case {
    let compare = move |solutions: &[Solution]| {
        let [force, left, fraction] = least(&solutions[0]);
        Ok(vec![
            Row::relative("pull-off force, N/m", [force, exact], within, ZONE),
            Row::new("force after it, N/m", [left, 0.0], 0.0, "nothing pulls beyond the range"),
            Row::new("contact fraction after it", [fraction, 0.0], 0.0, "nothing touches"),
        ])
    };
    Case {
        name: format!("{name}, bilinear law, 288 nodes"),
        source,
        subjects: vec![pulled(indenter).into()],
        compare: Box::new(compare),
    }
}

/// -3 (pi E* w^2 R/16)^(1/3)
fn cylinder() -> Case {
    let exact = -3.0 * (PI * modulus() * WORK * WORK * RADIUS / 16.0).cbrt();
    pull_off(
        "pull-off of a cylinder",
        "Johnson, Kendall and Roberts; Barquins",
        Indenter::Parabola(RADIUS),
        (exact, 1e-2),
    )
}

/// The least of p*(sin^2 psi - alpha sqrt(tan psi)), alpha^2 = 2 w L/(pi^2 E* g_0^2), p* = pi E* g_0/L, L = 1 m.
fn wave() -> Case {
    let closing = PI * modulus() * AMPLITUDE;
    let alpha = (2.0 * WORK / (PI * PI * modulus() * AMPLITUDE * AMPLITUDE)).sqrt();
    let force = |psi: f64| closing * (psi.sin().powi(2) - alpha * psi.tan().sqrt());
    // Of contacts of less than half the wave: near full contact there is another branch. To the second order of the spacing, 1e-7 of it.
    let exact = (1..4000).map(|i| force(i as f64 * PI / 16000.0)).fold(f64::INFINITY, f64::min);
    pull_off(
        "pull-off of a wave",
        "Johnson, Int. J. Solids Struct. 32 (1995) 423",
        Indenter::Wave(AMPLITUDE),
        (exact, 5e-3),
    )
}
