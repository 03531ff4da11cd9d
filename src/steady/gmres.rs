//! GMRES, preconditioned from the right (Saad and Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856), for systems so small that
//! distributed vectors would cost more than they do.

use nalgebra::DVector;

use crate::error::Result;

/// A linear operator.
pub type Linear<'a> = &'a dyn Fn(&DVector<f64>) -> Result<DVector<f64>>;

/// Products at most; what is left then is left to whoever asks again.
const MOST: usize = 100;

/// x with |b - A x| <= tolerance |b|, or as near as [`MOST`] products come; `inverse` is nearly that of A.
pub fn solve((a, inverse): (Linear<'_>, Linear<'_>), b: &DVector<f64>, tolerance: f64) -> Result<DVector<f64>> {
    let size = b.norm();
    if size == 0.0 {
        return Ok(b.clone());
    }
    let mut basis = vec![b / size];
    // The columns of the Hessenberg matrix as Givens rotations leave them, the rotations, and what they make of |b| e_1.
    let (mut columns, mut rotations, mut right): (Vec<Vec<f64>>, Vec<(f64, f64)>, _) = (vec![], vec![], vec![size]);
    for j in 0..MOST.min(b.len()) {
        let mut next = a(&inverse(&basis[j])?)?;
        let mut column = Vec::with_capacity(j + 2);
        for v in &basis {
            let along = v.dot(&next);
            next.axpy(-along, v, 1.0);
            column.push(along);
        }
        let length = next.norm();
        for (i, &(c, s)) in rotations.iter().enumerate() {
            (column[i], column[i + 1]) = (c * column[i] + s * column[i + 1], c * column[i + 1] - s * column[i]);
        }
        let whole = column[j].hypot(length);
        if whole == 0.0 {
            break;
        }
        let (c, s) = (column[j] / whole, length / whole);
        column[j] = whole;
        right.push(-s * right[j]);
        right[j] *= c;
        rotations.push((c, s));
        columns.push(column);
        if right[j + 1].abs() <= tolerance * size || length == 0.0 {
            break;
        }
        basis.push(next / length);
    }
    let mut x = DVector::zeros(b.len());
    for j in (0..columns.len()).rev() {
        let factor = right[j] / columns[j][j];
        (0..j).for_each(|i| right[i] -= factor * columns[j][i]);
        x.axpy(factor, &basis[j], 1.0);
    }
    inverse(&x)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// A matrix that is not symmetric, of order 30, against LU; a poor preconditioner changes the way, not the answer.
    #[test]
    fn the_solution_is_that_of_lu() {
        let n = 30;
        let a = DMatrix::from_fn(n, n, |i, j| if i == j { 4.0 } else { 1.0 / (1.0 + 2.0 * i as f64 + j as f64) });
        let b = DVector::from_fn(n, |i, _| (i as f64).sin());
        let exact = a.clone().lu().solve(&b).unwrap();
        let scaled = |v: &DVector<f64>| Ok(DVector::from_fn(n, |i, _| v[i] / (1.0 + i as f64 / 10.0)));
        let found = solve((&|v| Ok(&a * v), &scaled), &b, 1e-13).unwrap();
        assert!((found - &exact).norm() < 1e-12 * exact.norm());
        assert_eq!(solve((&|v| Ok(&a * v), &scaled), &DVector::zeros(n), 1e-13).unwrap(), DVector::zeros(n));
    }
}
