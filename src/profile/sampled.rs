//! A measured profile: elevations at sampling points, linear between them.

use super::{Elevation, Profile};
use crate::error::{Error, Result};

/// h(x_k) = h_k at the sampling points, the numbers unchanged; between them
///
///   h(x) = h_k + s_k (x - x_k),   s_k = (h_k+1 - h_k) / (x_k+1 - x_k),   dh/dx = s_k;
///
/// at a sampling point dh/dx = (s_k-1 + s_k) / 2, and the one slope there is at the ends of a bounded profile. A place
/// within round-off of a sampling point is that point.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    points: Vec<Point>,
    /// None = bounded.
    period: Option<f64>,
    /// Places this near, m, are one.
    near: f64,
}

/// A jump where the profile repeats is a wall from so many mean steps between neighbours on. Of uncorrelated heights
/// the difference is as large once in a million times.
pub const WALL: f64 = 5.0;

/// The share of the period, at each end, over which ends are blended.
pub const BLEND: f64 = 0.05;

/// A sampling point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// m
    pub x: f64,
    /// m
    pub height: f64,
}

impl Sampled {
    /// The profile through `points`, two or more with ascending x.
    ///
    /// With a period, which is not less than the distance from the first point to the last, the profile repeats: the
    /// point after the last is the first of the next period. A point exactly one period after the first is left out.
    pub fn new(mut points: Vec<Point>, period: Option<f64>) -> Self {
        let first = points.first().map_or(0.0, |point| point.x);
        let last = points.last().map_or(0.0, |point| point.x);
        // Some units in the last place of the largest number that takes part.
        let near = 16.0 * f64::EPSILON * first.abs().max(last.abs()).max(period.unwrap_or(0.0));
        if let Some(period) = period
            && last - first > period - near
        {
            points.pop();
        }
        Self { points, period, near }
    }

    /// The distance after which a profile repeats of which `points` are one period:
    ///
    /// where the last elevation is the first, the last point is the beginning of the next period, and the period is
    /// the distance between them; otherwise the points are equally spaced (to 1 % of the spacing, else None) and the
    /// period is that distance and one spacing.
    pub fn natural_period(points: &[Point]) -> Option<f64> {
        let (first, last) = (points.first()?, points.last()?);
        let span = last.x - first.x;
        if first.height == last.height {
            return Some(span);
        }
        let spacing = span / (points.len() - 1) as f64;
        let equal = |pair: &[Point]| (pair[1].x - pair[0].x - spacing).abs() <= 1e-2 * spacing;
        points.windows(2).all(equal).then_some(span + spacing)
    }

    /// How far apart in elevation the ends of the points are, m, if that is a wall where they repeat: more than
    /// [`WALL`] times the root mean square step between neighbours.
    pub fn wall(points: &[Point]) -> Option<f64> {
        let jump = (points.first()?.height - points.last()?.height).abs();
        let squares: f64 = points.windows(2).map(|pair| (pair[1].height - pair[0].height).powi(2)).sum();
        let step = (squares / (points.len() - 1) as f64).sqrt();
        (jump > WALL * step).then_some(jump)
    }

    /// Lets both ends of one `period`, m, of `points` go over into the mean of the two, each by half of the jump over
    /// [`BLEND`] of the period: h -> h +- jump/2 (3 s^2 - 2 s^3), s from 0 inside to 1 at the end.
    pub fn blend(points: &mut [Point], period: f64) {
        let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else { return };
        let (jump, length) = (first.height - last.height, BLEND * period);
        for point in &mut *points {
            point.height += jump * (ramp(last.x - point.x, length) - ramp(point.x - first.x, length));
        }
        // Not even by round-off apart.
        let end = points[0].height;
        points[points.len() - 1].height = end;
    }

    /// What it repeats after, m; None = it is bounded.
    pub fn period(&self) -> Option<f64> {
        self.period
    }

    /// The sampling point `k`, counted on through all periods, or None beyond the ends.
    fn point(&self, k: isize) -> Option<Point> {
        let n = self.points.len() as isize;
        let Some(period) = self.period else { return self.points.get(usize::try_from(k).ok()?).copied() };
        let Point { x, height } = self.points[k.rem_euclid(n) as usize];
        Some(Point { x: x + period * k.div_euclid(n) as f64, height })
    }

    /// The slope after sampling point `k`.
    fn slope(&self, k: isize) -> Option<f64> {
        let (a, b) = (self.point(k)?, self.point(k + 1)?);
        Some((b.height - a.height) / (b.x - a.x))
    }

    /// The slope at sampling point `k`.
    fn mean_slope(&self, k: isize) -> f64 {
        match (self.slope(k - 1), self.slope(k)) {
            (Some(left), Some(right)) => 0.5 * (left + right),
            (left, right) => left.or(right).unwrap_or(0.0),
        }
    }
}

/// The share of the jump that is taken off so far from an end, over a length: (3 s^2 - 2 s^3)/2, s from 0 inside to 1 at the end.
pub(super) fn ramp(distance: f64, length: f64) -> f64 {
    let s = (1.0 - distance / length).max(0.0);
    0.5 * s * s * (3.0 - 2.0 * s)
}

