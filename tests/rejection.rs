//! A step that was tried and rejected leaves no trace: a run that meets rejections equals, bit for bit, one that takes
//! the shortened steps from the start. With two arms, friction and both Poisson rules, on one and on two ranks.
//!
//! All times are sums of powers of two, so that the steps themselves are the same to the last bit.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::cell::Cell;
use std::path::Path;
use std::rc::Rc;

use common::mpi::Case;
use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use mpjr::composition::{self, Problem};
use mpjr::error::{Error, Result};
use mpjr::loading::{Phase, Target};
use mpjr::profile::{Elevation, Harmonic, Profile};
use mpjr::scene::{self, Scene, Source, Strategy};
use mpjr::solve::{Driver, Observer, Report};

/// MUMPS on several ranks sums in the order in which messages come, and PT-Scotch draws on with its random numbers from
/// one mesh to the next, so that no two runs in a process are the same to the last bit. Here each rank factorises the
/// whole, and the cells are dealt out in order.
const REPEATABLE: &str = "-pc_type redundant -mat_partitioning_type average";

const CASES: &[Case] = &[
    Case { petsc: REPEATABLE, ..Case::new("a_profile_that_fails_once", &[1, 2], a_profile_that_fails_once) },
    Case { petsc: REPEATABLE, ..Case::new("newton_that_gives_up", &[1, 2], newton_that_gives_up) },
    Case::new("condensed", &[1, 2], condensed),
];

fn main() {
    common::mpi::main(CASES);
}

const SURFACE: Harmonic = Harmonic { amplitude: 5e-4, wavelength: 1.0 };
const VELOCITY: f64 = 0.09375;

/// Pressed in four steps of 0.25 s, slid in four of 0.25 s.
fn scene(rule: &str, strategy: &str) -> Scene {
    let overrides = [
        "layer.cells=[16,8]",
        "material.arms=[{ weight = 0.3, time = 0.4 }, { weight = 0.4, time = 3.0 }]",
        &format!("material.poisson_rule=\"{rule}\""),
        &format!("solver.strategy=\"{strategy}\""),
        "material.poisson_ratio=0.3",
        "phase.indent.duration=1.0",
        "phase.indent.steps=4",
        &format!("phase.slide.velocity={VELOCITY}"),
        &format!("phase.slide.distance={VELOCITY}"),
        "phase.slide.steps=4",
        "output.bulk_at=[\"slide\"]",
    ]
    .map(str::to_owned);
    let source = Source { file: "sliding.toml".into(), overrides: overrides.to_vec() };
    scene::read(include_str!("scenes/sliding.toml"), &source).unwrap()
}

const RULES: [&str; 2] = ["constant_ratio", "constant_bulk_modulus"];

/// Everything that a run tells of its accepted states, as bits.
#[derive(Default)]
struct Told {
    /// Without the bulk fields.
    face_only: bool,
    times: Vec<f64>,
    numbers: Vec<u64>,
}

impl Observer for Told {
    fn observe(&mut self, report: Report<'_>) -> Result<()> {
        self.times.push(report.time);
        let energy = report.problem.energy().unwrap();
        let mut contact = report.problem.contact()?;
        let (totals, fields) = (contact.totals()?, contact.fields());
        let mut told = vec![
            report.time,
            totals.normal_force,
            totals.tangential_force.x,
            totals.hysteretic_force.x,
            totals.contact_fraction,
            totals.stick_fraction,
            totals.max_penetration,
            energy.external_work,
            energy.stored,
            energy.viscoelastic_dissipation,
            energy.friction_dissipation,
            energy.penalty,
        ];
        for field in [&fields.pressure, &fields.gap] {
            told.extend(field);
        }
        for field in [&fields.shear, &fields.slip_rate] {
            told.extend(field.iter().map(|vector| vector.x));
        }
        told.extend(contact.displacement);
        if !self.face_only {
            // The stress tells of the arms.
            let bulk = report.problem.bulk_fields(report.u)?;
            told.extend(bulk.displacement.as_flattened());
            told.extend(bulk.stress.as_flattened());
        }
        self.numbers.extend(told.iter().map(|number| number.to_bits()));
        Ok(())
    }
}

