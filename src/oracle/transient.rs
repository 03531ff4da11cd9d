//! Transient sliding of a rigid periodic profile over a viscoelastic bonded layer, in Fourier space.
//!
//! The Poisson ratio is constant, so that the surface compliance C(k) at the instantaneous modulus serves for all
//! time and the memory lives at the surface nodes. Arm i stores the elongation of its spring under the surface
//! displacement u = (u_x, d), dz_i/dt + z_i/tau_i = du/dt, and the tractions t = (q, p) follow from
//!
//! ```text
//! C t = mu_0 u + sum mu_i z_i
//! z+  = decay z + gain (u+ - u),   x = dt/tau
//! exponential:     decay = e^-x,   gain = (1 - e^-x)/x        backward Euler:  decay = gain = 1/(1 + x)
//! so u+ = (C t+ - r)/c,   c = mu_0 + sum mu_i gain_i,   r = sum mu_i (decay_i z_i - gain_i u)
//! ```
//!
//! The contact is that of Bonari and Paggi (2020), Eqs. (2) to (4), at every node: p = alpha e where the penetration
//! e = D - h(x - s) - d > 0, and q = f p tanh(w/eps), w = ds/dt - du_x/dt with du_x/dt = (u_x+ - u_x)/dt.

use nalgebra::{DMatrix, DVector};

use super::layer::Layer;
use super::periodic::kernel;
use super::solid::{Moduli, Solid};
use crate::error::{Error, Result};

/// How the arms are carried over a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Update {
    /// Exact for a displacement linear over the step.
    Exponential,
    /// First order.
    BackwardEuler,
}

impl Update {
    /// (decay, gain) at x = dt/tau > 0.
    fn factors(self, x: f64) -> (f64, f64) {
        match self {
            Self::Exponential => ((-x).exp(), -(-x).exp_m1() / x),
            Self::BackwardEuler => (1.0 / (1.0 + x), 1.0 / (1.0 + x)),
        }
    }
}

/// Newton iterations before a level of regularisation is given up.
const MOST_ITERATIONS: usize = 25;

/// Levels of regularisation before a step is given up.
const MOST_LEVELS: usize = 60;

/// What is pressed and slid.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// The layer.
    pub layer: Layer,
    /// Its material; the Poisson rule must be `ConstantRatio` if there are arms.
    pub solid: Solid,
    /// One period along x, m.
    pub width: f64,
    /// Nodes on the period.
    pub nodes: usize,
    /// Penalty alpha, Pa/m.
    pub penalty: f64,
    /// Friction coefficient f.
    pub friction: f64,
    /// Regularisation eps, m/s.
    pub regularisation: f64,
    /// The update of the arms.
    pub update: Update,
}

/// One step of the imposed motion: its length and where the indenter is at its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// s.
    pub dt: f64,
    /// Normal approach D, m.
    pub approach: f64,
    /// Sliding distance s, m.
    pub sliding: f64,
    /// ds/dt, m/s.
    pub velocity: f64,
}

/// The forces at the end of a step, N/m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Forces {
    /// Integral of p.
    pub normal: f64,
    /// Integral of q.
    pub tangential: f64,
    /// Integral of p dh/dx, h at its present position.
    pub hysteretic: f64,
}

/// The circulants of C at the instantaneous modulus: first index the displacement, second the traction.
struct Kernels {
    zz: Vec<f64>,
    xx: Vec<f64>,
    /// d under q; u_x under p is its negative.
    zx: Vec<f64>,
}

/// A field pair on the nodes: tangential and normal (u_x and d, or q and p).
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// u_x or q.
    pub x: Vec<f64>,
    /// d or p.
    pub z: Vec<f64>,
}

impl Pair {
    fn zeros(n: usize) -> Self {
        Self { x: vec![0.0; n], z: vec![0.0; n] }
    }
}

/// The layer and its history.
pub struct Transient<P> {
    setup: Setup,
    profile: P,
    kernels: Kernels,
    /// u_x and d, m.
    pub displacement: Pair,
    /// q and p, Pa.
    pub traction: Pair,
    /// One spring elongation per arm.
    arms: Vec<Pair>,
}

