//! A periodic layer wavenumber by wavenumber.
//!
//! The columns of a periodic layer are alike, so that a Fourier transform along x parts its stiffness into one matrix
//! per wavenumber, block-tridiagonal through the depth. Cells are their own mirror images, which makes the 2 x 2 blocks
//! real once the transform of u_x is written as i v_x:
//!
//! ```text
//! u_n = 1/columns sum_k (i v_x, u_z)(k) e^(2 pi i k n / columns),     w = (v_x, u_z)
//! G'_{j-1} w_{j-1} + D_j w_j + G_j w_{j+1} = f_j        rows j from the face down; w = 0 at the clamped one
//! ```
//!
//! Block elimination from the clamped row upward leaves the face, whose compliance is P_0:
//!
//! ```text
//! P_j = (D_j - G_j P_{j+1} G_j')^-1,     s_j = f_j - G_j P_{j+1} s_{j+1}
//! w_0 = P_0 s_0,     w_{j+1} = P_{j+1} (s_{j+1} - G_j' w_j)
//! ```

use std::f64::consts::PI;
use std::sync::Arc;

use nalgebra::{Complex, Matrix2};
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

use crate::element::quad4::Stiffness;
use crate::error::{Error, Result};

/// w of a row of nodes at one wavenumber: (v_x, u_z) by (real, imaginary) part. Fields of a layer hold, for each
/// wavenumber from 0 to columns / 2, one of them per row from the face down.
pub type Wave = Matrix2<f64>;

/// The stiffness of a layer, or a part of it.
pub struct Operator {
    rows: usize,
    /// Per wavenumber, per row.
    blocks: Vec<Row>,
}

/// D_j and G_j.
#[derive(Clone, Copy)]
struct Row {
    diagonal: Matrix2<f64>,
    coupling: Matrix2<f64>,
}

impl Operator {
    /// Of `columns` columns of the given cells, from the face down; the lower side of the last one is clamped.
    pub fn new(cells: &[Stiffness], columns: usize) -> Self {
        let mut blocks = Vec::with_capacity((columns / 2 + 1) * cells.len());
        for k in 0..=columns / 2 {
            let angle = 2.0 * PI * k as f64 / columns as f64;
            let mut above = Matrix2::zeros();
            for cell in cells {
                let [upper, coupling, lower] = cell_blocks(cell, angle);
                blocks.push(Row { diagonal: above + upper, coupling });
                above = lower;
            }
        }
        Self { rows: cells.len(), blocks }
    }

    /// sum_p factor_p part_p, of parts of one layer.
    pub fn sum(parts: &[Self], factors: &[f64]) -> Self {
        let mut blocks = vec![Row { diagonal: Matrix2::zeros(), coupling: Matrix2::zeros() }; parts[0].blocks.len()];
        for (part, &factor) in parts.iter().zip(factors) {
            for (sum, row) in blocks.iter_mut().zip(&part.blocks) {
                sum.diagonal += row.diagonal * factor;
                sum.coupling += row.coupling * factor;
            }
        }
        Self { rows: parts[0].rows, blocks }
    }

