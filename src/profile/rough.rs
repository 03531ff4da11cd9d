//! A self-affine rough profile, made from a seed.

use std::f64::consts::PI;

use super::{Elevation, Profile};
use crate::error::Result;

/// The statistics of a self-affine line profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roughness {
    /// H, in (0, 1].
    pub hurst: f64,
    /// How high or steep it is.
    pub rms: Rms,
    /// Shortest wavelength, m.
    pub shortest: f64,
    /// Longest wavelength, m.
    pub longest: f64,
    /// The profile repeats after this, m.
    pub period: f64,
    /// Which one of all profiles with these statistics.
    pub seed: u64,
}

/// The root mean square over a period that the profile has exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rms {
    /// Of dh/dx.
    Slope(f64),
    /// Of h about its mean, m.
    Height(f64),
}

/// h(x) = h_0 + sum over n of a_n cos(q_n x + phi_n), q_n = 2 pi n / period, longest >= period / n >= shortest.
///
/// A line profile with the spectral density C(q) ~ q^-(1 + 2 H) has a_n ~ n^-(H + 1/2). The phases alone are random:
/// phi_n / 2 pi = the n-th number of SplitMix64 (Steele, Lea and Flood, OOPSLA 2014) from the seed, its 53 leading
/// bits as a fraction of 1. As the amplitudes are not random, the root mean square sqrt(sum a_n^2 / 2), or that with
/// q_n a_n for the slope, is exactly what is asked for. A wave keeps its phase when `shortest` or `longest` change.
///
/// h_0 makes the lowest point 0: the lowest of eight points to the shortest wavelength, from x = 0 on, and of what
/// a parabola through that point and its neighbours dips below them.
///
/// Sine, cosine and power are those of the `libm` crate, plain arithmetic in a fixed order, not of the system's
/// library: the same scene has the same profile, bit for bit, on every machine and number of ranks.
#[derive(Debug, Clone, PartialEq)]
pub struct Rough {
    period: f64,
    /// The first n.
    first: usize,
    /// From the first n up: a_n exp(i phi_n), m, and the same times q_n.
    waves: Vec<[Complex; 2]>,
    /// h_0, m
    offset: f64,
}

/// Real and imaginary part.
pub(super) type Complex = [f64; 2];

/// Points to the shortest wavelength among which the lowest is looked for.
pub(super) const GRID: usize = 8;

impl Roughness {
    /// The wave numbers n of the period: those whose wavelength is between shortest and longest, to round-off.
    pub fn waves(&self) -> std::ops::RangeInclusive<usize> {
        let first = (self.period / self.longest * (1.0 - 1e-9)).ceil().max(1.0);
        let last = (self.period / self.shortest * (1.0 + 1e-9)).floor();
        first as usize..=last as usize
    }
}

impl Rough {
    /// The profile of these statistics. It has at least one wave.
    pub fn new(roughness: Roughness) -> Self {
        let Roughness { hurst, rms, period, seed, .. } = roughness;
        let numbers = roughness.waves();
        let q = |n: usize| 2.0 * PI * n as f64 / period;
        let shape: Vec<f64> = numbers.clone().map(|n| libm::pow(n as f64, -(hurst + 0.5))).collect();
        let square: f64 = match rms {
            Rms::Height(_) => shape.iter().map(|a| a * a).sum(),
            Rms::Slope(_) => numbers.clone().zip(&shape).map(|(n, a)| (a * q(n)) * (a * q(n))).sum(),
        };
        let (Rms::Height(rms) | Rms::Slope(rms)) = rms;
        let scale = rms / (square / 2.0).sqrt();
        let wave = |(n, shape): (usize, &f64)| {
            let (sin, cos) = libm::sincos(2.0 * PI * fraction(seed, n as u64));
            let a = scale * shape;
            [[a * cos, a * sin], [q(n) * a * cos, q(n) * a * sin]]
        };
        let waves = numbers.clone().zip(&shape).map(wave).collect();
        let mut profile = Self { period, first: *numbers.start(), waves, offset: 0.0 };
        profile.offset = -profile.lowest(GRID * numbers.end());
        profile
    }

