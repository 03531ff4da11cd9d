//! Axes: their ends, their ticks, and where a value stands.

use plotters::prelude::DrawingBackend;

use super::numbers::power;
use super::painter::{Painter, TICK};
use super::ticks::{Tick, linear, ticks};
use super::{Axis, Scale};

/// The share of a broken axis that is behind the break, and the width of the break, px.
const BEYOND: f64 = 0.27;
const BREAK: f64 = 14.0;

/// An axis with its ends and ticks.
pub struct Ruler {
    /// The quantity, the power of ten that the ticks leave out, the unit.
    pub label: String,
    /// Its ticks.
    pub ticks: Vec<Tick>,
    scale: Scale,
    stretches: Vec<(f64, f64)>,
}

/// From values to positions along one side of the frame.
pub struct Mapping {
    scale: Scale,
    /// Ascending; at least one.
    stretches: Vec<Stretch>,
}

/// Values at the two ends, and their positions, px.
struct Stretch {
    range: (f64, f64),
    ends: (f64, f64),
}

impl Ruler {
    /// An axis around `values`, with at most about `most` labels.
    pub fn new(axis: &Axis, values: impl Iterator<Item = f64>, most: usize) -> Self {
        let range = range(axis, values);
        let stretches: Vec<_> = [range].into_iter().chain(axis.beyond).collect();
        let (ticks, exponent) = match axis.beyond {
            _ if !axis.names.is_empty() => {
                let tick = |(i, name): (usize, &String)| Tick { at: (i + 1) as f64, label: Some(name.clone()) };
                (axis.names.iter().enumerate().map(tick).collect(), 0)
            }
            Some(beyond) => linear(&[(range, most), (beyond, 3)]),
            None => ticks(axis.scale, range, most),
        };
        Self { label: with_power(&axis.label, exponent), ticks, scale: axis.scale, stretches }
    }

    /// The values from one position to another, px.
    pub fn along(&self, from: f64, to: f64) -> Mapping {
        let length = to - from;
        let [near, far] = match self.stretches.len() {
            1 => [1.0, 1.0],
            _ => [1.0 - BEYOND - 0.5 * BREAK / length.abs(), 1.0 - BEYOND + 0.5 * BREAK / length.abs()],
        };
        let ends = [(from, from + near * length), (from + far * length, to)];
        let stretch = |(range, ends): (&(f64, f64), (f64, f64))| Stretch { range: *range, ends };
        Mapping { scale: self.scale, stretches: self.stretches.iter().zip(ends).map(stretch).collect() }
    }

    /// The width of the widest label of a tick, px.
    pub fn widest<DB: DrawingBackend>(&self, painter: &Painter<DB>) -> f64 {
        let labels = self.ticks.iter().filter_map(|tick| tick.label.as_deref());
        labels.map(|label| painter.width(label, TICK)).fold(0.0, f64::max)
    }
}

impl Mapping {
    /// The position of `value`, px; none where the axis has none.
    pub fn position(&self, value: f64) -> Option<f64> {
        let of = |value: f64| match self.scale {
            Scale::Linear => value,
            Scale::Log => value.ln(),
        };
        let between = |range: (f64, f64), ends: (f64, f64)| {
            let part = (of(value) - of(range.0)) / (of(range.1) - of(range.0));
            ends.0 + part * (ends.1 - ends.0)
        };
        let index = self.stretches.iter().rposition(|stretch| value >= stretch.range.0).unwrap_or(0);
        let position = match (&self.stretches[index], self.stretches.get(index + 1)) {
            // Across the break.
            (here, Some(next)) if value > here.range.1 => {
                between((here.range.1, next.range.0), (here.ends.1, next.ends.0))
            }
            (here, _) => between(here.range, here.ends),
        };
        // Far outside is outside; the clipping must not overflow.
        (!position.is_nan()).then_some(position.clamp(-1e9, 1e9))
    }

    /// The ends of each stretch, px.
    pub fn ends(&self) -> impl Iterator<Item = (f64, f64)> {
        self.stretches.iter().map(|stretch| stretch.ends)
    }
}

/// The label of an axis with the power of ten that its ticks leave out.
pub fn with_power(label: &str, exponent: i32) -> String {
    match exponent {
        0 => label.to_owned(),
        exponent => match label.rsplit_once(", ") {
            Some((quantity, unit)) => format!("{quantity}, {} {unit}", power(exponent)),
            None => format!("{label}, {}", power(exponent)),
        },
    }
}

/// The ends of an axis: as given, or around the data with a little air. Always ascending, and wide enough for ticks to
/// be told apart.
fn range(axis: &Axis, values: impl Iterator<Item = f64>) -> (f64, f64) {
    let log = axis.scale == Scale::Log;
    let usable = |value: &f64| value.is_finite() && (!log || *value > 0.0);
    let of = |value: f64| if log { value.clamp(1e-300, 1e300).ln() } else { value.clamp(-1e300, 1e300) };
    let back = |value: f64| if log { value.exp().clamp(1e-307, 1e307) } else { value };
    let (low, high) = match axis.range {
        Some((from, to)) => (of(from), of(to)),
        None => {
            let values = values.filter(usable).map(of);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
        }
    };
    if low > high || low.is_nan() || high.is_nan() {
        return (1.0, 10.0);
    }
    let least = if log { 1e-6 } else { 1e-9 * low.abs().max(high.abs()) };
    if high - low <= least {
        let air = if log || low == 0.0 { 1.0 } else { 0.5 * low.abs() };
        return (back(low - air), back(high + air));
    }
    let air = if axis.range.is_some() { 0.0 } else { 0.04 * (high - low) };
    (back(low - air), back(high + air))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broken_axis_is_continuous_and_rises_over_its_break() {
        let axis = Axis { beyond: Some((10.0, 12.0)), ..Axis::linear("Q, N").over(0.0, 1.0) };
        let mapping = Ruler::new(&axis, std::iter::empty(), 5).along(400.0, 0.0);
        let at = [0.0, 0.5, 1.0, 1.1, 9.9, 10.0, 12.0].map(|value| mapping.position(value).unwrap_or(f64::NAN));
        assert!(at.windows(2).all(|pair| pair[1] < pair[0]), "{at:?}");
        assert_eq!((at[0], at[6], at[2] - at[5]), (400.0, 0.0, BREAK));
    }
}
