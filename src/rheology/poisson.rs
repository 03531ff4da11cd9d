//! The Poisson ratio of a solid whose shear and bulk moduli relax.
//!
//! nu(t) here is that of an elastic solid with the moduli of time t, G(t) and K(t): the quasi-elastic ratio,
//!
//! ```text
//! nu(t) = (3 K(t) - 2 G(t)) / (6 K(t) + 2 G(t))
//! ```
//!
//! It is exact at t = 0 and for t -> infinity, and at every t where it is constant. It describes the material; the
//! solver takes G(t) and K(t) themselves, never nu(t).

use super::band::Band;
use super::prony::Prony;

/// Two relaxing moduli and the ratio that they begin with.
#[derive(Debug, Clone, PartialEq)]
pub struct Poisson {
    /// nu(0), in (-1, 0.5).
    pub instantaneous: f64,
    /// G(t)/G(0).
    pub shear: Prony,
    /// K(t)/K(0).
    pub bulk: Prony,
}

impl Poisson {
    /// nu at t >= 0 s, infinity included. Where both moduli have relaxed to nothing it is that of the slowest arms.
    pub fn at(&self, t: f64) -> f64 {
        // Both moduli times exp(t / slowest), so that the ratio survives where they do not.
        let slowest = self.slowest_rate();
        let left = |series: &Prony| {
            let arms = series.arms.iter().map(|arm| match 1.0 / arm.time - slowest {
                rate if rate > 0.0 => arm.weight * if t == 0.0 { 1.0 } else { (-t * rate).exp() },
                _ => arm.weight,
            });
            arms.sum::<f64>() + if slowest > 0.0 { 0.0 } else { series.long_term() }
        };
        let nu = self.instantaneous;
        let stiffness = 2.0 * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)) * left(&self.bulk);
        let shear = left(&self.shear);
        (3.0 * stiffness - 2.0 * shear) / (6.0 * stiffness + 2.0 * shear)
    }

    /// The first of 0 and some times of `band` at which nu is not inside (-1, 0.5), but for round-off, and nu there.
    pub fn leaves(&self, band: Band) -> Option<(f64, f64)> {
        const MARGIN: f64 = 1e-12;
        let times = std::iter::once(0.0).chain(band.samples(400));
        times.map(|t| (t, self.at(t))).find(|(_, nu)| !(*nu > -1.0 + MARGIN && *nu < 0.5 - MARGIN))
    }

    /// 1/s: zero unless both moduli relax to nothing, and then that of the slowest arm of either.
    fn slowest_rate(&self) -> f64 {
        if self.shear.long_term() > 0.0 || self.bulk.long_term() > 0.0 {
            return 0.0;
        }
        self.shear.arms.iter().chain(&self.bulk.arms).map(|arm| 1.0 / arm.time).fold(f64::INFINITY, f64::min)
    }
}
