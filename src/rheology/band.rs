//! A range of times or frequencies, cut into equal steps of its logarithm.

use crate::error::{Error, Result};

/// A range 0 < from < to, of times (s) or of angular frequencies (rad/s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// The lower end, > 0.
    pub from: f64,
    /// The upper end, > `from`.
    pub to: f64,
}

impl Band {
    /// The range from `from` to `to`; refused unless 0 < from < to, both finite.
    pub fn new(from: f64, to: f64) -> Result<Self> {
        if from > 0.0 && from < to && to.is_finite() {
            Ok(Self { from, to })
        } else {
            Err(Error::Domain(format!("a band needs 0 < from < to, both finite; {from} to {to} is none")))
        }
    }

    /// A band that reaches past this one by `factor` at both ends.
    #[must_use]
    pub fn widened(self, factor: f64) -> Self {
        Self { from: self.from / factor, to: self.to * factor }
    }

    /// log10(to/from).
    pub fn decades(self) -> f64 {
        self.to.log10() - self.from.log10()
    }

    /// `count` values in geometric progression, both ends among them and exact; the geometric mean if `count` is 1.
    pub fn samples(self, count: usize) -> Vec<f64> {
        if count == 1 {
            return vec![self.from.sqrt() * self.to.sqrt()];
        }
        let ratio = self.to.ln() - self.from.ln();
        (0..count)
            .map(|i| match i {
                0 => self.from,
                i if i + 1 == count => self.to,
                i => (self.from.ln() + ratio * i as f64 / (count - 1) as f64).exp(),
            })
            .collect()
    }

    /// `count` >= 2 values, both ends among them, whose logarithms crowd towards the ends as the extrema of a Chebyshev
    /// polynomial do.
    pub fn chebyshev(self, count: usize) -> Vec<f64> {
        let middle = 0.5 * (self.from.ln() + self.to.ln());
        let half = 0.5 * (self.to.ln() - self.from.ln());
        let angle = |i: usize| std::f64::consts::PI * i as f64 / (count - 1) as f64;
        let inside = (1..count - 1).map(|i| (middle - half * angle(i).cos()).exp());
        std::iter::once(self.from).chain(inside).chain([self.to]).collect()
    }

    /// `count` values in geometric progression strictly inside: the ends are left out.
    pub fn interior(self, count: usize) -> Vec<f64> {
        self.samples(count + 2)[1..=count].to_vec()
    }
}
