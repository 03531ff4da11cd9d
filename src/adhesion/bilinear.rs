//! sigma = sigma_0 (1 - g/range) up to the range.

use super::{Law, Pull};

/// sigma_0 = 2 w/range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bilinear {
    /// w, J/m^2.
    pub work: f64,
    /// m
    pub range: f64,
}

impl Law for Bilinear {
    fn work(&self) -> f64 {
        self.work
    }

    fn strength(&self) -> f64 {
        2.0 * self.work / self.range
    }

    fn reach(&self) -> f64 {
        self.range
    }

    fn steepest_fall(&self) -> f64 {
        self.strength() / self.range
    }

    fn pull(&self, gap: f64) -> Pull {
        let left = 1.0 - gap / self.range;
        let by_gap = -self.steepest_fall();
        Pull { value: self.strength() * left, by_gap, spent: self.work * (1.0 - left * left) }
    }
}
