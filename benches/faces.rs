//! What a step of a large face in space costs on one core: `cargo bench --bench faces [-- CASES...]`.
//!
//! A periodic layer of constant Poisson ratio and two arms over 64 cells of depth, pressed in three steps and slid in six (or pushed,
//! short of sliding), by default 128 x 128 cells along its face: `MPJR_FACE=512` for as many. Each case runs in a process of its own.
//! Counts are means over the steps of the last phase: Newton iterations, Fourier transforms of one component of all nodes; and
//! microseconds of user time a node and step, of the whole run but for its set-up over all steps too. Counts are exact; times are not on a
//! machine that is shared.
//!
//! `MPJR_RANKS=1,2,4` solves each case on so many ranks and tells what passes between them in a step: totals, exchanges of spectra and what a
//! rank sends in them; seconds of a step by the clock, beside
//!
//! ```text
//! T(P) = T(1)/P + totals x t(P) + exchanges x x(P)
//! ```
//!
//! with t and x, the time of a total and of an exchange of one component, measured by themselves. Below it is what that model says of larger
//! machines, by the times that the table's head gives them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::process::Command;
use std::time::{Duration, Instant};

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use mpjr::composition::{Problem, build};
use mpjr::error::Result;
use mpjr::parallel::{Team, Traffic};
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
    let ranks: Vec<usize> = std::env::var("MPJR_RANKS")
        .map_or_else(|_| Vec::new(), |list| list.split(',').filter_map(|word| word.trim().parse().ok()).collect());
    let chosen: Vec<usize> = arguments.iter().filter_map(|word| word.parse().ok()).collect();
    if !ranks.is_empty() {
        return on_ranks(&ranks, &chosen);
    }
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

/// A step of one case on so many ranks.
struct Shared {
    ranks: f64,
    /// By the clock, and of the processor of the busiest rank, s.
    step: f64,
    busy: f64,
    totals: f64,
    exchanges: f64,
    /// Bytes that a rank sends.
    sent: f64,
    /// Of a total, and of an exchange of one component, s.
    total: f64,
    exchange: f64,
}

/// Of one core to one core, on a machine of many nodes: bytes a second, and seconds before the first of them.
const LINK: [f64; 2] = [2e9, 2e-6];

/// Each case on each number of ranks.
fn on_ranks(ranks: &[usize], chosen: &[usize]) {
    let nodes = nodes();
    println!("{nodes} x {nodes} nodes; seconds of a step of the last phase, what passes in it, and the model");
    println!(
        "{:>24} {:>6} {:>8} {:>8} {:>8} {:>7} {:>9} {:>9} {:>8} {:>9}",
        "", "ranks", "step", "busy", "model", "totals", "exchanges", "MB sent", "total us", "exch. us"
    );
    for (index, (name, ..)) in CASES.iter().enumerate().filter(|(index, _)| chosen.is_empty() || chosen.contains(index))
    {
        let all: Vec<Shared> = ranks.iter().map(|ranks| shared(index, *ranks)).collect();
        let alone = all.iter().find(|one| one.ranks == 1.0).map_or(f64::NAN, |one| one.step);
        for one in &all {
            let Shared { ranks, step, busy, totals, exchanges, sent, total, exchange } = one;
            let model = alone / ranks + totals * total + exchanges * exchange;
            println!(
                "{name:>24} {ranks:>6} {step:>8.3} {busy:>8.3} {model:>8.3} {totals:>7.0} {exchanges:>9.0} {:>9.1} {:>8.1} {:>9.0}",
                sent / 1e6,
                total * 1e6,
                exchange * 1e6
            );
        }
        if let Some(Shared { ranks, totals, exchanges, sent, .. }) = all.last().filter(|one| one.ranks > 1.0) {
            // Of P - 1 parts of P each rank sends as much as of one, P times less.
            let bytes = |p: f64| sent * ranks / (ranks - 1.0) * ranks * (p - 1.0) / (p * p);
            let at = |p: f64| {
                let [rate, latency] = LINK;
                alone / p + totals * latency * p.log2() + exchanges * latency * (p - 1.0) + bytes(p) / rate
            };
            let line: Vec<String> =
                [4.0, 8.0, 16.0, 32.0, 64.0, 128.0].iter().map(|p| format!("{p}: {:.1}", alone / at(*p))).collect();
            println!("{:>24} times as fast by the model, links of 2 GB/s and 2 us: {}", "", line.join(", "));
        }
    }
}

