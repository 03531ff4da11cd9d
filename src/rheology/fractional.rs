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
//! The gamma function belongs to Eq. (11): with it, and with G = E/2, the paper's Table 1 comes out to every
//! digit but one (the first weight of three arms: 0.3095, printed 0.310).

use nalgebra::Complex;

use super::fit::{self, Residuals, Samples};
use super::prony::{Arm, Prony};
use super::{Band, Loading};
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
    /// The largest relative deviation from the power law: of the modulus over a band, or of the forces of a loading.
    pub max_error: f64,
}

impl Approximation {
    /// The integral of M from 0 to t >= 0 s, Pa s.
    fn integral(&self, t: f64) -> f64 {
        self.instantaneous * self.series.integral(t)
    }

    /// With one arm more, of a time (s), so that the integral of M from 0 to `t` grows by `area`, Pa s.
    fn with(self, time: f64, area: f64, t: f64) -> Self {
        let added = -area / (time * (-t / time).exp_m1());
        let instantaneous = self.instantaneous + added;
        let known = self.series.arms.iter();
        let known = known.map(|arm| Arm { weight: arm.weight * self.instantaneous / instantaneous, time: arm.time });
        let arms = std::iter::once(Arm { weight: added / instantaneous, time }).chain(known).collect();
        Self { instantaneous, series: Prony { arms }, max_error: self.max_error }
    }
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

    /// The integral of E_f from 0 to t, Pa s: c t^(1-a) / Gamma(2 - a), the force of a ramp of the rate 1.
    pub fn integral(self, t: f64) -> f64 {
        self.modulus * t.powf(1.0 - self.order) / libm::tgamma(2.0 - self.order)
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
        let found = Approximation { instantaneous: fit.instantaneous, series: fit.series, max_error: 0.0 };
        Ok(Approximation { max_error: self.largest_error(&found, band, 8 * count), ..found })
    }

    /// The Prony series of `arms` arms for a loading history, with the largest error of the forces that its ramps take.
    ///
    /// A ramp asks for all times down to 0, where the power law has no end, but only for its integral up to the first
    /// step h. So one arm, much faster than h, makes that integral exact, and the others follow E_f from h/3 on. Where
    /// nothing is loaded all follow E_f, and the error is that of E_f over the band.
    pub fn under(self, loading: &Loading, arms: usize) -> Result<Approximation> {
        if loading.is_idle() {
            return self.approximate(loading.band, arms);
        }
        let h = loading.band.from;
        let slow = self.approximate(Band::new(h / 3.0, loading.band.to)?, arms.max(2) - 1)?;
        let missing = self.integral(h) - slow.integral(h);
        // Of such an arm exp(-10) is left after the first step.
        let series = if arms > 1 && missing > 0.0 { slow.with(h / 10.0, missing, h) } else { slow };
        let max_error = loading.force_error(|t| series.integral(t), |t| self.integral(t));
        Ok(Approximation { max_error, ..series })
    }

    /// The fewest arms whose forces are within `error`, of at most `most`.
    pub fn within(self, error: f64, loading: &Loading, most: usize) -> Result<Approximation> {
        for arms in 2..most {
            let found = self.under(loading, arms)?;
            if found.max_error <= error {
                return Ok(found);
            }
        }
        self.under(loading, most)
    }

    /// Of M, relative, at `count` times of a band.
    fn largest_error(self, series: &Approximation, band: Band, count: usize) -> f64 {
        let error = |t: f64| (series.instantaneous * series.series.relaxation(t) / self.relaxation(t) - 1.0).abs();
        band.samples(count).into_iter().map(error).fold(0.0, f64::max)
    }
}
