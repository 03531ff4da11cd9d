//! A face that ranks share: the numbers do not depend on how many there are, and a state goes on on as many as one likes.
//!
//! Four ranks are started; the first of them, the first two, three and all four solve each scene. Sums are taken in another order, and
//! nothing else differs: histories, contact faces and bulk fields agree to 1e-9 of the largest value of each, at a solver tolerance of 1e-12.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::Path;

use common::mpi::{Case, main as run_cases};
use mpi::topology::{Color, SimpleCommunicator};
use mpi::traits::Communicator;
use mpjr::composition::{Problem, build, shares_face};
use mpjr::error::Result;
use mpjr::output::HistoryRow;
use mpjr::scene::{self, Scene, Source};
use mpjr::snapshot::Snapshot;
use mpjr::solution::{self, Solution, row};
use mpjr::solve::{Driver, Observer, Position, Report};

const CASES: &[Case] = &[
    Case::new("ranks_give_the_same", &[4], ranks_give_the_same),
    Case::new("a_state_goes_on_on_other_ranks", &[4], a_state_goes_on_on_other_ranks),
    Case::new("what_one_rank_meets_all_are_told", &[3], what_one_rank_meets_all_are_told),
];

fn main() {
    run_cases(CASES);
}

/// 21 lines of 24 nodes: of no number of ranks but 1 and 3 do all have as many. Slid obliquely by more than two lines a step.
const LAYER: &str = r#"
[layer]
width = [1.0, 1.0]
depth = 0.5
cells = [21, 24, 4]
sides = "periodic"
[material]
shear_modulus = 1e6
poisson_ratio = 0.45
arms = [ { weight = 0.3, time = 0.02 }, { weight = 0.4, time = 0.2 } ]
poisson_rule = "constant_ratio"
[contact]
[solver]
tolerance = 1e-12
"#;
const SPHERE: &str = "[indenter]\nprofile = \"sphere\"\nradius = 2.0\ncentre = [0.9, 0.5]\n";
/// With a kink, along both axes.
const CONE: &str = "[indenter]\nprofile = \"cone\"\nslope = 0.1\ncentre = [0.9, 0.5]\n";
const FRICTION: &str = "[friction]\nlaw = \"coulomb\"\ncoefficient = 0.3\n";
const HELD: &str = "[[phase]]\nname = \"press\"\nduration = 0.1\nsteps = 3\napproach = 2e-2\n";
const LOADED: &str = "[[phase]]\nname = \"press\"\nduration = 0.1\nsteps = 3\nnormal_force = 2e3\n";
const SLID: &str = "[[phase]]\nname = \"go\"\nvelocity = [1.0, 0.4]\nduration = 0.3\nsteps = 3\n";
const PUSHED: &str =
    "[[phase]]\nname = \"go\"\ntangential = { amplitude = [2e-3, 1e-3], cycles = 0.4 }\nduration = 0.1\nsteps = 4\n";

fn read(parts: &[&str]) -> Scene {
    let source = Source { file: "shared.toml".into(), overrides: Vec::new() };
    let scene = scene::read(&parts.concat(), &source).unwrap();
    assert!(shares_face(&scene, 4) && !shares_face(&scene, 1));
    scene
}

/// Name, and scene.
fn scenes() -> Vec<(&'static str, Scene)> {
    let bulk = LAYER.replace("constant_ratio", "constant_bulk_modulus");
    let wear = "[wear]\nof = \"indenter\"\nlaw = \"archard\"\ncoefficient = 1e-9\n";
    let body = "[wear]\nof = \"body\"\nlaw = \"energy\"\ncoefficient = 1e-9\n";
    let mounts =
        "[mount]\nnormal = { load = 2e3, stiffness = 1e4 }\ntangential = { stiffness = 2e4, damping = 10.0 }\n";
    let output = "[output]\nbulk_at = [\"go\"]\n";
    let fading = "[friction]\nlaw = \"coulomb\"\ncoefficient = \"0.2 + 0.1*exp(-v/0.5)\"\n";
    let adaptive = LOADED.replace("steps = 3", "tolerance = 1e-2");
    let moving = "[[phase]]\nname = \"go\"\nvelocity = [0.1, 0.0]\nduration = 0.1\n";
    vec![
        ("without friction", read(&[LAYER, SPHERE, output, HELD, SLID])),
        ("without friction, bulk", read(&[&bulk, SPHERE, HELD, SLID])),
        ("without friction, under a force", read(&[LAYER, SPHERE, LOADED, SLID])),
        ("sliding, bulk", read(&[&bulk, CONE, FRICTION, output, HELD, SLID])),
        ("partial slip", read(&[LAYER, SPHERE, FRICTION, LOADED, PUSHED])),
        (
            "mounts",
            read(&[LAYER, SPHERE, FRICTION, mounts, "[[phase]]\nname = \"press\"\nduration = 0.1\nsteps = 3\n", SLID]),
        ),
        ("worn indenter", read(&[LAYER, SPHERE, FRICTION, wear, HELD, SLID])),
        ("worn body", read(&[LAYER, SPHERE, FRICTION, body, HELD, SLID])),
        ("friction that falls", read(&[LAYER, SPHERE, fading, HELD, SLID])),
        ("adaptive", read(&[LAYER, SPHERE, FRICTION, &adaptive, &format!("{moving}tolerance = 1e-2\n")])),
    ]
}

