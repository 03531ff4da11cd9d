//! Periodic surfaces on equally spaced nodes: profiles, and surface kernels as circulants.

use std::f64::consts::TAU;

use nalgebra::Complex;

/// The harmonic profile h = g_0 (1 - cos(2 pi x/wavelength)), m. The solvers take any periodic profile as a function
/// x -> (h, dh/dx); this is the usual one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic {
    /// g_0, m.
    pub amplitude: f64,
    /// Wavelength, m; the period of the layer holds a whole number of them.
    pub wavelength: f64,
}

impl Harmonic {
    /// (h in m, dh/dx) at x.
    pub fn at(&self, x: f64) -> (f64, f64) {
        let k = TAU / self.wavelength;
        // 1 - cos without cancellation near the summit.
        (2.0 * self.amplitude * (0.5 * k * x).sin().powi(2), self.amplitude * k * (k * x).sin())
    }
}

/// The influence of a unit traction at node 0 on node j, from the symbol at wavenumbers k = 2 pi m/width, m >= 0.
///
/// u_i = sum_j kernel[(i - j) mod n] t_j is the exact response to the trigonometric interpolant of t. The symbol at -k
/// is the conjugate of that at k (real fields); at the Nyquist wavenumber only its real part acts on nodal values.
pub fn kernel(n: usize, width: f64, symbol: impl Fn(f64) -> Complex<f64>) -> Vec<f64> {
    let circle: Vec<Complex<f64>> = (0..n).map(|j| Complex::from_polar(1.0, TAU * j as f64 / n as f64)).collect();
    let modes: Vec<Complex<f64>> = (0..=n / 2)
        .map(|m| {
            // Twice for the pair +k, -k; once for the mean and for Nyquist, which are alone.
            let pair = if m == 0 || 2 * m == n { 1.0 } else { 2.0 };
            symbol(TAU * m as f64 / width) * (pair / n as f64)
        })
        .collect();
    (0..n).map(|j| modes.iter().enumerate().map(|(m, value)| (value * circle[m * j % n]).re).sum()).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod tests {
    use super::*;

    /// The symbol -i/k integrates: applied to cos it gives sin/k.
    #[test]
    fn kernel_applies_its_symbol() {
        for n in [16, 17] {
            let width = 3.0;
            let k1 = 2.0 * TAU / width;
            let circulant = kernel(n, width, |k| if k == 0.0 { 0.0.into() } else { Complex::new(0.5, -1.0 / k) });
            let x = |j: usize| width * j as f64 / n as f64;
            for i in 0..n {
                let u: f64 = (0..n).map(|j| circulant[(n + i - j) % n] * (k1 * x(j)).cos()).sum();
                assert!((u - 0.5 * (k1 * x(i)).cos() - (k1 * x(i)).sin() / k1).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn slope_is_the_derivative() {
        let profile = Harmonic { amplitude: 5e-4, wavelength: 0.7 };
        let (x, e) = (0.123, 1e-6);
        let difference = (profile.at(x + e).0 - profile.at(x - e).0) / (2.0 * e);
        assert!((difference - profile.at(x).1).abs() < 1e-9);
    }
}
