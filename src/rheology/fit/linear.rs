//! The linear half of the identification: the moduli of arms whose times are given, none negative.
//!
//! Lawson and Hanson, Solving Least Squares Problems (1974), algorithm NNLS: min |A x - b| with x >= 0.

use nalgebra::{DMatrix, DVector};

use super::{Residuals, Samples};

/// The moduli of the spring (first) and of the arms with the given times that come closest to the data, all >= 0.
/// Residuals relative to the data stand in for the logarithmic ones, which are not linear.
pub(super) fn moduli(samples: &Samples, residuals: Residuals, times: &[f64]) -> Vec<f64> {
    let columns = std::iter::once(samples.spring()).chain(times.iter().map(|&time| samples.arm(time)));
    let weight: Vec<f64> = match residuals {
        Residuals::Linear => vec![1.0; samples.values.len()],
        Residuals::Relative => samples.values.iter().map(|value| 1.0 / value).collect(),
    };
    let weighted =
        |values: &[f64]| DVector::from_iterator(weight.len(), values.iter().zip(&weight).map(|(v, w)| v * w));
    let matrix = DMatrix::from_columns(&columns.map(|column| weighted(&column)).collect::<Vec<_>>());
    let (matrix, right) = compressed(matrix, weighted(&samples.values));
    non_negative(&matrix, &right).as_slice().to_vec()
}

/// The same least-squares problem with as few rows as columns: R x = Q' b. Long data files stay cheap.
fn compressed(matrix: DMatrix<f64>, mut right: DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
    if matrix.nrows() <= matrix.ncols() {
        return (matrix, right);
    }
    let columns = matrix.ncols();
    let qr = matrix.qr();
    qr.q_tr_mul(&mut right);
    (qr.r(), right.rows(0, columns).into_owned())
}

/// min |A x - b| with x >= 0.
fn non_negative(matrix: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let n = matrix.ncols();
    let mut x = DVector::zeros(n);
    let mut free: Vec<usize> = Vec::new();
    // A gradient below round-off is no reason to free another unknown.
    let noise = 1e-14 * right.norm() * matrix.column_iter().map(|column| column.norm()).fold(0.0, f64::max);
    // Lawson and Hanson's loop ends by itself in exact arithmetic; round-off may make it turn in circles.
    for _ in 0..3 * n {
        let gradient = matrix.tr_mul(&(right - matrix * &x));
        let held = (0..n).filter(|i| !free.contains(i) && gradient[*i] > noise);
        let Some(next) = held.max_by(|&i, &j| gradient[i].total_cmp(&gradient[j])) else { break };
        free.push(next);
        for _ in 0..=free.len() {
            let trial = solve(matrix, right, &free);
            // The longest step towards the trial point that keeps every unknown >= 0.
            let step = free
                .iter()
                .zip(trial.iter())
                .filter(|(_, value)| **value <= 0.0)
                .map(|(&i, value)| x[i] / (x[i] - value))
                .fold(1.0, f64::min);
            for (&i, value) in free.iter().zip(trial.iter()) {
                x[i] += step * (value - x[i]);
            }
            if step >= 1.0 {
                break;
            }
            let largest = x.amax();
            free.retain(|&i| {
                let keep = x[i] > 1e-14 * largest;
                if !keep {
                    x[i] = 0.0;
                }
                keep
            });
        }
        if !free.contains(&next) {
            break;
        }
    }
    x
}

/// The unconstrained least-squares solution over the columns `free`.
fn solve(matrix: &DMatrix<f64>, right: &DVector<f64>, free: &[usize]) -> DVector<f64> {
    let svd = matrix.select_columns(free).svd(true, true);
    let cut = svd.singular_values.amax() * f64::EPSILON * matrix.nrows().max(1) as f64;
    svd.solve(right, cut).unwrap_or_else(|_| DVector::zeros(free.len()))
}
