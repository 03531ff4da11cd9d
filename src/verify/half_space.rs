//! Contacts narrow against the depth of the layer: Westergaard and Hertz.

use std::f64::consts::PI;

use super::setting::{Indenter, Phase, Setting, elastic};
use super::{Case, Row, resolution};
use crate::oracle::line_contact::{Hertz, Westergaard, plane_strain_modulus};
use crate::solution::Solution;

pub fn cases(quick: bool) -> Vec<Case> {
    let n = if quick { 128 } else { 512 };
    let mut list = vec![westergaard(n, 1.5e-3)];
    if !quick {
        list.push(westergaard(n, 3e-3));
    }
    list.push(hertz(if quick { 256 } else { 512 }));
    list
}

/// A deep layer, frictionless: cells as long as high at the face, twenty times as high at the base.
pub fn deep(n: usize, poisson: f64, indenter: Indenter, phases: Vec<Phase>) -> Setting {
    Setting {
        depth: 2.0,
        cells: [n, n / 3],
        grading: 20.0,
        indenter,
        penalty: Some(1e9),
        ..Setting::new(n, elastic(300.0, poisson), phases)
    }
}

/// E* of a setting, Pa.
pub fn modulus(setting: &Setting) -> f64 {
    let nu = setting.solid.poisson;
    plane_strain_modulus(2.0 * setting.solid.shear * (1.0 + nu), nu)
}

/// The largest difference of two fields over `scale`, within `half` of `centre`.
pub fn largest(solution: &Solution, field: &[f64], exact: impl Fn(f64) -> f64, (centre, half): (f64, f64)) -> f64 {
    let near = |x: f64| x - centre - (x - centre).round();
    let pairs = solution.x.iter().zip(field).filter(|(x, _)| near(**x).abs() < half);
    pairs.map(|(x, value)| (value - exact(near(*x))).abs()).fold(0.0, f64::max)
}

const EDGE: &str = "one node at each edge";
/// The reason of a tolerance of fields.
pub const EDGES: &str = "mesh: (k h)^2, next to the edges";

/// A wave on a layer two wavelengths deep; the depth is felt by e^{-2kH} = 1e-11 at most, but by the mean,
/// whose compliance is the layer's. The pressures are compared at the mean pressure found.
fn westergaard(n: usize, approach: f64) -> Case {
    let setting = deep(n, 0.3, Indenter::Wave(5e-4), vec![Phase::press(1.0, 2, approach)]);
    let subjects = vec![setting.clone().into()];
    let compare = move |solutions: &[Solution]| {
        let (solution, end) = (&solutions[0], &solutions[0].ends[0]);
        let wave = setting.wave();
        let exact = Westergaard { modulus: modulus(&setting), amplitude: wave.amplitude, wavelength: 1.0 };
        let mean = solution.last().normal_force;
        let (a, h) = (exact.half_width(mean), setting.spacing());
        let peak = exact.pressure(mean, 0.0);
        let error = largest(solution, &end.pressure, |x| exact.pressure(mean, x), (0.0, 0.9 * a)) / peak;
        let summit = end.pressure[0];
        let uniform = setting.layer().compliance(0.0, setting.moduli()).zz.re;
        let held = exact.mean_at(approach, uniform);
        // Next to full contact the pressure is the wave.
        let resolution = resolution(h, (2.0 * a).min(0.5));
        Ok(vec![
            Row::resolved("N_z at this approach, N/m", [mean, held], resolution),
            Row::new("contact width, m", [solution.last().contact_fraction, 2.0 * a], 2.0 * h, EDGE),
            Row::resolved("p under the summit at this N_z, Pa", [summit, peak], resolution),
            Row::new("largest error of p(x), |x| < 0.9 a, of its peak", [error, 0.0], 6.0 * resolution, EDGES),
            Row::new(OSCILLATION, [solution.last().traction_oscillation, 0.0], h / a, "edges: h/a; a checkerboard: 1"),
        ])
    };
    Case {
        name: format!("Westergaard, approach {approach:e} m, {n} cells"),
        source: "Westergaard 1939; Johnson, Contact Mechanics, 13.2",
        subjects,
        compare: Box::new(compare),
    }
}

/// See [`crate::interface`].
pub const OSCILLATION: &str = "node-to-node oscillation of the tractions";

/// Hertz among the periodic images of his cylinder: the indentation -(2P/(pi E*)) ln|x - nL| by the others has at the
/// contact the curvature (2P/(pi E*)) pi^2/(3 L^2), upward like that of the cylinder, and adds to it. What is left is
/// of order (a/L)^4.
pub fn hertz_among_images(setting: &Setting, force: f64) -> Hertz {
    let (modulus, width) = (modulus(setting), setting.width);
    let radius = if let Indenter::Parabola(radius) = setting.indenter { radius } else { f64::INFINITY };
    let curvature = 1.0 / radius + 2.0 * PI * force / (3.0 * modulus * width * width);
    Hertz { modulus, radius: 1.0 / curvature, force }
}

/// A parabola on a deep wide layer, compared at the force found: a half-plane has no approach.
fn hertz(n: usize) -> Case {
    let setting = deep(n, 0.3, Indenter::Parabola(1.0), vec![Phase::press(1.0, 2, 5e-3)]);
    let subjects = vec![setting.clone().into()];
    let compare = move |solutions: &[Solution]| {
        let (solution, end) = (&solutions[0], &solutions[0].ends[0]);
        let exact = hertz_among_images(&setting, solution.last().normal_force);
        let (a, h) = (exact.half_width(), setting.spacing());
        let error = largest(solution, &end.pressure, |x| exact.pressure(x), (0.5, 0.9 * a)) / exact.peak();
        let peak = end.pressure[n / 2];
        let resolution = resolution(h, 2.0 * a);
        Ok(vec![
            Row::new("contact width 2a, m", [solution.last().contact_fraction, 2.0 * a], 2.0 * h, EDGE),
            Row::resolved("peak pressure p0, Pa", [peak, exact.peak()], resolution),
            Row::new("largest error of p(x), |x| < 0.9 a, of p0", [error, 0.0], 6.0 * resolution, EDGES),
            Row::new(OSCILLATION, [solution.last().traction_oscillation, 0.0], h / a, "edges: h/a; a checkerboard: 1"),
        ])
    };
    Case {
        name: format!("Hertz, line contact, {n} cells"),
        source: "Hertz; Johnson, Contact Mechanics, 4.2(c)",
        subjects,
        compare: Box::new(compare),
    }
}
