//! The rows of a result file: where they go, and the one small write that makes them visible.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::unix::fs::{FileExt, MetadataExt};
use std::path::{Path, PathBuf};

use super::columns;
use super::scratch::scratch;
use super::{Plan, Status, locate, skeleton};
use crate::checksum::row_sum;
use crate::error::{Error, Result, plain};
use crate::petsc::object_address::object_address;

/// A dataset that grows by rows, and where the library put it.
#[derive(Debug)]
struct Series {
    name: String,
    row_bytes: usize,
    chunk_rows: usize,
    /// Where each chunk begins in the file.
    chunks: Vec<u64>,
    /// Where the number of rows stands in the file.
    extent_at: u64,
}

/// Which of the three groups of datasets, each with a number of rows of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Table {
    History,
    Interface,
    Bulk,
}

/// A result file open for adding rows. No file handle is kept: every operation opens the file, checks that it is
/// still the same one, and closes it.
#[derive(Debug)]
pub(super) struct Store {
    path: PathBuf,
    identity: (u64, u64),
    /// Each table's series, in the order that rows give their values, and its number of committed rows.
    tables: [(Vec<Series>, usize); 3],
    /// The sums of each table's committed rows; see [`row_sum`].
    sums: [u64; 3],
    /// The bytes of the file from the first to the last extent, as they are on disk.
    extents: (u64, Vec<u8>),
    wall_seconds_at: u64,
    status_at: u64,
    /// What to write at `status_at` for each of `Status::ALL`: references to the strings of `status_values`.
    status_values: Vec<[u8; 16]>,
}

/// The committed rows of a dataset, and where they are in the file.
pub(super) struct Rows<'a> {
    pub table: Table,
    pub count: usize,
    series: &'a Series,
}

impl Rows<'_> {
    /// From the root.
    pub fn name(&self) -> &str {
        &self.series.name
    }

    pub fn row_bytes(&self) -> usize {
        self.series.row_bytes
    }

    /// Where a row begins in the file.
    pub fn at(&self, row: usize) -> Option<u64> {
        self.series.row_at(row)
    }
}

/// The datasets of a table, named from the root.
pub(super) fn names(table: Table, plan: &Plan) -> Vec<String> {
    match table {
        Table::History => columns::history(plan.extra).map(|column| format!("history/{}", column.name)).collect(),
        Table::Interface => {
            let fields = columns::interface(plan.face.axes(), plan.extra).map(|field| field.name);
            fields.chain(["time"]).map(|name| format!("interface/{name}")).collect()
        }
        Table::Bulk if plan.bulk.is_some() => {
            let fields = columns::bulk(plan.extra).map(|field| field.name);
            fields.chain(["time"]).map(|name| format!("bulk/{name}")).collect()
        }
        Table::Bulk => Vec::new(),
    }
}

impl Store {
    /// Learns from the file at `path`, whose extents are all at full length, where everything is.
    pub(super) fn locate(path: &Path, plan: &Plan) -> Result<Self> {
        let tables = [Table::History, Table::Interface, Table::Bulk];
        let all: Vec<Vec<String>> = tables.iter().map(|&table| names(table, plan)).collect();
        Self::find(path, &all)
    }

    fn find(path: &Path, tables: &[Vec<String>]) -> Result<Self> {
        let library = hdf5::File::open(path).map_err(|error| Error::file(path, plain(&error)))?;
        let root = object_address(&library).map_err(|error| Error::file(path, plain(&error)))?;
        let raw = File::open(path).map_err(|error| Error::file(path, error))?;
        let mut found = [const { (Vec::new(), 0) }; 3];
        for (table, names) in found.iter_mut().zip(tables) {
            for name in names {
                table.0.push(Series::find(&library, &raw, name).map_err(|error| Error::file(path, plain(&error)))?);
            }
        }
        library.close().map_err(|error| Error::file(path, plain(&error)))?;
        Self::from_raw(path, &raw, found, root).map_err(|error| Error::file(path, error))
    }

