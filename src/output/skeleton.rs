//! Writes a new result file through the HDF5 library: every group, dataset and attribute, with room for all planned
//! rows. The rows themselves follow in [`super::store`].

use std::path::Path;
use std::str::FromStr;

use hdf5::plist::dataset_create::{AllocTime, FillTime};
use hdf5::plist::link_create::CharEncoding;
use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, H5Type, Location};

use super::columns::{self, BULK, INTERFACE, Value};
use super::{Metadata, Plan, Status};
use crate::error::{Error, Result};

/// The metadata of a file stands in one block of this size, so that one small write reaches all extents.
const METADATA_BLOCK: u64 = 1 << 18;
/// The HDF5 library's limit on a chunk is 4 GiB less one byte.
const LARGEST_CHUNK: usize = u32::MAX as usize;

/// A table's name, the units and long name of its datasets, in the order of creation.
type Described = Vec<(Dataset, &'static str, &'static str)>;

/// Creates the file at `path`, which must not exist, with all extents at the planned number of rows and no row in it.
pub(super) fn create(path: &Path, metadata: &Metadata, plan: &Plan) -> Result<()> {
    write(path, metadata, plan)
        .map_err(|error| Error::file(path, format!("cannot be created: {}", super::plain(&error))))
}

fn write(path: &Path, metadata: &Metadata, plan: &Plan) -> hdf5::Result<()> {
    let file = hdf5::File::with_options()
        .with_fapl(|access| access.libver_earliest().meta_block_size(METADATA_BLOCK))
        // Small chunk indices: a table has one chunk, or a few.
        .with_fcpl(|creation| creation.istore_k(1))
        .create_excl(path)?;
    root_attributes(&file, metadata)?;

    // Datasets first and attributes after them, so that the headers lie close together.
    let mut described = history(&file, plan)?;
    let names = described.iter().position(|(set, ..)| set.name().ends_with("/phase"));
    described.extend(interface(&file, plan)?);
    described.extend(bulk(&file, plan)?);
    for (set, units, long_name) in &described {
        text(set, "units", units)?;
        text(set, "long_name", long_name)?;
    }
    if let Some((phase, ..)) = names.and_then(|at| described.get(at)) {
        texts(phase, "names", &plan.phase_names)?;
    }
    if plan.bulk.is_some() {
        for field in BULK {
            let set = file.dataset(&format!("bulk/{}", field.name))?;
            texts(&set, "components", field.components)?;
        }
    }
    drop(described);
    file.close()
}

fn root_attributes(file: &hdf5::File, metadata: &Metadata) -> hdf5::Result<()> {
    text(file, "title", &metadata.title)?;
    text(file, "scene", &metadata.scene)?;
    text(file, "inputs", &metadata.inputs)?;
    text(file, "mpjr_version", &metadata.version)?;
    text(file, "git_commit", &metadata.git_commit)?;
    text(file, "petsc_version", &metadata.petsc_version)?;
    text(file, "started", &super::clock::iso_utc(metadata.started))?;
    text(file, "units", "SI")?;
    attribute::<i64>(file, "mpi_ranks")?.write_scalar(&(metadata.ranks as i64))?;
    attribute::<f64>(file, "wall_seconds")?.write_scalar(&0.0)?;
    texts(file, "warnings", &metadata.warnings)?;
    // A killed run is one that was stopped. The end of a run points `status` at another of `status_values`.
    text(file, "status", Status::Stopped.as_str())?;
    texts(file, "status_values", &Status::ALL.map(Status::as_str))
}

fn history(file: &hdf5::File, plan: &Plan) -> hdf5::Result<Described> {
    file.create_group("history")?;
    if plan.energy {
        file.create_group("history/energy")?;
    }
    columns::history(plan.energy)
        .map(|column| {
            let name = format!("history/{}", column.name);
            let set = match column.value {
                Value::Real(_) => growing::<f64>(file, &name, plan.history_rows, &[])?,
                Value::Count(_) => growing::<i64>(file, &name, plan.history_rows, &[])?,
            };
            Ok((set, column.units, column.long_name))
        })
        .collect()
}

