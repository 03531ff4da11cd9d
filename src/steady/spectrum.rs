//! Real numbers on the nodes of a periodic face, and their waves.

use std::sync::Arc;

use nalgebra::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

use crate::error::{Error, Result};

/// The Fourier transform of `n` numbers: X(m) = sum_j x_j e^(-2 pi i j m/n), m = 0 to n/2.
#[derive(Clone)]
pub struct Spectrum {
    nodes: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

impl Spectrum {
    /// Of so many nodes.
    pub fn new(nodes: usize) -> Self {
        let mut planner = RealFftPlanner::new();
        Self { nodes, forward: planner.plan_fft_forward(nodes), inverse: planner.plan_fft_inverse(nodes) }
    }

    /// The waves of numbers.
    pub fn waves(&self, mut numbers: Vec<f64>) -> Result<Vec<Complex<f64>>> {
        let mut waves = self.forward.make_output_vec();
        self.forward.process(&mut numbers, &mut waves).map_err(failed)?;
        Ok(waves)
    }

    /// The numbers of waves. Of the shortest one, whose conjugate it is itself, only what is real acts.
    pub fn numbers(&self, mut waves: Vec<Complex<f64>>) -> Result<Vec<f64>> {
        waves[0].im = 0.0;
        if self.nodes.is_multiple_of(2) {
            waves[self.nodes / 2].im = 0.0;
        }
        let mut numbers = self.inverse.make_output_vec();
        self.inverse.process(&mut waves, &mut numbers).map_err(failed)?;
        numbers.iter_mut().for_each(|number| *number /= self.nodes as f64);
        Ok(numbers)
    }
}

fn failed(error: realfft::FftError) -> Error {
    Error::Internal(format!("Fourier transform: {error}"))
}
