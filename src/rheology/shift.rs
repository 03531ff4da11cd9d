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

/// The most decades by which [`Shift::log_within`] scales times, either way: what is slower has no time to move, and what is faster moves
/// at once.
pub const MOST_DECADES: f64 = 12.0;

impl Shift {
    /// T_ref, K
    pub fn reference(self) -> f64 {
        match self {
            Self::Wlf { reference, .. } | Self::Arrhenius { reference, .. } => reference,
        }
    }

    /// The same law from another reference temperature, K, where it holds: a_T over that there.
    #[must_use]
    pub fn from(self, temperature: f64) -> Self {
        match self {
            Self::Wlf { reference, c1, c2 } if temperature != reference => {
                let c = c2 + temperature - reference;
                Self::Wlf { reference: temperature, c1: c1 * c2 / c, c2: c }
            }
            Self::Wlf { .. } => self,
            Self::Arrhenius { activation_energy, .. } => Self::Arrhenius { reference: temperature, activation_energy },
        }
    }

    /// ln a_T, within [`MOST_DECADES`]; at and below the pole of the WLF law, and at no temperature at all, the longest times.
    pub fn log_within(self, temperature: f64) -> f64 {
        let most = MOST_DECADES * std::f64::consts::LN_10;
        match self {
            Self::Wlf { reference, c2, .. } if temperature - reference <= -c2 => most,
            Self::Arrhenius { .. } if temperature <= 0.0 => most,
            _ => self.log(temperature).clamp(-most, most),
        }
    }

    /// ln a_T
    fn log(self, temperature: f64) -> f64 {
        match self {
            Self::Wlf { reference, c1, c2 } => {
                let above = temperature - reference;
                -std::f64::consts::LN_10 * c1 * above / (c2 + above)
            }
            Self::Arrhenius { reference, activation_energy } => {
                activation_energy / GAS_CONSTANT * (1.0 / temperature - 1.0 / reference)
            }
        }
    }

    /// a_T at `temperature` (K): finite and > 0, or the law does not hold there.
    pub fn factor(self, temperature: f64) -> Result<f64> {
        if !(temperature > 0.0 && temperature.is_finite()) {
            return Err(Error::Domain(format!("a temperature of {temperature} K; it must be above 0 K")));
        }
        if let Self::Wlf { reference, c2, .. } = self
            && c2 + (temperature - reference) <= 0.0
        {
            // At T_ref - c2 the law has its pole (the Vogel temperature): nothing flows below it.
            return Err(Error::Domain(format!(
                "the WLF law holds only above {:.2} K (reference - c2); the temperature is {temperature} K",
                reference - c2
            )));
        }
        let log = self.log(temperature);
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const WLF: Shift = Shift::Wlf { reference: 293.0, c1: 17.44, c2: 51.6 };
    const ARRHENIUS: Shift = Shift::Arrhenius { reference: 293.0, activation_energy: 8e4 };

    /// From another reference a law is the same over its factor there, to round-off; from its own, to the last bit.
    #[test]
    fn a_law_has_any_reference() {
        for law in [WLF, ARRHENIUS] {
            assert_eq!(law.from(293.0), law);
            let other = law.from(310.0);
            assert_eq!((other.log_within(310.0), other.from(310.0), other.reference()), (0.0, other, 310.0));
            for temperature in [280.0, 293.0, 330.0] {
                let exact = law.log_within(temperature) - law.log_within(310.0);
                assert!((other.log_within(temperature) - exact).abs() < 1e-13 * exact.abs().max(1.0));
                assert!((law.log_within(temperature).exp() / law.factor(temperature).unwrap() - 1.0).abs() < 1e-15);
            }
        }
    }

    /// Within twelve decades, whatever the temperature; it falls as that rises.
    #[test]
    fn no_temperature_is_out_of_range() {
        for law in [WLF, ARRHENIUS] {
            let most = 12.0 * std::f64::consts::LN_10;
            let logs = [-1.0, 0.0, 241.4, 241.5, 280.0, 293.0, 300.0, 1e3, 1e9].map(|t| law.log_within(t));
            assert!(
                logs.windows(2).all(|pair| pair[0] >= pair[1]) && logs.iter().all(|log| log.abs() <= most),
                "{logs:?}"
            );
            assert_eq!(logs[..2], [most; 2]);
        }
    }
}
