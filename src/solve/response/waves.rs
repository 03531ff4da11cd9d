//! A periodic layer wave by wave.
//!
//! The columns of a periodic layer are alike, so that a Fourier transform along its face parts its stiffness into one matrix
//! per wave vector, block-tridiagonal through the depth. Cells are their own mirror images, which makes the D x D blocks
//! real once the transforms of the components along the face are written as i v:
//!
//! ```text
//! u_n = 1/columns sum_k (i v, u_z)(k) e^(i k.n),     w = (v, u_z);   k.n = 2 pi sum over the axes of k n/count
//! G'_{j-1} w_{j-1} + D_j w_j + G_j w_{j+1} = f_j        rows j from the face down; w = 0 at the clamped one
//! ```
//!
//! Block elimination from the clamped row upward leaves the face, whose compliance is P_0:
//!
//! ```text
//! P_j = (D_j - G_j P_{j+1} G_j')^-1,     s_j = f_j - G_j P_{j+1} s_{j+1}
//! w_0 = P_0 s_0,     w_{j+1} = P_{j+1} (s_{j+1} - G_j' w_j)
//! ```
//!
//! To the uniform wave the rows of cells are springs in series, L_j = -G_j: what is stiff moves with what is soft below it, which
//! the difference D_j - G_j P_{j+1} G_j' has no digits of where moduli are far apart. The compliances below a row add up instead:
//!
//! ```text
//! F_j = L_j^-1 + F_{j+1},     P_j = (L_{j-1} + F_j^-1)^-1 = F_j (1 + L_{j-1} F_j)^-1,     P_0 = F_0
//! ```

mod vibration;

use nalgebra::{Complex, ComplexField, SMatrix};

use super::transform::{Transform, Wave};
use crate::element::solid::Blocks;
use crate::error::{Error, Result};

pub use vibration::Vibration;

/// The stiffness of a layer, or a part of it.
pub struct Operator<const D: usize> {
    rows: usize,
    /// Whether the first wave vector is the uniform one.
    uniform: bool,
    /// Per wave vector, per row.
    blocks: Vec<Row<D>>,
}

/// D_j and G_j.
#[derive(Clone, Copy)]
struct Row<const D: usize, T = f64> {
    diagonal: SMatrix<T, D, D>,
    coupling: SMatrix<T, D, D>,
}

impl<const D: usize> Operator<D> {
    /// Of columns of the given cells, from the face down; the lower side of the last one is clamped.
    pub fn new(cells: &[Blocks<D>], transform: &Transform<D>) -> Self {
        let blocks = (0..transform.waves()).flat_map(|k| rows_of(cells, &transform.angles(k)).0).collect();
        Self { rows: cells.len(), uniform: transform.is_uniform(0), blocks }
    }

    /// The same with the lower side of the last cell free, which is one row more.
    pub fn with_free_base(cells: &[Blocks<D>], transform: &Transform<D>) -> Self {
        let of_wave = |k: usize| {
            let (mut rows, diagonal) = rows_of(cells, &transform.angles(k));
            rows.push(Row { diagonal, coupling: SMatrix::zeros() });
            rows
        };
        let blocks = (0..transform.waves()).flat_map(of_wave).collect();
        Self { rows: cells.len() + 1, uniform: transform.is_uniform(0), blocks }
    }

    /// Rows of each wave vector.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// sum_p factor_p part_p, of parts of one layer.
    pub fn sum(parts: &[Self], factors: &[f64]) -> Self {
        let none = Row { diagonal: SMatrix::zeros(), coupling: SMatrix::zeros() };
        let mut blocks = vec![none; parts[0].blocks.len()];
        for (part, &factor) in parts.iter().zip(factors) {
            for (sum, row) in blocks.iter_mut().zip(&part.blocks) {
                sum.diagonal += row.diagonal * factor;
                sum.coupling += row.coupling * factor;
            }
        }
        Self { rows: parts[0].rows, uniform: parts[0].uniform, blocks }
    }

