//! Steady sliding without steps (`mpjr steady`) beside the solution in Fourier space: what the cells alone make of it.

use std::path::Path;

use mpi::topology::SimpleCommunicator;
use nalgebra::Vector2;

use super::setting::{Phase, Setting, one_arm};
use super::{Case, Row};
use crate::composition;
use crate::oracle::PoissonRule::{self, ConstantBulkModulus, ConstantRatio};
use crate::oracle::steady::Load;
use crate::scene::{Friction, Law};

const CELLS: usize = 128;
/// N/m
const FORCE: f64 = 0.5;
const REASON: &str = "mesh: 128 cells, 4 times as fine at the face";

pub fn cases(quick: bool) -> Vec<Case> {
    let velocities = if quick { vec![0.1] } else { vec![1e-9, 2.154e-2, 0.1, 1.0, 1e9] };
    vec![
        case("held approach", ConstantRatio, Phase::slide(1.0, 1.0, 1, 1e-3), velocities.clone()),
        case("held approach", ConstantBulkModulus, Phase::slide(1.0, 1.0, 1, 1e-3), velocities.clone()),
        case("held load", ConstantRatio, Phase { velocity: 1.0, ..Phase::load(1.0, 1, FORCE) }, velocities),
    ]
}

/// Velocities from rest to the glassy end, none of which has a transient to wait for.
fn case(held: &str, rule: PoissonRule, phase: Phase, velocities: Vec<f64>) -> Case {
    let load = phase.force.map_or(Load::Approach(phase.approach), Load::MeanPressure);
    let setting = Setting {
        grading: 4.0,
        penalty: None,
        friction: Some(Friction::constant(Law::Coulomb, 0.2)),
        ..Setting::new(CELLS, one_arm(0.3, rule), vec![phase])
    };
    let compare = move |_: &[_]| {
        let alone = SimpleCommunicator::self_comm();
        let mut sliding = composition::steady(&alone, &setting.scene()?, Path::new("verify"), Vector2::x())?;
        let mut rows = Vec::new();
        for state in sliding.states(&velocities)? {
            let wave = setting.wave();
            let exact = setting.steady(state.velocity).solve(512, |x| wave.at(x), load)?;
            let at = |what: &str| format!("{what} at v = {} m/s", state.velocity);
            let ratios = [state.hysteretic_force / state.normal_force, exact.hysteretic / exact.normal];
            let given = match load {
                Load::Approach(_) => Row::relative(at("N, N/m,"), [state.normal_force, exact.normal], 2e-4, REASON),
                Load::MeanPressure(_) => Row::relative(at("D, m,"), [state.approach, exact.approach], 2e-4, REASON),
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
        source: "complementarity in Fourier space, 512 nodes",
        subjects: Vec::new(),
        compare: Box::new(compare),
    }
}
