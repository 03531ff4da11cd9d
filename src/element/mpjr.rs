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
//! q    = friction law of p and w       Eq. (4), traction on the layer along t
//! R_a  = integral of N_a (-q t + p n)  Eq. (6), internal minus external force on the lower nodes a = 1, 2
//! ```
//!
//! On a flat face t = x, n = z, z = z_top. On a curved one the gap is the projection of the vertical clearance on the
//! local normal, which is the distance to second order in the slopes of face and profile.
//!
//! Ours rather than the paper's: the upper nodes are eliminated, the elevation of a curved face enters the gap, the
//! quadrature may be nodal, and there may be a multiplier: p = lambda - alpha g*_n where that is positive.

use nalgebra::{Matrix2, Vector2};

use crate::friction::{Friction, Shear, Slip};

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
    /// (ds/dt, -dD/dt) over the step, m/s.
    pub velocity: Vector2<f64>,
    /// The length of the step, s; 0 where it is over.
    pub dt: f64,
    /// See [`Slip::resolution`], m/s.
    pub resolution: f64,
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
    /// At the slip rate w.
    pub slip: Slip,
}

impl Motion {
    /// The relative motion in the frame, Eq. (2), of a point that had slipped by `stuck` (m) while it was to stick.
    pub fn new(frame: &Frame, over: Over, under: Under, stuck: f64) -> Self {
        let displacement = frame * under.displacement;
        let rate = (frame * (over.velocity - under.rate)).x;
        let slip = Slip { rate, dt: over.dt, stuck, resolution: over.resolution };
        Self { clearance: over.clearance * frame[(1, 1)], normal: displacement.y, slip }
    }

    /// How far the indenter is in the layer, m; negative where there is a gap.
    pub fn penetration(&self) -> f64 {
        self.normal - self.clearance
    }
}

/// What a point resists penetration with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resistance {
    /// Penalty alpha, Pa/m.
    pub penalty: f64,
    /// Multiplier lambda >= 0, Pa; 0 but for the augmented Lagrangian.
    pub multiplier: f64,
}

/// Tractions at one point and their derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Traction {
    /// p, Pa, positive in compression.
    pub pressure: f64,
    /// q and what goes with it; q on the layer, positive along t.
    pub shear: Shear,
    /// dp/d(u.n), Pa/m
    pub pressure_normal: f64,
}

/// The penalty and friction laws at one point, Eqs. (3) and (4).
pub fn traction(motion: Motion, resistance: Resistance, friction: Option<&Friction>) -> Traction {
    let Resistance { penalty, multiplier } = resistance;
    let pressure = multiplier + penalty * motion.penetration();
    if pressure <= 0.0 {
        return Traction::default();
    }
    let shear = friction.map_or(Shear::default(), |law| law.shear(pressure, motion.slip));
    Traction { pressure, shear, pressure_normal: penalty }
}

impl Traction {
    /// Internal minus external force per unit length, -q t + p n, as (t, n), Pa.
    pub fn residual(&self) -> Vector2<f64> {
        Vector2::new(-self.shear.shear, self.pressure)
    }

    /// d(residual)/du in (t, n), Pa/m, when du/dt moves with u at `shift` = 1/dt, 1/s. Not symmetric under friction.
    pub fn tangent(&self, shift: f64) -> Matrix2<f64> {
        let Self { shear, pressure_normal, .. } = self;
        Matrix2::new(shear.by_rate * shift, -shear.by_pressure * pressure_normal, 0.0, *pressure_normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::{CoulombTanh, ElasticSlip};

    /// The tangent against central differences, without friction and with each law, sticking and slipping, in and out of
    /// contact, with and without a multiplier.
    #[test]
    fn tangent_is_the_derivative_of_the_residual() {
        let tanh = Friction::CoulombTanh(CoulombTanh { coefficient: 0.3, regularisation: 1e-3 });
        let elastic = Friction::ElasticSlip(ElasticSlip { coefficient: 0.3, elastic_slip: 1e-4 });
        let (dt, drive, clearance, stuck) = (0.1, 2e-3, -1e-4, 4e-5);
        for law in [None, Some(&tanh), Some(&elastic)] {
            for (ut, un, multiplier) in [
                (1e-5, 2e-5, 0.0),
                (1.9e-4, -3e-5, 7.0),
                (2.3e-4, -3e-5, 0.0),
                (4e-4, 1e-4, 3.0),
                (-2e-4, 5e-5, 0.0),
                (1e-4, -2e-4, 0.0),
                (2.3e-4, -2e-4, 200.0),
            ] {
                let resistance = Resistance { penalty: 1e6, multiplier };
                let at = |u: Vector2<f64>| {
                    let slip = Slip { rate: drive - u.x / dt, dt, stuck, resolution: 0.0 };
                    traction(Motion { clearance, normal: u.y, slip }, resistance, law)
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
