//! The three-node triangle of constant strain in plane strain.
//!
//! Nodes run counter-clockwise; unknowns are u_x1, u_z1, u_x2, u_z2, u_x3, u_z3. It converges at the rate of the Q4
//! with about three times its error, and locks badly as the Poisson ratio nears 1/2, for which no remedy is applied to
//! it: use quadrilaterals with mean dilatation there, and triangles at most where little happens.

use nalgebra::{Matrix2x3, SMatrix, Vector2, Vector4};

use super::plane::{self, Answer, Split, deviatoric_law, volumetric_law};

/// B, the same everywhere in the element, 1/m, and the area, m^2; corners in m.
pub fn strain_operator(corners: &[Vector2<f64>; 3]) -> (SMatrix<f64, 3, 6>, f64) {
    let [p, q, r] = corners;
    let twice = (q - p).perp(&(r - p));
    // The gradient of a node's shape function is the opposite edge, turned inward, over twice the area.
    let gradient = Matrix2x3::from_columns(&[r - q, p - r, q - p].map(|edge| Vector2::new(-edge.y, edge.x) / twice));
    let operator = SMatrix::from_fn(|row, column| {
        let (node, x) = (column / 2, column % 2 == 0);
        match (row, x) {
            (0, true) | (2, false) => gradient[(0, node)],
            (1, false) | (2, true) => gradient[(1, node)],
            _ => 0.0,
        }
    });
    (operator, twice / 2.0)
}

/// K_dev = A B' D_dev B and K_vol = A B' D_vol B (unit thickness).
pub fn stiffness(corners: &[Vector2<f64>; 3]) -> Split<6> {
    let (b, area) = strain_operator(corners);
    Split {
        deviatoric: b.transpose() * deviatoric_law() * b * area,
        volumetric: b.transpose() * volumetric_law() * b * area,
    }
}

/// Stress (xx, zz, yy, xz), Pa, of the element, for a shear and a bulk modulus, each with the effective nodal
/// displacements that it answers to.
pub fn stress(corners: &[Vector2<f64>; 3], shear: Answer<'_, 6>, bulk: Answer<'_, 6>) -> Vector4<f64> {
    let (b, _) = strain_operator(corners);
    let volumetric = b * bulk.displacement;
    plane::stress(shear.modulus, &(b * shear.displacement), bulk.modulus * (volumetric[0] + volumetric[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::plane::trials;

    fn triangle() -> [Vector2<f64>; 3] {
        [[0.1, -0.2], [1.3, 0.0], [0.4, 0.9]].map(|p| Vector2::new(p[0], p[1]))
    }

    #[test]
    fn exactly_three_rigid_body_modes() {
        trials::exactly_three_rigid_body_modes(&triangle(), &stiffness(&triangle()));
    }

    #[test]
    fn a_linear_field_is_exact() {
        let u = trials::linear(&triangle(), &stiffness(&triangle()));
        let answer = |modulus| Answer { modulus, displacement: &u };
        let stress = stress(&triangle(), answer(trials::SHEAR), answer(trials::BULK));
        assert!((stress - trials::linear_stress()).norm() < 1e-14);
    }
}
