//! Surface compliance of an elastic layer bonded to a rigid base, plane strain, at one wavenumber.
//!
//! With s = |k| H and D = (3-4nu) cosh 2s + 2 s^2 + 5 - 12 nu + 8 nu^2
//!
//! ```text
//! C_zz = (1-nu)/(G |k|) [(3-4nu) sinh 2s - 2s]/D
//! C_xx = (1-nu)/(G |k|) [(3-4nu) sinh 2s + 2s]/D
//! C_xz = 1/(2 G k)      [(1-2nu)(3-4nu)(cosh 2s - 1) - 2 s^2]/D
//! u_x = C_xx q + i C_xz p,    d = -u_z = C_zz p - i C_xz q       for fields e^{ikx}
//! ```
//!
//! The sign of the coupling is that of the half-space, where a normal line load P draws the surface towards itself,
//! u_x = -(1-2nu)(1+nu)/(2E) sgn(x) P (Johnson, Contact Mechanics, 1985, Eq. 2.25); the tests derive it again for the
//! layer from the equations of equilibrium. By correspondence the same holds with complex moduli.

use nalgebra::Complex;

use super::solid::Moduli;

/// A layer -depth < z < 0 clamped at its base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// H, m.
    pub depth: f64,
}

/// The compliances at one wavenumber, m/Pa. For an elastic layer all three are real.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compliance {
    /// Indentation under pressure; even in k.
    pub zz: Complex<f64>,
    /// Tangential displacement under shear; even in k.
    pub xx: Complex<f64>,
    /// Coupling, without its factor i (see the module); odd in k.
    pub xz: Complex<f64>,
}

impl Compliance {
    /// The indentation under a pressure with q = f p everywhere: C_zz - i f C_xz.
    pub fn sliding(&self, f: f64) -> Complex<f64> {
        self.zz - Complex::i() * f * self.xz
    }
}

impl Layer {
    /// The compliance at wavenumber k (1/m, of either sign; 0 = uniform loading).
    ///
    /// Every hyperbolic function is scaled by e^{-2s}, so that s = 1e3 does not overflow, and the terms that cancel
    /// as s -> 0 are summed as series, so that s = 1e-6 (or nu = 1/2, or nu = 1/4 in C_xz) loses no digit.
    pub fn compliance(&self, k: f64, moduli: Moduli) -> Compliance {
        let Moduli { shear, poisson: nu } = moduli;
        if k == 0.0 {
            let zz = self.depth * (1.0 - 2.0 * nu) / (2.0 * shear * (1.0 - nu));
            return Compliance { zz, xx: self.depth / shear, xz: 0.0.into() };
        }
        let s = k.abs() * self.depth;
        let scale = (-2.0 * s).exp();
        let sinh2 = -0.5 * (-4.0 * s).exp_m1();
        let cosh2 = 0.5 * (1.0 + scale * scale);
        let kappa = 3.0 - 4.0 * nu;
        let determinant = kappa * cosh2 + scale * (2.0 * s * s + 5.0 - 12.0 * nu + 8.0 * nu * nu);
        let (sinh2_less, sinh_sq_less) = if s < 0.5 {
            (scale * sinh_less(2.0 * s), scale * sinh_less(s) * (s.sinh() + s))
        } else {
            (sinh2 - 2.0 * s * scale, 0.25 * (-2.0 * s).exp_m1().powi(2) - s * s * scale)
        };
        let normal = (1.0 - nu) / (shear * k.abs());
        // (1-2nu)(3-4nu) - 1 = 2 (1-nu)(1-4nu) is what is left of the coupling as s -> 0.
        let coupling =
            4.0 * (1.0 - nu) * (1.0 - 4.0 * nu) * (s * s * scale) + 2.0 * (1.0 - 2.0 * nu) * kappa * sinh_sq_less;
        Compliance {
            zz: normal * (kappa * sinh2_less + 4.0 * s * scale * (1.0 - 2.0 * nu)) / determinant,
            xx: normal * (kappa * sinh2 + 2.0 * s * scale) / determinant,
            xz: coupling / (2.0 * shear * k * determinant),
        }
    }
}

