//! `mpjr steady` in space: against the plane, against closed forms of waves, and against long transients.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::f64::consts::TAU;
use std::path::Path;

use common::compare::difference;
use common::mpi::Case;
use mpi::topology::SimpleCommunicator;
use mpjr::composition;
use mpjr::oracle::{Layer, PoissonRule, Solid};
use mpjr::output::HistoryRow;
use mpjr::scene::{self, Source};
use mpjr::solution;
use mpjr::steady::State;
use nalgebra::Vector2;

const CASES: &[Case] = &[
    Case::new("the_same_for_every_y_is_the_plane", &[1], |_, _| the_same_for_every_y_is_the_plane()),
    Case::new("along_y_is_along_x_turned", &[1], |_, _| along_y_is_along_x_turned()),
    Case::new("each_wave_answers_at_its_own_frequency", &[1], |_, _| each_wave_answers_at_its_own_frequency()),
    Case::new("long_transients_end_in_the_steady_state", &[1], |_, _| long_transients_end_in_the_steady_state()),
];

fn main() {
    common::mpi::main(CASES);
}

const SCENE: &str = include_str!("scenes/steady.toml");
const THREE_ARMS: &str =
    "material.arms=[{weight=0.310,time=0.102},{weight=0.226,time=0.545},{weight=0.210,time=4.104}]";

/// The steady states of a scene with changes; with a direction in degrees, or that of its last phase.
fn states(changes: &[&str], velocities: &[f64], direction: Option<f64>) -> Vec<State> {
    let overrides = changes.iter().map(|change| (*change).to_owned()).collect();
    let scene = scene::read(SCENE, &Source { file: "scene.toml".into(), overrides }).unwrap();
    let heading = composition::heading(&scene, direction).unwrap();
    let world = SimpleCommunicator::self_comm();
    let mut sliding = composition::steady(&world, &scene, Path::new("scene.toml"), heading).unwrap();
    assert!((sliding.heading.norm() - 1.0).abs() < 1e-15);
    sliding.states(velocities).unwrap()
}

fn off(found: f64, exact: f64) -> f64 {
    (found / exact - 1.0).abs()
}

/// Where nothing depends on y, states of the plane, node by node to 1e-9: both rules, with an approach or a force held, with a
/// coefficient that falls with the pressure, at velocities from rest to the glassy end.
fn the_same_for_every_y_is_the_plane() {
    let wide = ["layer.width=[1.0,0.3]", "layer.cells=[64,4,16]"];
    let force = |newton: &str| format!("phase.press.normal_force={newton}");
    for (changes, forces) in [
        (vec!["material.poisson_rule=constant_ratio"], None),
        (vec!["material.poisson_rule=constant_bulk_modulus", THREE_ARMS], None),
        (vec!["friction.coefficient=0.1 + 0.3*exp(-p)", "phase.press.approach="], Some(["0.5", "0.15"])),
    ] {
        let list = |more: &[&'static str], which: usize| {
            let forces = forces.map(|forces| force(forces[which]));
            changes.iter().chain(more).map(|change| (*change).to_owned()).chain(forces).collect::<Vec<String>>()
        };
        let (plane, space) = (list(&[], 0), list(&wide, 1));
        let velocities = [1e-3, 2e-2, 0.3, 10.0];
        let of = |list: &[String]| states(&list.iter().map(String::as_str).collect::<Vec<_>>(), &velocities, None);
        for (flat, solid) in of(&plane).iter().zip(of(&space)) {
            let forces = |state: &State, width: f64| {
                [state.normal_force, state.tangential_force, state.hysteretic_force].map(|force| force / width)
            };
            let [n, q, h] = forces(&solid, 0.3);
            let [plane_n, plane_q, plane_h] = forces(flat, 1.0);
            let found =
                [off(n, plane_n), off(q, plane_q), (h - plane_h).abs() / plane_n, off(solid.approach, flat.approach)];
            assert!(found.iter().all(|off| *off < 1e-9), "{changes:?} v {}: {found:?}", flat.velocity);
            assert!(solid.across.iter().all(|force| force.abs() < 1e-12 * n), "{:?}", solid.across);
            let power: Vec<f64> = solid.arm_dissipation.iter().map(|power| power / 0.3).collect();
            assert!(difference(&power, &flat.arm_dissipation) < 1e-7);
            let every = |values: &[f64]| values.iter().flat_map(|value| [*value; 4]).collect::<Vec<f64>>();
            assert!(difference(&solid.pressure, &every(&flat.pressure)) < 1e-9, "{changes:?} v {}", flat.velocity);
            assert!(difference(&solid.gap, &every(&flat.gap)) < 1e-9);
            let [along, across] =
                [0, 1].map(|axis| solid.shear.iter().skip(axis).step_by(2).copied().collect::<Vec<f64>>());
            assert!(difference(&along, &every(&flat.shear)) < 1e-9 && across.iter().all(|q| *q == 0.0));
        }
    }
}

