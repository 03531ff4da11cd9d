//! Real numbers on the nodes of a periodic face, and their waves.

use std::sync::Arc;

use nalgebra::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};

use crate::error::{Error, Result};

/// The Fourier transform of the numbers of the nodes, those along the last axis one after the other:
/// X(k, l) = sum over both axes of x_ij e^(-2 pi i (i k/lines + j l/columns)), l = 0 to columns/2 and k = 0 to lines - 1 (1 in the
/// plane), in the order of [`crate::solve::Travelling`]: l times the lines plus k.
#[derive(Clone)]
pub struct Spectrum {
    lines: usize,
    columns: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    /// Across the lines, there and back.
    across: [Arc<dyn Fft<f64>>; 2],
}

impl Spectrum {
    /// Of so many nodes along each axis.
    pub fn new(counts: &[usize]) -> Self {
        let columns = counts.last().copied().unwrap_or(1);
        let lines = counts.iter().rev().skip(1).product();
        let (mut real, mut complex) = (RealFftPlanner::new(), FftPlanner::new());
        Self {
            lines,
            columns,
            forward: real.plan_fft_forward(columns),
            inverse: real.plan_fft_inverse(columns),
            across: [complex.plan_fft_forward(lines), complex.plan_fft_inverse(lines)],
        }
    }

    /// The waves of numbers.
    pub fn waves(&self, mut numbers: Vec<f64>) -> Result<Vec<Complex<f64>>> {
        let mut waves = vec![Complex::default(); self.lines * (self.columns / 2 + 1)];
        let mut along = self.forward.make_output_vec();
        for (k, line) in numbers.chunks_exact_mut(self.columns).enumerate() {
            self.forward.process(line, &mut along).map_err(failed)?;
            along.iter().enumerate().for_each(|(l, wave)| waves[l * self.lines + k] = *wave);
        }
        if self.lines > 1 {
            self.across[0].process(&mut waves);
        }
        Ok(waves)
    }

    /// The numbers of waves. Of the shortest one, whose conjugate it is itself, only what is real acts.
    pub fn numbers(&self, mut waves: Vec<Complex<f64>>) -> Result<Vec<f64>> {
        if self.lines > 1 {
            self.across[1].process(&mut waves);
        }
        let nodes = self.lines * self.columns;
        let mut numbers = vec![0.0; nodes];
        let mut along = self.inverse.make_input_vec();
        for (k, line) in numbers.chunks_exact_mut(self.columns).enumerate() {
            along.iter_mut().enumerate().for_each(|(l, wave)| *wave = waves[l * self.lines + k]);
            along[0].im = 0.0;
            if self.columns.is_multiple_of(2) {
                along[self.columns / 2].im = 0.0;
            }
            self.inverse.process(&mut along, line).map_err(failed)?;
        }
        numbers.iter_mut().for_each(|number| *number /= nodes as f64);
        Ok(numbers)
    }
}

fn failed(error: realfft::FftError) -> Error {
    Error::Internal(format!("Fourier transform: {error}"))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// There and back on faces of even and odd counts; a wave is where it is said to be.
    #[test]
    fn waves_are_where_they_are_said_to_be() {
        for counts in [vec![6], vec![5], vec![4, 6], vec![5, 4], vec![3, 7]] {
            let (columns, nodes) = (counts[counts.len() - 1], counts.iter().product::<usize>());
            let lines = nodes / columns;
            let spectrum = Spectrum::new(&counts);
            let numbers: Vec<f64> = (0..nodes).map(|i| ((7 * i + 3) % 11) as f64 - 4.0).collect();
            let waves = spectrum.waves(numbers.clone()).unwrap();
            for (l, k) in (0..=columns / 2).flat_map(|l| (0..lines).map(move |k| (l, k))) {
                let turn = |i: usize| {
                    let turns = (i / columns * k) as f64 / lines as f64 + (i % columns * l) as f64 / columns as f64;
                    Complex::from_polar(numbers[i], -std::f64::consts::TAU * turns)
                };
                assert!((waves[l * lines + k] - (0..nodes).map(turn).sum::<Complex<f64>>()).norm() < 1e-12);
            }
            let back = spectrum.numbers(waves).unwrap();
            assert!(back.iter().zip(&numbers).all(|(a, b)| (a - b).abs() < 1e-13));
        }
    }
}
