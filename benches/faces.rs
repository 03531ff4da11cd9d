//! What a step of a large face in space costs on one core: `cargo bench --bench faces [-- CASES...]`.
//!
//! A periodic layer of constant Poisson ratio and two arms over 64 cells of depth, pressed in three steps and slid in six (or pushed,
//! short of sliding), by default 128 x 128 cells along its face: `MPJR_FACE=512` for as many. Each case runs in a process of its own.
//! Counts are means over the steps of the last phase: Newton iterations, Fourier transforms of one component of all nodes; and
//! microseconds of user time a node and step, of the whole run but for its set-up over all steps too. Counts are exact; times are not on a
//! machine that is shared.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::process::Command;

use mpjr::composition::{Problem, build};
use mpjr::error::Result;
use mpjr::petsc::{Session, peak_memory};
use mpjr::scene::{self, Source};
use mpjr::solve::{Driver, Observer, Report};

/// The argument before what a child process shall run: the index of a case.
const CHILD: &str = "--case";

const LAYER: &str = r#"
[layer]
width = [1.0, 1.0]
depth = 0.5
cells = [NODES, NODES, 64]
grading = 8.0
sides = "periodic"
[material]
shear_modulus = 1e6
poisson_ratio = 0.45
arms = [ { weight = 0.3, time = 0.02 }, { weight = 0.4, time = 0.2 } ]
poisson_rule = "constant_ratio"
[contact]
[output]
energy = false
"#;

const SMOOTH: &str = "[indenter]\nprofile = \"sphere\"\nradius = 2.0\ncentre = [0.4, 0.5]\n";
/// A spectrum over the wavelengths from a quarter of the period down to eight cells.
const ROUGH: &str = "[indenter]\nprofile = \"rough\"\nhurst = 0.8\nrms_slope = 0.1\nshortest = SHORTEST\nlongest = 0.25\nperiod = 1.0\nseed = 1\n";
const FRICTION: &str = "[friction]\nlaw = \"coulomb\"\ncoefficient = 0.3\n";
/// Of a step of sliding, a cell.
const SLIDE: &str = "velocity = 1.0\nduration = SIXCELLS\nsteps = 6\n";
/// A tenth of what would make all slip.
const PUSH: &str = "tangential = { amplitude = AMPLITUDE, cycles = 0.25 }\nduration = 0.1\nsteps = 6\n";

