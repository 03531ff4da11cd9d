//! Temperatures under heat that enters a face: half-spaces, layers, moving sources. Rises above where all began, in K.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

/// What heat flows through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conductor {
    /// kappa, W/m/K.
    pub conductivity: f64,
    /// rho c, per volume, J/m^3/K.
    pub capacity: f64,
}

/// A band of uniform flux that moves towards +x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// q, W/m^2.
    pub flux: f64,
    /// a, half of its width, m.
    pub half_width: f64,
    /// V, m/s, above 0.
    pub velocity: f64,
}

impl Conductor {
    /// D = kappa/(rho c), m^2/s.
    pub fn diffusivity(&self) -> f64 {
        self.conductivity / self.capacity
    }

    /// The face of a half-space under a flux q from t = 0 on: 2 q sqrt(t/(pi kappa rho c)) (Carslaw and Jaeger, Conduction of Heat
    /// in Solids, 2.9).
    pub fn half_space(&self, flux: f64, time: f64) -> f64 {
        2.0 * flux * (time / (PI * self.conductivity * self.capacity)).sqrt()
    }

    /// The face of a layer of depth H over a base at 0, under a flux q and a film h to air at `air`, when nothing changes any more:
    /// (q + h T_air)/(kappa/H + h).
    pub fn steady_layer(&self, depth: f64, flux: f64, [film, air]: [f64; 2]) -> f64 {
        (flux + film * air) / (self.conductivity / depth + film)
    }

    /// The face of a half-plane at `x` from the middle of a band that moves for ever, by Jaeger's integral
    /// q/(pi kappa) of e^(-V (x - s)/(2 D)) K_0(V |x - s|/(2 D)) over the band (Proc. R. Soc. N.S.W. 76 (1942) 203).
    pub fn jaeger(&self, band: Band, x: f64) -> f64 {
        let rate = band.velocity / (2.0 * self.diffusivity());
        // By the distance from x, which the integrand is singular in: u = y^2 takes the logarithm away.
        let side = |length: f64, sense: f64| {
            let value = |y: f64| {
                let u = rate * y * y;
                2.0 * y * scaled_k0(u) * (u * (sense - 1.0)).exp()
            };
            if length > 0.0 { integral(value, length.sqrt()) } else { 0.0 }
        };
        let (left, right) = (x + band.half_width, band.half_width - x);
        // Parts of the band that lie ahead of the point warm it the more: they have passed it.
        let inside = |from: f64, to: f64, sense: f64| side(to.max(0.0), sense) - side(from.max(0.0), sense);
        let ahead = inside(-left, right, 1.0);
        let behind = inside(-right, left, -1.0);
        band.flux / (PI * self.conductivity) * (ahead + behind)
    }

    /// The face of a layer of depth H over a base at 0, periodic over `width`, at `x` from the middle of a band that moves for ever:
    /// T_k = q_k tanh(gamma H)/(kappa gamma), gamma^2 = k^2 - i k V/D.
    pub fn periodic_layer(&self, band: Band, [width, depth]: [f64; 2], x: f64) -> f64 {
        const WAVES: u32 = 200_000;
        let mean = 2.0 * band.flux * band.half_width / width;
        let wave = |n: u32| {
            let k = TAU * f64::from(n) / width;
            let gamma = Complex::new(k * k, -k * band.velocity / self.diffusivity()).sqrt();
            // tanh without overflow.
            let fallen = (-gamma * (2.0 * depth)).exp();
            let answer = (1.0 - fallen) / (1.0 + fallen) / (gamma * self.conductivity);
            let flux = 2.0 * band.flux * (k * band.half_width).sin() / (k * width);
            2.0 * flux * (answer * Complex::from_polar(1.0, k * x)).re
        };
        mean * depth / self.conductivity + (1..=WAVES).map(wave).sum::<f64>()
    }

    /// The face at `x` under a flux q(s) that moves towards +x so fast that nothing is conducted along it:
    /// 1/sqrt(kappa rho c pi V) times the integral of q(s)/sqrt(s - x) from x to the leading edge.
    pub fn flash(&self, flux: impl Fn(f64) -> f64, velocity: f64, [x, edge]: [f64; 2]) -> f64 {
        if x >= edge {
            return 0.0;
        }
        // s = x + y^2
        let integral = integral(|y| 2.0 * flux(x + y * y), (edge - x).sqrt());
        integral / (self.conductivity * self.capacity * PI * velocity).sqrt()
    }
}

/// The integral from 0 to `end`, by the midpoint rule.
fn integral(value: impl Fn(f64) -> f64, end: f64) -> f64 {
    const PIECES: u32 = 4000;
    let step = end / f64::from(PIECES);
    (0..PIECES).map(|i| step * value(step * (f64::from(i) + 0.5))).sum()
}

/// e^u K_0(u), the integral of e^(-u (cosh t - 1)) over t > 0: by the trapezoidal rule, which is exact to round-off.
fn scaled_k0(u: f64) -> f64 {
    // The integrand is as wide as the smaller of 1 and 1/sqrt(u).
    let step = 0.05 / (1.0 + u).sqrt();
    let value = |i: u32| (-u * 2.0 * (0.5 * step * f64::from(i)).sinh().powi(2)).exp();
    let terms = (1..).map(value).take_while(|value| *value > 1e-18);
    step * (0.5 + terms.sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;

    const RUBBER: Conductor = Conductor { conductivity: 0.2, capacity: 2e6 };
    const BAND: Band = Band { flux: 5e3, half_width: 2e-3, velocity: 2e-3 };

    /// Tabulated values: the half-space, the layer, Jaeger's band at Pe = 20, the periodic layer, K_0 (Abramowitz and Stegun, 9.8).
    #[test]
    fn values_are_those_of_tables() {
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 6e-5, "{found} {expected}");
        near(RUBBER.half_space(5e3, 1.0), 8.92062);
        near(RUBBER.steady_layer(0.01, 5e3, [30.0, 5.0]), 103.0);
        near(RUBBER.jaeger(BAND, -2e-3), 11.8591);
        near(RUBBER.jaeger(BAND, 0.0), 8.9759);
        near(RUBBER.periodic_layer(BAND, [0.02, 0.001], -0.96875 * 2e-3), 13.1498);
        near(RUBBER.periodic_layer(BAND, [0.02, 0.001], 0.0), 9.9155);
        for (u, k0) in [(0.1, 2.4270690), (1.0, 0.4210244), (5.0, 0.0036911)] {
            assert!((scaled_k0(u) * f64::exp(-u) - k0).abs() < 1e-7, "{u}");
        }
    }

    /// Far from either edge of a long band at high Peclet, Jaeger's is what the flash temperature says: 2 q sqrt(l/(pi kappa rho c V))
    /// after a way l, with a correction of 1/Pe.
    #[test]
    fn fast_bands_conduct_nothing_along() {
        let fast = Band { velocity: 20.0, ..BAND };
        let (jaeger, flash) = (RUBBER.jaeger(fast, 0.0), RUBBER.flash(|_| fast.flux, fast.velocity, [0.0, 2e-3]));
        assert!((flash / RUBBER.half_space(fast.flux, 2e-3 / fast.velocity) - 1.0).abs() < 1e-12);
        assert!((jaeger / flash - 1.0).abs() < 1e-4, "{jaeger} {flash}");
    }
}
