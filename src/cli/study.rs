//! `mpjr study`: accuracy against cost.

use std::path::{Path, PathBuf};

use clap::Args;
use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use toml::{Table, Value};

use super::summary::seconds;
use super::sweep::{line, replace};
use super::telling::Telling;
use super::terminal;
use crate::error::{Error, Result};
use crate::output::ours;
use crate::parallel::agree;
use crate::plot::replaceable;
use crate::scene::Source;
use crate::study::advice::{self, Advice};
use crate::study::ladder::{self, Ladder};
use crate::study::{Climbed, Difference, Run, Solver, Subject, figure, roughness};

/// The arguments of `mpjr study`.
#[derive(Args)]
pub struct StudyArguments {
    /// The scene
    scene: PathBuf,
    /// Change a key of the scene throughout
    #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
    /// A ladder from coarse to fine, such as layer.cells=[32,32],[64,64]; instead of those that the scene suggests
    #[arg(long = "vary", value_name = "KEY.PATH=VALUE,VALUE")]
    vary: Vec<String>,
    /// Print only the cheapest settings that meet this error, such as 0.01, as --set options
    #[arg(long, value_name = "ERROR")]
    error: Option<f64>,
    /// Where the tables and the figure go, made if need be [default: the scene's stem + -study; with --error nowhere]
    #[arg(short, long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    telling: Telling,
}

/// The errors that are advised on.
const TARGETS: [f64; 4] = [0.1, 0.03, 0.01, 0.003];

/// Climbs the ladders on all ranks of the launcher; rank 0 tells.
pub fn run(arguments: &StudyArguments) -> Result<()> {
    if let Some(error) = arguments.error.filter(|error| !(*error > 0.0 && *error < 1.0)) {
        return Err(Error::Usage(format!("--error {error}: must be above 0 and below 1, such as 0.01 for 1 %")));
    }
    arguments.telling.begin(false);
    super::in_session(&[], |_, world| climb(world, arguments))
}

/// What a study came to.
struct Findings<'a> {
    file: &'a Path,
    base: Run,
    climbed: Vec<Climbed>,
    advised: Vec<Option<Advice>>,
    /// The error of the scene as it is, where the finest rungs all together could be solved.
    error: Option<f64>,
}

fn climb(world: &SimpleCommunicator, arguments: &StudyArguments) -> Result<()> {
    let tells = world.rank() == 0;
    let chatty = tells && arguments.error.is_none();
    let file = &arguments.scene;
    let subject = Subject::read(world, Source { file: file.clone(), overrides: arguments.set.clone() })?;
    let ladders = ladders(&subject, &arguments.vary)?;
    let out = arguments.out.clone().or_else(|| arguments.error.is_none().then(|| default_output(file)));
    if let Some(out) = &out {
        agree(world, if tells { prepare(out) } else { Ok(()) })?;
    }
    let tell = |changes: &str, run: Option<&Run>| {
        if chatty {
            terminal::tell(told(changes, run));
        }
    };
    let mut solver = Solver::new(&subject, &tell);
    let write = |work: &dyn Fn(&Path) -> Result<()>| match &out {
        Some(out) => agree(world, if tells { work(out) } else { Ok(()) }),
        None => Ok(()),
    };
    let Some(base) = solver.run(&[])? else {
        return Err(Error::Solver(format!("{}: cannot be studied as it is: {}", file.display(), solver.reason())));
    };
    let doubtful = base.warnings.len();
    if tells {
        base.warnings.iter().for_each(terminal::doubt);
    }
    let mut findings = Findings { file, base, climbed: Vec::new(), advised: Vec::new(), error: None };
    // What is found is kept at once: the finest rungs all together may take long, or be too much.
    for ladder in ladders {
        findings.climbed.push(solver.climb(ladder)?);
        write(&|out| findings.write_runs(out))?;
    }
    if chatty {
        terminal::tell(findings.ladders());
        if let Some(line) = roughness::resolved(&subject.with(&[])?, &findings.climbed) {
            terminal::tell(line);
        }
    }
    let targets = arguments.error.map_or(TARGETS.to_vec(), |error| vec![error]);
    let finest = solver.run(&advice::finest(&findings.climbed))?;
    if let Some(finest) = &finest {
        let Findings { base, climbed, .. } = &findings;
        let error = Difference::between(&base.history, &finest.history).error() + findings.left();
        let advised = advice::advise(&mut solver, climbed, (base, finest), &targets)?;
        (findings.error, findings.advised) = (Some(error), advised);
    }
    write(&|out| findings.write(out))?;
    if finest.is_none() {
        return Err(Error::Solver(format!(
            "{}: no error can be told, as the finest of all ladders together could not be solved: {}; give ladders that \
             end before them, with --vary",
            file.display(),
            solver.reason()
        )));
    }
    if chatty {
        terminal::tell(findings.advice());
    }
    match (arguments.error, findings.advised.first()) {
        (Some(_), Some(Some(advice))) => {
            if tells {
                terminal::answer(options(&advice.changes));
            }
            arguments.telling.judge(doubtful)
        }
        (Some(error), _) => Err(Error::Usage(format!(
            "--error {error}: no setting on these ladders meets it (the finest leave about {:.1e}); give finer ones with --vary",
            findings.left()
        ))),
        (None, _) => {
            if let (true, Some(out)) = (tells, &out) {
                terminal::tell(format_args!("tables and figure: {}", out.display()));
            }
            arguments.telling.judge(doubtful)
        }
    }
}

