//! `mpjr steady` against the oracle, against long transients, and against itself.
//!
//! Layer of 1 m by 1 m, wave of 1 m and 5e-4 m, one arm (0.579, 0.817 s), nu = 0.3, f = 0.2, unless said otherwise.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::f64::consts::TAU;
use std::path::Path;

use common::mpi::Case;
use mpi::topology::SimpleCommunicator;
use mpjr::composition;
use mpjr::oracle::steady::{Load, Sliding};
use mpjr::oracle::{Harmonic, Layer, PoissonRule, Solid};
use mpjr::output::HistoryRow;
use mpjr::scene::{self, Source};
use mpjr::solution;
use mpjr::steady::State;
use mpjr::steady::contact::{Contact, Held, Kernel};
use mpjr::steady::spectrum::Spectrum;
use nalgebra::Complex;

const CASES: &[Case] = &[
    Case::new("the_oracles_kernel_gives_the_oracles_contact", &[1], |_, _| {
        the_oracles_kernel_gives_the_oracles_contact()
    }),
    Case::new("the_table_of_steady_states", &[1], |_, _| the_table_of_steady_states()),
    Case::new("the_arms_take_the_work_of_the_indenter", &[1], |_, _| the_arms_take_the_work_of_the_indenter()),
    Case::new("long_transients_end_in_the_steady_state", &[1], |_, _| long_transients_end_in_the_steady_state()),
    Case::new("long_transients_under_a_load_end_in_the_steady_state", &[1], |_, _| {
        long_transients_under_a_load_end_in_the_steady_state()
    }),
    Case::new("sliding_to_the_left_is_sliding_to_the_right_in_a_mirror", &[1], |_, _| {
        sliding_to_the_left_is_sliding_to_the_right_in_a_mirror()
    }),
];

fn main() {
    common::mpi::main(CASES);
}

const SURFACE: Harmonic = Harmonic { amplitude: 5e-4, wavelength: 1.0 };
const RULES: [PoissonRule; 2] = [PoissonRule::ConstantRatio, PoissonRule::ConstantBulkModulus];
const VELOCITIES: [f64; 5] = [3e-3, 1e-2, 3e-2, 0.1, 0.3];
const THREE_ARMS: &str = "[{weight=0.310,time=0.102},{weight=0.226,time=0.545},{weight=0.210,time=4.104}]";

const SCENE: &str = include_str!("scenes/steady.toml");

fn off(found: f64, exact: f64) -> f64 {
    (found / exact - 1.0).abs()
}

fn named(rule: PoissonRule) -> &'static str {
    if rule == PoissonRule::ConstantRatio { "constant_ratio" } else { "constant_bulk_modulus" }
}

/// The steady states of a scene with changes.
fn states(changes: &[String], velocities: &[f64]) -> Vec<State> {
    let scene = scene::read(SCENE, &Source { file: "scene.toml".into(), overrides: changes.to_vec() }).unwrap();
    let heading = composition::heading(&scene, None).unwrap();
    let world = SimpleCommunicator::self_comm();
    let mut sliding = composition::steady(&world, &scene, Path::new("scene.toml"), heading).unwrap();
    sliding.states(velocities).unwrap()
}

/// With the oracle's kernel in place of the cells' the contact is the oracle's, 1e-8 of the highest pressure and of what is not held:
/// both rules, rigid and with a penalty, under an approach and under a force, one velocity from the one before.
fn the_oracles_kernel_gives_the_oracles_contact() {
    const NODES: usize = 128;
    let spectrum = Spectrum::new(&[NODES]);
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
            let contact =
                Contact { spectrum, kernel, softness, elevation: &elevation, area: spacing, shear: &shear, held };
            let found = contact.solve(last.as_ref()).unwrap();
            let highest = exact.pressure.iter().fold(0.0, |most: f64, p| most.max(*p));
            let apart = found.pressure.iter().zip(&exact.pressure).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!(
                "{rule:?} {softness} v {velocity}: {:.1e} {:.1e}",
                apart / highest,
                off(found.approach, exact.approach)
            );
            assert!(apart < 1e-8 * highest && off(found.approach, exact.approach) < 1e-8, "{rule:?} v {velocity}");
            last = Some(found);
        }
    }
}