/// What a step is solved with: everything that its unknowns do not change.
struct Increment {
    step: Step,
    /// c of the module's equations.
    factor: f64,
    /// -r/c: the displacement if no traction acted.
    free: Pair,
    /// D - h(x - s).
    reach: Vec<f64>,
}

impl<P: Fn(f64) -> (f64, f64)> Transient<P> {
    /// At rest, undeformed. The profile is x -> (h, dh/dx), periodic over the width.
    pub fn new(setup: Setup, profile: P) -> Result<Self> {
        if setup.solid.rule != super::PoissonRule::ConstantRatio && !setup.solid.arms.is_empty() {
            return Err(Error::Domain(
                "the surface carries the whole memory only if the Poisson ratio is constant".into(),
            ));
        }
        let (n, layer) = (setup.nodes, setup.layer);
        let moduli = Moduli::elastic(setup.solid.shear, setup.solid.poisson);
        let minus_i = nalgebra::Complex::new(0.0, -1.0);
        let kernels = Kernels {
            zz: kernel(n, setup.width, |k| layer.compliance(k, moduli).zz),
            xx: kernel(n, setup.width, |k| layer.compliance(k, moduli).xx),
            zx: kernel(n, setup.width, |k| minus_i * layer.compliance(k, moduli).xz),
        };
        let arms = vec![Pair::zeros(n); setup.solid.arms.len()];
        Ok(Self { setup, profile, kernels, displacement: Pair::zeros(n), traction: Pair::zeros(n), arms })
    }

    /// The position of node i, m.
    pub fn node(&self, i: usize) -> f64 {
        self.setup.width * i as f64 / self.setup.nodes as f64
    }

    /// Solves one step and commits it.
    pub fn advance(&mut self, step: Step) -> Result<Forces> {
        let increment = self.increment(step);
        self.traction = self.solve(&increment)?;
        let displacement = self.respond(&increment, &self.traction);
        for (z, &(_, time)) in self.arms.iter_mut().zip(&self.setup.solid.arms) {
            let (decay, gain) = self.setup.update.factors(step.dt / time);
            let update = |z: &mut [f64], new: &[f64], old: &[f64]| {
                z.iter_mut().zip(new.iter().zip(old)).for_each(|(z, (new, old))| *z = decay * *z + gain * (new - old));
            };
            update(&mut z.x, &displacement.x, &self.displacement.x);
            update(&mut z.z, &displacement.z, &self.displacement.z);
        }
        self.displacement = displacement;
        Ok(self.forces(step.sliding))
    }

    /// Advances through several steps; the forces at the end of each.
    pub fn run(&mut self, steps: impl IntoIterator<Item = Step>) -> Result<Vec<Forces>> {
        steps.into_iter().map(|step| self.advance(step)).collect()
    }

    fn forces(&self, sliding: f64) -> Forces {
        let cell = self.setup.width / self.setup.nodes as f64;
        let slope = |i| (self.profile)(self.node(i) - sliding).1;
        Forces {
            normal: cell * self.traction.z.iter().sum::<f64>(),
            tangential: cell * self.traction.x.iter().sum::<f64>(),
            hysteretic: cell * self.traction.z.iter().enumerate().map(|(i, p)| p * slope(i)).sum::<f64>(),
        }
    }

    fn increment(&self, step: Step) -> Increment {
        let factors: Vec<(f64, f64, f64)> = self
            .setup
            .solid
            .arms
            .iter()
            .map(|&(weight, time)| {
                let (decay, gain) = self.setup.update.factors(step.dt / time);
                (weight, decay, gain)
            })
            .collect();
        let factor = self.setup.solid.long_term() + factors.iter().map(|(weight, _, gain)| weight * gain).sum::<f64>();
        let free = |field: fn(&Pair) -> &[f64]| -> Vec<f64> {
            let remembered = |i: usize| -> f64 {
                let arms = factors.iter().zip(&self.arms);
                arms.map(|((weight, decay, gain), z)| {
                    weight * (decay * field(z)[i] - gain * field(&self.displacement)[i])
                })
                .sum()
            };
            (0..self.setup.nodes).map(|i| -remembered(i) / factor).collect()
        };
        let free = Pair { x: free(|pair| &pair.x), z: free(|pair| &pair.z) };
        let reach = (0..self.setup.nodes).map(|i| step.approach - (self.profile)(self.node(i) - step.sliding).0);
        Increment { step, factor, free, reach: reach.collect() }
    }

