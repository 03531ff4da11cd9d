//! A measured surface: heights over a regular grid, bilinear between them.

use nalgebra::Vector2;

use super::sampled::{BLEND, WALL, ramp};
use super::{Height, Surface};
use crate::error::{Error, Result};
use crate::heightmap::Heights;

/// h(x_i, y_j) = h_ij, the numbers unchanged; between four neighbours, with u and v from 0 to 1 across them,
///
///   h = (1 - u)(1 - v) h_ij + u (1 - v) h_i+1,j + (1 - u) v h_i,j+1 + u v h_i+1,j+1,
///
/// and its gradient is that of this. On a line of points, where the slope across it jumps, that is the mean of both
/// sides, and the one there is at an end of a bounded map. A place within round-off of such a line is on it.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightMap {
    /// Along x and along y.
    rulers: [Ruler; 2],
    /// Points along y in `values`.
    stride: usize,
    /// m, along y first.
    values: Vec<f64>,
}

/// The places of points along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ruler {
    /// m
    first: f64,
    /// m
    spacing: f64,
    count: usize,
    /// m, not less than from the first point to the last; none = bounded.
    period: Option<f64>,
}

/// What the points around a place have to do with it: the height there is the sum of `value` times theirs, the slope that of
/// `slope`, 1/m.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stencil {
    at: [usize; 3],
    value: [f64; 3],
    slope: [f64; 3],
}

impl HeightMap {
    /// Of heights with their points `spacing` m apart, the first one at `origin`, m. With periods, which are not less than
    /// the distance from the first point to the last, it repeats; points exactly one period after the first are left out.
    pub fn new(heights: Heights, [spacing, origin]: [[f64; 2]; 2], periods: Option<[f64; 2]>) -> Self {
        let ruler = |axis: usize| {
            let mut ruler = Ruler {
                first: origin[axis],
                spacing: spacing[axis],
                count: heights.counts[axis],
                period: periods.map(|periods| periods[axis]),
            };
            if ruler.period.is_some_and(|period| ruler.span() > period - ruler.near()) {
                ruler.count -= 1;
            }
            ruler
        };
        Self { rulers: [ruler(0), ruler(1)], stride: heights.counts[1], values: heights.values }
    }

    /// What is known of a bounded map: from where to where along x and y, m.
    pub fn extent(&self) -> [[f64; 2]; 2] {
        self.rulers.map(|ruler| [ruler.first, ruler.first + ruler.span()])
    }
}

impl Surface for HeightMap {
    /// Beyond the ends of a bounded map it is not known.
    fn at(&self, place: Vector2<f64>) -> Result<Height> {
        let [Some(x), Some(y)] = [self.rulers[0].stencil(place.x), self.rulers[1].stencil(place.y)] else {
            let [x, y] = self.extent();
            return Err(Error::Domain(format!(
                "has no height at x = {:?}, y = {:?} m: it is known from {:?} to {:?} along x and from {:?} to {:?} m along y",
                place.x, place.y, x[0], x[1], y[0], y[1]
            )));
        };
        let mut of = Height { height: 0.0, gradient: Vector2::zeros() };
        for (a, i) in x.at.into_iter().enumerate() {
            for (b, j) in y.at.into_iter().enumerate() {
                let value = self.values[i * self.stride + j];
                of.height += x.value[a] * y.value[b] * value;
                of.gradient += Vector2::new(x.slope[a] * y.value[b], x.value[a] * y.slope[b]) * value;
            }
        }
        Ok(of)
    }
}

impl Ruler {
    /// From the first point to the last, m.
    fn span(self) -> f64 {
        self.spacing * (self.count - 1) as f64
    }

    /// Places this near, m, are one: some units in the last place of the largest number that takes part.
    fn near(self) -> f64 {
        let last = self.first + self.span();
        16.0 * f64::EPSILON * self.first.abs().max(last.abs()).max(self.period.unwrap_or(0.0))
    }

