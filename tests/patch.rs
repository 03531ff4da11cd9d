//! Patch tests through the whole program: a state of uniform stress is met exactly, whatever the mesh, up to the
//! solver's tolerance (1e-12 here) and the output of bulk fields.
//!
//! ```text
//!   ==v===v===v==   flat indenter, approach D, penalty alpha
//!   o           o   e = d/H,  sigma_zz = -p = -M e,  M = K + 4/3 G,  p = D/(1/alpha + H/M)
//!   o           o   roller or periodic sides: no strain along x
//!   -------------   sigma_xx = sigma_yy = -(K - 2/3 G) e,  sigma_xz = 0
//! ```
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::program::{Outcome, Run};
use mpjr::oracle::prony::Relaxing;

const UNIFORM: &str = include_str!("scenes/uniform.toml");
const WIDTH: f64 = 2.0;
const DEPTH: f64 = 0.5;
const APPROACH: f64 = 1e-3;
const SHEAR: f64 = 600.0;
const BULK: f64 = 2.0 * SHEAR * 1.3 / (3.0 * 0.4);
const UNIAXIAL: f64 = BULK + 4.0 / 3.0 * SHEAR;

/// Asserts the stress (xx, zz, yy, xz) at all nodes in the last frame, to a tolerance relative to the largest.
fn assert_stress(outcome: &Outcome, expected: [f64; 4], tolerance: f64) {
    let stress = outcome.results().bulk("stress").unwrap();
    let scale = expected.iter().fold(0.0f64, |most, s| most.max(s.abs()));
    assert!(stress.columns > 0);
    for node in stress.row(stress.rows - 1).chunks_exact(4) {
        for (found, exact) in node.iter().zip(expected) {
            assert!((found - exact).abs() < tolerance * scale, "{node:?} against {expected:?}");
        }
    }
}

/// Asserts the displacement at all nodes in the last frame: u = face (1 + z/H).
fn assert_displacement(outcome: &Outcome, face: [f64; 2]) {
    let (u, x) = (outcome.results().bulk("displacement").unwrap(), outcome.results().bulk("coordinates").unwrap());
    for (u, x) in u.row(u.rows - 1).chunks_exact(2).zip(x.values.chunks_exact(2)) {
        for (found, top) in u.iter().zip(face) {
            assert!((found - top * (1.0 + x[1] / DEPTH)).abs() < 1e-9 * APPROACH, "{u:?} at {x:?}");
        }
    }
}

/// Elastic, with a penalty of the layer's own stiffness, on a graded mesh.
#[test]
fn uniform_compression() {
    let penalty = 5000.0;
    let pressure = APPROACH / (1.0 / penalty + DEPTH / UNIAXIAL);
    let strain = pressure / UNIAXIAL;
    let lateral = -(BULK - 2.0 / 3.0 * SHEAR) * strain;
    for (sides, quadrature) in [("roller", "nodal"), ("periodic", "nodal"), ("roller", "gauss"), ("periodic", "gauss")]
    {
        for ranks in [1, 2] {
            let outcome = Run::new(UNIFORM)
                .set(format!("layer.sides=\"{sides}\""))
                .set(format!("contact.penalty={penalty}"))
                .set(format!("contact.quadrature=\"{quadrature}\""))
                .set("output.bulk_at=[\"hold\"]")
                .ranks(ranks)
                .done();
            assert!((outcome.last("normal_force") / (pressure * WIDTH) - 1.0).abs() < 1e-9, "{sides} {quadrature}");
            assert_eq!(outcome.last("tangential_force"), 0.0);
            assert_eq!((outcome.last("contact_fraction"), outcome.last("stick_fraction")), (1.0, 0.0));
            assert!((outcome.last("max_penetration") / (pressure / penalty) - 1.0).abs() < 1e-9);
            assert_stress(&outcome, [lateral, -pressure, lateral, 0.0], 1e-9);
            assert_displacement(&outcome, [0.0, -strain * DEPTH]);
        }
    }
}

/// The same with a relaxing material: the stress that the file tells is that of the accepted state of the arms. A penalty
/// of 1e10 Pa/m is rigid but for 4e-7 of the approach; then the exponential memory is exact on ramp and hold. With e = D/H and G * e from the oracle,
/// sigma_zz = -(K e + 4/3 G * e), sigma_xx = -(K e - 2/3 G * e), where K relaxes like G or not at all.
#[test]
fn uniform_relaxation() {
    let arms = [(0.4, 0.3), (0.35, 1.1)];
    let relaxed =
        |instantaneous: f64| Relaxing { instantaneous, arms: arms.to_vec() }.ramp_and_hold(APPROACH / DEPTH, 1.0, 2.0);
    for (rule, volumetric) in [("constant_ratio", relaxed(BULK)), ("constant_bulk_modulus", BULK * APPROACH / DEPTH)] {
        let outcome = Run::new(UNIFORM)
            .set("material.arms=[{ weight = 0.4, time = 0.3 }, { weight = 0.35, time = 1.1 }]")
            .set(format!("material.poisson_rule=\"{rule}\""))
            .set("contact.penalty=1e10")
            .set("output.bulk_at=[\"hold\"]")
            .done();
        let deviatoric = relaxed(SHEAR);
        let lateral = -(volumetric - 2.0 / 3.0 * deviatoric);
        assert_stress(&outcome, [lateral, -(volumetric + 4.0 / 3.0 * deviatoric), lateral, 0.0], 1e-6);
    }
}

/// Slid at a rate far above the regularisation: sigma_xz = q = f p everywhere, u_x = q H/G at the face, and the pressure
/// stays. The indenter moves along +x and drags the layer with it.
#[test]
fn uniform_shear() {
    let (penalty, friction) = (5000.0, 0.3);
    let pressure = APPROACH / (1.0 / penalty + DEPTH / UNIAXIAL);
    let lateral = -(BULK - 2.0 / 3.0 * SHEAR) * pressure / UNIAXIAL;
    let shear = friction * pressure;
    let scene =
        format!("{UNIFORM}\n[friction]\nlaw = \"coulomb_tanh\"\ncoefficient = {friction}\nregularisation = 1e-4\n");
    for ranks in [1, 2] {
        for sign in [1.0, -1.0] {
            let outcome = Run::new(&scene)
                .set("layer.sides=\"periodic\"")
                .set(format!("contact.penalty={penalty}"))
                .set(format!("phase.hold.velocity={}", sign * 0.1))
                .set("output.bulk_at=[\"hold\"]")
                .ranks(ranks)
                .done();
            assert!((outcome.last("normal_force") / (pressure * WIDTH) - 1.0).abs() < 1e-9);
            assert!((outcome.last("tangential_force") / (sign * shear * WIDTH) - 1.0).abs() < 1e-9);
            assert_eq!(outcome.last("stick_fraction"), 0.0);
            assert_stress(&outcome, [lateral, -pressure, lateral, sign * shear], 1e-9);
            assert_displacement(&outcome, [sign * shear * DEPTH / SHEAR, -pressure / UNIAXIAL * DEPTH]);
        }
    }
}