    /// u+ = (C t - r)/c at every node.
    fn respond(&self, increment: &Increment, t: &Pair) -> Pair {
        let mut u = increment.free.clone();
        let n = self.setup.nodes;
        for j in (0..n).filter(|&j| t.z[j] != 0.0 || t.x[j] != 0.0) {
            let (p, q) = (t.z[j] / increment.factor, t.x[j] / increment.factor);
            for i in 0..n {
                let lag = (n + i - j) % n;
                u.z[i] += self.kernels.zz[lag] * p + self.kernels.zx[lag] * q;
                u.x[i] += self.kernels.xx[lag] * q - self.kernels.zx[lag] * p;
            }
        }
        u
    }

    /// The tractions at the end of the step.
    ///
    /// Newton's method overshoots where the friction law is steep against the compliance (sliding that starts slowly
    /// or turns back). Then the law is first made gentle, and its regularisation brought down to eps by ratios that
    /// shrink whenever one is too bold; the result is that of eps alone.
    fn solve(&self, increment: &Increment) -> Result<Pair> {
        let eps = self.setup.regularisation;
        let (mut trial, mut ratio) = (eps, 10.0);
        let (mut start, mut gentle) = (self.traction.clone(), f64::INFINITY);
        for _ in 0..MOST_LEVELS {
            match self.settle(increment, trial, start.clone())? {
                Some(t) if trial == eps => return Ok(t),
                Some(t) => (start, gentle) = (t, trial),
                // Nothing has settled yet: gentler still. Otherwise: a smaller stride from what has settled.
                None if gentle.is_infinite() => {
                    trial *= ratio;
                    continue;
                }
                None => ratio = ratio.sqrt(),
            }
            trial = eps.max(gentle / ratio);
        }
        Err(Error::Solver(format!("the contact did not settle at {:?}", increment.step)))
    }

    /// Newton's method on the tractions of the nodes in contact, with friction regularised by eps; `None` if it
    /// wanders.
    fn settle(&self, increment: &Increment, eps: f64, mut t: Pair) -> Result<Option<Pair>> {
        let mut touching = Vec::new();
        for _ in 0..MOST_ITERATIONS {
            let u = self.respond(increment, &t);
            let active: Vec<usize> = (0..self.setup.nodes).filter(|&i| increment.reach[i] - u.z[i] > 0.0).collect();
            let next = self.newton(increment, (eps, &active), (&t, &u))?;
            let largest = next.z.iter().fold(0.0f64, |m, p| m.max(p.abs()));
            let change = |new: &[f64], old: &[f64]| new.iter().zip(old).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            let change = change(&next.z, &t.z).max(change(&next.x, &t.x));
            t = next;
            if active == touching && change <= 1e-11 * largest {
                return Ok(Some(t));
            }
            touching = active;
        }
        Ok(None)
    }

    /// The slip rate at which the friction law of node i is linearised.
    ///
    /// A Newton step leaves (w, q) off the law's curve; of the two ways back, keeping w or keeping q, the one of smaller
    /// |w| is taken, or w = 0 if they disagree in sign: from the steep side of tanh the iteration is monotone, from
    /// the flat side it overshoots. At the solution the two coincide and the convergence is quadratic.
    fn tangent_point(&self, increment: &Increment, eps: f64, (t, u): (&Pair, &Pair), i: usize) -> f64 {
        let w = increment.step.velocity - (u.x[i] - self.displacement.x[i]) / increment.step.dt;
        let (q, limit) = (t.x[i], self.setup.friction * t.z[i]);
        // Without pressure or friction the law is flat; where w lies does not matter.
        if limit <= 0.0 || q * w.signum() >= limit {
            w
        } else if q * w <= 0.0 {
            0.0
        } else {
            w.signum() * w.abs().min(eps * (q.abs() / limit).atanh())
        }
    }

