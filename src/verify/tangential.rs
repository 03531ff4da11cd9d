//! Partial slip: Cattaneo and Mindlin, the cycles of Jager and Ciavarella, a flat punch, and a contact that is held.
//!
//! They neglect that pressure displaces the face tangentially and shear normally, which they do in proportion to
//! Dundurs' beta = (1-2nu)/(2(1-nu)): here 2e-4, with elements that do not lock, so that little shear is left after
//! pressing; and that the contact travels along the face with the indenter, which does so by some f a. Friction needs no time
//! scale: Coulomb's law itself without penetration, and beside it one regularised by the slip, with a penalty. With the law
//! itself each node is held against the closed form: in the stick zone it does not slip at all, outside it carries f p.

use super::half_space::{EDGES, OSCILLATION, deep, hertz_among_images, largest, modulus};
use super::setting::{Indenter, Phase, Setting, elastic};
use super::{Case, Row, resolution};
use crate::oracle::line_contact::{Oscillation, Westergaard};
use crate::output::{HistoryRow, InterfaceFrame};
use crate::scene::{Friction, Law};
use crate::solution::Solution;

const POISSON: f64 = 0.4999;
const FRICTION: f64 = 0.1;

const PRESSED: &str = "mesh; the shear after pressing; travel/a";
const STATED: &str = "the elastic slip stated";
const NONE: &str = "none at all";

pub fn cases(quick: bool) -> Vec<Case> {
    let mut list =
        vec![mindlin(512, Law::exact()), cycle(if quick { 128 } else { 256 }, Law::exact()), punch(256), held(64)];
    if !quick {
        list.extend([mindlin(512, Law::elastic_slip(1e-7)), cycle(256, Law::elastic_slip(1e-9))]);
    }
    list
}

/// A deep layer of elements for Poisson ratios near 1/2; without penetration where friction is Coulomb's law itself.
fn nearly_incompressible(n: usize, indenter: Indenter, law: Law, phases: Vec<Phase>) -> Setting {
    let deep = deep(n, POISSON, indenter, phases);
    Setting {
        depth: 1.0,
        mean_dilatation: true,
        penalty: deep.penalty.filter(|_| !law.is_exact()),
        friction: Some(Friction::constant(law, FRICTION)),
        ..deep
    }
}

fn said(law: Law) -> &'static str {
    if law.is_exact() { "Coulomb's law itself" } else { "elastic slip" }
}

/// A motion along the face at a held approach, in one second.
fn sway(distance: f64, steps: usize, approach: f64) -> Phase {
    Phase { velocity: distance, ..Phase::press(1.0, steps, approach) }
}

/// How many nodes in contact do not what a closed form says in the step that ends there: within `stick` of `centre` they stick,
/// which is to slip by nothing at all, elsewhere they slip and carry f p. Next to the edges of the stick zone, by up to a
/// spacing, they may do either.
fn misjudged(setting: &Setting, solution: &Solution, end: &InterfaceFrame, (centre, stick): (f64, f64)) -> f64 {
    let near = |x: f64| (x - centre - (x - centre).round()).abs();
    let nodes = solution.x.iter().zip(&end.pressure).zip(end.shear.iter().zip(&end.slip_rate));
    let touching = nodes.filter(|((_, p), _)| **p > 0.0);
    let friction = setting.friction.as_ref().and_then(Friction::coefficient).unwrap_or(0.0);
    let wrong = |((x, p), (q, slip)): &((&f64, &f64), (&f64, &f64))| {
        let at_the_limit = (q.abs() - friction * **p).abs() <= 1e-12 * **p;
        match near(**x) - stick {
            beyond if beyond > setting.spacing() => **slip == 0.0 || !at_the_limit,
            beyond if beyond < -setting.spacing() => **slip != 0.0,
            _ => false,
        }
    };
    touching.filter(wrong).count() as f64
}

const NODE_BY_NODE: &str = "each node but one at each edge of the stick zone";

/// Normal force, then a growing tangential displacement: the tractions point by point, and the zone that sticks.
fn mindlin(n: usize, law: Law) -> Case {
    let approach = 4e-3;
    let distance = 8.5e-4;
    // One step: without memory and turns, where the sway comes from does not matter.
    let phases = vec![Phase::press(1.0, 20, approach), sway(distance, 1, approach)];
    let setting = nearly_incompressible(n, Indenter::Parabola(1.0), law, phases);
    let subjects = vec![setting.clone().into()];
    let name = format!("Cattaneo-Mindlin, {}, nu = {POISSON}, {n} cells", said(law));
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
        let mut rows = vec![
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
            Row::new(OSCILLATION, [row.traction_oscillation, 0.0], 2.0 * h / c, "edges: 2 h/c; a checkerboard: 1"),
        ];
        rows.extend(match law.slip() {
            Some(elastic_slip) => {
                vec![Row::new("largest slip of a sticking point, m", [row.stuck_slip, 0.0], elastic_slip, STATED)]
            }
            None => vec![
                Row::new("largest slip of a sticking point, m", [row.stuck_slip, 0.0], 0.0, NONE),
                Row::new(
                    "nodes that do not stick or slip as they should",
                    [misjudged(&setting, solution, end, (middle, c)), 0.0],
                    0.0,
                    NODE_BY_NODE,
                ),
            ],
        });
        Ok(rows)
    };
    Case { name, source: "Johnson, Contact Mechanics, 7.2(d)", subjects, compare: Box::new(compare) }
}

