//! Writes a new result file through the HDF5 library: every group, dataset and attribute, with room for all planned
//! rows. The rows themselves follow in [`super::store`].

use std::path::Path;
use std::str::FromStr;

use hdf5::filters::deflate_available;
use hdf5::plist::dataset_create::{AllocTime, FillTime};
use hdf5::plist::link_create::CharEncoding;
use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, H5Type, Location};

use super::columns::{self, Components, Value};
use super::xdmf::MeshSize;
use super::{BulkPlan, Extra, FacePlan, Metadata, Plan, Status};
use crate::error::{Error, Result, plain};

/// The metadata of a file stands in one block of this size, so that one small write reaches all extents.
const METADATA_BLOCK: u64 = 1 << 18;
/// The HDF5 library's limit on a chunk is 4 GiB less one byte.
const LARGEST_CHUNK: usize = u32::MAX as usize;
/// Chunks that are compressed fit into the cache that readers have for them unless they ask for more.
const PACKED_CHUNK: usize = 1 << 20;
/// Of deflate: higher ones take several times as long for a few hundredths of the size.
const LEVEL: u8 = 1;

/// What a file is made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Rows are added by [`super::store`]: one chunk, with room for all planned rows.
    Growing,
    /// All rows are written by the library; fields are compressed.
    Packed,
}

/// A dataset, and what its attributes are to say.
struct Described {
    set: Dataset,
    units: &'static str,
    long_name: String,
    /// The dataset that is the scale of each dimension, named from the root.
    scales: Vec<String>,
}

/// Units and words of a column or field.
pub(super) fn about((units, long_name): (&'static str, &'static str), in_space: bool) -> (&'static str, String) {
    if in_space { columns::in_space(units, long_name) } else { (units, long_name.to_owned()) }
}

/// A file in the making.
pub(super) struct Skeleton<'a> {
    file: &'a hdf5::File,
    purpose: Purpose,
    made: Vec<Described>,
}

/// Creates the file at `path`, which must not exist, with all extents at the planned number of rows and no row in it.
pub(super) fn create(path: &Path, metadata: &Metadata, plan: &Plan) -> Result<()> {
    // A killed run is one that was stopped. The end of a run points `status` at another of `status_values`.
    write(path, &|file| root_attributes(file, metadata, (Status::Stopped, 0.0)), plan, Purpose::Growing)
        .map_err(|error| Error::file(path, format!("cannot be created: {}", plain(&error))))
}

/// The same with what `root` gives the root, for `purpose`.
pub(super) fn write(
    path: &Path,
    root: &dyn Fn(&hdf5::File) -> hdf5::Result<()>,
    plan: &Plan,
    purpose: Purpose,
) -> hdf5::Result<()> {
    let file = hdf5::File::with_options()
        .with_fapl(|access| access.libver_earliest().meta_block_size(METADATA_BLOCK))
        // Small chunk indices: a table has one chunk, or a few.
        .with_fcpl(|creation| creation.istore_k(1))
        .create_excl(path)?;
    root(&file)?;

    // Datasets first and attributes after them, so that the headers lie close together.
    let mut skeleton = Skeleton::new(&file, purpose);
    skeleton.history(plan)?;
    skeleton.interface(plan)?;
    if let Some(bulk) = &plan.bulk {
        skeleton.bulk(bulk, plan.extra)?;
    }
    skeleton.finish()?;
    let phase = file.dataset("history/phase")?;
    texts(&phase, "names", &plan.phase_names)?;
    if let Some(bulk) = &plan.bulk {
        for field in columns::bulk(plan.extra).filter(|field| field.components != Components::Scalar) {
            let set = file.dataset(&format!("bulk/{}", field.name))?;
            texts(&set, "components", field.components.names(bulk.axes))?;
        }
    }
    file.close()
}

/// The attributes of the root, for a run of this status that has taken so many seconds.
pub(super) fn root_attributes(
    file: &hdf5::File,
    metadata: &Metadata,
    (status, seconds): (Status, f64),
) -> hdf5::Result<()> {
    text(file, "title", &metadata.title)?;
    text(file, "scene", &metadata.scene)?;
    text(file, "inputs", &metadata.inputs)?;
    text(file, "mpjr_version", &metadata.version)?;
    text(file, "git_commit", &metadata.git_commit)?;
    text(file, "petsc_version", &metadata.petsc_version)?;
    text(file, "started", &super::clock::iso_utc(metadata.started))?;
    text(file, "units", "SI")?;
    attribute::<i64>(file, "mpi_ranks")?.write_scalar(&(metadata.ranks as i64))?;
    attribute::<f64>(file, "wall_seconds")?.write_scalar(&seconds)?;
    texts(file, "warnings", &metadata.warnings)?;
    text(file, "status", status.as_str())?;
    texts(file, "status_values", &Status::ALL.map(Status::as_str))
}

impl<'a> Skeleton<'a> {
    /// In a file without datasets.
    pub(super) fn new(file: &'a hdf5::File, purpose: Purpose) -> Self {
        Self { file, purpose, made: Vec::new() }
    }

