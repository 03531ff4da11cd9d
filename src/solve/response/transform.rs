//! The Fourier transform of the nodes of a periodic face.

use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::SMatrix;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use crate::error::{Error, Result};

/// w of a row of nodes at one wave vector: (v, u_z) by (real, imaginary) part. Fields of a layer hold, for each wave vector,
/// one of them per row from the face down.
pub type Wave<const D: usize> = SMatrix<f64, D, 2>;

/// The transform of a row of nodes: along its last axis that of real numbers, along the one before it that of complex ones.
///
/// Wave (k, l), l = 0 to columns/2 of the last axis and k = 0 to lines - 1 of the other (1 in the plane), is at l times the lines
/// plus k; what is left out is the complex conjugate of what there is.
#[derive(Clone)]
pub struct Transform<const D: usize> {
    lines: usize,
    columns: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    /// Across the lines, there and back.
    across: [Arc<dyn Fft<f64>>; 2],
}

impl<const D: usize> Transform<D> {
    /// For faces with so many nodes along each axis.
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

    /// How many nodes there are.
    pub fn nodes(&self) -> usize {
        self.lines * self.columns
    }

    /// How many wave vectors there are.
    pub fn waves(&self) -> usize {
        self.lines * (self.columns / 2 + 1)
    }

    /// The node that is as far from the first as node i is from node j.
    pub fn apart(&self, i: usize, j: usize) -> usize {
        let (n, m) = (self.lines, self.columns);
        let (line, column) = ((i / m + n - j / m) % n, (i % m + m - j % m) % m);
        line * m + column
    }

    /// By what a wave leads from one node to the next along each axis of the face, in the order of the axes.
    pub fn angles(&self, wave: usize) -> [f64; 2] {
        let angle = |k: usize, count: usize| 2.0 * PI * k as f64 / count as f64;
        let last = angle(wave / self.lines, self.columns);
        if D == 2 { [last, 0.0] } else { [angle(wave % self.lines, self.lines), last] }
    }

    /// For how many waves one stands: itself, and its conjugate where that is left out.
    pub fn stands_for(&self, wave: usize) -> f64 {
        let l = wave / self.lines;
        if l == 0 || 2 * l == self.columns { 1.0 } else { 2.0 }
    }

    /// The waves of the components of each node; a component that is nothing costs nothing.
    pub fn forward(&self, values: &[f64]) -> Result<Vec<Wave<D>>> {
        let mut waves = vec![Wave::zeros(); self.waves()];
        let mut row = self.forward.make_input_vec();
        let half = self.columns / 2 + 1;
        let [mut by_line, mut by_wave] = [0; 2].map(|_| vec![Complex::default(); self.waves()]);
        let mut scratch = self.forward.make_scratch_vec();
        for component in (0..D).filter(|&component| values.iter().skip(component).step_by(D).any(|value| *value != 0.0))
        {
            for (of_line, spectrum) in values.chunks_exact(D * self.columns).zip(by_line.chunks_exact_mut(half)) {
                row.iter_mut().zip(of_line.chunks_exact(D)).for_each(|(row, node)| *row = node[component]);
                self.forward.process_with_scratch(&mut row, spectrum, &mut scratch).map_err(transform_failed)?;
            }
            let all = match self.lines {
                1 => &by_line,
                lines => {
                    transpose::transpose(&by_line, &mut by_wave, half, lines);
                    self.across[0].process(&mut by_wave);
                    &by_wave
                }
            };
            for (wave, c) in waves.iter_mut().zip(all) {
                // v = -i u
                let part = if component + 1 < D { [c.im, -c.re] } else { [c.re, c.im] };
                (wave[(component, 0)], wave[(component, 1)]) = (part[0], part[1]);
            }
        }
        Ok(waves)
    }

    /// The components of each node.
    pub fn inverse<'a>(&self, waves: impl Iterator<Item = &'a Wave<D>> + Clone) -> Result<Vec<f64>> {
        self.inverse_of(waves, 0..D)
    }

    /// Some of the components of each node; the others are left at zero.
    pub fn inverse_of<'a>(
        &self,
        waves: impl Iterator<Item = &'a Wave<D>> + Clone,
        components: Range<usize>,
    ) -> Result<Vec<f64>> {
        let mut values = vec![0.0; D * self.nodes()];
        let (mut row, mut scratch) = (self.inverse.make_output_vec(), self.inverse.make_scratch_vec());
        let half = self.columns / 2 + 1;
        let [mut by_line, mut by_wave] = [0; 2].map(|_| vec![Complex::default(); self.waves()]);
        for component in components {
            let first = if self.lines == 1 { &mut by_line } else { &mut by_wave };
            for (c, wave) in first.iter_mut().zip(waves.clone()) {
                let (re, im) = (wave[(component, 0)], wave[(component, 1)]);
                *c = if component + 1 < D { Complex::new(-im, re) } else { Complex::new(re, im) };
            }
            if self.lines > 1 {
                self.across[1].process(&mut by_wave);
                transpose::transpose(&by_wave, &mut by_line, self.lines, half);
            }
            for (spectrum, of_line) in by_line.chunks_exact_mut(half).zip(values.chunks_exact_mut(D * self.columns)) {
                // Real but for round-off.
                spectrum[0].im = 0.0;
                if self.columns.is_multiple_of(2) {
                    spectrum[half - 1].im = 0.0;
                }
                self.inverse.process_with_scratch(spectrum, &mut row, &mut scratch).map_err(transform_failed)?;
                let nodes = of_line.chunks_exact_mut(D).zip(&row);
                nodes.for_each(|(node, row)| node[component] = row / self.nodes() as f64);
            }
        }
        Ok(values)
    }
}

fn transform_failed(error: realfft::FftError) -> Error {
    Error::Internal(format!("Fourier transform: {error}"))
}
