//! One wave of a layer that vibrates: the moduli of its parts are complex, the elimination is that of [`super`].

use nalgebra::{Complex, SMatrix, SVector};

use super::{Operator, Pivot, Row, eliminated};
use crate::error::Result;

/// The block elimination of one wave vector.
pub struct Vibration<const D: usize> {
    /// Per row, from the face down.
    pivots: Vec<Pivot<D, Complex<f64>>>,
}

impl<const D: usize> Vibration<D> {
    /// Of sum_p factor_p part_p at a wave vector.
    pub fn new(parts: &[Operator<D>], wave: usize, factors: &[Complex<f64>]) -> Result<Self> {
        let row = |j: usize| {
            let mut row = Row { diagonal: SMatrix::zeros(), coupling: SMatrix::zeros() };
            for (part, &factor) in parts.iter().zip(factors) {
                let Row { diagonal, coupling } = part.of(wave)[j];
                row.diagonal += diagonal.map(|entry| factor * entry);
                row.coupling += coupling.map(|entry| factor * entry);
            }
            row
        };
        Ok(Self { pivots: eliminated(&(0..parts[0].rows).map(row).collect::<Vec<_>>(), wave == 0)? })
    }

    /// P_0: the compliance of the face.
    pub fn face(&self) -> SMatrix<Complex<f64>, D, D> {
        self.pivots[0].inverse
    }

    /// w of each row under a force on the face.
    pub fn column(&self, force: SVector<Complex<f64>, D>) -> Vec<SVector<Complex<f64>, D>> {
        let mut w = vec![self.face() * force];
        for pair in self.pivots.windows(2) {
            w.push(-(pair[1].inverse * (pair[0].coupling.tr_mul(&w[w.len() - 1]))));
        }
        w
    }
}

impl<const D: usize> Operator<D> {
    /// The rows of a wave vector.
    fn of(&self, wave: usize) -> &[Row<D>] {
        &self.blocks[wave * self.rows..][..self.rows]
    }

    /// w* K w at a wave vector, for w of each row: real, as K is real and symmetric.
    pub fn form(&self, wave: usize, w: &[SVector<Complex<f64>, D>]) -> f64 {
        let of = |part: fn(Complex<f64>) -> f64| -> f64 {
            let w: Vec<SVector<f64, D>> = w.iter().map(|w| w.map(part)).collect();
            let below = |j: usize| w.get(j + 1).copied().unwrap_or_else(SVector::zeros);
            let rows = self.of(wave).iter().enumerate();
            rows.map(|(j, row)| w[j].dot(&(row.diagonal * w[j] + row.coupling * below(j) * 2.0))).sum()
        };
        of(|w| w.re) + of(|w| w.im)
    }
}
