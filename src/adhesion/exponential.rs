//! sigma = sigma_0 exp(-g/range).

use super::{Law, Pull};

/// sigma_0 = w/range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exponential {
    /// w, J/m^2.
    pub work: f64,
    /// m
    pub range: f64,
}

/// The reach over the range: what is left of sigma there, 2e-16 of sigma_0, no digit of a sum sees.
const REACH: f64 = 36.0;

impl Law for Exponential {
    fn work(&self) -> f64 {
        self.work
    }

    fn strength(&self) -> f64 {
        self.work / self.range
    }

    fn reach(&self) -> f64 {
        REACH * self.range
    }

    fn steepest_fall(&self) -> f64 {
        self.strength() / self.range
    }

    fn pull(&self, gap: f64) -> Pull {
        let value = self.strength() * (-gap / self.range).exp();
        Pull { value, by_gap: -value / self.range, spent: -self.work * (-gap / self.range).exp_m1() }
    }
}
