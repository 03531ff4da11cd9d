//! The four-node bilinear quadrilateral in plane strain, with 2 x 2 Gauss points.
//!
//! Nodes run counter-clockwise. It locks as the Poisson ratio nears 1/2: [`super::bbar`] does not.

use nalgebra::{Matrix2, Matrix2x4, SMatrix, SVector, Vector2, Vector3, Vector4};

use super::plane::{self, Answer, Split, deviatoric_law, volumetric_law};

/// Eight by eight: one element's stiffness.
pub type Stiffness = SMatrix<f64, 8, 8>;
/// Strain from nodal displacements.
pub type StrainOperator = SMatrix<f64, 3, 8>;

/// Corners of the reference square, counter-clockwise.
pub const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// The Gauss points of the reference square, one near each corner; each has weight 1.
pub fn gauss_points() -> [[f64; 2]; 4] {
    CORNERS.map(|corner| corner.map(|c| c / 3.0_f64.sqrt()))
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
pub fn stiffness(corners: &[Vector2<f64>; 4]) -> Split<8> {
    let (dev, vol) = (deviatoric_law(), volumetric_law());
    let mut split = Split { deviatoric: Stiffness::zeros(), volumetric: Stiffness::zeros() };
    for point in gauss_points() {
        let (b, det) = strain_operator(corners, point);
        split.deviatoric += b.transpose() * dev * b * det;
        split.volumetric += b.transpose() * vol * b * det;
    }
    split
}

/// Stress (xx, zz, yy, xz), Pa, at the four corners for a shear and a bulk modulus, each with the effective nodal
/// displacements that it answers to (mu_0 u + sum mu_i z_i of its own Prony series).
///
/// Taken at the Gauss points, where it is most accurate, and extrapolated bilinearly to the corners.
pub fn corner_stress(corners: &[Vector2<f64>; 4], shear: Answer<'_, 8>, bulk: Answer<'_, 8>) -> [Vector4<f64>; 4] {
    extrapolate(gauss_points().map(|point| {
        let (b, _) = strain_operator(corners, point);
        let mean = bulk.modulus * dilatation(&b, bulk.displacement);
        plane::stress(shear.modulus, &strain(&b, shear.displacement), mean)
    }))
}

/// B u
pub(super) fn strain(b: &StrainOperator, displacement: &SVector<f64, 8>) -> Vector3<f64> {
    b * displacement
}

/// tr(B u)
fn dilatation(b: &StrainOperator, displacement: &SVector<f64, 8>) -> f64 {
    let strain = strain(b, displacement);
    strain[0] + strain[1]
}

/// Values at the corners of the bilinear function with these values at the Gauss points.
pub(super) fn extrapolate(at_gauss: [Vector4<f64>; 4]) -> [Vector4<f64>; 4] {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::plane::trials;

    #[test]
    fn exactly_three_rigid_body_modes() {
        trials::exactly_three_rigid_body_modes(&trials::distorted(), &stiffness(&trials::distorted()));
    }

    /// Patch test: a linear field has constant stress, whose energy is exact on any shape.
    #[test]
    fn a_linear_field_is_exact() {
        let u = trials::linear(&trials::distorted(), &stiffness(&trials::distorted()));
        let answer = |modulus| Answer { modulus, displacement: &u };
        for stress in corner_stress(&trials::distorted(), answer(trials::SHEAR), answer(trials::BULK)) {
            assert!((stress - trials::linear_stress()).norm() < 1e-14);
        }
    }
}
