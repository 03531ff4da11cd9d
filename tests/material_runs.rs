//! Whole runs of `mpjr` against the closed forms of linear viscoelasticity.
//!
//! ```text
//!        | D(t)                  a flat indenter on a layer of depth H between rollers: the strain D/H is uniform,
//!   _____v_____                    N = width/H [K * dD + 4/3 G * dD]
//!  o|         |o                 * the Boltzmann integral from 0 to t of M(t - r) dD(r)
//!  o|  G, K   |o  H
//!  o|_________|o                 slid by s(t) without slip, under periodic sides: Q = width/H G * ds
//! ```
//!
//! Four nodes carry these fields exactly, so that what is left is the integration of the arms over the steps. The
//! penalty takes 1e-7 of the approach.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::f64::consts::{PI, TAU};
use std::process::Command;

use mpjr::oracle::prony::Relaxing;
use mpjr::output::reader::Results;
use mpjr::rheology::{Band, Fractional};

/// Instantaneous moduli and arms of both.
struct Solid {
    rule: &'static str,
    shear: Relaxing,
    bulk: Relaxing,
}

const POISSON: f64 = 0.3;
const WIDTH: f64 = 2.0;
const DEPTH: f64 = 0.5;
const APPROACH: f64 = 1e-3;

/// Table 1, three arms.
const EVA: [(f64, f64); 3] = [(0.309, 0.102), (0.226, 0.545), (0.210, 4.104)];
/// One time of its own and one that the shear modulus has too.
const BULK: [(f64, f64); 2] = [(0.2, 0.03), (0.3, 4.104)];

fn solids(arms: &[(f64, f64)], bulk_arms: &[(f64, f64)]) -> [Solid; 3] {
    let shear = |arms: &[(f64, f64)]| Relaxing { instantaneous: 749.386, arms: arms.to_vec() };
    let stiffness = 749.386 * 2.0 * (1.0 + POISSON) / (3.0 * (1.0 - 2.0 * POISSON));
    let bulk = |arms: &[(f64, f64)]| Relaxing { instantaneous: stiffness, arms: arms.to_vec() };
    [
        Solid { rule: "constant_ratio", shear: shear(arms), bulk: bulk(arms) },
        Solid { rule: "constant_bulk_modulus", shear: shear(arms), bulk: bulk(&[]) },
        Solid { rule: "bulk_arms", shear: shear(arms), bulk: bulk(bulk_arms) },
    ]
}

impl Solid {
    /// The `[material]` table.
    fn toml(&self, memory: &str) -> String {
        let arms = |arms: &[(f64, f64)]| -> String {
            arms.iter().map(|(weight, time)| format!("{{ weight = {weight:?}, time = {time:?} }},")).collect()
        };
        let bulk = match self.rule {
            "bulk_arms" => format!("bulk_arms = [{}]\n", arms(&self.bulk.arms)),
            _ => String::new(),
        };
        format!(
            "[material]\nshear_modulus = {:?}\npoisson_ratio = {POISSON}\narms = [{}]\npoisson_rule = \"{}\"\n{bulk}\
             memory = \"{memory}\"\n",
            self.shear.instantaneous,
            arms(&self.shear.arms),
            self.rule
        )
    }

    /// width/H times K + 4/3 G of what a unit of each modulus answers.
    fn compressed(&self, answer: impl Fn(&Relaxing) -> f64) -> f64 {
        WIDTH / DEPTH * (answer(&self.bulk) + 4.0 / 3.0 * answer(&self.shear))
    }
}

fn compression(material: &str, phases: &str) -> String {
    format!(
        "{material}\n[layer]\nwidth = {WIDTH}\ndepth = {DEPTH}\ncells = [1, 1]\nsides = \"roller\"\n[indenter]\n\
         profile = \"parabola\"\nradius = 1e15\ncentre = 1.0\n[contact]\npenalty = 1e11\n{phases}"
    )
}

fn phase(name: &str, duration: f64, steps: usize, more: &str) -> String {
    format!("[[phase]]\nname = \"{name}\"\nduration = {duration:?}\nsteps = {steps}\n{more}\n")
}

