//! Uniform compression of a relaxing layer, and the elastic limits of fast and slow loading.

use super::setting::{Indenter, Phase, Setting, one_arm};
use super::{Case, Row, resolution};
use crate::oracle::prony::Relaxing;
use crate::oracle::steady::{Load, Sliding, Steady};
use crate::oracle::transient::Update;
use crate::oracle::{PoissonRule, Solid};
use crate::solution::Solution;

pub fn cases(quick: bool) -> Vec<Case> {
    vec![
        compression(PoissonRule::ConstantRatio),
        compression(PoissonRule::ConstantBulkModulus),
        compression_backward_euler(),
        elastic_limits(if quick { 64 } else { 128 }),
    ]
}

const RAMP: f64 = 2.0;
const HOLD: f64 = 6.0;
const APPROACH: f64 = 1e-3;

/// The paper's Table 1, three arms.
fn three_arms(rule: PoissonRule) -> Solid {
    let arms = vec![(0.309, 0.102), (0.226, 0.545), (0.210, 4.104)];
    Solid { shear: 749.386, poisson: 0.3, rule, arms }
}

/// A face pressed flat: a wave of a nanometre's millionth, so that the strain is APPROACH/H everywhere.
fn pressed(solid: Solid, [ramp, hold]: [usize; 2]) -> Setting {
    Setting {
        indenter: Indenter::Wave(1e-15),
        penalty: Some(1e11),
        ..Setting::new(4, solid, vec![Phase::press(RAMP, ramp, APPROACH), Phase::press(HOLD, hold, APPROACH)])
    }
}

/// The oedometric modulus K + 4 G/3, Pa, under uniaxial strain: what of it relaxes, and what does not. G relaxes, and K
/// too where the Poisson ratio is constant.
fn moduli(solid: &Solid) -> (Relaxing, f64) {
    let Solid { shear, poisson, rule, arms } = solid;
    let bulk = 2.0 * shear * (1.0 + poisson) / (3.0 * (1.0 - 2.0 * poisson));
    let (relaxing, constant) = match rule {
        PoissonRule::ConstantRatio => (bulk + 4.0 / 3.0 * shear, 0.0),
        PoissonRule::ConstantBulkModulus => (4.0 / 3.0 * shear, bulk),
    };
    (Relaxing { instantaneous: relaxing, arms: arms.clone() }, constant)
}

/// The mean pressure at time t of the ramp and hold. Force on 1 m.
fn exact(solid: &Solid, t: f64) -> f64 {
    let (relaxing, constant) = moduli(solid);
    relaxing.ramp_and_hold(APPROACH / RAMP, RAMP, t) + constant * APPROACH * (t / RAMP).min(1.0)
}

/// The energies, J/m: in the springs, and dissipated in the arms. What does not relax stores all that it takes.
fn exact_energy(solid: &Solid, t: f64) -> [f64; 2] {
    let (relaxing, constant) = moduli(solid);
    let [stored, dissipated] = relaxing.ramp_and_hold_energy(APPROACH / RAMP, RAMP, t);
    [stored + 0.5 * constant * (APPROACH * (t / RAMP).min(1.0)).powi(2), dissipated]
}

/// The exponential memory is exact for a displacement that is linear over each step, and so are the energies of its arms:
/// here, to the last digits but for
/// the penalty, whose compliance of 1e-11 m/Pa stands in series with the layer's of 1e-4 to 1e-3 m/Pa.
fn compression(rule: PoissonRule) -> Case {
    let setting = pressed(three_arms(rule), [4, 3]);
    let solid = setting.solid.clone();
    let compare = move |solutions: &[Solution]| {
        let why = "solver: 1e-10; penalty in series: 1e-11 m/Pa";
        let mut rows = Vec::new();
        for (phase, end, t) in [(0, "ramp", RAMP), (1, "hold", RAMP + HOLD)] {
            let row = solutions[0].end_of(phase);
            let [stored, dissipated] = exact_energy(&solid, t);
            for (quantity, values) in [
                ("N_z at the end of the {end}, N/m", [row.normal_force, exact(&solid, t)]),
                ("energy stored then, J/m", [row.energy.stored, stored]),
                ("dissipated in the arms until then, J/m", [row.energy.viscoelastic_dissipation, dissipated]),
            ] {
                rows.push(Row::relative(quantity.replace("{end}", end), values, 1e-7, why));
            }
        }
        Ok(rows)
    };
    let rule = match rule {
        PoissonRule::ConstantRatio => "constant Poisson ratio",
        PoissonRule::ConstantBulkModulus => "constant bulk modulus",
    };
    Case {
        name: format!("Prony relaxation, three arms, {rule}"),
        source: "ramp and hold in uniaxial strain, in closed form",
        subjects: vec![setting.into()],
        compare: Box::new(compare),
    }
}

/// Backward Euler is of first order: N_z errs by dt/2 times the slope of what relaxes, at most
/// dt/2 sum mu_i/tau_i of the glassy answer.
fn compression_backward_euler() -> Case {
    let with =
        |steps| Setting { update: Update::BackwardEuler, ..pressed(three_arms(PoissonRule::ConstantRatio), steps) };
    let settings = [with([200, 60]), with([400, 120])];
    let solid = settings[0].solid.clone();
    let compare = move |solutions: &[Solution]| {
        let [coarse, fine] = [0, 1].map(|i| solutions[i].end_of(0).normal_force);
        let ramp = exact(&solid, RAMP);
        let order = ((coarse - ramp) / (fine - ramp)).abs().log2();
        let tolerance = 2.0 * (fine - coarse).abs();
        Ok(vec![
            Row::new(
                "N_z at the end of the ramp, N/m",
                [fine, ramp],
                tolerance,
                "twice the error that half the steps predict",
            ),
            Row::new("  its order of convergence in dt", [order, 1.0], 0.1, "not yet asymptotic"),
        ])
    };
    Case {
        name: "Prony relaxation, backward Euler".into(),
        source: "ramp in uniaxial strain, in closed form",
        subjects: settings.map(Into::into).into(),
        compare: Box::new(compare),
    }
}

/// A wave pressed within a millionth of the relaxation time meets the instantaneous moduli, within a million of them
/// the long-term ones: partial contact, against the elastic contact in Fourier space.
fn elastic_limits(n: usize) -> Case {
    let with = |duration: f64| {
        let solid = one_arm(0.3, PoissonRule::ConstantRatio);
        Setting::new(n, solid, vec![Phase::press(duration, 4, 1e-3)])
    };
    let settings = [with(1e-6), with(1e6)];
    let fast = settings[0].clone();
    let compare = move |solutions: &[Solution]| {
        let mut glassy = fast.steady(0.0);
        let relaxed = glassy.clone();
        glassy.solid.arms.clear();
        let wave = fast.wave();
        let solve = |sliding: &Sliding| sliding.solve(512, |x| wave.at(x), Load::Approach(1e-3));
        let row = |name, computed: f64, exact: Steady| {
            let resolution = resolution(fast.spacing(), exact.contact_width);
            Row::resolved(name, [computed, exact.normal], resolution)
        };
        Ok(vec![
            row("N_z pressed in 1 us, N/m", solutions[0].last().normal_force, solve(&glassy)?),
            row("N_z pressed in 1e6 s, N/m", solutions[1].last().normal_force, solve(&relaxed)?),
        ])
    };
    Case {
        name: "elastic limits of one arm".into(),
        source: "complementarity in Fourier space, 512 nodes",
        subjects: settings.map(Into::into).into(),
        compare: Box::new(compare),
    }
}