/// The first `ranks` of the world; none on the others. Collective.
fn first(world: &SimpleCommunicator, ranks: usize) -> Option<SimpleCommunicator> {
    let color = if (world.rank() as usize) < ranks { Color::with_value(1) } else { Color::undefined() };
    world.split_by_color(color)
}

/// All numbers of a row that have a scale of their own; what is 0 by symmetry is measured by what is not.
fn numbers(history: &[HistoryRow]) -> Vec<(&'static str, Vec<f64>)> {
    let of = |number: &dyn Fn(&HistoryRow) -> f64| history.iter().map(number).collect::<Vec<f64>>();
    let both = |x: &dyn Fn(&HistoryRow) -> f64, y: &dyn Fn(&HistoryRow) -> f64| [of(x), of(y)].concat();
    let work = |part: &dyn Fn(&HistoryRow) -> f64| both(&|row| row.energy.external_work, part);
    vec![
        ("time", of(&|row| row.time)),
        ("approach", of(&|row| row.approach)),
        ("sliding", both(&|row| row.sliding, &|row| row.across.sliding)),
        ("normal_force", of(&|row| row.normal_force)),
        (
            "tangential_force",
            [of(&|row| row.normal_force), both(&|row| row.tangential_force, &|row| row.across.tangential_force)]
                .concat(),
        ),
        (
            "hysteretic_force",
            [of(&|row| row.normal_force), both(&|row| row.hysteretic_force, &|row| row.across.hysteretic_force)]
                .concat(),
        ),
        ("contact_fraction", of(&|row| row.contact_fraction)),
        ("stick_fraction", of(&|row| row.stick_fraction)),
        // The root of a sum that cancels where nothing oscillates: of its square round-off is no more than of the others.
        ("traction_oscillation", of(&|row| row.traction_oscillation.powi(2))),
        ("worn_volume", of(&|row| row.worn_volume)),
        ("mount_normal", of(&|row| row.mount_normal)),
        ("stored", work(&|row| row.energy.stored)),
        ("viscoelastic_dissipation", work(&|row| row.energy.viscoelastic_dissipation)),
        ("friction_dissipation", work(&|row| row.energy.friction_dissipation)),
        ("wear", work(&|row| row.energy.wear)),
        ("imbalance", work(&|row| row.energy.imbalance)),
    ]
}

fn close(what: &str, a: &[f64], b: &[f64]) {
    assert_eq!(a.len(), b.len(), "{what}");
    let largest = a.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let apart = a.iter().zip(b).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(apart <= 1e-9 * largest, "{what}: {apart:e} of {largest:e}");
}

fn same_history(what: &str, a: &[HistoryRow], b: &[HistoryRow]) {
    for ((name, a), (_, b)) in numbers(a).into_iter().zip(numbers(b)) {
        close(&format!("{what}: {name}"), &a, &b);
    }
}

/// Bulk fields node by node, whichever rank had them. Collective.
fn bulk(comm: &SimpleCommunicator, solution: &Solution) -> Vec<f64> {
    let mut all: Vec<(usize, [f64; 9])> = Vec::new();
    for fields in &solution.bulk {
        for ((node, u), stress) in fields.nodes.iter().zip(&fields.displacement).zip(&fields.stress) {
            let [xx, yy, zz, xy, yz, xz] = stress.map(|stress| stress / 1e6);
            all.push((*node, [u[0], u[1], u[2], xx, yy, zz, xy, yz, xz]));
        }
    }
    let flat: Vec<f64> = all.iter().flat_map(|(node, values)| std::iter::once(*node as f64).chain(*values)).collect();
    // A team of as many lines as ranks says one list after the other.
    let whole = mpjr::parallel::Team::of(comm, [comm.size() as usize, 1]).collected(flat);
    let mut nodes: Vec<&[f64]> = whole.chunks_exact(10).collect();
    nodes.sort_by(|a, b| a[0].total_cmp(&b[0]));
    nodes.concat()
}

