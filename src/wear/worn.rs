//! What an indenter has lost, in its own frame.
//!
//! The depth h_w is linear between nodes that are as far apart as those of the face, and raises the profile: h + h_w. The points of
//! the face lie between these nodes. What a point wears goes to the nodes around it by the shares with which it has its depth from
//! them (the transposed interpolation): the shares sum to one, so that the volume of the nodes is that of the points.

use std::collections::BTreeMap;

use nalgebra::Vector2;

use crate::error::{Error, Result};
use crate::mesh::{Axis, Grid};
use crate::profile::Height;

/// The worn depth over the indenter.
#[derive(Debug, Clone, PartialEq)]
pub struct Worn {
    /// Along x and y; in the plane there is one node along y, of unit width.
    rulers: [Ruler; 2],
    /// Of the nodes that have worn, m.
    depths: BTreeMap<[i64; 2], f64>,
}

/// Evenly spaced nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ruler {
    /// Of node 0, m.
    origin: f64,
    /// m
    spacing: f64,
    /// After how many they are the same; none = they go on for ever.
    period: Option<i64>,
}

impl Ruler {
    fn of(axis: &Axis) -> Self {
        let (count, origin) = (axis.places.len(), axis.places.first().copied().unwrap_or(0.0));
        let last = axis.places.last().copied().unwrap_or(origin);
        match axis.period {
            Some(period) => Self { origin, spacing: period / count as f64, period: Some(count as i64) },
            None => Self { origin, spacing: (last - origin) / (count as f64 - 1.0), period: None },
        }
    }

    /// The nodes on either side of a place, and their shares.
    fn around(&self, place: f64) -> [(i64, f64); 2] {
        let at = (place - self.origin) / self.spacing;
        let left = at.floor();
        let node = |node: i64| self.period.map_or(node, |period| node.rem_euclid(period));
        [(node(left as i64), 1.0 - (at - left)), (node((left as i64).saturating_add(1)), at - left)]
    }
}

impl Worn {
    /// Nothing, on nodes as far apart as those of a face.
    pub fn new(grid: &Grid) -> Self {
        let across = Ruler { origin: 0.0, spacing: 1.0, period: Some(1) };
        let ruler = |axis: usize| grid.axes.get(axis).map_or(across, Ruler::of);
        Self { rulers: [ruler(0), ruler(1)], depths: BTreeMap::new() }
    }

    /// The depth at a place of the indenter, m, and its gradient.
    pub fn at(&self, place: Vector2<f64>) -> Height {
        let [x, y] = self.around(place);
        let depth = |i: usize, j: usize| self.depths.get(&[x[i].0, y[j].0]).copied().unwrap_or(0.0);
        let [[a, b], [c, d]] = [[depth(0, 0), depth(0, 1)], [depth(1, 0), depth(1, 1)]];
        Height {
            height: x[0].1 * (a * y[0].1 + b * y[1].1) + x[1].1 * (c * y[0].1 + d * y[1].1),
            gradient: Vector2::new(
                ((c - a) * y[0].1 + (d - b) * y[1].1) / self.rulers[0].spacing,
                ((b - a) * x[0].1 + (d - c) * x[1].1) / self.rulers[1].spacing,
            ),
        }
    }

    /// Takes a volume off at a place, m^2 per unit thickness (m^3).
    pub fn take(&mut self, place: Vector2<f64>, volume: f64) {
        let [x, y] = self.around(place);
        let area = self.area();
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let share = x[i].1 * y[j].1;
            if share > 0.0 {
                *self.depths.entry([x[i].0, y[j].0]).or_insert(0.0) += share * volume / area;
            }
        }
    }

    /// What is gone, m^2 per unit thickness (m^3).
    pub fn volume(&self) -> f64 {
        self.depths.values().sum::<f64>() * self.area()
    }

    /// As numbers: two of a node and its depth, again and again.
    pub fn numbers(&self) -> Vec<f64> {
        self.depths.iter().flat_map(|([i, j], depth)| [*i as f64, *j as f64, *depth]).collect()
    }

    /// Takes the depths from such numbers.
    ///
    /// # Errors
    /// Where they are not three to a node.
    pub fn restore(&mut self, numbers: &[f64]) -> Result<()> {
        if !numbers.len().is_multiple_of(3) {
            return Err(Error::Usage("the checkpoint's worn depths are not whole; run without --resume".into()));
        }
        let node = |three: &[f64]| ([three[0] as i64, three[1] as i64], three[2]);
        self.depths = numbers.chunks_exact(3).map(node).collect();
        Ok(())
    }

    fn around(&self, place: Vector2<f64>) -> [[(i64, f64); 2]; 2] {
        [self.rulers[0].around(place.x), self.rulers[1].around(place.y)]
    }

    /// What a node stands for, m (m^2).
    fn area(&self) -> f64 {
        self.rulers[0].spacing * self.rulers[1].spacing
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn grid(axes: &[(usize, Option<f64>)]) -> Grid {
        let places = |count: usize| (0..count).map(|i| 0.25 * i as f64).collect();
        Grid { axes: axes.iter().map(|&(count, period)| Axis { places: places(count), period }).collect() }
    }

    /// The volume of the nodes is that of the points, in the plane and in space, on closed and open faces, to round-off; where points
    /// are nodes the depth is theirs; the gradient is that of the depth.
    #[test]
    fn volume_is_kept() {
        let closed = [(4, Some(1.0)), (4, Some(1.0))];
        for axes in [&closed[..1], &closed, &[(5, None)], &[(5, None), (4, Some(1.0))]] {
            let mut worn = Worn::new(&grid(axes));
            let mut volume = 0.0;
            for i in 0..50 {
                let t = f64::from(i);
                let part = 1.0 + (1.7 * t).sin();
                worn.take(Vector2::new(3.1 * (0.3 * t).sin(), (2.3 * t).cos()), part);
                volume += part;
            }
            assert!((worn.volume() / volume - 1.0).abs() < 1e-14);
            let (place, e) = (Vector2::new(0.33, 0.11), 1e-6);
            let along = |x, y| worn.at(place + Vector2::new(x, y)).height;
            let slope = Vector2::new(along(e, 0.0) - along(-e, 0.0), along(0.0, e) - along(0.0, -e)) / (2.0 * e);
            assert!((worn.at(place).gradient - slope).norm() < 1e-7);
            let mut other = Worn::new(&grid(axes));
            other.restore(&worn.numbers()).unwrap();
            assert_eq!(other, worn);
        }
        let mut worn = Worn::new(&grid(&closed));
        worn.take(Vector2::new(-0.25, 1.5), 1.0);
        assert_eq!(worn.at(Vector2::new(0.75, 0.5)).height, 16.0);
    }
}