    /// Where a point is, m; with a period the one behind the last is the first of the next.
    fn place(self, k: usize) -> f64 {
        match self.period {
            Some(period) if k >= self.count => self.first + period,
            _ => self.first + self.spacing * k as f64,
        }
    }

    /// Around a place, m; none beyond the ends.
    fn stencil(self, x: f64) -> Option<Stencil> {
        let x = match self.period {
            // Places inside the first period keep all their digits.
            Some(period) => x - period * ((x - self.first) / period).floor(),
            None => x,
        };
        let last = if self.period.is_some() { self.count } else { self.count - 1 };
        let k = ((x - self.first) / self.spacing).floor().clamp(0.0, last as f64) as usize;
        // Where the last gap is a wider one, all of it belongs to the last point.
        let k = if self.period.is_some() { k.min(self.count - 1) } else { k };
        if let Some(k) = [k, k + 1].into_iter().find(|k| *k <= last && (x - self.place(*k)).abs() <= self.near()) {
            return Some(self.on(k));
        }
        let (from, to) = (self.place(k), self.place(k + 1));
        if !(x > from && x < to && k < last) {
            return None;
        }
        let (width, next) = (to - from, (k + 1) % self.count);
        let share = (x - from) / width;
        Some(Stencil { at: [k, next, next], value: [1.0 - share, share, 0.0], slope: [-1.0 / width, 1.0 / width, 0.0] })
    }

    /// On a point.
    fn on(self, k: usize) -> Stencil {
        let (k, last) = (k % self.count, self.count - 1);
        let repeats = self.period.is_some();
        // 1/m of the gaps at both sides, where there are such.
        let before =
            (repeats || k > 0).then(|| if k > 0 { self.spacing } else { self.place(self.count) - self.place(last) });
        let behind = (repeats || k < last).then(|| self.place(k + 1) - self.place(k));
        let half = if before.is_some() && behind.is_some() { 0.5 } else { 1.0 };
        let [before, behind] = [before, behind].map(|width| width.map_or(0.0, |width| half / width));
        Stencil {
            at: [
                if k > 0 {
                    k - 1
                } else if repeats {
                    last
                } else {
                    0
                },
                k,
                if k < last {
                    k + 1
                } else if repeats {
                    0
                } else {
                    last
                },
            ],
            value: [0.0, 1.0, 0.0],
            slope: [-before, before - behind, behind],
        }
    }
}

/// The two ends of a map along an axis, and what is between: where each height stands.
struct Ends {
    /// Points along the axis.
    count: usize,
    /// From one to the next along it, in the list of heights.
    step: usize,
    /// The first of each line along it.
    lines: Vec<usize>,
}

impl Ends {
    fn of(heights: &Heights, axis: usize) -> Self {
        let [columns, rows] = heights.counts;
        match axis {
            0 => Self { count: columns, step: rows, lines: (0..rows).collect() },
            _ => Self { count: rows, step: 1, lines: (0..columns).map(|i| i * rows).collect() },
        }
    }

    fn last(&self, line: usize) -> usize {
        line + (self.count - 1) * self.step
    }
}

/// The distance after which a map repeats along an axis, m: from its first point to its last where both ends are the same (and
/// not the same as what is next to them, as where nothing changes along the axis), else one spacing more.
pub fn natural_period(heights: &Heights, axis: usize, spacing: f64) -> f64 {
    let ends = Ends::of(heights, axis);
    let changes = ends.lines.iter().any(|&line| heights.values[line] != heights.values[line + ends.step]);
    let closed = changes && meets(heights, axis);
    spacing * (heights.counts[axis] - usize::from(closed)) as f64
}

/// Whether both ends along an axis have the same heights.
pub fn meets(heights: &Heights, axis: usize) -> bool {
    let ends = Ends::of(heights, axis);
    ends.lines.iter().all(|&line| heights.values[line] == heights.values[ends.last(line)])
}

