//! Partial slip under friction that is regularised by the slip: no time scale, Masing's rule, closed loops; and what each
//! regularisation lets a point do that is to stick.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::program::{Outcome, solved};
use common::scene::{COSINE, Text, elastic, layer, phase};

/// Elastic and nearly incompressible, so that shear does not change the pressure.
static SCENE: Text = Text::new(|| {
    let layer = layer("1.0", "0.7", "[64, 16]") + "element = \"q4_bbar\"\n";
    let law = "law = \"coulomb_elastic_slip\"\ncoefficient = 0.3\nelastic_slip = 1e-7\n";
    let law = format!("[contact]\npenalty = 1e8\n[friction]\n{law}");
    let press = phase("press", 2) + "duration = 1.0\napproach = 5e-4\n";
    let forth = phase("forth", 20) + "duration = 1.0\nvelocity = 6e-4\n";
    let back = phase("back", 20) + "duration = 2.0\nvelocity = -6e-4\n";
    let again = phase("again", 20) + "duration = 2.0\nvelocity = 6e-4\n[solver]\ntolerance = 1e-11\n";
    layer + &elastic("300.0", "0.4999") + COSINE + &law + &press + &forth + &back + &again
});

/// Q over f N at the end of each step from the end of pressing on.
fn shear(outcome: &Outcome) -> Vec<f64> {
    let [normal, tangential] = ["normal_force", "tangential_force"].map(|name| outcome.history(name));
    normal.iter().zip(&tangential).skip(2).map(|(n, q)| q / (0.3 * n)).collect()
}

/// The same motion in a ten-thousandth of the time gives the same forces.
#[test]
fn there_is_no_time_scale() {
    let slow = shear(&solved(&SCENE, &[]));
    let fast = shear(&solved(
        &SCENE,
        &[
            "phase.forth.duration=1e-4",
            "phase.forth.velocity=6.0",
            "phase.back.duration=2e-4",
            "phase.back.velocity=-6.0",
            "phase.again.duration=2e-4",
            "phase.again.velocity=6.0",
        ],
    ));
    let worst = slow.iter().zip(&fast).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
    assert!(slow.len() == 61 && worst < 1e-8, "{worst:e}");
}

/// Masing: a branch after a turn is the first one, twice as large; a loop closes. The pressure stays but for Dundurs'
/// 2e-4 of the shear.
#[test]
fn branches_follow_masings_rule() {
    let q = shear(&solved(&SCENE, &[]));
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
    let elastic = solved(&SCENE, &hold);
    let (q, stuck) = (shear(&elastic), elastic.history("stuck_slip"));
    assert!(stuck.iter().all(|slip| *slip <= 1e-7) && *stuck.last().unwrap() > 1e-9, "{stuck:?}");
    assert!((q[20] - q[40]).abs() < 1e-9, "{} {}", q[20], q[40]);

    let tanh = ["friction={law=\"coulomb_tanh\",coefficient=0.3,regularisation=1e-5}"];
    let creeping = solved(&SCENE, &[&tanh[..], &hold[..]].concat());
    let (q, stuck) = (shear(&creeping), creeping.history("stuck_slip"));
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
        let outcome = solved(&SCENE, &[&law[..], kind, &["phase.forth.velocity=1e-4"]].concat());
        for column in ["normal_force", "tangential_force", "stick_fraction", "contact_fraction"] {
            let values = outcome.history(column);
            assert!(values[22..].iter().all(|value| value.to_bits() == values[22].to_bits()), "{kind:?} {column}");
        }
        let sticks = outcome.history("stick_fraction")[22];
        assert!(sticks > 0.1 && sticks < 0.9, "{kind:?}: {sticks}");
        assert!(outcome.history("stuck_slip").iter().all(|slip| *slip == 0.0), "{kind:?}");
        let results = outcome.results();
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