/// Runs a scene on `ranks` and gives its results; the directory goes with them.
fn run(scene: &str, ranks: usize) -> (Results, tempfile::TempDir) {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("scene.toml"), scene).unwrap();
    let mut command = match ranks {
        1 => Command::new(env!("CARGO_BIN_EXE_mpjr")),
        ranks => {
            let mut command = common::mpi::mpirun(ranks);
            command.arg(env!("CARGO_BIN_EXE_mpjr"));
            command
        }
    };
    let output = command.args(["run", "scene.toml"]).current_dir(&directory).output().unwrap();
    assert!(output.status.success(), "{}\n{scene}", String::from_utf8_lossy(&output.stderr));
    (Results::open(&directory.path().join("scene.h5")).unwrap(), directory)
}

fn close(computed: f64, exact: f64, tolerance: f64, what: &str) {
    let difference = (computed / exact - 1.0).abs();
    assert!(difference <= tolerance, "{what}: {computed} is not {exact}: {difference:.2e}");
}

/// The final normal force.
fn force(scene: &str) -> f64 {
    *run(scene, 1).0.history("normal_force").unwrap().last().unwrap()
}

/// Pressed in 1 ns and held: N goes with M(t). Every row of the history, and any steps, with the exponential update.
#[test]
fn a_step_relaxes_as_the_moduli() {
    for solid in solids(&EVA, &BULK) {
        let approach = format!("approach = {APPROACH}");
        let phases = |steps| [phase("press", 1e-9, 1, &approach), phase("hold", 10.0, steps, "")].concat();
        let results = run(&compression(&solid.toml("exponential"), &phases(7)), 1).0;
        let (time, normal) = (results.history("time").unwrap(), results.history("normal_force").unwrap());
        assert_eq!(time.len(), 9);
        for (t, force) in time.iter().zip(&normal).skip(1) {
            let exact = APPROACH * solid.compressed(|modulus| modulus.step_strain(*t));
            close(*force, exact, 1e-6, solid.rule);
        }
        let exact = APPROACH * solid.compressed(|modulus| modulus.step_strain(10.0));
        let error = |steps| (force(&compression(&solid.toml("backward_euler"), &phases(steps))) - exact).abs();
        let order = (error(200) / error(400)).log2();
        assert!((order - 1.0).abs() < 0.05, "{}: order {order}", solid.rule);
    }
}

/// Pressed at a constant rate: the exponential update is exact at any step; backward Euler is of first order.
#[test]
fn a_ramp_is_the_boltzmann_integral() {
    let duration = 3.0;
    for solid in solids(&EVA, &BULK) {
        let exact = APPROACH / duration * solid.compressed(|modulus| modulus.ramp_strain(duration));
        let ramp = |memory: &str, steps| {
            let phases = phase("press", duration, steps, &format!("approach = {APPROACH}"));
            force(&compression(&solid.toml(memory), &phases))
        };
        for steps in [1, 20] {
            close(ramp("exponential", steps), exact, 1e-6, solid.rule);
        }
        let error = |steps| (ramp("backward_euler", steps) - exact).abs();
        let order = (error(100) / error(200)).log2();
        assert!((order - 1.0).abs() < 0.05, "{}: order {order}", solid.rule);
    }
}

/// A sinusoidal displacement that begins after the layer was pressed.
fn sheared(solid: &Solid, memory: &str, (duration, cycles, steps): (f64, f64, usize)) -> Results {
    let motion = format!("tangential = {{ amplitude = {AMPLITUDE}, cycles = {cycles:?} }}");
    let approach = format!("approach = {APPROACH}");
    let scene = compression(
        &solid.toml(memory),
        &[phase("press", 1.0, 1, &approach), phase("shear", duration, steps, &motion)].concat(),
    );
    // So strong that it never leaves the straight part of tanh, and creeps by some 1e-11 m/s.
    let friction = "[friction]\nlaw = \"coulomb_tanh\"\ncoefficient = 1e7\nregularisation = 1e-3\n";
    // One period of a layer has two cells.
    let scene = scene.replace("cells = [1, 1]", "cells = [2, 1]").replace("\"roller\"", "\"periodic\"");
    run(&(scene + friction), 1).0
}

const AMPLITUDE: f64 = 1e-4;

