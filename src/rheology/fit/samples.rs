//! What was measured, and what one Maxwell arm would have given there.

use crate::rheology::Band;

/// The test that the data come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Test {
    /// A held strain: the relaxation modulus over time.
    Relaxation,
    /// A sinusoidal strain: storage and loss modulus over angular frequency.
    Dynamic,
}

/// Measured moduli. Abscissae ascend; moduli are finite and positive (a loss modulus may be 0).
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// The test.
    pub test: Test,
    /// Times, s, or angular frequencies, rad/s.
    pub at: Vec<f64>,
    /// Pa: the relaxation moduli, or all storage moduli and after them all loss moduli.
    pub values: Vec<f64>,
}

impl Samples {
    /// Relaxation moduli (Pa) at times (s).
    pub fn relaxation(time: Vec<f64>, modulus: Vec<f64>) -> Self {
        Self { test: Test::Relaxation, at: time, values: modulus }
    }

    /// Storage and loss moduli (Pa) at angular frequencies (rad/s).
    pub fn dynamic(frequency: Vec<f64>, storage: Vec<f64>, loss: Vec<f64>) -> Self {
        Self { test: Test::Dynamic, at: frequency, values: [storage, loss].concat() }
    }

    /// The same data with every modulus multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { values: self.values.iter().map(|value| value * factor).collect(), ..self.clone() }
    }

    /// The times that the data see: from the first positive one to the last, or 1/w; none if fewer than two.
    pub fn times(&self) -> Option<Band> {
        let mut positive = self.at.iter().copied().filter(|&at| at > 0.0);
        let (first, last) = (positive.next()?, positive.next_back()?);
        match self.test {
            Test::Relaxation => Band::new(first, last).ok(),
            Test::Dynamic => Band::new(1.0 / last, 1.0 / first).ok(),
        }
    }

    /// What a lone spring of unit modulus gives at each value.
    pub(super) fn spring(&self) -> Vec<f64> {
        let ones = vec![1.0; self.at.len()];
        match self.test {
            Test::Relaxation => ones,
            Test::Dynamic => [ones, vec![0.0; self.at.len()]].concat(),
        }
    }

    /// What an arm of unit modulus and relaxation time `time` gives at each value: exp(-x) with x = t/time, or
    /// x^2/(1+x^2) and x/(1+x^2) with x = w time.
    pub(super) fn arm(&self, time: f64) -> Vec<f64> {
        match self.test {
            Test::Relaxation => self.at.iter().map(|t| (-t / time).exp()).collect(),
            Test::Dynamic => {
                let storage = self.at.iter().map(|w| 1.0 / (1.0 + (w * time).powi(-2)));
                let loss = self.at.iter().map(|w| 1.0 / (w * time + 1.0 / (w * time)));
                storage.chain(loss).collect()
            }
        }
    }

    /// The derivative of [`Self::arm`] with respect to ln(time).
    pub(super) fn arm_slope(&self, time: f64) -> Vec<f64> {
        match self.test {
            Test::Relaxation => self.at.iter().map(|t| decay_slope(t / time)).collect(),
            Test::Dynamic => {
                // With s = x/(1+x^2): d(x^2/(1+x^2))/d ln x = 2 s^2 and d(x/(1+x^2))/d ln x = s (1-x^2)/(1+x^2).
                let loss = |w: f64| 1.0 / (w * time + 1.0 / (w * time));
                let storage_slope = self.at.iter().map(|&w| 2.0 * loss(w).powi(2));
                let loss_slope = self.at.iter().map(|&w| loss(w) * (1.0 - 2.0 / (1.0 + (w * time).powi(-2))));
                storage_slope.chain(loss_slope).collect()
            }
        }
    }
}

/// x exp(-x): 0 where x overflows, not infinity times nothing.
fn decay_slope(x: f64) -> f64 {
    if x > 745.0 { 0.0 } else { x * (-x).exp() }
}
