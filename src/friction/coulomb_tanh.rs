//! Coulomb's law regularised by the slip rate.

use super::{Shear, Slip};

/// q = f p tanh(w / eps), Bonari and Paggi (2020), Eq. (4): sticks by creeping at a slip rate below eps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoulombTanh {
    /// Coefficient of friction f, -.
    pub coefficient: f64,
    /// Slip rate eps over which the direction turns, m/s.
    pub regularisation: f64,
}

impl CoulombTanh {
    /// A point sticks where |w| < eps, that is |q| < tanh(1) f p = 0.76 f p, and creeps meanwhile; `stuck` is the slip
    /// since it began to.
    pub(super) fn shear(&self, pressure: f64, Slip { rate, dt, stuck }: Slip) -> Shear {
        let x = rate / self.regularisation;
        let direction = x.tanh();
        let sech = self.sech(rate);
        let sticks = x.abs() < 1.0;
        Shear {
            shear: self.coefficient * pressure * direction,
            by_pressure: self.coefficient * direction,
            by_rate: self.coefficient * pressure * sech * sech / self.regularisation,
            stuck: if sticks { stuck + rate * dt } else { 0.0 },
            sticks,
        }
    }

    /// It creeps on; at a turn of the indenter it sticks. From the steep side of the law Newton's method lets point after
    /// point slip; from the flat side it does not find back.
    pub(super) fn expected(&self, Slip { rate, .. }: Slip, drive: f64) -> Option<f64> {
        if drive * rate < 0.0 {
            return Some(0.0);
        }
        (self.sech(rate).powi(2) > 1e-6).then_some(rate)
    }

    /// Which way a point slips that the law does not answer to any more; 0 where it does.
    pub(super) fn direction(&self, Slip { rate, .. }: Slip) -> f64 {
        if rate.abs() < self.regularisation { 0.0 } else { rate.signum() }
    }

    /// sech(w / eps), without the cancellation of 1 - tanh^2 and without overflow.
    fn sech(&self, rate: f64) -> f64 {
        let x = rate / self.regularisation;
        if x.abs() > 350.0 { 0.0 } else { 1.0 / x.cosh() }
    }
}
