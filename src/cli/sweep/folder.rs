//! The directory of a sweep: where everything is, and what has become of a case.

use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use super::super::origin;
use crate::checksum::checksum;
use crate::error::{Error, Result};
use crate::output::scratch::scratch;
use crate::output::{checkpoint, left};
use crate::scene::differences;
use crate::scene::sweep::Sweep;

/// The directory of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Folder {
    path: PathBuf,
}

/// How the last attempt at a case ended.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Record {
    /// The run that made it.
    pub run: String,
    /// What `mpjr run` would have ended with.
    pub exit: i32,
    /// The error; empty when all went well.
    pub reason: String,
    /// s
    pub wall_seconds: f64,
    /// The resolved scene.
    pub scene: String,
}

/// What has become of a case.
#[derive(Debug, Clone, PartialEq)]
pub enum State {
    /// Its results are there, of this very scene.
    Complete,
    /// It failed the last time.
    Failed(Record),
    /// It was begun.
    Stopped,
    /// Nothing of it is there, or something of another scene.
    Missing,
}

impl State {
    /// For lists.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Complete => "complete",
            Self::Failed(_) => "failed",
            Self::Stopped => "stopped",
            Self::Missing => "missing",
        }
    }
}

impl Folder {
    /// The directory, which need not exist.
    pub fn at(path: &Path) -> Self {
        Self { path: path.to_owned() }
    }

    /// The directory, made where it does not exist.
    pub fn make(path: &Path) -> Result<Self> {
        let folder = Self::at(path);
        for directory in [path.to_owned(), folder.hidden(""), folder.shared_directory()] {
            std::fs::create_dir_all(&directory)
                .map_err(|error| Error::file(&directory, format!("cannot be created: {error}")))?;
        }
        Ok(folder)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The result file of a case.
    pub fn results(&self, case: usize) -> PathBuf {
        self.path.join(format!("case-{case:04}.h5"))
    }

    /// The file that whoever runs a case has locked.
    pub fn claim(&self, case: usize) -> PathBuf {
        self.hidden(&format!("case-{case:04}.claim"))
    }

    /// The result file of phases that cases share, whose scene is `scene`.
    pub fn shared(&self, scene: &str) -> PathBuf {
        // The scene itself is compared before the file is used.
        self.shared_directory().join(format!("{:016x}.h5", checksum(scene.as_bytes())))
    }

    /// What has become of a case of the sweep as it is now.
    pub fn state(&self, sweep: &Sweep, case: usize) -> State {
        let scene = &sweep.cases[case].scene;
        let record = self.record(case).filter(|record| differences(&record.scene, &scene.to_toml()).is_empty());
        match left(&self.results(case)) {
            Ok(Some(found)) if origin::is_of(&found, scene, &sweep.file) => match (found.status.as_str(), record) {
                ("complete", _) => State::Complete,
                ("not converged", None) => State::Failed(Record { exit: 3, ..Record::default() }),
                (_, Some(record)) if record.exit != 0 && record.exit != 5 => State::Failed(record),
                _ => State::Stopped,
            },
            _ => match record {
                Some(record) if record.exit != 0 && record.exit != 5 => State::Failed(record),
                _ => State::Missing,
            },
        }
    }

    /// Moves the results of a case out of the way that were damaged since they were written, so that it is solved again:
    /// what this program never wrote stays, and is refused where it would be replaced. What was done, if it was.
    pub fn set_aside(&self, case: usize) -> Result<Option<String>> {
        let path = self.results(case);
        let reason = match left(&path) {
            Ok(Some(found)) if found.status != "complete" && checkpoint::beside(&path).exists() => {
                origin::is_intact(&path).err()
            }
            Ok(_) => None,
            Err(error) => Some(error),
        };
        let written_before = || {
            let solved = |record: Record| record.exit != Error::file(&path, "").exit_code();
            std::fs::metadata(&path).is_ok_and(|about| about.len() == 0) || self.record(case).is_some_and(solved)
        };
        let Some(Error::File { reason, .. }) = reason.filter(|_| written_before()) else { return Ok(None) };
        let numbered = |n: usize| path.with_extension(if n == 1 { "damaged".into() } else { format!("damaged-{n}") });
        let Some(aside) = (1..).map(numbered).find(|aside| !aside.exists()) else { return Ok(None) };
        std::fs::rename(&path, &aside).map_err(|error| Error::file(&path, error))?;
        let aside = aside.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Some(format!("{}: {reason}; moved to {aside}, and case {case} is solved again", path.display())))
    }

    /// How the last attempt at a case ended; none when there was none.
    pub fn record(&self, case: usize) -> Option<Record> {
        toml::from_str(&std::fs::read_to_string(self.record_file(case)).ok()?).ok()
    }

    /// Keeps how an attempt ended.
    pub fn keep_record(&self, case: usize, record: &Record) -> Result<()> {
        let text = toml::to_string(record)
            .map_err(|error| Error::Internal(format!("a record has no form in TOML: {error}")))?;
        replace(&self.record_file(case), &text)
    }

    fn record_file(&self, case: usize) -> PathBuf {
        self.hidden(&format!("case-{case:04}.toml"))
    }

    fn shared_directory(&self) -> PathBuf {
        self.path.join(".shared")
    }

    fn hidden(&self, name: &str) -> PathBuf {
        self.path.join(".cases").join(name)
    }
}

/// Writes a file beside and renames it, so that readers see the old one or the new one.
pub fn replace(path: &Path, text: &str) -> Result<()> {
    let scratch = scratch(path);
    let outcome = std::fs::write(&scratch, text).and_then(|()| std::fs::rename(&scratch, path));
    if outcome.is_err() {
        // The error at hand says more than one about a leftover.
        let _ = std::fs::remove_file(&scratch);
    }
    outcome.map_err(|error| Error::file(path, error))
}

/// A name that no other run has.
pub fn run_id() -> String {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    format!("{:x}-{:x}", now.as_nanos(), std::process::id())
}
