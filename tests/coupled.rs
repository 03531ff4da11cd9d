//! Arms that follow the temperature of their cells: against uniform temperatures, against the closed form of a layer with a gradient
//! of temperature, in space, on any number of ranks, across checkpoints; their energies; and that friction falls as rubber gets hot.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::Path;
use std::process::Stdio;

use common::msh::write_msh;
use common::program::{Outcome, Run, assert_same, ends_with, output_of, program, solved, wait_for};
use common::scene::{RUBBER, Text};
use common::solid::{Body, Surface};
use mpjr::mesh::{Layer, Sides};

/// A parabola that is pressed in and slid over rubber whose friction warms it by some kelvin.
static SCENE: Text = Text::new(|| {
    let material = "heat_capacity = 2e5\nshift = \"wlf\"\nc1 = 17.44\nc2 = 51.6\nreference_temperature = 288.0\ntemperature = 293.0";
    let heat = "[heat]\ninitial = 293.0\nbase = 293.0\ncoupled = true\n";
    let air = "convection = { coefficient = 200.0, temperature = 300.0 }\n";
    [RUBBER[0], material, RUBBER[1], heat, air].concat()
});

/// The histories of forces and of energies are the same to so much of the largest value.
fn alike(one: &Outcome, other: &Outcome, within: f64) {
    for name in
        ["normal_force", "tangential_force", "hysteretic_force", "energy/stored", "energy/viscoelastic_dissipation"]
    {
        let (one, other) = (one.history(name), other.history(name));
        let largest = one.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        assert_eq!(one.len(), other.len());
        for (a, b) in one.iter().zip(&other) {
            assert!((a - b).abs() < within * largest, "{name}: {a} {b} of {largest}");
        }
    }
}

/// A body that has come to 303 K everywhere, from 293 K, relaxes as one whose times are those at 303 K: cells with arms of their own
/// come to what nodal fields, the following face and waves do, under either rule of Poisson and either update, by either law.
#[test]
fn at_a_uniform_temperature_times_are_scaled() {
    // No heat of its own; and the time to come to the base, a million diffusion times long.
    let scene = SCENE
        .replace("convection = { coefficient = 200.0, temperature = 300.0 }", "share = 0.0")
        .replace("base = 293.0", "base = 303.0")
        .replace(
            "[[phase]]\nname = \"press\"",
            "[[phase]]\nname = \"wait\"\nduration = 1e7\nsteps = 6\napproach = -1e-4\n[[phase]]\nname = \"press\"",
        );
    let still = |scene: &str| {
        scene
            .replace("coupled = true\n", "")
            .replace("temperature = 293.0\n[indenter]", "temperature = 303.0\n[indenter]")
    };
    for changes in [
        &[][..],
        &["material.poisson_rule=\"constant_bulk_modulus\""],
        &[
            "material.poisson_rule=\"constant_bulk_modulus\"",
            "layer.sides=\"free\"",
            "material.memory=\"backward_euler\"",
        ],
    ] {
        alike(&solved(&still(&scene), changes), &solved(&scene, changes), 1e-9);
    }
    let arrhenius = scene.replace("\"wlf\"\nc1 = 17.44\nc2 = 51.6", "\"arrhenius\"\nactivation_energy = 8e4");
    alike(&solved(&still(&arrhenius), &[]), &solved(&arrhenius, &[]), 1e-9);
}

/// Layer P with temperatures from 293 K at the base to 303 K at the face, under a flat indenter with 0.5 N/m from a ramp of `RAMP` on:
/// D = N C_0/(H L) times the integral of j(t/a_T(z)) over the depth.
const GRADIENT: &str = r#"
[layer]
width = 1.0
depth = 1.0
cells = [2, 4]
sides = "periodic"
[material]
shear_modulus = 568.498
poisson_ratio = 0.3
arms = [ { weight = 0.579, time = 0.817 } ]
poisson_rule = "constant_ratio"
conductivity = 100.0
heat_capacity = 2e6
shift = "wlf"
c1 = 17.44
c2 = 51.6
reference_temperature = 293.0
temperature = 293.0
[indenter]
profile = "expression"
formula = "0*x"
[contact]
[heat]
initial = 293.0
base = 293.0
coupled = true
convection = { coefficient = 1e9, temperature = 303.0 }
[[phase]]
name = "warm"
duration = 2e5
steps = 16
approach = -1e-9
[[phase]]
name = "load"
duration = 0.01
steps = 4
normal_force = 0.5
[[phase]]
name = "hold"
duration = 2.0
steps = 100
"#;

