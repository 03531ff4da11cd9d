//! `mpjr steady` against the oracle, against long transients, and against itself.
//!
//! Layer of 1 m by 1 m, wave of 1 m and 5e-4 m, one arm (0.579, 0.817 s), nu = 0.3, f = 0.2, unless said otherwise.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::f64::consts::TAU;
use std::path::Path;

use common::program::{Outcome, Run, mpjr, names, program};
use mpi::topology::SimpleCommunicator;
use mpjr::composition;
use mpjr::oracle::steady::{Load, Sliding};
use mpjr::oracle::{Harmonic, Layer, PoissonRule, Solid};
use mpjr::output::reader::Results;
use mpjr::scene::{self, Source};
use mpjr::steady::State;
use mpjr::steady::contact::{Contact, Held, Kernel};
use mpjr::steady::spectrum::Spectrum;
use nalgebra::Complex;

const SURFACE: Harmonic = Harmonic { amplitude: 5e-4, wavelength: 1.0 };
const RULES: [PoissonRule; 2] = [PoissonRule::ConstantRatio, PoissonRule::ConstantBulkModulus];
const THREE_ARMS: &str = "[{weight=0.310,time=0.102},{weight=0.226,time=0.545},{weight=0.210,time=4.104}]";

const SCENE: &str = r#"
[layer]
width = 1.0
depth = 1.0
cells = [64, 16]
grading = 4.0
sides = "periodic"
[material]
shear_modulus = 568.498
poisson_ratio = 0.3
arms = [ { weight = 0.579, time = 0.817 } ]
poisson_rule = "constant_ratio"
[indenter]
profile = "harmonic"
amplitude = 5e-4
wavelength = 1.0
[contact]
[friction]
law = "coulomb"
coefficient = 0.2
[[phase]]
name = "press"
duration = 10.0
steps = 20
approach = 1e-3
[[phase]]
name = "slide"
velocity = 0.1
distance = 2.0
steps = 128
"#;

fn off(found: f64, exact: f64) -> f64 {
    (found / exact - 1.0).abs()
}

fn named(rule: PoissonRule) -> &'static str {
    if rule == PoissonRule::ConstantRatio { "constant_ratio" } else { "constant_bulk_modulus" }
}

/// The steady states of a scene with changes.
fn states(changes: &[String], velocities: &[f64]) -> Vec<State> {
    let scene = scene::read(SCENE, &Source { file: "scene.toml".into(), overrides: changes.to_vec() }).unwrap();
    let mut sliding = composition::steady(&SimpleCommunicator::self_comm(), &scene, Path::new("scene.toml")).unwrap();
    sliding.states(velocities).unwrap()
}

/// `mpjr steady scene.toml ARGUMENTS`.
fn steady(ranks: usize, arguments: &[&str]) -> Outcome {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("scene.toml"), SCENE).unwrap();
    let output = program(ranks).current_dir(&directory).args(["steady", "scene.toml"]).args(arguments).output().unwrap();
    Outcome::new(output, directory)
}

