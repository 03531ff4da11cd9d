//! Runs the real program on a scene, in a directory of its own.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};
use std::time::{Duration, Instant};

use mpjr::output::{checkpoint, reader::Results};
use tempfile::TempDir;

use super::mpi::mpirun;

/// The program.
pub const MPJR: &str = env!("CARGO_BIN_EXE_mpjr");

/// `mpjr run scene.toml` in a fresh directory.
pub struct Run {
    directory: TempDir,
    arguments: Vec<String>,
    petsc: Vec<String>,
    ranks: usize,
}

/// What came of it.
#[derive(Debug)]
pub struct Outcome {
    /// Where it ran; removed when dropped.
    pub directory: TempDir,
    /// The exit code.
    pub code: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Run {
    /// With `scene` as the text of the scene, on one rank without a launcher.
    pub fn new(scene: &str) -> Self {
        let directory = tempfile::tempdir().unwrap();
        std::fs::write(directory.path().join("scene.toml"), scene).unwrap();
        Self { directory, arguments: vec!["run".into(), "scene.toml".into()], petsc: Vec::new(), ranks: 1 }
    }

    /// With `--set` of each of the changes.
    pub fn changed(scene: &str, changes: &[&str]) -> Self {
        changes.iter().fold(Self::new(scene), |run, change| run.set(*change))
    }

    /// Where it will run.
    pub fn directory(&self) -> PathBuf {
        self.directory.path().to_owned()
    }

    /// With `--set KEY=VALUE`.
    pub fn set(self, assignment: impl Into<String>) -> Self {
        let mut run = self.argument("--set");
        run.arguments.push(assignment.into());
        run
    }

    /// With one more argument before the PETSc options.
    pub fn argument(mut self, argument: &str) -> Self {
        self.arguments.push(argument.into());
        self
    }

    /// With PETSc options, separated by spaces.
    pub fn petsc(mut self, options: &str) -> Self {
        self.petsc.extend(options.split_whitespace().map(str::to_owned));
        self
    }

    /// Under `mpirun -n RANKS`, also for one.
    pub fn ranks(mut self, ranks: usize) -> Self {
        self.ranks = ranks;
        self
    }

    /// The command as it stands.
    pub fn command(&self) -> Command {
        let mut command = program(self.ranks);
        command.current_dir(&self.directory).args(&self.arguments);
        if !self.petsc.is_empty() {
            command.arg("--").args(&self.petsc);
        }
        command
    }

    /// Runs to its end, whatever that is.
    pub fn run(self) -> Outcome {
        let output = self.command().output().unwrap();
        Outcome::new(output, self.directory)
    }

    /// Runs and must succeed; gives the results.
    pub fn done(self) -> Outcome {
        let outcome = self.run();
        assert_eq!(outcome.code, 0, "{}{}", outcome.stdout, outcome.stderr);
        outcome
    }
}

/// What comes of a scene with `--set` of each of the changes; it must succeed.
pub fn solved(scene: &str, changes: &[&str]) -> Outcome {
    Run::changed(scene, changes).done()
}

/// What a scene writes that is run in a directory with its files; it must succeed.
pub fn run_in(directory: &Path, scene: &str, ranks: usize) -> Results {
    std::fs::write(directory.join("scene.toml"), scene).unwrap();
    output_of(program(ranks).current_dir(directory).args(["run", "scene.toml", "-q"]));
    Results::open(&directory.join("scene.h5")).unwrap()
}

impl Outcome {
    /// Of an output in a directory.
    pub fn new(output: Output, directory: TempDir) -> Self {
        Self {
            directory,
            // A signal leaves no code.
            code: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// The file that the run wrote by default.
    pub fn file(&self) -> PathBuf {
        self.directory.path().join("scene.h5")
    }

    /// What is in it.
    pub fn results(&self) -> Results {
        Results::open(&self.file()).unwrap()
    }

    /// A column of the history.
    pub fn history(&self, column: &str) -> Vec<f64> {
        self.results().history(column).unwrap()
    }

    /// The last value of a column of the history.
    pub fn last(&self, column: &str) -> f64 {
        *self.history(column).last().unwrap()
    }

    /// The value of a column of the history at a time, s, at which a step ends.
    pub fn at(&self, time: f64, column: &str) -> f64 {
        let times = self.history("time");
        let row = times.iter().position(|t| (t - time).abs() < 1e-9 * time.max(1e-3));
        self.history(column)[row.unwrap_or_else(|| panic!("no step ends at {time} s"))]
    }

    /// Asserts that nothing that a user should not see was printed, and that standard error holds `message` once.
    pub fn assert_single_message(&self, message: &str) {
        assert_eq!(self.stderr.matches(message).count(), 1, "{message:?} should be once in:\n{}", self.stderr);
        assert_eq!(self.stderr.matches("mpjr: ").count(), 1, "one message should be in:\n{}", self.stderr);
        self.assert_clean();
    }

    /// Asserts that no panic and no library's stack trace was printed.
    pub fn assert_clean(&self) {
        for text in [&self.stdout, &self.stderr] {
            for trace in ["panicked", "RUST_BACKTRACE", "PETSC ERROR", "HDF5-DIAG", "MPI_ABORT", "Segmentation", "*** "]
            {
                assert!(!text.contains(trace), "{trace:?} in:\n{text}");
            }
        }
    }
}

/// What was printed on standard error, without warnings.
pub fn errors(text: &str) -> String {
    text.split_inclusive('\n').filter(|line| !line.starts_with("warning: ")).collect()
}

/// The program on `ranks`; on one without a launcher, and without what MPI does to find other processes.
pub fn program(ranks: usize) -> Command {
    if ranks == 1 {
        let mut command = Command::new(MPJR);
        command.envs([("OMPI_MCA_ess_singleton_isolated", "1"), ("OMPI_MCA_btl", "self"), ("OMP_NUM_THREADS", "1")]);
        return command;
    }
    let mut command = mpirun(ranks);
    command.env("OMP_NUM_THREADS", "1").arg(MPJR);
    command
}

/// Runs the program with `arguments` alone in an empty directory.
pub fn mpjr(ranks: usize, arguments: &[&str]) -> Outcome {
    let directory = tempfile::tempdir().unwrap();
    let output = program(ranks).current_dir(&directory).args(arguments).output().unwrap();
    Outcome::new(output, directory)
}

/// The names in a directory.
pub fn names(directory: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The errors that the command wrote, after checking its exit code.
pub fn ends_with(command: &mut Command, code: i32) -> String {
    let output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{command:?}\n{}{text}", String::from_utf8_lossy(&output.stdout));
    errors(&text)
}

/// Standard output, after checking that all went well.
pub fn output_of(command: &mut Command) -> String {
    let output: Output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{command:?}\n{text}{}", String::from_utf8_lossy(&output.stderr));
    text
}

/// Every number of a result file: history, interface and bulk, with a name for messages. Names of components are no numbers.
pub fn numbers(path: &Path) -> Vec<(String, Vec<f64>)> {
    let results = Results::open(path).unwrap();
    let file = hdf5::File::open(path).unwrap();
    let mut all = Vec::new();
    for column in file.group("history").unwrap().member_names().unwrap() {
        if column != "energy" {
            all.push((column.clone(), results.history(&column).unwrap()));
        }
    }
    if results.has("history/energy/stored") {
        for column in file.group("history/energy").unwrap().member_names().unwrap() {
            let column = format!("energy/{column}");
            all.push((column.clone(), results.history(&column).unwrap()));
        }
    }
    for group in ["interface", "bulk"] {
        for field in file.group(group).map(|group| group.member_names().unwrap()).unwrap_or_default() {
            if ["axis", "component"].contains(&field.as_str()) {
                continue;
            }
            let values = if group == "bulk" { results.bulk(&field) } else { results.interface(&field) };
            all.push((format!("{group}/{field}"), values.unwrap().values));
        }
    }
    all
}

/// Both files have the same numbers: bit for bit, or (`within` > 0) to so much of the largest of each list.
pub fn assert_same(one: &Path, other: &Path, within: f64) {
    let (one, other) = (numbers(one), numbers(other));
    assert_eq!(one.len(), other.len());
    let work = one.iter().find(|(name, _)| name == "energy/external_work").map_or(0.0, |(_, work)| largest(work));
    for ((name, one), (_, other)) in one.iter().zip(&other) {
        assert_eq!(one.len(), other.len(), "{name}");
        if within == 0.0 {
            let pairs = one.iter().zip(other).enumerate();
            let differing: Vec<_> = pairs.filter(|(_, (a, b))| a.to_bits() != b.to_bits()).collect();
            assert!(differing.is_empty(), "{name}: numbers that differ: {differing:?}");
        } else if name != "newton_iterations" {
            // Relative to the tractions already, and the root of a sum of products that are nothing where all is resolved:
            // what goes with the tractions is its square.
            let is_root = name == "traction_oscillation";
            let [one, other] = [one, other].map(|list| match is_root {
                true => list.iter().map(|value| value * value).collect(),
                false => list.clone(),
            });
            let floor = match name.as_str() {
                _ if is_root => 1.0,
                // Differences of what is as large as the work.
                name if name.starts_with("energy/") => work,
                _ => 0.0,
            };
            let largest = largest(&one).max(floor);
            let difference = one.iter().zip(&other).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
            assert!(difference <= within * largest, "{name}: {difference:e} of {largest:e}");
        }
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

/// Waits until the checkpoint has been written `count` times more, or the program has ended.
pub fn wait_for(child: &mut Child, results: &Path, count: usize) {
    let written = || std::fs::metadata(checkpoint::beside(results)).and_then(|about| about.modified()).ok();
    let (mut last, mut seen) = (written(), 0);
    let begun = Instant::now();
    while seen < count && child.try_wait().unwrap().is_none() {
        let now = written();
        seen += usize::from(now != last && now.is_some());
        last = now;
        assert!(begun.elapsed() < Duration::from_secs(120), "no checkpoint comes");
        std::thread::sleep(Duration::from_millis(1));
    }
}
