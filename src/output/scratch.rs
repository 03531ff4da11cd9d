//! Names of files that are renamed to their place when they are whole.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

const BEFORE_PID: &str = ".mpjr-";
/// How all such names end.
pub(super) const HALF: &str = ".part";

/// A name beside `path` that no other process uses, for a file that is renamed to `path` when it is whole.
pub fn scratch(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!("{BEFORE_PID}{}{HALF}", std::process::id()));
    path.with_file_name(name)
}

/// The process that chose `name` for a file that was to become `path`, if one did.
pub(super) fn process(path: &Path, name: &OsStr) -> Option<u32> {
    let begin = format!("{}{BEFORE_PID}", path.file_name().unwrap_or_default().to_string_lossy());
    name.to_str()?.strip_prefix(&begin)?.strip_suffix(HALF)?.parse().ok()
}
