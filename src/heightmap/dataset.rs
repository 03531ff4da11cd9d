//! Heights in a dataset of an HDF5 file.

use std::path::Path;

use hdf5::Dataset;
use hdf5::dataset::Layout;
use hdf5::types::TypeDescriptor;

use super::Heights;
use crate::error::plain;

/// Reads a dataset of two dimensions, whose first index goes along x.
pub(super) fn read(file: &Path, name: &str) -> Result<Heights, String> {
    let broken = |error: hdf5::Error| format!("cannot be read as HDF5 ({})", plain(&error));
    let file = hdf5::File::open(file).map_err(broken)?;
    let dataset = file.dataset(name).map_err(|_| format!("has no dataset {name:?}{}", others(&file)))?;
    let [columns, rows] = dataset.shape()[..] else {
        return Err(format!("{name:?} must have two dimensions, but has {}", dataset.ndim()));
    };
    let kind = dataset.dtype().and_then(|kind| kind.to_descriptor()).map_err(broken)?;
    if !matches!(kind, TypeDescriptor::Float(_) | TypeDescriptor::Integer(_) | TypeDescriptor::Unsigned(_)) {
        return Err(format!("{name:?} must hold real numbers, but holds {kind}"));
    }
    if !is_whole(&dataset, [columns, rows], kind.size()) {
        return Err(format!(
            "says that {name:?} has {columns} x {rows} points, but does not have them all: it was not written whole, or is damaged"
        ));
    }
    Ok(Heights::bare([columns, rows], dataset.read_raw::<f64>().map_err(broken)?))
}

/// Whether a file has as much of a dataset as it says: there may be places for what nobody wrote.
fn is_whole(dataset: &Dataset, [columns, rows]: [usize; 2], size: usize) -> bool {
    let Some(points) = columns.checked_mul(rows) else { return false };
    match (dataset.layout(), dataset.chunk()) {
        (Layout::Virtual, _) => false,
        (Layout::Chunked, Some(chunk)) => {
            let volume = chunk.iter().try_fold(1_usize, |volume, edge| volume.checked_mul(*edge));
            let there = dataset.num_chunks().zip(volume).and_then(|(chunks, volume)| chunks.checked_mul(volume));
            there.is_some_and(|there| there >= points)
        }
        _ => points.checked_mul(size).is_some_and(|bytes| dataset.storage_size() >= bytes as u64),
    }
}

/// The datasets at the root, for a message.
fn others(file: &hdf5::File) -> String {
    let names: Vec<String> = file.datasets().unwrap_or_default().iter().map(|dataset| dataset.name()).take(8).collect();
    if names.is_empty() { String::new() } else { format!("; it has {}", names.join(", ")) }
}