impl Profile for Sampled {
    /// Beyond the ends of a bounded profile it is not known.
    fn at(&self, x: f64) -> Result<Elevation> {
        let first = self.points[0].x;
        let x = match self.period {
            // Places inside the first period keep all their digits.
            Some(period) => x - period * ((x - first) / period).floor(),
            None => x,
        };
        // The sampling point at or before x.
        let k = self.points.partition_point(|point| point.x <= x) as isize - 1;
        for k in [k, k + 1] {
            if let Some(Point { height, .. }) = self.point(k).filter(|point| (x - point.x).abs() <= self.near) {
                return Ok(Elevation { height, slope: self.mean_slope(k) });
            }
        }
        match (self.point(k), self.slope(k)) {
            (Some(point), Some(slope)) => Ok(Elevation { height: point.height + slope * (x - point.x), slope }),
            _ => {
                let last = self.points[self.points.len() - 1].x;
                Err(Error::Domain(format!("has no elevation at x = {x:?} m: it is known from {first:?} to {last:?} m")))
            }
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn points(values: &[(f64, f64)]) -> Vec<Point> {
        values.iter().map(|&(x, height)| Point { x, height }).collect()
    }

    /// n points of one period of a cosine, the last one left out, from `start`.
    fn cosine(n: usize, start: f64) -> Vec<Point> {
        let point = |k: usize| start + 0.7 * k as f64 / n as f64;
        (0..n).map(|k| Point { x: point(k), height: 1e-3 * (9.0 * point(k)).cos() }).collect()
    }

    #[test]
    fn sampling_points_have_the_file_s_numbers_exactly() {
        for (n, start) in [(7, 0.0), (1000, -0.123), (12_345, 5.0)] {
            let list = cosine(n, start);
            for profile in [Sampled::new(list.clone(), None), Sampled::new(list.clone(), Some(0.7))] {
                for point in &list {
                    assert_eq!(profile.at(point.x).unwrap().height, point.height);
                    // The same place, found by another calculation.
                    assert_eq!(profile.at(point.x * (1.0 + f64::EPSILON)).unwrap().height, point.height);
                }
            }
        }
    }

    #[test]
    fn linear_between_with_mean_slopes_at_the_points() {
        let profile = Sampled::new(points(&[(0.0, 0.0), (1.0, 1.0), (3.0, -1.0)]), None);
        assert_eq!(profile.at(0.25).unwrap(), Elevation { height: 0.25, slope: 1.0 });
        assert_eq!(profile.at(2.0).unwrap(), Elevation { height: 0.0, slope: -1.0 });
        assert_eq!(profile.at(1.0).unwrap().slope, 0.0);
        assert_eq!((profile.at(0.0).unwrap().slope, profile.at(3.0).unwrap().slope), (1.0, -1.0));
        for x in [-0.1, 3.1] {
            assert!(matches!(profile.at(x), Err(Error::Domain(_))));
        }
    }

    /// The segment over the end of the period, and places many periods away.
    #[test]
    fn a_period_repeats() {
        let list = points(&[(1.0, 0.0), (2.0, 1.0), (3.0, 4.0)]);
        let profile = Sampled::new(list, Some(4.0));
        assert_eq!(profile.at(4.5).unwrap(), Elevation { height: 1.0, slope: -2.0 });
        assert_eq!(profile.at(0.5).unwrap(), profile.at(4.5).unwrap());
        assert_eq!(profile.at(1.0).unwrap(), Elevation { height: 0.0, slope: -0.5 });
        for turn in [-1000.0, -1.0, 7.0] {
            let (near, far) = (profile.at(2.25).unwrap(), profile.at(2.25 + 4.0 * turn).unwrap());
            assert!((near.height - far.height).abs() < 1e-12 && near.slope == far.slope);
        }
    }

    #[test]
    fn a_wall_at_the_seam_is_seen_and_closed() {
        assert_eq!(Sampled::wall(&cosine(100, 0.0)), None);
        let mut tilted: Vec<Point> = cosine(100, 0.0);
        tilted.iter_mut().for_each(|point| point.height = 1e-3 * point.x);
        let jump = Sampled::wall(&tilted).unwrap();
        assert!((jump - 0.7e-3 * 0.99).abs() < 1e-18, "{jump:e}");
        let before = tilted.clone();
        Sampled::blend(&mut tilted, 0.7);
        assert_eq!(tilted[0].height, tilted[99].height);
        assert!((tilted[0].height - 0.5 * jump).abs() < 1e-18);
        for (old, new) in before.iter().zip(&tilted) {
            let far = old.x > 0.0351 && old.x < 0.693 - 0.0351;
            assert!(!far || old == new);
        }
    }

    #[test]
    fn the_period_of_a_file() {
        let closed = points(&[(0.0, 1.0), (0.3, 2.0), (1.0, 1.0)]);
        assert_eq!(Sampled::natural_period(&closed), Some(1.0));
        // The point that closes the period is the first of the next.
        assert_eq!(Sampled::new(closed, Some(1.0)).at(0.65).unwrap().height, 1.5);
        let open = cosine(100, 0.2);
        assert!((Sampled::natural_period(&open).unwrap() - 0.7).abs() < 1e-15);
        assert_eq!(Sampled::natural_period(&points(&[(0.0, 1.0), (0.3, 2.0), (1.0, 3.0)])), None);
    }
}