    /// The lowest height over a period, from `points` of it and a parabola about the lowest of them.
    fn lowest(&self, points: usize) -> f64 {
        let height = |k: usize| self.wave_sum((k % points) as f64 / points as f64).height;
        let heights: Vec<f64> = (0..points).map(height).collect();
        let Some((k, &lowest)) = heights.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)) else { return 0.0 };
        let (before, after) = (heights[(k + points - 1) % points], heights[(k + 1) % points]);
        let bend = before - 2.0 * lowest + after;
        let dip = if bend > 0.0 { (after - before) * (after - before) / (8.0 * bend) } else { 0.0 };
        lowest - dip
    }

    /// The sum of the waves at a fraction of the period:
    ///
    ///   h = Re sum c_n z^n,   dh/dx = -Im sum q_n c_n z^n,   z = exp(2 pi i x / period),
    ///
    /// by Horner's rule from the shortest wave down, with no sine or cosine but the first.
    fn wave_sum(&self, fraction: f64) -> Elevation {
        let z = turn(fraction);
        let [mut height, mut slope] = [[0.0; 2]; 2];
        for [c, qc] in self.waves.iter().rev() {
            height = add(times(height, z), *c);
            slope = add(times(slope, z), *qc);
        }
        let lead = turn(self.first as f64 * fraction);
        Elevation { height: times(height, lead)[0], slope: -times(slope, lead)[1] }
    }
}

impl Profile for Rough {
    fn at(&self, x: f64) -> Result<Elevation> {
        let turns = x / self.period;
        let Elevation { height, slope } = self.wave_sum(turns - turns.floor());
        Ok(Elevation { height: height + self.offset, slope })
    }
}

/// cos and sin of so many turns.
pub(super) fn turn(turns: f64) -> Complex {
    let (sin, cos) = libm::sincos(2.0 * PI * (turns - turns.round()));
    [cos, sin]
}

fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn add(a: Complex, b: Complex) -> Complex {
    [a[0] + b[0], a[1] + b[1]]
}

/// The n-th number (from 1) of SplitMix64 from `seed`, in [0, 1).
pub(super) fn fraction(seed: u64, n: u64) -> f64 {
    (split_mix(seed, n) >> 11) as f64 / (1u64 << 53) as f64
}

