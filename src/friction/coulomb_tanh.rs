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
    pub(super) fn shear(&self, pressure: f64, slip: Slip) -> Shear {
        let (Slip { rate, dt, stuck, .. }, sharpness) = (slip, self.sharpness(slip));
        let x = rate / sharpness;
        let direction = x.tanh();
        let sech = self.sech(slip);
        let sticks = x.abs() < 1.0;
        Shear {
            shear: self.coefficient * pressure * direction,
            by_pressure: self.coefficient * direction,
            by_rate: self.coefficient * pressure * sech * sech / sharpness,
            stuck: if sticks { stuck + rate * dt } else { 0.0 },
            sticks,
        }
    }

    /// It creeps on; at a turn of the indenter it sticks. From the steep side of the law Newton's method lets point after
    /// point slip; from the flat side it does not find back.
    pub(super) fn expected(&self, slip: Slip, drive: f64) -> Option<f64> {
        if drive * slip.rate < 0.0 {
            return Some(0.0);
        }
        (self.sech(slip).powi(2) > 1e-6).then_some(slip.rate)
    }

    /// Which way a point slips that the law does not answer to any more; 0 where it does.
    pub(super) fn direction(&self, slip: Slip) -> f64 {
        if slip.rate.abs() < self.sharpness(slip) { 0.0 } else { slip.rate.signum() }
    }

    /// eps as far as it can be resolved, m/s.
    pub(super) fn sharpness(&self, slip: Slip) -> f64 {
        self.regularisation.max(slip.resolution)
    }

    /// sech(w / eps), without the cancellation of 1 - tanh^2 and without overflow.
    fn sech(&self, slip: Slip) -> f64 {
        let x = slip.rate / self.sharpness(slip);
        if x.abs() > 350.0 { 0.0 } else { 1.0 / x.cosh() }
    }
}
