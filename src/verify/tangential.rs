//! Partial slip: Cattaneo and Mindlin, and the cycles of Jager and Ciavarella.
//!
//! They neglect that pressure displaces the face tangentially and shear normally, which they do in proportion to
//! Dundurs' beta = (1-2nu)/(2(1-nu)): here 2e-4, with elements that do not lock, so that little shear is left after
//! pressing; and that the contact travels along the face with the indenter, which does so by some f a. Friction is
//! regularised by the slip and needs no time scale.

use super::half_space::{EDGES, OSCILLATION, deep, hertz_among_images, largest, modulus};
use super::setting::{Indenter, Phase, Setting};
use super::{Case, Row, resolution};
use crate::oracle::line_contact::{Oscillation, Westergaard};
use crate::scene::{Friction, Law};
use crate::solution::Solution;

const POISSON: f64 = 0.4999;
const FRICTION: f64 = 0.1;

const PRESSED: &str = "mesh; the shear after pressing; travel/a";
const STATED: &str = "the elastic slip stated";

pub fn cases(quick: bool) -> Vec<Case> {
    vec![mindlin(512), cycle(if quick { 128 } else { 256 })]
}

/// A deep layer of elements for Poisson ratios near 1/2, with an elastic slip in m.
fn nearly_incompressible(n: usize, indenter: Indenter, elastic_slip: f64, phases: Vec<Phase>) -> Setting {
    Setting {
        depth: 1.0,
        mean_dilatation: true,
        friction: Some(Friction::constant(Law::CoulombElasticSlip { elastic_slip }, FRICTION)),
        ..deep(n, POISSON, indenter, phases)
    }
}

/// A motion along the face at a held approach, in one second.
fn sway(distance: f64, steps: usize, approach: f64) -> Phase {
    Phase { velocity: distance, ..Phase::press(1.0, steps, approach) }
}

/// Normal force, then a growing tangential displacement: the tractions point by point, and the zone that sticks.
fn mindlin(n: usize) -> Case {
    let approach = 4e-3;
    let (elastic_slip, distance) = (1e-7, 8.5e-4);
    // One step: without memory and turns, where the sway comes from does not matter.
    let phases = vec![Phase::press(1.0, 20, approach), sway(distance, 1, approach)];
    let setting = nearly_incompressible(n, Indenter::Parabola(1.0), elastic_slip, phases);
    let subjects = vec![setting.clone().into()];
    let compare = move |solutions: &[Solution]| {
        let (solution, end) = (&solutions[0], &solutions[0].ends[1]);
        let row = solution.last();
        let exact = hertz_among_images(&setting, row.normal_force);
        let (a, h, force) = (exact.half_width(), setting.spacing(), row.tangential_force);
        let (c, peak) = (a * exact.stick_ratio(force, FRICTION), exact.peak());
        let before = solution.end_of(0);
        let middle = 0.5 + distance;
        let p = largest(solution, &end.pressure, |x| exact.pressure(x), (middle, 0.9 * a)) / peak;
        let q =
            largest(solution, &end.shear, |x| exact.shear(force, FRICTION, x), (middle, 0.8 * c)) / (FRICTION * peak);
        let far = |x: f64| exact.shear(force, FRICTION, x);
        let near = largest(solution, &end.shear, far, (middle, 0.9 * a)) / (FRICTION * peak);
        let stuck = row.stick_fraction * row.contact_fraction;
        let pressed = &solution.ends[0].shear;
        let left = largest(solution, pressed, |_| 0.0, (0.5, 0.9 * a)) / (FRICTION * peak);
        let smooth = 6.0 * resolution(h, 2.0 * a);
        let travelled = left + distance / a;
        Ok(vec![
            Row::new(
                "Q_x/(f N_z) after pressing",
                [before.tangential_force / (FRICTION * before.normal_force), 0.0],
                1e-6,
                "solver",
            ),
            Row::new("contact width 2a, m", [row.contact_fraction, 2.0 * a], 2.0 * h, "one node at each edge"),
            Row::new("largest error of p(x), |x| < 0.9 a, of p0", [p, 0.0], smooth, EDGES),
            Row::new("width of the stick zone 2c, m", [stuck, 2.0 * c], 4.0 * h, "two nodes at each edge"),
            Row::new("largest error of q(x), |x| < 0.8 c, of f p0", [q, 0.0], smooth + travelled, PRESSED),
            Row::new(
                "largest error of q(x), |x| < 0.9 a, of f p0",
                [near, 0.0],
                (2.0 * h / c).sqrt(),
                "sqrt cusp at c, placed to a spacing",
            ),
            Row::new("largest slip of a sticking point, m", [row.stuck_slip, 0.0], elastic_slip, STATED),
            Row::new(OSCILLATION, [row.traction_oscillation, 0.0], 2.0 * h / c, "edges: 2 h/c; a checkerboard: 1"),
        ])
    };
    Case {
        name: format!("Cattaneo-Mindlin, nu = {POISSON}, {n} cells"),
        source: "Johnson, Contact Mechanics, 7.2(d)",
        subjects,
        compare: Box::new(compare),
    }
}

