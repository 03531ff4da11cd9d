//! The elastic compliance of the contact face: what the condensed strategy needs of the body.
//!
//! u = C f for forces f on the face alone, at the instantaneous moduli: C is the inverse of the Schur complement of
//! the stiffness onto the face.

use std::f64::consts::PI;

use nalgebra::{Complex, Matrix2};

use super::super::body::Body;
use crate::element::quad4;
use crate::error::Result;
use crate::petsc::Cholesky;

/// C, dense: (x, z of each face node)^2, m per N/m, column-major; zero rows and columns where a component is held.
#[derive(Debug, Clone, PartialEq)]
pub struct Compliance {
    order: usize,
    values: Vec<f64>,
}

impl Compliance {
    /// By the Schur complement of a body that this rank holds whole.
    pub fn by_schur_complement(body: &Body) -> Result<Self> {
        let kept: Vec<i32> = Self::free_rows(body).into_iter().map(|(_, row)| row).collect();
        let mut stiffness = body.elastic()?;
        stiffness.declare_positive_definite()?;
        let (_, inverse) = Cholesky::with_inverse_schur(&stiffness, &kept)?;
        Ok(Self::from_free(body, &inverse))
    }

    /// The face's components that are not held: their place on the face and their row in the body.
    pub fn free_rows(body: &Body) -> Vec<(usize, i32)> {
        let (mesh, numbering) = (body.mesh(), body.numbering());
        let components =
            mesh.face.unknown.iter().enumerate().flat_map(|(i, &unknown)| [(i, unknown, 0), (i, unknown, 1)]);
        components
            .filter(|&(_, unknown, component)| !mesh.held[unknown as usize][component])
            .map(|(i, unknown, component)| {
                (2 * i + component, 2 * numbering.global[unknown as usize] + component as i32)
            })
            .collect()
    }

    /// From the compliance of the components that are not held.
    pub fn from_free(body: &Body, inverse: &[f64]) -> Self {
        let places: Vec<usize> = Self::free_rows(body).into_iter().map(|(place, _)| place).collect();
        let order = 2 * body.mesh().face.unknown.len();
        let mut values = vec![0.0; order * order];
        for (column, source) in places.iter().zip(inverse.chunks_exact(places.len())) {
            for (row, value) in places.iter().zip(source) {
                values[column * order + row] = *value;
            }
        }
        Self { order, values }
    }

    /// For a periodic layer, whose stiffness is block-circulant along x: one block-tridiagonal elimination through
    /// the depth per wavenumber, and no sparse factor at all. `cells` are those of one column, from the top down.
    ///
    /// At wavenumber k the layer is a column of node rows coupled by Hermitian 2 x 2 blocks; elimination from the
    /// clamped row upward leaves S(k) at the face, and C(x) is the inverse transform of S(k)^-1.
    pub fn of_periodic_columns(cells: &[quad4::Stiffness], columns: usize) -> Self {
        // C(-k) is the conjugate of C(k): half of the wavenumbers suffice.
        let spectrum: Vec<Matrix2<Complex<f64>>> =
            (0..=columns / 2).map(|k| face_compliance(cells, 2.0 * PI * k as f64 / columns as f64)).collect();
        let mut values = vec![0.0; 4 * columns * columns];
        for offset in 0..columns {
            let block = at_offset(&spectrum, offset, columns);
            for source in 0..columns {
                let node = (source + offset) % columns;
                for (row, column) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    values[(2 * source + column) * 2 * columns + 2 * node + row] = block[(row, column)];
                }
            }
        }
        Self { order: 2 * columns, values }
    }

    /// Rows, and columns.
    pub fn order(&self) -> usize {
        self.order
    }

    /// A column: the displacements of the face under a unit force.
    pub fn column(&self, column: usize) -> &[f64] {
        &self.values[column * self.order..][..self.order]
    }

    /// u += C f, for forces given as (place, force).
    pub fn add_displacements(&self, forces: impl Iterator<Item = (usize, f64)>, u: &mut [f64]) {
        for (place, force) in forces.filter(|(_, force)| *force != 0.0) {
            for (u, c) in u.iter_mut().zip(self.column(place)) {
                *u += c * force;
            }
        }
    }

    /// The largest diagonal entry, m per N/m.
    pub fn largest(&self) -> f64 {
        (0..self.order).map(|i| self.column(i)[i]).fold(0.0, f64::max)
    }
}

/// S(k)^-1 at the phase `angle` = k dx of one column of cells (from the top down).
fn face_compliance(cells: &[quad4::Stiffness], angle: f64) -> Matrix2<Complex<f64>> {
    let mut schur: Option<Matrix2<Complex<f64>>> = None;
    for cell in cells.iter().rev() {
        let [upper, coupling, lower] = column_blocks(cell, angle);
        schur = Some(match schur {
            // The lower row of the lowest cell is clamped.
            None => upper,
            Some(below) => {
                // K_u - K_ul (S_below + K_l)^-1 K_lu
                let pivot = (below + lower).try_inverse().unwrap_or_else(Matrix2::zeros);
                upper - coupling * pivot * coupling.adjoint()
            }
        });
    }
    schur.and_then(Matrix2::try_inverse).unwrap_or_else(Matrix2::zeros)
}

/// A cell's stiffness between waves of the node rows above and below it: (upper, upper), (upper, lower),
/// (lower, lower). Corners: lower left, lower right, upper right, upper left; the right ones lead by `angle`.
fn column_blocks(cell: &quad4::Stiffness, angle: f64) -> [Matrix2<Complex<f64>>; 3] {
    let lead = Complex::from_polar(1.0, angle);
    let phase = [Complex::from(1.0), lead, lead, Complex::from(1.0)];
    let (upper, lower) = ([2, 3], [0, 1]);
    let between = |rows: [usize; 2], columns: [usize; 2]| {
        let mut block = Matrix2::zeros();
        for row in rows {
            for column in columns {
                let real = cell.fixed_view::<2, 2>(2 * row, 2 * column).map(Complex::from);
                block += real * (phase[row].conj() * phase[column]);
            }
        }
        block
    };
    [between(upper, upper), between(upper, lower), between(lower, lower)]
}

/// The real block C(x = offset) from the half spectrum of a sequence of `length`.
fn at_offset(spectrum: &[Matrix2<Complex<f64>>], offset: usize, length: usize) -> Matrix2<f64> {
    let mut sum = Matrix2::zeros();
    for (k, block) in spectrum.iter().enumerate() {
        let twice = if k == 0 || 2 * k == length { 1.0 } else { 2.0 };
        // Reduced first: the angle keeps its digits for long faces.
        let angle = 2.0 * PI * ((k * offset) % length) as f64 / length as f64;
        sum += block.map(|value| (value * Complex::from_polar(1.0, angle)).re) * twice;
    }
    sum / length as f64
}
