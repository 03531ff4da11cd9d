//! Friction laws: pressure and slip rate in, shear traction and its derivatives out.

/// A friction law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Friction {
    /// Regularised Coulomb, Eq. (4).
    CoulombTanh(CoulombTanh),
}

/// The shear traction and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shear {
    /// q, Pa, on the layer; it has the sign of the slip rate.
    pub shear: f64,
    /// dq/dp at constant slip rate.
    pub by_pressure: f64,
    /// dq/dw at constant pressure, Pa s/m.
    pub by_rate: f64,
}

/// q = f p tanh(w / eps), Bonari and Paggi (2020), Eq. (4): sticks by creeping at a slip rate below eps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoulombTanh {
    /// Coefficient of friction f, -.
    pub coefficient: f64,
    /// Slip rate eps over which the direction turns, m/s.
    pub regularisation: f64,
}

impl Friction {
    /// The law of Eq. (4).
    pub fn coulomb_tanh(coefficient: f64, regularisation: f64) -> Self {
        Self::CoulombTanh(CoulombTanh { coefficient, regularisation })
    }

    /// The traction at pressure p >= 0, Pa, and slip rate w, m/s.
    pub fn shear(&self, pressure: f64, slip_rate: f64) -> Shear {
        match self {
            Self::CoulombTanh(law) => law.shear(pressure, slip_rate),
        }
    }

    /// Whether a point at slip rate w sticks: |w| < eps, that is |q| < tanh(1) f p = 0.76 f p.
    pub fn sticks(&self, slip_rate: f64) -> bool {
        match self {
            Self::CoulombTanh(law) => slip_rate.abs() < law.regularisation,
        }
    }
}

impl CoulombTanh {
    fn shear(&self, pressure: f64, slip_rate: f64) -> Shear {
        let x = slip_rate / self.regularisation;
        let direction = x.tanh();
        // sech^2, without the cancellation of 1 - tanh^2 and without overflow.
        let sech = if x.abs() > 350.0 { 0.0 } else { 1.0 / x.cosh() };
        Shear {
            shear: self.coefficient * pressure * direction,
            by_pressure: self.coefficient * direction,
            by_rate: self.coefficient * pressure * sech * sech / self.regularisation,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// |q| <= f p, q odd in w, and finite at any slip rate.
    #[test]
    fn bounded_by_coulomb_and_odd() {
        let law = Friction::coulomb_tanh(0.2, 1e-6);
        for w in [0.0, 1e-300, 1e-9, 1e-6, 1e-3, 1.0, 1e9, f64::MAX] {
            let (plus, minus) = (law.shear(3.0, w), law.shear(3.0, -w));
            assert!(plus.shear <= 0.2 * 3.0 && plus.shear == -minus.shear);
            assert!(plus.by_rate >= 0.0 && plus.by_rate.is_finite() && plus.by_rate == minus.by_rate);
        }
    }
}