/// With the oracle's kernel in place of the cells' the contact is the oracle's, 1e-8 of the highest pressure and of what is not held:
/// both rules, rigid and with a penalty, under an approach and under a force, one velocity from the one before.
#[test]
fn the_oracles_kernel_gives_the_oracles_contact() {
    const NODES: usize = 128;
    let spectrum = Spectrum::new(NODES);
    let spacing = 1.0 / NODES as f64;
    let elevation: Vec<f64> = (0..NODES).map(|i| SURFACE.at(spacing * i as f64).0).collect();
    for (rule, softness, load) in [
        (RULES[0], 0.0, Load::Approach(1e-3)),
        (RULES[1], 0.0, Load::Approach(1e-3)),
        (RULES[0], 1e-6, Load::Approach(1e-3)),
        (RULES[1], 1e-6, Load::MeanPressure(0.5)),
    ] {
        let mut last = None;
        for velocity in [1e-3, 2.154e-2, 0.1, 1.0, 30.0] {
            let solid = Solid { shear: 568.498, poisson: 0.3, rule, arms: vec![(0.579, 0.817)] };
            let sliding = Sliding { layer: Layer { depth: 1.0 }, solid, width: 1.0, velocity, friction: 0.2, softness };
            let exact = sliding.solve(NODES, |x| SURFACE.at(x), load).unwrap();
            let compliance = |wave: usize| {
                let k = TAU * wave as f64;
                sliding.layer.compliance(k, sliding.solid.moduli(-k * velocity))
            };
            let kernel = Kernel {
                normal: (0..=NODES / 2).map(|wave| compliance(wave).zz).collect(),
                shear: (0..=NODES / 2).map(|wave| -Complex::<f64>::i() * compliance(wave).xz).collect(),
            };
            let held = match load {
                Load::Approach(approach) => Held::Approach(approach),
                Load::MeanPressure(mean) => Held::Force(mean),
            };
            let (spectrum, kernel) = (&spectrum, &kernel);
            let shear = |p: f64| [0.2 * p, 0.2];
            let contact = Contact { spectrum, kernel, softness, elevation: &elevation, spacing, shear: &shear, held };
            let found = contact.solve(last.as_ref()).unwrap();
            let highest = exact.pressure.iter().fold(0.0, |most: f64, p| most.max(*p));
            let apart = found.pressure.iter().zip(&exact.pressure).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!("{rule:?} {softness} v {velocity}: {:.1e} {:.1e}", apart / highest, off(found.approach, exact.approach));
            assert!(apart < 1e-8 * highest && off(found.approach, exact.approach) < 1e-8, "{rule:?} v {velocity}");
            last = Some(found);
        }
    }
}

/// The independent table "fully slipping steady state, partial contact" (512 nodes in Fourier space), on 128 cells four times as fine
/// at the face: N within 2e-4, the hysteretic ratio within 4e-3 of it, and N for a constant bulk modulus within its three digits.
#[test]
fn the_table_of_steady_states() {
    let cells = |rule: PoissonRule| {
        [String::from("layer.cells=[128,128]"), format!("material.poisson_rule=\"{}\"", named(rule))]
    };
    let velocities = [1e-9, 2.154e-2, 0.1, 1.0, 1e9];
    let ratio = states(&cells(RULES[0]), &velocities);
    let bulk = states(&cells(RULES[1]), &velocities);
    let normal = [0.49498, 0.49754, 0.53513, 0.59554, 0.59715];
    let hysteretic = [-1.138, 2.195, 6.839, 0.583, -1.017];
    for (i, velocity) in velocities.into_iter().enumerate() {
        let found = [ratio[i].normal_force, 1e4 * ratio[i].hysteretic_force / ratio[i].normal_force, bulk[i].normal_force];
        println!("v {velocity}: {found:?}");
        assert!(off(found[0], normal[i]) < 2e-4 && off(found[1], hysteretic[i]) < 4e-3, "v {velocity}: {found:?}");
        assert!((found[2] - [0.829, 0.833, 0.884, 0.969, 0.971][i]).abs() < 1e-3, "v {velocity}: {found:?}");
        assert!(off(ratio[i].tangential_force, 0.2 * ratio[i].normal_force) < 1e-14);
    }
}

