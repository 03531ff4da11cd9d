//! Standard output and standard error: the one place that writes to them.
//!
//! A reader that goes away, as `head` does, changes nothing but that it reads no more: what was to be solved is solved
//! and written, and the exit code is that of the work. Any other failure, such as a full disk, is an error at the end.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::{Error, Result};
use crate::warnings::Warning;

/// Why standard output takes no more.
static FAILURE: OnceLock<io::Error> = OnceLock::new();

/// Whether only errors and warnings are printed, and what was asked for.
static QUIET: AtomicBool = AtomicBool::new(false);

/// From now on [`tell`] tells nothing.
pub fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Whether [`tell`] tells nothing.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Prints lines on standard output, unless it is to be quiet; the last one need not end.
pub fn tell(text: impl Display) {
    if !is_quiet() {
        answer(text);
    }
}

/// Prints what was asked for on standard output, quiet or not.
pub fn answer(text: impl Display) {
    if FAILURE.get().is_some() {
        return;
    }
    let text = text.to_string();
    let mut out = io::stdout().lock();
    let written = writeln!(out, "{}", text.strip_suffix('\n').unwrap_or(&text)).and_then(|()| out.flush());
    if let Err(error) = written {
        // The first failure is kept: two threads may meet one at a time.
        let _ = FAILURE.set(error);
    }
}

/// Prints a message to the user on standard error.
pub fn warn(text: impl Display) {
    // There is nobody left to tell when even this cannot be written.
    let _ = writeln!(io::stderr(), "mpjr: {text}");
}

/// Prints a warning about a scene or its results on standard error.
pub fn doubt(warning: &Warning) {
    // As for an error.
    let _ = writeln!(io::stderr(), "warning: {warning}");
}

/// Whether all that was told was written, or a reader went away.
pub fn finish() -> Result<()> {
    match FAILURE.get() {
        Some(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Error::file(Path::new("standard output"), format!("cannot be written: {error}")))
        }
        _ => Ok(()),
    }
}