/// Runs a problem over its phases.
fn run(world: &SimpleCommunicator, scene: &Scene, problem: Problem) -> Result<Told> {
    let Problem { mut strategy, mut tangent, mut u, phases, mut integrator, .. } = problem;
    // On several ranks the condensed form parts the body among them when it is first asked for, not always alike.
    let face_only = scene.solver.strategy == Strategy::Condensed && world.size() > 1;
    let mut told = Told { face_only, ..Told::default() };
    let mut driver = Driver::new(strategy.as_mut(), &mut told, &phases);
    driver.run(&mut integrator, &mut tangent, &mut u)?;
    let counts = driver.counts();
    assert_eq!(counts.steps, told.times.len());
    Ok(told)
}

/// The phases with the steps that `times` end, all of them planned.
fn stepped(phases: Vec<Phase>, times: &[f64]) -> Vec<Phase> {
    let steps = |phase: &Phase| {
        let mut last = phase.start;
        let inside = times.iter().filter(|&&t| t > phase.start && t <= phase.end());
        inside.map(|&time| Target { time, dt: time - std::mem::replace(&mut last, time), bulk_output: false }).collect()
    };
    phases.into_iter().map(|phase| Phase { steps: steps(&phase), ..phase }).collect()
}

/// The harmonic profile, which does not know itself at one point until it was asked there once.
struct FailsOnce {
    at: f64,
    failed: Rc<Cell<bool>>,
}

impl Profile for FailsOnce {
    fn at(&self, x: f64) -> Result<Elevation> {
        if x == self.at && !self.failed.replace(true) {
            return Err(Error::Domain("not yet".into()));
        }
        SURFACE.at(x)
    }
}

/// Whether two runs are the same to the last bit.
fn assert_same(met: &Told, planned: &Told) {
    assert_eq!(met.times, planned.times);
    assert_eq!(met.numbers.len(), planned.numbers.len());
    let different = met.numbers.iter().zip(&planned.numbers).filter(|(a, b)| a != b).count();
    assert_eq!(different, 0, "of {} numbers", met.numbers.len());
}

/// The profile fails when the node at 9/16 first meets it at the end of the second step of the slide. The step of dt is
/// then taken as dt/4, dt/2, dt/4.
fn profile_fails(world: &SimpleCommunicator, scene: &Scene) {
    let failed = Rc::new(Cell::new(false));
    let profile = FailsOnce { at: 9.0 / 16.0 - VELOCITY * 0.5, failed: failed.clone() };
    let met = run(world, scene, composition::build_with_profile(world, scene, Box::new(profile)).unwrap()).unwrap();
    assert!(failed.get());
    let times = [0.25, 0.5, 0.75, 1.0, 1.25, 1.3125, 1.4375, 1.5, 1.75, 2.0];
    assert_eq!(met.times, times);

    let mut problem = composition::build(world, scene, Path::new("scene.toml")).unwrap();
    problem.phases = stepped(problem.phases, &times);
    assert_same(&met, &run(world, scene, problem).unwrap());
}

/// Under a sharp regularisation Newton's method is allowed the fewest iterations with which it comes through, so that
/// some steps fail half way; then all steps that were accepted are planned in a run that may take as many as it likes.
fn newton_fails(world: &SimpleCommunicator, scene: &Scene) {
    let friction = Some(scene::Friction::constant(scene::Law::tanh(1e-5), 0.2));
    let scene = &Scene { friction, ..scene.clone() };
    let met = (2..8).find_map(|most| {
        let mut problem = composition::build(world, scene, Path::new("scene.toml")).unwrap();
        problem.integrator.set_max_newton(most).unwrap();
        run(world, scene, problem).ok()
    });
    let met = met.unwrap();
    assert!(met.times.len() > 8, "no step was cut: {:?}", met.times);

    let mut problem = composition::build(world, scene, Path::new("scene.toml")).unwrap();
    problem.phases = stepped(problem.phases, &met.times);
    assert_same(&met, &run(world, scene, problem).unwrap());
}

fn a_profile_that_fails_once(world: &SimpleCommunicator, _: &Path) {
    for rule in RULES {
        profile_fails(world, &scene(rule, "monolithic"));
    }
}

fn newton_that_gives_up(world: &SimpleCommunicator, _: &Path) {
    for rule in RULES {
        newton_fails(world, &scene(rule, "monolithic"));
    }
}

/// Both, condensed on the contact face.
fn condensed(world: &SimpleCommunicator, _: &Path) {
    for rule in RULES {
        profile_fails(world, &scene(rule, "condensed"));
        newton_fails(world, &scene(rule, "condensed"));
    }
}
