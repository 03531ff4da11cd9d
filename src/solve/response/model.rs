//! About what a face answers a force on one of its nodes with: for preconditioners and moduli, which need no digits of it.
//!
//! Of two nodes a distance r apart, with r^ the direction along the face from the one that bears f to the other,
//!
//! ```text
//! u = (zz f_z + rz (f.r^)) z^ + (rr (f.r^) - rz f_z) r^ + tt (f - f_z z^ - (f.r^) r^)
//! ```
//!
//! as on a body that is the same in all directions along its face. Each is taken from what the body says at a few nodes, times r in space,
//! between the distances that occur; so a finite depth and strata are in it, and free sides are not. What a node does under its own
//! force is a number for each component times the inverse of its own block of the stiffness.

use nalgebra::{SMatrix, SVector};

use super::applied::Column;
use crate::mesh::Face;

/// Ratio of the distances of two knots.
const RATIO: f64 = 1.2;

/// The model, m per N/m (m/N in space).
pub struct Model<const D: usize> {
    places: Vec<SVector<f64, D>>,
    own: Vec<SMatrix<f64, D, D>>,
    knots: Vec<Knot>,
}

/// zz, rr, tt and rz, times r in space, at a distance.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot {
    /// ln r
    at: f64,
    values: [f64; 4],
}

impl<const D: usize> Model<D> {
    /// Of a face, from columns of C and the inverse of each node's block of the stiffness, zero where a component is held.
    pub fn new(face: &Face<D>, columns: &[Column], mut own: Vec<SMatrix<f64, D, D>>) -> Self {
        let ratios = |k: usize| {
            let of = columns.iter().filter(move |column| column.component == k);
            let sum =
                of.clone().map(|column| column.values[D * column.node + k] / own[column.node][(k, k)]).sum::<f64>();
            sum / of.count().max(1) as f64
        };
        let by = SVector::<f64, D>::from_fn(|k, _| ratios(k).abs().sqrt());
        let by = SMatrix::<f64, D, D>::from_diagonal(&by);
        own.iter_mut().for_each(|own| *own = by * *own * by);
        let mut model = Self { places: face.places.clone(), own, knots: Vec::new() };
        model.tabulate(columns);
        model
    }

    /// The means of what the columns say in each range of distances.
    fn tabulate(&mut self, columns: &[Column]) {
        let mut sums: Vec<(i32, [f64; 9])> = Vec::new();
        for Column { node, component, values } in columns {
            for (i, u) in values.chunks_exact(D).enumerate().filter(|(i, _)| i != node) {
                let Some((r, along)) = self.apart(i, *node) else { continue };
                let bin = (r.ln() / RATIO.ln()).floor() as i32;
                let at = match sums.binary_search_by_key(&bin, |(bin, _)| *bin) {
                    Ok(at) => at,
                    Err(at) => {
                        sums.insert(at, (bin, [0.0; 9]));
                        at
                    }
                };
                let u = SVector::<f64, D>::from_column_slice(u) * Self::growing(r);
                add::<D>(&mut sums[at].1, r, (&u, *component), &along);
            }
        }
        let knot = |(_, [count, at, zz, z, rr, r, tt, t, rz]): &(i32, [f64; 9])| {
            let mean = |sum: f64, weight: f64| if weight > 0.0 { sum / weight } else { 0.0 };
            Knot { at: at / count, values: [mean(*zz, *z), mean(*rr, *r), mean(*tt, *t), mean(*rz, *z)] }
        };
        self.knots = sums.iter().map(knot).collect();
    }

    /// r, m, and r^ with no component along z; none where one is above the other.
    fn apart(&self, i: usize, j: usize) -> Option<(f64, SVector<f64, D>)> {
        let way = self.places[i] - self.places[j];
        let r = way.norm();
        let mut along = way;
        along[D - 1] = 0.0;
        let length = along.norm();
        (length > 0.0).then(|| (r, along / length))
    }

    fn growing(r: f64) -> f64 {
        if D == 3 { r } else { 1.0 }
    }

