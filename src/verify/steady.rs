//! Steady sliding over one relaxing arm: hysteretic friction in full contact, and partial contact beside a solution in
//! Fourier space.

use std::f64::consts::TAU;

use super::setting::{Phase, Setting, elastic, one_arm, tanh};
use super::{Case, Row, resolution};
use crate::energy::Energy;
use crate::oracle::PoissonRule;
use crate::oracle::steady::{Load, Steady};
use crate::output::HistoryRow;
use crate::scene::{Friction, Law};
use crate::solution::Solution;

/// Tens of the relaxation time of 0.817 s.
const SETTLED: f64 = 16.0;
/// Twice the amplitude of the wave, m.
const APPROACH: f64 = 1e-3;

pub fn cases(quick: bool) -> Vec<Case> {
    use PoissonRule::{ConstantBulkModulus, ConstantRatio};
    let mut list = vec![full_contact(if quick { 64 } else { 128 }, ConstantRatio)];
    let exact_laws = if quick { vec![0.0, 0.1] } else { vec![0.0, 2.154e-2, 0.1, 1.0, f64::INFINITY] };
    list.extend(exact_laws.into_iter().map(|velocity| without_penetration(128, velocity)));
    list.push(dissipation(64, ConstantRatio));
    if quick {
        list.push(partial_contact(64, 0.1, ConstantRatio));
        return list;
    }
    list.push(full_contact(32, ConstantBulkModulus));
    list.push(dissipation(32, ConstantBulkModulus));
    for (n, velocity) in [(128, 1e-3), (128, 2.154e-2), (128, 0.1), (128, 1.0), (32, 10.0)] {
        list.push(partial_contact(n, velocity, ConstantRatio));
    }
    list.push(partial_contact(32, 0.1, ConstantBulkModulus));
    list
}

/// Pressed slowly, then slid for long, by one spacing of nodes a step: the nodes meet the profile at the same points
/// at every step.
fn slid(n: usize, velocity: f64, rule: PoissonRule, approach: f64) -> Setting {
    // A quarter of a wave at least: the contact must have left where it was pressed.
    let distance = (velocity * SETTLED).max(0.25);
    let steps = (distance * n as f64).ceil();
    let slide = Phase::slide(velocity, steps / n as f64, steps as usize, approach);
    let phases = vec![Phase::press(10.0, 20, approach), slide];
    Setting { friction: Some(tanh(0.2, 0.01 * velocity)), ..Setting::new(n, one_arm(0.3, rule), phases) }
}

/// Full contact is exact: |integral of p h'| = (1/2) wavelength k g0^2 |Im 1/(C_zz - i f C_xz)|, C at G*(k v). Mesh and
/// steps are halved together, and both errors are of second order.
fn full_contact(n: usize, rule: PoissonRule) -> Case {
    let (velocity, approach) = (0.1, 8e-3);
    let settings = [slid(n, velocity, rule, approach), slid(n / 2, velocity, rule, approach)];
    let setting = settings[0].clone();
    let compare = move |solutions: &[Solution]| {
        let exact = setting.steady(velocity).full_contact(setting.wave(), Load::Approach(approach))?;
        let [fine, coarse] = [0, 1].map(|i: usize| solutions[i].last());
        let hysteretic = [fine.hysteretic_force, coarse.hysteretic_force];
        Ok(vec![
            Row::new("contact fraction", [fine.contact_fraction, 1.0], 0.0, "full contact is what the formula is for"),
            Row::relative("N_z, N/m", [fine.normal_force, exact.normal], 1e-6, "settling: 16 s; solver"),
            Row::relative("Q_x, N/m", [fine.tangential_force, exact.tangential], 1e-6, "settling: 16 s; solver"),
            Row::refined("hysteretic force, N/m", hysteretic, exact.hysteretic),
            Row::order("  its order of convergence", hysteretic, exact.hysteretic),
        ])
    };
    Case {
        name: format!("hysteresis in full contact, v = {velocity} m/s, {}", said(rule)),
        source: "full contact of a wave, in closed form",
        subjects: settings.map(Into::into).into(),
        compare: Box::new(compare),
    }
}