    fn from_raw(path: &Path, raw: &File, tables: [(Vec<Series>, usize); 3], root: u64) -> io::Result<Self> {
        let about = raw.metadata()?;
        let at = || tables.iter().flat_map(|(series, _)| series).map(|series| series.extent_at);
        let (first, last) = (at().min().unwrap_or(0), at().max().unwrap_or(0));
        let mut extents = vec![0; (last + 8 - first) as usize];
        raw.read_exact_at(&mut extents, first)?;
        let (wall_seconds_at, _) = locate::attribute(raw, root, "wall_seconds")?;
        let (status_at, _) = locate::attribute(raw, root, "status")?;
        let (_, values) = locate::attribute(raw, root, "status_values")?;
        let status_values = values.as_chunks().0.to_vec();
        let (path, identity) = (path.to_owned(), (about.dev(), about.ino()));
        let extents = (first, extents);
        Ok(Self { path, identity, tables, sums: [0; 3], extents, wall_seconds_at, status_at, status_values })
    }

    /// Learns where everything is from the file at `path` of which `rows` are to stay, which must be as they were written.
    pub(super) fn reopen(path: &Path, plan: &Plan, rows: super::Rows) -> Result<Self> {
        let mut store = Self::locate(path, plan)?;
        for ((series, count), rows) in store.tables.iter_mut().zip(rows.counts()) {
            let visible = |series: &Series| {
                let at = (series.extent_at - store.extents.0) as usize;
                let bytes = store.extents.1.get(at..at + 8).and_then(|bytes| bytes.try_into().ok());
                bytes.map_or(0, u64::from_le_bytes)
            };
            if let Some(short) = series.iter().find(|series| visible(series) < rows as u64) {
                let (name, there) = (&short.name, visible(short));
                let reason =
                    format!("has {there} rows of /{name} where the checkpoint counts {rows}; run without --resume");
                return Err(Error::file(path, reason));
            }
            *count = rows;
        }
        store.sums = store.sums_on_disk().map_err(|error| Error::file(path, error))?;
        match store.sums == rows.sums {
            true => Ok(store),
            false => Err(Error::file(path, DAMAGED)),
        }
    }

    /// The sums of the committed rows as they are in the file now.
    fn sums_on_disk(&self) -> io::Result<[u64; 3]> {
        let file = File::open(&self.path)?;
        let mut sums = [0; 3];
        let mut bytes = Vec::new();
        for (sum, (series, rows)) in sums.iter_mut().zip(&self.tables) {
            for (index, series) in series.iter().enumerate() {
                bytes.resize(series.row_bytes, 0);
                for row in 0..*rows {
                    let at = series.row_at(row).ok_or(io::ErrorKind::UnexpectedEof)?;
                    file.read_exact_at(&mut bytes, at)?;
                    *sum = row_sum(place(index, row), 0, &bytes).wrapping_add(*sum);
                }
            }
        }
        Ok(sums)
    }

    /// The rows that are there to stay.
    pub(super) fn committed(&self) -> super::Rows {
        let [history, interface, bulk] = [Table::History, Table::Interface, Table::Bulk].map(|table| self.rows(table));
        super::Rows { history, interface, bulk, sums: self.sums }
    }

    /// The file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// The file was renamed to `path`.
    pub(super) fn moved_to(&mut self, path: &Path) {
        self.path = path.to_owned();
    }

