//! An isotropic solid in a cell: its stiffness, split by the two moduli, and its stress.
//!
//! With g_a the gradient of the shape function of corner a, the blocks between two corners are, in plane strain too,
//!
//! ```text
//! K_dev,ab = integral of (g_a.g_b) 1 + g_b g_a' - 2/3 g_a g_b',     K_vol,ab = integral of g_a g_b'
//! ```
//!
//! Mean dilatation (B-bar; Hughes, Int. J. Numer. Methods Eng. 15 (1980) 1413) replaces the dilatation by its mean over the cell,
//! K_vol,ab = V m_a m_b' with m_a = (1/V) integral of g_a: a cell is asked for one condition of incompressibility instead of one
//! at each point, and does not lock. Its mean stress is constant and can alternate from cell to cell, a mode that does almost no
//! work; the mean over the cells around a node, which is what is written, removes it.

use nalgebra::{SMatrix, SVector};

use super::{Gradients, MOST_CORNERS, Shape};

/// How the dilatation of a cell is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Dilatation {
    /// At each point.
    #[default]
    Pointwise,
    /// As its mean over the cell, for Poisson ratios up to 1/2.
    Mean,
}

/// A cell that lies somewhere.
#[derive(Clone, Copy)]
pub struct Placed<'a, const D: usize> {
    /// Its shape functions.
    pub shape: &'a dyn Shape<D>,
    /// Where its corners are, m.
    pub corners: &'a [SVector<f64, D>],
    /// How its dilatation is taken.
    pub dilatation: Dilatation,
}

/// The stiffness of a cell for unit moduli, block by block: that of corners a and b is at a times the corners plus b.
#[derive(Debug, Clone, PartialEq)]
pub struct Split<const D: usize> {
    /// Per unit shear modulus.
    pub deviatoric: Vec<SMatrix<f64, D, D>>,
    /// Per unit bulk modulus.
    pub volumetric: Vec<SMatrix<f64, D, D>>,
}

/// The blocks of a cell's stiffness, in the order of [`Split`], N/m per m (N/m in space).
pub type Blocks<const D: usize> = Vec<SMatrix<f64, D, D>>;

/// Stress xx, yy, zz, xy, yz, xz, Pa, tension positive. The plane is that of x and z.
pub type Stress = SVector<f64, 6>;

/// A modulus, Pa, and the displacements of the corners that it answers to, m.
#[derive(Clone, Copy)]
pub struct Answer<'a, const D: usize> {
    /// Pa
    pub modulus: f64,
    /// mu_0 u + sum mu_i z_i of its own series, of each corner.
    pub displacement: &'a [SVector<f64, D>],
}

impl<const D: usize> Split<D> {
    /// G K_dev + K K_vol for moduli in Pa.
    pub fn with(&self, shear: f64, bulk: f64) -> Blocks<D> {
        self.deviatoric.iter().zip(&self.volumetric).map(|(dev, vol)| dev * shear + vol * bulk).collect()
    }
}

/// Blocks as one row-major matrix, corner by corner.
pub fn row_major<const D: usize>(blocks: &[SMatrix<f64, D, D>]) -> Vec<f64> {
    let corners = blocks.len().isqrt();
    let mut values = Vec::with_capacity(blocks.len() * D * D);
    for of_corner in blocks.chunks_exact(corners) {
        for i in 0..D {
            of_corner.iter().for_each(|block| values.extend((0..D).map(|j| block[(i, j)])));
        }
    }
    values
}

