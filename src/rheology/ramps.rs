//! A loading history made of ramps, and what forces it takes.
//!
//! Boltzmann: F(t) = integral of M(t - s) du(s). Over a ramp of a constant rate r from t1 to t2
//!
//! ```text
//! F(t) = r [I(t - t1) - I(t - t2)],    I(t) = integral of M from 0 to t, and 0 for t < 0
//! ```

use super::Band;

/// A constant rate from one time to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// s
    pub from: f64,
    /// s
    pub to: f64,
    /// Per s, of whatever is loaded.
    pub rate: f64,
}

/// What a loading history asks of a material.
#[derive(Debug, Clone, PartialEq)]
pub struct Loading {
    /// From the shortest step to the end, s.
    pub band: Band,
    /// The ramps of each thing that is loaded.
    pub directions: Vec<Vec<Ramp>>,
    /// The ends of steps where forces are compared, s, ascending.
    pub moments: Vec<f64>,
}

impl Loading {
    /// Whether nothing is loaded.
    pub fn is_idle(&self) -> bool {
        self.directions.iter().all(Vec::is_empty)
    }

    /// The same history on a clock that runs `factor` times as slow.
    pub fn stretched(&self, factor: f64) -> Self {
        let ramp = |ramp: &Ramp| Ramp { from: ramp.from * factor, to: ramp.to * factor, rate: ramp.rate };
        Self {
            band: Band { from: self.band.from * factor, to: self.band.to * factor },
            directions: self.directions.iter().map(|ramps| ramps.iter().map(ramp).collect()).collect(),
            moments: self.moments.iter().map(|t| t * factor).collect(),
        }
    }

    /// The largest error of a force at the moments, by the integral I(t) of the modulus that stands for `exact`, over
    /// the force that there would be if no ramp took back what another had loaded. Zero without ramps.
    pub fn force_error(&self, approximate: impl Fn(f64) -> f64, exact: impl Fn(f64) -> f64) -> f64 {
        let share = |integral: &dyn Fn(f64) -> f64, ramp: &Ramp, t: f64| {
            integral(t - ramp.from) - if t > ramp.to { integral(t - ramp.to) } else { 0.0 }
        };
        let error = |ramps: &[Ramp], t: f64| {
            let (mut off, mut force) = (0.0, 0.0);
            for ramp in ramps.iter().filter(|ramp| t > ramp.from) {
                let there = share(&exact, ramp, t);
                off += ramp.rate * (share(&approximate, ramp, t) - there);
                force += ramp.rate.abs() * there;
            }
            if force > 0.0 { off.abs() / force } else { 0.0 }
        };
        let of = |ramps: &Vec<Ramp>| self.moments.iter().map(|&t| error(ramps, t)).fold(0.0, f64::max);
        self.directions.iter().map(of).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M = 1 + e^-t against M = 1 under a ramp of 1 s that is held: at its end I = 1 + (1 - 1/e) against 1, and at 2 s
    /// what I gained since, 1 + 1/e - 1/e^2 against 1; taking it all back at once from 2 s leaves the error over twice.
    #[test]
    fn forces_of_ramps() {
        let band = Band { from: 0.1, to: 3.0 };
        let up = Ramp { from: 0.0, to: 1.0, rate: 5.0 };
        let loading = |ramps: &[Ramp], t: f64| Loading { band, directions: vec![ramps.to_vec()], moments: vec![t] };
        let error = |loading: Loading| loading.force_error(|t| t - (-t).exp_m1(), |t| t);
        let e = std::f64::consts::E;
        assert!((error(loading(&[up], 1.0)) - (1.0 - 1.0 / e)).abs() < 1e-12);
        assert!((error(loading(&[up], 2.0)) - (1.0 / e - 1.0 / e / e)).abs() < 1e-12);
        let down = Ramp { from: 2.0, to: 3.0, rate: -5.0 };
        let left = (1.0 / e / e - (-3f64).exp()) - (1.0 - 1.0 / e);
        assert!((error(loading(&[up, down], 3.0)) - left.abs() / 2.0).abs() < 1e-12);
        assert_eq!(error(loading(&[], 1.0)), 0.0);
        assert!((error(loading(&[up], 1.0).stretched(2.0)) - (1.0 - (-2f64).exp()) / 2.0).abs() < 1e-12);
    }
}
