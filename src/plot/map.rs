//! A field over a pair of axes, drawn in colours.

use plotters::prelude::DrawingBackend;

use super::axes::{Mapping, Ruler, with_power};
use super::bar::Bar;
use super::layout::{Drawn, Place, Sides, labels, left_of};
use super::legend::{Legend, Sample};
use super::numbers::{decimals, minus};
use super::painter::{Frame, INK, Painter};
use super::ticks::linear;
use super::{Axis, Colour, Ramp};
use crate::error::Result;

/// Values on a regular grid; NaN = nothing is known there.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    /// The ends of the grid along x.
    pub x: (f64, f64),
    /// The ends of the grid along y.
    pub y: (f64, f64),
    /// Fields along x.
    pub columns: usize,
    /// Row after row from the lower end of y.
    pub values: Vec<f64>,
}

/// What a value looks like.
#[derive(Debug, Clone, PartialEq)]
pub enum Colouring {
    /// Bands between levels, with a colour bar.
    Bands {
        /// The quantity and its unit.
        label: String,
        /// The limits of the bands, ascending; at least two.
        levels: Vec<f64>,
        /// Their colours.
        ramp: Ramp,
    },
    /// The values 0, 1, ... are classes with a name and a colour.
    Classes(Vec<(String, Colour)>),
}

/// A field of colours.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Above everything.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The field.
    pub raster: Raster,
    /// Its colours.
    pub colouring: Colouring,
    /// Whether a length on one axis is as long on the other.
    pub equal: bool,
    /// Over the field, from here to there.
    pub arrows: Vec<[(f64, f64); 2]>,
}

impl Colouring {
    /// Bands for values from `low` to `high`, about `count` of them, their limits round; for a diverging ramp they are
    /// symmetric about zero.
    pub fn bands(label: String, (low, high): (f64, f64), ramp: Ramp, count: usize) -> Self {
        let (low, high) = match ramp {
            Ramp::Sequential => (low, high),
            Ramp::Diverging => (-low.abs().max(high.abs()), low.abs().max(high.abs())),
        };
        let high = if high > low { high } else { low + low.abs().max(1.0) };
        let rough = (high - low) / count.max(1) as f64;
        let decade = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 2.5, 5.0, 10.0].map(|m| m * decade).into_iter().find(|s| *s >= 0.999 * rough);
        let step = step.unwrap_or(rough);
        let (first, last) = ((low / step + 1e-6).floor() as i64, (high / step - 1e-6).ceil() as i64);
        Self::Bands { label, levels: (first..=last.max(first + 1)).map(|i| i as f64 * step).collect(), ramp }
    }

    /// The index of the band or class of a value.
    fn index(&self, value: f64) -> Option<usize> {
        if value.is_nan() {
            return None;
        }
        let last = match self {
            Self::Bands { levels, .. } => {
                return Some(levels.partition_point(|level| *level <= value).clamp(1, levels.len() - 1) - 1);
            }
            Self::Classes(classes) => classes.len().checked_sub(1)?,
        };
        Some((value.round().max(0.0) as usize).min(last))
    }

    fn colour(&self, index: usize) -> Colour {
        match self {
            Self::Bands { levels, ramp, .. } => ramp.at(index as f64 / (levels.len() as f64 - 2.0).max(1.0)),
            Self::Classes(classes) => classes[index].1,
        }
    }
}

impl<DB: DrawingBackend> Drawn<DB> for Map {
    fn title(&self) -> &str {
        &self.title
    }

    fn sides(&self, painter: &Painter<DB>, height: f64) -> Sides {
        let bar = self.bar().map_or(0.0, |bar| bar.width(painter));
        Sides { left: left_of(self.upwards(height).widest(painter)), right: bar + 20.0 }
    }

    fn legend(&self, painter: &Painter<DB>, width: f64) -> f64 {
        Legend::new(painter, self.entries(), width).height()
    }

    fn draw(&self, painter: &Painter<DB>, &Place { mut frame, sides, height }: &Place) -> Result<()> {
        let legend = Legend::new(painter, self.entries(), frame.right - frame.left);
        let upwards = self.upwards(height);
        if self.equal {
            let (x, y) = (self.raster.x, self.raster.y);
            let ratio = (x.1 - x.0) / (y.1 - y.0);
            let (wide, high) = (frame.right - frame.left, frame.bottom - frame.top);
            frame.right = frame.left + wide.min(high * ratio);
            frame.bottom = frame.top + high.min(wide / ratio);
        }
        let across = ruler(&self.x, self.raster.x, (frame.right - frame.left) / 66.0);
        let (x, y) = (across.along(frame.left, frame.right), upwards.along(frame.bottom, frame.top));
        field(self, painter, &frame, (&x, &y))?;
        self.arrows.iter().try_for_each(|ends| arrow(painter, &frame, (&x, &y), *ends))?;
        painter.axes(&frame, (&x, &across.ticks), (&y, &upwards.ticks))?;
        labels(painter, &frame, sides, (&across.label, &upwards.label))?;
        self.bar().iter().try_for_each(|bar| bar.draw(painter, &frame))?;
        legend.draw(painter, &frame)
    }
}

impl Map {
    /// The vertical axis in a panel of this height.
    fn upwards(&self, height: f64) -> Ruler {
        ruler(&self.y, self.raster.y, (height - 106.0) / 34.0)
    }

    /// The names of the classes.
    fn entries(&self) -> Vec<(&str, Sample<'_>)> {
        match &self.colouring {
            Colouring::Bands { .. } => Vec::new(),
            Colouring::Classes(classes) => classes.iter().map(|(name, c)| (name.as_str(), Sample::Field(*c))).collect(),
        }
    }