/// What the indenter puts in through the slope of a frictionless profile in full contact is what the arms take, to round-off; at
/// each velocity the arm takes most whose time is nearest to the wave's.
#[test]
fn the_arms_take_the_work_of_the_indenter() {
    for rule in RULES {
        let changes = [
            "friction=".into(),
            "phase.press.approach=8e-3".into(),
            format!("material.arms={THREE_ARMS}"),
            format!("material.poisson_rule=\"{}\"", named(rule)),
        ];
        for (velocity, busiest) in [(2e-3, 2), (0.25, 1), (20.0, 0)] {
            let state = &states(&changes, &[velocity])[0];
            let taken = state.arm_dissipation.iter().sum::<f64>();
            assert_eq!(state.contact_fraction, 1.0);
            println!("{rule:?} v {velocity}: {:?}, off {:.1e}", state.arm_dissipation, off(taken, state.hysteretic_force * velocity));
            assert!(off(taken, state.hysteretic_force * velocity) < 1e-10, "{rule:?} v {velocity}");
            let most = state.arm_dissipation.iter().fold(0.0, |most: f64, power| most.max(*power));
            if velocity != 0.25 {
                assert_eq!(state.arm_dissipation[busiest], most, "{rule:?} v {velocity}");
            }
        }
    }
}

/// Long transients on the same cells end in the steady state, averaged over the steps that pass one node spacing: three arms, both rules,
/// friction, five velocities; a coefficient that falls with the pressure; a held load. Eight steps to a spacing leave an error of
/// second order in the step.
#[test]
fn long_transients_end_in_the_steady_state() {
    let arms = format!("material.arms={THREE_ARMS}");
    let mut cases: Vec<(Vec<String>, f64)> = Vec::new();
    for rule in RULES {
        let rule = format!("material.poisson_rule=\"{}\"", named(rule));
        cases.extend([3e-3, 1e-2, 3e-2, 0.1, 0.3].map(|velocity| (vec![arms.clone(), rule.clone()], velocity)));
    }
    cases.push((vec!["friction.coefficient=0.1 + 0.3*exp(-p)".into()], 0.1));
    cases.push((vec!["phase.press.approach=".into(), "phase.press.normal_force=0.5".into()], 0.1));
    for (changes, velocity) in cases {
        // 20 times the longest relaxation time that there is, and half a wave at least.
        let longest = if changes[0] == arms { 4.104 } else { 0.817 };
        let spacings = (velocity * 20.0 * longest * 64.0).max(32.0).ceil();
        let per_spacing = 8;
        let mut run = Run::new(SCENE);
        for change in &changes {
            run = run.set(change.clone());
        }
        let outcome = run
            .set(format!("phase.slide.velocity={velocity}"))
            .set(format!("phase.slide.distance={}", spacings / 64.0))
            .set(format!("phase.slide.steps={}", spacings as usize * per_spacing))
            .set("output.interface_every=0")
            .set("output.energy=false")
            .done();
        let mean = |column: &str| {
            let values = outcome.history(column);
            values.iter().rev().take(per_spacing).sum::<f64>() / per_spacing as f64
        };
        let steady = &states(&changes, &[velocity])[0];
        let found = [
            off(mean("normal_force"), steady.normal_force),
            off(mean("tangential_force"), steady.tangential_force),
            off(mean("hysteretic_force"), steady.hysteretic_force),
            off(mean("approach"), steady.approach),
        ];
        println!("{changes:?} v {velocity}: {found:.1e?}");
        assert!(found[0] < 1e-4 && found[1] < 1e-4 && found[2] < 5e-3 && found[3] < 1e-4, "{changes:?} v {velocity}: {found:?}");
    }
}

/// The other way round everything is mirrored.
#[test]
fn sliding_to_the_left_is_sliding_to_the_right_in_a_mirror() {
    let (right, left) = (&states(&[], &[0.1])[0], &states(&[], &[-0.1])[0]);
    assert!(off(left.normal_force, right.normal_force) < 1e-10);
    assert!(off(left.tangential_force, -right.tangential_force) < 1e-10);
    assert!(off(left.hysteretic_force, -right.hysteretic_force) < 1e-7);
    assert!(left.arm_dissipation[0] > 0.0 && off(left.arm_dissipation[0], right.arm_dissipation[0]) < 1e-8);
}

