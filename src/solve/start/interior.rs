//! An interior-point method for tractions that sweeps do not settle.
//!
//! Two Gauss points to an edge, held by a stiff penalty, share their nodes: most of them carry nothing, and which do is what
//! Newton's method on the laws themselves finds no way to. Here pressure p > 0 and slack s > 0 of every point,
//!
//! ```text
//! s = c - m_n + (p - lambda)/alpha,     p s = mu -> 0
//! ```
//!
//! go to their complementarity together from inside (Nocedal and Wright, Numerical Optimization, 14.1 and 19.2), while the
//! shear q = f p tanh(w/eps) gets as sharp as mu becomes small.

use nalgebra::{Matrix2, Vector2};

use super::{Station, Tractions};
use crate::error::Result;
use crate::petsc::DenseLu;

const MOST_ITERATIONS: usize = 80;
/// What is asked of mu from one iteration to the next.
const REDUCTION: f64 = 0.2;
/// How far towards p = 0 or s = 0 an iteration goes.
const REACH: f64 = 0.99;
/// mu over that of the beginning, at the end.
const LEAST: f64 = 1e-26;

/// A step of Newton's method.
struct Inner {
    tractions: Vec<Vector2<f64>>,
    slacks: Vec<f64>,
}

impl Tractions<'_> {
    /// Follows the tractions from well inside to the laws.
    pub(super) fn approach_from_inside(&mut self) -> Result<()> {
        let law = self.law;
        let influence = self.influences();
        let largest = self.values.iter().fold(0.0, |most: f64, t| most.max(t.y));
        let softest = self.own.iter().fold(0.0, |most: f64, own| most.max(own[(1, 1)]));
        if largest == 0.0 {
            return Ok(());
        }
        let fastest = self.fastest();
        let count = self.stations.len();
        self.set(self.values.iter().map(|t| Vector2::new(t.x, t.y.max(0.1 * largest))).collect());
        let mut slack = vec![0.1 * largest * softest; count];
        let mean = |slack: &[f64], values: &[Vector2<f64>]| {
            slack.iter().zip(values).map(|(s, t)| s * t.y).sum::<f64>() / count as f64
        };
        let first = mean(&slack, &self.values);
        let mut complementarity = first;
        for _ in 0..MOST_ITERATIONS {
            if complementarity <= LEAST * first {
                break;
            }
            if let (Some(law), Some(station)) = (law, self.stations.first()) {
                self.law = Some(law.softened(fastest * (complementarity / first).sqrt(), station.motion.slip.dt));
            }
            let target = REDUCTION * complementarity;
            let Some(Inner { tractions: more, slacks: wider }) = self.inner_step(&slack, target, &influence)? else {
                break;
            };
            let reach = |most: f64, value: f64, change: f64| {
                if change < 0.0 { most.min(-REACH * value / change) } else { most }
            };
            let length = slack.iter().zip(&wider).fold(1.0, |most, (s, ds)| reach(most, *s, *ds));
            let length = self.values.iter().zip(&more).fold(length, |most, (t, dt)| reach(most, t.y, dt.y));
            self.set(self.values.iter().zip(&more).map(|(t, dt)| t + dt * length).collect());
            slack.iter_mut().zip(&wider).for_each(|(s, ds)| *s += length * ds);
            complementarity = mean(&slack, &self.values);
        }
        self.law = law;
        let carries = |((t, s), own): ((&Vector2<f64>, &f64), &Matrix2<f64>)| {
            if t.y * own[(1, 1)] > *s { *t } else { Vector2::zeros() }
        };
        self.set(self.values.iter().zip(&slack).zip(&self.own).map(carries).collect());
        Ok(())
    }

    /// The motion at each point under a unit of (q, p) at each other, m/Pa, by rows.
    fn influences(&self) -> Vec<Matrix2<f64>> {
        let on_layer = Matrix2::new(1.0, 0.0, 0.0, -1.0);
        let row =
            |a: &Station| self.stations.iter().map(|b| a.influence(b, self.behind) * on_layer).collect::<Vec<_>>();
        self.stations.iter().flat_map(row).collect()
    }

    /// Newton's step of (q, p) and of the slacks to p s = `target`; none where its system is singular.
    fn inner_step(&self, slack: &[f64], target: f64, influence: &[Matrix2<f64>]) -> Result<Option<Inner>> {
        let count = self.stations.len();
        let order = 2 * count;
        let (mut matrix, mut right) = (vec![0.0; order * order], vec![0.0; order]);
        for (i, station) in self.stations.iter().enumerate() {
            let (t, s) = (self.values[i], slack[i]);
            let local = self.local(i);
            let motion = station.motion(&self.u);
            let resistance = station.resistance;
            let lacking =
                s - (station.motion.clearance - motion.y + (t.y - resistance.multiplier) / resistance.penalty);
            // (1/alpha + s/p) dp - dm_n = r_s - (p s - mu)/p
            let own = 1.0 / resistance.penalty + s / t.y;
            let normal = own + self.own[i][(1, 1)];
            // (1 + k D_tt) dq - dq/dp dp + k (dm_t - D_tt dq) = answer - q
            let shear = self.law.map(|law| station.shear(&local, t.y, &law));
            let [answer, by_pressure, rate] = shear.unwrap_or_default();
            let along = 1.0 + rate * self.own[i][(0, 0)];
            for (j, block) in influence[i * count..][..count].iter().enumerate() {
                for l in [0, 1] {
                    let column = &mut matrix[(2 * j + l) * order..][..order];
                    let coupled = if j == i && l == 0 { 0.0 } else { rate * block[(0, l)] };
                    column[2 * i] = coupled / along;
                    column[2 * i + 1] = -block[(1, l)] / normal;
                }
            }
            matrix[2 * i * order + 2 * i] = 1.0;
            matrix[(2 * i + 1) * order + 2 * i] -= by_pressure / along;
            matrix[(2 * i + 1) * order + 2 * i + 1] += own / normal;
            right[2 * i] = answer - t.x;
            right[2 * i + 1] = (lacking - (t.y * s - target) / t.y) / normal;
        }
        let Ok(factor) = DenseLu::new(order, matrix) else { return Ok(None) };
        let mut solution = vec![0.0; order];
        factor.solve(&right, &mut solution)?;
        if solution.iter().any(|value| !value.is_finite()) {
            return Ok(None);
        }
        let more: Vec<_> = solution.as_chunks().0.iter().map(|&[q, p]| Vector2::new(q, p)).collect();
        let wider = (0..count).map(|i| (target - slack[i] * more[i].y) / self.values[i].y - slack[i]).collect();
        Ok(Some(Inner { tractions: more, slacks: wider }))
    }
}
