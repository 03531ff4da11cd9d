//! Friction laws: pressure and slip in, shear traction and its derivatives out, all of them scalars.
//!
//! A point slips by a vector s over a step: what it slips in the step, and before that what the law still holds elastically.
//! With m = |s| >= 0 a law gives |q|(m, p) = B phi, B what the point bears ([`Strength`]) and phi what share of it the slip calls
//! up, from 0 to 1, which does not fall with m; B may. The traction is q = |q| s/m, whatever the dimension. A new law is a file with
//! an `impl Law` and its [`Kind`], and a line in [`KINDS`].

mod coulomb;
mod coulomb_tanh;
mod elastic_slip;
mod kind;
mod rebound;
mod strength;

pub use coulomb::Coulomb;
pub use coulomb_tanh::CoulombTanh;
pub use elastic_slip::ElasticSlip;
pub use kind::{KINDS, Kind, Softness};
pub use rebound::Rebound;
pub use strength::{Bound, Coefficient, Lasting, Strength, TEMPERATURE, VARIABLES};

/// What a point answers in: its pressure, its step and its past.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circumstances {
    /// p >= 0, Pa.
    pub pressure: f64,
    /// The length of the step, s.
    pub dt: f64,
    /// Slips, m, that are too short to tell apart; 0 where the slip is known to all its digits.
    pub resolution: f64,
    /// What the point has slid, without what is elastic, up to the step, m.
    pub slid: f64,
    /// At the beginning of the step, K; any number where nobody tells.
    pub temperature: f64,
}

/// phi and its derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// -
    pub value: f64,
    /// d phi/dm, 1/m, at least 0; infinite where the law lets nothing slip.
    pub by_slip: f64,
}

/// The shear traction and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shear {
    /// |q|, Pa.
    pub shear: f64,
    /// d|q|/dm at constant pressure, Pa/m; infinite where the law lets nothing slip.
    pub by_slip: f64,
    /// d|q|/dp at constant slip.
    pub by_pressure: f64,
}

/// Where a law and a spring that pulls at the point come to rest: see [`Law::meet`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Met {
    /// m, m
    pub slip: f64,
    /// There.
    pub shear: Shear,
}

/// A friction law.
pub trait Law: std::fmt::Debug + Send + Sync {
    /// B
    fn strength(&self) -> &Strength;

    /// phi of a point that slips by `slip` = m >= 0, m.
    fn share(&self, at: Circumstances, slip: f64) -> Share;

    /// The m >= 0, m, over which |q| comes near B: what a step has to tell apart.
    fn sharpness(&self, dt: f64) -> f64;

    /// Whether a point that slips by `slip` sticks.
    fn sticks(&self, at: Circumstances, slip: f64) -> bool;

    /// Whether part of the slip is elastic: it is stored instead of dissipated, and what the next step begins with.
    fn holds(&self) -> bool {
        false
    }

    /// Whether a point that does not slip keeps the shear that it has, for as long as that is.
    fn rests(&self) -> bool {
        let strength = self.strength();
        (self.holds() || self.sharpness(1.0) == 0.0) && !strength.varies() && !strength.knows_temperature()
    }

    /// How much of the slip m is elastic, m.
    fn elastic(&self, _slip: f64) -> f64 {
        0.0
    }

    /// How much of the slip m is for good: what B knows as rate and distance.
    fn lasting(&self, slip: f64) -> Lasting {
        Lasting { length: slip, by_slip: 1.0 }
    }

    /// B of a point that slips by `slip`.
    fn bound(&self, at: Circumstances, slip: f64) -> Bound {
        self.strength().at(at, self.lasting(slip))
    }

    /// |q| of a point that slips by `slip`.
    fn shear(&self, at: Circumstances, slip: f64) -> Shear {
        let (Share { value, by_slip }, bound) = (self.share(at, slip), self.bound(at, slip));
        let rise = if by_slip.is_infinite() { by_slip } else { bound.value * by_slip + bound.by_slip * value };
        Shear { shear: bound.value * value, by_slip: rise, by_pressure: bound.by_pressure * value }
    }

    /// The m >= 0 where |q|(m) + rho m = `reach` (Pa), for rho > 0, Pa/m: the only one where |q| falls less steeply than rho
    /// rises. A law that lets nothing slip sticks up to B.
    fn meet(&self, at: Circumstances, reach: f64, rho: f64) -> Met {
        let (still, bound) = (self.shear(at, 0.0), self.bound(at, 0.0).value);
        if still.by_slip.is_infinite() && reach <= bound {
            return Met { slip: 0.0, shear: Shear { shear: reach, ..still } };
        }
        let least = ((reach - bound) / rho).max(reach / (still.by_slip + rho));
        let slip = match self.strength().varies() {
            false => from_below(self, (at, reach, rho), least),
            true => between(self, (at, reach, rho), least.min(reach / rho)),
        };
        let (shear, bound) = (self.shear(at, slip), self.bound(at, slip).value);
        Met { slip, shear: Shear { shear: met(reach, bound, rho * slip, shear.shear), ..shear } }
    }
}

/// Evaluations for one point at most.
const MOST: usize = 100;

/// By Newton's method from below, which does not overshoot where |q| is concave.
fn from_below(law: &(impl Law + ?Sized), (at, reach, rho): (Circumstances, f64, f64), mut slip: f64) -> f64 {
    for _ in 0..MOST {
        let shear = law.shear(at, slip);
        let more = (reach - shear.shear - rho * slip) / (shear.by_slip + rho);
        let next = (slip + more).max(0.0).min(reach / rho);
        // Newton's steps are upward until round-off turns them; a number that is none ends it, too.
        if next.partial_cmp(&slip) != Some(std::cmp::Ordering::Greater) {
            break;
        }
        slip = next;
    }
    slip
}

/// By Newton's method between bounds that close in, halving them where it leaves them.
fn between(law: &(impl Law + ?Sized), (at, reach, rho): (Circumstances, f64, f64), mut slip: f64) -> f64 {
    let [mut low, mut high] = [0.0, reach / rho];
    for _ in 0..MOST {
        let shear = law.shear(at, slip);
        let excess = shear.shear + rho * slip - reach;
        *if excess < 0.0 { &mut low } else { &mut high } = slip;
        let newton = slip - excess / (shear.by_slip + rho);
        let next = if low < newton && newton < high { newton } else { 0.5 * (low + high) };
        if next.is_nan() || (next - slip).abs() <= f64::EPSILON * slip {
            break;
        }
        slip = next;
    }
    slip
}

/// |q| to all digits: of reach - rho m none are left where the point slips, and of the law's own where it sticks.
fn met(reach: f64, bound: f64, spring: f64, law: f64) -> f64 {
    if reach > bound { law } else { (reach - spring).max(0.0).min(bound) }
}

#[cfg(test)]
mod tests;
