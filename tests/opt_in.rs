//! Nothing runs, allocates or costs unless the scene asks for it (issue: model only what a scene requires). By
//! counters, not clocks.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::Path;

use common::mpi::{Case, main as run_cases};
use mpi::topology::SimpleCommunicator;
use mpjr::scene::{self, Source};
use mpjr::solution;
use mpjr::solve::Work;

/// Elastic and frictionless, without bulk output.
const BARE: &str = r#"
[layer]
width = 1.0
depth = 0.5
cells = [16, 8]
sides = "free"
[material]
shear_modulus = 500.0
poisson_ratio = 0.3
[indenter]
profile = "parabola"
radius = 2.0
centre = 0.5
[contact]
penalty = 1e6
[[phase]]
name = "press"
duration = 1.0
steps = 4
approach = 2e-3
[[phase]]
name = "hold"
duration = 1.0
steps = 3
"#;
const ARMS: &str =
    "arms = [ { weight = 0.3, time = 0.1 }, { weight = 0.3, time = 1.0 }, { weight = 0.2, time = 9.0 } ]";
const FRICTION: &str = "[friction]\nlaw = \"coulomb_tanh\"\ncoefficient = 0.3\nregularisation = 1e-3\n";

static CASES: &[Case] = &[
    Case::new("a_bare_scene_does_nothing_else", &[1, 2], bare),
    Case::new("arms_bring_a_field_each", &[1], arms),
    Case::new("friction_brings_its_law", &[1], friction),
    Case::new("bulk_output_brings_a_recovery_each_time", &[1], bulk_output),
    Case::new("one_factorisation_serves_for_all_steps", &[1, 2], factorisations),
    Case::new("columns_of_one_node_serve_a_periodic_face", &[1, 2], columns),
];

fn main() {
    run_cases(CASES);
}

/// The work of a scene, with the changes of `--set` in it.
fn work(comm: &SimpleCommunicator, text: &str, changes: &[&str]) -> Work {
    let overrides = changes.iter().map(|&change| change.to_owned()).collect();
    let scene = scene::read(text, &Source { file: "bare.toml".into(), overrides }).unwrap();
    solution::solve(comm, &scene).unwrap().counts.work
}

/// Under both strategies, on free and on periodic layers.
fn everywhere(comm: &SimpleCommunicator, text: &str, check: impl Fn(Work)) {
    for strategy in ["solver.strategy=condensed", "solver.strategy=monolithic"] {
        for sides in ["layer.sides=free", "layer.sides=periodic"] {
            check(work(comm, text, &[strategy, sides]));
        }
    }
}

/// No memory, no tangential law, no recovery; what is factorised at all is the symmetric bulk.
fn bare(comm: &SimpleCommunicator, _directory: &Path) {
    everywhere(comm, BARE, |work| {
        assert_eq!((work.memory_fields, work.tangential_laws, work.recoveries), (0, 0, 0));
    });
    assert_eq!(work(comm, BARE, &[]), Work::default());
}

/// One field for each arm, whatever the rule.
fn arms(comm: &SimpleCommunicator, _directory: &Path) {
    for rule in ["constant_ratio", "constant_bulk_modulus"] {
        let material = format!("poisson_ratio = 0.3\n{ARMS}\npoisson_rule = \"{rule}\"");
        everywhere(comm, &BARE.replace("poisson_ratio = 0.3", &material), |work| {
            assert_eq!((work.memory_fields, work.tangential_laws, work.recoveries), (3, 0, 0));
        });
    }
}

/// The law is asked at every point in contact, and nothing else changes.
fn friction(comm: &SimpleCommunicator, _directory: &Path) {
    everywhere(comm, &format!("{BARE}{FRICTION}"), |work| {
        assert!(work.tangential_laws > 0);
        assert_eq!((work.memory_fields, work.recoveries), (0, 0));
    });
}

/// One recovery for each moment.
fn bulk_output(comm: &SimpleCommunicator, _directory: &Path) {
    everywhere(comm, &format!("{BARE}[output]\nbulk_at = [\"press\", 1.5]\n"), |work| {
        assert_eq!((work.memory_fields, work.tangential_laws, work.recoveries), (0, 0, 2));
    });
}

/// Of the monolithic strategy: one for all step lengths where all moduli relax alike, else one per step length (two
/// here); with friction too, since it is the symmetric bulk that is factorised.
fn factorisations(comm: &SimpleCommunicator, _directory: &Path) {
    let with = |rule: &str| {
        let material = format!("poisson_ratio = 0.3\n{ARMS}\npoisson_rule = \"{rule}\"");
        format!("{}{FRICTION}", BARE.replace("poisson_ratio = 0.3", &material))
    };
    for (text, expected) in [(BARE.to_owned(), 1), (with("constant_ratio"), 1), (with("constant_bulk_modulus"), 2)] {
        let work = work(comm, &text, &["solver.strategy=monolithic"]);
        assert_eq!(work.factorisations, expected);
        // Two a Newton iteration and one for each component that came into contact.
        assert!(work.solves > 0);
    }
}

/// The monolithic strategy takes the columns of the face's compliance from one node of a periodic layer, two solves, and a start
/// that meets the laws takes three a step: free motion, tractions, and what round-off left. Newton's method has nothing to
/// do then, which it would have with a wrong compliance.
fn columns(comm: &SimpleCommunicator, _directory: &Path) {
    let changes = ["solver.strategy=monolithic", "layer.sides=periodic", "contact.penalty=1e9"];
    let work = work(comm, &format!("{BARE}{FRICTION}"), &changes);
    assert_eq!(work.solves, 2 + 3 * 7);
}
