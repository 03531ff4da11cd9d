//! Phases with a `tolerance` instead of `steps`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::Path;

use common::mpi::Case;
use mpi::topology::SimpleCommunicator;
use mpjr::composition::{self, Problem};
use mpjr::error::{Error, Result};
use mpjr::loading::{Phase, Target};
use mpjr::scene::{self, Scene, Source};
use mpjr::solution::{Solution, solve};
use mpjr::solve::{Driver, Observer, Report};
use mpjr::study::Difference;

const CASES: &[Case] = &[
    Case::new("a_third_of_the_steps", &[1], a_third_of_the_steps),
    Case::new("rejections_leave_no_trace", &[1, 2], rejections_leave_no_trace),
    Case::new("first_touch_and_moments", &[1], first_touch_and_moments),
    Case::new("sinusoids_are_resolved", &[1], sinusoids_are_resolved),
    Case::new("a_tolerance_out_of_reach", &[2], a_tolerance_out_of_reach),
    Case::new("cuts_have_an_end", &[1], cuts_have_an_end),
];

fn main() {
    common::mpi::main(CASES);
}

/// A layer that creeps in the approach, on few cells, pressed, brought to slip and slid.
fn layer(overrides: impl IntoIterator<Item = String>) -> Scene {
    let overrides = std::iter::once("layer.cells=[32,32]".to_owned()).chain(overrides).collect();
    scene::read(include_str!("scenes/creeping-layer.toml"), &Source { file: "creeping-layer.toml".into(), overrides })
        .unwrap()
}

/// In 3200 equal steps, unless the overrides say otherwise.
fn in_steps(overrides: &[&str]) -> Scene {
    let steps = ["phase.indent.steps=100", "phase.onset.steps=100", "phase.slide.steps=3000"];
    layer(steps.iter().chain(overrides).map(|&set| set.to_owned()))
}

/// The same with the steps of each phase chosen by a tolerance.
fn adaptive(tolerance: f64, overrides: &[&str]) -> Scene {
    let each = |phase: &str| format!("phase.{phase}.tolerance={tolerance:e}");
    layer(["indent", "onset", "slide"].map(each).into_iter().chain(overrides.iter().map(|&set| set.to_owned())))
}

/// The largest differences of N, Q and the hysteretic force from a finer history.
fn apart(coarse: &Solution, fine: &Solution) -> [f64; 3] {
    let Difference { normal, tangential, hysteretic, .. } = Difference::between(&coarse.history, &fine.history);
    [normal, tangential, hysteretic]
}

/// A layer that creeps in the approach in 3200 equal steps, of which the onset of slip has 100: adaptive steps come to
/// a smaller error (the largest of those of N, Q and the hysteretic force) with less than a third of them, the rejected
/// attempts counted. The
/// reference resolves every moment (its tolerance is a fiftieth); that it is right, equal steps say, which come
/// closer to it. N has kinks where node after node comes into contact, and is known to 5e-5 only between the rows of
/// the reference.
fn a_third_of_the_steps(world: &SimpleCommunicator, _: &Path) {
    let reference = solve(world, &adaptive(2e-6, &[])).unwrap();
    let equal = solve(world, &in_steps(&[])).unwrap();
    let twice = ["phase.indent.steps=200", "phase.onset.steps=200", "phase.slide.steps=6000"];
    let finer = apart(&solve(world, &in_steps(&twice)).unwrap(), &reference);
    let adaptive = solve(world, &adaptive(7e-5, &[])).unwrap();
    let [off_equal, off_adaptive] = [&equal, &adaptive].map(|run| apart(run, &reference));
    let [steps_equal, attempts] = [equal.counts.steps, adaptive.counts.steps + adaptive.counts.rejected];
    println!("{steps_equal} equal steps: {off_equal:.5?}; {attempts} attempts: {off_adaptive:.5?}");
    println!("twice as many: {finer:.5?}");
    assert_eq!(steps_equal, 3200);
    assert!([1, 2].iter().all(|&i| finer[i] < 0.6 * off_equal[i]), "{finer:?} {off_equal:?}");
    assert!(3 * attempts <= steps_equal, "{attempts}");
    let largest = |off: [f64; 3]| off.into_iter().fold(0.0, f64::max);
    assert!(largest(off_adaptive) <= largest(off_equal) && largest(off_adaptive) < 5e-4);
    assert!(off_adaptive[0] < 1e-4 && off_adaptive[1] <= off_equal[1]);
}

/// All that is told of the accepted states, as bits, and the steps that led to them.
#[derive(Default)]
struct Told {
    steps: Vec<Target>,
    numbers: Vec<u64>,
}

impl Observer for Told {
    fn observe(&mut self, report: Report<'_>) -> Result<()> {
        self.steps.push(Target { time: report.time, dt: report.dt, bulk_output: false });
        let mut contact = report.problem.contact()?;
        let (totals, fields) = (contact.totals()?, contact.fields());
        let forces = [totals.normal_force, totals.tangential_force.x, totals.hysteretic_force.x];
        let all = forces
            .iter()
            .chain(&fields.pressure)
            .chain(fields.shear.iter().chain(&fields.slip_rate).map(|vector| &vector.x));
        self.numbers.extend(all.map(|number| number.to_bits()));
        Ok(())
    }
}