    /// load -= K w
    pub fn subtract_product(&self, w: &[Wave<D>], load: &mut [Wave<D>]) {
        let waves = w.chunks_exact(self.rows).zip(load.chunks_exact_mut(self.rows));
        for (blocks, (w, load)) in self.blocks.chunks_exact(self.rows).zip(waves) {
            for (j, Row { diagonal, coupling }) in blocks.iter().enumerate() {
                load[j] -= diagonal * w[j];
                if j + 1 < self.rows {
                    load[j] -= coupling * w[j + 1];
                    load[j + 1] -= coupling.tr_mul(&w[j]);
                }
            }
        }
    }
}

/// The block elimination of an operator.
pub struct Elimination<const D: usize> {
    rows: usize,
    /// Per wave vector, per row.
    pivots: Vec<Pivot<D>>,
}

/// P_j and G_j.
#[derive(Clone, Copy)]
struct Pivot<const D: usize, T = f64> {
    inverse: SMatrix<T, D, D>,
    coupling: SMatrix<T, D, D>,
}

impl<const D: usize> Elimination<D> {
    /// Of a positive definite operator that resists nothing but the strain of its cells, over a clamped base.
    pub fn new(operator: &Operator<D>) -> Result<Self> {
        Self::of(operator, true)
    }

    /// Of one whose rows resist by themselves, too, or whose base is free.
    pub fn of_rows_that_hold(operator: &Operator<D>) -> Result<Self> {
        Self::of(operator, false)
    }

    fn of(operator: &Operator<D>, in_series: bool) -> Result<Self> {
        let rows = operator.rows;
        let mut pivots = Vec::with_capacity(operator.blocks.len());
        for (k, blocks) in operator.blocks.chunks_exact(rows).enumerate() {
            pivots.extend(eliminated(blocks, in_series && operator.uniform && k == 0)?);
        }
        Ok(Self { rows, pivots })
    }

    /// P_0 of each wave vector: the compliance of the face.
    pub fn face(&self) -> impl ExactSizeIterator<Item = SMatrix<f64, D, D>> {
        self.pivots.iter().step_by(self.rows).map(|pivot| pivot.inverse)
    }

    /// From the forces f to s, in place.
    pub fn sweep(&self, load: &mut [Wave<D>]) {
        for (pivots, load) in self.pivots.chunks_exact(self.rows).zip(load.chunks_exact_mut(self.rows)) {
            for j in (1..self.rows).rev() {
                load[j - 1] -= pivots[j - 1].coupling * (pivots[j].inverse * load[j]);
            }
        }
    }

    /// w_0 of each wave vector, from s.
    pub fn at_face(&self, swept: &[Wave<D>]) -> Vec<Wave<D>> {
        self.face().zip(swept.iter().step_by(self.rows)).map(|(inverse, swept)| inverse * swept).collect()
    }

    /// From s to w, in place.
    pub fn complete(&self, swept: &mut [Wave<D>]) {
        swept.iter_mut().step_by(self.rows).zip(self.face()).for_each(|(w, inverse)| *w = inverse * *w);
        self.descend(swept);
    }

    /// w of a layer without load whose face is at w_0.
    pub fn below(&self, face: &[Wave<D>]) -> Vec<Wave<D>> {
        let mut w = vec![Wave::zeros(); self.pivots.len()];
        w.iter_mut().step_by(self.rows).zip(face).for_each(|(w, face)| *w = *face);
        self.descend(&mut w);
        w
    }

    /// From s to w below w_0, in place.
    fn descend(&self, swept: &mut [Wave<D>]) {
        for (pivots, w) in self.pivots.chunks_exact(self.rows).zip(swept.chunks_exact_mut(self.rows)) {
            for j in 1..self.rows {
                w[j] = pivots[j].inverse * (w[j] - pivots[j - 1].coupling.tr_mul(&w[j - 1]));
            }
        }
    }
}

