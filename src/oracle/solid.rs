//! An isotropic viscoelastic solid: complex moduli at a frequency from (weight, time) pairs.

use nalgebra::Complex;

/// What stays constant while the shear modulus relaxes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoissonRule {
    /// Poisson ratio constant: the bulk modulus relaxes like the shear modulus.
    ConstantRatio,
    /// Bulk modulus constant (elastic): the Poisson ratio grows as the shear modulus relaxes.
    ConstantBulkModulus,
}

/// Shear modulus (Pa) and Poisson ratio at one frequency; real for an elastic solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moduli {
    /// Shear modulus, Pa.
    pub shear: Complex<f64>,
    /// Poisson ratio.
    pub poisson: Complex<f64>,
}

impl Moduli {
    /// An elastic solid, shear modulus in Pa.
    pub fn elastic(shear: f64, poisson: f64) -> Self {
        Self { shear: shear.into(), poisson: poisson.into() }
    }

    /// An elastic solid from its Young modulus, Pa: G = E/(2(1 + nu)).
    pub fn from_young(young: f64, poisson: f64) -> Self {
        Self::elastic(young / (2.0 * (1.0 + poisson)), poisson)
    }
}

/// G(t) = G_inst [mu_0 + sum mu_i exp(-t/tau_i)], mu_0 = 1 - sum mu_i, with a rule for the Poisson ratio.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// Instantaneous shear modulus G_inst, Pa.
    pub shear: f64,
    /// Instantaneous Poisson ratio.
    pub poisson: f64,
    /// What the bulk modulus does.
    pub rule: PoissonRule,
    /// (weight mu_i, relaxation time tau_i in s); empty = elastic.
    pub arms: Vec<(f64, f64)>,
}

impl Solid {
    /// mu_0 = 1 - sum mu_i.
    pub fn long_term(&self) -> f64 {
        1.0 - self.arms.iter().map(|&(weight, _)| weight).sum::<f64>()
    }

    /// G*(w)/G_inst = mu_0 + sum mu_i i w tau_i/(1 + i w tau_i); w in rad/s, of either sign, up to infinity.
    ///
    /// Written as 1 - sum mu_i/(1 + i w tau_i): the same thing, with nothing that overflows.
    pub fn relative_shear(&self, w: f64) -> Complex<f64> {
        let lost = |&(weight, time): &(f64, f64)| {
            let x = w * time;
            // 1/(1 + ix) = (1 - ix)/(1 + x^2), through hypot so that x = 1e300 gives 0 and not 0 x infinity.
            let r = 1.0 / 1f64.hypot(x);
            let angle = -x.atan();
            weight * Complex::from_polar(r, angle)
        };
        Complex::from(1.0) - self.arms.iter().map(lost).sum::<Complex<f64>>()
    }

    /// The complex moduli at angular frequency w, rad/s.
    ///
    /// Constant bulk modulus: K = 2 G_inst (1 + nu)/(3 (1 - 2 nu)) and nu*(w) = (3K - 2G*)/(2 (3K + G*)), written with
    /// G*/K so that an incompressible solid (1/K = 0) stays so.
    pub fn moduli(&self, w: f64) -> Moduli {
        let relative = self.relative_shear(w);
        let poisson = match self.rule {
            PoissonRule::ConstantRatio => self.poisson.into(),
            PoissonRule::ConstantBulkModulus => {
                let shear_over_bulk = relative * (1.5 * (1.0 - 2.0 * self.poisson) / (1.0 + self.poisson));
                (3.0 - 2.0 * shear_over_bulk) / (2.0 * (3.0 + shear_over_bulk))
            }
        };
        Moduli { shear: self.shear * relative, poisson }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod tests {
    use super::*;

    fn solid(rule: PoissonRule) -> Solid {
        Solid { shear: 568.498, poisson: 0.3, rule, arms: vec![(0.4, 0.817), (0.3, 5.0)] }
    }

    /// Against the transform of the relaxation function: G*(w) = G(0) + integral of G'(t) e^{-iwt} dt, by quadrature.
    #[test]
    fn complex_modulus_is_the_transform_of_the_relaxation() {
        let (s, w) = (solid(PoissonRule::ConstantRatio), 0.9);
        let rate = |t: f64| -s.arms.iter().map(|&(m, tau)| m / tau * (-t / tau).exp()).sum::<f64>();
        let n = 400_000;
        let dt = 200.0 / f64::from(n);
        let sum: Complex<f64> = (0..n)
            .map(|i| {
                let t = (f64::from(i) + 0.5) * dt;
                rate(t) * Complex::from_polar(1.0, -w * t) * dt
            })
            .sum();
        assert!((s.relative_shear(w) - (1.0 + sum)).norm() < 1e-6);
        // The other sign of the frequency gives the conjugate.
        assert!((s.relative_shear(-w) - s.relative_shear(w).conj()).norm() < 1e-15);
    }

    #[test]
    fn ends_of_the_spectrum() {
        let s = solid(PoissonRule::ConstantBulkModulus);
        assert!((s.moduli(0.0).shear.re - 0.3 * 568.498).abs() < 1e-10);
        for w in [1e300, f64::INFINITY] {
            assert!((s.moduli(w).shear - 568.498).norm() < 1e-10 && (s.moduli(w).poisson - 0.3).norm() < 1e-14);
        }
        // K is the same at both ends: 2 G (1 + nu)/(3 (1 - 2 nu)).
        let bulk = |m: Moduli| 2.0 * m.shear * (1.0 + m.poisson) / (3.0 * (1.0 - 2.0 * m.poisson));
        assert!((bulk(s.moduli(0.0)) / bulk(s.moduli(f64::INFINITY)) - 1.0).norm() < 1e-13);
        assert!((bulk(s.moduli(0.7)) / bulk(s.moduli(f64::INFINITY)) - 1.0).norm() < 1e-13);
        let incompressible = Solid { poisson: 0.5, ..s };
        assert_eq!(incompressible.moduli(0.7).poisson, Complex::from(0.5));
    }
}