/// The independent table "fully slipping steady state, partial contact" (512 nodes in Fourier space), on 128 cells four times as fine
/// at the face: N within 2e-4, the hysteretic ratio within 4e-3 of it, and N for a constant bulk modulus within its three digits.
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
        let found =
            [ratio[i].normal_force, 1e4 * ratio[i].hysteretic_force / ratio[i].normal_force, bulk[i].normal_force];
        println!("v {velocity}: {found:?}");
        assert!(off(found[0], normal[i]) < 2e-4 && off(found[1], hysteretic[i]) < 4e-3, "v {velocity}: {found:?}");
        assert!((found[2] - [0.829, 0.833, 0.884, 0.969, 0.971][i]).abs() < 1e-3, "v {velocity}: {found:?}");
        assert!(off(ratio[i].tangential_force, 0.2 * ratio[i].normal_force) < 1e-14);
    }
}

/// What the indenter puts in through the slope of a frictionless profile in full contact is what the arms take, to round-off; at
/// each velocity the arm takes most whose time is nearest to the wave's.
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
            println!(
                "{rule:?} v {velocity}: {:?}, off {:.1e}",
                state.arm_dissipation,
                off(taken, state.hysteretic_force * velocity)
            );
            assert!(off(taken, state.hysteretic_force * velocity) < 1e-10, "{rule:?} v {velocity}");
            let most = state.arm_dissipation.iter().fold(0.0, |most: f64, power| most.max(*power));
            if velocity != 0.25 {
                assert_eq!(state.arm_dissipation[busiest], most, "{rule:?} v {velocity}");
            }
        }
    }
}

/// N, Q, the hysteretic force and the approach of a long transient, averaged over the steps that pass the last node spacing, of which there
/// are so many; and of the spacing before that. It slides for so many times the longest relaxation time, and half a wave at least.
fn transient(changes: &[String], (velocity, nodes): (f64, u32), (times, per_spacing): (f64, usize)) -> [[f64; 4]; 2] {
    let longest = if changes.iter().any(|change| change.contains(THREE_ARMS)) { 4.104 } else { 0.817 };
    let nodes = f64::from(nodes);
    let spacings = (velocity * times * longest * nodes).max(nodes / 2.0).ceil();
    let mut all = changes.to_vec();
    all.extend([
        format!("phase.slide.velocity={velocity}"),
        format!("phase.slide.distance={}", spacings / nodes),
        format!("phase.slide.steps={}", spacings as usize * per_spacing),
        "output.energy=false".to_owned(),
    ]);
    let scene = scene::read(SCENE, &Source { file: "scene.toml".into(), overrides: all }).unwrap();
    let solved = solution::solve(&SimpleCommunicator::self_comm(), &scene).unwrap();
    [0, per_spacing].map(|skipped| {
        let mean = |column: fn(&HistoryRow) -> f64| {
            let rows = solved.history.iter().rev().skip(skipped).take(per_spacing);
            rows.map(column).sum::<f64>() / per_spacing as f64
        };
        [
            mean(|row| row.normal_force),
            mean(|row| row.tangential_force),
            mean(|row| row.hysteretic_force),
            mean(|row| row.approach),
        ]
    })
}

/// The same of the steady states, which have the crest on a node, at eight places of it between two nodes.
fn between_nodes(changes: &[String], (velocity, nodes): (f64, u32)) -> [f64; 4] {
    const PLACES: u32 = 8;
    let mut mean = [0.0; 4];
    for place in 0..PLACES {
        let x = f64::from(place) / f64::from(PLACES * nodes);
        let formula = format!("indenter={{ profile = \"expression\", formula = \"5e-4*(1-cos(2*pi*(x-{x:?})))\" }}");
        let state = states(&[changes, &[formula]].concat(), &[velocity]).remove(0);
        let found = [state.normal_force, state.tangential_force, state.hysteretic_force, state.approach];
        mean.iter_mut().zip(found).for_each(|(mean, found)| *mean += found / f64::from(PLACES));
    }
    mean
}