    /// The displacement of node i under unit forces on node j.
    pub fn block(&self, i: usize, j: usize) -> SMatrix<f64, D, D> {
        if i == j {
            return self.own[i];
        }
        let Some((r, along)) = self.apart(i, j) else { return SMatrix::zeros() };
        let [zz, rr, tt, rz] = self.at(r.ln()).map(|value| value / Self::growing(r));
        let mut block = along * along.transpose() * (rr - tt);
        for k in 0..D - 1 {
            block[(k, k)] += tt;
            block[(D - 1, k)] += rz * along[k];
            block[(k, D - 1)] -= rz * along[k];
        }
        block[(D - 1, D - 1)] += zz;
        // What is held answers with nothing, and nothing to it.
        let free = |node: usize, k: usize| f64::from(u8::from(self.own[node][(k, k)] > 0.0));
        SMatrix::from_fn(|row, column| block[(row, column)] * free(i, row) * free(j, column))
    }

    /// The values at a distance, between knots.
    fn at(&self, at: f64) -> [f64; 4] {
        let after = self.knots.partition_point(|knot| knot.at < at);
        match (after.checked_sub(1).and_then(|before| self.knots.get(before)), self.knots.get(after)) {
            (Some(before), Some(next)) => {
                let share = (at - before.at) / (next.at - before.at);
                std::array::from_fn(|i| before.values[i] + share * (next.values[i] - before.values[i]))
            }
            (Some(knot), None) | (None, Some(knot)) => knot.values,
            (None, None) => [0.0; 4],
        }
    }
}

/// Adds what a node does at a distance r under a force along a component to the sums of its range: how many, ln r, and of zz and rz, rr, tt the
/// sums and the weights.
fn add<const D: usize>(
    sums: &mut [f64; 9],
    r: f64,
    (u, component): (&SVector<f64, D>, usize),
    along: &SVector<f64, D>,
) {
    sums[0] += 1.0;
    sums[1] += r.ln();
    if component == D - 1 {
        sums[2] += u[D - 1];
        sums[3] += 1.0;
        sums[8] -= u.dot(along);
        return;
    }
    // By least squares of one number each.
    let share = along[component];
    sums[4] += u.dot(along) * share;
    sums[5] += share * share;
    let mut across = SVector::<f64, D>::zeros();
    across[component] = 1.0;
    across -= along * share;
    sums[6] += u.dot(&across);
    sums[7] += across.norm_squared();
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between the columns of Boussinesq and Cerruti on a plane grid the model is what they say: to 2 % at all distances, and symmetric to
    /// round-off. u_z = (1 - nu)/(2 pi G r) f_z etc.; K. L. Johnson, Contact Mechanics, 3.2 and 3.6.
    #[test]
    fn a_half_space_is_met() {
        const NU: f64 = 0.3;
        let places: Vec<_> = (0..121).map(|i| SVector::from([(i / 11) as f64, (i % 11) as f64, 0.0])).collect();
        let exact = |i: usize, j: usize| -> SMatrix<f64, 3, 3> {
            let way: SVector<f64, 3> = places[i] - places[j];
            let r = way.norm();
            if r == 0.0 {
                return SMatrix::identity();
            }
            let e = way / r;
            let mut block = e * e.transpose() * NU;
            for k in 0..2 {
                block[(k, k)] += 1.0 - NU;
                block[(2, k)] += (0.5 - NU) * e[k];
                block[(k, 2)] -= (0.5 - NU) * e[k];
            }
            block[(2, 2)] = 1.0 - NU;
            block / r
        };
        let column = |node: usize, component: usize| {
            let values = (0..121).flat_map(|i| exact(i, node).column(component).iter().copied().collect::<Vec<_>>());
            Column { node, component, values: values.collect() }
        };
        let columns: Vec<_> = [60, 38].into_iter().flat_map(|node| (0..3).map(move |k| column(node, k))).collect();
        let face = Face { places: places.clone(), ..Face::default() };
        let model = Model::new(&face, &columns, vec![SMatrix::identity() * 0.5; 121]);
        for (i, j) in [(0, 1), (3, 70), (120, 0), (44, 45), (5, 5), (17, 29)] {
            let (found, wanted) = (model.block(i, j), exact(i, j));
            assert!((found - wanted).norm() < 0.02 * wanted.norm(), "{i} {j}: {found} {wanted}");
            assert!((model.block(j, i).transpose() - found).norm() < 1e-15, "{i} {j}");
        }
    }
}