fn split_mix(seed: u64, n: u64) -> u64 {
    let mut z = seed.wrapping_add(n.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn roughness() -> Roughness {
        Roughness { hurst: 0.8, rms: Rms::Slope(0.1), shortest: 0.01, longest: 0.5, period: 1.0, seed: 7 }
    }

    /// Mean, and root mean square of height about it and of slope, over the period; exact for more points than twice
    /// the waves.
    fn moments(profile: &Rough, period: f64, points: usize) -> (f64, f64, f64) {
        let list: Vec<Elevation> =
            (0..points).map(|k| profile.at(period * k as f64 / points as f64).unwrap()).collect();
        let mean = |f: &dyn Fn(&Elevation) -> f64| list.iter().map(f).sum::<f64>() / points as f64;
        let height = mean(&|e| e.height);
        (height, mean(&|e| (e.height - height).powi(2)).sqrt(), mean(&|e| e.slope * e.slope).sqrt())
    }

    /// The generator against the numbers of its authors' program.
    #[test]
    fn split_mix_is_split_mix() {
        let numbers: Vec<u64> = (1..=5).map(|n| split_mix(1_234_567, n)).collect();
        let published = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
            16_408_922_859_458_223_821,
        ];
        assert_eq!(numbers, published);
    }

    #[test]
    fn root_mean_squares_are_exact() {
        for period in [1.0, 3.7] {
            let base = Roughness { period, longest: 0.5 * period, ..roughness() };
            let (_, _, slope) = moments(&Rough::new(base), period, 4096);
            assert!((slope / 0.1 - 1.0).abs() < 1e-12, "{slope}");
            let profile = Rough::new(Roughness { rms: Rms::Height(3e-6), ..base });
            let (_, height, _) = moments(&profile, period, 4096);
            assert!((height / 3e-6 - 1.0).abs() < 1e-12, "{height}");
        }
    }

    #[test]
    fn slopes_are_derivatives() {
        let profile = Rough::new(roughness());
        for x in [-3.3, 0.0, 0.123, 0.99, 17.2] {
            let h = 1e-6;
            let numeric = (profile.at(x + h).unwrap().height - profile.at(x - h).unwrap().height) / (2.0 * h);
            assert!((profile.at(x).unwrap().slope - numeric).abs() < 1e-6, "{x}");
        }
    }

    /// The amplitudes, found by a Fourier sum of the profile, fall as n^-(H + 1/2) between longest and shortest and
    /// are 0 elsewhere.
    #[test]
    fn the_spectrum_is_a_power_law() {
        let profile = Rough::new(Roughness { rms: Rms::Height(1.0), ..roughness() });
        let points = 512;
        let heights: Vec<f64> = (0..points).map(|k| profile.at(k as f64 / points as f64).unwrap().height).collect();
        let amplitude = |n: usize| {
            let term = |f: fn(f64) -> f64| -> f64 {
                heights.iter().enumerate().map(|(k, h)| h * f(2.0 * PI * (n * k) as f64 / points as f64)).sum()
            };
            term(f64::cos).hypot(term(f64::sin)) * 2.0 / points as f64
        };
        for n in 2..=100 {
            let law = amplitude(2) * (n as f64 / 2.0).powf(-1.3);
            assert!((amplitude(n) - law).abs() < 1e-12, "{n}");
        }
        assert!(amplitude(1).max(amplitude(101)) < 1e-12);
    }

    /// How long the longest profile takes; run with --release --ignored --nocapture.
    #[test]
    #[ignore = "a measurement"]
    #[allow(clippy::print_stdout)]
    fn time_to_make_and_to_evaluate() {
        for waves in [100, 1000, 4000, 10_000] {
            let clock = std::time::Instant::now();
            let profile = Rough::new(Roughness { shortest: 1.0 / waves as f64, longest: 1.0, ..roughness() });
            let made = clock.elapsed();
            let clock = std::time::Instant::now();
            let sum: f64 = (0..1000).map(|k| profile.at(k as f64 * 0.9e-3).unwrap().height).sum();
            println!("{waves} waves: made in {made:?}, 1000 points in {:?} ({sum:e})", clock.elapsed());
        }
    }

    /// The lowest point is 0, but for what the parabola misses.
    #[test]
    fn the_lowest_point_is_zero() {
        for seed in 0..20 {
            let profile = Rough::new(Roughness { seed, rms: Rms::Height(1.0), ..roughness() });
            let lowest = (0..40_000).map(|k| profile.at(k as f64 / 40_000.0).unwrap().height).fold(1.0, f64::min);
            assert!(lowest.abs() < 2e-3, "{seed}: {lowest}");
        }
    }

    /// Numbers written down once: they must not change with the machine, the compiler or the version.
    #[test]
    fn a_seed_is_a_profile_for_ever() {
        let profile = Rough::new(roughness());
        let bits: Vec<u64> = [0.0, 0.3, 0.77].iter().map(|&x| profile.at(x).unwrap().height.to_bits()).collect();
        // The formulas in 40 digits, by another program, rounded.
        for (bits, exact) in bits.iter().zip([0.007924591165347616, 0.004785847302680426, 0.004437372148711689f64]) {
            assert!((f64::from_bits(*bits) - exact).abs() < 1e-15);
        }
        assert_eq!(bits, [4_575_721_837_565_926_791, 4_572_167_728_426_707_880, 4_571_765_963_927_876_137]);
        assert_ne!(Rough::new(Roughness { seed: 8, ..roughness() }), profile);
    }

    /// A finer or longer cut of the same profile keeps the waves that both have.
    #[test]
    fn waves_keep_their_phases() {
        let coarse = Rough::new(Roughness { shortest: 0.1, longest: 0.25, ..roughness() });
        let fine = Rough::new(roughness());
        let phase = |wave: &[Complex; 2]| wave[0][1].atan2(wave[0][0]);
        assert_eq!((coarse.first, coarse.waves.len(), fine.first, fine.waves.len()), (4, 7, 2, 99));
        for (coarse, fine) in coarse.waves.iter().zip(&fine.waves[2..]) {
            assert!((phase(coarse) - phase(fine)).abs() < 1e-14);
        }
    }
}