/// D at the end of [`GRADIENT`], m.
fn gradient() -> f64 {
    const RAMP: f64 = 0.01;
    let (weight, tau, t) = (0.579, 0.817, 2.0 + RAMP);
    let long = 1.0 - weight;
    // j(t) = 1/mu_0 - (1/mu_0 - 1) exp(-mu_0 t/tau), its mean over the ramp.
    let creep = |a: f64| {
        let lambda = a * tau / long;
        let mean = ((-(t - RAMP) / lambda).exp() - (-t / lambda).exp()) * lambda / RAMP;
        1.0 / long - (1.0 / long - 1.0) * mean
    };
    let points = 20_000;
    let at = |i: usize| {
        let warm = 10.0 * (i as f64 + 0.5) / points as f64;
        creep(10f64.powf(-17.44 * warm / (51.6 + warm)))
    };
    0.5 * 5.025_775e-4 * (0..points).map(at).sum::<f64>() / points as f64
}

/// Of second order in the cells, each of which has the times of its middle: 2.7e-4 off with 16 of them, and 7e-5 with 32. The face gets
/// no heat while it is pressed, which 2 s of 2e4 s of diffusion time hardly notice.
#[test]
fn a_gradient_of_temperature_is_the_closed_form() {
    let exact = gradient();
    let errors = [8, 16, 32].map(|rows| {
        let found = solved(GRADIENT, &[&format!("layer.cells=[2, {rows}]")]);
        (found.last("approach") - exact) / exact
    });
    for pair in errors.windows(2) {
        assert!(((pair[0] / pair[1]).log2() - 2.0).abs() < 0.1, "{errors:?}");
    }
    assert!(errors[2].abs() < 1e-4, "{errors:?}");
}

/// What is stored, lost and rubbed away is the work to 1e-3, that of the steps, as well as it is without; and with `arms` what enters the body is what its cells
/// lost: in the plane, on free sides, in space.
#[test]
fn energies_balance() {
    let apart = |outcome: &Outcome| {
        let (left, work) = (outcome.history("energy/imbalance"), outcome.last("energy/external_work"));
        left.iter().fold(0.0_f64, |most, left| most.max(left.abs())) / work
    };
    let cold = apart(&solved(&SCENE, &["heat.coupled=false"]));
    for changes in [
        &["heat.arms=true"][..],
        &["heat.arms=true", "layer.sides=\"free\"", "material.poisson_rule=\"constant_bulk_modulus\""],
        &["heat.arms=true", "layer.width=[0.02, 0.008]", "layer.cells=[10, 4, 3]"],
    ] {
        let outcome = solved(&SCENE, changes);
        assert!(apart(&outcome) < 1e-3, "{}", apart(&outcome));
        let energy = |name: &str| outcome.history(&format!("energy/{name}"));
        let columns = ["heat", "heat_stored", "heat_convected", "heat_conducted"].map(energy);
        let (friction, arms) = (energy("friction_dissipation"), energy("viscoelastic_dissipation"));
        let most = *columns[0].last().unwrap();
        assert!(most > 0.0 && outcome.last("max_temperature") > 294.0);
        for row in 0..friction.len() {
            let [entered, stored, convected, conducted] = [0, 1, 2, 3].map(|i| columns[i][row]);
            assert!((entered - stored - convected - conducted).abs() < 1e-12 * most, "row {row}");
            assert!((entered - friction[row] - arms[row]).abs() < 1e-11 * most, "row {row}");
            assert!(row == 0 || arms[row] >= arms[row - 1], "row {row}");
        }
        if changes.len() == 1 {
            assert!(apart(&outcome) < cold, "{} {cold}", apart(&outcome));
        }
    }
}

/// In space, a profile that does not depend on y warms and shifts what it does in the plane.
#[test]
fn space_is_the_plane() {
    let plane = solved(&SCENE, &[]);
    let space = solved(&SCENE, &["layer.width=[0.02, 0.004]", "layer.cells=[40, 2, 8]"]);
    for name in ["normal_force", "tangential_force", "hysteretic_force", "energy/viscoelastic_dissipation"] {
        for (a, b) in plane.history(name).iter().zip(space.history(name)) {
            let largest = plane.history(name).iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            assert!((a - b / 0.004).abs() < 1e-8 * largest, "{name}: {a} {b}");
        }
    }
}