/// How far apart they are, of each; the hysteretic force, far smaller than the load, as a share of that.
fn apart(found: [f64; 4], exact: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|i| (found[i] - exact[i]).abs() / exact[if i == 2 { 0 } else { i }].abs())
}

/// Long transients on the same cells end in the steady state, averaged over the steps that pass one node spacing: three arms, both rules,
/// friction, five velocities; a coefficient that falls with the pressure. With the mean of the steady states at eight places of the crest
/// between two nodes, N, Q and the approach agree to 2e-5, the hysteretic force to 1e-6 of the load.
fn long_transients_end_in_the_steady_state() {
    let arms = format!("material.arms={THREE_ARMS}");
    let mut cases: Vec<(Vec<String>, f64)> = Vec::new();
    for rule in RULES {
        let rule = format!("material.poisson_rule=\"{}\"", named(rule));
        cases.extend(VELOCITIES.map(|velocity| (vec![arms.clone(), rule.clone()], velocity)));
    }
    cases.push((vec!["friction.coefficient=0.1 + 0.3*exp(-p)".into()], 0.1));
    for (changes, velocity) in cases {
        let [end, _] = transient(&changes, (velocity, 64), (20.0, 8));
        let apart = apart(end, between_nodes(&changes, (velocity, 64)));
        println!("{changes:?} v {velocity}: {apart:?}");
        assert!(apart[2] < 1e-6 && apart.iter().all(|apart| *apart < 2e-5), "{changes:?} v {velocity}: {apart:?}");
    }
}

/// The same under a held load: three arms, friction, both rules of Poisson's ratio and both of the memory at each of five velocities, on 32
/// nodes. Under a load the layer creeps, for longer than its arms relax: 24 times that, 13 times the longest time of the creep. The memory by
/// backward Euler is of first order in the step: from 8 and 16 steps a spacing it is extrapolated to none. N and Q are those of the load, the
/// hysteretic force agrees to 1e-6 of that, the approach to 5e-5, or to what it drifts by from one spacing to the next where that is more.
fn long_transients_under_a_load_end_in_the_steady_state() {
    for (rule, velocity) in RULES.into_iter().flat_map(|rule| VELOCITIES.map(|velocity| (rule, velocity))) {
        let changes = [
            format!("material.arms={THREE_ARMS}"),
            format!("material.poisson_rule=\"{}\"", named(rule)),
            "phase.press.approach=".into(),
            "phase.press.normal_force=0.5".into(),
            "layer.cells=[32,8]".into(),
        ];
        let steady = between_nodes(&changes, (velocity, 32));
        for memory in ["exponential", "backward_euler"] {
            let changes = [&changes[..], &[format!("material.memory={memory}")]].concat();
            let by = |per_spacing| transient(&changes, (velocity, 32), (24.0, per_spacing));
            let ends = match memory {
                "exponential" => by(8),
                _ => {
                    let (coarse, fine) = (by(8), by(16));
                    std::array::from_fn(|end| std::array::from_fn(|i| 2.0 * fine[end][i] - coarse[end][i]))
                }
            };
            let (apart, drift) = (apart(ends[0], steady), apart(ends[0], ends[1]));
            println!("{rule:?} {memory} v {velocity}: {apart:?}, drift {drift:?}");
            let told = format!("{rule:?} {memory} v {velocity}: {apart:?} {drift:?}");
            assert!(apart[0] < 1e-12 && apart[1] < 1e-12 && apart[2] < 1e-6, "{told}");
            assert!(apart[3] < drift[3].max(5e-5), "{told}");
        }
    }
}

/// The other way round everything is mirrored.
fn sliding_to_the_left_is_sliding_to_the_right_in_a_mirror() {
    let (right, left) = (&states(&[], &[0.1])[0], &states(&[], &[-0.1])[0]);
    assert!(off(left.normal_force, right.normal_force) < 1e-10);
    assert!(off(left.tangential_force, -right.tangential_force) < 1e-10);
    assert!(off(left.hysteretic_force, -right.hysteretic_force) < 1e-7);
    assert!(left.arm_dissipation[0] > 0.0 && off(left.arm_dissipation[0], right.arm_dissipation[0]) < 1e-8);
}
