//! Reads result files, those of a run that is still going on or was killed included.

use std::path::{Path, PathBuf};

use hdf5::types::VarLenUnicode;

use super::columns::{self, Value};
use super::{Extra, HistoryRow};
use crate::error::{Error, Result, plain};
use crate::input;

/// A result file open for reading.
#[derive(Debug)]
pub struct Results {
    path: PathBuf,
    file: hdf5::File,
}

/// A field with `columns` values in each of `rows` rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Number of rows, such as stored times.
    pub rows: usize,
    /// Values per row; for bulk fields nodes times components, components fastest.
    pub columns: usize,
    /// Row after row.
    pub values: Vec<f64>,
}

impl Field {
    /// One row.
    pub fn row(&self, row: usize) -> &[f64] {
        self.values.get(row * self.columns..(row + 1) * self.columns).unwrap_or_default()
    }
}

/// Whether this program wrote the file at `path`.
pub fn is_ours(path: &Path) -> bool {
    input::regular(path).is_ok() && hdf5::File::open(path).and_then(|file| file.attr("mpjr_version")).is_ok()
}

impl Results {
    /// Opens a file that this program wrote.
    pub fn open(path: &Path) -> Result<Self> {
        // The system's words on a file that is missing or may not be read are plainer than the library's.
        input::regular(path)?;
        std::fs::File::open(path).map_err(|error| Error::file(path, error))?;
        let file = hdf5::File::open(path)
            .map_err(|error| Error::file(path, format!("is not an HDF5 file that can be read ({})", plain(&error))))?;
        if file.attr("mpjr_version").is_err() {
            return Err(Error::file(path, "is an HDF5 file, but not one that mpjr wrote"));
        }
        Ok(Self { path: path.to_owned(), file })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A string attribute of the root, such as `title`, `scene` or `status`.
    pub fn text(&self, name: &str) -> Result<String> {
        let value = self.file.attr(name).and_then(|attribute| attribute.read_scalar::<VarLenUnicode>());
        value.map(|value| value.to_string()).map_err(|error| self.missing(&format!("attribute {name}"), &error))
    }

    /// A numeric attribute of the root, such as `wall_seconds` or `mpi_ranks`.
    pub fn number(&self, name: &str) -> Result<f64> {
        let value = self.file.attr(name).and_then(|attribute| attribute.read_scalar());
        value.map_err(|error| self.missing(&format!("attribute {name}"), &error))
    }

    /// What was found doubtful, each as `KEY: text`.
    pub fn warnings(&self) -> Result<Vec<String>> {
        let read = || -> hdf5::Result<Vec<String>> {
            let attribute = self.file.attr("warnings")?;
            match attribute.size() {
                0 => Ok(Vec::new()),
                _ => Ok(attribute.read_raw::<VarLenUnicode>()?.iter().map(ToString::to_string).collect()),
            }
        };
        read().map_err(|error| self.missing("attribute warnings", &error))
    }

    /// The names of the phases.
    pub fn phase_names(&self) -> Result<Vec<String>> {
        let names =
            self.file.dataset("history/phase").and_then(|phase| phase.attr("names")?.read_raw::<VarLenUnicode>());
        let names = names.map_err(|error| self.missing("attribute names of /history/phase", &error))?;
        Ok(names.iter().map(ToString::to_string).collect())
    }

    /// Which columns its history has besides those that all have.
    pub fn extra(&self) -> Extra {
        let mounts = ["mount_normal", "mount_tangential"].map(|column| self.has(&format!("history/{column}")));
        let (wear, worn_profile) = (self.has("history/worn_volume"), self.has("interface/worn_profile"));
        let [energy, heat, adhesion] = ["energy/stored", "max_temperature", "energy/adhesion"]
            .map(|column| self.has(&format!("history/{column}")));
        Extra { energy, mounts, wear, worn_profile, heat, adhesion }
    }

    /// Whether the file has the dataset, such as `history/energy/stored` or `bulk/stress`.
    pub fn has(&self, dataset: &str) -> bool {
        self.file.dataset(dataset).is_ok()
    }

    /// The names of all datasets of numbers, from the root.
    pub fn datasets(&self) -> Result<Vec<String>> {
        fn below(group: &hdf5::Group, found: &mut Vec<String>) -> hdf5::Result<()> {
            for set in group.datasets()? {
                let kind = set.dtype()?;
                if kind.is::<f64>() || kind.is::<i64>() {
                    found.push(set.name().trim_start_matches('/').to_owned());
                }
            }
            group.groups()?.iter().try_for_each(|group| below(group, found))
        }
        let mut found = Vec::new();
        below(&self.file, &mut found).map_err(|error| self.missing("list of datasets", &error))?;
        Ok(found)
    }

    /// A column of the history as numbers: `time`, `normal_force`, `energy/stored`, ... As many as there are times. Of a vector
    /// those along x.
    pub fn history(&self, column: &str) -> Result<Vec<f64>> {
        self.history_along(column, 0)
    }

    /// The same of a vector along x, 0, or along y, 1; where it has none, zeros.
    pub fn history_along(&self, column: &str, direction: usize) -> Result<Vec<f64>> {
        let rows = self.field("history/time")?.rows;
        let field = self.field(&format!("history/{column}"))?;
        let value = |row| field.row(row).get(direction).copied().unwrap_or(0.0);
        Ok((0..rows.min(field.rows)).map(value).collect())
    }

    /// The whole history, with the energies where the run kept them.
    pub fn rows(&self, extra: Extra) -> Result<Vec<HistoryRow>> {
        let mut rows = Vec::new();
        for column in columns::history(extra) {
            let values = self.history(column.name)?;
            rows.resize(values.len(), HistoryRow::default());
            for (row, value) in rows.iter_mut().zip(values) {
                match column.value {
                    Value::Real(of) | Value::Along([of, _]) => *of(row) = value,
                    Value::Count(of) => *of(row) = value as usize,
                }
            }
            if let Value::Along([_, of]) = column.value {
                let across = self.history_along(column.name, 1)?;
                rows.iter_mut().zip(across).for_each(|(row, value)| *of(row) = value);
            }
        }
        Ok(rows)
    }

    /// A field on the contact face: `pressure`, ... (k x m) or `time`, `x` (one column). As many rows as there are
    /// times, except for `x`.
    pub fn interface(&self, name: &str) -> Result<Field> {
        self.table("interface", name)
    }

    /// A field of the bulk: `displacement`, `stress` (j x nodes x components), `time`, or the mesh: `coordinates`,
    /// `cells`.
    pub fn bulk(&self, name: &str) -> Result<Field> {
        self.table("bulk", name)
    }

    /// A dataset of steady sliding: `velocity`, `pressure`, ... as many rows as there are velocities; and `relaxation_time`.
    pub fn steady(&self, name: &str) -> Result<Field> {
        self.field(&format!("steady/{name}"))
    }

    fn table(&self, group: &str, name: &str) -> Result<Field> {
        let mut field = self.field(&format!("{group}/{name}"))?;
        let face = |axes| columns::interface(axes, Extra::ALL).map(|field| field.name);
        let mut grow = face(2).chain(face(3)).chain(columns::bulk(Extra::ALL).map(|field| field.name));
        if grow.any(|field| field == name) {
            let rows = self.field(&format!("{group}/time"))?.rows;
            field.rows = field.rows.min(rows);
            field.values.truncate(field.rows * field.columns);
        }
        Ok(field)
    }

    /// A dataset, named from the root.
    pub fn field(&self, dataset: &str) -> Result<Field> {
        let read = || -> hdf5::Result<Field> {
            let set = self.file.dataset(dataset)?;
            let shape = set.shape();
            let (rows, columns) = (shape.first().copied().unwrap_or(1), shape.iter().skip(1).product());
            Ok(Field { rows, columns, values: set.read_raw()? })
        };
        read().map_err(|error| self.missing(&format!("dataset /{dataset}"), &error))
    }

    fn missing(&self, what: &str, error: &hdf5::Error) -> Error {
        Error::file(&self.path, format!("has no {what} that can be read ({})", plain(error)))
    }
}
