//! Maps of heights out of the files of instruments and of numerical programs.
//!
//! Whatever the format, height [i, j] is that at x = x0 + i dx, y = y0 + j dy: the first index goes along x, the second
//! along y. In .npy, .h5 and .txt these are the indices of the array (of the matrix: lines and columns); .sdf and .x3p have
//! profiles along x one after the other, each at a greater y; .xyz says where each point is. Nothing is turned upside down.
//!
//! What a file declares is held against what it has before anything is allocated for it.

mod dataset;
mod npy;
mod sdf;
mod stored;
mod text;
mod x3p;

use std::path::Path;

use crate::table::Unit;

/// The formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// An array of NumPy.
    Npy,
    /// A dataset of an HDF5 file.
    Hdf5,
    /// A matrix as text.
    Matrix,
    /// Three columns as text: x, y and height.
    Points,
    /// ISO 25178-71, as text or binary.
    Sdf,
    /// ISO 25178-72: a zip archive with an index in XML.
    X3p,
}

/// How the name of a file of each format ends.
const ENDINGS: [(&str, Format); 9] = [
    ("npy", Format::Npy),
    ("h5", Format::Hdf5),
    ("hdf5", Format::Hdf5),
    ("txt", Format::Matrix),
    ("csv", Format::Matrix),
    ("dat", Format::Matrix),
    ("xyz", Format::Points),
    ("sdf", Format::Sdf),
    ("x3p", Format::X3p),
];

/// Heights over a regular grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Heights {
    /// Points along x and along y, each at least 2.
    pub counts: [usize; 2],
    /// m, all finite; along y first.
    pub values: Vec<f64>,
    /// The distance of neighbours along x and along y, m, where the file says it.
    pub spacing: Option<[f64; 2]>,
    /// Where the first point is, m, where the file says it.
    pub origin: Option<[f64; 2]>,
    /// The units of places, if the file has them, and of heights.
    pub units: [Option<Unit>; 2],
}

impl Format {
    /// By the end of a name.
    ///
    /// # Errors
    /// What names of files end in.
    pub fn of(name: &str) -> Result<Self, String> {
        let ending = Path::new(name).extension().map(|ending| ending.to_string_lossy().to_lowercase());
        let known = ENDINGS.iter().find(|(known, _)| Some(*known) == ending.as_deref());
        known.map(|(_, format)| *format).ok_or_else(|| {
            let endings: Vec<String> = ENDINGS.iter().map(|(ending, _)| format!(".{ending}")).collect();
            format!("must be the name of a file that ends in {}, got {name:?}", endings.join(", "))
        })
    }

    /// Whether the file says how far its points are apart.
    pub fn has_spacing(self) -> bool {
        matches!(self, Self::Points | Self::Sdf | Self::X3p)
    }

    /// Whether the standard says that all is in m.
    pub fn is_in_metres(self) -> bool {
        matches!(self, Self::Sdf | Self::X3p)
    }

    /// The heights in the content of a file that is no HDF5, with the units that the scene says of places and heights.
    ///
    /// # Errors
    /// What is wrong with it, and the remedy.
    pub fn parse(self, bytes: &[u8], said: [Option<Unit>; 2]) -> Result<Heights, String> {
        let heights = match self {
            Self::Npy => npy::read(bytes)?.in_unit(said[1]),
            Self::Matrix => text::matrix(bytes)?.in_unit(said[1]),
            Self::Points => text::points(bytes, said)?,
            Self::Sdf => sdf::read(bytes)?,
            Self::X3p => x3p::read(bytes)?,
            Self::Hdf5 => return Err("an HDF5 file is read from its path".to_owned()),
        };
        heights.checked()
    }
}

/// The heights in a dataset of an HDF5 file, in the unit that the scene says.
///
/// # Errors
/// What is wrong with it, and the remedy.
pub fn dataset(file: &Path, name: &str, said: Option<Unit>) -> Result<Heights, String> {
    dataset::read(file, name)?.in_unit(said).checked()
}

impl Heights {
    /// Of a file that says nothing but numbers; not yet known to be finite.
    fn bare(counts: [usize; 2], values: Vec<f64>) -> Self {
        Self { counts, values, spacing: None, origin: None, units: [None; 2] }
    }

    /// Of a file that is in m by its standard and says how far points are apart.
    fn spaced(counts: [usize; 2], values: Vec<f64>, spacing: [f64; 2]) -> Self {
        Self { spacing: Some(spacing), units: [Some(Unit::METRE); 2], ..Self::bare(counts, values) }
    }

