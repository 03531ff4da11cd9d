//! Compresses the results of a complete run: the library writes them anew, under another name that is then renamed to
//! the file's.
//!
//! Rows are not compressed as they come: what a compressed chunk takes is known only when it is whole, so that a row could
//! not be added by a write to a known place. Nor could a collective write of the library do it, for what [`super::bulk`]
//! says of such writes.

use std::fs::File;
use std::os::unix::fs::FileExt;
use std::path::Path;
use std::time::Duration;

use hdf5::filters::deflate_available;
use hdf5::types::{TypeDescriptor, VarLenUnicode};
use hdf5::{Dataset, H5Type, Hyperslab, SliceOrIndex};
use ndarray::ArrayViewD;

use super::reader::Results;
use super::scratch::scratch;
use super::skeleton::{self, Purpose};
use super::state::State;
use super::store::{Rows as Stored, Table};
use super::{BulkPlan, Plan};
use crate::error::{Error, Result, plain};

/// Bytes per second that are compressed at the least: 50 to 110 MB/s were measured on one core (docs/results.md).
const RATE: f64 = 40e6;
/// The most that compression may take of the time of a run.
const SHARE: f64 = 0.05;
/// Fields of so few bytes stay as they are.
const SMALL: usize = 1 << 16;
/// Rows are copied in pieces of about this many bytes.
const PIECE: usize = 1 << 24;

/// Puts a compressed file in the place of that of `state`, which is complete, where this takes little of the time of the
/// run and there is room on the disk. The file is whole with and without: what goes wrong changes nothing.
pub(super) fn pack(state: &State) {
    let stored = state.store.stored();
    let fields = stored.iter().filter(|rows| rows.table != Table::History);
    let fields: usize = fields.map(|rows| rows.count * rows.row_bytes()).sum();
    if !worthwhile(fields, state.begun.elapsed()) || !deflate_available() {
        return;
    }
    let path = state.store.path();
    // The library does not survive a disk that fills up while it writes.
    let whole = std::fs::metadata(path).map_or(u64::MAX, |about| about.len());
    let room = rustix::fs::statvfs(path).map_or(0, |disk| disk.f_bavail.saturating_mul(disk.f_frsize));
    if room / 2 < whole {
        return;
    }
    let scratch = scratch(path);
    if pack_into(state, &scratch).is_err() {
        // A leftover does no harm.
        let _ = std::fs::remove_file(&scratch);
    }
}

fn worthwhile(bytes: usize, run: Duration) -> bool {
    bytes > SMALL && bytes as f64 / RATE < SHARE * run.as_secs_f64()
}

fn pack_into(state: &State, scratch: &Path) -> Result<()> {
    let path = state.store.path();
    let results = Results::open(path)?;
    let plan = plan(state, &results)?;
    let broken = |error: hdf5::Error| Error::file(path, plain(&error));
    let from = hdf5::File::open(path).map_err(broken)?;
    skeleton::write(scratch, &|to| copy_attributes(&from, to), &plan, Purpose::Packed).map_err(broken)?;
    let to = hdf5::File::open_rw(scratch).map_err(broken)?;
    let raw = File::open(path).map_err(|error| Error::file(path, error))?;
    for rows in state.store.stored() {
        copy_rows(&rows, &raw, &to).map_err(broken)?;
    }
    to.close().map_err(broken)?;
    drop((results, from));
    let into_place = || {
        std::fs::set_permissions(scratch, std::fs::metadata(path)?.permissions())?;
        File::open(scratch)?.sync_all()?;
        std::fs::rename(scratch, path)
    };
    into_place().map_err(|error| Error::file(path, error))
}