    /// load -= K w
    pub fn subtract_product(&self, w: &[Wave], load: &mut [Wave]) {
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
pub struct Elimination {
    rows: usize,
    /// Per wavenumber, per row.
    pivots: Vec<Pivot>,
}

/// P_j and G_j.
#[derive(Clone, Copy)]
struct Pivot {
    inverse: Matrix2<f64>,
    coupling: Matrix2<f64>,
}

impl Elimination {
    /// Of a positive definite operator.
    pub fn new(operator: &Operator) -> Result<Self> {
        let rows = operator.rows;
        let mut pivots = Vec::with_capacity(operator.blocks.len());
        for blocks in operator.blocks.chunks_exact(rows) {
            let first = pivots.len();
            let mut below = Matrix2::zeros();
            for &Row { diagonal, coupling } in blocks.iter().rev() {
                let inverse = (diagonal - coupling * below * coupling.transpose())
                    .try_inverse()
                    .ok_or_else(|| Error::Solver("the stiffness of the layer is singular".into()))?;
                pivots.push(Pivot { inverse, coupling });
                below = inverse;
            }
            pivots[first..].reverse();
        }
        Ok(Self { rows, pivots })
    }

    /// P_0 of each wavenumber: the compliance of the face.
    pub fn face(&self) -> impl Iterator<Item = Matrix2<f64>> {
        self.pivots.iter().step_by(self.rows).map(|pivot| pivot.inverse)
    }

    /// From the forces f to s, in place.
    pub fn sweep(&self, load: &mut [Wave]) {
        for (pivots, load) in self.pivots.chunks_exact(self.rows).zip(load.chunks_exact_mut(self.rows)) {
            for j in (1..self.rows).rev() {
                load[j - 1] -= pivots[j - 1].coupling * (pivots[j].inverse * load[j]);
            }
        }
    }

    /// w_0 of each wavenumber, from s.
    pub fn at_face(&self, swept: &[Wave]) -> Vec<Wave> {
        self.face().zip(swept.iter().step_by(self.rows)).map(|(inverse, swept)| inverse * swept).collect()
    }

    /// From s to w, in place.
    pub fn complete(&self, swept: &mut [Wave]) {
        swept.iter_mut().step_by(self.rows).zip(self.face()).for_each(|(w, inverse)| *w = inverse * *w);
        self.descend(swept);
    }

    /// w of a layer without load whose face is at w_0.
    pub fn below(&self, face: &[Wave]) -> Vec<Wave> {
        let mut w = vec![Wave::zeros(); self.pivots.len()];
        w.iter_mut().step_by(self.rows).zip(face).for_each(|(w, face)| *w = *face);
        self.descend(&mut w);
        w
    }

    /// From s to w below w_0, in place.
    fn descend(&self, swept: &mut [Wave]) {
        for (pivots, w) in self.pivots.chunks_exact(self.rows).zip(swept.chunks_exact_mut(self.rows)) {
            for j in 1..self.rows {
                w[j] = pivots[j].inverse * (w[j] - pivots[j - 1].coupling.tr_mul(&w[j - 1]));
            }
        }
    }
}

/// A cell's stiffness between waves of the node rows above and below it: (upper, upper), (upper, lower),
/// (lower, lower). Corners: lower left, lower right, upper right, upper left; the right ones lead by `angle`.
fn cell_blocks(cell: &Stiffness, angle: f64) -> [Matrix2<f64>; 3] {
    let lead = Complex::from_polar(1.0, angle);
    let phase = [Complex::from(1.0), lead, lead, Complex::from(1.0)];
    let (upper, lower) = ([2, 3], [0, 1]);
    let between = |rows: [usize; 2], columns: [usize; 2]| {
        let mut block = Matrix2::<Complex<f64>>::zeros();
        for row in rows {
            for column in columns {
                let real = cell.fixed_view::<2, 2>(2 * row, 2 * column).map(Complex::from);
                block += real * (phase[row].conj() * phase[column]);
            }
        }
        // With u_x = i v_x and f_x alike; what is left out is zero by the mirror symmetry.
        Matrix2::new(block[(0, 0)].re, block[(0, 1)].im, -block[(1, 0)].im, block[(1, 1)].re)
    };
    [between(upper, upper), between(upper, lower), between(lower, lower)]
}

/// The Fourier transform of a row of nodes.
#[derive(Clone)]
pub struct Transform {
    columns: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

impl Transform {
    /// For rows of `columns` nodes.
    pub fn new(columns: usize) -> Self {
        let mut planner = RealFftPlanner::new();
        Self { columns, forward: planner.plan_fft_forward(columns), inverse: planner.plan_fft_inverse(columns) }
    }

    /// How many wavenumbers there are.
    pub fn waves(&self) -> usize {
        self.columns / 2 + 1
    }

    /// The waves of x, z of each node.
    pub fn forward(&self, values: &[f64]) -> Result<Vec<Wave>> {
        let mut waves = vec![Wave::zeros(); self.waves()];
        let (mut row, mut spectrum) = (self.forward.make_input_vec(), self.forward.make_output_vec());
        for component in 0..2 {
            row.iter_mut().zip(values.iter().skip(component).step_by(2)).for_each(|(row, value)| *row = *value);
            self.forward.process(&mut row, &mut spectrum).map_err(transform_failed)?;
            for (wave, c) in waves.iter_mut().zip(&spectrum) {
                // v_x = -i u_x
                let part = if component == 0 { [c.im, -c.re] } else { [c.re, c.im] };
                (wave[(component, 0)], wave[(component, 1)]) = (part[0], part[1]);
            }
        }
        Ok(waves)
    }

    /// x, z of each node.
    pub fn inverse<'a>(&self, waves: impl Iterator<Item = &'a Wave> + Clone) -> Result<Vec<f64>> {
        let mut values = vec![0.0; 2 * self.columns];
        let (mut row, mut spectrum) = (self.inverse.make_output_vec(), self.inverse.make_input_vec());
        for component in 0..2 {
            for ((k, c), wave) in spectrum.iter_mut().enumerate().zip(waves.clone()) {
                let (re, im) = (wave[(component, 0)], wave[(component, 1)]);
                *c = if component == 0 { Complex::new(-im, re) } else { Complex::new(re, im) };
                if k == 0 || 2 * k == self.columns {
                    // Real but for round-off.
                    c.im = 0.0;
                }
            }
            self.inverse.process(&mut spectrum, &mut row).map_err(transform_failed)?;
            for (value, row) in values.iter_mut().skip(component).step_by(2).zip(&row) {
                *value = row / self.columns as f64;
            }
        }
        Ok(values)
    }
}

fn transform_failed(error: realfft::FftError) -> Error {
    Error::Internal(format!("Fourier transform: {error}"))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::element::quad4;
    use nalgebra::{DMatrix, DVector, Vector2};

    /// Five columns of three cells of growing height and other moduli, as one dense matrix: unknown 2 (3 n + j) of
    /// column n and row j.
    fn layer() -> (Vec<Stiffness>, DMatrix<f64>) {
        let cell = |height: f64, bulk: f64| {
            let corners = [[0.0, 0.0], [0.4, 0.0], [0.4, height], [0.0, height]].map(|[x, z]| Vector2::new(x, z));
            let split = quad4::stiffness(&corners);
            split.deviatoric + split.volumetric * bulk
        };
        let cells = vec![cell(0.2, 1.5), cell(0.3, 0.2), cell(0.7, 9.0)];
        let mut dense = DMatrix::zeros(30, 30);
        for n in 0..5 {
            for (j, cell) in cells.iter().enumerate() {
                let right = (n + 1) % 5;
                let corners = [(n, j + 1), (right, j + 1), (right, j), (n, j)];
                for (a, &(column_a, row_a)) in corners.iter().enumerate() {
                    for (b, &(column_b, row_b)) in corners.iter().enumerate() {
                        if row_a < 3 && row_b < 3 {
                            let (to, from) = (2 * (3 * column_a + row_a), 2 * (3 * column_b + row_b));
                            let mut block = dense.fixed_view_mut::<2, 2>(to, from);
                            block += cell.fixed_view::<2, 2>(2 * a, 2 * b);
                        }
                    }
                }
            }
        }
        (cells, dense)
    }

    /// Row by row into waves, and back.
    fn into_waves(transform: &Transform, values: &DVector<f64>) -> Vec<Wave> {
        let rows: Vec<Vec<Wave>> = (0..3)
            .map(|j| {
                let row: Vec<f64> = (0..10).map(|i| values[2 * (3 * (i / 2) + j) + i % 2]).collect();
                transform.forward(&row).unwrap()
            })
            .collect();
        (0..3).flat_map(|k| rows.iter().map(move |row| row[k])).collect()
    }

    fn out_of_waves(transform: &Transform, waves: &[Wave]) -> DVector<f64> {
        let rows: Vec<Vec<f64>> = (0..3).map(|j| transform.inverse(waves.iter().skip(j).step_by(3)).unwrap()).collect();
        DVector::from_fn(30, |i, _| rows[i / 2 % 3][2 * (i / 6) + i % 2])
    }

    /// Product and solution are those of the assembled matrix, to round-off.
    #[test]
    fn waves_are_the_assembled_layer() {
        let (cells, dense) = layer();
        let (operator, transform) = (Operator::new(&cells, 5), Transform::new(5));
        let force = DVector::from_fn(30, |i, _| ((7 * i + 3) % 11) as f64 - 4.0);
        let mut product = vec![Wave::zeros(); 9];
        operator.subtract_product(&into_waves(&transform, &force), &mut product);
        let expected = -(&dense * &force);
        assert!((out_of_waves(&transform, &product) - &expected).norm() < 1e-13 * expected.norm());

        let elimination = Elimination::new(&operator).unwrap();
        let mut load = into_waves(&transform, &force);
        elimination.sweep(&mut load);
        let face = transform.inverse(elimination.at_face(&load).iter()).unwrap();
        elimination.complete(&mut load);
        let solution = out_of_waves(&transform, &load);
        let expected = dense.lu().solve(&force).unwrap();
        assert!((&solution - &expected).norm() < 1e-13 * expected.norm());
        let expected: Vec<f64> = (0..10).map(|i| expected[6 * (i / 2) + i % 2]).collect();
        assert!(face.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-13 * solution.norm()));
    }
}
