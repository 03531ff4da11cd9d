//! The checkpoint beside a result file: what a run needs to go on.
//!
//! It is written under another name, forced to the disk and renamed, after the rows of the result file that it counts
//! have been forced to the disk: at every moment the last whole checkpoint and all rows before it are there.
//!
//! The format is this program's own, so that every write is seen to succeed: the HDF5 library, whose files are for
//! other programs to read, does not survive a disk that fills up while it writes. A line `mpjr checkpoint 5`, the
//! length of a TOML header, the header (scene, `started`, names and lengths of the lists), the numbers as 8 bytes
//! each, least significant byte first, and a checksum of all that.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::scratch::scratch;
use super::store::failed;
use crate::checksum::checksum;
use crate::error::{Error, Result};
use crate::input;

/// The number goes up when what a checkpoint holds changes its meaning.
const MARK: &[u8] = b"mpjr checkpoint 5\n";
/// What the mark of every format begins with.
pub(super) const ANY_MARK: &[u8] = b"mpjr checkpoint ";

/// What stands before the numbers.
#[derive(Serialize, Deserialize)]
struct Header {
    scene: String,
    started: String,
    names: Vec<String>,
    lengths: Vec<usize>,
}

/// A state, and the run that it belongs to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Checkpoint {
    /// The resolved scene, whole, as TOML.
    pub scene: String,
    /// The attribute `started` of the result file that it belongs to.
    pub started: String,
    /// The state, as named lists of numbers.
    pub fields: Vec<(String, Vec<f64>)>,
}

/// The checkpoint that belongs to a result file.
pub fn beside(results: &Path) -> PathBuf {
    let mut name = results.file_name().unwrap_or_default().to_owned();
    name.push(".checkpoint");
    results.with_file_name(name)
}

/// Writes the checkpoint of the result file `results`; the one before is there until this one is whole.
pub fn write(results: &Path, checkpoint: &Checkpoint) -> Result<()> {
    let path = beside(results);
    let scratch = scratch(&path);
    let outcome = encode(checkpoint).and_then(|bytes| {
        write_whole(&scratch, &bytes).and_then(|()| put_in_place(&scratch, &path)).map_err(|error| failed(&path, error))
    });
    if outcome.is_err() {
        // The error at hand says more than one about a leftover.
        let _ = std::fs::remove_file(&scratch);
    }
    outcome
}

/// Reads the checkpoint of the result file `results`; none if there is no such file.
pub fn read(results: &Path) -> Result<Option<Checkpoint>> {
    let path = beside(results);
    let bytes = match std::fs::read(&path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(Error::file(&path, error)),
        Ok(bytes) => bytes,
    };
    if bytes.starts_with(ANY_MARK) && !bytes.starts_with(MARK) {
        let reason = "is a checkpoint of another version of mpjr; remove it and run without --resume";
        return Err(Error::file(&path, reason));
    }
    let damaged = "is not a whole checkpoint; remove it and run without --resume";
    decode(&bytes).map(Some).ok_or_else(|| Error::file(&path, damaged))
}

/// Removes the checkpoint of the result file `results`, if there is one.
pub fn remove(results: &Path) -> Result<()> {
    let path = beside(results);
    if !input::begins_with(&path, &[ANY_MARK]) {
        return Ok(());
    }
    match std::fs::remove_file(&path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Error::file(&path, error)),
        _ => Ok(()),
    }
}

fn encode(checkpoint: &Checkpoint) -> Result<Vec<u8>> {
    let Checkpoint { scene, started, fields } = checkpoint;
    let header = Header {
        scene: scene.clone(),
        started: started.clone(),
        names: fields.iter().map(|(name, _)| name.clone()).collect(),
        lengths: fields.iter().map(|(_, values)| values.len()).collect(),
    };
    let header = toml::to_string(&header)
        .map_err(|error| Error::Internal(format!("the header of a checkpoint has no form in TOML: {error}")))?;
    let mut bytes = [MARK, &(header.len() as u64).to_le_bytes(), header.as_bytes()].concat();
    bytes.extend(fields.iter().flat_map(|(_, values)| values).flat_map(|value| value.to_le_bytes()));
    let sum = checksum(&bytes);
    bytes.extend(sum.to_le_bytes());
    Ok(bytes)
}

/// None where anything is missing or damaged.
fn decode(bytes: &[u8]) -> Option<Checkpoint> {
    let (content, sum) = bytes.split_last_chunk()?;
    if checksum(content) != u64::from_le_bytes(*sum) {
        return None;
    }
    let (length, rest) = content.strip_prefix(MARK)?.split_first_chunk()?;
    let (header, numbers) = rest.split_at_checked(u64::from_le_bytes(*length) as usize)?;
    let Header { scene, started, names, lengths } = toml::from_str(std::str::from_utf8(header).ok()?).ok()?;
    let mut numbers = numbers.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes));
    let mut list = |(name, length)| {
        let values: Vec<f64> = numbers.by_ref().take(length).collect();
        (values.len() == length).then_some((name, values))
    };
    let fields = names.into_iter().zip(lengths).map(&mut list).collect::<Option<_>>()?;
    Some(Checkpoint { scene, started, fields })
}

fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = File::create(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

fn put_in_place(scratch: &Path, path: &Path) -> std::io::Result<()> {
    std::fs::rename(scratch, path)?;
    // The name is on the disk when the directory is. Some network file systems cannot say so.
    if let Some(directory) = path.parent() {
        let directory = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
        let _ = File::open(directory).and_then(|directory| directory.sync_all());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every number comes back bit for bit, and no damaged byte goes unnoticed.
    #[test]
    fn what_is_written_is_read_or_refused() {
        let fields = vec![("u".to_owned(), vec![1.0, -0.0, f64::MIN_POSITIVE, 1.0 / 3.0]), ("none".to_owned(), vec![])];
        let checkpoint = Checkpoint { scene: "title = \"é\"".into(), started: "now".into(), fields };
        let bytes = encode(&checkpoint).unwrap_or_default();
        assert_eq!(decode(&bytes), Some(checkpoint));
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1;
            assert_eq!(decode(&damaged), None);
            assert_eq!(decode(&bytes[..at]), None);
        }
    }
}