    /// One Newton step for the nodes in contact, solved for the new tractions themselves:
    ///
    /// ```text
    /// p/alpha + (C_zz p + C_zx q)/c = reach - free_z
    /// q = f p tanh(w0/eps) + b dt (w - w0),   b = f p(now) sech^2(w0/eps)/(eps dt)
    /// ```
    ///
    /// Where b is nothing against the compliance (full slip, most of a sliding phase) q is eliminated.
    fn newton(&self, increment: &Increment, (eps, active): (f64, &[usize]), (t, u): (&Pair, &Pair)) -> Result<Pair> {
        let (m, n, setup) = (active.len(), self.setup.nodes, &self.setup);
        let at: Vec<f64> = active.iter().map(|&i| self.tangent_point(increment, eps, (t, u), i)).collect();
        // Frictionless: whatever eps is, also 0.
        let drag = |w: &f64| if setup.friction == 0.0 { 0.0 } else { setup.friction * (w / eps).tanh() };
        let drag: Vec<f64> = at.iter().map(drag).collect();
        let slip_gain = |a: usize| {
            let sech = 1.0 / (at[a] / eps).cosh();
            setup.friction * t.z[active[a]].max(0.0) * sech * sech / (eps * increment.step.dt)
        };
        // (position in the active list, b) of the nodes whose shear answers to their own motion.
        let unsettled: Vec<(usize, f64)> = (0..m)
            .map(|a| (a, slip_gain(a)))
            .filter(|&(_, b)| b * self.kernels.xx[0] > 1e-14 * increment.factor)
            .collect();
        let mut row_of = vec![None; m];
        unsettled.iter().enumerate().for_each(|(r, &(a, _))| row_of[a] = Some(m + r));

        let size = m + unsettled.len();
        if size == 0 {
            return Ok(Pair::zeros(n));
        }
        let mut matrix = DMatrix::zeros(size, size);
        let mut load = DVector::zeros(size);
        // One row of [kernel of p, kernel of q] times a scale, with eliminated shears folded into their pressures.
        let couple = |matrix: &mut DMatrix<f64>, row: usize, i: usize, by: (f64, &[f64], f64, &[f64])| {
            let (of_p, kernel_p, of_q, kernel_q) = by;
            for (a, &j) in active.iter().enumerate() {
                let lag = (n + i - j) % n;
                let (p, q) = (of_p * kernel_p[lag], of_q * kernel_q[lag]);
                match row_of[a] {
                    Some(column) => {
                        matrix[(row, a)] += p;
                        matrix[(row, column)] += q;
                    }
                    None => matrix[(row, a)] += p + q * drag[a],
                }
            }
        };
        let k = &self.kernels;
        for (row, &i) in active.iter().enumerate() {
            let scale = 1.0 / increment.factor;
            couple(&mut matrix, row, i, (scale, &k.zz, scale, &k.zx));
            matrix[(row, row)] += 1.0 / setup.penalty;
            load[row] = increment.reach[i] - increment.free.z[i];
        }
        for (r, &(a, b)) in unsettled.iter().enumerate() {
            let (row, i, scale) = (m + r, active[a], b / increment.factor);
            couple(&mut matrix, row, i, (-scale, &k.zx, scale, &k.xx));
            matrix[(row, row)] += 1.0;
            matrix[(row, a)] -= drag[a];
            let excess = (increment.step.velocity - at[a]) * increment.step.dt;
            load[row] = b * (excess + self.displacement.x[i] - increment.free.x[i]);
        }
        let solution =
            matrix.lu().solve(&load).ok_or_else(|| Error::Solver("the contact matrix is singular".into()))?;
        let mut next = Pair::zeros(n);
        for (a, &i) in active.iter().enumerate() {
            next.z[i] = solution[a];
            next.x[i] = row_of[a].map_or(drag[a] * solution[a], |row| solution[row]);
        }
        Ok(next)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#[path = "transient_tests.rs"]
mod tests;
