//! What a profile looks like over a stretch of x.

use super::{Elevation, Profile};
use crate::error::Result;

/// A profile at equally spaced points.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// Both ends of the stretch are points.
    pub points: Vec<Elevation>,
}

impl Survey {
    /// Evaluates `profile` at the ends of `pieces` equal pieces of the stretch from `from` to `to`, m.
    ///
    /// # Errors
    /// That of the first point at which the profile is not known.
    pub fn new(profile: &dyn Profile, [from, to]: [f64; 2], pieces: usize) -> Result<Self> {
        let x = |k: usize| if k == pieces { to } else { from + (to - from) * (k as f64 / pieces as f64) };
        Ok(Self { points: (0..=pieces).map(|k| profile.at(x(k))).collect::<Result<_>>()? })
    }

    /// Lowest and highest point, m.
    pub fn range(&self) -> [f64; 2] {
        let heights = || self.points.iter().map(|point| point.height);
        [heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// Root mean square of the height about its mean, m.
    pub fn rms_height(&self) -> f64 {
        let mean = self.mean(|point| point.height);
        self.mean(|point| (point.height - mean).powi(2)).sqrt()
    }

    /// Root mean square of the slope.
    pub fn rms_slope(&self) -> f64 {
        self.mean(|point| point.slope.powi(2)).sqrt()
    }

    /// By the trapezoidal rule.
    fn mean(&self, value: impl Fn(&Elevation) -> f64) -> f64 {
        let pieces = (self.points.len() - 1) as f64;
        let sum: f64 = self.points.iter().map(&value).sum();
        let ends = value(&self.points[0]) + value(&self.points[self.points.len() - 1]);
        (sum - 0.5 * ends) / pieces
    }

    /// A drawing of `columns` letters by `rows` lines, up is up: the indenter, `#`, above the face, `-`, and under the
    /// face `^` where it is lowest and touches first. The lowest point of each column counts.
    pub fn drawing(&self, columns: usize, rows: usize) -> Vec<String> {
        let last = self.points.len() - 1;
        let lowest = |c: usize| {
            let part = &self.points[c * last / columns..=((c + 1) * last / columns)];
            part.iter().map(|point| point.height).fold(f64::INFINITY, f64::min)
        };
        let [low, high] = self.range();
        // How far a column's lowest point is above the lowest of all, in lines.
        let level = |c: usize| match (lowest(c) - low) / (high - low) * rows as f64 {
            level if level.is_nan() => 0.0,
            level => level,
        };
        let levels: Vec<f64> = (0..columns).map(level).collect();
        let line = |row: usize| levels.iter().map(|&level| if level < row as f64 + 0.5 { '#' } else { ' ' }).collect();
        let nearest = levels.iter().copied().fold(f64::INFINITY, f64::min);
        let touching = |level: &f64| if *level <= nearest + 0.05 { '^' } else { ' ' };
        let mut lines: Vec<String> = (0..rows).rev().map(line).collect();
        lines.push("-".repeat(columns));
        lines.push(levels.iter().map(touching).collect());
        lines
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::profile::{Harmonic, Wedge};

    #[test]
    fn a_wave_has_its_moments() {
        let wave = Harmonic { amplitude: 2.0, wavelength: 0.5 };
        let survey = Survey::new(&wave, [0.0, 1.0], 64).unwrap();
        let [low, high] = survey.range();
        assert!(low.abs() < 1e-15 && (high - 4.0).abs() < 1e-15);
        assert!((survey.rms_height() - 2f64.sqrt()).abs() < 1e-14);
        assert!((survey.rms_slope() - 8.0 * std::f64::consts::PI / 2f64.sqrt()).abs() < 1e-13);
    }

    #[test]
    fn a_drawing_has_the_indenter_above_and_the_lowest_point_marked() {
        let wedge = Wedge { slope: 1.0, centre: 0.5 };
        let lines = Survey::new(&wedge, [0.0, 1.0], 160).unwrap().drawing(8, 3);
        assert_eq!(lines, ["########", "  ####  ", "   ##   ", "--------", "   ^^   "]);
        assert_eq!(Survey::new(&wedge, [0.0, 1.0], 3).unwrap().drawing(8, 2)[0].chars().count(), 8);
    }
}
