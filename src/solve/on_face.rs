//! The linear system of the monolithic strategy on the nodes in contact.
//!
//! With B the components where T = dR/du has columns, (c 1 + C T) x = b is solved by
//!
//! ```text
//! (c 1 + (C T)_BB) x_B = b_B,     x = (b - C T_B x_B) / c
//! ```

use nalgebra::SMatrix;

use super::response::Compliance;
use crate::error::Result;
use crate::interface::Tangent;
use crate::petsc::DenseLu;

/// The columns of T that are not zero: for each, (row, value) in components of the face.
#[derive(Debug, Clone, Default)]
pub struct SparseColumns {
    places: Vec<usize>,
    entries: Vec<Vec<(usize, f64)>>,
}

/// The factor of c 1 + (C T)_BB, with what it was made for.
pub struct Factor {
    lu: DenseLu,
    columns: SparseColumns,
    secant: f64,
}

impl SparseColumns {
    /// The columns with an entry above `negligible`, N/m per m.
    pub fn new<const D: usize>(tangent: &Tangent<D>, pairs: &[(usize, usize)], negligible: f64) -> Self {
        let mut all: Vec<Vec<(usize, f64)>> = vec![Vec::new(); D * tangent.diagonal.len()];
        let mut add = |row: usize, column: usize, block: &SMatrix<f64, D, D>| {
            for (i, j) in (0..D).flat_map(|j| (0..D).map(move |i| (i, j))).filter(|place| block[*place] != 0.0) {
                all[D * column + j].push((D * row + i, block[(i, j)]));
            }
        };
        for (node, block) in tangent.diagonal.iter().enumerate() {
            add(node, node, block);
        }
        for (&(row, column), block) in pairs.iter().zip(&tangent.coupling) {
            add(row, column, block);
        }
        let matters = |(_, entries): &(usize, Vec<(usize, f64)>)| entries.iter().any(|(_, t)| t.abs() > negligible);
        let (places, entries) = all.into_iter().enumerate().filter(matters).unzip();
        Self { places, entries }
    }

    /// The rows with an entry; one may come more than once.
    pub fn rows(&self) -> impl Iterator<Item = usize> {
        self.entries.iter().flatten().map(|&(row, _)| row)
    }

    /// T v as (row, force), for v given by component.
    pub fn multiply(&self, v: impl Fn(usize) -> f64) -> impl Iterator<Item = (usize, f64)> {
        self.places.iter().zip(&self.entries).flat_map(move |(&place, entries)| {
            let v = v(place);
            entries.iter().map(move |(row, t)| (*row, t * v))
        })
    }
}

impl Factor {
    /// Factorises for the given columns and c.
    pub fn new<const D: usize>(compliance: &Compliance<D>, columns: SparseColumns, secant: f64) -> Result<Self> {
        let order = columns.places.len();
        let mut matrix = vec![0.0; order * order];
        for (j, entries) in columns.entries.iter().enumerate() {
            let target = &mut matrix[j * order..][..order];
            for (row, t) in entries {
                compliance.add_column(*row, *t, &columns.places, target);
            }
            target[j] += secant;
        }
        Ok(Self { lu: DenseLu::new(order, matrix)?, columns, secant })
    }

    /// T.
    pub fn columns(&self) -> &SparseColumns {
        &self.columns
    }

    /// x = (b - C T_B x_B) / c
    pub fn solve<const D: usize>(&self, compliance: &Compliance<D>, b: &[f64], x: &mut [f64]) -> Result<()> {
        let places = &self.columns.places;
        let right: Vec<f64> = places.iter().map(|&place| b[place]).collect();
        let mut active = vec![0.0; places.len()];
        self.lu.solve(&right, &mut active)?;
        x.fill(0.0);
        for (place, value) in places.iter().zip(&active) {
            x[*place] = *value;
        }
        let forces: Vec<(usize, f64)> = self.columns.multiply(|place| x[place]).collect();
        x.copy_from_slice(b);
        compliance.add_displacements(forces.into_iter().map(|(row, force)| (row, -force)), x, 0..D)?;
        x.iter_mut().for_each(|value| *value /= self.secant);
        Ok(())
    }
}