    /// The committed rows of all datasets.
    pub(super) fn stored(&self) -> Vec<Rows<'_>> {
        let mut stored = Vec::new();
        for (table, (all, count)) in [Table::History, Table::Interface, Table::Bulk].into_iter().zip(&self.tables) {
            stored.extend(all.iter().map(|series| Rows { table, count: *count, series }));
        }
        stored
    }

    /// How many committed rows a table has.
    pub(super) fn rows(&self, table: Table) -> usize {
        self.tables[table as usize].1
    }

    /// The rows that a table has room for.
    pub(super) fn capacity(&self, table: Table) -> usize {
        self.tables[table as usize].0.iter().map(|series| series.chunk_rows * series.chunks.len()).min().unwrap_or(0)
    }

    /// Where row `row` of the series number `index` of a table begins in the file; the row must be within capacity.
    pub(super) fn row_at(&self, table: Table, index: usize, row: usize) -> Result<u64> {
        let series = self.tables[table as usize].0.get(index);
        series
            .and_then(|series| series.row_at(row))
            .ok_or_else(|| Error::Internal(format!("no room for row {row} in {table:?}")))
    }

    /// Opens the file for one operation, if it is still the one that was created.
    pub(super) fn open(&self) -> Result<File> {
        let file = OpenOptions::new().write(true).open(&self.path).map_err(|error| Error::file(&self.path, error))?;
        let about = file.metadata().map_err(|error| Error::file(&self.path, error))?;
        if (about.dev(), about.ino()) == self.identity {
            return Ok(file);
        }
        Err(Error::file(
            &self.path,
            "was replaced while this run was writing it; give each run its own file with --out",
        ))
    }

    /// Writes one row of a table beyond the committed ones: `ahead` rows further, one run of bytes per series. It is
    /// not visible before [`Self::commit`], which wants the row's sum.
    pub(super) fn write_row(&self, file: &File, table: Table, ahead: usize, values: &[&[u8]]) -> Result<u64> {
        let (series, rows) = &self.tables[table as usize];
        if series.len() != values.len() {
            return Err(Error::Internal(format!("a row of {table:?} with {} values", values.len())));
        }
        let mut sum = 0_u64;
        for (index, (series, bytes)) in series.iter().zip(values).enumerate() {
            if bytes.len() != series.row_bytes {
                let (name, given, needed) = (&series.name, bytes.len() / 8, series.row_bytes / 8);
                return Err(Error::Internal(format!("a row of {name} with {given} numbers instead of {needed}")));
            }
            let at = self.row_at(table, index, rows + ahead)?;
            file.write_all_at(bytes, at).map_err(|error| failed(&self.path, error))?;
            sum = row_sum(place(index, rows + ahead), 0, bytes).wrapping_add(sum);
        }
        Ok(sum)
    }

    /// Makes `added` rows of each table visible, in one write; with the rows go their sums.
    pub(super) fn commit(&mut self, file: &File, added: &[(Table, usize, u64)]) -> Result<()> {
        let mut extents = self.extents.1.clone();
        for &(table, count, _) in added {
            let (series, rows) = &self.tables[table as usize];
            for series in series {
                let at = (series.extent_at - self.extents.0) as usize;
                extents[at..at + 8].copy_from_slice(&((rows + count) as u64).to_le_bytes());
            }
        }
        file.write_all_at(&extents, self.extents.0).map_err(|error| failed(&self.path, error))?;
        self.extents.1 = extents;
        for &(table, count, sum) in added {
            self.tables[table as usize].1 += count;
            self.sums[table as usize] = self.sums[table as usize].wrapping_add(sum);
        }
        Ok(())
    }

    /// Forgets the full extents that the library left: only the committed rows show.
    pub(super) fn show_committed_only(&mut self, file: &File) -> Result<()> {
        self.commit(file, &[Table::History, Table::Interface, Table::Bulk].map(|table| (table, 0, 0)))
    }

    /// Sets the attribute `wall_seconds`.
    pub(super) fn set_wall_seconds(&self, file: &File, seconds: f64) -> Result<()> {
        file.write_all_at(&seconds.to_ne_bytes(), self.wall_seconds_at).map_err(|error| failed(&self.path, error))
    }

    /// Sets the attribute `status`.
    pub(super) fn set_status(&self, file: &File, status: Status) -> Result<()> {
        let reference = Status::ALL.iter().position(|&other| other == status).and_then(|at| self.status_values.get(at));
        let reference = reference.ok_or_else(|| Error::Internal("status_values is not what was written".into()))?;
        file.write_all_at(reference, self.status_at).map_err(|error| failed(&self.path, error))
    }

    /// The same file with room for twice the rows of `table`, which must be full.
    pub(super) fn grown(&self, table: Table) -> Result<Self> {
        let capacity = self.capacity(table);
        let extend = |file: &hdf5::File| {
            self.tables[table as usize].0.iter().try_for_each(|series| {
                let set = file.dataset(&series.name)?;
                let mut shape = set.shape();
                if let Some(rows) = shape.first_mut() {
                    *rows = (2 * capacity).next_multiple_of(series.chunk_rows);
                }
                set.resize(shape)
            })
        };
        self.changed("make room for more rows", &extend)
    }

    /// The same file with these texts as the attribute `warnings`.
    pub(super) fn with_warnings(&self, warnings: &[String]) -> Result<Self> {
        let replace = |file: &hdf5::File| {
            if file.attr("warnings").is_ok() {
                file.delete_attr("warnings")?;
            }
            skeleton::texts(file, "warnings", warnings)
        };
        self.changed("take warnings", &replace)
    }

    /// The same file with this text as the attribute `scene`.
    pub(super) fn with_scene(&self, scene: &str) -> Result<Self> {
        let replace = |file: &hdf5::File| {
            file.delete_attr("scene")?;
            skeleton::text(file, "scene", scene)
        };
        self.changed("take the scene", &replace)
    }

    /// The same file after a change by the library, for which the file is copied and put in the place of the old one by
    /// a rename, so that at every moment one of the two is there.
    fn changed(&self, what: &str, change: &dyn Fn(&hdf5::File) -> hdf5::Result<()>) -> Result<Self> {
        let scratch = scratch(&self.path);
        let changed = self.changed_copy(what, change, &scratch);
        if changed.is_err() {
            // The error at hand says more than one about a leftover.
            let _ = std::fs::remove_file(&scratch);
        }
        changed
    }

    fn changed_copy(
        &self,
        what: &str,
        change: &dyn Fn(&hdf5::File) -> hdf5::Result<()>,
        scratch: &Path,
    ) -> Result<Self> {
        // Checks that the file at the path is ours before its copy takes that place.
        drop(self.open()?);
        std::fs::copy(&self.path, scratch).map_err(|error| failed(&self.path, error))?;
        let work = || -> hdf5::Result<()> {
            let file = hdf5::File::with_options().with_fapl(|access| access.libver_earliest()).open_rw(scratch)?;
            change(&file)?;
            file.close()
        };
        work().map_err(|error| Error::file(&self.path, format!("cannot {what}: {}", plain(&error))))?;

        let names = self.tables.iter().map(|(series, _)| series.iter().map(|s| s.name.clone()).collect());
        let mut changed = Self::find(scratch, &names.collect::<Vec<_>>())?;
        for (new, old) in changed.tables.iter_mut().zip(&self.tables) {
            new.1 = old.1;
        }
        changed.sums = self.sums;
        changed.show_committed_only(&changed.open()?)?;
        std::fs::rename(scratch, &self.path).map_err(|error| failed(&self.path, error))?;
        changed.moved_to(&self.path);
        Ok(changed)
    }
}