/// A run that chose its steps, and rejected some, is bit for bit one for which the accepted ones were planned. Both
/// kinds of memory behind the face, and all unknowns (on one rank; MUMPS is not repeatable on several).
fn rejections_leave_no_trace(world: &SimpleCommunicator, _: &Path) {
    use mpi::traits::Communicator;
    let mut cases = vec![("constant_ratio", "condensed"), ("constant_bulk_modulus", "condensed")];
    if world.size() == 1 {
        cases.push(("constant_ratio", "monolithic"));
    }
    for (rule, strategy) in cases {
        let rule = format!("material.poisson_rule=\"{rule}\"");
        let strategy = format!("solver.strategy=\"{strategy}\"");
        let scene = adaptive(1e-3, &["layer.cells=[24,8]", &rule, &strategy]);
        let run = |planned: Option<&[Target]>| {
            let Problem { mut strategy, mut tangent, mut u, mut phases, mut integrator, .. } =
                composition::build(world, &scene, Path::new("scene.toml")).unwrap();
            if let Some(steps) = planned {
                let inside = |phase: &Phase| {
                    steps.iter().filter(|step| step.time > phase.start && step.time <= phase.end()).copied().collect()
                };
                phases =
                    phases.into_iter().map(|phase| Phase { steps: inside(&phase), adaptive: None, ..phase }).collect();
            }
            let mut told = Told::default();
            let mut driver = Driver::new(strategy.as_mut(), &mut told, &phases);
            driver.run(&mut integrator, &mut tangent, &mut u).unwrap();
            (driver.counts(), told)
        };
        let (counts, chosen) = run(None);
        assert!(counts.rejected > 0 && counts.pieces == 0, "{counts:?}");
        let (again, planned) = run(Some(&chosen.steps));
        assert_eq!((again.rejected, again.steps), (0, counts.steps));
        assert_eq!(chosen.numbers, planned.numbers, "{rule} {strategy}");
    }
}

/// The profile begins 3e-4 m above the face: the load sets in within a hundredth of what it comes to, although steps grow while
/// nothing happens. Moments for bulk output inside a phase, and the ends of phases, are hit to the last bit.
fn first_touch_and_moments(world: &SimpleCommunicator, _: &Path) {
    let above = "indenter={ profile = \"expression\", formula = \"3e-4 + 5e-4*(1-cos(2*pi*x))\" }";
    let moments = "output.bulk_at=[1.25, 9.875, 30.0625]";
    let run = solve(world, &adaptive(1e-3, &[above, moments])).unwrap();
    let touch = run.history.iter().find(|row| row.normal_force > 0.0).unwrap();
    let pressed = run.end_of(0);
    assert!(touch.time > 3.0 && touch.time < 3.1, "{}", touch.time);
    assert!(touch.normal_force < 0.01 * pressed.normal_force);
    for moment in [1.25, 9.875, 10.0, 30.0625] {
        assert!(run.history.iter().any(|row| row.time == moment), "{moment}");
    }
    assert_eq!(run.ends.len(), 3);
    assert!(run.counts.steps < 400, "{}", run.counts.steps);
}

/// Two cycles of fretting with a sharp regularisation: no half cycle has less than twelve steps, however loose the
/// tolerance, and the force agrees with that of 4000 equal steps.
fn sinusoids_are_resolved(world: &SimpleCommunicator, _: &Path) {
    let sway = "phase.slide={ name = \"slide\", duration = 4.0, tangential = { amplitude = 2e-4, cycles = 2.0 }";
    let with = |stepping: &str| adaptive(1e-3, &[&format!("{sway}, {stepping} }}"), "friction.regularisation=1e-6"]);
    let loose = solve(world, &with("tolerance = 0.5")).unwrap();
    let inside = |from: f64, to: f64| loose.history.iter().filter(|row| row.time > from && row.time <= to).count();
    let start = loose.end_of(1).time;
    for half in 0..4 {
        let from = start + f64::from(half);
        assert!(inside(from, from + 1.0) >= 12, "half cycle {half}: {} steps", inside(from, from + 1.0));
    }
    let (fine, run) = (solve(world, &with("steps = 4000")).unwrap(), solve(world, &with("tolerance = 1e-3")).unwrap());
    let off = apart(&run, &fine);
    println!("{} attempts: {off:.5?}", run.counts.steps + run.counts.rejected);
    assert!(off[0] < 1e-3 && off[1] < 1e-2, "{off:?}");
}

/// A tolerance that no step can meet ends the run on all ranks with an error of the solver that says what to do.
fn a_tolerance_out_of_reach(world: &SimpleCommunicator, _: &Path) {
    let Err(Error::Solver(text)) = solve(world, &adaptive(1e-16, &["layer.cells=[16,4]"])) else {
        panic!("no solver error")
    };
    assert!(text.contains("give a larger tolerance, or steps") && text.contains("phase \"indent\""), "{text}");
}

/// Steps that Newton's method gives up on are cut no further than to 1e-10 of the time at the end of their phase, where
/// eight cuts by four of the first step, of that length already, would go to 1.5e-15.
fn cuts_have_an_end(world: &SimpleCommunicator, _: &Path) {
    let scene = adaptive(1e-12, &["layer.cells=[16,4]"]);
    let end = scene.phases[0].duration;
    let Problem { mut strategy, mut tangent, mut u, phases, mut integrator, .. } =
        composition::build(world, &scene, Path::new("scene.toml")).unwrap();
    integrator.set_max_newton(0).unwrap();
    let mut ignored = Told::default();
    let outcome = Driver::new(strategy.as_mut(), &mut ignored, &phases).run(&mut integrator, &mut tangent, &mut u);
    let Err(Error::Solver(text)) = outcome else { panic!("no solver error") };
    let (_, rest) = text.split_once("cut down to ").unwrap();
    let shortest: f64 = rest.split(' ').next().unwrap().parse().unwrap();
    assert!(shortest > 0.2e-10 * end, "{text}");
}
