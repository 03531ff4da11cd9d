//! What the plane-strain elements share: the split of a stiffness by the two moduli, and the stress at a point.
//!
//! Strain is (e_xx, e_zz, 2 e_xz), the plane is (x, z), tension is positive. N counts an element's unknowns, node by
//! node: u_x1, u_z1, u_x2, ...

use nalgebra::{Matrix3, SMatrix, SVector, Vector3, Vector4};

/// The stiffness of one element split by the two moduli of an isotropic solid, each for a unit modulus:
/// K = G K_dev + K K_vol.
#[derive(Debug, Clone, PartialEq)]
pub struct Split<const N: usize> {
    /// Per unit shear modulus, from the deviatoric strain.
    pub deviatoric: SMatrix<f64, N, N>,
    /// Per unit bulk modulus, from the volumetric strain.
    pub volumetric: SMatrix<f64, N, N>,
}

impl<const N: usize> Split<N> {
    /// G K_dev + K K_vol for moduli in Pa, N/m per m.
    pub fn with(&self, shear: f64, bulk: f64) -> SMatrix<f64, N, N> {
        self.deviatoric * shear + self.volumetric * bulk
    }
}

/// A modulus, Pa, and the nodal displacements it answers to, m.
#[derive(Clone, Copy)]
pub struct Answer<'a, const N: usize> {
    /// Pa
    pub modulus: f64,
    /// In the element's order of unknowns.
    pub displacement: &'a SVector<f64, N>,
}

/// Stress over modulus for a deviatoric unit-modulus response, 2 (e - tr(e)/3 1), of (xx, zz, xz).
pub fn deviatoric_law() -> Matrix3<f64> {
    let (a, b) = (4.0 / 3.0, -2.0 / 3.0);
    Matrix3::new(a, b, 0.0, b, a, 0.0, 0.0, 0.0, 1.0)
}

/// Stress over modulus for a volumetric unit-modulus response, tr(e) 1, of (xx, zz, xz).
pub fn volumetric_law() -> Matrix3<f64> {
    Matrix3::new(1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0)
}

/// Stress (xx, zz, yy, xz), Pa: 2 G (e - tr(e)/3 1) + `mean` 1, with e the strain that answers to the shear modulus
/// `shear` and `mean` the mean stress K tr(e), which may answer to another strain; both moduli and `mean` in Pa.
pub fn stress(shear: f64, strain: &Vector3<f64>, mean: f64) -> Vector4<f64> {
    let third = (strain[0] + strain[1]) / 3.0;
    let normal = |e: f64| 2.0 * shear * (e - third) + mean;
    Vector4::new(normal(strain[0]), normal(strain[1]), normal(0.0), shear * strain[2])
}

/// What the tests of all elements ask: rigid modes, the patch test and its exact stress.
#[cfg(test)]
#[allow(clippy::missing_docs_in_private_items)]
pub(crate) mod trials {
    use super::*;
    use nalgebra::{DMatrix, Matrix2, SymmetricEigen, Vector2};

    pub const SHEAR: f64 = 2.0;
    pub const BULK: f64 = 3.0;
    const GRADIENT: Matrix2<f64> = Matrix2::new(0.3, -0.1, 0.7, 0.4);

    /// A convex quadrilateral without parallel sides.
    pub fn distorted() -> [Vector2<f64>; 4] {
        [[0.1, -0.2], [1.3, 0.0], [1.1, 0.9], [-0.2, 0.7]].map(|p| Vector2::new(p[0], p[1]))
    }

    /// The nodal values of a displacement field.
    pub fn field<const N: usize>(
        corners: &[Vector2<f64>],
        u: impl Fn(Vector2<f64>) -> Vector2<f64>,
    ) -> SVector<f64, N> {
        SVector::from_iterator(corners.iter().flat_map(|&p| [u(p).x, u(p).y]))
    }

    /// The only zero-energy modes are two translations and one rotation.
    pub fn exactly_three_rigid_body_modes<const N: usize>(corners: &[Vector2<f64>], split: &Split<N>) {
        let k = split.with(1.0, 1.7);
        for mode in [|_| Vector2::x(), |_| Vector2::y(), |p: Vector2<f64>| Vector2::new(-p.y, p.x)] {
            assert!((k * field::<N>(corners, mode)).norm() < 1e-14);
        }
        let k = DMatrix::from_fn(N, N, |i, j| k[(i, j)]);
        let mut eigenvalues: Vec<f64> = SymmetricEigen::new(k).eigenvalues.iter().copied().collect();
        eigenvalues.sort_by(f64::total_cmp);
        assert!(eigenvalues[2].abs() < 1e-14 && eigenvalues[3] > 0.05, "{eigenvalues:?}");
    }

    /// A linear field, whose energy is exact on any shape.
    pub fn linear<const N: usize>(corners: &[Vector2<f64>], split: &Split<N>) -> SVector<f64, N> {
        let u = field::<N>(corners, |p| GRADIENT * p);
        let area: f64 = (0..corners.len()).map(|i| corners[i].perp(&corners[(i + 1) % corners.len()]) / 2.0).sum();
        let (stress, strain) = (linear_stress(), (GRADIENT + GRADIENT.transpose()) / 2.0);
        let density = stress[0] * strain[(0, 0)] + stress[1] * strain[(1, 1)] + 2.0 * stress[3] * strain[(0, 1)];
        let energy = u.dot(&(split.with(SHEAR, BULK) * u));
        assert!((energy - density * area).abs() < 1e-14 * energy.abs(), "{energy} {}", density * area);
        u
    }

    /// The stress of [`linear`].
    pub fn linear_stress() -> Vector4<f64> {
        let strain = (GRADIENT + GRADIENT.transpose()) / 2.0;
        let trace = strain.trace();
        let normal = |e: f64| 2.0 * SHEAR * (e - trace / 3.0) + BULK * trace;
        Vector4::new(normal(strain[(0, 0)]), normal(strain[(1, 1)]), normal(0.0), 2.0 * SHEAR * strain[(0, 1)])
    }
}
