//! The power law of soft matter, and its approximation by a Prony series over a band.
//!
//! A spring-pot (Di Paola, Pirrotta and Valenza, Mech. Mater. 43 (2011) 799) relaxes without a time of its own; Bonari
//! and Paggi (2020), Eq. (11):
//!
//! ```text
//! E_f(t)  = c t^-a / Gamma(1 - a)                     c: Pa s^a, 0 < a < 1
//! E_f*(w) = c (i w)^a = c w^a [cos(pi a/2) + i sin(pi a/2)]
//! ```
//!
//! The gamma function belongs to Eq. (11): with it, and with G = E/2, the paper's Table 1 comes out to every digit.

use nalgebra::Complex;

use super::Band;
use super::fit::{self, Residuals, Samples};
use super::prony::Prony;
use crate::error::{Error, Result};

/// The power law E_f(t) = modulus t^-order / Gamma(1 - order); Eq. (11).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fractional {
    /// c, Pa s^order, > 0; the paper's is that of Young's modulus.
    pub modulus: f64,
    /// a, in (0, 1): towards 0 a spring, towards 1 a dashpot.
    pub order: f64,
}

/// A Prony series in place of the power law over a band of times.
#[derive(Debug, Clone, PartialEq)]
pub struct Approximation {
    /// M(0) of the series, Pa; the power law itself has none.
    pub instantaneous: f64,
    /// The series.
    pub series: Prony,
    /// The largest relative deviation from the power law over the band.
    pub max_error: f64,
}

impl Fractional {
    /// The power law; refused unless modulus > 0 and 0 < order < 1.
    pub fn new(modulus: f64, order: f64) -> Result<Self> {
        if modulus > 0.0 && modulus.is_finite() && order > 0.0 && order < 1.0 {
            Ok(Self { modulus, order })
        } else {
            Err(Error::Domain(format!(
                "a power law needs modulus > 0 and 0 < order < 1; modulus {modulus}, order {order} are none"
            )))
        }
    }

    /// E_f(t), Pa, at t > 0 s.
    pub fn relaxation(self, t: f64) -> f64 {
        self.modulus * t.powf(-self.order) / libm::tgamma(1.0 - self.order)
    }

    /// E_f*(w), Pa, at w > 0 rad/s: the real part is the storage modulus, the imaginary part the loss modulus.
    pub fn complex_modulus(self, w: f64) -> Complex<f64> {
        Complex::from_polar(self.modulus * w.powf(self.order), std::f64::consts::FRAC_PI_2 * self.order)
    }

    /// The Prony series of `arms` arms that stays closest to E_f over `band`, with its largest relative error there:
    /// least squares on ln E at times that crowd towards the ends, which comes close to the smallest largest error.
    /// The order 0.226 takes 5 arms for 1 % over four decades.
    pub fn approximate(self, band: Band, arms: usize) -> Result<Approximation> {
        // The error swings some 2 arms + 2 times; about six samples see each swing.
        let count = (12 * arms).max((12.0 * band.decades()) as usize) + 20;
        let time = band.chebyshev(count);
        let modulus = time.iter().map(|&t| self.relaxation(t)).collect();
        let fit = fit::identify(&Samples::relaxation(time, modulus), arms, Residuals::Relative, None)?;
        let error = |t: f64| (fit.instantaneous * fit.series.relaxation(t) / self.relaxation(t) - 1.0).abs();
        let max_error = band.samples(8 * count).into_iter().map(error).fold(0.0, f64::max);
        Ok(Approximation { instantaneous: fit.instantaneous, series: fit.series, max_error })
    }
}
