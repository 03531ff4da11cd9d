//! Steady sliding without steps (`mpjr steady`) beside the solution in Fourier space: what the cells alone make of it.

use std::path::Path;

use mpi::topology::SimpleCommunicator;
use nalgebra::Vector2;

use super::setting::{Phase, Setting, one_arm};
use super::{Case, Row};
use crate::composition;
use crate::error::Result;
use crate::oracle::PoissonRule::{self, ConstantBulkModulus, ConstantRatio};
use crate::oracle::steady::Load;
use crate::scene::{Friction, Indenter, Law};
use crate::steady::State;

const CELLS: usize = 128;
/// N/m
const FORCE: f64 = 0.5;
/// Of the reference: on as many the hysteretic force is within 1e-3 of that on twice as many.
const NODES: usize = 1024;
const REASON: &str = "mesh: 128 cells, 4 times as fine at the face";

pub fn cases(quick: bool) -> Vec<Case> {
    let velocities = if quick { vec![0.1] } else { vec![1e-9, 2.154e-2, 0.1, 1.0, 1e9] };
    vec![
        case("held approach", ConstantRatio, Phase::slide(1.0, 1.0, 1, 1e-3), velocities.clone()),
        case("held approach", ConstantBulkModulus, Phase::slide(1.0, 1.0, 1, 1e-3), velocities.clone()),
        case("held load", ConstantRatio, Phase { velocity: 1.0, ..Phase::load(1.0, 1, FORCE) }, velocities),
    ]
}

/// Places of the crest between two nodes. The hysteretic force is what the two flanks leave of each other, and at 1 m/s next to nothing: there
/// it is by half of a hundredth another wherever the ends of the contact fall between nodes.
const PLACES: u32 = 4;

/// Steady states at velocities, the means over the places of the crest.
fn placed(setting: &Setting, velocities: &[f64]) -> Result<Vec<[f64; 3]>> {
    let mut means = vec![[0.0; 3]; velocities.len()];
    for place in 0..PLACES {
        let mut scene = setting.scene()?;
        let x = f64::from(place) / f64::from(PLACES) * setting.spacing();
        let amplitude = setting.wave().amplitude;
        scene.indenter = Indenter::Expression { formula: format!("{amplitude:?}*(1-cos(2*pi*(x-{x:?})))") };
        let alone = SimpleCommunicator::self_comm();
        let mut sliding = composition::steady(&alone, &scene, Path::new("verify"), Vector2::x())?;
        for (mean, state) in means.iter_mut().zip(sliding.states(velocities)?) {
            let State { approach, normal_force, hysteretic_force, .. } = state;
            let values = [approach, normal_force, hysteretic_force];
            mean.iter_mut().zip(values).for_each(|(mean, value)| *mean += value / f64::from(PLACES));
        }
    }
    Ok(means)
}

/// Velocities from rest to the glassy end, none of which has a transient to wait for.
fn case(held: &str, rule: PoissonRule, phase: Phase, velocities: Vec<f64>) -> Case {
    let load = phase.force.map_or(Load::Approach(phase.approach), Load::MeanPressure);
    let setting = Setting {
        grading: 4.0,
        penalty: None,
        friction: Some(Friction::constant(Law::exact(), 0.2)),
        ..Setting::new(CELLS, one_arm(0.3, rule), vec![phase])
    };
    let compare = move |_: &[_]| {
        let mut rows = Vec::new();
        for (velocity, [approach, normal, hysteretic]) in velocities.iter().zip(placed(&setting, &velocities)?) {
            let wave = setting.wave();
            let exact = setting.steady(*velocity).solve(NODES, |x| wave.at(x), load)?;
            let at = |what: &str| format!("{what} at v = {velocity} m/s");
            let ratios = [hysteretic / normal, exact.hysteretic / exact.normal];
            let given = match load {
                Load::Approach(_) => Row::relative(at("N, N/m,"), [normal, exact.normal], 2e-4, REASON),
                Load::MeanPressure(_) => Row::relative(at("D, m,"), [approach, exact.approach], 2e-4, REASON),
            };
            rows.extend([
                given,
                Row::relative(at("  hysteretic force/N, 1e-4,"), ratios.map(|ratio| 1e4 * ratio), 4e-3, REASON),
            ]);
        }
        Ok(rows)
    };
    let rule = if rule == ConstantRatio { "constant ratio" } else { "constant bulk modulus" };
    Case {
        name: format!("mpjr steady under a {held}, {rule}, {CELLS} x {CELLS}"),
        source: "complementarity in Fourier space, 1024 nodes",
        subjects: Vec::new(),
        compare: Box::new(compare),
    }
}