fn ladders(subject: &Subject, vary: &[String]) -> Result<Vec<Ladder>> {
    let scene = subject.with(&[])?;
    if vary.is_empty() {
        return ladder::default(subject, &scene);
    }
    let ladders = vary.iter().map(|typed| ladder::parse(typed, &scene)).collect::<Result<Vec<_>>>()?;
    // A value that the scene does not take is known before anything is solved.
    for setting in ladders.iter().flat_map(|ladder| &ladder.rungs) {
        subject.with(&setting.changes)?;
    }
    Ok(ladders)
}

fn default_output(scene: &Path) -> PathBuf {
    let mut name = scene.file_stem().unwrap_or_default().to_owned();
    name.push("-study");
    PathBuf::from(name)
}

/// Makes the directory, and sees that what is in it may be replaced before anything is solved.
fn prepare(out: &Path) -> Result<()> {
    std::fs::create_dir_all(out).map_err(|error| Error::file(out, error))?;
    let header = HEADER.join(",");
    for (name, mark) in [("runs.csv", header.as_str()), ("study.toml", MARK)] {
        ours::make_way_for_table(&out.join(name), |line| line == mark)?;
    }
    ["png", "svg"].iter().try_for_each(|kind| replaceable(&out.join(format!("work-precision.{kind}"))))
}

fn told(changes: &str, run: Option<&Run>) -> String {
    let changes = if changes.is_empty() { "as it is" } else { changes };
    match run {
        Some(run) => format!("{changes}: {} steps, {} Newton, {}", run.steps, run.newton, seconds(run.seconds)),
        None => format!("{changes}: no convergence"),
    }
}

/// `--set key=value ...`, for a shell.
fn options(changes: &[String]) -> String {
    // What `$(mpjr study ...)` puts into a command line is cut at blanks, and quotes stay in it: brackets and commas go
    // without, as no file has such a name.
    let plain = |c: char| c.is_ascii_alphanumeric() || "._=-+[],/:".contains(c);
    let quoted = |change: &String| match change.chars().all(plain) {
        true => format!("--set {change}"),
        false => format!("--set '{}'", change.replace('\'', r"'\''")),
    };
    changes.iter().map(quoted).collect::<Vec<_>>().join(" ")
}

const MARK: &str = "# Written by mpjr study.";
const HEADER: [&str; 11] = [
    "ladder",
    "setting",
    "changes",
    "steps",
    "newton",
    "seconds",
    "memory",
    "error_normal_force",
    "error_tangential_force",
    "error_hysteretic_force",
    "error",
];

