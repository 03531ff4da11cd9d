//! The MPJR interface element: a four-node, zero-thickness element with an embedded profile.
//!
//! Bonari and Paggi (2020), Eqs. (1) to (6). The two lower nodes belong to the layer; the two upper ones to the rigid
//! indenter, whose motion is prescribed, so they carry no unknowns and the relative displacement g = Q N L u reduces to
//! the indenter's motion minus the layer's. In the element's frame (t along the contact face in the sense of +x, n
//! outward from the layer), with everything at the undeformed place (x, z) of the point:
//!
//! ```text
//! c    = h(x - s) - D + z_top - z      vertical clearance; s sliding, D approach, z_top the summit of the face
//! g*_n = c n_z - u.n                   Eq. (2), corrected normal gap
//! p    = -alpha g*_n where g*_n < 0    Eq. (3), p >= 0 in compression
//! w    = (v - du/dt).t                 slip rate; v = (ds/dt, -dD/dt), the indenter's velocity
//! q    = friction law of (p, w)        Eq. (4), traction on the layer along t
//! R_a  = integral of N_a (-q t + p n)  Eq. (6), internal minus external force on the lower nodes a = 1, 2
//! ```
//!
//! On a flat face t = x, n = z, z = z_top. On a curved one the gap is the projection of the vertical clearance on the
//! local normal, which is the distance to second order in the slopes of face and profile.
//!
//! Ours rather than the paper's: the upper nodes are eliminated, the elevation of a curved face enters the gap, and the
//! quadrature may be nodal.

use nalgebra::{Matrix2, Vector2};

use crate::friction::Friction;

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

/// The paper's Q: turns (x, z) into (t, n); its rows are t and n.
pub type Frame = Matrix2<f64>;

/// The frame of an element along the unit vector `tangent`.
pub fn frame(tangent: Vector2<f64>) -> Frame {
    Frame::new(tangent.x, tangent.y, -tangent.y, tangent.x)
}

/// The indenter over one point of the face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Over {
    /// Vertical clearance c over the undeformed face, m.
    pub clearance: f64,
    /// (ds/dt, -dD/dt), m/s.
    pub velocity: Vector2<f64>,
}

/// The layer at one point of the face, in (x, z).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Under {
    /// m
    pub displacement: Vector2<f64>,
    /// m/s
    pub rate: Vector2<f64>,
}

/// What the layer and the indenter do at one point, in the element's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// c n_z: the gap over the undeformed face, m.
    pub clearance: f64,
    /// u.n, m
    pub normal: f64,
    /// Slip rate w, m/s.
    pub slip_rate: f64,
}

impl Motion {
    /// The relative motion in the frame, Eq. (2).
    pub fn new(frame: &Frame, over: Over, under: Under) -> Self {
        let displacement = frame * under.displacement;
        let slip_rate = frame * (over.velocity - under.rate);
        Self { clearance: over.clearance * frame[(1, 1)], normal: displacement.y, slip_rate: slip_rate.x }
    }
}

/// Tractions at one point and their derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Traction {
    /// p, Pa, positive in compression.
    pub pressure: f64,
    /// q, Pa, on the layer, positive along t.
    pub shear: f64,
    /// dp/d(u.n), Pa/m
    pub pressure_normal: f64,
    /// dq/d(u.n), Pa/m
    pub shear_normal: f64,
    /// dq/dw, Pa s/m
    pub shear_rate: f64,
}

/// The penalty and friction laws at one point, Eqs. (3) and (4).
pub fn traction(motion: Motion, penalty: f64, friction: Option<&Friction>) -> Traction {
    let penetration = motion.normal - motion.clearance;
    if penetration <= 0.0 {
        return Traction::default();
    }
    let pressure = penalty * penetration;
    let Some(law) = friction else {
        return Traction { pressure, pressure_normal: penalty, ..Traction::default() };
    };
    let answer = law.shear(pressure, motion.slip_rate);
    Traction {
        pressure,
        shear: answer.shear,
        pressure_normal: penalty,
        shear_normal: answer.by_pressure * penalty,
        shear_rate: answer.by_rate,
    }
}

impl Traction {
    /// Internal minus external force per unit length, -q t + p n, as (t, n), Pa.
    pub fn residual(&self) -> Vector2<f64> {
        Vector2::new(-self.shear, self.pressure)
    }

    /// d(residual)/du in (t, n), Pa/m, when du/dt moves with u at `shift` = 1/dt, 1/s. Not symmetric under friction.
    pub fn tangent(&self, shift: f64) -> Matrix2<f64> {
        Matrix2::new(self.shear_rate * shift, -self.shear_normal, 0.0, self.pressure_normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tangent against central differences, with and without friction, sticking and slipping, in and out of contact.
    #[test]
    fn tangent_is_the_derivative_of_the_residual() {
        let friction = Friction::coulomb_tanh(0.3, 1e-3);
        let (penalty, dt, drive, clearance) = (1e6, 0.1, 2e-3, -1e-4);
        for law in [None, Some(&friction)] {
            for (ut, un) in [(1e-5, 2e-5), (1.9e-4, -3e-5), (4e-4, 1e-4), (-2e-4, 5e-5), (1e-4, -2e-4)] {
                let at = |u: Vector2<f64>| {
                    let motion = Motion { clearance, normal: u.y, slip_rate: drive - u.x / dt };
                    traction(motion, penalty, law)
                };
                let u = Vector2::new(ut, un);
                let step = 1e-10;
                let column =
                    |e: Vector2<f64>| (at(u + e * step).residual() - at(u - e * step).residual()) / (2.0 * step);
                let numeric = Matrix2::from_columns(&[column(Vector2::x()), column(Vector2::y())]);
                let exact = at(u).tangent(1.0 / dt);
                assert!((numeric - exact).norm() <= 1e-6 * exact.norm(), "{numeric} {exact}");
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
