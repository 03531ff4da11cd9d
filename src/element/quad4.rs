//! The four-node bilinear quadrilateral in plane strain, with 2 x 2 Gauss points.
//!
//! Nodes run counter-clockwise; unknowns are node by node: u_x1, u_z1, u_x2, ... Strain is (e_xx, e_zz, 2 e_xz), the
//! plane is (x, z), tension is positive.

use nalgebra::{Matrix2, Matrix2x4, Matrix3, SMatrix, SVector, Vector2, Vector4};

/// Eight by eight: one element's stiffness.
pub type Stiffness = SMatrix<f64, 8, 8>;
/// Strain from nodal displacements.
pub type StrainOperator = SMatrix<f64, 3, 8>;

/// Corners of the reference square, counter-clockwise.
const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// The stiffness of one element split by the two moduli of an isotropic solid, each for a unit modulus:
/// K = G K_dev + K K_vol.
#[derive(Debug, Clone, PartialEq)]
pub struct Split {
    /// Per unit shear modulus, from the deviatoric strain.
    pub deviatoric: Stiffness,
    /// Per unit bulk modulus, from the volumetric strain.
    pub volumetric: Stiffness,
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

/// B and the Jacobian determinant at `point` of the reference square; `corners` are the node coordinates, m.
pub fn strain_operator(corners: &[Vector2<f64>; 4], point: [f64; 2]) -> (StrainOperator, f64) {
    let reference = Matrix2x4::from_fn(|row, node| {
        let [a, b] = CORNERS[node];
        if row == 0 { a * (1.0 + b * point[1]) / 4.0 } else { b * (1.0 + a * point[0]) / 4.0 }
    });
    // jacobian[(i, j)] = d x_j / d xi_i
    let jacobian: Matrix2<f64> = (0..4).map(|node| reference.column(node) * corners[node].transpose()).sum();
    let det = jacobian.determinant();
    let inverse = Matrix2::new(jacobian[(1, 1)], -jacobian[(0, 1)], -jacobian[(1, 0)], jacobian[(0, 0)]) / det;
    let gradient = inverse * reference;
    let operator = StrainOperator::from_fn(|row, column| {
        let (node, x) = (column / 2, column % 2 == 0);
        match (row, x) {
            (0, true) | (2, false) => gradient[(0, node)],
            (1, false) | (2, true) => gradient[(1, node)],
            _ => 0.0,
        }
    });
    (operator, det)
}

/// K_dev = integral of B' D_dev B and K_vol = integral of B' D_vol B over the element (unit thickness).
pub fn stiffness(corners: &[Vector2<f64>; 4]) -> Split {
    let (dev, vol) = (deviatoric_law(), volumetric_law());
    let mut split = Split { deviatoric: Stiffness::zeros(), volumetric: Stiffness::zeros() };
    for corner in CORNERS {
        let (b, det) = strain_operator(corners, corner.map(|c| c / 3.0_f64.sqrt()));
        split.deviatoric += b.transpose() * dev * b * det;
        split.volumetric += b.transpose() * vol * b * det;
    }
    split
}

/// Stress (xx, zz, yy, xz), Pa, at the four corners for moduli `shear` and `bulk`, Pa, each with the effective nodal
/// displacements that it answers to (mu_0 u + sum mu_i z_i of its own Prony series), m.
///
/// Taken at the Gauss points, where it is most accurate, and extrapolated bilinearly to the corners.
pub fn corner_stress(corners: &[Vector2<f64>; 4], shear: Answer<'_>, bulk: Answer<'_>) -> [Vector4<f64>; 4] {
    let at_gauss = CORNERS.map(|corner| {
        let (b, _) = strain_operator(corners, corner.map(|c| c / 3.0_f64.sqrt()));
        let (e, v) = (b * shear.displacement, b * bulk.displacement);
        let mean = (e[0] + e[1]) / 3.0;
        let pressure = bulk.modulus * (v[0] + v[1]);
        let dev = |strain: f64| 2.0 * shear.modulus * (strain - mean) + pressure;
        Vector4::new(dev(e[0]), dev(e[1]), dev(0.0), shear.modulus * e[2])
    });
    CORNERS.map(|corner| {
        (0..4)
            .map(|gauss| {
                let [a, b] = CORNERS[gauss];
                let r = 3.0_f64.sqrt();
                at_gauss[gauss] * ((1.0 + a * corner[0] * r) * (1.0 + b * corner[1] * r) / 4.0)
            })
            .sum()
    })
}

/// A modulus, Pa, and the nodal displacements it answers to, m.
#[derive(Clone, Copy)]
pub struct Answer<'a> {
    /// Pa
    pub modulus: f64,
    /// In the element's order of unknowns.
    pub displacement: &'a SVector<f64, 8>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SymmetricEigen;