fn ranks_give_the_same(world: &SimpleCommunicator, _: &Path) {
    for (name, scene) in scenes() {
        let mut alone: Option<(Solution, Vec<f64>)> = None;
        for ranks in 1..=4 {
            let Some(comm) = first(world, ranks) else { continue };
            let solution = solution::solve(&comm, &scene).unwrap();
            let bulk = bulk(&comm, &solution);
            assert_eq!(bulk.is_empty(), comm.rank() > 0 || scene.output.bulk_at.is_empty(), "{name}");
            let Some((expected, fields)) = &alone else {
                let last = solution.last();
                assert!(last.normal_force > 100.0 && last.contact_fraction < 0.6, "{name}: {last:?}");
                alone = Some((solution, bulk));
                continue;
            };
            // Every rank that was there before compares.
            let what = format!("{name} on {ranks}");
            same_history(&what, &expected.history, &solution.history);
            if comm.rank() == 0 {
                close(&what, fields, &bulk);
            }
            for (a, b) in expected.ends.iter().zip(&solution.ends) {
                for (field, a, b) in [
                    ("pressure", &a.pressure, &b.pressure),
                    ("shear", &a.shear, &b.shear),
                    ("gap", &a.gap, &b.gap),
                    ("slip_rate", &a.slip_rate, &b.slip_rate),
                    ("displacement", &a.displacement, &b.displacement),
                    ("worn_depth", &a.worn_depth, &b.worn_depth),
                    ("worn_profile", &a.worn_profile, &b.worn_profile),
                ] {
                    close(&format!("{what}: {field}"), a, b);
                }
            }
        }
    }
}

/// Keeps the history, and the state after a step.
struct Kept {
    after: usize,
    history: Vec<HistoryRow>,
    state: Option<(Snapshot, Position)>,
}

impl Observer for Kept {
    fn observe(&mut self, mut report: Report<'_>) -> Result<()> {
        self.history.push(row(&mut report)?);
        if self.history.len() == self.after {
            let mut snapshot = Snapshot::default();
            report.problem.save(report.u, &mut snapshot)?;
            self.state = report.next.map(|next| (snapshot, next));
        }
        Ok(())
    }
}

/// Runs a scene on `comm`, from a state on its first rank if there is one. Collective.
fn run(comm: &SimpleCommunicator, scene: &Scene, from: Option<(Snapshot, Position)>, after: usize) -> Kept {
    let Problem { mut strategy, mut tangent, mut u, phases, mut integrator, .. } =
        build(comm, scene, "shared.toml".as_ref()).unwrap();
    let mut kept = Kept { after, history: Vec::new(), state: None };
    let position = from.map(|(snapshot, position)| {
        strategy.restore(&snapshot.shared(comm), &mut u).unwrap();
        position
    });
    let mut driver = Driver::new(strategy.as_mut(), &mut kept, &phases);
    if let Some(position) = position {
        let counts = driver.counts();
        driver = driver.at(position, counts);
    }
    driver.run(&mut integrator, &mut tangent, &mut u).unwrap();
    kept
}

/// A state of three ranks goes on on one, two and four as it does on three, one of one rank on four: the steps after it agree to 1e-9.
fn a_state_goes_on_on_other_ranks(world: &SimpleCommunicator, _: &Path) {
    let chosen = ["sliding, bulk", "worn indenter", "mounts", "without friction"];
    for (name, scene) in scenes().into_iter().filter(|(name, _)| chosen.contains(name)) {
        for (before, after) in [(3, [1, 2, 4]), (1, [2, 3, 4])] {
            let whole = first(world, before).map(|comm| run(&comm, &scene, None, 4));
            // Only the first rank has a whole state, and only those that ran before know the position.
            for ranks in after {
                let Some(comm) = first(world, ranks) else { continue };
                let state = whole.as_ref().and_then(|whole| whole.state.clone());
                let position = positions(&comm, state.as_ref());
                let snapshot = state.map_or_else(Snapshot::default, |(snapshot, _)| snapshot);
                let rest = run(&comm, &scene, Some((snapshot, position)), 0);
                if comm.rank() == 0 {
                    let expected = &whole.as_ref().unwrap().history;
                    assert_eq!(rest.history.len() + 4, expected.len());
                    same_history(&format!("{name} from {before} on {ranks}"), &expected[4..], &rest.history);
                }
            }
        }
    }
}

/// The position of the first rank, on all. Collective.
fn positions(comm: &SimpleCommunicator, state: Option<&(Snapshot, Position)>) -> Position {
    let mut mine = Snapshot::default();
    if let Some((_, position)) = state {
        position.save(&mut mine);
    }
    Position::restore(&mine.shared(comm)).unwrap()
}

/// A formula that is not known beyond a place that only one rank meets: all are told, and none waits.
fn what_one_rank_meets_all_are_told(world: &SimpleCommunicator, _: &Path) {
    let profile =
        "[indenter]\nprofile = \"expression\"\nformula = \"0.2*(x - 0.5)^2 + 0.2*(y - 0.5)^2 + 0*sqrt(0.9 - x)\"\n";
    let source = Source { file: "shared.toml".into(), overrides: Vec::new() };
    let scene = match scene::read(&[LAYER, profile, HELD].concat(), &source) {
        Ok(scene) => scene,
        Err(error) => panic!("{error}"),
    };
    let told = solution::solve(world, &scene).map(|_| ()).unwrap_err().to_string();
    assert!(told.contains("0.9") || told.contains("x = 0.9"), "{told}");
}