/// The file has what the reference says, with scales; on three ranks it is the same to round-off; without --velocities it has the last
/// phase's alone, and `plot` draws what there is.
#[test]
fn the_file_is_whole_on_any_ranks() {
    let ladder = ["--velocities", "1e-3:1e1:3", "--out", "curve.h5"];
    let [one, three] = [1, 3].map(|ranks| steady(ranks, &ladder));
    for outcome in [&one, &three] {
        assert_eq!(outcome.code, 0, "{}", outcome.stderr);
        outcome.assert_clean();
    }
    let [one_file, other] = [&one, &three].map(|outcome| Results::open(&outcome.directory.path().join("curve.h5")).unwrap());
    for (name, columns) in [
        ("velocity", 1),
        ("approach", 1),
        ("normal_force", 1),
        ("tangential_force", 1),
        ("hysteretic_force", 1),
        ("contact_fraction", 1),
        ("arm_dissipation", 1),
        ("pressure", 64),
        ("shear", 64),
        ("gap", 64),
    ] {
        let (a, b) = (one_file.steady(name).unwrap(), other.steady(name).unwrap());
        assert_eq!((a.rows, a.columns), (13, columns), "{name}");
        let size = a.values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        let apart = a.values.iter().zip(&b.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart <= 1e-9 * size, "{name}: {apart}");
    }
    assert_eq!(one_file.text("status").unwrap(), "complete");
    assert_eq!(one_file.interface("x").unwrap().rows, 64);
    let drawn = program(1).current_dir(&one.directory).args(["plot", "curve.h5"]).output().unwrap();
    assert!(drawn.status.success(), "{}", String::from_utf8_lossy(&drawn.stderr));
    let drawn = names(one.directory.path());
    for figure in ["friction", "dissipation", "steady"] {
        assert!(drawn.contains(&format!("curve-{figure}.png")) && drawn.contains(&format!("curve-{figure}.svg")));
    }
    let single = steady(1, &[]);
    assert_eq!(single.results().steady("velocity").unwrap().values, [0.1]);
    let refused = program(1).current_dir(&single.directory).args(["plot", "scene.h5", "friction"]).output().unwrap();
    assert!(String::from_utf8_lossy(&refused.stderr).contains("several velocities"));
}

/// What cannot be done is said, with its key, and nothing is written.
#[test]
fn what_is_never_steady_is_refused() {
    for (change, message) in [
        ("layer.sides=free", "layer.sides: mpjr steady takes \"periodic\" sides"),
        ("phase.slide.velocity=0", "phase.slide.velocity: the last phase has none"),
        ("friction.coefficient=0.2 + s", "friction.coefficient: mpjr steady takes no s"),
        ("material.arms.0.weight=1", "material.arms: mpjr steady needs weights that sum to less than 1"),
        ("phase.press.approach=0", "phase.slide.approach: mpjr steady reaches the layer above 0e0 m"),
    ] {
        let mut arguments = vec!["--set", change];
        if change.starts_with("phase.slide.velocity") {
            arguments.extend(["--set", "phase.slide.distance=", "--set", "phase.slide.duration=1"]);
        }
        let outcome = steady(1, &arguments);
        assert_eq!(outcome.code, 2, "{change}: {}", outcome.stderr);
        outcome.assert_single_message(message);
        assert_eq!(names(outcome.directory.path()), ["scene.toml"]);
    }
    let outcome = steady(1, &["--velocities", "1:0.1:3"]);
    assert!(outcome.code == 2 && outcome.stderr.contains("FROM:TO:PER_DECADE"), "{}", outcome.stderr);
    let other = tempfile::tempdir().unwrap();
    let path = other.path().join("notes.h5");
    std::fs::write(&path, "mine").unwrap();
    let outcome = steady(1, &["--out", path.to_str().unwrap()]);
    assert_eq!(outcome.code, 4);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
    assert_eq!(mpjr(1, &["steady", "absent.toml"]).code, 4);
}