/// What the system said about a write to the result file, with what to do about it.
pub(super) fn failed(path: &Path, error: io::Error) -> Error {
    let remedy = match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "; free some space or choose another place with --out"
        }
        _ => "",
    };
    Error::file(path, format!("{error}{remedy}. What was written before is kept"))
}

pub(super) const DAMAGED: &str = "was changed since the checkpoint beside it was written: its rows are not those that it counts; \
                       restore the file, or begin anew with --restart";

/// What tells the rows of a table apart: that of the series number `index` with the number `row`.
pub(super) fn place(index: usize, row: usize) -> u64 {
    (index as u64) << 48 | row as u64
}

impl Series {
    /// Where a row begins in the file; none beyond capacity.
    fn row_at(&self, row: usize) -> Option<u64> {
        let chunk = self.chunks.get(row / self.chunk_rows)?;
        Some(chunk + (row % self.chunk_rows * self.row_bytes) as u64)
    }

    fn find(library: &hdf5::File, raw: &File, name: &str) -> hdf5::Result<Self> {
        let set = library.dataset(name)?;
        let header = object_address(&set)?;
        let (extent_at, _) = locate::extent(raw, header).map_err(|error| error.to_string())?;
        if !(set.dtype()?.is::<f64>() || set.dtype()?.is::<i64>()) {
            return Err(format!("/{name} does not hold numbers of 8 bytes").into());
        }
        let shape = set.chunk().ok_or_else(|| format!("/{name} is not chunked"))?;
        let mut chunks = (0..set.num_chunks().unwrap_or(0))
            .map(|index| set.chunk_info(index).ok_or_else(|| format!("/{name} has no chunk {index}").into()))
            .collect::<hdf5::Result<Vec<_>>>()?;
        chunks.sort_by(|a, b| a.offset.cmp(&b.offset));
        let row_bytes = set.dtype()?.size() * shape.iter().skip(1).product::<usize>();
        let chunk_rows = shape.first().copied().unwrap_or(1);
        Ok(Self {
            name: name.to_owned(),
            row_bytes,
            chunk_rows,
            chunks: chunks.into_iter().map(|chunk| chunk.addr).collect(),
            extent_at,
        })
    }
}
