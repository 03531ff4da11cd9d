//! Newton's method on tractions that sweeps have brought near.

use nalgebra::{Matrix2, Vector2};

use super::{LARGE_FACE, SETTLED, Station, Tractions};
use crate::error::Result;
use crate::petsc::DenseLu;

const MOST_ITERATIONS: usize = 10;

impl Tractions<'_> {
    /// What each traction is more than the laws answer to all the others, and the sum of squares.
    fn excess(&self) -> (Vec<Vector2<f64>>, f64) {
        let of =
            |(i, station): (usize, &Station)| self.values[i] - station.tractions(&self.local(i), self.law.as_ref());
        let excess: Vec<_> = self.stations.iter().enumerate().map(of).collect();
        let sum = excess.iter().map(Vector2::norm_squared).sum();
        (excess, sum)
    }

    /// Newton's method on the tractions, each less what the laws answer to all the others, as long as it brings them
    /// closer. However stiff the laws, these answers have slopes of order 1.
    pub(super) fn refine(&mut self) -> Result<()> {
        let (mut excess, mut sum) = self.excess();
        for _ in 0..MOST_ITERATIONS {
            let size: f64 = self.values.iter().map(Vector2::norm_squared).sum();
            if sum <= SETTLED * size {
                break;
            }
            let Some(step) = self.newton_step(&excess)? else { break };
            let before = (self.values.clone(), sum);
            for length in [1.0, 0.5, 0.25, 0.125] {
                self.set(before.0.iter().zip(&step).map(|(t, d)| t - d * length).collect());
                (excess, sum) = self.excess();
                if sum < before.1 {
                    break;
                }
            }
            // Not even by a number that is none.
            if sum >= before.1 || sum.is_nan() {
                self.set(before.0);
                break;
            }
        }
        Ok(())
    }

    /// What to take off the tractions so that, to first order, nothing is left of `excess`.
    fn newton_step(&self, excess: &[Vector2<f64>]) -> Result<Option<Vec<Vector2<f64>>>> {
        let acts = |&i: &usize| self.values[i] != Vector2::zeros() || excess[i] != Vector2::zeros();
        let active: Vec<usize> = (0..self.stations.len()).filter(acts).collect();
        let order = 2 * active.len();
        if order > LARGE_FACE {
            return Ok(None);
        }
        let slopes: Vec<_> = active
            .iter()
            .map(|&i| self.stations[i].slope(&self.local(i), self.values[i] - excess[i], self.law.as_ref()))
            .collect();
        let mut matrix = vec![0.0; order * order];
        for (column, &j) in active.iter().enumerate() {
            for (row, &i) in active.iter().enumerate() {
                let block = match row == column {
                    true => Matrix2::identity(),
                    false => {
                        let influence = self.stations[i].influence(&self.stations[j], self.behind);
                        -slopes[row] * influence * Matrix2::new(1.0, 0.0, 0.0, -1.0)
                    }
                };
                for (k, l) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    matrix[(2 * column + l) * order + 2 * row + k] = block[(k, l)];
                }
            }
        }
        let Ok(factor) = DenseLu::new(order, matrix) else { return Ok(None) };
        let right: Vec<f64> = active.iter().flat_map(|&i| [excess[i].x, excess[i].y]).collect();
        let mut solution = vec![0.0; order];
        factor.solve(&right, &mut solution)?;
        let mut step = vec![Vector2::zeros(); self.stations.len()];
        for (&i, &[q, p]) in active.iter().zip(solution.as_chunks().0) {
            step[i] = Vector2::new(q, p);
        }
        Ok(Some(step))
    }
}
