//! Real numbers on the nodes of a periodic face, and their waves.

use nalgebra::Complex;

use crate::error::Result;
use crate::solve::Transform;

/// The Fourier transform of one number for each node, those along the last axis one after the other:
/// X(k, l) = sum over both axes of x_ij e^(-2 pi i (i k/lines + j l/columns)), in the order of [`Transform`].
#[derive(Clone)]
pub struct Spectrum(Transform<1>);

impl Spectrum {
    /// Of so many nodes along each axis.
    pub fn new(counts: &[usize]) -> Self {
        Self(Transform::new(counts))
    }

    /// The waves of numbers.
    pub fn waves(&self, numbers: &[f64]) -> Result<Vec<Complex<f64>>> {
        Ok(self.0.forward(numbers)?.iter().map(|wave| Complex::new(wave[0], wave[1])).collect())
    }

    /// The numbers of waves. Of the shortest one, whose conjugate it is itself, only what is real acts.
    pub fn numbers(&self, waves: &[Complex<f64>]) -> Result<Vec<f64>> {
        let waves: Vec<_> = waves.iter().map(|wave| [wave.re, wave.im].into()).collect();
        self.0.inverse(|wave| &waves[wave])
    }
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
            let waves = spectrum.waves(&numbers).unwrap();
            for (l, k) in (0..=columns / 2).flat_map(|l| (0..lines).map(move |k| (l, k))) {
                let turn = |i: usize| {
                    let turns = (i / columns * k) as f64 / lines as f64 + (i % columns * l) as f64 / columns as f64;
                    Complex::from_polar(numbers[i], -std::f64::consts::TAU * turns)
                };
                assert!((waves[l * lines + k] - (0..nodes).map(turn).sum::<Complex<f64>>()).norm() < 1e-12);
            }
            let back = spectrum.numbers(&waves).unwrap();
            assert!(back.iter().zip(&numbers).all(|(a, b)| (a - b).abs() < 1e-13));
        }
    }
}
