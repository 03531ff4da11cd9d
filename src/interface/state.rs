//! What is known of a point of the contact once a step is solved.

use nalgebra::SVector;

use crate::friction::Law;

/// A point at an accepted state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<const D: usize> {
    /// p, Pa, positive in compression.
    pub pressure: f64,
    /// q, Pa, on the layer, tangential.
    pub shear: SVector<f64, D>,
    /// o, m; negative where there is a gap.
    pub overlap: f64,
    /// Slip of the indenter against the layer over the last step, m.
    pub slip: SVector<f64, D>,
    /// By how much the point has slipped while it was to stick, m: what the regularisation lets it do.
    pub stuck: SVector<f64, D>,
    /// The slip for good of all steps in contact, m.
    pub slid: f64,
    /// What has worn off over the point, m, of the body or of the indenter.
    pub worn: f64,
    /// Whether it sticks.
    pub sticks: bool,
}

impl<const D: usize> Default for State<D> {
    fn default() -> Self {
        let none = SVector::zeros();
        Self { pressure: 0.0, shear: none, overlap: 0.0, slip: none, stuck: none, slid: 0.0, worn: 0.0, sticks: false }
    }
}

impl<const D: usize> State<D> {
    /// How many numbers it is in a list.
    pub const NUMBERS: usize = 5 + 3 * D;

    /// The elastic part of the slip that the next step begins with, m.
    pub fn elastic(&self, law: &dyn Law) -> SVector<f64, D> {
        if law.holds() { self.stuck } else { SVector::zeros() }
    }

    /// `stuck` after a step that ends with `slip`, what a law answered to, of which the step's own part is `of_step`.
    pub fn stuck_after(
        &self,
        law: &dyn Law,
        sticks: bool,
        (slip, of_step): (SVector<f64, D>, SVector<f64, D>),
    ) -> SVector<f64, D> {
        let length = slip.norm();
        match sticks {
            _ if law.holds() && length > 0.0 => slip * (law.elastic(length) / length),
            true if !law.holds() => self.stuck + of_step,
            _ => SVector::zeros(),
        }
    }

    /// The same after a step in which nothing moved.
    pub fn at_rest(&self) -> Self {
        Self { slip: SVector::zeros(), ..*self }
    }

    /// Whether its gap is closed: where nothing pulls, whether p > 0.
    pub fn touches(&self) -> bool {
        self.pressure > 0.0 || self.pressure < 0.0 && self.overlap >= 0.0
    }

    /// q - p n, Pa.
    pub fn on_layer(&self, normal: &SVector<f64, D>) -> SVector<f64, D> {
        self.shear - normal * self.pressure
    }

    /// As numbers.
    pub fn write(&self, list: &mut Vec<f64>) {
        list.extend([self.pressure, self.overlap, self.slid, self.worn, f64::from(u8::from(self.sticks))]);
        for vector in [&self.shear, &self.slip, &self.stuck] {
            list.extend(vector.iter());
        }
    }

    /// From [`Self::NUMBERS`] numbers.
    pub fn read(list: &[f64]) -> Self {
        let vector = |i: usize| SVector::from_column_slice(&list[5 + i * D..][..D]);
        Self {
            pressure: list[0],
            overlap: list[1],
            slid: list[2],
            worn: list[3],
            sticks: list[4] != 0.0,
            shear: vector(0),
            slip: vector(1),
            stuck: vector(2),
        }
    }
}
