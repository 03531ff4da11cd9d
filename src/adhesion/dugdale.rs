//! sigma = sigma_0 up to the range, from where it falls straight to 0, over a share of the range.

use super::{Law, Pull};

/// sigma_0 = w/range; with the fall as steep as it is wide, the integral is that of a step at the range.
///
/// With a step a node lets go all at once, and the front of a contact is held by one node until the next takes over: the coarser
/// the cells, the more it then takes to pull off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dugdale {
    /// w, J/m^2.
    pub work: f64,
    /// m
    pub range: f64,
}

/// How far before and behind the range the fall begins and ends, over the range.
pub const HALF: f64 = 0.2;

impl Law for Dugdale {
    fn work(&self) -> f64 {
        self.work
    }

    fn strength(&self) -> f64 {
        self.work / self.range
    }

    fn reach(&self) -> f64 {
        (1.0 + HALF) * self.range
    }

    fn steepest_fall(&self) -> f64 {
        self.strength() / (2.0 * HALF * self.range)
    }

    fn pull(&self, gap: f64) -> Pull {
        let left = self.reach() - gap;
        let fall = self.steepest_fall();
        match left < 2.0 * HALF * self.range {
            true => Pull { value: fall * left, by_gap: -fall, spent: self.work - 0.5 * fall * left * left },
            false => Pull { value: self.strength(), by_gap: 0.0, spent: self.strength() * gap },
        }
    }
}
