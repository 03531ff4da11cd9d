//! Runs the real program on a scene, in a directory of its own.

use std::path::PathBuf;
use std::process::{Command, Output};

use mpjr::output::reader::Results;
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
    pub fn results(&self) -> Results {
        Results::open(&self.directory.path().join("scene.h5")).unwrap()
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

/// The program on `ranks`, without a launcher on one.
pub fn program(ranks: usize) -> Command {
    if ranks == 1 {
        return Command::new(MPJR);
    }
    let mut command = mpirun(ranks);
    command.arg(MPJR);
    command
}

/// Runs the program with `arguments` alone in an empty directory.
pub fn mpjr(ranks: usize, arguments: &[&str]) -> Outcome {
    let directory = tempfile::tempdir().unwrap();
    let output = program(ranks).current_dir(&directory).args(arguments).output().unwrap();
    Outcome::new(output, directory)
}

/// The names in a directory.
pub fn names(directory: &std::path::Path) -> Vec<String> {
    let mut names: Vec<String> =
        std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