    /// The colours of the bands, with their limits.
    fn bar(&self) -> Option<Bar> {
        let Colouring::Bands { label, levels, .. } = &self.colouring else { return None };
        let (names, exponent) = names(levels);
        Some(Bar {
            label: with_power(label, exponent),
            fields: (0..levels.len() - 1).map(|i| self.colouring.colour(i)).collect(),
            marks: names.into_iter().enumerate().map(|(i, name)| (i as f64, name)).collect(),
        })
    }
}

/// An axis as long as the grid, with at most about `most` labels.
fn ruler(axis: &Axis, (from, to): (f64, f64), most: f64) -> Ruler {
    Ruler::new(&axis.clone().over(from, to), std::iter::empty(), most as usize)
}

/// Rectangles of one colour, as long as they get.
fn field<DB: DrawingBackend>(
    map: &Map,
    painter: &Painter<DB>,
    frame: &Frame,
    (x, y): (&Mapping, &Mapping),
) -> Result<()> {
    let Raster { columns, values, .. } = &map.raster;
    let rows = values.len() / (*columns).max(1);
    let along = |mapping: &Mapping, ends: (f64, f64), i: usize, n: usize| {
        let value = ends.0 + (ends.1 - ends.0) * i as f64 / n as f64;
        mapping.position(value).unwrap_or(0.0)
    };
    // From the top, so that each row covers the overlap of the one above.
    for row in (0..rows).rev() {
        let top = along(y, map.raster.y, row + 1, rows).clamp(frame.top, frame.bottom);
        // A little more than its own field: viewers let the white through between rectangles that only touch.
        let bottom = (along(y, map.raster.y, row, rows) + 0.5).clamp(frame.top, frame.bottom);
        let classes: Vec<_> =
            values[row * columns..(row + 1) * columns].iter().map(|value| map.colouring.index(*value)).collect();
        let mut start = 0;
        for run in classes.chunk_by(|a, b| a == b) {
            let end = start + run.len();
            if let Some(index) = run[0] {
                let from = along(x, map.raster.x, start, *columns).clamp(frame.left, frame.right);
                let to = (along(x, map.raster.x, end, *columns) + 0.5).clamp(frame.left, frame.right);
                painter.rectangle((from, top), (to, bottom), map.colouring.colour(index))?;
            }
            start = end;
        }
    }
    Ok(())
}

/// Dark on a pale edge, so that it is seen on every colour.
fn arrow<DB: DrawingBackend>(
    painter: &Painter<DB>,
    frame: &Frame,
    (x, y): (&Mapping, &Mapping),
    ends: [(f64, f64); 2],
) -> Result<()> {
    /// Of its length: that of the head, and half of its width.
    const HEAD: [f64; 2] = [0.4, 0.2];
    let place = |(at_x, at_y): (f64, f64)| x.position(at_x).zip(y.position(at_y));
    let [Some(tail), Some(tip)] = ends.map(place) else { return Ok(()) };
    let inside = |(x, y): (f64, f64)| x >= frame.left && x <= frame.right && y >= frame.top && y <= frame.bottom;
    if !(inside(tail) && inside(tip)) {
        return Ok(());
    }
    let along = (tip.0 - tail.0, tip.1 - tail.1);
    let barb = |side: f64| {
        (tip.0 - HEAD[0] * along.0 + side * HEAD[1] * along.1, tip.1 - HEAD[0] * along.1 - side * HEAD[1] * along.0)
    };
    for (colour, width) in [((255, 255, 255), 3.0), (INK, 1.4)] {
        painter.line(&[tail, tip], colour, width)?;
        painter.line(&[barb(1.0), tip, barb(-1.0)], colour, width)?;
    }
    Ok(())
}

/// The levels in as few digits as tell them apart, and the power of ten they leave out.
fn names(levels: &[f64]) -> (Vec<String>, i32) {
    let (low, high) = (levels[0], levels[levels.len() - 1]);
    let exponent = linear(&[((low, high), levels.len())]).1;
    let unit = 10f64.powi(exponent);
    let step = (high - low) / (levels.len() - 1) as f64 / unit;
    let decimals = decimals(step);
    // No level is minus nothing.
    let name = |level: &f64| minus(&format!("{:.decimals$}", if *level == 0.0 { 0.0 } else { level / unit }));
    (levels.iter().map(name).collect(), exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_are_round_cover_the_values_and_are_symmetric_where_they_diverge() {
        let levels = |low, high, ramp| match Colouring::bands("s".into(), (low, high), ramp, 10) {
            Colouring::Bands { levels, .. } => levels,
            Colouring::Classes(_) => Vec::new(),
        };
        let sequential = levels(-1.93, 0.07, Ramp::Sequential);
        assert_eq!((sequential[0], sequential[sequential.len() - 1], sequential.len()), (-2.0, 0.2, 12));
        let diverging = levels(-0.3, 0.45, Ramp::Diverging);
        assert_eq!(diverging.first().map(|l| -l), diverging.last().copied());
        assert!(levels(0.0, 0.0, Ramp::Sequential).len() >= 2);
        assert!(levels(3.0, 3.0, Ramp::Diverging).len() >= 2);
    }

    #[test]
    fn a_value_has_the_band_it_lies_in() {
        let bands = Colouring::Bands { label: String::new(), levels: vec![0.0, 1.0, 2.0], ramp: Ramp::Sequential };
        assert_eq!([-1.0, 0.5, 1.0, 5.0].map(|v| bands.index(v)), [Some(0), Some(0), Some(1), Some(1)]);
        assert_eq!(bands.index(f64::NAN), None);
        assert_eq!(names(&[-0.0002, 0.0, 0.0002]), (vec!["−2".into(), "0".into(), "2".into()], -4));
    }
}
