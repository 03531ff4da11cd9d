//! A measured path: straight between its rows.

use std::ops::{Add, Mul, Sub};
use std::sync::Arc;

/// Rows (time since the phase began, value) with ascending times. The path begins where the phase found things, and is straight
/// to the first row after that; a row at the beginning itself that says otherwise is a jump, which takes the first step.
/// Beyond the last row its value stays.
#[derive(Debug, Clone, PartialEq)]
pub struct Track<T> {
    rows: Arc<[(f64, T)]>,
}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>> Track<T> {
    /// Of one row or more.
    pub fn new(rows: impl IntoIterator<Item = (f64, T)>) -> Self {
        Self { rows: rows.into_iter().collect() }
    }

    /// The ends of the stretch that `local`, s, is in or ends.
    fn stretch(&self, start: T, local: f64) -> [(f64, T); 2] {
        let next = self.rows.partition_point(|(time, _)| *time < local);
        let before = next.checked_sub(1).map_or((0.0, start), |last| self.rows[last]);
        [before, self.rows.get(next).copied().unwrap_or(before)]
    }

    /// Its value at `local`, s; `start` at the beginning.
    pub fn at(&self, start: T, local: f64) -> T {
        if local <= 0.0 {
            return start;
        }
        let [(from, before), (to, after)] = self.stretch(start, local);
        if to > from { before + (after - before) * ((local - from) / (to - from)) } else { after }
    }

    /// Its mean rate over the `dt` before `local`, s. Within a stretch that is the stretch's own, which keeps the digits of short
    /// steps.
    pub fn rate(&self, start: T, local: f64, dt: f64) -> T {
        let [(from, before), (to, after)] = self.stretch(start, local);
        // Against round-off in the clock.
        let (begun, near) = (local - dt, 1e-9 * dt);
        let jumps = begun <= near && self.rows.first().is_some_and(|(time, _)| *time <= 0.0);
        if to > from && begun >= from - near && !jumps {
            return (after - before) * (to - from).recip();
        }
        let earlier = self.at(start, if begun <= near { 0.0 } else { begun });
        (self.at(start, local) - earlier) * dt.recip()
    }

    /// The rows before `end`, s.
    pub fn before(&self, end: f64) -> &[(f64, T)] {
        &self.rows[..self.rows.partition_point(|(time, _)| *time < end)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Straight from the start to the first row and between rows; rates are difference quotients, also over a row and out of a jump.
    #[test]
    fn straight_between_rows() {
        let track = Track::new([(1.0, 2.0), (3.0, 1.0)]);
        for (local, value) in [(0.0, 0.5), (0.5, 1.25), (1.0, 2.0), (2.0, 1.5), (3.0, 1.0), (9.0, 1.0)] {
            assert_eq!(track.at(0.5, local), value, "{local}");
        }
        for (local, dt) in [(1.0, 1.0), (0.75, 0.25), (1.5, 1.0), (3.0, 2.0), (2.5, 0.5), (3.0, 3.0), (4.0, 0.5)] {
            let quotient = (track.at(0.5, local) - track.at(0.5, local - dt)) / dt;
            assert!((track.rate(0.5, local, dt) - quotient).abs() < 1e-15, "{local} {dt}");
        }
        let jump = Track::new([(0.0, 4.0), (2.0, 4.0)]);
        assert_eq!((jump.at(1.0, 0.0), jump.at(1.0, 0.5)), (1.0, 4.0));
        assert_eq!((jump.rate(1.0, 0.5, 0.5), jump.rate(1.0, 1.0, 0.5)), (6.0, 0.0));
        assert_eq!(jump.before(2.0), [(0.0, 4.0)]);
    }
}