/// What the file has, exactly.
fn plan(state: &State, results: &Results) -> Result<Plan> {
    let rows = |table| state.store.rows(table);
    let mesh = |mesh: super::xdmf::MeshSize| -> Result<BulkPlan> {
        let cells = results.bulk("cells")?.values.into_iter().map(|node| node as i64).collect();
        let coordinates = results.bulk("coordinates")?.values;
        Ok(BulkPlan { frames: rows(Table::Bulk), axes: mesh.axes, coordinates, corners: mesh.corners, cells })
    };
    Ok(Plan {
        history_rows: rows(Table::History),
        interface_rows: rows(Table::Interface),
        bulk: state.mesh.map(mesh).transpose()?,
        ..state.plan.clone()
    })
}

/// Texts and numbers, as [`skeleton`] gives them to a file.
fn copy_attributes(from: &hdf5::File, to: &hdf5::File) -> hdf5::Result<()> {
    for name in from.attr_names()? {
        let attribute = from.attr(&name)?;
        match (attribute.dtype()?.to_descriptor()?, attribute.is_scalar()) {
            (TypeDescriptor::VarLenUnicode | TypeDescriptor::VarLenAscii, true) => {
                skeleton::text(to, &name, &attribute.read_scalar::<VarLenUnicode>()?)?;
            }
            (TypeDescriptor::Integer(_), true) => {
                skeleton::attribute::<i64>(to, &name)?.write_scalar(&attribute.read_scalar::<i64>()?)?;
            }
            (TypeDescriptor::Float(_), true) => {
                skeleton::attribute::<f64>(to, &name)?.write_scalar(&attribute.read_scalar::<f64>()?)?;
            }
            _ if attribute.size() == 0 => skeleton::texts::<&str>(to, &name, &[])?,
            _ => skeleton::texts(to, &name, &attribute.read_raw::<VarLenUnicode>()?)?,
        }
    }
    Ok(())
}

/// Copies all rows of a dataset.
fn copy_rows(rows: &Stored, from: &File, to: &hdf5::File) -> hdf5::Result<()> {
    let set = to.dataset(rows.name())?;
    let integers = set.dtype()?.is::<i64>();
    let at_once = (PIECE / rows.row_bytes().max(1)).max(1);
    let mut bytes = Vec::new();
    for first in (0..rows.count).step_by(at_once) {
        let range = first..rows.count.min(first + at_once);
        bytes.resize(range.len() * rows.row_bytes(), 0);
        for (row, place) in range.clone().zip(bytes.chunks_exact_mut(rows.row_bytes().max(1))) {
            let at = rows.at(row).ok_or("a row beyond the chunks")?;
            from.read_exact_at(place, at).map_err(|error| error.to_string())?;
        }
        let numbers = bytes.as_chunks::<8>().0.iter();
        match integers {
            true => write_rows(&set, range, &numbers.map(|number| i64::from_ne_bytes(*number)).collect::<Vec<_>>())?,
            false => write_rows(&set, range, &numbers.map(|number| f64::from_ne_bytes(*number)).collect::<Vec<_>>())?,
        }
    }
    Ok(())
}

fn write_rows<T: H5Type>(set: &Dataset, rows: std::ops::Range<usize>, values: &[T]) -> hdf5::Result<()> {
    let mut shape = set.shape();
    let whole = (1..shape.len()).map(|_| SliceOrIndex::from(..));
    let slab: Hyperslab = std::iter::once(SliceOrIndex::from(rows.clone())).chain(whole).collect::<Vec<_>>().into();
    shape[0] = rows.len();
    let view = ArrayViewD::from_shape(shape, values).map_err(|error| error.to_string())?;
    set.write_slice(view, slab)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 5 % of the run at 40 MB/s: 2 MB for each second of it; nothing below 64 KiB.
    #[test]
    fn compression_is_bounded_by_the_time_of_the_run() {
        let cases = [(100_000, 1.0, true), (1_900_000, 1.0, true), (2_100_000, 1.0, false), (60_000, 1e3, false)];
        for (bytes, seconds, expected) in cases {
            assert_eq!(worthwhile(bytes, Duration::from_secs_f64(seconds)), expected, "{bytes} bytes, {seconds} s");
        }
    }
}