/// The energy of steady sliding without friction, in full contact: over a period of the wave the indenter supplies, and the
/// arms dissipate, the hysteretic force times its length, and nothing else of the ledger changes. Mesh and steps are halved
/// together.
fn dissipation(n: usize, rule: PoissonRule) -> Case {
    let (velocity, approach) = (0.1, 8e-3);
    // A period more, which is the one that is looked at.
    let settings = [n, n / 2].map(|n| {
        let mut setting = Setting { friction: None, ..slid(n, velocity, rule, approach) };
        let slide = &mut setting.phases[1];
        (slide.duration, slide.steps) = (slide.duration + setting.width / velocity, slide.steps + n);
        setting
    });
    let setting = settings[0].clone();
    let compare = move |solutions: &[Solution]| {
        let exact = setting.steady(velocity).full_contact(setting.wave(), Load::Approach(approach))?;
        let lost = exact.hysteretic * setting.width;
        // A step is a spacing of nodes, so that a period takes as many steps as there are cells along the face.
        let over_a_period = |energy: fn(&Energy) -> f64| {
            [(&solutions[0], n), (&solutions[1], n / 2)].map(|(solution, steps)| {
                let history = &solution.history;
                energy(&history[history.len() - 1].energy) - energy(&history[history.len() - 1 - steps].energy)
            })
        };
        let arms = over_a_period(|energy| energy.viscoelastic_dissipation);
        let work = over_a_period(|energy| energy.external_work);
        let [kept, _] = over_a_period(|energy| energy.stored + energy.penalty);
        let [fine, coarse] = [0, 1].map(|i: usize| {
            let Energy { imbalance, external_work, .. } = solutions[i].last().energy;
            imbalance / external_work
        });
        Ok(vec![
            Row::refined("work of the indenter over a period, J/m", work, lost),
            Row::refined("dissipated in the arms over a period, J/m", arms, lost),
            Row::order("  its order of convergence", arms, lost),
            Row::new("stored over a period, J/m", [kept, 0.0], 1e-6 * lost, "settling: 16 s; solver"),
            Row::new(
                "imbalance at the end, of the work",
                [fine, 0.0],
                2.0 * (fine - coarse).abs(),
                "nodes touch within steps: twice a first-order error",
            ),
        ])
    };
    Case {
        name: format!("energy of sliding in full contact, v = {velocity} m/s, {}", said(rule)),
        source: "full contact of a wave, in closed form",
        subjects: settings.map(Into::into).into(),
        compare: Box::new(compare),
    }
}

/// Partial contact against the complementarity problem in Fourier space on 512 nodes.
fn partial_contact(n: usize, velocity: f64, rule: PoissonRule) -> Case {
    let setting = slid(n, velocity, rule, APPROACH);
    let subjects = vec![setting.clone().into()];
    let compare = move |solutions: &[Solution]| {
        let wave = setting.wave();
        let exact = setting.steady(velocity).solve(512, |x| wave.at(x), Load::Approach(APPROACH))?;
        let row = solutions[0].last();
        let h = setting.spacing();
        let resolution = resolution(h, exact.contact_width);
        let ratio = |hysteretic: f64, normal: f64| 1e4 * hysteretic / normal;
        // Of the steepest slope in contact, all of which but little cancels between the two sides.
        let steepest = 1e4 * TAU * wave.amplitude * (0.5 * TAU * exact.contact_width).sin();
        let ratios = [ratio(row.hysteretic_force, row.normal_force), ratio(exact.hysteretic, exact.normal)];
        Ok(vec![
            Row::resolved("N_z, N/m", [row.normal_force, exact.normal], resolution),
            Row::resolved("Q_x, N/m", [row.tangential_force, exact.tangential], resolution),
            Row::new("contact fraction", [row.contact_fraction, exact.contact_width], 2.0 * h, "one node at each edge"),
            Row::new(
                "hysteretic force/N_z, 1e-4",
                ratios,
                resolution * steepest,
                "mesh, of the steepest slope in contact",
            ),
        ])
    };
    Case {
        name: format!("steady sliding, v = {velocity} m/s, {}, {n} x {n}", said(rule)),
        source: "complementarity in Fourier space, 512 nodes",
        subjects,
        compare: Box::new(compare),
    }
}