/// The wave on a deep layer, in closed form: how it presses, and how far the mean tangential compliance is above the normal one,
/// m/Pa.
///
/// Where the theorem of Jager and Ciavarella takes the tangential compliance to equal the normal one, it does so at every k > 0
/// on a deep layer but not for the mean, where C_xx = H/G and C_zz = H (1-2nu)/(2G (1-nu)): so a sway is lessened by the
/// mean's own (C_xx - C_zz) Q/L first.
fn closed_form(setting: &Setting) -> (Westergaard, f64, f64) {
    let mean = setting.layer().compliance(0.0, setting.moduli());
    let amplitude = setting.wave().amplitude;
    let wave = Westergaard { modulus: modulus(setting), amplitude, wavelength: setting.width };
    (wave, mean.zz.re, mean.xx.re - mean.zz.re)
}

/// A wave at a held approach, swayed half of the way to full sliding, back as far on the other side, and forth again: at
/// each step Q against the superposition Q = f [P(D) - P(D - ...)] of Jager and Ciavarella, P by Westergaard; at each turn
/// what sticks against the contact at the approach that is taken off.
fn cycle(n: usize, law: Law) -> Case {
    let approach = 2.5e-4;
    let mut setting = nearly_incompressible(n, Indenter::Wave(5e-4), law, vec![Phase::press(1.0, 20, approach)]);
    let (exact, uniform, excess) = closed_form(&setting);
    let force = move |d: f64| exact.wavelength * exact.mean_at(d, uniform);
    let normal = force(approach);
    let half = 0.5 * FRICTION * (approach + excess * normal / setting.width);
    for (distance, steps) in [(half, 10), (-2.0 * half, 20), (2.0 * half, 20)] {
        setting.phases.push(sway(distance, steps, approach));
    }
    let subjects = vec![setting.clone().into()];
    let name = format!("Jager-Ciavarella cycle, {}, nu = {POISSON}, {n} cells", said(law));
    let compare = move |solutions: &[Solution]| {
        let solution = &solutions[0];
        let mut contact = Oscillation::new(force, approach, FRICTION);
        let mut worst = [0.0_f64; 2];
        let mut turns = Vec::new();
        let mut wrong = 0.0;
        for phase in 1..=3 {
            let mut last = [0.0_f64; 2];
            for row in solution.history.iter().filter(|row| row.phase == phase) {
                let q = row.tangential_force;
                last = [q, contact.advance(row.sliding - excess * q)];
                if (last[0] - last[1]).abs() > (worst[0] - worst[1]).abs() {
                    worst = last;
                }
            }
            turns.push(last);
            let stuck = exact.half_width(exact.mean_at(contact.stuck_approach(), uniform));
            wrong += misjudged(&setting, solution, &solution.ends[phase], (0.0, stuck));
        }
        let limit = FRICTION * normal;
        let tolerance = 0.005 * limit;
        let why = "0.5 % of f P: mesh";
        let mut rows = vec![
            Row::relative("N_z, N/m", [solution.end_of(0).normal_force, normal], 0.01, "1 %: mesh, nu near 1/2"),
            Row::new("Q_x at the first turn, N/m", turns[0], tolerance, why),
            Row::new("Q_x at the second turn, N/m", turns[1], tolerance, why),
            Row::new("Q_x at the third turn, N/m", turns[2], tolerance, why),
            Row::new("Q_x where it differs most, N/m", worst, tolerance, why),
        ];
        if law.is_exact() {
            let what = "nodes that do not stick or slip as they should";
            rows.push(Row::new(what, [wrong, 0.0], 0.0, NODE_BY_NODE));
        }
        Ok(rows)
    };
    Case { name, source: "Jager 1993, Ciavarella 1998", subjects, compare: Box::new(compare) }
}

