//! Held by a force: creep, Westergaard and Hertz under load, Lee and Radok; and friction that depends on the pressure, in full
//! slip under a known load.

use std::collections::BTreeMap;

use super::half_space::{deep, modulus};
use super::setting::{Indenter, Phase, Setting, elastic, one_arm};
use super::{Case, Row, resolution};
use crate::error::Result;
use crate::oracle::PoissonRule;
use crate::oracle::line_contact::Westergaard;
use crate::oracle::prony::Relaxing;
use crate::oracle::transient::Update;
use crate::scene::{Coefficient, Friction, Law};
use crate::solution::Solution;

/// N/m
const FORCE: f64 = 0.5;
/// How long it is held, s.
const HELD: f64 = 5.0;
/// How soon it is there, s.
const JUMP: f64 = 1e-9;

pub fn cases(quick: bool) -> Vec<Case> {
    let n = if quick { 128 } else { 256 };
    vec![
        creep(Update::Exponential, 3.6e-5),
        creep(Update::BackwardEuler, 3.1e-3),
        lee_radok(n),
        hertz(2 * n),
        full_slip(n, "0.3*(max(p, 1e-9)/0.1)^-0.25", None, |p| 0.3 * p * (p.max(1e-9) / 0.1).powf(-0.25)),
        full_slip(n, "0.3", Some(0.02), |p| (0.3 * p).min(0.02)),
    ]
}

/// A jump to a force and its hold.
fn held(steps: usize) -> Vec<Phase> {
    vec![Phase::load(JUMP, 1, FORCE), Phase::load(HELD, steps, FORCE)]
}

/// J(t) over J(0).
fn softening(setting: &Setting, t: f64) -> Result<f64> {
    let modulus = Relaxing::from(&setting.solid);
    Ok(modulus.creep()?.at(t) * modulus.instantaneous)
}

/// A layer under a flat indenter creeps with J(t): D = N (C_0 J(t)/J(0) + 1/alpha). `error` is what steps of a tenth of a
/// second make of it, of first or second order.
fn creep(update: Update, error: f64) -> Case {
    let solid = one_arm(0.3, PoissonRule::ConstantRatio);
    // A wave of a nanometre's millionth is flat.
    let layer = |steps| Setting {
        indenter: Indenter::Wave(1e-15),
        penalty: Some(1e6),
        update,
        ..Setting::new(4, solid.clone(), held(steps))
    };
    let setting = layer(50);
    let subjects = vec![setting.clone().into(), layer(100).into()];
    let (memory, order) = match update {
        Update::Exponential => ("exponential", 2.0),
        Update::BackwardEuler => ("backward Euler", 1.0),
    };
    let compare = move |solutions: &[Solution]| {
        let uniform = setting.layer().compliance(0.0, setting.moduli()).zz.re;
        let exact = |softening: f64| FORCE * (uniform * softening + setting.softness());
        let [first, last] = [exact(1.0), exact(softening(&setting, HELD)?)];
        let end = |i: usize| solutions[i].last().approach;
        let found = ((end(0) - last) / (end(1) - last)).abs().log2();
        Ok(vec![
            Row::relative("D at once, m", [solutions[0].end_of(0).approach, first], 1e-8, "the jump in 1e-9 s"),
            Row::relative("D after 5 s in 50 steps, m", [end(0), last], 1.05 * error, "steps of a tenth of a second"),
            Row::new("order in the step", [found, order], 0.1, "not yet asymptotic"),
        ])
    };
    Case {
        name: format!("creep under a step of load, {memory}"),
        source: "closed form: creep of a Prony solid",
        subjects,
        compare: Box::new(compare),
    }
}

/// A wave under a held load while its contact grows: Westergaard's contact with the modulus of Lee and Radok (1960), which is exact
/// as long as the contact grows; sin^2(pi a/L) = N j(t)/(L p*), D = C_0 N j + the summit's indentation.
fn lee_radok(n: usize) -> Case {
    let solid = one_arm(0.3, PoissonRule::ConstantRatio);
    let setting = Setting { penalty: None, ..Setting::new(n, solid, held(100)) };
    let subjects = vec![setting.clone().into()];
    let compare = move |solutions: &[Solution]| {
        let solution = &solutions[0];
        let wave = setting.wave();
        let uniform = setting.layer().compliance(0.0, setting.moduli()).zz.re;
        let mut rows = Vec::new();
        for (row, t, when) in [(solution.end_of(0), 0.0, "at once"), (solution.last(), HELD, "after 5 s")] {
            let j = softening(&setting, t)?;
            let exact = Westergaard { modulus: modulus(&setting), amplitude: wave.amplitude, wavelength: 1.0 };
            let (mean, a) = (FORCE * j, exact.half_width(FORCE * j));
            let approach = uniform * mean + exact.indentation(mean);
            let h = setting.spacing();
            // The layer is a wavelength deep: e^(-2kH) = 3e-6 of what the wave adds, times (kH)^2; 1e-4 of the whole.
            let tolerance = 1e-4 + resolution(h, 2.0 * a);
            rows.push(Row::relative(
                format!("D {when}, m"),
                [row.approach, approach],
                tolerance,
                "mesh; depth of the layer",
            ));
            let width = [row.contact_fraction, 2.0 * a];
            rows.push(Row::new(format!("contact width {when}, m"), width, 2.0 * h, "one node at each edge"));
        }
        Ok(rows)
    };
    Case {
        name: format!("Lee-Radok: a wave under a held load, {n} nodes"),
        source: "closed form",
        subjects,
        compare: Box::new(compare),
    }
}