impl Findings<'_> {
    /// The error that the finest rungs leave all together.
    fn left(&self) -> f64 {
        self.climbed.iter().map(|ladder| ladder.finest).sum()
    }

    /// What the ladders came to, for the terminal.
    fn ladders(&self) -> String {
        let mut text = format!("\n{:<28} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "", "time", "N", "Q", "hyster.", "error");
        for ladder in &self.climbed {
            let order = ladder.order.map_or("no clean order".to_owned(), |order| format!("order {order:.2}"));
            let order = if ladder.ladder.ratio.is_some() { format!(", {order}") } else { String::new() };
            text += &format!("{}{order}\n", ladder.ladder.name);
            for (setting, rung) in ladder.ladder.rungs.iter().zip(&ladder.rungs) {
                let label = &setting.label;
                text += &match &rung.run {
                    None => format!("  {label:<26} {:>9}\n", "no convergence"),
                    Some(run) => {
                        let Difference { normal, tangential, hysteretic, .. } = rung.difference;
                        let time = seconds(run.seconds);
                        let error = rung.error;
                        format!(
                            "  {label:<26} {time:>9} {normal:>9.1e} {tangential:>9.1e} {hysteretic:>9.1e} {error:>9.1e}\n"
                        )
                    }
                };
            }
        }
        text
    }

    /// What is best, for the terminal.
    fn advice(&self) -> String {
        let error = self.error.map_or(String::new(), |error| format!(", error {error:.1e}"));
        let mut text = format!("\nas it is: {}{error}\n", seconds(self.base.seconds));
        for (target, advice) in TARGETS.iter().zip(&self.advised) {
            text += &match advice {
                None => format!("for {} %: nothing on these ladders meets it\n", 100.0 * target),
                Some(advice) => format!(
                    "for {} %: {}, {:.2} GB, error {:.1e}\n    {}\n",
                    100.0 * target,
                    seconds(advice.seconds),
                    advice.memory / 1e9,
                    advice.error,
                    options(&advice.changes)
                ),
            };
        }
        text
    }

    /// `runs.csv`: the ladders climbed so far.
    fn write_runs(&self, out: &Path) -> Result<()> {
        replace(&out.join("runs.csv"), &self.csv())
    }

    /// `study.toml`, `work-precision.png` and `.svg`.
    fn write(&self, out: &Path) -> Result<()> {
        replace(&out.join("study.toml"), &self.toml()?)?;
        let stem = self.file.file_stem().unwrap_or_default().to_string_lossy();
        figure::work_precision(&stem, &self.climbed, &self.advised).write(&out.join("work-precision")).map(|_| ())
    }

    fn csv(&self) -> String {
        let mut text = line(HEADER.iter().map(|&name| name.to_owned()));
        for ladder in &self.climbed {
            for (setting, rung) in ladder.ladder.rungs.iter().zip(&ladder.rungs) {
                let names = [ladder.ladder.name.clone(), setting.label.clone(), options(&setting.changes)];
                let numbers = rung.run.as_ref().map(|run| {
                    let Difference { normal, tangential, hysteretic, .. } = rung.difference;
                    let counts = [run.steps, run.newton].map(|count| count.to_string());
                    let numbers = [run.seconds, run.memory, normal, tangential, hysteretic, rung.error];
                    counts.into_iter().chain(numbers.map(|number| format!("{number:e}"))).collect::<Vec<_>>()
                });
                let numbers = numbers.unwrap_or(vec![String::new(); HEADER.len() - names.len()]);
                text += &line(names.into_iter().chain(numbers));
            }
        }
        text
    }

    fn toml(&self) -> Result<String> {
        let table = |pairs: Vec<(&str, Value)>| -> Table {
            pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
        };
        let ladders = self.climbed.iter().map(|ladder| {
            let order = ladder.order.map(|order| ("order", Value::Float(order)));
            let name = Value::String(ladder.ladder.name.clone());
            let mut pairs = vec![("name", name), ("error_of_the_finest", Value::Float(ladder.finest))];
            pairs.extend(order);
            Value::Table(table(pairs))
        });
        let advice = self.advised.iter().flatten().map(|advice| {
            Value::Table(table(vec![
                ("target", Value::Float(advice.target)),
                ("error", Value::Float(advice.error)),
                ("seconds", Value::Float(advice.seconds)),
                ("memory", Value::Float(advice.memory)),
                ("set", Value::Array(advice.changes.iter().cloned().map(Value::String).collect())),
            ]))
        });
        let mut all = table(vec![
            ("scene", Value::String(self.file.display().to_string())),
            ("seconds", Value::Float(self.base.seconds)),
            ("error_of_the_finest", Value::Float(self.left())),
            ("ladder", Value::Array(ladders.collect())),
            ("advice", Value::Array(advice.collect())),
        ]);
        all.extend(self.error.map(|error| ("error".to_owned(), Value::Float(error))));
        let text =
            toml::to_string(&all).map_err(|error| Error::Internal(format!("a study has no form in TOML: {error}")))?;
        Ok(format!("{MARK}\n{text}"))
    }
}
