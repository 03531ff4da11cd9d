//! A self-affine rough surface, the same in all directions, made from a seed.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::f64::consts::PI;

use nalgebra::{Matrix2, Vector2};

use super::rough::{Complex, GRID, fraction, turn};
use super::{Height, Rms, Roughness, Surface};
use crate::error::Result;

/// h(x, y) = h_0 + sum over (m, n) of a_mn cos(q_m x + q_n y + phi_mn), q_m = 2 pi m / Px, q_n = 2 pi n / Py,
/// longest >= 2 pi / |q| >= shortest, one of every pair of opposite waves.
///
/// An isotropic surface with the spectral density C(|q|) ~ |q|^-(2 + 2 H) has a_mn ~ |q|^-(1 + H) on the lattice of
/// its periods (Jacobs, Junge and Pastewka, Surf. Topogr.: Metrol. Prop. 5 (2017) 013001). As in
/// [`Rough`](super::Rough), the phases alone are random, so that the root mean square of h, or of its gradient, is
/// exactly what is asked for; a wave keeps its phase when `shortest` or `longest` change; and `libm` and plain
/// arithmetic in a fixed order make the same bits everywhere.
///
/// Along a line of constant x the waves add up to one series in y, c_n + conj(c_-n) for every n >= 0, by Horner's rule
/// over m. Points on the same line share it: a grid whose y runs fastest costs a series each.
pub struct RoughSurface {
    /// Px, Py, m
    periods: Vector2<f64>,
    /// The largest m and |n|.
    most: [usize; 2],
    /// a_mn exp(i phi_mn), m: m from 0, n from the lowest, n fastest.
    waves: Vec<Complex>,
    /// h_0, m
    offset: f64,
    /// The lines that were looked at last.
    lines: RefCell<VecDeque<Line>>,
}

/// So many lines are kept: two points to an edge alternate between two of them, and so do neighbouring cells.
const LINES: usize = 4;

/// The surface along a line of constant x: h and dh/dx are the real parts of sum c_n w^n, w = exp(2 pi i y / Py).
struct Line {
    /// x as a fraction of its period.
    at: f64,
    height: Vec<Complex>,
    slope: Vec<Complex>,
}

/// The wave vectors (m, n) of a lattice with these statistics, its periods `period` of them along x and `across` along y, m: one
/// of every pair of opposite ones.
fn wave_vectors(roughness: &Roughness, across: f64) -> impl Iterator<Item = (i64, i64)> {
    let Roughness { shortest, longest, period, .. } = *roughness;
    let [most_x, most_y] = most(roughness, across).map(|most| most as i64);
    let half = move |m: i64, n: i64| m > 0 || n > 0;
    let inside = move |m: i64, n: i64| {
        let frequency = (m as f64 / period).powi(2) + (n as f64 / across).powi(2);
        let wavelengths = 1.0 / frequency.sqrt();
        wavelengths >= shortest * (1.0 - 1e-9) && wavelengths <= longest * (1.0 + 1e-9)
    };
    (0..=most_x)
        .flat_map(move |m| (-most_y..=most_y).map(move |n| (m, n)))
        .filter(move |&(m, n)| half(m, n) && inside(m, n))
}

/// The largest wave numbers along x and along y.
fn most(roughness: &Roughness, across: f64) -> [usize; 2] {
    [roughness.period, across].map(|period| (period / roughness.shortest * (1.0 + 1e-9)).floor() as usize)
}

impl RoughSurface {
    /// How many waves it has.
    pub fn count(roughness: &Roughness, across: f64) -> usize {
        wave_vectors(roughness, across).count()
    }

