//! `mpjr sweep`: every case of a sweep, several at once, none twice.

mod board;
pub mod claim;
mod folder;
mod group;
mod slurm;
mod summary;
mod tasks;

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use self::board::Board;
use self::folder::Folder;
pub(super) use self::folder::replace;
use self::group::Group;
pub(super) use self::summary::line;
use self::tasks::Tasks;
use super::interrupt::Interrupt;
use super::telling::Telling;
use super::terminal;
use crate::composition::{Form, form};
use crate::error::{Error, Result};
use crate::output::reader::Results;
use crate::parallel::{agree, any, share_text};
use crate::petsc::Session;
use crate::scene::sweep::{self, Sweep};
use crate::scene::{self, Scene};
use crate::warnings::Warning;

/// With all unknowns in one system, one rank for so many of them.
const UNKNOWNS_PER_RANK: usize = 50_000;

/// The arguments of `mpjr sweep`.
#[derive(Args)]
pub struct SweepArguments {
    /// The sweep
    sweep: PathBuf,
    /// The directory of the results [default: the sweep's stem, in the current directory]
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Run one case only, counted from 0
    #[arg(long, value_name = "I")]
    case: Option<usize>,
    /// Print the cases and what has become of them; solve nothing
    #[arg(long, conflicts_with_all = ["case", "slurm"])]
    list: bool,
    /// Print an sbatch script that runs the cases as a job array; solve nothing
    #[arg(long, conflicts_with = "case")]
    slurm: bool,
    #[command(flatten)]
    batch: slurm::Batch,
    /// Ranks that solve a case together [default: from the size of the problem]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    ranks_per_case: Option<u32>,
    /// Print the summary as one JSON object on standard output, and nothing else there
    #[arg(long, conflicts_with_all = ["list", "slurm"])]
    json: bool,
    #[command(flatten)]
    telling: Telling,
    /// PETSc options, such as -ksp_type gmres -pc_type gamg
    #[arg(last = true, value_name = "PETSC OPTIONS")]
    petsc: Vec<String>,
}

/// Runs the sweep on all ranks of the launcher.
pub fn run(arguments: &SweepArguments) -> Result<()> {
    if arguments.list || arguments.slurm {
        return print(arguments);
    }
    arguments.telling.begin(arguments.json);
    let interrupt = Interrupt::watch()?;
    super::in_session(&arguments.petsc, |session, world| solve((session, world), &interrupt, arguments))
}

/// What needs no solver.
fn print(arguments: &SweepArguments) -> Result<()> {
    let sweep = sweep::receive(&read(&arguments.sweep)?)?;
    let out = directory(arguments);
    if !super::is_first_process() {
        return Ok(());
    }
    if arguments.slurm {
        let ranks = arguments.ranks_per_case.map_or_else(|| ranks_per_case(&sweep), |ranks| ranks as usize);
        terminal::answer(slurm::script(&arguments.sweep, &out, (sweep.cases.len(), ranks), &arguments.batch));
        return Ok(());
    }
    let folder = Folder::at(&out);
    for index in 0..sweep.cases.len() {
        let state = folder.state(&sweep, index).word();
        terminal::answer(format_args!("{index:4}  {state:13}  {}", sweep.label(index)));
    }
    Ok(())
}

fn solve(
    (session, world): (&Session, &SimpleCommunicator),
    interrupt: &Interrupt,
    arguments: &SweepArguments,
) -> Result<()> {
    let begun = Instant::now();
    let sweep = sweep::receive(&share_text(world, || read(&arguments.sweep))?)?;
    let out = directory(arguments);
    let made = if world.rank() == 0 {
        summary::may_write(&out).and_then(|()| Folder::make(&out))
    } else {
        Ok(Folder::at(&out))
    };
    let folder = agree(world, made)?;
    let chosen: Vec<usize> = match arguments.case {
        Some(case) if case < sweep.cases.len() => vec![case],
        Some(case) => {
            let last = sweep.cases.len() - 1;
            return Err(Error::Usage(format!("--case {case}: the sweep has the cases 0 to {last}")));
        }
        None => (0..sweep.cases.len()).collect(),
    };
    let ranks = match (arguments.ranks_per_case, arguments.case) {
        (Some(ranks), _) if ranks as i32 > world.size() => {
            let reason = format!("--ranks-per-case {ranks}: only {} rank(s) were started", world.size());
            return Err(Error::Usage(reason));
        }
        (Some(ranks), None) => ranks as usize,
        (_, Some(_)) => world.size() as usize,
        (None, None) => ranks_per_case(&sweep),
    };
    let run = share_text(world, || Ok(folder::run_id()))?;
    let board = (world.rank() == 0).then(|| Board::start(&folder, &sweep, &chosen, &run)).transpose();
    let board = agree(world, board)?;
    let tasks = Tasks::new(&sweep, &folder, &chosen, run);
    let worked = Group::split(world, ranks).work(session, interrupt, tasks);
    if let Err(error @ Error::Internal(_)) = &worked {
        // Other ranks may never get here.
        return Err(error.clone());
    }
    group::wait_for_all(world);
    drop(board);
    agree(world, worked)?;
    let stopped = any(world, interrupt.requested());
    let mine = if world.rank() == 0 { summary::write(&sweep, &folder) } else { Ok(()) };
    agree(world, mine)?;
    let mine = if world.rank() == 0 { tell((&sweep, &folder), arguments, &chosen, begun, stopped) } else { Ok(()) };
    agree(world, mine)
}