/// Name, indenter, friction, approach, the last phase, the rule of Poisson's ratio.
type Kind = (&'static str, &'static str, &'static str, f64, &'static str, &'static str);

const CASES: [Kind; 9] = [
    ("frictionless, smooth", SMOOTH, "", 5e-3, SLIDE, ""),
    ("frictionless, rough", ROUGH, "", 4e-3, SLIDE, ""),
    ("gross sliding, smooth", SMOOTH, FRICTION, 5e-3, SLIDE, ""),
    ("gross sliding, rough", ROUGH, FRICTION, 4e-3, SLIDE, ""),
    ("partial slip, smooth", SMOOTH, FRICTION, 5e-3, PUSH, ""),
    ("partial slip, rough", ROUGH, FRICTION, 4e-3, PUSH, ""),
    ("sliding, constant bulk", SMOOTH, FRICTION, 5e-3, SLIDE, "constant_bulk_modulus"),
    ("rough, constant bulk", ROUGH, FRICTION, 4e-3, SLIDE, "constant_bulk_modulus"),
    ("frictionless, constant bulk", ROUGH, "", 4e-3, SLIDE, "constant_bulk_modulus"),
];

fn nodes() -> usize {
    std::env::var("MPJR_FACE").ok().and_then(|word| word.parse().ok()).unwrap_or(128)
}

fn scene_of((_, indenter, friction, approach, last, rule): Kind) -> String {
    let nodes = nodes();
    let text = format!(
        "{LAYER}{indenter}{friction}[[phase]]\nname = \"press\"\nduration = 0.1\nsteps = 3\napproach = {approach:?}\n[[phase]]\nname = \"go\"\n{last}"
    );
    // Seen from the friction bound of the deepest points: f times about half of the approach.
    let amplitude = 0.3 * approach * 0.5;
    let text = text
        .replace("NODES", &nodes.to_string())
        .replace("SHORTEST", &format!("{:?}", 8.0 / nodes as f64))
        .replace("SIXCELLS", &format!("{:?}", 6.0 / nodes as f64))
        .replace("AMPLITUDE", &format!("{amplitude:?}"));
    if rule.is_empty() { text } else { text.replace("constant_ratio", rule) }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.first().is_some_and(|first| first == CHILD) {
        return child(CASES[arguments[1].parse::<usize>().unwrap()]);
    }
    let chosen: Vec<usize> = arguments.iter().filter_map(|word| word.parse().ok()).collect();
    let nodes = nodes();
    println!("{nodes} x {nodes} nodes over 64 cells, one rank, tolerance 1e-8; means over the steps of the last phase");
    println!(
        "{:>28} {:>7} {:>11} {:>8} {:>8} {:>8} {:>7} {:>6} {:>6}",
        "", "newton", "transforms", "us/step", "us all", "setup s", "B/node", "area", "stick"
    );
    for (index, (name, ..)) in CASES.iter().enumerate().filter(|(index, _)| chosen.is_empty() || chosen.contains(index))
    {
        let mut command = Command::new(std::env::current_exe().unwrap());
        command.env("OMP_NUM_THREADS", "1").env("OPENBLAS_NUM_THREADS", "1").args([CHILD, &index.to_string()]);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        println!("{name:>28} {}", String::from_utf8(output.stdout).unwrap().trim_end());
    }
}

/// What was counted at the end of each step.
#[derive(Default)]
struct Counted {
    steps: Vec<(usize, usize, usize, f64)>,
    contact: [f64; 2],
}

impl Observer for Counted {
    fn observe(&mut self, report: Report<'_>) -> Result<()> {
        let totals = report.problem.contact()?.totals()?;
        self.contact = [totals.contact_fraction, totals.stick_fraction];
        let work = report.problem.work();
        self.steps.push((report.phase, report.counts.newton, work.transforms, user_time()));
        Ok(())
    }
}

/// Of this process so far, s.
fn user_time() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let ticks = stat.rsplit(')').next().unwrap().split_whitespace().nth(11).unwrap();
    ticks.parse::<f64>().unwrap() / 100.0
}

fn child(case: Kind) {
    let session = Session::start(&[]).unwrap();
    let source = Source { file: "faces.toml".into(), overrides: Vec::new() };
    let scene = scene::read(&scene_of(case), &source).unwrap();
    let idle = peak_memory() as f64;
    let problem = build(&session.world(), &scene, "faces.toml".as_ref()).unwrap();
    let Problem { mut strategy, mut tangent, mut u, phases, mut integrator, .. } = problem;
    let (mut counted, begun) = (Counted::default(), user_time());
    Driver::new(strategy.as_mut(), &mut counted, &phases).run(&mut integrator, &mut tangent, &mut u).unwrap();
    let nodes = (nodes() * nodes()) as f64;
    let before = counted.steps.iter().rev().find(|step| step.0 == 0).unwrap();
    let last = counted.steps.last().unwrap();
    let steps = counted.steps.iter().filter(|step| step.0 == 1).count() as f64;
    println!(
        "{:>7.1} {:>11.1} {:>8.2} {:>8.2} {:>8.2} {:>7.0} {:>6.3} {:>6.3}",
        (last.1 - before.1) as f64 / steps,
        (last.2 - before.2) as f64 / steps,
        (last.3 - before.3) / steps / nodes * 1e6,
        (last.3 - begun) / counted.steps.len() as f64 / nodes * 1e6,
        begun,
        (peak_memory() as f64 - idle) / nodes,
        counted.contact[0],
        counted.contact[1],
    );
}