/// The same without penetration and with Coulomb's law itself: the rigid limit, in which no number is chosen but the mesh. The
/// means are taken over the steps that pass one spacing.
///
/// The hysteretic force is what the two sides of a summit leave of each other, a few parts in 10^4: tests/verification.rs has how
/// that comes with the mesh.
fn without_penetration(n: usize, velocity: f64) -> Case {
    let (setting, averaged) = rigidly(n, velocity);
    let subjects = vec![setting.clone().into()];
    let compare = move |solutions: &[Solution]| {
        let solid = one_arm(0.3, PoissonRule::ConstantRatio);
        let (wave, exact) = (setting.wave(), Setting { solid, ..setting.clone() }.steady(velocity));
        let Steady { normal, hysteretic, .. } = exact.solve(512, |x| wave.at(x), Load::Approach(APPROACH))?;
        let history = &solutions[0].history;
        let mean = |force: fn(&HistoryRow) -> f64| {
            history.iter().rev().take(averaged).map(force).sum::<f64>() / averaged as f64
        };
        let found = [mean(|row| row.normal_force), mean(|row| row.hysteretic_force)];
        let deepest = history.iter().map(|row| row.max_penetration).fold(0.0, f64::max);
        Ok(vec![
            Row::relative("N_z, N/m", [found[0], normal], 2e-4, CELLS_OF_128),
            Row::relative(
                "hysteretic force/N_z, 1e-4",
                [1e4 * found[1] / found[0], 1e4 * hysteretic / normal],
                2e-3,
                CELLS_OF_128,
            ),
            Row::new("penetration, m", [deepest, 0.0], 0.0, "none at all"),
        ])
    };
    Case {
        name: format!("steady sliding without penetration, v = {velocity} m/s, {n} x {n}"),
        source: "complementarity in Fourier space, 512 nodes",
        subjects,
        compare: Box::new(compare),
    }
}

const CELLS_OF_128: &str = "mesh: 128 cells, 4 times as fine at the face";

/// The setting, and over how many of its last steps the steady state is averaged. At no velocity the layer is the relaxed one.
///
/// At an infinite one, what moves with the indenter is not felt by the arms, only its mean is: so it jumps from step to
/// step by a share of the wave next to the golden section, which leaves no place out, at last in steps too short for anything to relax, as many as
/// there are nodes.
fn rigidly(n: usize, velocity: f64) -> (Setting, usize) {
    let rule = PoissonRule::ConstantRatio;
    let cell = 1.0 / n as f64;
    let mut setting = Setting {
        grading: 4.0,
        penalty: None,
        friction: Some(Friction::constant(Law::exact(), 0.2)),
        ..slid(n, if velocity.is_finite() && velocity > 0.0 { velocity } else { 1.0 }, rule, APPROACH)
    };
    let passed = |speed: f64, spacings: f64, steps: usize| Phase::slide(speed, spacings * cell, steps, APPROACH);
    if velocity == 0.0 {
        setting.solid = elastic(setting.solid.shear * setting.solid.long_term(), setting.solid.poisson);
        setting.phases[1] = passed(1.0, n as f64, n);
    } else if velocity.is_infinite() {
        // Odd, and so without a factor in common with a power of two.
        let jump = 2.0 * (0.309 * n as f64).floor() + 1.0;
        let phase = |dt: f64, steps: usize| passed(jump * cell / dt, jump * steps as f64, steps);
        setting.phases = vec![setting.phases[0], phase(1e-2, (SETTLED / 1e-2) as usize), phase(1e-6, n)];
        return (setting, n);
    }
    (setting, 1)
}

fn said(rule: PoissonRule) -> &'static str {
    match rule {
        PoissonRule::ConstantRatio => "constant ratio",
        PoissonRule::ConstantBulkModulus => "constant bulk modulus",
    }
}