impl<const D: usize> Placed<'_, D> {
    /// Its stiffness.
    pub fn stiffness(&self) -> Split<D> {
        let corners = self.shape.corners();
        let zeros = || vec![SMatrix::zeros(); corners * corners];
        let mut split = Split { deviatoric: zeros(), volumetric: zeros() };
        let points = self.points();
        for (g, weight) in &points {
            for (a, b) in pairs(corners) {
                let (g_a, g_b, place) = (&g[a], &g[b], a * corners + b);
                let dyad = g_a * g_b.transpose() * *weight;
                let along = SMatrix::from_diagonal_element(g_a.dot(g_b) * weight);
                split.deviatoric[place] += along + dyad.transpose() - dyad * (2.0 / 3.0);
                split.volumetric[place] += dyad;
            }
        }
        if self.dilatation == Dilatation::Mean {
            let (mean, volume) = mean(&points);
            for (a, b) in pairs(corners) {
                split.volumetric[a * corners + b] = mean[a] * mean[b].transpose() * volume;
            }
        }
        split
    }

    /// The stress at each corner, extrapolated from the points where it is most accurate.
    pub fn corner_stress(&self, shear: Answer<'_, D>, bulk: Answer<'_, D>) -> Vec<Stress> {
        let points = self.points();
        let mean = (self.dilatation == Dilatation::Mean).then(|| mean(&points).0);
        let at_points: Vec<Stress> = points
            .iter()
            .map(|(g, _)| {
                stress(shear.modulus, &gradient(g, shear.displacement)) + {
                    let dilatation = gradient(mean.as_ref().unwrap_or(g), bulk.displacement).trace();
                    Stress::from([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]) * (bulk.modulus * dilatation)
                }
            })
            .collect();
        let at = |corner| self.shape.at_corner(corner).iter().zip(&at_points).map(|(share, s)| s * *share).sum();
        (0..self.shape.corners()).map(at).collect()
    }

    /// Its volume, m^D; negative where the corners run the wrong way.
    pub fn volume(&self) -> f64 {
        self.points().iter().map(|(_, weight)| weight).sum()
    }

    /// The gradients of the shape functions, 1/m, and the weight, m^D, at each of its points.
    pub(super) fn points(&self) -> Vec<(Gradients<D>, f64)> {
        let at = |sample: super::Sample<D>| {
            let slopes = self.shape.slopes(&sample.at);
            // (i, j) = d x_j / d xi_i
            let jacobian: SMatrix<f64, D, D> =
                slopes.iter().zip(self.corners).map(|(slope, corner)| slope * corner.transpose()).sum();
            let inverse = jacobian.try_inverse().unwrap_or_else(SMatrix::zeros);
            (slopes.map(|slope| inverse * slope), determinant(&jacobian) * sample.weight)
        };
        self.shape.samples().into_iter().map(at).collect()
    }
}

/// All pairs of corners.
fn pairs(corners: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..corners).flat_map(move |a| (0..corners).map(move |b| (a, b)))
}

/// m, and the volume.
fn mean<const D: usize>(points: &[(Gradients<D>, f64)]) -> (Gradients<D>, f64) {
    let volume: f64 = points.iter().map(|(_, weight)| weight).sum();
    let mut mean = [SVector::zeros(); MOST_CORNERS];
    for (g, weight) in points {
        mean.iter_mut().zip(g).for_each(|(mean, g)| *mean += g * (weight / volume));
    }
    (mean, volume)
}

/// du_i/dx_j
fn gradient<const D: usize>(g: &Gradients<D>, u: &[SVector<f64, D>]) -> SMatrix<f64, D, D> {
    u.iter().zip(g).map(|(u, g)| u * g.transpose()).sum()
}

/// 2 G (e - tr(e)/3 1), with what acts across the plane.
fn stress<const D: usize>(modulus: f64, gradient: &SMatrix<f64, D, D>) -> Stress {
    let mean = gradient.trace() / 3.0;
    let at = |i: usize, j: usize| {
        let strain = 0.5 * (gradient[(i, j)] + gradient[(j, i)]);
        2.0 * modulus * if i == j { strain - mean } else { strain }
    };
    match D {
        2 => Stress::from([at(0, 0), -2.0 * modulus * mean, at(1, 1), 0.0, 0.0, at(0, 1)]),
        _ => Stress::from([at(0, 0), at(1, 1), at(2, 2), at(0, 1), at(1, 2), at(0, 2)]),
    }
}

