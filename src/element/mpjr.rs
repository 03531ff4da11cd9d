//! The MPJR interface element: a zero-thickness element with an embedded profile.
//!
//! Bonari and Paggi (2020), Eqs. (1) to (6). The lower nodes belong to the layer; the upper ones to the rigid indenter, whose
//! motion is prescribed, so they carry no unknowns and the relative displacement g = Q N L u reduces to the indenter's motion
//! minus the layer's. With everything at the undeformed place of the point, n the unit normal out of the layer there and
//! T = 1 - n n' what is tangential:
//!
//! ```text
//! c    = h(x - s) - D + z_top - z      vertical clearance; s sliding, D approach, z_top the summit of the face
//! g*_n = c n_z - u.n                   Eq. (2), corrected normal gap; o = -g*_n is the overlap
//! p    = alpha o where o > 0           Eq. (3), p >= 0 in compression
//! d    = T (V dt - du)                 slip over the step; V = (ds/dt, -dD/dt), the indenter's velocity
//! q    = friction law of p and d       Eq. (4), traction on the layer
//! R_a  = integral of -N_a (q - p n)    Eq. (6), internal minus external force on the lower nodes a
//! ```
//!
//! On a flat face n = z, z = z_top. On a curved one the gap is the projection of the vertical clearance on the
//! local normal, which is the distance to second order in the slopes of face and profile.
//!
//! Ours rather than the paper's: the upper nodes are eliminated, the elevation of a curved face enters the gap, the
//! quadrature may be nodal, and so may the laws be exact: no penalty, no regularisation (crate::solve::traction).

use nalgebra::{SMatrix, SVector};

use crate::friction::{Circumstances, Law};

/// One integration point: where the profile is evaluated and what it weighs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Shape functions of the two lower nodes, which sum to 1.
    pub shape: [f64; 2],
    /// Weight times half the length, m.
    pub weight: f64,
}

/// Where the laws are evaluated along the element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quadrature {
    /// At the two nodes: tractions of neighbouring nodes do not mix.
    Nodal,
    /// At two Gauss points.
    Gauss,
}

impl Quadrature {
    /// The two points of an element of length `length`, m.
    pub fn points(self, length: f64) -> [Point; 2] {
        let a = match self {
            Self::Nodal => 1.0,
            Self::Gauss => 1.0 / 3.0_f64.sqrt(),
        };
        [-a, a].map(|xi| Point { shape: [(1.0 - xi) / 2.0, (1.0 + xi) / 2.0], weight: length / 2.0 })
    }
}

/// How layer and indenter have moved against each other at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relative<const D: usize> {
    /// o, m: how far the indenter is in the layer; negative where there is a gap.
    pub overlap: f64,
    /// What a friction law answers to, m: the slip over the step, and before it what the law holds elastically.
    pub slip: SVector<f64, D>,
    /// n
    pub normal: SVector<f64, D>,
}

/// Tractions at one point and their derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traction<const D: usize> {
    /// p, Pa, positive in compression.
    pub pressure: f64,
    /// q, Pa, on the layer.
    pub shear: SVector<f64, D>,
    /// Whether the point sticks.
    pub sticks: bool,
    /// -d(q - p n)/du when the slip is minus the tangential part of the displacement, Pa/m. Not symmetric under friction.
    pub tangent: SMatrix<f64, D, D>,
}

impl<const D: usize> Default for Traction<D> {
    fn default() -> Self {
        Self { pressure: 0.0, shear: SVector::zeros(), sticks: false, tangent: SMatrix::zeros() }
    }
}

impl<const D: usize> Traction<D> {
    /// The penalty and friction laws at one point, Eqs. (3) and (4), for displacements that are known; `at` says the step.
    pub fn new(relative: Relative<D>, penalty: f64, law: Option<&dyn Law>, at: Circumstances) -> Self {
        let Relative { overlap, slip, normal } = relative;
        let pressure = penalty * overlap;
        if pressure <= 0.0 {
            return Self::default();
        }
        let normally = normal * normal.transpose();
        let stiff = normally * penalty;
        let Some(law) = law else { return Self { pressure, tangent: stiff, ..Self::default() } };
        let at = Circumstances { pressure, ..at };
        let length = slip.norm();
        let shear = law.shear(at, length);
        let direction = if length > 0.0 { slip / length } else { SVector::zeros() };
        let across = if length > 0.0 { shear.shear / length } else { shear.by_slip };
        let along = direction * direction.transpose() * (shear.by_slip - across);
        let tangential = (SMatrix::identity() - normally) * across + along;
        let drag = direction * normal.transpose() * (shear.by_pressure * penalty);
        Self {
            pressure,
            shear: direction * shear.shear,
            sticks: law.sticks(at, length),
            tangent: stiff + tangential - drag,
        }
    }

    /// q - p n, Pa.
    pub fn on_layer(&self, normal: &SVector<f64, D>) -> SVector<f64, D> {
        self.shear - normal * self.pressure
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::{CoulombTanh, ElasticSlip, Strength};

    /// The tangent against central differences in the plane and in space, without friction and with each law, sticking and
    /// slipping, in and out of contact, under a normal that leans.
    #[test]
    fn tangent_is_the_derivative_of_the_traction() {
        check::<2>(SVector::from([0.28, 0.96]), SVector::from([0.96, -0.28]));
        check::<3>(SVector::from([0.28, 0.0, 0.96]), SVector::from([0.576, -0.8, -0.168]));
    }

    fn check<const D: usize>(normal: SVector<f64, D>, along: SVector<f64, D>) {
        let tanh = CoulombTanh { strength: Strength::constant(0.3), regularisation: 1e-3 };
        let elastic = ElasticSlip { strength: Strength::constant(0.3), elastic_slip: 1e-4 };
        let at = Circumstances { pressure: 0.0, dt: 0.1, resolution: 0.0, slid: 0.0, temperature: 0.0 };
        let laws: [Option<&dyn Law>; 3] = [None, Some(&tanh), Some(&elastic)];
        for law in laws {
            for (slip, overlap) in [(3e-5, 1e-4), (-9e-5, 7e-5), (2.3e-4, 3e-5), (-4e-4, 1e-4), (1e-4, -5e-5)] {
                let on = |du: SVector<f64, D>| {
                    let tangential = du - normal * normal.dot(&du);
                    let relative =
                        Relative { overlap: overlap + normal.dot(&du), slip: along * slip - tangential, normal };
                    Traction::new(relative, 1e6, law, at)
                };
                let exact = on(SVector::zeros()).tangent;
                for column in 0..D {
                    let mut du = SVector::<f64, D>::zeros();
                    du[column] = 1e-10;
                    let change = on(-du).on_layer(&normal) - on(du).on_layer(&normal);
                    let apart = (change / 2e-10 - exact.column(column)).norm();
                    assert!(apart <= 1e-6 * exact.norm(), "{law:?} {slip} {overlap}: {apart}");
                }
            }
        }
    }

    /// Both rules integrate linear functions exactly and sum to the length.
    #[test]
    fn quadrature_is_exact_for_linear_functions() {
        for rule in [Quadrature::Nodal, Quadrature::Gauss] {
            let points = rule.points(0.4);
            let first: f64 = points.iter().map(|point| point.weight * point.shape[0]).sum();
            assert!((first - 0.2).abs() < 1e-16);
        }
    }
}
