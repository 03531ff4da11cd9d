//! Relaxation and creep of a uniformly compressed layer against closed form, through the whole program: the exponential
//! memory is second order in the step, backward Euler first order, for both Poisson rules.
//!
//! ```text
//!     D(t)        p = alpha (D - d)      penalty, a spring in series with the layer
//!   ==v=======
//!   |  layer |    p = M * d / H          M(t) = K(t) + 4/3 G(t), uniaxial strain (roller sides)
//!   ----------
//! ```
//!
//! Over a ramp d is linear only if the contact is rigid; then the exponential memory is exact.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::program::{Outcome, Run};
use mpjr::oracle::prony::Relaxing;

const UNIFORM: &str = include_str!("scenes/uniform.toml");
const WIDTH: f64 = 2.0;
const DEPTH: f64 = 0.5;
/// G and K at t = 0, Pa, of the scene's modulus and Poisson ratio 0.3.
const SHEAR: f64 = 600.0;
const BULK: f64 = 2.0 * SHEAR * 1.3 / (3.0 * 0.4);
/// Approach, m, reached in 1 s and held for 1 s.
const APPROACH: f64 = 1e-3;
const ARMS: [(f64, f64); 2] = [(0.4, 0.3), (0.35, 1.1)];

const RULES: [&str; 2] = ["constant_ratio", "constant_bulk_modulus"];

/// The uniaxial-strain modulus under a Poisson rule: either all of it relaxes, or only its 4/3 G.
fn uniaxial(rule: &str, arms: &[(f64, f64)]) -> Relaxing {
    let instantaneous = BULK + 4.0 / 3.0 * SHEAR;
    let share = if rule == "constant_ratio" { 1.0 } else { 4.0 / 3.0 * SHEAR / instantaneous };
    Relaxing { instantaneous, arms: arms.iter().map(|&(weight, time)| (share * weight, time)).collect() }
}

/// The scene with `steps` in each of its two phases.
fn run(rule: &str, memory: &str, arms: &[(f64, f64)], penalty: f64, steps: usize) -> Outcome {
    let list: Vec<String> =
        arms.iter().map(|(weight, time)| format!("{{ weight = {weight}, time = {time} }}")).collect();
    Run::new(UNIFORM)
        .set(format!("material.arms=[{}]", list.join(", ")))
        .set(format!("material.poisson_rule=\"{rule}\""))
        .set(format!("material.memory=\"{memory}\""))
        .set(format!("contact.penalty={penalty:e}"))
        .set(format!("phase.ramp.steps={steps}"))
        .set(format!("phase.hold.steps={steps}"))
        .done()
}

/// The pressure at the end of the ramp and of the hold, Pa.
fn pressures(outcome: &Outcome) -> [f64; 2] {
    [1.0, 2.0].map(|time| outcome.at(time, "normal_force") / WIDTH)
}

/// Relative errors of values at both times over rising numbers of steps, as measured; the last two give the orders.
fn orders(errors: &[[f64; 2]]) -> [f64; 2] {
    let [.., coarse, fine] = errors else { panic!("two levels") };
    [0, 1].map(|i| (coarse[i] / fine[i]).log2())
}

fn relative(found: [f64; 2], exact: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|i| (found[i] / exact[i] - 1.0).abs())
}

