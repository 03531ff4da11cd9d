//! A measured history that drives a phase.

use nalgebra::Vector2;
use serde::Serialize;

use super::{Motion, Phase};

/// The columns of a file of measured motion; those that it lacks are empty, all others are as long as `time`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Record {
    /// As typed.
    pub file: String,
    /// The checksum of its bytes, where it was read for this scene, which then depends on it.
    #[serde(skip)]
    pub checksum: Option<String>,
    /// s since the phase began, at least 0, ascending; the last is above 0.
    pub time: Vec<f64>,
    /// The normal approach of the indenter, m.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub approach: Vec<f64>,
    /// The normal force on the indenter, N/m, at least 0; not beside `approach`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub normal_force: Vec<f64>,
    /// The sliding along x, m, of which that at 0 s, where there is a row, is where the phase found the indenter.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sliding_x: Vec<f64>,
    /// The same along y.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sliding_y: Vec<f64>,
}

impl Record {
    /// When it ends, s.
    pub fn end(&self) -> f64 {
        self.time.last().copied().unwrap_or(0.0)
    }

    /// How many rows it has.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether it has none; such a scene is refused.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// What has the times of a column.
    pub fn rows<'a>(&'a self, column: &'a [f64]) -> impl Iterator<Item = (f64, f64)> + 'a {
        self.time.iter().copied().zip(column.iter().copied())
    }

    /// Whether it has a column of sliding.
    pub fn slides(&self) -> bool {
        !(self.sliding_x.is_empty() && self.sliding_y.is_empty())
    }

    /// How far it has slid at each time since 0 s, m.
    pub fn slid(&self) -> Vec<(f64, Vector2<f64>)> {
        let gone = |column: &[f64], row: usize| column.get(row).copied().unwrap_or(0.0);
        let at = |row: usize| Vector2::new(gone(&self.sliding_x, row), gone(&self.sliding_y, row));
        let zero = if self.time.first() == Some(&0.0) { at(0) } else { Vector2::zeros() };
        self.time.iter().enumerate().map(|(row, time)| (*time, at(row) - zero)).collect()
    }
}

impl Phase {
    /// What drives it, where that was measured.
    pub fn record(&self) -> Option<&Record> {
        match &self.motion {
            Motion::Measured(record) => Some(record),
            Motion::Velocity(_) | Motion::Tangential { .. } => None,
        }
    }

    /// The approaches that it is told, m, with the times since its beginning, s: that at its end, or those that were measured.
    pub fn approaches(&self) -> Vec<(f64, f64)> {
        self.told(|record| &record.approach, self.approach)
    }

    /// The same of the normal forces, N/m.
    pub fn forces(&self) -> Vec<(f64, f64)> {
        self.told(|record| &record.normal_force, self.normal_force)
    }

    fn told(&self, column: impl Fn(&Record) -> &Vec<f64>, at_its_end: Option<f64>) -> Vec<(f64, f64)> {
        let measured = self.record().map(|record| {
            // Up to the row that the last stretch of the phase leads to.
            let reached = record.time.partition_point(|time| *time < self.duration) + 1;
            record.rows(column(record)).take(reached)
        });
        measured.into_iter().flatten().chain(at_its_end.map(|value| (self.duration, value))).collect()
    }

    /// The key by which it says its approach.
    pub fn approach_key(&self) -> String {
        format!("phase.{}.{}", self.name, if self.record().is_some() { "motion" } else { "approach" })
    }

    /// Whether it says a normal force.
    pub fn says_force(&self) -> bool {
        self.normal_force.is_some() || self.record().is_some_and(|record| !record.normal_force.is_empty())
    }
}
