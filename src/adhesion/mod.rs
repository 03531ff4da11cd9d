//! Adhesion: what the surfaces pull each other with across a gap. Gap in, traction and its derivative out, all of them scalars.
//!
//! A law gives sigma(g) >= 0, which does not rise with g >= 0, with integral of sigma dg = w, the work of adhesion, and sigma(0) =
//! sigma_0. The pressure of a point is then a function of its overlap o = -g that goes on without a jump into repulsion:
//!
//! ```text
//! p = -sigma(g)            where there is a gap
//! p >= -sigma_0            at g = 0, whatever bears it, without penetration; p = alpha o - sigma_0 with a penalty
//! ```
//!
//! so that a closed gap may be in tension. A new law is a file with an `impl Law`.

mod bilinear;
mod dugdale;
mod exponential;

use std::fmt::Debug;

pub use bilinear::Bilinear;
pub use dugdale::Dugdale;
pub use exponential::Exponential;

/// sigma at a gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pull {
    /// sigma, Pa.
    pub value: f64,
    /// d sigma/dg, Pa/m, at most 0.
    pub by_gap: f64,
    /// The integral of sigma from 0 to the gap, J/m^2.
    pub spent: f64,
}

/// A law of adhesion.
pub trait Law: Debug + Send + Sync {
    /// w, J/m^2.
    fn work(&self) -> f64;

    /// sigma_0, Pa.
    fn strength(&self) -> f64;

    /// The gap from which on sigma is 0, m.
    fn reach(&self) -> f64;

    /// How steeply sigma falls at most, Pa/m.
    fn steepest_fall(&self) -> f64;

    /// At a gap g >= 0, m, below the reach.
    fn pull(&self, gap: f64) -> Pull;

    /// At any gap g >= 0.
    fn at(&self, gap: f64) -> Pull {
        if gap < self.reach() { self.pull(gap) } else { Pull { value: 0.0, by_gap: 0.0, spent: self.work() } }
    }

    /// The potential of an overlap, J/m^2, 0 far apart: what is stored in the attraction; at most 0. The penalty is not in it.
    fn potential(&self, overlap: f64) -> f64 {
        match overlap < 0.0 {
            true => self.at(-overlap).spent - self.work(),
            false => -self.work() - self.strength() * overlap,
        }
    }
}

/// Where a point comes to rest whose p + rho o is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Met {
    /// p*, Pa.
    pub pressure: f64,
    /// o*, m.
    pub overlap: f64,
    /// theta = dp*/ds, and 1 - theta to all its digits; theta < 0 where sigma falls.
    pub stiff: f64,
    /// See `stiff`.
    pub soft: f64,
}

/// How close two gaps are that are one, over the larger.
const SAME: f64 = 4.0 * f64::EPSILON;
/// Evaluations at most.
const MOST: usize = 100;

/// The only p* and o* on the law's curve with p* + rho o* = s, for rho, Pa/m, above the steepest fall of sigma. `s` in Pa, the penalty
/// in Pa/m, none = no penetration.
pub fn meet(law: &dyn Law, penalty: Option<f64>, s: f64, rho: f64) -> Met {
    let closed = s + law.strength();
    if closed >= 0.0 {
        return match penalty {
            None => Met { pressure: s, overlap: 0.0, stiff: 1.0, soft: 0.0 },
            Some(alpha) => {
                let overlap = closed / (alpha + rho);
                let pressure = alpha * overlap - law.strength();
                Met { pressure, overlap, stiff: alpha / (alpha + rho), soft: rho / (alpha + rho) }
            }
        };
    }
    let gap = opened(law, -s, rho);
    let Pull { value, by_gap, .. } = law.at(gap);
    Met { pressure: -value, overlap: -gap, stiff: by_gap / (by_gap + rho), soft: rho / (by_gap + rho) }
}

/// g > 0 with sigma(g) + rho g = r > sigma_0: by Newton's method from above between bounds that close in.
fn opened(law: &dyn Law, r: f64, rho: f64) -> f64 {
    let mut gap = r / rho;
    if gap >= law.reach() {
        return gap;
    }
    let [mut low, mut high] = [(r - law.strength()) / rho, gap];
    for _ in 0..MOST {
        let Pull { value, by_gap, .. } = law.at(gap);
        let excess = value + rho * gap - r;
        *if excess < 0.0 { &mut low } else { &mut high } = gap;
        let newton = gap - excess / (rho + by_gap);
        let next = if low < newton && newton < high { newton } else { 0.5 * (low + high) };
        if excess == 0.0 || next.is_nan() || (next - gap).abs() <= SAME * gap {
            break;
        }
        gap = next;
    }
    gap
}

#[cfg(test)]
mod tests;
