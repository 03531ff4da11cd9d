//! The checkpoint beside a result file: what a run needs to go on.
//!
//! It is written under another name, forced to the disk and renamed, after the rows of the result file that it counts
//! have been forced to the disk: at every moment the last whole checkpoint and all rows before it are there.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use hdf5::types::VarLenUnicode;

use super::recorder::scratch;
use super::store::failed;
use crate::error::{Error, Result};

/// Goes up when what a checkpoint holds changes its meaning.
const FORMAT: i64 = 1;

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
    let outcome = write_whole(&scratch, checkpoint)
        .map_err(|error| Error::file(&path, format!("the checkpoint cannot be written: {}", super::plain(&error))))
        .and_then(|()| put_in_place(&scratch, &path).map_err(|error| failed(&path, error)));
    if outcome.is_err() {
        // The error at hand says more than one about a leftover.
        let _ = std::fs::remove_file(&scratch);
    }
    outcome
}

/// Reads the checkpoint of the result file `results`; none if there is no such file.
pub fn read(results: &Path) -> Result<Option<Checkpoint>> {
    let path = beside(results);
    match File::open(&path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(Error::file(&path, error)),
        Ok(_) => {}
    }
    let (format, checkpoint) = read_whole(&path).map_err(|error| {
        Error::file(&path, format!("is not a checkpoint that can be read ({})", super::plain(&error)))
    })?;
    if format != FORMAT {
        let reason = "is a checkpoint of another version of mpjr; remove it and run without --resume";
        return Err(Error::file(&path, reason));
    }
    Ok(Some(checkpoint))
}

/// Removes the checkpoint of the result file `results`, if there is one.
pub fn remove(results: &Path) -> Result<()> {
    let path = beside(results);
    match std::fs::remove_file(&path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Error::file(&path, error)),
        _ => Ok(()),
    }
}

fn write_whole(path: &Path, checkpoint: &Checkpoint) -> hdf5::Result<()> {
    let file = hdf5::File::create(path)?;
    file.new_attr::<i64>().create("mpjr_checkpoint")?.write_scalar(&FORMAT)?;
    // In datasets: an attribute holds 64 KiB at most.
    for (name, text) in [("scene", &checkpoint.scene), ("started", &checkpoint.started)] {
        let text = VarLenUnicode::from_str(text).map_err(|error| error.to_string())?;
        file.new_dataset::<VarLenUnicode>().create(name)?.write_scalar(&text)?;
    }
    let state = file.create_group("state")?;
    for (index, (name, values)) in checkpoint.fields.iter().enumerate() {
        // Numbered, so that they come back in their order.
        let set = state.new_dataset::<f64>().shape(values.len()).create(format!("{index:04} {name}").as_str())?;
        set.write_raw(values)?;
    }
    drop(state);
    file.close()
}

fn read_whole(path: &Path) -> hdf5::Result<(i64, Checkpoint)> {
    let file = hdf5::File::open(path)?;
    let text = |name: &str| Ok::<_, hdf5::Error>(file.dataset(name)?.read_scalar::<VarLenUnicode>()?.to_string());
    let format = file.attr("mpjr_checkpoint")?.read_scalar()?;
    let state = file.group("state")?;
    let mut names = state.member_names()?;
    names.sort_unstable();
    let fields = names.into_iter().map(|name| {
        let values = state.dataset(&name)?.read_raw()?;
        let name = name.split_once(' ').map_or(name.as_str(), |(_, name)| name).to_owned();
        Ok((name, values))
    });
    let fields = fields.collect::<hdf5::Result<_>>()?;
    Ok((format, Checkpoint { scene: text("scene")?, started: text("started")?, fields }))
}

fn put_in_place(scratch: &Path, path: &Path) -> std::io::Result<()> {
    File::open(scratch)?.sync_all()?;
    std::fs::rename(scratch, path)?;
    // The name is on the disk when the directory is. Some network file systems cannot say so.
    if let Some(directory) = path.parent() {
        let directory = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
        let _ = File::open(directory).and_then(|directory| directory.sync_all());
    }
    Ok(())
}