/// P_0 of each wave vector of columns of the given cells, of which nothing else is kept.
pub fn face_compliance<const D: usize>(
    cells: &[Blocks<D>],
    transform: &Transform<D>,
) -> Result<Vec<SMatrix<f64, D, D>>> {
    let of_wave =
        |k: usize| Ok(eliminated(&rows_of(cells, &transform.angles(k)).0, transform.is_uniform(k))?[0].inverse);
    (0..transform.waves()).map(of_wave).collect()
}

/// The rows of a wave vector, eliminated; `in_series` where they are springs in series, as to the uniform wave.
fn eliminated<const D: usize, T: ComplexField + Copy>(rows: &[Row<D, T>], in_series: bool) -> Result<Vec<Pivot<D, T>>> {
    let mut below = SMatrix::zeros();
    let pivot = |(j, row): (usize, &Row<D, T>)| {
        let coupling = row.coupling;
        if !in_series {
            below = inverse(row.diagonal - coupling * below * coupling.transpose())?;
            return Ok(Pivot { inverse: below, coupling });
        }
        below += inverse(-coupling)?;
        let above = if j > 0 { -rows[j - 1].coupling } else { SMatrix::zeros() };
        Ok(Pivot { inverse: below * inverse(SMatrix::identity() + above * below)?, coupling })
    };
    let mut pivots = rows.iter().enumerate().rev().map(pivot).collect::<Result<Vec<_>>>()?;
    pivots.reverse();
    Ok(pivots)
}

fn inverse<const D: usize, T: ComplexField + Copy>(stiffness: SMatrix<T, D, D>) -> Result<SMatrix<T, D, D>> {
    stiffness.try_inverse().ok_or_else(|| Error::Solver("the stiffness of the layer is singular".into()))
}

/// The rows of one wave vector, and the block of the lower side of the last cell; cells that follow their like cost nothing.
fn rows_of<const D: usize>(cells: &[Blocks<D>], angles: &[f64; 2]) -> (Vec<Row<D>>, SMatrix<f64, D, D>) {
    let mut rows: Vec<Row<D>> = Vec::with_capacity(cells.len());
    let mut above = SMatrix::zeros();
    let mut made = [SMatrix::zeros(); 3];
    for (j, cell) in cells.iter().enumerate() {
        if j == 0 || *cell != cells[j - 1] {
            made = cell_blocks(cell, angles);
        }
        let [upper, coupling, lower] = made;
        rows.push(Row { diagonal: above + upper, coupling });
        above = lower;
    }
    (rows, above)
}