    /// The surface of these statistics: its period along x is theirs, that along y is `across`, m. It has at least one
    /// wave.
    pub fn new(roughness: Roughness, across: f64) -> Self {
        let Roughness { hurst, rms, period, seed, .. } = roughness;
        let most = most(&roughness, across);
        let columns = 2 * most[1] + 1;
        let square = |m: i64, n: i64| (m as f64 / period).powi(2) + (n as f64 / across).powi(2);
        let longest_of_lattice = period.max(across);
        // |q| in the lowest wave of the lattice: no power of it leaves the range of numbers.
        let shape = |m, n| libm::pow(square(m, n) * longest_of_lattice.powi(2), -0.5 * (hurst + 1.0));
        let share = |(m, n)| match rms {
            Rms::Height(_) => shape(m, n) * shape(m, n),
            Rms::Slope(_) => shape(m, n) * shape(m, n) * square(m, n) * (2.0 * PI).powi(2),
        };
        let (Rms::Height(wanted) | Rms::Slope(wanted)) = rms;
        let scale = wanted / (0.5 * wave_vectors(&roughness, across).map(share).sum::<f64>()).sqrt();
        let mut waves = vec![[0.0; 2]; (most[0] + 1) * columns];
        for (m, n) in wave_vectors(&roughness, across) {
            // A number of its own for every wave of any lattice.
            let number = ((m as u64) << 32) | u64::from(n as i32 as u32);
            let [cos, sin] = turn(fraction(seed, number));
            let amplitude = scale * shape(m, n);
            waves[m as usize * columns + (n + most[1] as i64) as usize] = [amplitude * cos, amplitude * sin];
        }
        let periods = Vector2::new(period, across);
        let mut surface = Self { periods, most, waves, offset: 0.0, lines: RefCell::default() };
        surface.offset = -surface.lowest();
        surface
    }

    /// The line at a fraction of the period along x.
    fn line(&self, at: f64) -> Line {
        let [_, n] = self.most;
        let columns = 2 * n + 1;
        let z = turn(at);
        let unit = 2.0 * PI / self.periods.x;
        let [mut height, mut slope] = [(); 2].map(|()| vec![[0.0; 2]; columns]);
        for (m, row) in self.waves.chunks_exact(columns).enumerate().rev() {
            let q = m as f64 * unit;
            for ((sum, along), c) in height.iter_mut().zip(&mut slope).zip(row) {
                *sum = [sum[0] * z[0] - sum[1] * z[1] + c[0], sum[0] * z[1] + sum[1] * z[0] + c[1]];
                *along = [along[0] * z[0] - along[1] * z[1] + q * c[0], along[0] * z[1] + along[1] * z[0] + q * c[1]];
            }
        }
        // The real part of c w^-n is that of conj(c) w^n; d/dx is a factor of i q.
        let folded = |sums: &[Complex]| -> Vec<Complex> {
            let pair = |k: usize| [sums[n + k][0] + sums[n - k][0], sums[n + k][1] - sums[n - k][1]];
            std::iter::once(sums[n]).chain((1..=n).map(pair)).collect()
        };
        slope.iter_mut().for_each(|c| *c = [-c[1], c[0]]);
        Line { at, height: folded(&height), slope: folded(&slope) }
    }

    /// The lowest height: that of a grid of [`GRID`] points to the shortest wave, and what a paraboloid through it and its
    /// neighbours dips below them.
    fn lowest(&self) -> f64 {
        let [columns, rows] = self.most.map(|most| GRID * most.max(1));
        let w: Vec<Complex> = (0..rows).map(|j| turn(j as f64 / rows as f64)).collect();
        let mut heights = Vec::with_capacity(columns * rows);
        for i in 0..columns {
            let mut sums = vec![[0.0; 2]; rows];
            for c in self.line(i as f64 / columns as f64).height.iter().rev() {
                for (sum, w) in sums.iter_mut().zip(&w) {
                    *sum = [sum[0] * w[0] - sum[1] * w[1] + c[0], sum[0] * w[1] + sum[1] * w[0] + c[1]];
                }
            }
            heights.extend(sums.iter().map(|sum| sum[0]));
        }
        let Some((k, &lowest)) = heights.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)) else { return 0.0 };
        let (i, j) = (k / rows, k % rows);
        let near = |di: usize, dj: usize| heights[(i + columns + di - 1) % columns * rows + (j + rows + dj - 1) % rows];
        let slope = Vector2::new(near(2, 1) - near(0, 1), near(1, 2) - near(1, 0)) / 2.0;
        let bend = Vector2::new(near(2, 1) + near(0, 1), near(1, 2) + near(1, 0)).map(|sum| sum - 2.0 * lowest);
        let twist = (near(2, 2) - near(2, 0) - near(0, 2) + near(0, 0)) / 4.0;
        let dip =
            Matrix2::new(bend.x, twist, twist, bend.y).try_inverse().map_or(0.0, |soft| slope.dot(&(soft * slope)));
        lowest - 0.5 * dip.max(0.0)
    }
}

