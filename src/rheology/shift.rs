//! Time-temperature superposition: at another temperature the times scale by one factor, the moduli do not.
//!
//! A thermo-rheologically simple solid relaxes at temperature T as it does at the reference temperature, with every
//! time multiplied by a_T(T): M(t; T) = M(t / a_T; T_ref). Below the reference a_T > 1: colder is slower.
//! Ferry, Viscoelastic Properties of Polymers, 3rd ed. (1980), ch. 11. Temperatures are in kelvin.

use super::prony::{Arm, Prony};
use crate::error::{Error, Result};

/// The molar gas constant, J/(mol K), exact since 2019.
pub const GAS_CONSTANT: f64 = 8.314_462_618_153_24;

/// How the relaxation times go with temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shift {
    /// Williams-Landel-Ferry: log10 a_T = -c1 (T - T_ref)/(c2 + T - T_ref), for T > T_ref - c2.
    Wlf {
        /// T_ref, K
        reference: f64,
        /// -
        c1: f64,
        /// K
        c2: f64,
    },
    /// Arrhenius: ln a_T = E_a/R (1/T - 1/T_ref).
    Arrhenius {
        /// T_ref, K
        reference: f64,
        /// E_a, J/mol
        activation_energy: f64,
    },
}

impl Shift {
    /// a_T at `temperature` (K): finite and > 0, or the law does not hold there.
    pub fn factor(self, temperature: f64) -> Result<f64> {
        if !(temperature > 0.0 && temperature.is_finite()) {
            return Err(Error::Domain(format!("a temperature of {temperature} K; it must be above 0 K")));
        }
        let log = match self {
            Self::Wlf { reference, c1, c2 } => {
                let above = temperature - reference;
                // At T_ref - c2 the law has its pole (the Vogel temperature): nothing flows below it.
                if c2 + above <= 0.0 {
                    return Err(Error::Domain(format!(
                        "the WLF law holds only above {:.2} K (reference - c2); the temperature is {temperature} K",
                        reference - c2
                    )));
                }
                -std::f64::consts::LN_10 * c1 * above / (c2 + above)
            }
            Self::Arrhenius { reference, activation_energy } => {
                activation_energy / GAS_CONSTANT * (1.0 / temperature - 1.0 / reference)
            }
        };
        let factor = log.exp();
        if factor > 0.0 && factor.is_finite() {
            Ok(factor)
        } else {
            Err(Error::Domain(format!(
                "the shift factor at {temperature} K is exp({log}), which no number of double precision holds"
            )))
        }
    }
}

impl Prony {
    /// The series whose times are `factor` times longer; the weights stay.
    #[must_use]
    pub fn with_times_scaled(&self, factor: f64) -> Self {
        Self { arms: self.arms.iter().map(|arm| Arm { weight: arm.weight, time: arm.time * factor }).collect() }
    }
}
