//! Heat in whole runs: one way, on any body, on any number of ranks, across checkpoints; what heats is what the ledger of energies
//! says. The numbers of conduction itself are in `src/solve/heat/tests.rs` and in `mpjr verify`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::Path;
use std::process::Stdio;

use common::program::{Outcome, Run, assert_same, numbers, output_of, program, solved, wait_for};
use common::scene::{RUBBER, Text};

/// A parabola that is pressed in and slid, with arms, air and a held base.
static SCENE: Text = Text::new(|| {
    let heat = "[heat]\ninitial = 293.0\nbase = 290.0\nshare = 0.75\n";
    let air = "convection = { coefficient = 200.0, temperature = 300.0 }\n";
    [RUBBER[0], "heat_capacity = 2e6", RUBBER[1], heat, air, "[output]\nbulk_at = [\"slide\"]\n"].concat()
});
const BULK: &str = "material.poisson_rule=\"constant_bulk_modulus\"";
const TEMPERATURE: &str = "friction.coefficient=\"0.4*exp(-(T - 293)/2)\"";

/// What entered is stored, given to the air or to the base, at every step, to round-off of the most that there is of them; and it is
/// the share of what friction dissipated and, where they heat, all that the arms did.
fn balances(outcome: &Outcome, arms: bool) {
    let energy = |name: &str| outcome.history(&format!("energy/{name}"));
    let columns = ["heat", "heat_stored", "heat_convected", "heat_conducted"].map(energy);
    let largest = columns.iter().flatten().fold(0.0_f64, |most, value| most.max(value.abs()));
    let (friction, arm) = (energy("friction_dissipation"), energy("viscoelastic_dissipation"));
    assert!(columns[0].last().unwrap() > &0.0 && largest > 0.0);
    for row in 0..friction.len() {
        let [entered, stored, convected, conducted] = [0, 1, 2, 3].map(|i| columns[i][row]);
        assert!((entered - stored - convected - conducted).abs() < 1e-12 * largest, "row {row}");
        let source = 0.75 * friction[row] + if arms { arm[row] } else { 0.0 };
        assert!((entered - source).abs() < 1e-11 * columns[0].last().unwrap(), "row {row}: {entered} {source}");
    }
}

/// Periodic layers by waves, others by a sparse factor, either strategy, planned and adaptive steps, a base of either kind.
#[test]
fn what_enters_is_what_friction_lost_and_goes_somewhere() {
    for changes in [
        &["heat.base=\"insulated\""][..],
        &[BULK],
        &["layer.sides=\"free\""],
        &["layer.sides=\"fixed\"", BULK, "phase.slide.duration=0.3"],
        &[
            "contact.penalty=1e10",
            "friction={law=\"coulomb_tanh\",coefficient=0.4,regularisation=1e-4}",
            "solver.strategy=\"monolithic\"",
        ],
        &[
            "contact.quadrature=\"gauss\"",
            "contact.penalty=1e10",
            "friction={law=\"coulomb_elastic_slip\",coefficient=0.4,elastic_slip=1e-6}",
        ],
    ] {
        balances(&solved(&SCENE, changes), false);
    }
    let adaptive = SCENE.replace("steps = 25\n", "tolerance = 1e-2\n");
    balances(&Run::new(&adaptive).done(), false);
}

/// With `arms`, of every body and strategy.
#[test]
fn arms_heat_with_all_that_they_dissipate() {
    for changes in [
        &["heat.arms=true"][..],
        &["heat.arms=true", BULK],
        &["heat.arms=true", BULK, "layer.sides=\"free\""],
        &[
            "heat.arms=true",
            "contact.penalty=1e10",
            "friction={law=\"coulomb_tanh\",coefficient=0.4,regularisation=1e-4}",
            "solver.strategy=\"monolithic\"",
        ],
        &["heat.arms=true", "layer.width=[0.02, 0.008]", "layer.cells=[10, 4, 3]", "heat.base=\"insulated\""],
    ] {
        let outcome = solved(&SCENE, changes);
        balances(&outcome, true);
        assert!(outcome.last("max_temperature") > outcome.last("mean_temperature"));
    }
}

/// Nothing mechanical changes by a bit.
#[test]
fn heat_is_one_way() {
    let cold = SCENE.replace("[heat]\ninitial = 293.0\nbase = 290.0\nshare = 0.75\nconvection = { coefficient = 200.0, temperature = 300.0 }\n", "");
    assert!(!cold.contains("[heat]"));
    let (cold, warm) = (Run::new(&cold).done(), solved(&SCENE, &["heat.arms=true"]));
    let warm = numbers(&warm.file());
    for (name, values) in numbers(&cold.file()) {
        let found = &warm.iter().find(|(other, _)| *other == name).unwrap().1;
        assert!(found.iter().zip(&values).all(|(a, b)| a.to_bits() == b.to_bits()), "{name}");
    }
}