/// A flat punch, pushed a third of the way to where it slides, and beyond: until Q = f N all of it sticks, and its push adds q = (Q/N) p;
/// then all of it slips. How wide it is beyond its outermost nodes, by some part of a spacing, is taken from N.
///
/// Next to incompressible, the edges of a punch leave a checkerboard in the elements' tractions, the same in pressing and
/// pushing, which the mean over neighbours takes out; friction is high, so that none of it slips.
fn punch(n: usize) -> Case {
    const FRICTION: f64 = 0.5;
    let (approach, nodes) = (1e-4, n / 8 + 1);
    let half_width = 0.5 * nodes as f64 / n as f64;
    let phases = vec![Phase::press(1.0, 1, approach)];
    let mut setting = nearly_incompressible(n, Indenter::Punch(half_width), Law::exact(), phases);
    setting.friction = Some(Friction::constant(Law::exact(), FRICTION));
    let (exact, uniform, excess) = closed_form(&setting);
    let normal_at = move |half_width: f64| approach / (uniform + exact.indentation_of_punch(half_width, 1.0));
    let slides = FRICTION * (approach + excess * normal_at(half_width));
    setting.phases.extend([sway(slides / 3.0, 5, approach), sway(slides, 5, approach)]);
    let subjects = vec![setting.clone().into()];
    let compare = move |solutions: &[Solution]| {
        let solution = &solutions[0];
        let [pressed, pushed, slid] = [0, 1, 2].map(|phase| solution.end_of(phase));
        let normal = pressed.normal_force;
        let edge = 0.5 * setting.spacing();
        let wider = normal_at(half_width + edge) - normal_at(half_width);
        let pushed_by = pushed.sliding / (approach / normal + excess);
        let [first, end, beyond] = [0, 1, 2].map(|phase| &solution.ends[phase]);
        let added: Vec<f64> = end.shear.iter().zip(&first.shear).map(|(q, before)| q - before).collect();
        let ratio = pushed.tangential_force / pushed.normal_force;
        let smooth = |field: &[f64], i: usize| 0.25 * (field[i - 1] + 2.0 * field[i] + field[i + 1]);
        let inner = (n / 2 - 2 * nodes / 5)..=(n / 2 + 2 * nodes / 5);
        let apart = |i: usize| smooth(&added, i) / (ratio * smooth(&end.pressure, i)) - 1.0;
        let uneven = inner.map(|i| apart(i).abs()).fold(0.0, f64::max);
        let touching = end.pressure.iter().filter(|p| **p > 0.0).count();
        let all = |end: &InterfaceFrame, stick: f64| misjudged(&setting, solution, end, (0.5, stick));
        Ok(vec![
            Row::new("N_z, N/m", [normal, normal_at(half_width)], wider, "half a spacing beyond each edge"),
            Row::new("nodes in contact", [touching as f64, nodes as f64], 0.0, "those under the punch"),
            Row::resolved(
                "Q_x a third of the way, N/m",
                [pushed.tangential_force, pushed_by],
                resolution(2.0 * edge, 2.0 * half_width),
            ),
            Row::new(
                "largest error of q/p, |x| < 0.8 a, of Q_x/N_z",
                [uneven, 0.0],
                2.0 * edge / half_width,
                "edges: h/a",
            ),
            Row::new("nodes that slip there", [all(end, half_width), 0.0], 0.0, "all but the outermost"),
            Row::new("nodes that stick beyond", [all(beyond, -0.5), 0.0], 0.0, "all slip"),
            Row::relative("Q_x beyond, N/m", [slid.tangential_force, FRICTION * slid.normal_force], 1e-12, "solver"),
        ])
    };
    Case {
        name: format!("flat punch, Coulomb's law itself, nu = {POISSON}, {n} cells"),
        source: "Sadowsky; Johnson, Contact Mechanics, 2.8, 7.2",
        subjects,
        compare: Box::new(compare),
    }
}

/// Pressed, swayed until part of it slips, and held for long: on an elastic body, coupled here, nothing moves any more.
fn held(n: usize) -> Case {
    let approach = 2.5e-4;
    let hold = Phase { duration: 1e4, ..sway(0.0, 20, approach) };
    let phases = vec![Phase::press(1.0, 5, approach), sway(1.2e-5, 5, approach), hold];
    let setting = Setting {
        friction: Some(Friction::constant(Law::exact(), FRICTION)),
        penalty: None,
        ..Setting::new(n, elastic(300.0, 0.3), phases)
    };
    let subjects = vec![setting.into()];
    let compare = move |solutions: &[Solution]| {
        let solution = &solutions[0];
        let before = solution.end_of(1);
        let hold = || solution.history.iter().filter(|row| row.phase == 2);
        let most = |of: &dyn Fn(&HistoryRow) -> f64| hold().map(of).fold(0.0, f64::max);
        let sticks = |end: &InterfaceFrame| -> Vec<bool> {
            end.pressure.iter().zip(&end.shear).map(|(p, q)| q.abs() < FRICTION * p * (1.0 - 1e-9)).collect()
        };
        let [begun, ended] = [&solution.ends[1], &solution.ends[2]].map(sticks);
        let changed = begun.iter().zip(&ended).filter(|(a, b)| a != b).count();
        Ok(vec![
            Row::new("part of the contact that sticks", [before.stick_fraction, 0.5], 0.3, "partial slip"),
            Row::new("largest slip of a sticking point, m", [most(&|row| row.stuck_slip), 0.0], 0.0, NONE),
            Row::new(
                "largest change of Q_x, of Q_x",
                [most(&|row| (row.tangential_force / before.tangential_force - 1.0).abs()), 0.0],
                1e-10,
                "solver",
            ),
            Row::new(
                "change of the part that sticks",
                [most(&|row| (row.stick_fraction - before.stick_fraction).abs()), 0.0],
                0.0,
                NONE,
            ),
            Row::new("nodes that come into the stick zone or leave it", [changed as f64, 0.0], 0.0, NONE),
        ])
    };
    Case {
        name: format!("a held indenter, Coulomb's law itself, {n} x {n}"),
        source: "an elastic body in equilibrium",
        subjects,
        compare: Box::new(compare),
    }
}