/// A wave at a held approach, swayed half of the way to full sliding, back as far on the other side, and forth again: at
/// each step Q against the superposition Q = f [P(D) - P(D - ...)] of Jager and Ciavarella, P by Westergaard.
///
/// The theorem takes the tangential compliance to equal the normal one, which holds at every k > 0 on a deep layer but
/// not for the mean, where C_xx = H/G and C_zz = H (1-2nu)/(2G (1-nu)): so the sway is lessened by the mean's own
/// (C_xx - C_zz) Q/L first.
fn cycle(n: usize) -> Case {
    let approach = 2.5e-4;
    let mut setting = nearly_incompressible(n, Indenter::Wave(5e-4), 1e-9, vec![Phase::press(1.0, 20, approach)]);
    let wave = setting.wave();
    let mean = setting.layer().compliance(0.0, setting.moduli());
    let excess = mean.xx.re - mean.zz.re;
    let exact = Westergaard { modulus: modulus(&setting), amplitude: wave.amplitude, wavelength: setting.width };
    let force = move |d: f64| exact.wavelength * exact.mean_at(d, mean.zz.re);
    let normal = force(approach);
    let half = 0.5 * FRICTION * (approach + excess * normal / setting.width);
    for (distance, steps) in [(half, 10), (-2.0 * half, 20), (2.0 * half, 20)] {
        setting.phases.push(sway(distance, steps, approach));
    }
    let subjects = vec![setting.into()];
    let compare = move |solutions: &[Solution]| {
        let mut contact = Oscillation::new(force, approach, FRICTION);
        let mut worst = [0.0_f64; 2];
        let mut turns = Vec::new();
        for phase in 1..=3 {
            let mut last = [0.0_f64; 2];
            for row in solutions[0].history.iter().filter(|row| row.phase == phase) {
                let q = row.tangential_force;
                last = [q, contact.advance(row.sliding - excess * q)];
                if (last[0] - last[1]).abs() > (worst[0] - worst[1]).abs() {
                    worst = last;
                }
            }
            turns.push(last);
        }
        let limit = FRICTION * normal;
        let tolerance = 0.005 * limit;
        let why = "0.5 % of f P: mesh";
        Ok(vec![
            Row::relative("N_z, N/m", [solutions[0].end_of(0).normal_force, normal], 0.01, "1 %: mesh, nu near 1/2"),
            Row::new("Q_x at the first turn, N/m", turns[0], tolerance, why),
            Row::new("Q_x at the second turn, N/m", turns[1], tolerance, why),
            Row::new("Q_x at the third turn, N/m", turns[2], tolerance, why),
            Row::new("Q_x where it differs most, N/m", worst, tolerance, why),
        ])
    };
    Case {
        name: format!("Jager-Ciavarella cycle, nu = {POISSON}, {n} cells"),
        source: "Jager 1993, Ciavarella 1998",
        subjects,
        compare: Box::new(compare),
    }
}