/// A cell's stiffness between waves of the node rows above and below it: (upper, upper), (upper, lower), (lower, lower). Of two
/// corners one ahead of the other along an axis, that leads by the axis' angle.
fn cell_blocks<const D: usize>(cell: &Blocks<D>, angles: &[f64; 2]) -> [SMatrix<f64, D, D>; 3] {
    let lead = |[x, y]: [u8; 2]| Complex::from_polar(1.0, f64::from(x) * angles[0] + f64::from(y) * angles[1]);
    // The corners of the lower and of the upper side, in the same order; see crate::element::Multilinear.
    let (lower, upper, places): (&[usize], &[usize], &[[u8; 2]]) = match cell.len() {
        16 => (&[0, 1], &[3, 2], &[[0, 0], [1, 0]]),
        _ => (&[0, 1, 2, 3], &[4, 5, 6, 7], &[[0, 0], [1, 0], [1, 1], [0, 1]]),
    };
    let phase: Vec<Complex<f64>> = places.iter().map(|place| lead(*place)).collect();
    let corners = 2 * phase.len();
    let between = |rows: &[usize], columns: &[usize]| {
        let [mut real, mut imaginary] = [SMatrix::<f64, D, D>::zeros(); 2];
        for (row, from) in rows.iter().zip(&phase) {
            for (column, to) in columns.iter().zip(&phase) {
                let (block, turn) = (&cell[row * corners + column], from.conj() * to);
                real += block * turn.re;
                imaginary += block * turn.im;
            }
        }
        // With u = i v along the face and forces alike; what is left out is zero by the mirror symmetries.
        SMatrix::from_fn(|i, j| match (i + 1 == D, j + 1 == D) {
            (false, true) => imaginary[(i, j)],
            (true, false) => -imaginary[(i, j)],
            _ => real[(i, j)],
        })
    };
    [between(upper, upper), between(upper, lower), between(lower, lower)]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::element::Multilinear;
    use crate::element::solid::{Dilatation, Placed};
    use crate::mesh::{Layer, Sides, Span};
    use nalgebra::{DMatrix, DVector, SVector};

    /// Three cells of growing height and other bulk moduli below a face of these counts, as blocks of one column and as one dense
    /// matrix: unknown D (3 n + j) + i of column n, row j and component i.
    fn layer<const D: usize>(counts: &[usize]) -> (Vec<Blocks<D>>, DMatrix<f64>) {
        let spans = counts.iter().map(|&cells| Span { width: 0.4 * cells as f64, cells, sides: Sides::Periodic });
        let mesh = Layer { spans: spans.collect(), depth: 1.2, rows: 3, grading: 3.5, strata: vec![] }.mesh::<D>();
        let stiffness = |cell: usize| {
            let corners = mesh.places(&mesh.cells[cell]);
            let placed = Placed { shape: &Multilinear, corners: &corners, dilatation: Dilatation::Pointwise };
            placed.stiffness().with(1.0, [1.5, 0.2, 9.0][cell % 3])
        };
        let columns: usize = counts.iter().product();
        let mut dense = DMatrix::zeros(3 * D * columns, 3 * D * columns);
        // Nodes run column by column with the clamped one last in each.
        let row = |unknown: u32| (unknown % 4 < 3).then_some(D * (unknown / 4 * 3 + unknown % 4) as usize);
        for cell in 0..mesh.cells.len() {
            let (unknowns, blocks) = (mesh.cell_unknowns(cell), stiffness(cell));
            let corners = unknowns.corners();
            for (a, b) in (0..corners.len()).flat_map(|a| (0..corners.len()).map(move |b| (a, b))) {
                if let (Some(to), Some(from)) = (row(corners[a]), row(corners[b])) {
                    let mut block = dense.fixed_view_mut::<D, D>(to, from);
                    block += blocks[a * corners.len() + b];
                }
            }
        }
        ((0..3).map(stiffness).collect(), dense)
    }

    /// Row by row into waves, and back.
    fn into_waves<const D: usize>(transform: &Transform<D>, values: &DVector<f64>) -> Vec<Wave<D>> {
        let columns = values.len() / (3 * D);
        let row = |j: usize| -> Vec<f64> { (0..D * columns).map(|i| values[D * (3 * (i / D) + j) + i % D]).collect() };
        let rows: Vec<Vec<Wave<D>>> = (0..3).map(|j| transform.forward(&row(j)).unwrap()).collect();
        (0..transform.waves()).flat_map(|k| rows.iter().map(move |row| row[k])).collect()
    }

    fn out_of_waves<const D: usize>(transform: &Transform<D>, waves: &[Wave<D>]) -> DVector<f64> {
        let rows: Vec<Vec<f64>> = (0..3).map(|j| transform.inverse(|k| &waves[3 * k + j]).unwrap()).collect();
        DVector::from_fn(3 * rows[0].len(), |i, _| rows[i / D % 3][D * (i / (3 * D)) + i % D])
    }

    /// Product, solution and compliance are those of the assembled layer, to round-off.
    fn waves_are_the_assembled_layer<const D: usize>(counts: &[usize]) {
        let (cells, dense) = layer::<D>(counts);
        let transform = Transform::<D>::new(counts);
        let operator = Operator::new(&cells, &transform);
        let force = DVector::from_fn(dense.nrows(), |i, _| ((7 * i + 3) % 11) as f64 - 4.0);
        let mut product = vec![Wave::zeros(); 3 * transform.waves()];
        operator.subtract_product(&into_waves(&transform, &force), &mut product);
        let expected = -(&dense * &force);
        assert!((out_of_waves(&transform, &product) - &expected).norm() < 1e-13 * expected.norm());

        let elimination = Elimination::new(&operator).unwrap();
        let mut load = into_waves(&transform, &force);
        elimination.sweep(&mut load);
        let face = {
            let at_face = elimination.at_face(&load);
            transform.inverse(|k| &at_face[k]).unwrap()
        };
        elimination.complete(&mut load);
        let solution = out_of_waves(&transform, &load);
        let expected = dense.lu().solve(&force).unwrap();
        assert!((&solution - &expected).norm() < 1e-13 * expected.norm());
        let expected: Vec<f64> = (0..face.len()).map(|i| expected[3 * D * (i / D) + i % D]).collect();
        assert!(face.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-13 * solution.norm()));
        let alone = face_compliance(&cells, &transform).unwrap();
        assert!(alone.iter().zip(elimination.face()).all(|(a, b)| *a == b));
    }

    /// To the uniform wave rows of cells are springs in series, of h/G along the face and h/(K + 4/3 G) across it, to the last digits
    /// however far apart their moduli are (as assembled, a stratum of 1e-8 under one of 1e8 has none).
    #[test]
    fn the_uniform_wave_has_all_digits_of_stiff_on_soft() {
        const MODULI: [[f64; 2]; 3] = [[1e8, 5e11], [1e-8, 1e-7], [3.0, 2.0]];
        let spans = vec![Span { width: 2.0, cells: 4, sides: Sides::Periodic }];
        let mesh = Layer { spans, depth: 1.2, rows: 3, grading: 3.5, strata: vec![] }.mesh::<2>();
        let corners: Vec<_> = (0..3).map(|cell| mesh.places(&mesh.cells[cell])).collect();
        let cell = |(corners, [shear, bulk]): (&Vec<_>, [f64; 2])| {
            let placed = Placed { shape: &Multilinear, corners, dilatation: Dilatation::Pointwise };
            placed.stiffness().with(shear, bulk)
        };
        let cells: Vec<Blocks<2>> = corners.iter().zip(MODULI).map(cell).collect();
        let height = |corners: &Vec<SVector<f64, 2>>| corners[2][1] - corners[1][1];
        let series = |modulus: fn([f64; 2]) -> f64| -> f64 {
            // The weight of a column is the width of its cells.
            corners.iter().zip(MODULI).map(|(corners, moduli)| height(corners) / (0.5 * modulus(moduli))).sum()
        };
        let transform = Transform::<2>::new(&[4]);
        let found = face_compliance(&cells, &transform).unwrap()[0];
        for (found, exact) in [
            (found[(0, 0)], series(|[shear, _]| shear)),
            (found[(1, 1)], series(|[shear, bulk]| bulk + 4.0 / 3.0 * shear)),
        ] {
            assert!((found / exact - 1.0).abs() < 1e-14, "{found:e} {exact:e}");
        }
        assert!(found[(0, 1)].abs() < 1e-14 * found[(0, 0)].abs());
    }

    #[test]
    fn waves_are_the_assembled_layer_in_the_plane() {
        waves_are_the_assembled_layer::<2>(&[5]);
        waves_are_the_assembled_layer::<2>(&[6]);
    }

    #[test]
    fn waves_are_the_assembled_layer_in_space() {
        for counts in [[3, 4], [4, 3], [5, 5], [2, 4]] {
            waves_are_the_assembled_layer::<3>(&counts);
        }
    }
}