/// Slid sinusoidally without slip: q/G = mu_0 sin wt + sum mu_i x/(1 + x^2) [cos wt + x sin wt - exp(-t/tau_i)],
/// x = w tau_i, transient included, whatever the bulk does: of second order with the exponential update.
#[test]
fn a_sinusoid_is_the_boltzmann_integral() {
    let (duration, cycles) = (2.3, 1.2);
    let w = TAU * cycles / duration;
    for solid in solids(&EVA, &BULK) {
        let arm = |&(weight, time): &(f64, f64)| {
            let x = w * time;
            weight * x / (1.0 + x * x) * ((w * duration).cos() + x * (w * duration).sin() - f64::exp(-duration / time))
        };
        let sum = solid.shear.long_term() * (w * duration).sin() + solid.shear.arms.iter().map(arm).sum::<f64>();
        let exact = WIDTH / DEPTH * AMPLITUDE * solid.shear.instantaneous * sum;
        for (memory, order, steps) in [("exponential", 2.0, 40), ("backward_euler", 1.0, 200)] {
            let shear = |steps| sheared(&solid, memory, (duration, cycles, steps)).history("tangential_force").unwrap();
            let error = |steps| (shear(steps).last().unwrap() - exact).abs();
            let (coarse, fine) = (error(steps), error(2 * steps));
            let observed = (coarse / fine).log2();
            println!("{} {memory}: {:.2e} of the force, order {observed:.3}", solid.rule, fine / exact.abs());
            assert!((observed - order).abs() < 0.1, "{} {memory}: order {observed}", solid.rule);
        }
    }
}

/// Over a settled cycle the indenter supplies pi G'' e0^2 per volume, e0 = amplitude/H, and the arms dissipate it: of second
/// order in the step with the exponential update and of first with backward Euler. What does not balance over the cycle is
/// of second order with either: the first-order share of backward Euler is a change of state, which a cycle undoes.
#[test]
fn a_cycle_dissipates_pi_times_the_loss_modulus() {
    let (period, cycles) = (1.3, 30usize);
    let solid = &solids(&EVA, &BULK)[2];
    let series = mpjr::rheology::Prony {
        arms: EVA.iter().map(|&(weight, time)| mpjr::rheology::Arm { weight, time }).collect(),
    };
    let loss = solid.shear.instantaneous * series.complex_modulus(TAU / period).im;
    let exact = PI * loss * (AMPLITUDE / DEPTH).powi(2) * WIDTH * DEPTH;
    for (memory, order, per_cycle, allowed) in [("exponential", 2.0, 50, 2e-3), ("backward_euler", 1.0, 75, 3e-2)] {
        let errors = |per_cycle: usize| {
            let results = sheared(solid, memory, (period * cycles as f64, cycles as f64, per_cycle * cycles));
            let gain = |name: &str| {
                let column = results.history(&format!("energy/{name}")).unwrap();
                column[column.len() - 1] - column[column.len() - 1 - per_cycle]
            };
            let (work, lost) = (gain("external_work"), gain("viscoelastic_dissipation"));
            println!("{memory}, {per_cycle} steps a cycle: {work:.8e} J/m, {lost:.8e} in the arms, exact {exact:.8e}");
            [work / exact - 1.0, lost / exact - 1.0, gain("imbalance") / exact]
        };
        let (coarse, fine) = (errors(per_cycle), errors(2 * per_cycle));
        for ((coarse, fine), order) in coarse.into_iter().zip(fine).zip([order, order, 2.0]) {
            let observed = (coarse / fine).log2();
            assert!(fine.abs() < allowed, "{memory}: {fine}");
            assert!((observed - order).abs() < 0.1, "{memory}: order {observed}, {coarse} {fine}");
        }
    }
}

/// The stress at `t` under a strain that grows to 1 over `duration`, and stays: without the difference of long ramps.
fn held(modulus: &Relaxing, duration: f64, t: f64) -> f64 {
    let arm = |(weight, time): &(f64, f64)| {
        let x = duration / time;
        weight * (-(t - duration) / time).exp() * -(-x).exp_m1() / x
    };
    modulus.instantaneous * (modulus.long_term() + modulus.arms.iter().map(arm).sum::<f64>())
}

