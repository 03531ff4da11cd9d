//! Whether a face that adheres stays where it is: whether the energy of body, attraction and support is least there.
//!
//! With C the normal compliance of the points that are closed or pull, and s = dp/do at each (1/s = 0 without penetration, 1/alpha with a
//! penalty, s = d sigma/dg < 0 across a gap), K + S is positive definite on them exactly where
//!
//! ```text
//! | C + 1/s   n |      has as many eigenvalues above 0 as there are closed points, and the others below
//! | n'       -k |      (Haynsworth's inertia; k the stiffness of what holds the indenter, the border only where its place is not given)
//! ```
//!
//! and its leading parts then have their signs, too, closed points first: it is quasi-definite, and L D L' tells by D without pivots.
//! Friction, which would hold a face that slips away, is left out, as is what wears.

use nalgebra::SVector;

use super::dense::Influence;
use super::held::up;
use super::{Answer, Laws, Outcome, Site, Sites};

/// Points above which nothing is told: the cost is a third of the cube.
const MOST: usize = 600;
/// What round-off leaves of a pivot, over its entry on the diagonal.
const NOTHING: f64 = 1e-10;

/// A point that matters.
struct Held {
    point: usize,
    /// 1/s, m/Pa.
    soft: f64,
    closed: bool,
}

/// Whether the state stays; of more than 600 points, and of none, that is taken for granted.
pub fn is_stable<const D: usize>(
    sites: &Sites<D>,
    at: &Outcome<D>,
    laws: Laws<'_>,
    influence: &Influence<'_, D>,
) -> bool {
    let Some(law) = laws.adhesion else { return true };
    let of = |&(point, answer): &(usize, Answer<D>)| match answer.gap > 0.0 {
        true => {
            let slope = law.at(answer.gap).by_gap;
            (slope < 0.0).then(|| Held { point, soft: 1.0 / slope, closed: false })
        }
        false => Some(Held { point, soft: laws.penalty.map_or(0.0, f64::recip), closed: true }),
    };
    let mut held: Vec<Held> = at.answers.iter().filter(|(_, answer)| answer.active).filter_map(of).collect();
    held.sort_by_key(|point| !point.closed);
    if held.is_empty() || held.len() > MOST || held.iter().all(|point| point.closed) {
        return true;
    }
    let support = laws.held.supports[0];
    let order = held.len() + usize::from(support.is_some());
    let mut matrix = vec![0.0; order * order];
    let rows: Vec<usize> = held.iter().map(|point| point.point).collect();
    for (j, column) in held.iter().enumerate() {
        let site = &sites[column.point];
        for ((i, to), moved) in rows.iter().enumerate().zip(influence(column.point, &rows)) {
            let row: &Site<D> = &sites[*to];
            let normal: SVector<f64, D> = moved * site.normal;
            matrix[j * order + i] = row.normal.dot(&normal) * (row.weight / site.weight).sqrt();
        }
        matrix[j * order + j] += column.soft;
        if let Some(support) = support {
            matrix[j * order + held.len()] = site.normal.dot(&up()) * site.weight.sqrt();
            matrix[order * order - 1] = -support.stiffness;
        }
    }
    let closed = held.iter().take_while(|point| point.closed).count();
    has_signs(&mut matrix, order, closed)
}

/// Whether the first `above` pivots of a symmetric matrix, of which the lower half is given by columns, are above 0, and the others below.
fn has_signs(matrix: &mut [f64], order: usize, above: usize) -> bool {
    let mut pivots = Vec::with_capacity(order);
    for j in 0..order {
        let (before, rest) = matrix.split_at_mut(j * order);
        let column = &mut rest[..order];
        let size = column[j].abs();
        for (pivot, done) in pivots.iter().zip(before.chunks_exact(order)) {
            let share: f64 = done[j] * pivot;
            if share != 0.0 {
                column[j..].iter_mut().zip(&done[j..]).for_each(|(entry, l)| *entry -= share * l);
            }
        }
        let sign = if j < above { 1.0 } else { -1.0 };
        let least = NOTHING * size;
        if sign * column[j] < -least || !column[j].is_finite() {
            return false;
        }
        let pivot = sign * (sign * column[j]).max(least).max(f64::MIN_POSITIVE);
        column[j..].iter_mut().for_each(|entry| *entry /= pivot);
        pivots.push(pivot);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two springs of 1 that are coupled by 0.2 against attractions that fall by s: K + S has the least eigenvalue 1/1.2 - s.
    #[test]
    fn pivots_tell_what_stays() {
        for (fall, stays) in [(0.5, true), (0.83, true), (0.84, false), (1.24, false), (2.0, false)] {
            let soft = -1.0 / fall;
            assert_eq!(has_signs(&mut [1.0 + soft, 0.2, 0.0, 1.0 + soft], 2, 0), stays, "{fall}");
        }
        // The first one closed, the other has its compliance 1 - 0.04 left.
        for (fall, stays) in [(1.0 / 0.97, true), (1.0 / 0.95, false)] {
            assert_eq!(has_signs(&mut [1.0, 0.2, 0.0, 1.0 - 1.0 / fall], 2, 1), stays, "{fall}");
        }
        // On a support of stiffness k a single point on a spring of 1 stays where its fall is below 1/(1 + 1/k).
        for (stiffness, fall, stays) in [(1.0, 0.49, true), (1.0, 0.51, false), (0.0, 1e-3, false)] {
            assert_eq!(has_signs(&mut [1.0 - 1.0 / fall, 1.0, 0.0, -stiffness], 2, 0), stays, "{stiffness} {fall}");
        }
    }
}