/// On three ranks as on one, to the last bit.
#[test]
fn ranks_make_no_difference() {
    let with = |ranks| Run::new(&SCENE).ranks(ranks).set("heat.arms=true").set("output.bulk_at=[\"slide\"]").done();
    assert_same(&with(1).file(), &with(3).file(), 0.0);
}

/// A run that is killed goes on with the same bits.
#[test]
fn checkpoints_keep_every_bit() {
    let directory = tempfile::tempdir().unwrap();
    let scene = directory.path().join("scene.toml");
    let adaptive =
        SCENE.replace("steps = 25", "tolerance = 1e-4").replace("coupled = true", "coupled = true\narms = true");
    std::fs::write(&scene, adaptive + "[output]\ncheckpoint_every = 2\n").unwrap();
    let [whole, killed] = ["whole.h5", "killed.h5"].map(|name| directory.path().join(name));
    let command = |out: &Path| {
        let mut command = program(1);
        command.arg("run").arg(&scene).arg("--out").arg(out);
        command
    };
    output_of(&mut command(&whole));
    let mut child = command(&killed).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    wait_for(&mut child, &killed, 8);
    assert_eq!(child.try_wait().unwrap(), None, "ended by itself");
    child.kill().unwrap();
    child.wait().unwrap();
    output_of(command(&killed).arg("--resume"));
    assert_same(&whole, &killed, 0.0);
}

/// Adaptive steps keep the change of ln a_T of a step near a tenth, where the motion alone would let it be more.
#[test]
fn adaptive_steps_follow_the_temperature() {
    let adaptive = SCENE.replace("steps = 25", "tolerance = 0.1").replace("heat_capacity = 2e5", "heat_capacity = 5e4");
    let (coupled, one_way) = (solved(&adaptive, &[]), solved(&adaptive, &["heat.coupled=false"]));
    let log = |t: f64| -17.44 * std::f64::consts::LN_10 * (t - 288.0) / (51.6 + t - 288.0);
    let most = |outcome: &Outcome| {
        let hottest = outcome.history("max_temperature");
        // The first steps of the slide have no rate to go by.
        hottest.windows(2).skip(7).map(|pair| (log(pair[1]) - log(pair[0])).abs()).fold(0.0, f64::max)
    };
    assert!(most(&coupled) < 0.1 && most(&one_way) > 0.4, "{} {}", most(&coupled), most(&one_way));
}

/// The hysteretic friction of a wave against velocity, over the same way: at one temperature it rises threefold with each threefold
/// velocity, below the peak of the loss; where friction warms the rubber and shifts its arms it rises, has its peak near 0.1 m/s and falls
/// (5.7, 8.6 and 7.3 N/m at 0.03, 0.1 and 0.3 m/s).
#[test]
fn friction_rises_and_falls_as_rubber_gets_hot() {
    let parabola = "profile = \"parabola\"\nradius = 0.02\ncentre = 0.01";
    let scene = SCENE
        .replace(parabola, "profile = \"harmonic\"\namplitude = 1e-4\nwavelength = 0.02")
        .replace("cells = [40, 8]", "cells = [20, 6]")
        .replace("coefficient = 0.4", "coefficient = 0.002")
        .replace("convection = { coefficient = 200.0, temperature = 300.0 }\n", "")
        .replace("heat_capacity = 2e5", "heat_capacity = 2e3")
        .replace("young_modulus = 1e7", "young_modulus = 1e8")
        .replace("duration = 0.5\nsteps = 25", "distance = 0.06\nsteps = 60");
    let friction = |velocity: f64, coupled: bool| {
        let changes = [format!("phase.slide.velocity={velocity}"), format!("heat.coupled={coupled}")];
        solved(&scene, &changes.each_ref().map(String::as_str)).last("hysteretic_force")
    };
    let [cold, hot] = [false, true].map(|coupled| [0.01, 0.03, 0.1, 0.3].map(|velocity| friction(velocity, coupled)));
    assert!(cold.windows(2).all(|pair| pair[1] > 2.5 * pair[0]), "{cold:?}");
    assert!(hot[1] > 1.5 * hot[0] && hot[2] > 1.2 * hot[1] && hot[3] < 0.95 * hot[2], "{hot:?}");
}