/// A parabola under a force, on a deep layer.
fn hertz(n: usize) -> Case {
    let force = 0.05;
    let setting = deep(n, 0.3, Indenter::Parabola(10.0), vec![Phase::load(1.0, 2, force)]);
    let subjects = vec![setting.clone().into()];
    let compare = move |solutions: &[Solution]| {
        let (solution, end) = (&solutions[0], &solutions[0].ends[0]);
        let exact = super::half_space::hertz_among_images(&setting, force);
        let (a, h) = (exact.half_width(), setting.spacing());
        let peak = end.pressure.iter().copied().fold(0.0, f64::max);
        Ok(vec![
            Row::relative("N, N/m", [solution.last().normal_force, force], 1e-8, "the solver's tolerance"),
            Row::new("contact width, m", [solution.last().contact_fraction, 2.0 * a], 2.0 * h, "one node at each edge"),
            Row::resolved("peak pressure, Pa", [peak, exact.peak()], resolution(h, 2.0 * a)),
        ])
    };
    Case { name: format!("Hertz under load, {n} nodes"), source: "closed form", subjects, compare: Box::new(compare) }
}

/// A wave on a nearly incompressible deep layer under 0.05 N/m, in full slip: q is what its law makes of Westergaard's pressure.
fn full_slip(n: usize, coefficient: &str, shear_limit: Option<f64>, law: fn(f64) -> f64) -> Case {
    let (force, cells) = (0.05, 12.0 * (n as f64 / 256.0));
    // By whole cells.
    let distance = cells / n as f64;
    let slide = Phase { velocity: distance, ..Phase::load(1.0, 4, force) };
    let setting = Setting {
        depth: 2.0,
        cells: [n, n / 2],
        grading: 8.0,
        mean_dilatation: true,
        penalty: None,
        friction: Some(Friction {
            law: Law::exact(),
            coefficient: Coefficient::Formula(coefficient.to_owned()),
            shear_limit,
            tables: BTreeMap::new(),
            checksums: Vec::new(),
        }),
        ..Setting::new(n, elastic(568.498, 0.4999), vec![Phase::load(1.0, 2, force), slide])
    };
    let subjects = vec![setting.clone().into()];
    let compare = move |solutions: &[Solution]| {
        let exact = Westergaard { modulus: modulus(&setting), amplitude: setting.wave().amplitude, wavelength: 1.0 };
        let (a, h) = (exact.half_width(force), setting.spacing());
        let shear = force_of(|x| law(exact.pressure(force, x)), a);
        let edges = 2.0 * law(exact.pressure(force, a - h)) * h;
        let row = solutions[0].last();
        let tolerance = edges + resolution(h, 2.0 * a) * shear;
        Ok(vec![
            Row::new("Q, N/m", [row.tangential_force, shear], tolerance, "one node at each edge; mesh"),
            Row::new("share that sticks", [row.stick_fraction, 0.0], 0.0, "none"),
        ])
    };
    let limit = shear_limit.map_or(String::new(), |limit| format!(", at most {limit} Pa"));
    Case {
        name: format!("full slip, f = {coefficient}{limit}"),
        source: "Westergaard's pressure, quadrature",
        subjects,
        compare: Box::new(compare),
    }
}

/// The integral of a traction over |x| < a, which may begin like a root at either end.
fn force_of(traction: impl Fn(f64) -> f64, a: f64) -> f64 {
    const PIECES: u32 = 20_000;
    let step = std::f64::consts::PI / f64::from(PIECES);
    let angle = |i: u32| step * (f64::from(i) + 0.5);
    (0..PIECES).map(|i| traction(-a * angle(i).cos()) * a * angle(i).sin() * step).sum()
}
