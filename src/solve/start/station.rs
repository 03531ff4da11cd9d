//! One point of the contact against a layer that answers to its traction alone.

use nalgebra::{Matrix2, Vector2};

use super::Behind;
use crate::element::mpjr::Resistance;
use crate::friction::{Friction, Shear, Slip};
use crate::interface::Station;

/// What the layer does at a point under a traction there: m0 + D (q, -p), in (t, n).
pub struct Local {
    pub without: Vector2<f64>,
    pub own: Matrix2<f64>,
}

impl Station {
    /// The nodes that share it, and their shares.
    pub(super) fn shares(&self) -> impl Iterator<Item = (usize, f64)> + use<> {
        self.point.nodes.into_iter().zip(self.point.shape).filter(|(_, share)| *share != 0.0)
    }

    /// The motion here under a unit traction there, m/Pa, in (t, n).
    pub(super) fn influence(&self, other: &Self, (compliance, secant): Behind<'_>) -> Matrix2<f64> {
        let mut sum = Matrix2::zeros();
        for (a, na) in self.shares() {
            for (b, nb) in other.shares() {
                let mut block = Matrix2::zeros();
                for j in [0, 1] {
                    compliance.add_column(2 * b + j, na * nb, &[2 * a, 2 * a + 1], block.column_mut(j).as_mut_slice());
                }
                sum += block;
            }
        }
        self.point.frame * sum * other.point.frame.transpose() * (other.point.weight / secant)
    }

    /// The displacement here, m, in (t, n).
    pub(super) fn motion(&self, u: &[f64]) -> Vector2<f64> {
        let node =
            |i: usize| Vector2::new(u[2 * self.point.nodes[i]], u[2 * self.point.nodes[i] + 1]) * self.point.shape[i];
        self.point.frame * (node(0) + node(1))
    }

    /// p under a given q, Pa: p = (lambda + alpha (n.m - c))+.
    fn pressure(&self, local: &Local, shear: f64) -> f64 {
        let Resistance { penalty, multiplier } = self.resistance;
        let open = multiplier + penalty * (local.without.y + local.own[(1, 0)] * shear - self.motion.clearance);
        (open / (1.0 + penalty * local.own[(1, 1)])).max(0.0)
    }

    /// The slip under given tractions.
    fn slip(&self, local: &Local, shear: f64, pressure: f64) -> Slip {
        let along = local.without.x + local.own[(0, 0)] * shear - local.own[(0, 1)] * pressure;
        Slip { rate: self.motion.slip.rate - (along - self.before) / self.motion.slip.dt, ..self.motion.slip }
    }

    /// (q, p) that meet both laws.
    pub(super) fn tractions(&self, local: &Local, law: Option<&Friction>) -> Vector2<f64> {
        let Some(law) = law else { return Vector2::new(0.0, self.pressure(local, 0.0)) };
        let excess = |q: f64| {
            let p = self.pressure(local, q);
            q - if p > 0.0 { law.shear(p, self.slip(local, q, p)).shear } else { 0.0 }
        };
        let widest = law.coefficient() * self.pressure(local, 0.0);
        let reach = |sign: f64| {
            let mut q = sign * widest;
            // The pressure may rise with q.
            for _ in 0..60 {
                if sign * excess(q) >= 0.0 {
                    break;
                }
                q *= 2.0;
            }
            q
        };
        let q = root([reach(-1.0), reach(1.0)], excess);
        Vector2::new(q, self.pressure(local, q))
    }

    /// How tractions that meet both laws change with the motion without them, d(q, p)/d(m0), Pa/m.
    pub(super) fn slope(&self, local: &Local, tractions: Vector2<f64>, law: Option<&Friction>) -> Matrix2<f64> {
        let (Resistance { penalty, .. }, own) = (self.resistance, local.own);
        if tractions.y <= 0.0 {
            return Matrix2::zeros();
        }
        let slip = self.slip(local, tractions.x, tractions.y);
        let shear = law.map_or(Shear::default(), |law| law.shear(tractions.y, slip));
        let rate = shear.by_rate / slip.dt;
        // (1 + rate D_tt) dq - (dq/dp + rate D_tn) dp = -rate dm_t,  -alpha D_nt dq + (1 + alpha D_nn) dp = alpha dm_n
        let (along, normal) = (1.0 + rate * own[(0, 0)], 1.0 + penalty * own[(1, 1)]);
        let laws =
            Matrix2::new(1.0, -(shear.by_pressure + rate * own[(0, 1)]) / along, -penalty * own[(1, 0)] / normal, 1.0);
        let motion = Matrix2::new(-rate / along, 0.0, 0.0, penalty / normal);
        laws.try_inverse().map_or(Matrix2::zeros(), |inverse| inverse * motion)
    }

    /// The shear that friction answers with under a given pressure, and there dq/dp and -dq/dm_t, Pa/m, of the law.
    pub(super) fn shear(&self, local: &Local, pressure: f64, law: &Friction) -> [f64; 3] {
        let most = law.coefficient() * pressure;
        let at = |q: f64| law.shear(pressure, self.slip(local, q, pressure));
        let q = root([-most, most], |q| q - at(q).shear);
        let Shear { by_pressure, by_rate, .. } = at(q);
        [q, by_pressure, by_rate / self.motion.slip.dt]
    }
}

/// Where a function that increases is zero, by bisection to the last digit.
fn root([mut low, mut high]: [f64; 2], of: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..120 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        *if of(middle) > 0.0 { &mut high } else { &mut low } = middle;
    }
    0.5 * (low + high)
}