fn interface(file: &hdf5::File, plan: &Plan) -> hdf5::Result<Described> {
    file.create_group("interface")?;
    let (rows, nodes) = (plan.interface_rows, plan.interface_x.len());
    let mut sets = INTERFACE
        .iter()
        .map(|field| {
            let set = growing::<f64>(file, &format!("interface/{}", field.name), rows, &[nodes])?;
            Ok((set, field.units, field.long_name))
        })
        .collect::<hdf5::Result<Described>>()?;
    sets.push((growing::<f64>(file, "interface/time", rows, &[])?, "s", "time"));
    let x = file.new_dataset::<f64>().shape(nodes).create("interface/x")?;
    x.write_raw(&plan.interface_x)?;
    sets.push((x, "m", "undeformed coordinate along the contact face"));
    Ok(sets)
}

fn bulk(file: &hdf5::File, plan: &Plan) -> hdf5::Result<Described> {
    let Some(bulk) = &plan.bulk else { return Ok(Vec::new()) };
    file.create_group("bulk")?;
    let nodes = bulk.coordinates.len();
    let mut sets = BULK
        .iter()
        .map(|field| {
            let row = [nodes, field.components.len()];
            Ok((
                growing::<f64>(file, &format!("bulk/{}", field.name), bulk.frames, &row)?,
                field.units,
                field.long_name,
            ))
        })
        .collect::<hdf5::Result<Described>>()?;
    sets.push((growing::<f64>(file, "bulk/time", bulk.frames, &[])?, "s", "time"));
    let coordinates = file.new_dataset::<f64>().shape((nodes, 2)).create("bulk/coordinates")?;
    coordinates.write_raw(bulk.coordinates.as_flattened())?;
    sets.push((coordinates, "m", "undeformed coordinates x, z of the nodes"));
    let cells = file.new_dataset::<i64>().shape((bulk.cells.len(), 4)).create("bulk/cells")?;
    cells.write_raw(bulk.cells.as_flattened())?;
    sets.push((cells, "1", "nodes of each quadrilateral, counter-clockwise, from 0"));
    Ok(sets)
}

/// A dataset that rows are added to, created with room for `rows` of them, of shape `row` each. Room is set aside and
/// not filled, so that the file takes no more of the disk than what is written.
fn growing<T: H5Type>(file: &hdf5::File, name: &str, rows: usize, row: &[usize]) -> hdf5::Result<Dataset> {
    let row_bytes = size_of::<T>() * row.iter().product::<usize>();
    if row_bytes > LARGEST_CHUNK {
        return Err(format!("a row of /{name} has {row_bytes} bytes; HDF5 takes up to {LARGEST_CHUNK}").into());
    }
    let chunk_rows = (LARGEST_CHUNK / row_bytes.max(1)).clamp(1, rows.max(1));
    // Whole chunks only: the room in the last one is there anyway.
    let rows = rows.max(1).next_multiple_of(chunk_rows);
    let extents: Vec<hdf5::Extent> =
        std::iter::once(hdf5::Extent::resizable(rows)).chain(row.iter().map(|&n| hdf5::Extent::fixed(n))).collect();
    let chunk: Vec<usize> = std::iter::once(chunk_rows).chain(row.iter().copied()).collect();
    file.new_dataset::<T>()
        .shape(hdf5::SimpleExtents::from_vec(extents))
        .chunk(chunk)
        .alloc_time(Some(AllocTime::Early))
        .fill_time(FillTime::Never)
        .obj_track_times(false)
        .create(name)
}

/// A scalar attribute without a value yet.
fn attribute<T: H5Type>(object: &Location, name: &str) -> hdf5::Result<hdf5::Attribute> {
    object.new_attr::<T>().char_encoding(CharEncoding::Ascii).create(name)
}

/// A string attribute. Of variable length: h5py gives `str` for those and bytes for the others.
fn text(object: &Location, name: &str, value: &str) -> hdf5::Result<()> {
    attribute::<VarLenUnicode>(object, name)?.write_scalar(&unicode(value)?)
}

/// A one-dimensional attribute of strings.
pub(super) fn texts<S: AsRef<str>>(object: &Location, name: &str, values: &[S]) -> hdf5::Result<()> {
    let values = values.iter().map(|value| unicode(value.as_ref())).collect::<hdf5::Result<Vec<_>>>()?;
    let shaped = object.new_attr::<VarLenUnicode>().char_encoding(CharEncoding::Ascii).shape(values.len());
    let attribute = shaped.create(name)?;
    if values.is_empty() { Ok(()) } else { attribute.write_raw(&values) }
}

fn unicode(value: &str) -> hdf5::Result<VarLenUnicode> {
    // HDF5 ends strings at a zero.
    VarLenUnicode::from_str(&value.replace('\0', "\u{fffd}")).map_err(|error| error.to_string().into())
}