/// The temperatures and forces of a layer and of the same cells from a Gmsh file, by the same nodes, one way and coupled; the balance
/// closes there, too.
fn on_a_mesh(layer: &str, wide: f64, write: &dyn Fn(&Path)) {
    for coupled in ["heat.coupled=false", "heat.coupled=true"] {
        let changes = [coupled, "layer.sides=\"free\"", "layer.grading=1.0", layer, "heat.arms=true"];
        let changes = [&changes[..], if wide > 0.0 { &["layer.width=[0.02, 0.008]"] } else { &[] }].concat();
        let of_layer = solved(&SCENE, &changes);
        let (_, after) = SCENE.split_once("[material]").unwrap();
        let mesh = format!("[mesh]\nfile = \"body.msh\"\ncontact = \"top\"\nfixed = [\"base\"]\n[material]{after}");
        let run = Run::new(&mesh).set(coupled).set("heat.arms=true");
        write(&run.directory().join("body.msh"));
        let of_mesh = run.done();
        alike(&of_layer, &of_mesh, 1e-8);
        for name in ["max_temperature", "mean_temperature"] {
            for (a, b) in of_layer.history(name).iter().zip(of_mesh.history(name)) {
                assert!((a - b).abs() < 1e-9 * a, "{name}: {a} {b}");
            }
        }
        let columns = ["heat", "heat_stored", "heat_convected", "heat_conducted"]
            .map(|name| of_mesh.last(&format!("energy/{name}")));
        let left = columns[0] - columns[1] - columns[2] - columns[3];
        assert!(columns[0] > 0.0 && left.abs() < 1e-12 * columns[0], "{columns:?}");
    }
}

#[test]
fn a_gmsh_mesh_is_the_layer_in_the_plane() {
    on_a_mesh("layer.cells=[40, 8]", 0.0, &|file| {
        let layer = Layer::in_plane([0.02, 4e-3], [40, 8], Sides::Free);
        write_msh(&layer.mesh(), [40, 8], &["body"], file);
    });
}

#[test]
fn a_gmsh_mesh_is_the_layer_in_space() {
    on_a_mesh("layer.cells=[10, 4, 3]", 0.008, &|file| {
        let surfaces: [Surface<'_>; 2] = [("top", &|node| node[2] == 0.0), ("base", &|node| node[2] == -4e-3)];
        Body::layer([0.02, 0.008, 4e-3], [10, 4, 3]).write(&surfaces, file);
    });
}

/// A face that is too large for a dense compliance in each step is refused, by `check` and by `run`, with the remedy.
#[test]
fn a_large_face_is_refused() {
    for command in ["check", "run"] {
        let directory = tempfile::tempdir().unwrap();
        let scene = directory.path().join("scene.toml");
        std::fs::write(&scene, SCENE.replace("cells = [40, 8]", "cells = [2049, 2]")).unwrap();
        let text = ends_with(program(1).arg(command).arg(&scene), 2);
        let reason = "layer.cells: 2049 nodes of the face, and with heat.coupled = true, which inverts a dense matrix of the face in \
                      each step, at most 2048 are solved for; take fewer cells along the face, or coupled = false";
        assert!(text.contains(reason), "{text}");
    }
}

/// The scene that `check` prints is the scene: it prints the same once more, of whatever temperature the arms were given at.
#[test]
fn what_check_prints_is_the_scene() {
    let directory = tempfile::tempdir().unwrap();
    let [given, resolved] = ["given.toml", "resolved.toml"].map(|name| directory.path().join(name));
    std::fs::write(&given, &**SCENE).unwrap();
    let printed = |file: &Path| output_of(program(1).arg("check").arg(file));
    let keys = |text: &str| -> Vec<String> {
        text.lines().filter(|line| !line.starts_with('#') && !line.starts_with("title")).map(str::to_owned).collect()
    };
    let first = printed(&given);
    std::fs::write(&resolved, &first).unwrap();
    assert!(first.contains("shift = \"wlf\"") && first.contains("reference_temperature = 293.0"), "{first}");
    assert_eq!(keys(&first), keys(&printed(&resolved)));
}
