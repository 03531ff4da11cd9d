//! What this program may replace or remove: what it wrote itself, under whatever name.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::scratch::{self, HALF};
use super::{checkpoint, reader, xdmf};
use crate::error::{Error, Result};
use crate::input;

/// Refuses results at `path` where that, or a file that belongs to them, is there and was not written by this program;
/// removes what its processes that were killed left half written.
pub(super) fn make_way(path: &Path) -> Result<()> {
    let taken = [(".checkpoint", "a checkpoint"), (HALF, "a file that is not whole yet")];
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if let Some((_, what)) = taken.iter().find(|(end, _)| name.ends_with(end)) {
        return Err(Error::file(path, format!("is the name of {what}; end the name of the results in .h5")));
    }
    if let Ok(about) = std::fs::symlink_metadata(path)
        && about.is_dir()
    {
        return Err(Error::file(path, "is a directory; name a file with --out"));
    }
    xdmf::refuse_same_name(path)?;
    refuse(path, reader::is_ours)?;
    let others = [xdmf::beside(path), checkpoint::beside(path)];
    others.iter().try_for_each(|other| refuse(other, |other| input::begins_with(other, &MARKS)))?;
    others.iter().map(PathBuf::as_path).chain([path]).for_each(|path| remove_stale(path, is_half_written));
    Ok(())
}

/// Refuses to replace `path` where it exists and is not `ours`.
fn refuse(path: &Path, ours: impl FnOnce(&Path) -> bool) -> Result<()> {
    match std::fs::symlink_metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        Err(error) => Err(Error::file(path, error)),
        Ok(_) if ours(path) => Ok(()),
        Ok(_) => {
            Err(Error::file(path, "exists and was not written by mpjr; remove it or name another file with --out"))
        }
    }
}

/// How the files begin that belong to results.
const MARKS: [&[u8]; 2] = [checkpoint::ANY_MARK, xdmf::BEGIN];

/// Refuses a table at `path` whose first line is not `ours`, and removes what killed processes left of such.
pub fn make_way_for_table(path: &Path, ours: impl Fn(&str) -> bool) -> Result<()> {
    const LONGEST: usize = 1 << 16;
    let ours = |path: &Path| {
        let begin = input::beginning(path, LONGEST).unwrap_or_default();
        ours(String::from_utf8_lossy(&begin).lines().next().unwrap_or_default())
    };
    refuse(path, ours)?;
    remove_stale(path, ours);
    Ok(())
}

/// Removes the files that processes which are no more were to rename to `path`, and that are `ours`.
fn remove_stale(path: &Path, ours: impl Fn(&Path) -> bool) {
    let directory = path.parent().filter(|directory| !directory.as_os_str().is_empty()).unwrap_or(Path::new("."));
    for entry in std::fs::read_dir(directory).into_iter().flatten().flatten() {
        let pid = scratch::process(path, &entry.file_name());
        if pid.is_some_and(|pid| !Path::new(&format!("/proc/{pid}")).exists()) && ours(&entry.path()) {
            // One that stays does no harm.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Whether a file is what a process of this program leaves that is killed while it writes: results that cannot be opened
/// yet, or the beginning of another file.
fn is_half_written(path: &Path) -> bool {
    const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
    let Some(begin) = input::beginning(path, HDF5.len()) else { return false };
    let unborn = begin.iter().all(|&byte| byte == 0) || begin == HDF5;
    reader::is_ours(path) || unborn && hdf5::File::open(path).is_err() || input::begins_with(path, &MARKS)
}