/// On three ranks as on one, with the temperature in the coefficient and arms that heat.
#[test]
fn ranks_make_no_difference() {
    for changes in [&["heat.arms=true", TEMPERATURE][..], &["layer.sides=\"free\"", BULK, "output.bulk_at=[]"]] {
        let with = |ranks| changes.iter().fold(Run::new(&SCENE).ranks(ranks), |run, change| run.set(*change)).done();
        let (one, three) = (with(1), with(3));
        // The interior behind the face is distributed where arms heat.
        assert_same(&one.file(), &three.file(), if changes.len() == 2 { 1e-11 } else { 0.0 });
    }
}

/// Through the face of a mirror: rollers on a symmetric half-line hold what a period repeats, so that the sparse factor and the
/// waves have to come to the same temperatures, which the air alone makes here.
#[test]
fn a_sparse_factor_is_the_waves() {
    let still = ["phase.slide.velocity=0.0", "heat.base=\"insulated\"", "layer.cells=[40, 8]"];
    let [waves, sparse] = ["periodic", "roller"].map(|sides| {
        let sides = format!("layer.sides=\"{sides}\"");
        solved(&SCENE, &[&still[..], &[sides.as_str()]].concat())
    });
    let last = |outcome: &Outcome| outcome.results().interface("temperature").unwrap();
    let (one, other) = (last(&waves), last(&sparse));
    assert_eq!((one.columns, other.columns), (40, 41));
    for (a, b) in one.row(one.rows - 1).iter().zip(other.row(other.rows - 1)) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    assert!(one.row(one.rows - 1).iter().any(|t| *t > 293.1));
}

/// In space, a profile that does not depend on y warms what it warms in the plane.
#[test]
fn space_is_the_plane() {
    for more in [&[][..], &[TEMPERATURE]] {
        let plane = solved(&SCENE, more);
        let space = solved(&SCENE, &[&["layer.width=[0.02, 0.004]", "layer.cells=[40, 3, 8]"], more].concat());
        for name in ["max_temperature", "mean_temperature"] {
            for (a, b) in plane.history(name).iter().zip(space.history(name)) {
                assert!((a - b).abs() < 1e-9 * 293.0, "{name}: {a} {b}");
            }
        }
        for name in ["energy/heat", "energy/heat_convected", "energy/heat_conducted", "normal_force"] {
            let (a, b) = (plane.last(name), space.last(name) / 0.004);
            assert!((a - b).abs() < 1e-9 * a.abs(), "{name}: {a} {b}");
        }
    }
}

/// The coefficient of a step is that of the temperature at its beginning: q = f(T_n) p where a node slips, to the last digits.
#[test]
fn friction_knows_the_temperature_of_the_beginning() {
    let outcome = solved(&SCENE, &[TEMPERATURE]);
    let [p, q, temperature] =
        ["pressure", "shear", "temperature"].map(|name| outcome.results().interface(name).unwrap());
    let (mut slipping, mut least) = (0, f64::INFINITY);
    for step in 7..p.rows {
        for node in 0..p.columns {
            let coefficient = 0.4 * (-(temperature.row(step - 1)[node] - 293.0) / 2.0).exp();
            let (p, q) = (p.row(step)[node], q.row(step)[node]);
            if p > 0.0 {
                assert!((q - coefficient * p).abs() < 1e-9 * p, "{q} {p} {coefficient}");
                (slipping, least) = (slipping + 1, coefficient.min(least));
            }
        }
    }
    assert!(slipping > 50 && least < 0.38, "{slipping} {least}");
}

/// The body at rest is at its initial temperature, in row 0; temperatures of the bulk have those of the face in them.
#[test]
fn temperatures_begin_where_they_are_told() {
    let outcome = solved(&SCENE, &["layer.width=[0.02, 0.008]", "layer.cells=[10, 4, 3]"]);
    assert_eq!(outcome.history("max_temperature")[0], 293.0);
    let (bulk, face) =
        (outcome.results().bulk("temperature").unwrap(), outcome.results().interface("temperature").unwrap());
    let highest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    assert_eq!(highest(bulk.row(0)), outcome.last("max_temperature"));
    assert!(face.row(face.rows - 1).iter().all(|t| bulk.row(0).contains(t)));
    assert!(bulk.row(0).contains(&290.0));
}

/// A run that is killed goes on with the same bits.
#[test]
fn checkpoints_keep_every_bit() {
    for changes in [&["heat.arms=true", TEMPERATURE][..], &["layer.sides=\"free\"", "heat.base=\"insulated\""]] {
        let directory = tempfile::tempdir().unwrap();
        let scene = directory.path().join("scene.toml");
        let long = SCENE.replace("steps = 25", "steps = 400");
        std::fs::write(&scene, long.replace("[output]", "[output]\ncheckpoint_every = 2")).unwrap();
        let [whole, killed] = ["whole.h5", "killed.h5"].map(|name| directory.path().join(name));
        let command = |out: &Path| {
            let mut command = program(1);
            command.arg("run").arg(&scene).arg("--out").arg(out);
            changes.iter().for_each(|change| {
                command.args(["--set", change]);
            });
            command
        };
        output_of(&mut command(&whole));
        let mut child = command(&killed).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        wait_for(&mut child, &killed, 5);
        assert_eq!(child.try_wait().unwrap(), None, "ended by itself");
        child.kill().unwrap();
        child.wait().unwrap();
        output_of(command(&killed).arg("--resume"));
        assert_same(&whole, &killed, 0.0);
    }
}
