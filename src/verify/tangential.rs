//! Partial slip: Cattaneo and Mindlin.
//!
//! They neglect that pressure displaces the face tangentially and shear normally, which they do in proportion to
//! Dundurs' beta = (1-2nu)/(2(1-nu)). The scenes press so slowly, against the regularisation, that the contact is then
//! frictionless, as the theory supposes: so the coupling enters only by way of the shear, f beta of the pressure, and
//! back from that, beta^2 of the shear. With nu = 0.45, where bilinear elements do not lock yet, and f = 0.05 both are
//! under a hundredth. The sway, on the other hand, is so fast that sticking nodes creep by little of it.

use super::half_space::{OSCILLATION, deep, hertz_among_images, largest};
use super::setting::{Indenter, Phase, Setting};
use super::{Case, Row, resolution};
use crate::solution::Solution;

const POISSON: f64 = 0.45;
const FRICTION: f64 = 0.05;
/// f beta + beta^2.
const COUPLING: f64 = FRICTION * BETA + BETA * BETA;
const BETA: f64 = (1.0 - 2.0 * POISSON) / (2.0 * (1.0 - POISSON));

const WHY: &str = "mesh: (k h)^2/6; coupling: f beta + beta^2; creep";

// 512 cells in the quick table too: on 256 Newton's method fails at first and steps are cut, which takes longer.
pub fn cases() -> Vec<Case> {
    vec![mindlin(512)]
}

/// Presses frictionless: slip of some 1e-4 m in 1e8 s is nothing to a regularisation of 1e-6 m/s.
fn press(approach: f64) -> Phase {
    Phase::press(1e8, 4, approach)
}

/// Normal force, then a growing tangential displacement: the tractions point by point, and the zone that sticks.
fn mindlin(n: usize) -> Case {
    let approach = 4e-3;
    // One step: without memory and turns, where the sway comes from does not matter.
    let sway = Phase { duration: 1.0, steps: 1, approach, velocity: 4.3e-4 };
    let setting = Setting {
        depth: 1.0,
        friction: Some([FRICTION, 1e-6]),
        ..deep(n, POISSON, Indenter::Parabola(1.0), vec![press(approach), sway])
    };
    let subjects = vec![setting.clone().into()];
    let compare = move |solutions: &[Solution]| {
        let (solution, end) = (&solutions[0], &solutions[0].ends[1]);
        let row = solution.last();
        let exact = hertz_among_images(&setting, row.normal_force);
        let (a, h, force) = (exact.half_width(), setting.spacing(), row.tangential_force);
        let (c, peak) = (a * exact.stick_ratio(force, FRICTION), exact.peak());
        let before = solution.end_of(0);
        let p = largest(solution, &end.pressure, |x| exact.pressure(x), (0.5, 0.9 * a)) / peak;
        let q = largest(solution, &end.shear, |x| exact.shear(force, FRICTION, x), (0.5, 0.8 * c)) / (FRICTION * peak);
        let far = |x: f64| exact.shear(force, FRICTION, x);
        let near = largest(solution, &end.shear, far, (0.5, 0.9 * a)) / (FRICTION * peak);
        let stuck = row.stick_fraction * row.contact_fraction;
        let smooth = resolution(h, 2.0 * a) + COUPLING;
        // Sticking nodes creep at up to eps for a second; under full slip the contact has moved by f a^2/R.
        let creep = 1e-6 / (FRICTION * a * a);
        Ok(vec![
            Row::new(
                "Q_x/(f N_z) after pressing",
                [before.tangential_force / before.normal_force, 0.0],
                1e-6,
                "solver",
            ),
            Row::new("contact width 2a, m", [row.contact_fraction, 2.0 * a], 2.0 * h, "one node at each edge"),
            Row::new("largest error of p(x), |x| < 0.9 a, of p0", [p, 0.0], smooth, WHY),
            Row::new("width of the stick zone 2c, m", [stuck, 2.0 * c], 4.0 * h, "two nodes at each edge"),
            Row::new("largest error of q(x), |x| < 0.8 c, of f p0", [q, 0.0], smooth + creep, WHY),
            Row::new(
                "largest error of q(x), |x| < 0.9 a, of f p0",
                [near, 0.0],
                (2.0 * h / c).sqrt(),
                "sqrt cusp at c, placed to a spacing",
            ),
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
