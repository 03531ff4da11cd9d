//! Held by springs: in series with a layer, and stick-slip without a mass.

use super::setting::{Indenter, Phase, Setting, elastic};
use super::{Case, Row};
use crate::scene::{Coefficient, Friction, Law};
use crate::solution::Solution;

/// Pa
const SHEAR: f64 = 568.498;
/// N/m
const FORCE: f64 = 0.5;
/// f = f_d + (f_s - f_d) exp(-w/v_s) + eta w
const STATIC: f64 = 0.6;
const DYNAMIC: f64 = 0.2;
/// m/s, s/m
const FALL: f64 = 0.01;
const RISE: f64 = 2.0;
/// N/m per m, m/s
const SPRING: f64 = 5.0;
const PULLED: f64 = 0.005;

pub fn cases(quick: bool) -> Vec<Case> {
    let mut list = vec![in_series()];
    if !quick {
        list.push(stick_slip());
    }
    list
}

/// An elastic layer under a flat indenter.
fn flat(mount: &'static str, phases: Vec<Phase>) -> Setting {
    // A wave of a nanometre's millionth is flat.
    let layer = Setting::new(4, elastic(SHEAR, 0.3), phases);
    Setting { indenter: Indenter::Wave(1e-15), penalty: None, mount: Some(mount), ..layer }
}

/// A spring of k in series with a layer of C_0: N = (k D + L)/(1 + k C_0) under a dead load L.
fn in_series() -> Case {
    let setting = flat("normal = { stiffness = 800.0, load = 0.1 }", vec![Phase::press(1.0, 4, 1e-3)]);
    let subjects = vec![setting.clone().into()];
    let compare = move |solutions: &[Solution]| {
        let compliance = setting.layer().compliance(0.0, setting.moduli()).zz.re;
        let exact = (800.0 * 1e-3 + 0.1) / (1.0 + 800.0 * compliance);
        let row = solutions[0].last();
        Ok(vec![
            Row::relative("N, N/m", [row.normal_force, exact], 1e-8, "the solver's tolerance"),
            Row::relative("D, m", [row.approach, exact * compliance], 1e-8, "the solver's tolerance"),
        ])
    };
    Case { name: "a spring in series with a layer".into(), source: "closed form", subjects, compare: Box::new(compare) }
}

/// F = N f(w) of a slider without mass, pulled by a spring: up at k V in stick, 1/k = 1/k_t + H/(G L), and down the rising branch of f in slip,
/// dF/dt = k (V - w), to where f is least.
fn stick_slip() -> Case {
    let (seconds, dt) = (25.0, 0.01);
    let pull = Phase { velocity: PULLED, ..Phase::load(seconds, (seconds / dt) as usize, FORCE) };
    let friction = Friction {
        coefficient: Coefficient::Formula(format!(
            "{DYNAMIC:?} + {:?}*exp(-v/{FALL:?}) + {RISE:?}*v",
            STATIC - DYNAMIC
        )),
        ..Friction::constant(Law::exact(), 0.0)
    };
    let setting = Setting {
        friction: Some(friction),
        ..flat("tangential = { stiffness = 5.0 }", vec![Phase::load(1e-3, 1, FORCE), pull])
    };
    let compare = move |solutions: &[Solution]| {
        let rows = &solutions[0].history;
        let force = |i: usize| rows[i].tangential_force;
        let peaks: Vec<usize> = (1..rows.len() - 1)
            .filter(|&i| force(i) > force(i - 1) && force(i) > force(i + 1) && force(i) > 0.5 * FORCE * STATIC)
            .collect();
        let [first, last] = [peaks.first(), peaks.last()].map(|peak| peak.copied().unwrap_or(0));
        let period = (rows[last].time - rows[first].time) / (peaks.len().max(2) - 1) as f64;
        let least = (first..rows.len()).map(force).fold(f64::INFINITY, f64::min);
        let stiffness = 1.0 / (1.0 / SPRING + 1.0 / SHEAR);
        let [low, slip, slowest] = slipped(stiffness);
        let exact = (FORCE * STATIC - low) / (stiffness * PULLED) + slip;
        // In a step the spring is drawn by so much, and gives by so much where slip ends.
        let step = stiffness * PULLED * dt;
        let caught = stiffness * (slowest - PULLED) * dt;
        Ok(vec![
            Row::new("F at the last peak, N/m", [force(last), FORCE * STATIC], step, "one step of 0.01 s"),
            Row::new("least F after the first, N/m", [least, low], caught, "one step of the slowest slip"),
            Row::new("period, s", [period, exact], 5.0 * dt, "five steps of 0.01 s"),
        ])
    };
    Case {
        name: "stick-slip of a slider without mass".into(),
        source: "closed form, quadrature",
        subjects: vec![setting.into()],
        compare: Box::new(compare),
    }
}

/// The least force of the slip, N/m, how long it takes from its beginning on the rising branch at the force of stick, s, and the rate of slip at
/// its end, m/s.
fn slipped(stiffness: f64) -> [f64; 3] {
    const PIECES: u32 = 20_000;
    let f = |w: f64| DYNAMIC + (STATIC - DYNAMIC) * (-w / FALL).exp() + RISE * w;
    let slope = |w: f64| RISE - (STATIC - DYNAMIC) / FALL * (-w / FALL).exp();
    let end = FALL * ((STATIC - DYNAMIC) / (RISE * FALL)).ln();
    // f_s again, by bisection beyond the least.
    let (mut from, mut to) = (end, STATIC / RISE);
    for _ in 0..200 {
        let middle = 0.5 * (from + to);
        if f(middle) < STATIC { from = middle } else { to = middle }
    }
    let width = (from - end) / f64::from(PIECES);
    let time = (0..PIECES).map(|i| end + (f64::from(i) + 0.5) * width);
    let time: f64 = time.map(|w| FORCE * slope(w) / (stiffness * (w - PULLED)) * width).sum();
    [FORCE * f(end), time, end]
}