    /// A distorted convex quadrilateral.
    fn distorted() -> [Vector2<f64>; 4] {
        [[0.1, -0.2], [1.3, 0.0], [1.1, 0.9], [-0.2, 0.7]].map(|p| Vector2::new(p[0], p[1]))
    }

    fn field(corners: &[Vector2<f64>; 4], u: impl Fn(Vector2<f64>) -> Vector2<f64>) -> SVector<f64, 8> {
        SVector::from_iterator(corners.iter().flat_map(|&p| [u(p).x, u(p).y]))
    }

    /// The only zero-energy modes are two translations and one rotation (bilinear Q4, full integration).
    #[test]
    fn exactly_three_rigid_body_modes() {
        let corners = distorted();
        let split = stiffness(&corners);
        let k = split.deviatoric + split.volumetric * 1.7;
        for mode in [|_| Vector2::x(), |_| Vector2::y(), |p: Vector2<f64>| Vector2::new(-p.y, p.x)] {
            assert!((k * field(&corners, mode)).norm() < 1e-14);
        }
        let mut eigenvalues: Vec<f64> = SymmetricEigen::new(k).eigenvalues.iter().copied().collect();
        eigenvalues.sort_by(f64::total_cmp);
        assert!(eigenvalues[2].abs() < 1e-14 && eigenvalues[3] > 0.05, "{eigenvalues:?}");
    }

    /// Patch test: a linear field has constant stress, whose nodal forces and energy are exact on any shape.
    #[test]
    fn a_linear_field_is_exact() {
        let corners = distorted();
        let (shear, bulk) = (2.0, 3.0);
        let gradient = Matrix2::new(0.3, -0.1, 0.7, 0.4);
        let u = field(&corners, |p| gradient * p);
        let strain = (gradient + gradient.transpose()) / 2.0;
        let (exx, ezz, exz) = (strain[(0, 0)], strain[(1, 1)], strain[(0, 1)]);
        let trace = exx + ezz;
        let expected = Vector4::new(
            2.0 * shear * (exx - trace / 3.0) + bulk * trace,
            2.0 * shear * (ezz - trace / 3.0) + bulk * trace,
            -2.0 * shear * trace / 3.0 + bulk * trace,
            2.0 * shear * exz,
        );
        let answer = |modulus| Answer { modulus, displacement: &u };
        for stress in corner_stress(&corners, answer(shear), answer(bulk)) {
            assert!((stress - expected).norm() < 1e-14);
        }
        let split = stiffness(&corners);
        let area: f64 = (0..4)
            .map(|i| {
                let (p, q) = (corners[i], corners[(i + 1) % 4]);
                (p.x * q.y - p.y * q.x) / 2.0
            })
            .sum();
        let density = expected[0] * exx + expected[1] * ezz + 2.0 * expected[3] * exz;
        let energy = u.dot(&((split.deviatoric * shear + split.volumetric * bulk) * u));
        assert!((energy - density * area).abs() < 1e-14 * energy.abs(), "{energy} {}", density * area);
    }
}