impl Line {
    /// h and its gradient at a fraction of the period along y of which 2 pi is `unit`, 1/m.
    fn at(&self, fraction: f64, unit: f64) -> Height {
        let w = turn(fraction);
        let times = |a: Complex| [a[0] * w[0] - a[1] * w[1], a[0] * w[1] + a[1] * w[0]];
        let [mut height, mut across] = [[0.0; 2]; 2];
        let mut along = [0.0; 2];
        for (n, (c, s)) in self.height.iter().zip(&self.slope).enumerate().rev() {
            let q = n as f64 * unit;
            let [turned, turned_along, turned_across] = [times(height), times(along), times(across)];
            height = [turned[0] + c[0], turned[1] + c[1]];
            along = [turned_along[0] + s[0], turned_along[1] + s[1]];
            across = [turned_across[0] - q * c[1], turned_across[1] + q * c[0]];
        }
        Height { height: height[0], gradient: Vector2::new(along[0], across[0]) }
    }
}

impl Surface for RoughSurface {
    fn at(&self, place: Vector2<f64>) -> Result<Height> {
        let [x, y] = [0, 1].map(|axis| {
            let turns = place[axis] / self.periods[axis];
            turns - turns.floor()
        });
        let mut lines = self.lines.borrow_mut();
        let line = match lines.iter().position(|line| line.at.to_bits() == x.to_bits()) {
            Some(known) => &lines[known],
            None => {
                lines.truncate(LINES - 1);
                lines.push_front(self.line(x));
                &lines[0]
            }
        };
        let Height { height, gradient } = line.at(y, 2.0 * PI / self.periods.y);
        Ok(Height { height: height + self.offset, gradient })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const ACROSS: f64 = 0.5;

    fn roughness() -> Roughness {
        Roughness { hurst: 0.8, rms: Rms::Slope(0.1), shortest: 0.05, longest: 0.5, period: 1.0, seed: 7 }
    }

    /// Heights and gradients on a grid of a period, y fastest; sums over it are exact for more points than twice the waves.
    fn grid(surface: &RoughSurface, [columns, rows]: [usize; 2]) -> Vec<Height> {
        let place = |i: usize, j: usize| Vector2::new(i as f64 / columns as f64, ACROSS * j as f64 / rows as f64);
        let each = |i: usize| (0..rows).map(move |j| place(i, j)).map(|place| surface.at(place).unwrap());
        (0..columns).flat_map(each).collect()
    }

    fn rms(heights: &[Height]) -> [f64; 2] {
        let mean = |f: &dyn Fn(&Height) -> f64| heights.iter().map(f).sum::<f64>() / heights.len() as f64;
        let middle = mean(&|point| point.height);
        [mean(&|point| (point.height - middle).powi(2)).sqrt(), mean(&|point| point.gradient.norm_squared()).sqrt()]
    }

    /// Of the gradient and of the height, to round-off.
    #[test]
    fn root_mean_squares_are_exact() {
        let [_, slope] = rms(&grid(&RoughSurface::new(roughness(), ACROSS), [64, 64]));
        assert!((slope / 0.1 - 1.0).abs() < 1e-12, "{slope}");
        let [height, _] =
            rms(&grid(&RoughSurface::new(Roughness { rms: Rms::Height(3e-6), ..roughness() }, ACROSS), [64, 64]));
        assert!((height / 3e-6 - 1.0).abs() < 1e-12, "{height}");
    }

    /// Against central differences, some periods away too.
    #[test]
    fn gradients_are_derivatives() {
        let surface = RoughSurface::new(roughness(), ACROSS);
        for place in [[-3.3, 0.1], [0.0, 0.0], [0.123, 7.9], [17.2, -0.3]].map(Vector2::from) {
            for axis in 0..2 {
                let step = Vector2::ith(axis, 1e-6);
                let [plus, minus] = [step, -step].map(|step| surface.at(place + step).unwrap().height);
                let slope = surface.at(place).unwrap().gradient[axis];
                assert!(((plus - minus) / 2e-6 - slope).abs() < 1e-7, "{place}");
            }
        }
    }

    /// The amplitudes, by a Fourier sum of the heights, are |q|^-(1 + H) in all directions between longest and shortest, and 0
    /// elsewhere.
    #[test]
    fn the_spectrum_is_a_power_law_in_all_directions() {
        let (columns, rows) = (48, 24);
        let heights = grid(&RoughSurface::new(Roughness { rms: Rms::Height(1.0), ..roughness() }, ACROSS), [48, 24]);
        let amplitude = |m: i64, n: i64| {
            let mut sum = [0.0; 2];
            for (k, point) in heights.iter().enumerate() {
                let turns = m as f64 * (k / rows) as f64 / columns as f64 + n as f64 * (k % rows) as f64 / rows as f64;
                let (sin, cos) = (2.0 * PI * turns).sin_cos();
                sum = [sum[0] + point.height * cos, sum[1] + point.height * sin];
            }
            2.0 * sum[0].hypot(sum[1]) / heights.len() as f64
        };
        let reference = amplitude(2, 0);
        for (m, n) in (0..=22).flat_map(|m| (-11..=11).map(move |n| (m, n))).filter(|&(m, n)| m > 0 || n > 0) {
            let q = (m as f64).hypot(n as f64 / ACROSS);
            let law = if (2.0..=20.0 + 1e-9).contains(&q) { reference * (q / 2.0).powf(-1.8) } else { 0.0 };
            assert!((amplitude(m, n) - law).abs() < 1e-12, "{m} {n}: {} {law}", amplitude(m, n));
        }
    }

    /// Phases are as good as random: as Gaussian as a sum of so many waves, neither skewed nor peaked.
    #[test]
    fn heights_are_gaussian() {
        let (mut skewness, mut kurtosis) = (0.0, 0.0);
        for seed in 0..16 {
            // All amplitudes alike, so that many waves count.
            let flat =
                Roughness { seed, hurst: 1e-9, shortest: 0.04, longest: 0.1, rms: Rms::Height(1.0), ..roughness() };
            let heights = grid(&RoughSurface::new(flat, ACROSS), [64, 32]);
            let mean = heights.iter().map(|point| point.height).sum::<f64>() / heights.len() as f64;
            let moment =
                |power| heights.iter().map(|p| (p.height - mean).powi(power)).sum::<f64>() / heights.len() as f64;
            (skewness, kurtosis) = (skewness + moment(3) / 16.0, kurtosis + moment(4) / 16.0);
        }
        assert!(skewness.abs() < 0.05 && (kurtosis - 3.0).abs() < 0.1, "{skewness} {kurtosis}");
    }

    /// Of all seeds, within 1 % of the root mean square: what the paraboloid misses.
    #[test]
    fn the_lowest_point_is_zero() {
        for seed in 0..10 {
            let surface = RoughSurface::new(Roughness { seed, rms: Rms::Height(1.0), ..roughness() }, ACROSS);
            let lowest = grid(&surface, [900, 500]).iter().map(|point| point.height).fold(1.0, f64::min);
            assert!(lowest.abs() < 1e-2, "{seed}: {lowest}");
        }
    }

    /// A finer cut of the same surface keeps the waves that both have; lines that are kept change no bit.
    #[test]
    fn waves_keep_their_phases_and_places_their_bits() {
        let [coarse, fine] =
            [0.1, 0.05].map(|shortest| RoughSurface::new(Roughness { shortest, ..roughness() }, ACROSS));
        let phase = |surface: &RoughSurface, m: usize, n: usize| {
            let wave = surface.waves[m * (2 * surface.most[1] + 1) + n + surface.most[1]];
            wave[1].atan2(wave[0])
        };
        for (m, n) in [(2, 0), (3, 2), (0, 4), (9, 1)] {
            assert!((phase(&coarse, m, n) - phase(&fine, m, n)).abs() < 1e-14);
        }
        let in_order = grid(&fine, [12, 12]);
        for (k, point) in in_order.iter().enumerate().rev() {
            let place = Vector2::new((k / 12) as f64 / 12.0, ACROSS * (k % 12) as f64 / 12.0);
            assert_eq!(fine.at(place).unwrap(), *point);
        }
    }

    /// How long a face takes; run with --release --ignored --nocapture.
    #[test]
    #[ignore = "a measurement"]
    #[allow(clippy::print_stdout)]
    fn time_to_make_and_to_evaluate() {
        for (cells, shortest) in [(64, 1.0 / 8.0), (128, 1.0 / 32.0), (256, 1.0 / 64.0), (512, 1.0 / 128.0)] {
            let statistics = Roughness { shortest, longest: 1.0, ..roughness() };
            let clock = std::time::Instant::now();
            let surface = RoughSurface::new(statistics, 1.0);
            let made = clock.elapsed();
            let clock = std::time::Instant::now();
            let place = |k: usize| Vector2::new((k / cells) as f64, (k % cells) as f64) / cells as f64;
            let sum: f64 = (0..cells * cells).map(|k| surface.at(place(k)).unwrap().height).sum();
            let each = clock.elapsed().as_secs_f64() * 1e6 / (cells * cells) as f64;
            let waves = RoughSurface::count(&statistics, 1.0);
            println!("{waves} waves: made in {made:?}, {cells} x {cells} points {each:.2} us each ({sum:e})");
        }
    }
}
