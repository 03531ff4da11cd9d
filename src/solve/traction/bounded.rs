//! Contact without friction on a large periodic face: the pressures alone, by conjugate gradients that keep them from pulling.
//!
//! With r = o - p/alpha, the overlap less what the penalty gives way by, p are those of
//!
//! ```text
//! least of 1/2 p'(C + 1/alpha) p - b'p over p >= 0;     r = b - (C + 1/alpha) p is 0 where p > 0, else r <= 0
//! ```
//!
//! After Polonsky and Keer (Wear 231 (1999) 206), on the points that press or overlap, with the inverse of C + 1/alpha on the whole
//! face as preconditioner, Polak and Ribiere's directions, and pressures that would pull set to zero. Where that would raise what is
//! to be least, a step along the projected gradient, which cannot, takes its place. An iteration is four transforms of one component,
//! or six where a pressure was set to zero; the residual is told in the norm of Newton's method, so that both stop at the same place.

use super::{Behind, Outcome, Sites};
use crate::error::{Error, Result};
use crate::parallel::Team;
use crate::solve::response::{Kernel, Transform};

/// Iterations at most; Newton's method begins it anew where they leave too much.
const MOST: usize = 300;
/// Of what is allowed to be left of the residual: what its recursion loses is not to cost another round.
const ENOUGH: f64 = 0.5;
/// By how much what is to be least may rise, over what it was to fall by.
const RISE: f64 = 1e-3;

/// The least squares of a step: the same at all points of a flat periodic face.
struct Face<'a, const D: usize> {
    transform: &'a Transform<D>,
    team: &'a Team,
    kernel: &'a Kernel<D>,
    /// Of a traction, what a force of the compliance is.
    per_traction: f64,
    /// 1/alpha, and alpha/(alpha + rho).
    give: f64,
    stiff: f64,
    rho: f64,
    weight: f64,
}

/// The pressures where the laws of the normal direction hold, from those of a state: until the norm of the residual is less than the
/// `tolerance` times that of the tractions, or times `scale` where that is larger, or round-off. Collective.
pub fn pressures<const D: usize>(
    sites: &Sites<D>,
    from: &Outcome<D>,
    behind: &Behind<'_, D>,
    (penalty, tolerance, scale): (Option<f64>, f64, f64),
) -> Result<Vec<f64>> {
    let ((transform, kernel), site) = behind
        .compliance
        .waves()
        .zip(sites.first())
        .ok_or_else(|| Error::Internal("conjugate gradients without a periodic face".into()))?;
    let rho = site.moduli.normal;
    let face = Face {
        transform,
        team: transform.team(),
        kernel,
        per_traction: site.weight / behind.secant,
        give: penalty.map_or(0.0, f64::recip),
        stiff: penalty.map_or(1.0, |alpha| alpha / (alpha + rho)),
        rho,
        weight: site.weight,
    };
    let (mut p, mut r) = face.begin(sites, from)?;
    let [mut z, mut d, mut q] = [(); 3].map(|()| vec![0.0; p.len()]);
    let mut before = r.clone();
    // z'r of the iteration before; none where a direction begins anew.
    let mut last: Option<f64> = None;
    for _ in 0..MOST {
        let (left, size) = face.norms(&p, &r);
        if left <= (ENOUGH * tolerance * size.max(scale)).max(from.noise()) {
            break;
        }
        let presses = |p: f64, r: f64| p > 0.0 || r > 0.0;
        z.iter_mut().zip(p.iter().zip(&r)).for_each(|(z, (&p, &r))| *z = if presses(p, r) { r } else { 0.0 });
        face.precondition(&mut z)?;
        let (mut now, mut turned, mut kept) = (0.0, 0.0, 0.0);
        for (i, z) in z.iter_mut().enumerate() {
            *z = if presses(p[i], r[i]) { *z } else { 0.0 };
            (now, turned, kept) = (now + *z * r[i], turned + *z * (r[i] - before[i]), kept + d[i] * r[i]);
        }
        let [now, turned, kept] = face.team.sum([now, turned, kept]);
        let share = last.map_or(0.0, |last| (turned / last).max(0.0));
        let share = if now + share * kept > 0.0 { share } else { 0.0 };
        for (i, d) in d.iter_mut().enumerate() {
            *d = if presses(p[i], r[i]) { z[i] + share * *d } else { 0.0 };
            q[i] = *d;
        }
        face.yield_under(&mut q)?;
        let (fall, bend) =
            d.iter().zip(&q).zip(&r).fold((0.0, 0.0), |(fall, bend), ((d, q), r)| (fall + d * r, bend + d * q));
        let [fall, bend] = face.team.sum([fall, bend]);
        if !(bend > 0.0 && fall > 0.0) {
            break;
        }
        last = Some(now);
        before.copy_from_slice(&r);
        if !face.advance((&mut p, &mut r), (&d, &mut q), fall / bend)? {
            last = None;
            d.fill(0.0);
        }
    }
    Ok(p)
}