    /// With numbers that are in a unit.
    fn in_unit(mut self, said: Option<Unit>) -> Self {
        let unit = said.unwrap_or(Unit::METRE);
        self.values.iter_mut().for_each(|value| *value = unit.to_si(*value));
        Self { units: [None, Some(unit)], ..self }
    }

    /// Whether it is a surface: points enough, each with a height, and a distance between them.
    fn checked(self) -> Result<Self, String> {
        let [columns, rows] = self.counts;
        if columns < 2 || rows < 2 {
            return Err(format!("has {columns} x {rows} points along x and y; at least 2 x 2 make a surface"));
        }
        if let Some(spacing) = self.spacing.filter(|spacing| !spacing.iter().all(|d| d.is_finite() && *d > 0.0)) {
            return Err(format!(
                "says that its points are {:?} and {:?} m apart, which are no distances",
                spacing[0], spacing[1]
            ));
        }
        let missing = self.values.iter().filter(|value| !value.is_finite()).count();
        if missing > 0 {
            let first = self.values.iter().position(|value| !value.is_finite()).unwrap_or(0);
            return Err(format!(
                "has {missing} points of {} without a value, the first at [{}, {}] (from 0, along x and y): fill them first, as \
                 SurfaceTopography's interpolate_undefined_data() does, or cut them off",
                self.values.len(),
                first / rows,
                first % rows
            ));
        }
        Ok(self)
    }

    /// h = -z: the file's peaks become the points that touch first.
    pub fn invert(&mut self) {
        self.values.iter_mut().for_each(|value| *value = -*value);
    }

    /// Adds a constant, m.
    pub fn shift(&mut self, offset: f64) {
        self.values.iter_mut().for_each(|value| *value += offset);
    }

    /// Takes off the mean height.
    pub fn take_off_mean(&mut self) {
        let mean = self.values.iter().sum::<f64>() / self.values.len() as f64;
        self.shift(-mean);
    }

    /// Takes off the plane of least squares. Over a whole grid its slopes along x and y do not depend on one another:
    /// each is sum (i - m) h / sum (i - m)^2 with the indices i of one direction and their mean m.
    pub fn take_off_plane(&mut self) {
        self.take_off_mean();
        let [columns, rows] = self.counts;
        let middle = [columns, rows].map(|count| 0.5 * (count as f64 - 1.0));
        let offsets = |k: usize| [(k / rows) as f64 - middle[0], (k % rows) as f64 - middle[1]];
        let mut products = [0.0; 2];
        for (k, value) in self.values.iter().enumerate() {
            let offset = offsets(k);
            products = [0, 1].map(|axis| products[axis] + offset[axis] * value);
        }
        // sum (i - m)^2 over n indices is n (n^2 - 1)/12.
        let squares = |n: usize, others: usize| others as f64 * n as f64 * ((n * n) as f64 - 1.0) / 12.0;
        let slopes = [products[0] / squares(columns, rows), products[1] / squares(rows, columns)];
        for (k, value) in self.values.iter_mut().enumerate() {
            let offset = offsets(k);
            *value -= slopes[0] * offset[0] + slopes[1] * offset[1];
        }
    }

    /// What a reader of the scene cannot see.
    pub fn note(&self) -> String {
        let name = |unit: Option<Unit>| unit.map_or("m", |unit| unit.name);
        match self.units {
            [Some(place), height] if Some(place) != height => {
                format!("x and y in {}, z in {}", place.name, name(height))
            }
            [_, height] => format!("in {}", name(height)),
        }
    }

    /// As a list of numbers: the heights, and behind them counts, spacing and origin.
    pub fn into_numbers(self, spacing: [f64; 2], origin: [f64; 2]) -> Vec<f64> {
        let mut numbers = self.values;
        numbers.reserve_exact(6);
        numbers.extend(self.counts.map(|count| count as f64).into_iter().chain(spacing).chain(origin));
        numbers
    }

    /// Of such a list; none where it is too short to be one.
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let (values, rest) = numbers.split_last_chunk::<6>()?;
        let [columns, rows, dx, dy, x, y] = *rest;
        let counts = [columns as usize, rows as usize];
        let whole = counts[0].checked_mul(counts[1]) == Some(values.len());
        let heights = || Self {
            counts,
            values: values.to_vec(),
            spacing: Some([dx, dy]),
            origin: Some([x, y]),
            units: [None; 2],
        };
        whole.then(heights)
    }
}

#[cfg(test)]
mod tests;