/// How far the two ends along an axis are apart in height, m (root mean square), if that is a wall where they repeat: more than
/// [`WALL`] times that of the steps between neighbours along it.
pub fn wall(heights: &Heights, axis: usize) -> Option<f64> {
    let ends = Ends::of(heights, axis);
    let (mut jumps, mut steps) = (0.0, 0.0);
    for &line in &ends.lines {
        jumps += (heights.values[line] - heights.values[ends.last(line)]).powi(2);
        for k in 1..ends.count {
            let at = line + k * ends.step;
            steps += (heights.values[at] - heights.values[at - ends.step]).powi(2);
        }
    }
    let lines = ends.lines.len() as f64;
    let (jump, step) = ((jumps / lines).sqrt(), (steps / lines / (ends.count - 1) as f64).sqrt());
    (jump > WALL * step).then_some(jump)
}

/// Lets both ends along an axis go over into their mean, as [`super::Sampled::blend`] does on every line.
pub fn blend(heights: &mut Heights, axis: usize, [spacing, period]: [f64; 2]) {
    let ends = Ends::of(heights, axis);
    for &line in &ends.lines {
        let last = ends.last(line);
        let jump = heights.values[line] - heights.values[last];
        for k in 0..ends.count {
            let [before, behind] = [k, ends.count - 1 - k].map(|gaps| ramp(gaps as f64 * spacing, BLEND * period));
            heights.values[line + k * ends.step] += jump * (behind - before);
        }
        // Not even by round-off apart.
        heights.values[last] = heights.values[line];
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// Points of h(x, y) from the origin on.
    fn heights(counts: [usize; 2], [spacing, origin]: [[f64; 2]; 2], h: impl Fn(f64, f64) -> f64) -> Heights {
        let at = |axis: usize, k: usize| origin[axis] + spacing[axis] * k as f64;
        let values = (0..counts[0] * counts[1]).map(|k| h(at(0, k / counts[1]), at(1, k % counts[1]))).collect();
        Heights { counts, values, spacing: None, origin: None, units: [None; 2] }
    }

    /// Two waves that repeat after 0.7 and 0.4 m.
    fn waves(x: f64, y: f64) -> f64 {
        1e-3 * (2.0 * PI * x / 0.7).cos() * (2.0 * PI * y / 0.4 + 0.3).sin()
    }

    fn periodic(n: usize) -> HeightMap {
        let layout = [[0.7 / n as f64, 0.4 / (2 * n) as f64], [-0.2, 5.0]];
        HeightMap::new(heights([n, 2 * n], layout, waves), layout, Some([0.7, 0.4]))
    }

    /// On its points a map has the numbers of its file, wherever they repeat.
    #[test]
    fn points_have_the_file_s_numbers() {
        let map = periodic(24);
        for (i, j) in [(0, 0), (3, 47), (23, 1), (11, 30)] {
            let place = Vector2::new(-0.2 + 0.7 / 24.0 * i as f64, 5.0 + 0.4 / 48.0 * j as f64);
            assert_eq!(map.at(place).unwrap().height, map.values[i * 48 + j]);
            let far = map.at(place + Vector2::new(-1.4, 0.8)).unwrap();
            assert!((far.height - map.values[i * 48 + j]).abs() < 1e-15);
        }
    }

    /// Gradients against central differences inside cells, the wider one where the period ends included; on lines of points
    /// the mean of both sides.
    #[test]
    fn gradients_are_derivatives() {
        let layout = [[0.1, 0.2], [1.0, -1.0]];
        let bumps = |x: f64, y: f64| (3.0 * x).sin() * (1.0 + y * y);
        let map = HeightMap::new(heights([5, 4], layout, bumps), layout, Some([0.55, 0.7]));
        for place in [[1.03, -0.95], [1.48, -0.7], [1.22, -0.35], [1.53, -0.33], [7.3, 9.1]].map(Vector2::from) {
            let gradient = map.at(place).unwrap().gradient;
            for axis in 0..2 {
                let step = Vector2::ith(axis, 1e-5);
                let [plus, minus] = [step, -step].map(|step| map.at(place + step).unwrap().height);
                assert!(((plus - minus) / 2e-5 - gradient[axis]).abs() < 1e-9, "{place}");
            }
        }
        let [left, on, right] = [1.2 - 1e-7, 1.2, 1.2 + 1e-7].map(|x| map.at(Vector2::new(x, -0.9)).unwrap().gradient);
        assert!((0.5 * (left.x + right.x) - on.x).abs() < 1e-9 && (left.x - right.x).abs() > 0.05);
        assert!((on.y - left.y).abs() < 1e-6);
    }

    /// Between points a smooth surface is met to second order, its gradient to first: linear interpolation of a wave of number k
    /// is off by k^2 d^2/8 of it in each direction.
    #[test]
    fn second_order() {
        let error = |n: usize| {
            let map = periodic(n);
            let place = |k: usize| Vector2::new(0.0137 * k as f64, 0.0071 * k as f64);
            (0..200)
                .map(|k| (map.at(place(k)).unwrap().height - waves(place(k).x, place(k).y)).abs())
                .fold(0.0, f64::max)
        };
        let [coarse, fine] = [error(32), error(64)];
        // Along x k d = 2 pi/32, along y half of that.
        let bound = 1e-3 * ((2.0 * PI / 32.0_f64).powi(2) + (PI / 32.0).powi(2)) / 8.0;
        assert!(coarse < bound && coarse > 0.8 * bound, "{coarse:e} {bound:e}");
        assert!((coarse / fine - 4.0).abs() < 0.2, "{coarse:e} {fine:e}");
    }

    /// A bounded map ends where its points end, and has the one slope that there is at an edge.
    #[test]
    fn bounds() {
        let layout = [[0.5, 0.25], [0.0, 0.0]];
        let map = HeightMap::new(heights([3, 5], layout, |x, y| x * x + 10.0 * y), layout, None);
        let corner = map.at(Vector2::new(1.0, 1.0)).unwrap();
        assert_eq!((corner.height, corner.gradient), (11.0, Vector2::new(1.5, 10.0)));
        for place in [[-0.01, 0.5], [1.01, 0.5], [0.5, -0.01], [0.5, 1.01]] {
            assert!(matches!(map.at(Vector2::from(place)), Err(Error::Domain(_))));
        }
    }

    /// Walls are seen along the axis where they are, and blended; ends that meet are one line of points.
    #[test]
    fn seams() {
        let layout = [[0.01, 0.02], [0.0, 0.0]];
        let tilted = heights([60, 40], layout, |x, y| 0.3 * x + 1e-3 * (2.0 * PI * y / 0.8).sin());
        let jump = wall(&tilted, 0).unwrap();
        assert!((jump - 0.177).abs() < 1e-12 && wall(&tilted, 1).is_none(), "{jump}");
        let mut blended = tilted.clone();
        assert!(!meets(&tilted, 0) && natural_period(&tilted, 0, 0.01) == 0.6);
        let closed = heights([9, 4], layout, |x, _| (x - 0.04).abs());
        assert_eq!((natural_period(&closed, 0, 0.01), natural_period(&closed, 1, 0.02)), (0.08, 0.08));
        blend(&mut blended, 0, [0.01, 0.6]);
        assert!(meets(&blended, 0) && wall(&blended, 0).is_none());
        assert_eq!(blended.values[30 * 40..31 * 40], tilted.values[30 * 40..31 * 40]);
        let map = HeightMap::new(blended, layout, Some([0.59, 0.8]));
        assert_eq!(map.rulers.map(|ruler| ruler.count), [59, 40]);
    }
}