/// Fifty arms from 1e-12 s to 1e12 s, weights down to 1e-12, steps from 1e-14 to 1e14 and more of a relaxation time:
/// the force falls, never below its long-term value, and with the exponential update it is the closed form.
#[test]
fn fifty_arms_over_twenty_four_decades() {
    let times = Band::new(1e-12, 1e12).unwrap().samples(50);
    let weight = |i: usize| if i.is_multiple_of(3) { 1e-12 } else { 0.029 };
    let arms: Vec<(f64, f64)> = times.iter().enumerate().map(|(i, &time)| (weight(i), time)).collect();
    let bulk: Vec<(f64, f64)> = times.iter().step_by(7).map(|&time| (0.1, time)).collect();
    let press = phase("press", 1e-2, 1, &format!("approach = {APPROACH}"));
    let hold: Vec<String> = (-1..=12).map(|k| phase(&format!("1e{k}"), 10f64.powi(k), 4, "")).collect();
    let phases = press + &hold.concat();
    for solid in solids(&arms, &bulk) {
        for memory in ["exponential", "backward_euler"] {
            let results = run(&compression(&solid.toml(memory), &phases), 1).0;
            let (time, normal) = (results.history("time").unwrap(), results.history("normal_force").unwrap());
            assert_eq!(normal.len(), 1 + 1 + 14 * 4);
            let rest = APPROACH * solid.compressed(|modulus| modulus.instantaneous * modulus.long_term());
            let what = format!("{} {memory}", solid.rule);
            for (t, force) in time.iter().zip(&normal).skip(1) {
                assert!(*force >= rest * (1.0 - 1e-6), "{what}: {force} at {t} s");
                if memory == "exponential" {
                    let exact = APPROACH * solid.compressed(|modulus| held(modulus, 1e-2, *t));
                    close(*force, exact, 1e-6, &format!("{what} at {t} s"));
                }
            }
            let falls = normal[1..].windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-7));
            assert!(falls, "{what}: {normal:?}");
        }
    }
}

/// The power law in a scene relaxes as Eq. (11) says, to the stated error, between its shortest step and its end.
#[test]
fn a_fractional_material_relaxes_as_the_power_law() {
    let material = "[material]\nfractional = { modulus = 814.7, order = 0.226, arms = 5 }\npoisson_ratio = 0.25\n\
                    poisson_rule = \"constant_ratio\"\n";
    // A jump, and four decades of steps after it.
    let press = phase("press", 1e-9, 1, &format!("approach = {APPROACH}"));
    let holds: Vec<String> = (-2..=1).map(|k| phase(&format!("{k}"), 9.0 * 10f64.powi(k), 9, "")).collect();
    let first = phase("first", 1e-2, 1, "");
    // The jump would be the shortest step: the series comes from the scene without it.
    let resolved = run(&compression(material, &(first.clone() + &holds.concat())), 1).0;
    let resolved: toml::Table = resolved.text("scene").unwrap().parse().unwrap();
    let note = resolved["material"]["notes"][0].as_str().unwrap().to_owned();
    assert!(note.contains("5 arms for steps from 1.000e-2 s to 1.000e2 s: largest error of E(t) there"), "{note}");
    let stated: f64 = note.rsplit(' ').next().unwrap().parse().unwrap();
    assert!(stated > 1e-3 && stated < 0.01, "{note}");
    let series = toml::Table::from_iter([("material".to_owned(), resolved["material"].clone())]).to_string();
    let results = run(&compression(&series, &(press + &first + &holds.concat())), 1).0;
    let law = Fractional::new(814.7, 0.226).unwrap();
    // Uniaxial strain: K + 4/3 G = E (1 - nu)/((1 + nu)(1 - 2 nu)).
    let factor = WIDTH / DEPTH * APPROACH * 0.75 / (1.25 * 0.5);
    let mut largest: f64 = 0.0;
    for (t, force) in results.history("time").unwrap().iter().zip(results.history("normal_force").unwrap()).skip(2) {
        largest = largest.max((force / (factor * law.relaxation(*t)) - 1.0).abs());
    }
    println!("stated {stated:.2e}, found {largest:.2e}");
    assert!(largest < 1.05 * stated, "{largest} over {stated}");
}

