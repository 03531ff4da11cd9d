//! Partial slip under friction that is regularised by the slip: no time scale, Masing's rule, closed loops; and what each
//! regularisation lets a point do that is to stick.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::process::Command;

use mpjr::output::reader::Results;

/// Elastic and nearly incompressible, so that shear does not change the pressure.
const SCENE: &str = r#"
[layer]
width = 1.0
depth = 0.7
cells = [64, 16]
sides = "periodic"
element = "q4_bbar"
[material]
shear_modulus = 300.0
poisson_ratio = 0.4999
[indenter]
profile = "harmonic"
amplitude = 5e-4
wavelength = 1.0
[contact]
penalty = 1e8
[friction]
law = "coulomb_elastic_slip"
coefficient = 0.3
elastic_slip = 1e-7
[[phase]]
name = "press"
duration = 1.0
steps = 2
approach = 5e-4
[[phase]]
name = "forth"
duration = 1.0
steps = 20
velocity = 6e-4
[[phase]]
name = "back"
duration = 2.0
steps = 20
velocity = -6e-4
[[phase]]
name = "again"
duration = 2.0
steps = 20
velocity = 6e-4
[solver]
tolerance = 1e-11
"#;

/// The rows of the first step of "forth", and of all that follow, in the scene with some keys changed.
fn run(overrides: &[&str]) -> Results {
    let directory = tempfile::tempdir().unwrap();
    let (scene, out) = (directory.path().join("scene.toml"), directory.path().join("run.h5"));
    std::fs::write(&scene, SCENE).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_mpjr"));
    command.arg("run").arg(&scene).arg("--out").arg(&out);
    command.args(overrides.iter().flat_map(|change| ["--set", change]));
    let output = command.output().unwrap();
    assert!(output.status.success(), "{overrides:?}: {}", String::from_utf8_lossy(&output.stderr));
    Results::open(&out).unwrap()
}

/// Q over f N at the end of each step from the end of pressing on.
fn shear(results: &Results) -> Vec<f64> {
    let (normal, tangential) = (results.history("normal_force").unwrap(), results.history("tangential_force").unwrap());
    normal.iter().zip(&tangential).skip(2).map(|(n, q)| q / (0.3 * n)).collect()
}

/// The same motion in a ten-thousandth of the time gives the same forces.
#[test]
fn there_is_no_time_scale() {
    let slow = shear(&run(&[]));
    let fast = shear(&run(&[
        "phase.forth.duration=1e-4",
        "phase.forth.velocity=6.0",
        "phase.back.duration=2e-4",
        "phase.back.velocity=-6.0",
        "phase.again.duration=2e-4",
        "phase.again.velocity=6.0",
    ]));
    let worst = slow.iter().zip(&fast).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
    assert!(slow.len() == 61 && worst < 1e-8, "{worst:e}");
}

/// Masing: a branch after a turn is the first one, twice as large; a loop closes. The pressure stays but for Dundurs'
/// 2e-4 of the shear.
#[test]
fn branches_follow_masings_rule() {
    let q = shear(&run(&[]));
    // q[k] belongs to the end of step k of "forth", whose steps are half of the others'.
    let turn = q[20];
    assert!(turn > 0.3 && turn < 0.9, "no partial slip: {turn}");
    for k in 0..=20 {
        let (back, again) = (q[20 + k], q[40 + k]);
        assert!((turn - back - 2.0 * q[k]).abs() < 5e-4, "back, {k}: {back} {}", turn - 2.0 * q[k]);
        assert!((back + again - q[20] - q[40]).abs() < 5e-4, "again, {k}: {again}");
    }
    assert!((q[60] - turn).abs() < 5e-4, "{} {turn}", q[60]);
}

/// Held after a sway, the elastic slip keeps the shear, at a slip below the one stated; under tanh the contact creeps,
/// its shear falls, and the history says how far sticking points have come.
#[test]
fn regularisations_tell_their_error_during_holds() {
    let hold =
        ["phase.back={name=\"hold\",duration=10.0,steps=10}", "phase.again={name=\"rest\",duration=10.0,steps=10}"];
    let elastic = run(&hold);
    let (q, stuck) = (shear(&elastic), elastic.history("stuck_slip").unwrap());
    assert!(stuck.iter().all(|slip| *slip <= 1e-7) && *stuck.last().unwrap() > 1e-9, "{stuck:?}");
    assert!((q[20] - q[40]).abs() < 1e-9, "{} {}", q[20], q[40]);

    let tanh = ["friction={law=\"coulomb_tanh\",coefficient=0.3,regularisation=1e-5}"];
    let creeping = run(&[&tanh[..], &hold[..]].concat());
    let (q, stuck) = (shear(&creeping), creeping.history("stuck_slip").unwrap());
    let [sway, hold, rest] = [22, 32, 42].map(|row: usize| stuck[row]);
    assert!(sway <= 1e-5 && hold > 10.0 * 1e-6 && rest > hold && rest <= 21.0 * 1e-5, "{sway:e} {hold:e} {rest:e}");
    assert!(q[40] < 0.9 * q[20], "{} {}", q[20], q[40]);
}

/// Coulomb's law itself during a hold of an elastic body in partial slip, on faces that are solved by LU, by Fourier transforms and on
/// free sides, without penetration and with a penalty: nothing slips, and N, Q and what sticks are those before it, to the last bit.
#[test]
fn what_is_held_rests() {
    let hold = "phase.back={name=\"hold\",duration=1e4,steps=200}";
    let law =
        ["friction={law=\"coulomb\",coefficient=0.3}", "phase.again={name=\"rest\",duration=10.0,steps=10}", hold];
    for kind in [
        &["contact.penalty="][..],
        &["contact.penalty=", "layer.cells=[256,16]"],
        &["contact.penalty=", "layer.sides=free", "material.poisson_ratio=0.3"],
        &["layer.cells=[256,16]"],
    ] {
        let results = run(&[&law[..], kind, &["phase.forth.velocity=1e-4"]].concat());
        for column in ["normal_force", "tangential_force", "stick_fraction", "contact_fraction"] {
            let values = results.history(column).unwrap();
            assert!(values[22..].iter().all(|value| value.to_bits() == values[22].to_bits()), "{kind:?} {column}");
        }
        let sticks = results.history("stick_fraction").unwrap()[22];
        assert!(sticks > 0.1 && sticks < 0.9, "{kind:?}: {sticks}");
        assert!(results.history("stuck_slip").unwrap().iter().all(|slip| *slip == 0.0), "{kind:?}");
        let slips = results.interface("slip_rate").unwrap();
        let pressures = results.interface("pressure").unwrap();
        for frame in 22..slips.rows {
            let touching = slips.row(frame).iter().zip(pressures.row(frame)).filter(|(_, p)| **p > 0.0);
            assert!(
                touching.clone().count() > 3 && touching.map(|(slip, _)| slip).all(|slip| *slip == 0.0),
                "{kind:?}"
            );
        }
    }
}