    /// Says of each dataset what it is, and which others are its scales.
    pub(super) fn finish(self) -> hdf5::Result<()> {
        for Described { set, units, long_name, .. } in &self.made {
            text(set, "units", units)?;
            text(set, "long_name", long_name)?;
        }
        super::scales::attach(self.file, self.made.iter().map(|made| (&made.set, made.scales.as_slice())))
    }

    fn history(&mut self, plan: &Plan) -> hdf5::Result<()> {
        self.file.create_group("history")?;
        if plan.extra.energy {
            self.file.create_group("history/energy")?;
        }
        let in_space = plan.face.in_space;
        for column in columns::history(plan.extra) {
            let (name, rows) = (format!("history/{}", column.name), plan.history_rows);
            let vector = in_space && matches!(column.value, Value::Along(_));
            let set = match column.value {
                Value::Real(_) => self.growing::<f64>(&name, rows, &[])?,
                Value::Along(_) if vector => self.growing::<f64>(&name, rows, &[2])?,
                Value::Along(_) => self.growing::<f64>(&name, rows, &[])?,
                Value::Count(_) => self.growing::<i64>(&name, rows, &[])?,
            };
            let scales: &[&str] = if vector { &["time", "direction"] } else { &["time"] };
            self.describe(set, about((column.units, column.long_name), in_space), "history", scales);
        }
        if in_space {
            self.names("history", Components::Along, 3)?;
        }
        Ok(())
    }

    fn interface(&mut self, plan: &Plan) -> hdf5::Result<()> {
        const GROUP: &str = "interface";
        self.file.create_group(GROUP)?;
        let (rows, nodes, axes) = (plan.interface_rows, plan.face.nodes(), plan.face.axes());
        let node = if plan.face.in_space { "node" } else { "x" };
        for field in columns::interface(axes, plan.extra) {
            let components = field.components.names(axes).len();
            let (row, scales): (&[usize], &[&str]) = match components {
                0 => (&[nodes], &["time", node]),
                _ => (&[nodes, components], &["time", node, field.components.scale()]),
            };
            let set = self.growing::<f64>(&format!("{GROUP}/{}", field.name), rows, row)?;
            self.describe(set, about((field.units, field.long_name), plan.face.in_space), GROUP, scales);
        }
        self.time(GROUP, rows)?;
        if !plan.face.in_space {
            let about = ("m", "undeformed coordinate along the contact face");
            return self.fixed((GROUP, "x"), &plan.face.coordinates, about, &[("x", nodes)]);
        }
        self.nodes(GROUP, &plan.face)?;
        self.names(GROUP, Components::Axes, axes)
    }

    /// The nodes of a face of two directions, and the names of these.
    pub(super) fn nodes(&mut self, group: &str, face: &FacePlan) -> hdf5::Result<()> {
        let nodes = face.nodes();
        let about = ("m", "undeformed coordinates along the contact face");
        self.fixed((group, "coordinates"), &face.coordinates, about, &[("node", nodes), ("direction", 2)])?;
        if let (Some(made), false) = (self.made.last(), face.grid.is_empty()) {
            let grid: Vec<i64> = face.grid.iter().map(|&count| count as i64).collect();
            made.set.new_attr::<i64>().shape(grid.len()).create("grid")?.write_raw(&grid)?;
        }
        let indices: Vec<i64> = (0..nodes as i64).collect();
        self.fixed((group, "node"), &indices, ("1", "index of a node"), &[("node", nodes)])?;
        self.names(group, Components::Along, face.axes())
    }

    /// The names of components, as the scale of their dimension.
    fn names(&mut self, group: &str, components: Components, axes: usize) -> hdf5::Result<()> {
        let what = match components {
            Components::Stress => "component of a stress",
            Components::Along => "direction along the contact face",
            _ => "axis",
        };
        let names = components.names(axes).iter().map(|name| unicode(name)).collect::<hdf5::Result<Vec<_>>>()?;
        self.fixed((group, components.scale()), &names, ("1", what), &[(components.scale(), names.len())])
    }

    fn bulk(&mut self, plan: &BulkPlan, extra: Extra) -> hdf5::Result<()> {
        const GROUP: &str = "bulk";
        self.file.create_group(GROUP)?;
        let MeshSize { nodes, cells, axes, corners } = MeshSize::of(plan);
        for field in columns::bulk(extra) {
            let (row, scales): (&[usize], &[&str]) = match field.components {
                Components::Scalar => (&[nodes], &["time", "node"]),
                components => (&[nodes, components.names(axes).len()], &["time", "node", components.scale()]),
            };
            let set = self.growing::<f64>(&format!("{GROUP}/{}", field.name), plan.frames, row)?;
            self.describe(set, (field.units, field.long_name), GROUP, scales);
        }
        self.time(GROUP, plan.frames)?;
        let (node, axis, cell, corner) = (("node", nodes), ("axis", axes), ("cell", cells), ("corner", corners));
        let about = ("m", "undeformed coordinates of the nodes");
        self.fixed((GROUP, "coordinates"), &plan.coordinates, about, &[node, axis])?;
        let about = ("1", "nodes of each cell, from 0, counter-clockwise in a quadrilateral");
        self.fixed((GROUP, "cells"), &plan.cells, about, &[cell, corner])?;
        for ((name, count), what) in
            [(node, "index of a node"), (cell, "index of a cell"), (corner, "corner of a cell")]
        {
            let indices: Vec<i64> = (0..count as i64).collect();
            self.fixed((GROUP, name), &indices, ("1", what), &[(name, count)])?;
        }
        self.names(GROUP, Components::Axes, axes)?;
        self.names(GROUP, Components::Stress, axes)
    }