/// Failed cases that the last message names; the summary has them all.
const NAMED: usize = 3;

/// Prints how many cases are done, and what is doubtful about them; an error when one failed or is missing.
fn tell(
    (sweep, folder): (&Sweep, &Folder),
    arguments: &SweepArguments,
    chosen: &[usize],
    begun: Instant,
    stopped: bool,
) -> Result<()> {
    let (mut complete, mut failed, mut first_exit) = (0, Vec::new(), None);
    for &index in chosen {
        match folder.state(sweep, index) {
            folder::State::Complete => complete += 1,
            folder::State::Failed(record) => {
                first_exit.get_or_insert(record.exit);
                failed.push(format!("case {index} (exit code {}): {}", record.exit, record.reason))
            }
            _ => {}
        }
    }
    let doubts: Vec<Doubt> = doubts(folder, chosen);
    doubts.iter().for_each(|doubt| terminal::doubt(&doubt.warning()));
    let doubtful: usize = doubts.iter().map(|doubt| doubt.cases.len()).sum();
    let elapsed = begun.elapsed().as_secs_f64();
    let (total, directory) = (chosen.len(), folder.path().display());
    let counts = format!("{complete} of {total} case(s) complete, {} failed, {doubtful} warning(s)", failed.len());
    terminal::tell(format_args!("{counts}, in {}; {directory}/summary.csv", super::summary::seconds(elapsed)));
    if arguments.json {
        terminal::answer(serde_json::json!({
            "directory": directory.to_string(),
            "cases": total,
            "complete": complete,
            "failed": failed,
            "warnings": doubts.iter().map(|doubt| doubt.warning().to_string()).collect::<Vec<_>>(),
            "wall_seconds": elapsed,
        }));
    }
    if stopped && complete < total {
        return Err(Error::Stopped("stopped by a signal; start the same sweep again to go on with it".into()));
    }
    if failed.is_empty() {
        return arguments.telling.judge(doubtful);
    }
    let named = failed.iter().take(NAMED).map(String::as_str).collect::<Vec<_>>().join("; ");
    let text = format!("{} of {total} case(s) failed: {named}", failed.len());
    // The code is that of the first of them.
    Err(match first_exit {
        Some(2) => Error::Usage(text),
        Some(4) => Error::file(folder.path(), text),
        Some(1) => Error::Mismatch(text),
        _ => Error::Solver(text),
    })
}

/// A warning that cases have in common but for its numbers.
struct Doubt {
    key: String,
    /// As the first of them has it.
    text: String,
    cases: Vec<usize>,
}

impl Doubt {
    fn warning(&self) -> Warning {
        let Self { key, text, cases } = self;
        let others = match cases.len() {
            1 => String::new(),
            count => format!(" and {} more", count - 1),
        };
        Warning::new(key.clone(), format!("{text} (case {}{others})", cases[0]))
    }
}

/// The warnings in the results of the cases, one for each key.
fn doubts(folder: &Folder, cases: &[usize]) -> Vec<Doubt> {
    let mut list: Vec<Doubt> = Vec::new();
    for &case in cases {
        // A case without results has none.
        let found = Results::open(&folder.results(case)).and_then(|results| results.warnings()).unwrap_or_default();
        for warning in found {
            let (key, text) = warning.split_once(": ").unwrap_or((&warning, ""));
            match list.iter_mut().find(|doubt| doubt.key == key) {
                Some(doubt) if doubt.cases.contains(&case) => {}
                Some(doubt) => doubt.cases.push(case),
                None => list.push(Doubt { key: key.into(), text: text.into(), cases: vec![case] }),
            }
        }
    }
    list
}

fn read(file: &Path) -> Result<String> {
    sweep::read(&scene::open(file)?, file)
}

/// The sweep's stem in the current directory, unless named.
fn directory(arguments: &SweepArguments) -> PathBuf {
    let stem = || PathBuf::from(arguments.sweep.file_stem().unwrap_or_default());
    arguments.out.clone().unwrap_or_else(stem)
}

/// Enough for the largest layer. A condensed case has its unknowns on one rank; a mesh is not read for this.
fn ranks_per_case(sweep: &Sweep) -> usize {
    let scenes = sweep.cases.iter().map(|case| &case.scene).filter(|scene| form(scene) == Form::Monolithic);
    scenes.filter_map(Scene::layer).map(|layer| layer.unknowns().div_ceil(UNKNOWNS_PER_RANK)).max().unwrap_or(1)
}