/// sinh x - x for 0 <= x <= 1 by its series x^3/3! + x^5/5! + ..., the terms nested.
fn sinh_less(x: f64) -> f64 {
    let square = x * x;
    let nested = (2..=10).rev().fold(1.0, |tail, n| {
        let n = f64::from(2 * n);
        1.0 + square / (n * (n + 1.0)) * tail
    });
    x * square / 6.0 * nested
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod tests {
    use super::*;
    use crate::oracle::solid::{PoissonRule, Solid};
    use nalgebra::{Matrix2, Matrix4};

    type C = Complex<f64>;

    /// Second method: equilibrium as a first-order system in z for (u_x, u_z, sigma_xz, sigma_zz) e^{ikx}, carried
    /// from the clamped base to the surface by a matrix exponential. Returns the map (q, p) -> (u_x, -u_z).
    fn by_state_space(k: f64, depth: f64, m: Moduli) -> Matrix2<C> {
        let ik = C::new(0.0, k);
        let (g, zero) = (m.shear, C::from(0.0));
        let lame = 2.0 * g * m.poisson / (1.0 - 2.0 * m.poisson);
        let p_wave = lame + 2.0 * g;
        // u_x' = sigma_xz/G - ik u_z;  u_z' = (sigma_zz - lame ik u_x)/P;
        // sigma_xz' = -ik sigma_xx, sigma_xx = P ik u_x + lame u_z';  sigma_zz' = -ik sigma_xz.
        let system = Matrix4::new(
            zero,
            -ik,
            g.inv(),
            zero,
            -ik * lame / p_wave,
            zero,
            zero,
            p_wave.inv(),
            k * k * (p_wave - lame * lame / p_wave),
            zero,
            zero,
            -ik * lame / p_wave,
            zero,
            zero,
            -ik,
            zero,
        );
        let carried = (system * C::from(depth)).exp();
        let u = carried.fixed_view::<2, 2>(0, 2).into_owned();
        let t = carried.fixed_view::<2, 2>(2, 2).into_owned();
        let map = u * t.try_inverse().unwrap();
        // (sigma_xz, sigma_zz) -> (q, p = -sigma_zz) and u_z -> -u_z.
        Matrix2::new(map[(0, 0)], -map[(0, 1)], -map[(1, 0)], map[(1, 1)])
    }

    #[test]
    fn agrees_with_equilibrium_integrated_through_the_depth() {
        let arms = vec![(0.579, 0.817)];
        let solid = Solid { shear: 3.0, poisson: 0.3, rule: PoissonRule::ConstantBulkModulus, arms };
        let mut moduli: Vec<Moduli> = [0.0, 0.2, 0.25, 0.3, 0.45].map(|nu| Moduli::elastic(3.0, nu)).into();
        moduli.push(solid.moduli(0.8));
        for m in moduli {
            for k in [0.05, 0.4, 1.0, 3.0, -2.0] {
                let c = Layer { depth: 0.7 }.compliance(k, m);
                let map = by_state_space(k, 0.7, m);
                let tolerance = 1e-10 * c.zz.norm();
                assert!((map[(0, 0)] - c.xx).norm() < tolerance, "xx k {k} {m:?}");
                assert!((map[(1, 1)] - c.zz).norm() < tolerance, "zz k {k} {m:?}");
                assert!((map[(0, 1)] - C::i() * c.xz).norm() < tolerance, "xp k {k} {m:?}");
                assert!((map[(1, 0)] + C::i() * c.xz).norm() < tolerance, "zq k {k} {m:?}");
            }
        }
    }

    /// The deep limit is the half-space: C_zz = C_xx = 2(1-nu^2)/(E k), C_xz = (1+nu)(1-2nu)/(E k).
    #[test]
    fn deep_layer_is_a_half_space() {
        let (young, nu, k) = (7.0, 0.3, 2.0);
        let c = Layer { depth: 500.0 }.compliance(k, Moduli::from_young(young, nu));
        let normal = 2.0 * (1.0 - nu * nu) / (young * k);
        assert!((c.zz.re / normal - 1.0).abs() < 1e-14 && (c.xx.re / normal - 1.0).abs() < 1e-14);
        assert!((c.xz.re / ((1.0 + nu) * (1.0 - 2.0 * nu) / (young * k)) - 1.0).abs() < 1e-14);
        assert!(Layer { depth: 1e6 }.compliance(k, Moduli::from_young(young, nu)).zz.re.is_finite());
    }

    /// Thin layer: the k = 0 limits, and where they vanish the next order. At nu = 1/2, C_zz = k^2 H^3/(3 G)
    /// (lubrication); at nu = 1/4 the bracket of C_xz begins with (1-2nu)(3-4nu) 2 s^4/3 = 2 s^4/3, D = 8 (1-nu)^2 = 9/2.
    #[test]
    fn thin_layer_limits() {
        let layer = Layer { depth: 0.5 };
        for nu in [0.0, 0.3, 0.49] {
            let m = Moduli::elastic(2.0, nu);
            let (uniform, thin) = (layer.compliance(0.0, m), layer.compliance(1e-6, m));
            assert!((thin.zz / uniform.zz - 1.0).norm() < 1e-9 && (thin.xx / uniform.xx - 1.0).norm() < 1e-9);
            let expected = 0.5 * (1.0 - 2.0 * nu) * (1.0 + nu) / (2.0 * 2.0 * (1.0 + nu) * (1.0 - nu));
            assert!((uniform.zz.re - expected).abs() < 1e-15 && uniform.xx.re == 0.25);
        }
        for k in [2e-3, 2e-6] {
            let incompressible = layer.compliance(k, Moduli::elastic(2.0, 0.5)).zz.re;
            assert!((incompressible / (k * k * 0.125 / 6.0) - 1.0).abs() < 2.0 * k * k);
            let quarter = layer.compliance(k, Moduli::elastic(2.0, 0.25)).xz.re;
            let s = 0.5 * k;
            assert!((quarter / (2.0 * s.powi(4) / 3.0 / 4.5 / (4.0 * k)) - 1.0).abs() < 2.0 * k * k);
        }
    }

    /// The series and the direct formulas meet where one takes over from the other.
    #[test]
    fn continuous_at_the_switch() {
        let m = Moduli::elastic(1.0, 0.5);
        let layer = Layer { depth: 1.0 };
        let (below, above) = (layer.compliance(0.5 - 1e-13, m), layer.compliance(0.5, m));
        assert!((below.zz / above.zz - 1.0).norm() < 2e-12 && (below.xz / above.xz - 1.0).norm() < 2e-12);
    }
}