    /// The times of a group's rows.
    fn time(&mut self, group: &str, rows: usize) -> hdf5::Result<()> {
        let set = self.growing::<f64>(&format!("{group}/time"), rows, &[])?;
        self.describe(set, ("s", "time"), group, &["time"]);
        Ok(())
    }

    /// Notes what a dataset is, and which datasets of the group are the scales of its dimensions.
    fn describe(
        &mut self,
        set: Dataset,
        (units, long_name): (&'static str, impl Into<String>),
        group: &str,
        scales: &[&str],
    ) {
        let scales = scales.iter().map(|scale| format!("{group}/{scale}")).collect();
        self.made.push(Described { set, units, long_name: long_name.into(), scales });
    }

    /// A dataset that is written whole, with the scale and the length of each dimension.
    pub(super) fn fixed<T: H5Type>(
        &mut self,
        (group, name): (&str, &str),
        values: &[T],
        about: (&'static str, impl Into<String>),
        dimensions: &[(&str, usize)],
    ) -> hdf5::Result<()> {
        let (scales, shape): (Vec<&str>, Vec<usize>) = dimensions.iter().copied().unzip();
        let mut builder = self.file.new_dataset::<T>();
        if size_of_val(values) >= PACKED_CHUNK / 16 && deflate_available() {
            builder = builder.chunk(packed_chunk(&shape, size_of::<T>())).shuffle().deflate(LEVEL);
        }
        let set = builder.shape(shape).obj_track_times(false).create(format!("{group}/{name}").as_str())?;
        set.write_raw(values)?;
        self.describe(set, about, group, &scales);
        Ok(())
    }

    /// A dataset that rows are added to, created with room for `rows` of them, of shape `row` each. Room is set aside and
    /// not filled, so that the file takes no more of the disk than what is written. Where the file is packed, fields are
    /// compressed.
    fn growing<T: H5Type>(&self, name: &str, rows: usize, row: &[usize]) -> hdf5::Result<Dataset> {
        let row_bytes = size_of::<T>() * row.iter().product::<usize>();
        if row_bytes > LARGEST_CHUNK {
            return Err(format!("a row of /{name} has {row_bytes} bytes; HDF5 takes up to {LARGEST_CHUNK}").into());
        }
        let shape = |rows: usize| -> Vec<usize> { std::iter::once(rows).chain(row.iter().copied()).collect() };
        let builder = self.file.new_dataset::<T>().obj_track_times(false);
        if self.purpose == Purpose::Packed {
            let builder = match (row.is_empty(), rows) {
                (true, _) | (_, 0) => builder,
                (false, _) => builder.chunk(packed_chunk(&shape(rows), size_of::<T>())).shuffle().deflate(LEVEL),
            };
            return builder.shape(shape(rows)).create(name);
        }
        let chunk_rows = (LARGEST_CHUNK / row_bytes.max(1)).clamp(1, rows.max(1));
        // Whole chunks only: the room in the last one is there anyway.
        let rows = rows.max(1).next_multiple_of(chunk_rows);
        let extents: Vec<hdf5::Extent> =
            std::iter::once(hdf5::Extent::resizable(rows)).chain(row.iter().map(|&n| hdf5::Extent::fixed(n))).collect();
        builder
            .shape(hdf5::SimpleExtents::from_vec(extents))
            .chunk(shape(chunk_rows))
            .alloc_time(Some(AllocTime::Early))
            .fill_time(FillTime::Never)
            .create(name)
    }
}

/// The chunk of a compressed dataset: whole rows, or a part of one.
fn packed_chunk(shape: &[usize], number_bytes: usize) -> Vec<usize> {
    let mut room = PACKED_CHUNK / number_bytes;
    let mut chunk: Vec<usize> = shape
        .iter()
        .rev()
        .map(|&length| {
            let taken = length.clamp(1, room.max(1));
            room /= taken;
            taken
        })
        .collect();
    chunk.reverse();
    chunk
}

/// A scalar attribute without a value yet.
pub(super) fn attribute<T: H5Type>(object: &Location, name: &str) -> hdf5::Result<hdf5::Attribute> {
    object.new_attr::<T>().char_encoding(CharEncoding::Ascii).create(name)
}

/// A string attribute. Of variable length: h5py gives `str` for those and bytes for the others.
pub(super) fn text(object: &Location, name: &str, value: &str) -> hdf5::Result<()> {
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
