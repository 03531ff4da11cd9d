//! Files that a user names: all are read through here.
//!
//! A pipe without a writer never opens and `/dev/zero` never ends; only regular files are read.

use std::fs::{self, File, FileType};
use std::io::Read;
use std::os::unix::fs::FileTypeExt;
use std::path::Path;

use crate::error::{Error, Result};

/// The content of a file.
///
/// # Errors
/// [`Error::File`] when it is not a regular file or cannot be read.
pub fn bytes(file: &Path) -> Result<Vec<u8>> {
    regular(file)?;
    fs::read(file).map_err(|error| unreadable(file, error))
}

/// The content of a file in UTF-8.
///
/// # Errors
/// As of [`bytes`], or when it is not UTF-8.
pub fn text(file: &Path) -> Result<String> {
    regular(file)?;
    fs::read_to_string(file).map_err(|error| unreadable(file, error))
}

/// Refuses what is not a regular file, without opening it; for libraries that open files themselves.
///
/// # Errors
/// [`Error::File`].
pub fn regular(file: &Path) -> Result<()> {
    let kind = fs::metadata(file).map_err(|error| unreadable(file, error))?.file_type();
    // What the system says of a directory is plain enough.
    if kind.is_file() || kind.is_dir() {
        return Ok(());
    }
    Err(unreadable(file, format!("it is {}, not a regular file; write its content to a file first", name(kind))))
}

fn unreadable(file: &Path, reason: impl std::fmt::Display) -> Error {
    Error::file(file, format!("cannot be read: {reason}"))
}

fn name(kind: FileType) -> &'static str {
    match kind {
        kind if kind.is_fifo() => "a pipe",
        kind if kind.is_socket() => "a socket",
        _ => "a device",
    }
}

/// Whether the regular file at `path` begins with one of these.
pub fn begins_with(path: &Path, marks: &[&[u8]]) -> bool {
    let begin = beginning(path, marks.iter().map(|mark| mark.len()).max().unwrap_or(0));
    begin.is_some_and(|begin| marks.iter().any(|mark| begin.starts_with(mark)))
}

/// The first bytes of a regular file.
pub fn beginning(path: &Path, length: usize) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let about = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file);
    about.and_then(|_| File::open(path).ok())?.take(length as u64).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}