/// nalgebra's own asks more of D than that it is a number.
fn determinant<const D: usize>(m: &SMatrix<f64, D, D>) -> f64 {
    let minor = |i: usize, j: usize| m[(1, i)] * m[(2, j)] - m[(1, j)] * m[(2, i)];
    match D {
        2 => m[(0, 0)] * m[(1, 1)] - m[(0, 1)] * m[(1, 0)],
        _ => m[(0, 0)] * minor(1, 2) - m[(0, 1)] * minor(0, 2) + m[(0, 2)] * minor(0, 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::{Multilinear, Simplex};
    use nalgebra::DMatrix;

    const SHEAR: f64 = 3.0;
    const BULK: f64 = 7.0;

    fn vectors<const D: usize>(list: &[[f64; D]]) -> Vec<SVector<f64, D>> {
        list.iter().map(|corner| SVector::from(*corner)).collect()
    }

    /// Cells of no symmetry at all, of each kind, with either dilatation.
    fn each_plane(check: impl Fn(Placed<'_, 2>)) {
        let quadrilateral = vectors(&[[0.1, -0.2], [1.3, 0.0], [1.1, 1.2], [-0.2, 0.8]]);
        let triangle = vectors(&[[0.1, -0.2], [1.3, 0.0], [0.4, 0.9]]);
        for dilatation in [Dilatation::Pointwise, Dilatation::Mean] {
            check(Placed { shape: &Multilinear, corners: &quadrilateral, dilatation });
            check(Placed { shape: &Simplex, corners: &triangle, dilatation });
        }
    }

    fn each_solid(check: impl Fn(Placed<'_, 3>)) {
        let hexahedron = vectors(&[
            [0.1, -0.2, 0.0],
            [1.3, 0.0, 0.1],
            [1.1, 1.2, -0.1],
            [-0.2, 0.8, 0.05],
            [0.0, 0.1, 1.0],
            [1.2, -0.1, 1.2],
            [1.0, 1.1, 0.9],
            [0.1, 0.9, 1.1],
        ]);
        let tetrahedron = vectors(&[[0.1, -0.2, 0.0], [1.3, 0.0, 0.1], [0.4, 0.9, 0.0], [0.3, 0.2, 1.1]]);
        for dilatation in [Dilatation::Pointwise, Dilatation::Mean] {
            check(Placed { shape: &Multilinear, corners: &hexahedron, dilatation });
            check(Placed { shape: &Simplex, corners: &tetrahedron, dilatation });
        }
    }

    fn zero_modes<const D: usize>(cell: Placed<'_, D>) -> usize {
        let order = D * cell.shape.corners();
        let blocks = cell.stiffness().with(SHEAR, BULK);
        let values = DMatrix::from_row_slice(order, order, &row_major(&blocks));
        assert!((&values - values.transpose()).norm() < 1e-14 * values.norm());
        let eigenvalues = values.symmetric_eigenvalues();
        assert!(eigenvalues.min() > -1e-13 * eigenvalues.max());
        eigenvalues.iter().filter(|value| **value < 1e-13 * eigenvalues.max()).count()
    }

    /// Rigid-body modes, and those alone: three in the plane, six in space.
    #[test]
    fn rigid_body_modes_cost_nothing() {
        each_plane(|cell| assert_eq!(zero_modes(cell), 3));
        each_solid(|cell| assert_eq!(zero_modes(cell), 6));
    }

    /// Patch test: a linear field has constant stress, and half its work on the strain as energy, on any cell.
    fn linear<const D: usize>(cell: Placed<'_, D>) {
        let slope = SMatrix::<f64, D, D>::from_fn(|i, j| [0.3, -0.1, 0.2, 0.5, 0.4, -0.6, 0.7, 0.05, -0.35][3 * i + j]);
        let u: Vec<_> = cell.corners.iter().map(|corner| slope * corner).collect();
        let mean = Stress::from([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]) * (BULK * slope.trace());
        let expected = stress(SHEAR, &slope) + mean;
        let answer = |modulus| Answer { modulus, displacement: &u };
        for found in cell.corner_stress(answer(SHEAR), answer(BULK)) {
            assert!((found - expected).norm() < 1e-13, "{found} {expected}");
        }
        let blocks = cell.stiffness().with(SHEAR, BULK);
        let corners = u.len();
        let energy: f64 = pairs(corners).map(|(a, b)| u[a].dot(&(blocks[a * corners + b] * u[b]))).sum();
        let strain = (slope + slope.transpose()) * 0.5;
        let deviator = strain.norm_squared() - strain.trace().powi(2) / 3.0;
        let density = 2.0 * SHEAR * deviator + BULK * strain.trace().powi(2);
        assert!((energy - density * cell.volume()).abs() < 1e-13 * energy);
    }

    #[test]
    fn a_linear_field_is_exact() {
        each_plane(linear);
        each_solid(linear);
    }

    /// Bending u = (x z, -x^2/2) is deviatoric in the mean: free of volumetric energy with mean dilatation, full of it (4/3 of a
    /// square of side 2) without, which is how that locks.
    #[test]
    fn bending_costs_no_volumetric_energy() {
        let square = vectors(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]);
        let u: Vec<_> = square.iter().map(|p| SVector::from([p.x * p.y, -p.x * p.x / 2.0])).collect();
        let energy = |dilatation| {
            let split = Placed { shape: &Multilinear, corners: &square, dilatation }.stiffness();
            pairs(4).map(|(a, b)| u[a].dot(&(split.volumetric[4 * a + b] * u[b]))).sum::<f64>()
        };
        assert!(energy(Dilatation::Mean).abs() < 1e-15);
        assert!((energy(Dilatation::Pointwise) - 4.0 / 3.0).abs() < 1e-14);
    }
}