/// A rigid contact imposes d = D, linear in time: p = (M * D)/H, "ramp and hold". The exponential memory gives it exactly
/// at any step; backward Euler to first order.
#[test]
fn relaxation_under_a_rigid_indenter() {
    for rule in RULES {
        let material = uniaxial(rule, &ARMS);
        // A penalty of 1e10 Pa/m lets the indenter sink in by 4e-7 of the approach at first.
        let exact = [1.0, 2.0].map(|t| material.ramp_and_hold(APPROACH / DEPTH, 1.0, t));
        for steps in [1, 3, 16] {
            let found = pressures(&run(rule, "exponential", &ARMS, 1e10, steps));
            println!("{rule} exponential {steps}: {:?}", relative(found, exact));
            assert!(relative(found, exact).iter().all(|e| *e < 5e-7), "{rule} {steps}: {found:?} {exact:?}");
        }
        let errors = [16, 32, 64].map(|n| relative(pressures(&run(rule, "backward_euler", &ARMS, 1e10, n)), exact));
        println!("{rule} backward Euler {errors:?} orders {:?}", orders(&errors));
        assert!(orders(&errors).iter().all(|order| (0.95..1.05).contains(order)), "{rule}: {errors:?}");
    }
}

/// A penalty as soft as the layer: relaxation and creep together. The two in series are again a relaxing spring,
/// 1/M_eff = 1/alpha + H/M, with one arm for one arm: its time is tau (alpha + k)/(alpha + k mu_0), k = M_inst/H.
#[test]
fn relaxation_in_series_with_the_penalty() {
    let arm = [(0.6, 0.5)];
    let penalty = 2000.0;
    for rule in RULES {
        let material = uniaxial(rule, &arm);
        let (k, rest) = (material.instantaneous / DEPTH, material.long_term());
        let series = |stiffness: f64| penalty * stiffness / (penalty + stiffness);
        let time = arm[0].1 * (penalty + k) / (penalty + k * rest);
        let instantaneous = series(k);
        let effective = Relaxing { instantaneous, arms: vec![(1.0 - series(k * rest) / instantaneous, time)] };
        let exact = [1.0, 2.0].map(|t| effective.ramp_and_hold(APPROACH, 1.0, t));
        for (memory, order, largest) in [("exponential", 2.0, 1e-5), ("backward_euler", 1.0, 5e-3)] {
            let errors = [8, 16, 32].map(|n| relative(pressures(&run(rule, memory, &arm, penalty, n)), exact));
            println!("{rule} {memory} {errors:?} orders {:?}", orders(&errors));
            assert!(orders(&errors).iter().all(|o| (o - order).abs() < 0.1), "{rule} {memory}: {errors:?}");
            assert!(errors[2].iter().all(|e| *e < largest), "{rule} {memory}: {errors:?}");
        }
    }
}

/// A penalty far softer than the layer imposes the pressure p = alpha D: the layer creeps, d = H (J * p), with
/// J = J_inf - sum J_j exp(-t/rho_j). After a ramp of 1 s at the rate p':
/// d = H p' [J_inf - sum J_j rho_j (exp(-(t - 1)/rho_j) - exp(-t/rho_j))].
#[test]
fn creep_under_a_soft_penalty() {
    let penalty = 1e-6;
    for rule in RULES {
        let creep = uniaxial(rule, &ARMS).creep().unwrap();
        let rate = penalty * APPROACH;
        let exact = [1.0, 2.0].map(|t: f64| {
            let mode = |&(weight, time): &(f64, f64)| weight * time * ((-(t - 1.0) / time).exp() - (-t / time).exp());
            DEPTH * rate * (creep.long_term - creep.modes.iter().map(mode).sum::<f64>())
        });
        for (memory, order, largest) in [("exponential", 2.0, 1e-4), ("backward_euler", 1.0, 1e-2)] {
            let errors = [8, 16, 32].map(|n| {
                let field = run(rule, memory, &ARMS, penalty, n).results().interface("displacement_z").unwrap();
                // At the end of each phase; the same at all nodes.
                relative([field.row(n - 1)[1], field.row(2 * n - 1)[2]].map(|u| -u), exact)
            });
            println!("{rule} {memory} {errors:?} orders {:?}", orders(&errors));
            assert!(orders(&errors).iter().all(|o| (o - order).abs() < 0.1), "{rule} {memory}: {errors:?}");
            assert!(errors[2].iter().all(|e| *e < largest), "{rule} {memory}: {errors:?}");
        }
    }
}