/// What slides along y over a surface is what slides along x over the surface turned by a quarter.
fn along_y_is_along_x_turned() {
    let bumps = |x: &str, y: &str| {
        format!(
            "indenter={{ profile = \"expression\", formula = \"4e-4*(1-cos(2*pi*{x})) + 2e-4*(1-cos(4*pi*{y}+sin(2*pi*{x})))\" }}"
        )
    };
    let layer = ["layer.width=[1.0,1.0]", "layer.cells=[24,24,8]", "phase.press.approach=6e-4"];
    let with = |formula: &String, direction: f64| {
        let changes: Vec<&str> = layer.iter().copied().chain([formula.as_str()]).collect();
        states(&changes, &[0.1], Some(direction)).remove(0)
    };
    let (x, y) = (with(&bumps("x", "y"), 0.0), with(&bumps("y", "x"), 90.0));
    for (one, other) in [
        (x.normal_force, y.normal_force),
        (x.tangential_force, y.across[0]),
        (x.hysteretic_force, y.across[1]),
        (x.across[1], y.hysteretic_force),
        (x.approach, y.approach),
    ] {
        assert!((one - other).abs() < 1e-9 * x.normal_force, "{one:e} {other:e}");
    }
    assert!(x.contact_fraction > 0.05 && x.contact_fraction < 0.95);
    assert!((x.contact_fraction - y.contact_fraction).abs() < 1e-12);
    assert!(x.hysteretic_force > 0.0 && x.tangential_force > 0.0 && y.tangential_force == 0.0);
}

/// Full contact of waves without friction is linear: a wave of number vector k and height a, pressed flat, has a mean force of
/// k a^2/2 Im g(k.v)/C(|k|) along x and y, with g = G*/G and C the elastic compliance. Against the kernel of the layer itself the cells are
/// off by less than 3 %, in ratios of velocities and directions by 1e-9. What the arms take is what the indenter does.
fn each_wave_answers_at_its_own_frequency() {
    let (weight, time) = (0.579, 0.817);
    let loss = |w: f64| weight * w * time / (1.0 + (w * time).powi(2));
    let solid = Solid { shear: 568.498, poisson: 0.3, rule: PoissonRule::ConstantRatio, arms: vec![] };
    let elastic = |k: f64| Layer { depth: 1.0 }.compliance(k, solid.moduli(0.0)).zz.re;
    let layer = ["layer.width=[1.0,1.0]", "layer.cells=[32,32,16]", "friction=", "phase.press.approach=2e-2"];
    let hysteretic = |formula: &str, speed: f64, direction: f64| {
        let formula = format!("indenter={{ profile = \"expression\", formula = \"{formula}\" }}");
        let changes: Vec<&str> = layer.iter().copied().chain([formula.as_str()]).collect();
        let state = states(&changes, &[speed], Some(direction)).remove(0);
        assert_eq!(state.contact_fraction, 1.0);
        let force = Vector2::new(state.hysteretic_force, state.across[1]);
        let velocity = Vector2::new(direction.to_radians().cos(), direction.to_radians().sin()) * speed;
        let taken = state.arm_dissipation.iter().sum::<f64>();
        assert!(off(taken, force.dot(&velocity)) < 1e-9, "{formula}: {taken} {}", force.dot(&velocity));
        (force, velocity)
    };
    let (a, b) = (5e-4, 3e-4);
    // Each of two waves along x and y has a velocity of its own.
    let sum = format!("{a}*(1-cos(2*pi*x)) + {b}*(1-cos(4*pi*y))");
    let mut constants = Vec::new();
    for (speed, direction) in [(0.1, 30.0), (1.0, 30.0), (0.3, 75.0), (0.02, -40.0)] {
        let (force, velocity) = hysteretic(&sum, speed, direction);
        let shares =
            [(TAU, a, velocity.x, force.x), (2.0 * TAU, b, velocity.y, force.y)].map(|(k, height, v, force)| {
                let exact = 0.5 * k * height * height * loss(k * v) / elastic(k);
                force / exact
            });
        println!("{speed} m/s at {direction} degrees: {shares:?}");
        assert!(shares.iter().all(|share| (share - 1.0).abs() < 3e-2), "{shares:?}");
        constants.push(shares);
    }
    for shares in &constants {
        assert!((0..2).all(|wave| off(shares[wave], constants[0][wave]) < 1e-9), "{constants:?}");
    }
    // A product is two waves, at k.v each: (k, l) and (k, -l).
    let (speed, direction) = (0.25, 20.0);
    let (force, velocity) = hysteretic(&format!("{a}*(1-cos(2*pi*x)*cos(4*pi*y))"), speed, direction);
    let (k, l) = (TAU, 2.0 * TAU);
    let of = |sign: f64| 0.5 * (0.5 * a).powi(2) * loss(k * velocity.x + sign * l * velocity.y) / elastic(k.hypot(l));
    let (plus, minus) = (of(1.0), of(-1.0));
    let exact = Vector2::new(k * (plus + minus), l * (plus - minus));
    println!("product: {force:?} {exact:?}");
    // Both are of one length: what is left of the cells' error is one factor.
    let factor = force.x / exact.x;
    assert!((factor - 1.0).abs() < 3e-2 && off(force.y / exact.y, factor) < 1e-9, "{factor} {}", force.y / exact.y);
}