/// A ramp of ten steps, held for a hundred times as long: with as many arms as the program takes, the force is within 0.5 %
/// of the power law's at every step, the first included, and within what is said. F = r c [t^(1-a) - (t - 1)^(1-a)] /
/// Gamma(2 - a).
#[test]
fn a_fractional_material_takes_the_forces_of_ramps() {
    let material = "[material]\nfractional = { modulus = 814.7, order = 0.226 }\npoisson_ratio = 0.25\n\
                    poisson_rule = \"constant_ratio\"\n";
    let press = phase("press", 1.0, 10, &format!("approach = {APPROACH}"));
    let (results, _directory) = run(&compression(material, &(press + &phase("hold", 100.0, 200, ""))), 1);
    let resolved: toml::Table = results.text("scene").unwrap().parse().unwrap();
    let note = resolved["material"]["notes"][0].as_str().unwrap().to_owned();
    let stated: f64 = note.rsplit(' ').next().unwrap().parse().unwrap();
    let factor = WIDTH / DEPTH * APPROACH * 0.75 / (1.25 * 0.5) * 814.7 / libm::tgamma(1.774);
    let exact = |t: f64| factor * (t.powf(0.774) - (t - 1.0).max(0.0).powf(0.774));
    let rows = results.history("time").unwrap().into_iter().zip(results.history("normal_force").unwrap());
    let errors: Vec<f64> = rows.skip(1).map(|(t, force)| (force / exact(t) - 1.0).abs()).collect();
    let largest = errors.iter().copied().fold(0.0, f64::max);
    println!("stated {stated:.2e}, found {largest:.2e}, at the first step {:.2e}", errors[0]);
    assert_eq!(errors.len(), 210);
    assert!(largest < 5e-3 && (largest - stated).abs() < 1e-2 * stated, "{largest} over {stated}");
}

/// Hotter by a factor of the times is the same run on a slower clock.
#[test]
fn temperature_scales_the_times() {
    let cold = solids(&EVA, &BULK)[2].toml("exponential");
    let hot = cold.clone()
        + "shift = \"arrhenius\"\nreference_temperature = 293.15\ntemperature = 313.15\nactivation_energy = 1e5\n";
    let factor = (1e5 / 8.314_462_618_153_24 * (1.0 / 313.15 - 1.0 / 293.15f64)).exp();
    let run_in = |material: &str, duration: f64| {
        let phases = phase("press", duration, 20, &format!("approach = {APPROACH}"));
        force(&compression(material, &phases))
    };
    close(run_in(&hot, 3.0 * factor), run_in(&cold, 3.0), 1e-9, "at 313.15 K");
    assert!((run_in(&hot, 3.0) / run_in(&cold, 3.0) - 1.0).abs() > 0.05);
}

/// The file that `mpjr fit` writes goes into a scene, on any number of ranks, and into the results in full.
#[test]
fn a_material_file_on_one_and_two_ranks() {
    let directory = tempfile::tempdir().unwrap();
    let fit = Command::new(env!("CARGO_BIN_EXE_mpjr"))
        .args("fit --fractional 814.7,0.226 --from 0.1 --to 10 --arms 2 --out eva.toml".split(' '))
        .current_dir(&directory)
        .output();
    assert!(fit.unwrap().status.success());
    let file = directory.path().join("eva.toml");
    let scene = compression(
        &format!("[material]\nfile = {:?}\nmemory = \"backward_euler\"\n", file.to_str().unwrap()),
        &phase("press", 1.0, 10, &format!("approach = {APPROACH}")),
    );
    let runs = [1, 2].map(|ranks| run(&scene, ranks));
    let forces = runs.each_ref().map(|(results, _)| results.history("normal_force").unwrap());
    close(forces[0][10], forces[1][10], 1e-9, "on two ranks");
    let resolved: toml::Table = runs[1].0.text("scene").unwrap().parse().unwrap();
    let material = resolved["material"].as_table().unwrap();
    assert_eq!(format!("{:.3}", material["shear_modulus"].as_float().unwrap()), "674.606");
    assert_eq!(material["arms"].as_array().unwrap().len(), 2);
    assert_eq!(material["memory"].as_str(), Some("backward_euler"));
    assert!(material["notes"][0].as_str().unwrap().starts_with("read from "));
    assert!(!material.contains_key("file"));
}