/// One case on so many ranks.
fn shared(index: usize, ranks: usize) -> Shared {
    let mut command = Command::new("mpirun");
    command.env("OMP_NUM_THREADS", "1").env("OPENBLAS_NUM_THREADS", "1");
    command.args(["-n", &ranks.to_string()]).arg(std::env::current_exe().unwrap()).args([
        CHILD,
        &index.to_string(),
        CHILD,
    ]);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let [step, busy, totals, exchanges, sent, total, exchange] = numbers.try_into().unwrap();
    Shared { ranks: ranks as f64, step, busy, totals, exchanges, sent, total, exchange }
}

/// Tells the numbers of [`Shared`] of the last phase, on the first rank.
fn tell_shared(world: &SimpleCommunicator, counted: &Counted, team: &Team) {
    let before = counted.traffic.iter().rev().find(|step| step.0 == 0).unwrap();
    let last = counted.traffic.last().unwrap();
    let steps = counted.traffic.iter().filter(|step| step.0 == 1).count() as f64;
    let whole = Team::of(world, [world.size() as usize, 1]);
    let [busy] = whole.most([(last.2 - before.2) / steps]);
    let [ranks, rank] = team.ranks();
    let least = |repeat: usize, call: &mut dyn FnMut()| {
        let times = (0..repeat).map(|_| {
            let begun = Instant::now();
            call();
            begun.elapsed().as_secs_f64()
        });
        let mut times: Vec<f64> = times.collect();
        times.sort_by(f64::total_cmp);
        times[repeat / 2]
    };
    let total = least(501, &mut || {
        team.sum([1.0; 3]);
    });
    // Of one component a rank has this many numbers for each.
    let part = nodes() * (nodes() / 2 + 1) * 2 / (ranks * ranks);
    let places: Vec<_> = (0..ranks).map(|rank| rank * part..(rank + 1) * part).collect();
    let (from, mut to) = (vec![0.0; ranks * part], vec![0.0; ranks * part]);
    let exchange = least(31, &mut || team.exchange((&from, &places), (&mut to, &places)));
    if rank > 0 {
        return;
    }
    let of = |what: fn(&Traffic) -> usize| (what(&last.3) - what(&before.3)) as f64 / steps;
    println!(
        "{} {busy} {} {} {} {total} {exchange}",
        (last.1 - before.1).as_secs_f64() / steps,
        of(|traffic| traffic.reductions),
        of(|traffic| traffic.exchanges),
        of(|traffic| traffic.sent),
    );
}

/// What was counted at the end of each step.
#[derive(Default)]
struct Counted {
    steps: Vec<(usize, usize, usize, f64)>,
    contact: [f64; 2],
    /// Phase, the clock, time of the processor, s, and what passed between ranks.
    traffic: Vec<(usize, Duration, f64, Traffic)>,
    begun: Option<Instant>,
}

impl Observer for Counted {
    fn observe(&mut self, report: Report<'_>) -> Result<()> {
        let mut contact = report.problem.contact()?;
        let (totals, traffic) = (contact.totals()?, contact.team().traffic());
        let clock = self.begun.get_or_insert_with(Instant::now).elapsed();
        self.traffic.push((report.phase, clock, user_time(), traffic));
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
    if std::env::args().filter(|word| word == CHILD).count() > 1 {
        let world = session.world();
        let mut contact = strategy.contact().unwrap();
        contact.totals().unwrap();
        return tell_shared(&world, &counted, contact.team());
    }
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