impl<const D: usize> Face<'_, D> {
    /// p and r of a state.
    fn begin(&self, sites: &Sites<D>, from: &Outcome<D>) -> Result<(Vec<f64>, Vec<f64>)> {
        let told = from.tractions.iter().zip(sites).map(|(t, site)| -site.normal.dot(t));
        let (mut p, mut pulls): (Vec<f64>, Vec<f64>) = told.map(|p| (p.max(0.0), p.min(0.0))).unzip();
        let overlaps = from.motions.iter().zip(sites).map(|(motion, site)| site.relative(motion).overlap);
        let mut r: Vec<f64> =
            overlaps.zip(p.iter().zip(&pulls)).map(|(o, (p, pull))| o - self.give * (p + pull)).collect();
        if self.team.any(pulls.iter().any(|pull| *pull != 0.0)) {
            self.yield_under(&mut pulls)?;
            r.iter_mut().zip(&pulls).for_each(|(r, pull)| *r += pull);
        }
        p.iter_mut().for_each(|p| *p = p.max(0.0));
        Ok((p, r))
    }

    /// The norms of G and of t.
    fn norms(&self, p: &[f64], r: &[f64]) -> (f64, f64) {
        let (mut left, mut size) = (0.0, 0.0);
        for (p, r) in p.iter().zip(r) {
            let met = self.stiff * (p + self.rho * (r + self.give * p)).max(0.0);
            left += (p - met) * (p - met);
            size += p * p;
        }
        let [left, size] = self.team.sum([left, size]);
        ((self.weight * left).sqrt(), (self.weight * size).sqrt())
    }

    fn compliance(&self, wave: usize) -> f64 {
        self.per_traction * self.kernel.entry(wave, D - 1, D - 1) + self.give
    }

    /// z = (C + 1/alpha)^-1 z on the whole face.
    fn precondition(&self, z: &mut [f64]) -> Result<()> {
        self.transform.filter_last(z, |wave| 1.0 / self.compliance(wave))
    }

    /// q = (C + 1/alpha) q
    fn yield_under(&self, q: &mut [f64]) -> Result<()> {
        self.transform.filter_last(q, |wave| self.compliance(wave))
    }

    /// p and r a step along d; `q` is (C + 1/alpha) d and may be overwritten. Whether the directions go on from here.
    fn advance(&self, (p, r): (&mut [f64], &mut [f64]), (d, q): (&[f64], &mut [f64]), length: f64) -> Result<bool> {
        if self.team.all_say(p.iter().zip(d).all(|(p, d)| p + length * d >= 0.0)) {
            for (((p, r), d), q) in p.iter_mut().zip(r.iter_mut()).zip(d).zip(q.iter()) {
                (*p, *r) = (*p + length * d, *r - length * q);
            }
            return Ok(true);
        }
        // What is cut off.
        let mut change: Vec<f64> = p.iter().zip(d).map(|(p, d)| -(p + length * d).min(0.0)).collect();
        self.yield_under(&mut change)?;
        let (mut rise, mut fall) = (0.0, 0.0);
        for (i, change) in change.iter().enumerate() {
            let gone = (p[i] + length * d[i]).max(0.0) - p[i];
            q[i] = r[i] - length * q[i] - change;
            (rise, fall) = (rise - 0.5 * gone * (r[i] + q[i]), fall + (gone * r[i]).abs());
        }
        let [rise, fall] = self.team.sum([rise, fall]);
        if rise <= RISE * fall {
            p.iter_mut().zip(d).for_each(|(p, d)| *p = (*p + length * d).max(0.0));
            r.copy_from_slice(q);
            return Ok(true);
        }
        let softest = (0..self.kernel.len()).map(|wave| self.compliance(wave)).fold(0.0, f64::max);
        let [softest] = self.team.most([softest]);
        let mut gone: Vec<f64> = p.iter().zip(r.iter()).map(|(p, r)| (p + r / softest).max(0.0) - p).collect();
        p.iter_mut().zip(&gone).for_each(|(p, gone)| *p += gone);
        self.yield_under(&mut gone)?;
        r.iter_mut().zip(&gone).for_each(|(r, q)| *r -= q);
        Ok(false)
    }
}
