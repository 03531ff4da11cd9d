//! Newton's linear system on the points in contact, by LU.
//!
//! For y = r - n dp of each point, with A = 1 - f' e n' (what friction adds to it), R and S the rows of [`Linearised::rows`]:
//!
//! ```text
//! S_i y_i + R_i sum_j C_ij w_j A_j y_j = b_i      (b with the rows combined)
//! ```
//!
//! A point that slides has r = b_t, and only its pressure is unknown.

use nalgebra::{SMatrix, SVector};

use super::linear::Linearised;
use crate::error::Result;
use crate::petsc::DenseLu;

/// The compliance between points, (j, rows): the motion at each of `rows` under a unit traction at j, m/Pa.
pub type Influence<'a, const D: usize> = dyn Fn(usize, &[usize]) -> Vec<SMatrix<f64, D, D>> + 'a;

/// A factor, with what it was made of.
pub struct Factor<const D: usize> {
    points: Vec<Linearised<D>>,
    unknowns: Vec<Unknown<D>>,
    lu: DenseLu,
}

/// A component of y.
#[derive(Debug, Clone, Copy)]
struct Unknown<const D: usize> {
    point: usize,
    /// Along which y is unknown; its row of the equations too.
    along: SVector<f64, D>,
}

impl<const D: usize> Factor<D> {
    /// Factorises.
    ///
    /// # Errors
    /// Where the system is singular.
    pub fn new(points: Vec<Linearised<D>>, influence: &Influence<'_, D>) -> Result<Self> {
        let unknowns = unknowns(&points);
        let order = unknowns.len();
        let mut matrix = vec![0.0; order * order];
        let rows: Vec<_> = points.iter().map(Linearised::rows).collect();
        let of_points: Vec<&[Unknown<D>]> = unknowns.chunk_by(|a, b| a.point == b.point).collect();
        let in_rows: Vec<usize> = of_points.iter().map(|chunk| chunk[0].point).collect();
        let mut at_column = 0;
        // Unknowns of one point stand together.
        for column in &of_points {
            let j = column[0].point;
            let influences = influence(j, &in_rows);
            let dragging = points[j].dragging();
            let mut at_row = 0;
            for (row, influence) in of_points.iter().zip(influences) {
                let i = row[0].point;
                let [moved, own] = rows[i];
                let mut block = moved * influence * dragging;
                if i == j {
                    block += own;
                }
                for (l, to) in column.iter().enumerate() {
                    let target = &mut matrix[(at_column + l) * order + at_row..][..row.len()];
                    let answer = block * to.along;
                    row.iter().zip(target).for_each(|(from, target)| *target = from.along.dot(&answer));
                }
                at_row += row.len();
            }
            at_column += column.len();
        }
        Ok(Self { lu: DenseLu::new(order, matrix)?, points, unknowns })
    }

    /// dt of J dt = b. `moves` gives the motion of every point under tractions.
    pub fn solve(
        &self,
        b: &[SVector<f64, D>],
        moves: impl FnOnce(&[SVector<f64, D>]) -> Result<Vec<SVector<f64, D>>>,
    ) -> Result<Vec<SVector<f64, D>>> {
        let combined: Vec<_> = self.points.iter().zip(b).map(|(point, b)| point.combined(b)).collect();
        // What is known: dt out of contact, r where a point slides.
        let known = |(point, b): (&Linearised<D>, &SVector<f64, D>)| match (point.active, point.slides()) {
            (false, _) => *b,
            (true, true) => point.tangential(b),
            (true, false) => SVector::zeros(),
        };
        let mut y: Vec<SVector<f64, D>> = self.points.iter().zip(&combined).map(known).collect();
        let mut right = combined;
        if y.iter().any(|y| y.iter().any(|value| *value != 0.0)) {
            for ((right, point), moved) in right.iter_mut().zip(&self.points).zip(moves(&y)?) {
                *right -= point.rows()[0] * moved;
            }
            let worn = |(point, y): (&Linearised<D>, &SVector<f64, D>)| point.worn_by(y);
            let wears = self.points.iter().any(|point| point.wearing[0] != 0.0);
            if wears {
                right.iter_mut().zip(self.points.iter().zip(&y).map(worn)).for_each(|(right, worn)| *right += worn);
            }
        }
        let right: Vec<f64> = self.unknowns.iter().map(|unknown| unknown.along.dot(&right[unknown.point])).collect();
        let mut solution = vec![0.0; right.len()];
        if !right.is_empty() {
            self.lu.solve(&right, &mut solution)?;
        }
        for (unknown, value) in self.unknowns.iter().zip(&solution) {
            y[unknown.point] += unknown.along * *value;
        }
        let dragged = |(point, y): (&Linearised<D>, &SVector<f64, D>)| if point.active { point.dragged(y) } else { *y };
        Ok(self.points.iter().zip(&y).map(dragged).collect())
    }

    /// How many unknowns a factor of these points has.
    pub fn order(points: &[Linearised<D>]) -> usize {
        let of = |point: &Linearised<D>| if point.slides() { 1 } else { D };
        points.iter().filter(|point| point.active).map(of).sum()
    }

    /// What it was made of, to be made again from.
    pub fn points(&self) -> &[Linearised<D>] {
        &self.points
    }
}

/// All components of y that are not known beforehand.
fn unknowns<const D: usize>(points: &[Linearised<D>]) -> Vec<Unknown<D>> {
    let mut unknowns = Vec::new();
    for (i, point) in points.iter().enumerate().filter(|(_, point)| point.active) {
        match point.slides() {
            true => unknowns.push(Unknown { point: i, along: point.normal }),
            false => unknowns.extend((0..D).map(|k| {
                let mut along = SVector::zeros();
                along[k] = 1.0;
                Unknown { point: i, along }
            })),
        }
    }
    unknowns
}
