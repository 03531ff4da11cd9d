//! GMRES with a preconditioner that may change (Saad, SIAM J. Sci. Comput. 14 (1993) 461), without restarts: its vectors are those of
//! the points in contact, which are few.

use crate::error::Result;
use crate::parallel::Team;

/// Iterations at most.
const MOST: usize = 200;

/// A linear system on the ranks of a team. The last `common` entries of a vector are the same on each of them.
pub struct System<'a> {
    /// The ranks.
    pub team: &'a Team,
    /// Unknowns that all ranks have.
    pub common: usize,
    /// w = A w
    pub product: &'a mut dyn FnMut(&mut [f64]) -> Result<()>,
    /// w = M^-1 w
    pub precondition: &'a mut dyn FnMut(&mut [f64]) -> Result<()>,
}

impl System<'_> {
    /// Of a vector with others.
    fn dots(&self, others: &[Vec<f64>], w: &[f64]) -> Vec<f64> {
        let own = w.len() - if self.team.is_first() { 0 } else { self.common };
        self.team.sum_all(others.iter().map(|other| dot(&other[..own], &w[..own])).collect())
    }

    /// What of w is along vectors of length 1 that are across each other, which is taken off it.
    fn freed_of(&self, basis: &[Vec<f64>], w: &mut [f64]) -> Vec<f64> {
        let along = self.dots(basis, w);
        basis.iter().zip(&along).for_each(|(v, h)| add(w, -h, v));
        along
    }

    fn norm(&self, w: &[f64]) -> f64 {
        let own = w.len() - if self.team.is_first() { 0 } else { self.common };
        let [square] = self.team.sum([dot(&w[..own], &w[..own])]);
        square.sqrt()
    }

    /// x with |b - A x| no more than the `reduction` times |b|, or the nearest that was found, and what of |b| that leaves. Collective.
    pub fn solve(&mut self, b: &[f64], reduction: f64) -> Result<(Vec<f64>, f64)> {
        let size = self.norm(b);
        let mut x = vec![0.0; b.len()];
        if size == 0.0 {
            return Ok((x, 0.0));
        }
        let (mut basis, mut tried) = (vec![scaled(b, 1.0 / size)], Vec::new());
        // The columns of R, the rotations that make it of H, and what they make of |b| e_1.
        let (mut columns, mut turns, mut right): (Vec<Vec<f64>>, Vec<[f64; 2]>, _) =
            (Vec::new(), Vec::new(), vec![size]);
        while columns.len() < MOST && right[columns.len()].abs() > reduction * size {
            let mut w = basis[columns.len()].clone();
            (self.precondition)(&mut w)?;
            tried.push(w.clone());
            (self.product)(&mut w)?;
            // Twice: of the first what round-off leaves along them.
            let mut column = self.freed_of(&basis, &mut w);
            let rest = self.freed_of(&basis, &mut w);
            column.iter_mut().zip(rest).for_each(|(h, rest)| *h += rest);
            let beyond = self.norm(&w);
            if !beyond.is_finite() {
                break;
            }
            for (i, [c, s]) in turns.iter().enumerate() {
                let (a, b) = (column[i], column.get(i + 1).copied().unwrap_or(0.0));
                (column[i], column[i + 1]) = (c * a + s * b, c * b - s * a);
            }
            let last = columns.len();
            let length = column[last].hypot(beyond);
            if length == 0.0 {
                break;
            }
            let turn = [column[last] / length, beyond / length];
            column[last] = length;
            let rest = right[last];
            right[last] = turn[0] * rest;
            right.push(-turn[1] * rest);
            columns.push(column);
            turns.push(turn);
            if beyond > 0.0 {
                basis.push(scaled(&w, 1.0 / beyond));
            }
        }
        let left = right[columns.len()].abs() / size;
        for i in (0..columns.len()).rev() {
            let y = right[i] / columns[i][i];
            right.iter_mut().zip(&columns[i]).take(i).for_each(|(right, r)| *right -= r * y);
            add(&mut x, y, &tried[i]);
        }
        Ok((x, left))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(to: &mut [f64], factor: f64, by: &[f64]) {
    to.iter_mut().zip(by).for_each(|(to, by)| *to += factor * by);
}

fn scaled(v: &[f64], factor: f64) -> Vec<f64> {
    v.iter().map(|v| v * factor).collect()
}
