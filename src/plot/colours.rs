//! Colours that stand for numbers, in an order that readers with any colour vision see.

use super::Colour;

/// A range of colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ramp {
    /// From dark violet to yellow, ever lighter: viridis (Smith and van der Walt, 2015).
    Sequential,
    /// From blue over white to red, for values about zero: RdBu (Brewer, 2002).
    Diverging,
}

const VIRIDIS: [Colour; 9] = [
    (68, 1, 84),
    (71, 44, 122),
    (59, 81, 139),
    (44, 113, 142),
    (33, 144, 141),
    (39, 173, 129),
    (92, 200, 99),
    (170, 220, 50),
    (253, 231, 37),
];

const BLUE_RED: [Colour; 9] = [
    (33, 102, 172),
    (67, 147, 195),
    (146, 197, 222),
    (209, 229, 240),
    (247, 247, 247),
    (253, 219, 199),
    (244, 165, 130),
    (214, 96, 77),
    (178, 24, 43),
];

impl Ramp {
    /// The colour at `part` of the range, from 0 to 1.
    pub fn at(self, part: f64) -> Colour {
        let stops = match self {
            Self::Sequential => VIRIDIS,
            Self::Diverging => BLUE_RED,
        };
        let part = if part.is_nan() { 0.0 } else { part.clamp(0.0, 1.0) };
        let place = part * (stops.len() - 1) as f64;
        let first = (place as usize).min(stops.len() - 2);
        let (low, high, rest) = (stops[first], stops[first + 1], place - first as f64);
        let mix = |a: u8, b: u8| (f64::from(a) + rest * (f64::from(b) - f64::from(a))).round() as u8;
        (mix(low.0, high.0), mix(low.1, high.1), mix(low.2, high.2))
    }

    /// `count` colours for lines on white: the palest of the range are left out.
    pub fn lines(count: usize) -> Vec<Colour> {
        let last = count.saturating_sub(1).max(1) as f64;
        (0..count).map(|i| Self::Sequential.at(0.86 * i as f64 / last)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_stops_are_met() {
        assert_eq!(Ramp::Sequential.at(0.0), (68, 1, 84));
        assert_eq!(Ramp::Sequential.at(2.0), (253, 231, 37));
        assert_eq!(Ramp::Diverging.at(0.5), (247, 247, 247));
        assert_eq!(Ramp::lines(1), [(68, 1, 84)]);
        assert_eq!(Ramp::lines(3).len(), 3);
    }
}
