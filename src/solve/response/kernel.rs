//! A compliance wave vector by wave vector.

use nalgebra::{DMatrix, SMatrix};
use rustfft::num_complex::Complex;

/// A real symmetric matrix for each wave vector, as a list for each of its entries: what only some of them are asked of passes over
/// no others.
#[derive(Clone)]
pub struct Kernel<const D: usize> {
    /// The upper triangle, row by row.
    entries: Vec<Vec<f64>>,
}

/// Where an entry stands.
fn place<const D: usize>(i: usize, j: usize) -> usize {
    let (i, j) = (i.min(j), i.max(j));
    i * D - i * (i + 1) / 2 + j
}

impl<const D: usize> Kernel<D> {
    /// Of matrices that are symmetric but for round-off.
    pub fn new(matrices: impl ExactSizeIterator<Item = SMatrix<f64, D, D>>) -> Self {
        let mut entries: Vec<Vec<f64>> = (0..D * (D + 1) / 2).map(|_| Vec::with_capacity(matrices.len())).collect();
        for matrix in matrices {
            for (i, j) in (0..D).flat_map(|i| (i..D).map(move |j| (i, j))) {
                entries[place::<D>(i, j)].push(matrix[(i, j)]);
            }
        }
        Self { entries }
    }

    /// How many wave vectors there are.
    pub fn len(&self) -> usize {
        self.entries[0].len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// One entry of a wave vector.
    pub fn entry(&self, wave: usize, i: usize, j: usize) -> f64 {
        self.entries[place::<D>(i, j)][wave]
    }

    /// The matrix of a wave vector.
    pub fn matrix(&self, wave: usize) -> SMatrix<f64, D, D> {
        SMatrix::from_fn(|i, j| self.entry(wave, i, j))
    }

    /// w = C w
    pub fn act(&self, wave: usize, w: &mut [Complex<f64>; D]) {
        let product = |i: usize| (0..D).map(|j| w[j] * self.entry(wave, i, j)).sum();
        *w = std::array::from_fn(product);
    }

    /// The same of the last component alone.
    pub fn act_normally(&self, wave: usize, w: &mut [Complex<f64>; D]) {
        w[D - 1] *= self.entries[place::<D>(D - 1, D - 1)][wave];
    }

    /// The smallest eigenvalue of all.
    pub fn smallest(&self) -> f64 {
        let of =
            |wave: usize| DMatrix::from_column_slice(D, D, self.matrix(wave).as_slice()).symmetric_eigenvalues().min();
        (0..self.len()).map(of).fold(f64::INFINITY, f64::min)
    }
}
