//! Coulomb's law regularised by the slip rate.

use super::{Circumstances, Law, Shear};

/// |q| = f p tanh(m/(eps dt)), Bonari and Paggi (2020), Eq. (4): sticks by creeping at a slip rate below eps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoulombTanh {
    /// Coefficient of friction f, -.
    pub coefficient: f64,
    /// Slip rate eps over which the direction turns, m/s.
    pub regularisation: f64,
}

impl CoulombTanh {
    /// m/(eps dt), with eps dt as far as it can be resolved.
    fn argument(&self, at: Circumstances, slip: f64) -> f64 {
        slip / self.length(at)
    }

    /// eps dt, m
    fn length(&self, at: Circumstances) -> f64 {
        (self.regularisation * at.dt).max(at.resolution)
    }
}

impl Law for CoulombTanh {
    fn coefficient(&self) -> f64 {
        self.coefficient
    }

    fn shear(&self, at: Circumstances, slip: f64) -> Shear {
        let x = self.argument(at, slip);
        let direction = x.tanh();
        // sech without the cancellation of 1 - tanh^2 and without overflow.
        let sech = if x > 350.0 { 0.0 } else { 1.0 / x.cosh() };
        Shear {
            shear: self.coefficient * at.pressure * direction,
            by_slip: self.coefficient * at.pressure * sech * sech / self.length(at),
            by_pressure: self.coefficient * direction,
        }
    }

    fn sharpness(&self, dt: f64) -> f64 {
        self.regularisation * dt
    }

    /// Where the slip rate is below eps, that is |q| < tanh(1) f p = 0.76 f p; it creeps meanwhile.
    fn sticks(&self, at: Circumstances, slip: f64) -> bool {
        self.argument(at, slip) < 1.0
    }
}