/// Long transients on the same cells end in the steady state, averaged over the steps that pass one node spacing: along x, and along a
/// diagonal of the cells, with friction and partial contact, with an approach or a force held, one way of relaxing or two. With the mean of
/// the steady states at eight places between two nodes.
fn long_transients_end_in_the_steady_state() {
    const CELLS: usize = 16;
    const PLACES: usize = 8;
    let surface = |x: f64, y: f64| {
        format!(
            "indenter={{ profile = \"expression\", formula = \"3e-4*(1-cos(2*pi*(x-{x:?}))) + 2e-4*(1-cos(2*pi*(y-{y:?})))\" }}"
        )
    };
    let layer = ["layer.width=[1.0,1.0]", "layer.cells=[16,16,6]", "phase.press.approach=5e-4"];
    let bulk = "material.poisson_rule=constant_bulk_modulus";
    for (more, velocity, force) in [
        (vec![], [0.1_f64, 0.0], None),
        (vec![bulk], [0.1, 0.1], None),
        (vec![], [0.1, -0.1], Some("phase.press.normal_force=0.2")),
    ] {
        let mut changes: Vec<&str> = layer.iter().copied().chain(more).collect();
        if let Some(force) = force {
            changes.extend(["phase.press.approach=", force]);
        }
        let speed = velocity[0].hypot(velocity[1]);
        // Twenty relaxation times.
        let spacings = (0.1 * 20.0 * 0.817 * CELLS as f64).ceil();
        let path = [
            format!("phase.slide.velocity=[{:?},{:?}]", velocity[0], velocity[1]),
            format!("phase.slide.distance={:?}", spacings / CELLS as f64 * speed / 0.1),
            format!("phase.slide.steps={}", spacings as usize * PLACES),
            surface(0.0, 0.0),
        ];
        let all: Vec<String> = changes.iter().map(|change| (*change).to_owned()).chain(path).collect();
        let scene = scene::read(SCENE, &Source { file: "scene.toml".into(), overrides: all }).unwrap();
        let solved = solution::solve(&SimpleCommunicator::self_comm(), &scene).unwrap();
        let mean = |column: fn(&HistoryRow) -> f64| {
            solved.history.iter().rev().take(PLACES).map(column).sum::<f64>() / PLACES as f64
        };
        let direction = Some(velocity[1].atan2(velocity[0]).to_degrees());
        let placed: Vec<State> = (0..PLACES)
            .map(|place| {
                let [x, y] = velocity.map(|v| v / 0.1 * place as f64 / PLACES as f64 / CELLS as f64);
                let formula = surface(x, y);
                let changes: Vec<&str> = changes.iter().copied().chain([formula.as_str()]).collect();
                states(&changes, &[speed], direction).remove(0)
            })
            .collect();
        let between = |column: fn(&State) -> f64| placed.iter().map(column).sum::<f64>() / PLACES as f64;
        let load = between(|state| state.normal_force);
        let contact = between(|state| state.contact_fraction);
        let found = [
            mean(|row| row.normal_force) / load - 1.0,
            (mean(|row| row.tangential_force) - between(|state| state.tangential_force)) / load,
            (mean(|row| row.across.tangential_force) - between(|state| state.across[0])) / load,
            (mean(|row| row.hysteretic_force) - between(|state| state.hysteretic_force)) / load,
            (mean(|row| row.across.hysteretic_force) - between(|state| state.across[1])) / load,
            mean(|row| row.approach) / between(|state| state.approach) - 1.0,
        ];
        println!("{velocity:?} {force:?}, contact {contact}: {found:?}");
        assert!(contact > 0.1 && contact < 0.9);
        assert!(found.iter().all(|off| off.abs() < 2e-5), "{velocity:?} {force:?}: {found:?}");
    }
}
