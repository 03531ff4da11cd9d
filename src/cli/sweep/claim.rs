//! Claims: which process works at what.
//!
//! A claim is a lock on a file, which the system takes back when its process ends in whatever way: none is ever stale.
//! The groups of one launcher and the jobs of a batch system share a sweep by nothing but these locks. The file also
//! says how far the work is, for whoever shows it.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Write};
use std::os::unix::fs::FileExt;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::error::{Error, Result};

/// The progress is written no more often than this.
const TELL_EVERY: Duration = Duration::from_millis(500);
/// Every text is as long as this, so that a reader never sees the rest of an older one.
const LENGTH: usize = 96;

/// A piece of work that nobody else does while this lives.
#[derive(Debug)]
pub struct Claim {
    file: File,
    run: String,
    told: Option<Instant>,
}

/// What a claim file says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Told {
    /// The run that it is part of.
    pub run: String,
    /// Planned steps done, of how many.
    pub steps: [usize; 2],
    /// Whether the work has ended.
    pub ended: bool,
}

impl Claim {
    /// Claims the work that `path` stands for; none when somebody else is at it.
    pub fn take(path: &Path, run: &str) -> Result<Option<Self>> {
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path);
        let file = file.map_err(|error| Error::file(path, error))?;
        match file.try_lock() {
            Ok(()) => Ok(Some(Self { file, run: run.to_owned(), told: None })),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(error)) => Err(Error::file(
                path,
                format!("cannot be locked: {error}; choose a directory on another disk with --out"),
            )),
        }
    }

    /// Tells how far the work is.
    pub fn tell(&mut self, done: usize, total: usize) {
        if self.told.is_none_or(|told| told.elapsed() >= TELL_EVERY) {
            self.told = Some(Instant::now());
            self.write(done, total, "running");
        }
    }

    /// Tells that the work has ended.
    pub fn end(&mut self) {
        self.write(0, 0, "ended");
    }

    fn write(&mut self, done: usize, total: usize, word: &str) {
        let text = format!("{:<width$}\n", format!("{} {done} {total} {word}", self.run), width = LENGTH - 1);
        // It is for show only.
        let _ = self.file.write_all_at(text.as_bytes(), 0).and_then(|()| self.file.flush());
    }
}

/// What the claim file at `path` says; nothing much when there is none.
pub fn told(path: &Path) -> Told {
    let mut text = String::new();
    if File::open(path).and_then(|mut file| file.read_to_string(&mut text)).is_err() {
        return Told::default();
    }
    let words: Vec<&str> = text.split_whitespace().collect();
    let [run, done, total, word] = words[..] else { return Told::default() };
    let number = |text: &str| text.parse().unwrap_or(0);
    Told { run: run.to_owned(), steps: [number(done), number(total)], ended: word == "ended" }
}
