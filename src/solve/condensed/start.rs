//! A start for Newton's method where the laws are too stiff for it: nonlinear block Gauss-Seidel on the tractions.
//!
//! With the body condensed onto the face, the motion at a point of the contact is what it would be without the traction
//! there, m0, plus what that traction does, D (q, -p) with a block D of 2 x 2. Point after point the laws are met exactly
//! by their own traction while the others stay (Jourdan, Alart and Jean, Comput. Methods Appl. Mech. Engrg. 155 (1998)
//! 31-47): however stiff the laws are, each is one equation with one root, which bisection finds. It converges
//! by a factor a sweep, Newton's method then in a step or two.

use nalgebra::{Matrix2, Vector2};

use super::compliance::Compliance;
use crate::element::mpjr::Resistance;
use crate::friction::{Friction, Slip};
use crate::interface::Station;

/// Sweeps over all points at most, and products of a compliance and a force in all: it is a start only.
const MOST_SWEEPS: usize = 2000;
const MOST_PRODUCTS: usize = 500_000_000;

/// What the layer does at a point under a traction there: m0 + D (q, -p), in (t, n).
struct Local {
    without: Vector2<f64>,
    own: Matrix2<f64>,
}

impl Station {
    /// D, m/Pa, of a body with the compliance C/c.
    fn own(&self, (compliance, secant): (&Compliance, f64)) -> Matrix2<f64> {
        let mut sum = Matrix2::zeros();
        for (a, na) in self.point.nodes.into_iter().zip(self.point.shape) {
            for (b, nb) in self.point.nodes.into_iter().zip(self.point.shape) {
                let mut block = Matrix2::zeros();
                for j in [0, 1] {
                    compliance.add_column(2 * b + j, na * nb, &[2 * a, 2 * a + 1], block.column_mut(j).as_mut_slice());
                }
                sum += block;
            }
        }
        self.point.frame * sum * self.point.frame.transpose() * (self.point.weight / secant)
    }

    fn motion(&self, u: &[f64]) -> Vector2<f64> {
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
    fn tractions(&self, local: &Local, law: Option<&Friction>) -> Vector2<f64> {
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
        let (mut low, mut high) = (reach(-1.0), reach(1.0));
        for _ in 0..120 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            *if excess(middle) > 0.0 { &mut high } else { &mut low } = middle;
        }
        let q = 0.5 * (low + high);
        Vector2::new(q, self.pressure(local, q))
    }
}

/// The displacements of the face, x, z of each node, m, that the contact at `stations` leaves of the `free` ones, before a
/// body of the compliance C/c.
pub fn displacements(
    stations: &[Station],
    law: Option<&Friction>,
    behind: (&Compliance, f64),
    mut free: Vec<f64>,
) -> Vec<f64> {
    let (compliance, secant) = behind;
    let own: Vec<_> = stations.iter().map(|station| station.own(behind)).collect();
    let mut tractions = vec![Vector2::zeros(); stations.len()];
    let places: Vec<usize> = (0..free.len()).collect();
    let sweeps = (MOST_PRODUCTS / (free.len() * free.len())).clamp(10, MOST_SWEEPS);
    let u = &mut free;
    for _ in 0..sweeps {
        let (mut change, mut size) = (0.0, 0.0);
        for ((station, own), traction) in stations.iter().zip(&own).zip(&mut tractions) {
            let signed = |t: &Vector2<f64>| Vector2::new(t.x, -t.y);
            let local = Local { without: station.motion(u) - own * signed(traction), own: *own };
            let new = station.tractions(&local, law);
            let more = signed(&(new - *traction));
            *traction = new;
            size += new.norm_squared();
            if more == Vector2::zeros() {
                continue;
            }
            change += more.norm_squared();
            let force = station.point.frame.tr_mul(&more) * (station.point.weight / secant);
            for (node, share) in
                station.point.nodes.into_iter().zip(station.point.shape).filter(|(_, share)| *share != 0.0)
            {
                compliance.add_column(2 * node, share * force.x, &places, u);
                compliance.add_column(2 * node + 1, share * force.y, &places, u);
            }
        }
        if change <= 1e-24 * size {
            break;
        }
    }
    for (station, traction) in stations.iter().zip(&tractions) {
        // What a stiff law makes of the last digits of a displacement is noise; of its own traction it makes that.
        if station.point.shape == [1.0, 0.0] && traction.y > 0.0 {
            let mut motion = station.motion(u);
            motion.y =
                station.motion.clearance + (traction.y - station.resistance.multiplier) / station.resistance.penalty;
            if let Some(rate) = law.and_then(|law| law.rate(*traction, station.motion.slip)) {
                motion.x = station.before + (station.motion.slip.rate - rate) * station.motion.slip.dt;
            }
            let place = station.point.frame.tr_mul(&motion);
            (u[2 * station.point.nodes[0]], u[2 * station.point.nodes[0] + 1]) = (place.x, place.y);
        }
    }
    free
}
