//! Archard's law: a conforming contact, a held approach, and a wave in full contact that wears off itself.

use std::f64::consts::TAU;

use super::setting::{Indenter, Phase, Setting, elastic};
use super::{Case, Row};
use crate::scene::{Friction, Law, Wear, WearLaw, Wearing};
use crate::solution::Solution;

/// N/m; 1/Pa; m/s.
const FORCE: f64 = 0.5;
const COEFFICIENT: f64 = 2e-4;
const VELOCITY: f64 = 0.1;

pub fn cases(quick: bool) -> Vec<Case> {
    let n = if quick { 64 } else { 128 };
    vec![conforming(), held_approach(), wave(n, 0.0), wave(n, 0.3)]
}

fn archard(of: Wearing) -> Wear {
    Wear { of, law: WearLaw::Archard, coefficient: COEFFICIENT }
}

/// A flat indenter on the layer of the paper, elastic, without penetration.
fn flat(of: Wearing, phases: Vec<Phase>) -> Setting {
    // A wave of a nanometre's millionth is flat.
    let indenter = Indenter::Wave(1e-15);
    Setting { indenter, penalty: None, wear: Some(archard(of)), ..Setting::new(4, elastic(568.498, 0.3), phases) }
}

/// k N V t/L
fn conforming() -> Case {
    let time = 20.0;
    let slide = Phase { velocity: VELOCITY, ..Phase::load(time, 20, FORCE) };
    let subjects =
        [Wearing::Body, Wearing::Indenter].map(|of| flat(of, vec![Phase::load(1.0, 1, FORCE), slide]).into());
    let compare = move |solutions: &[Solution]| {
        let exact = COEFFICIENT * FORCE * VELOCITY * time;
        let row = |(solution, of): (&Solution, &str)| {
            let depth = solution.ends[1].worn_depth.iter().copied().fold(0.0, f64::max);
            [(depth, "depth, m"), (solution.last().worn_volume, "volume, m^2")].map(|(found, what)| {
                Row::relative(format!("{of}: {what}"), [found, exact], 1e-8, "the solver's tolerance")
            })
        };
        Ok(solutions.iter().zip(["body", "indenter"]).flat_map(row).collect())
    };
    Case {
        name: "wear of a conforming contact".into(),
        source: "k N V t/L",
        subjects: subjects.into(),
        compare: Box::new(compare),
    }
}

/// N = N_0 exp(-k V t/C_0), of first order in the step.
fn held_approach() -> Case {
    let (approach, time) = (1e-3, 25.0);
    let layer = |steps| {
        let slide = Phase::slide(VELOCITY, VELOCITY * time, steps, approach);
        flat(Wearing::Body, vec![Phase::press(1.0, 1, approach), slide])
    };
    let setting = layer(50);
    let subjects = vec![setting.clone().into(), layer(100).into()];
    let compare = move |solutions: &[Solution]| {
        let rate = COEFFICIENT * VELOCITY / setting.layer().compliance(0.0, setting.moduli()).zz.re;
        let exact = (-rate * time).exp();
        let [coarse, fine] =
            [0, 1].map(|i: usize| solutions[i].last().normal_force / solutions[i].end_of(0).normal_force);
        // (1 + x/n)^-n is off by x^2/(2 n) and less.
        let error = (rate * time).powi(2) / 200.0;
        Ok(vec![
            Row::relative("N/N_0 after 25 s in 100 steps", [fine, exact], error, "backward Euler: (k V t/C)^2/(2 n)"),
            Row::new(
                "order in the step",
                [((coarse - exact) / (fine - exact)).log2(), 1.0],
                0.05,
                "not yet asymptotic",
            ),
        ])
    };
    Case {
        name: "wear under a held approach".into(),
        source: "N_0 exp(-k V t/C)",
        subjects,
        compare: Box::new(compare),
    }
}

/// The profile's wave decays with exp(-k V S t), by the real part of S = 1/(C_zz - i f C_xz).
fn wave(n: usize, friction: f64) -> Case {
    // So low that its slopes make nothing of the slip.
    let (height, time, steps) = (5e-7, 10.0, 32);
    let layer = |n: usize, steps: usize| {
        // By whole cells in a step.
        let velocity = 2.0 / time;
        let slide = Phase { velocity, ..Phase::load(time, steps, 0.006) };
        let law = (friction > 0.0).then(|| Friction::constant(Law::exact(), friction));
        Setting {
            indenter: Indenter::Wave(height),
            penalty: None,
            friction: law,
            wear: Some(archard(Wearing::Indenter)),
            ..Setting::new(n, elastic(568.498, 0.3), vec![Phase::load(1.0, 1, 0.006), slide])
        }
    };
    let setting = layer(n, steps);
    let subjects =
        vec![setting.clone().into(), setting.halved().into(), layer(n, 2 * steps).into(), layer(n, 4 * steps).into()];
    let compare = move |solutions: &[Solution]| {
        let stiffness = 1.0 / setting.layer().compliance(TAU, setting.moduli()).sliding(friction);
        let rate = stiffness * COEFFICIENT * setting.phases[1].velocity;
        let euler = (1.0 + rate * time / steps as f64).norm().powi(-(steps as i32));
        let left: Vec<f64> =
            solutions.iter().map(|solution| first_wave(&solution.ends[1].worn_profile) / height).collect();
        let error = 1.1 * (rate * time).norm_sqr() / (2.0 * 128.0);
        let order = ((left[0] - left[2]) / (left[2] - left[3])).log2();
        Ok(vec![
            Row::refined(format!("amplitude after {steps} steps over that before"), [left[0], left[1]], euler),
            Row::relative(
                "the same in 128 steps",
                [left[3], (-rate.re * time).exp()],
                error,
                "backward Euler: x^2/(2 n), x = k V S t; mesh",
            ),
            Row::new("order in the step", [order, 1.0], 0.1, "not yet asymptotic"),
        ])
    };
    Case {
        name: format!("wear of a wave in full contact, f = {friction}, {n} nodes"),
        source: "exp(-k V Re(S) t), S = 1/(C_zz - i f C_xz)",
        subjects,
        compare: Box::new(compare),
    }
}

/// The amplitude of the first wave of a field.
fn first_wave(field: &[f64]) -> f64 {
    let part = |of: fn(f64) -> f64| {
        let terms = field.iter().enumerate().map(|(i, value)| value * of(TAU * i as f64 / field.len() as f64));
        2.0 * terms.sum::<f64>() / field.len() as f64
    };
    part(f64::cos).hypot(part(f64::sin))
}
