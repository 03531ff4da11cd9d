//! A field over a pair of axes, drawn in colours.

use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::HPos;

use super::draw::{Legend, Sample, labels, size, title, with_power};
use super::painter::{Frame, LABEL, Mapping, Painter, TICK};
use super::ticks::{Tick, ticks};
use super::{Axis, Colour, Curve, Ramp, Scale};
use crate::error::Result;

/// Width of a colour bar, px.
const BAR: f64 = 20.0;

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
    /// Drawn over it.
    pub curves: Vec<Curve>,
    /// Whether a length on one axis is as long on the other.
    pub equal: bool,
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

/// Draws a map on the painter's area.
pub fn draw<DB: DrawingBackend>(map: &Map, painter: &Painter<DB>) -> Result<()> {
    let (width, height) = size(painter);
    let (x_range, y_range) = (map.x.range.unwrap_or(map.raster.x), map.y.range.unwrap_or(map.raster.y));
    let (y_ticks, y_power) = ticks(Scale::Linear, y_range, (height / 65.0) as usize);
    let widest = y_ticks.iter().filter_map(|tick| tick.label.as_deref()).map(|label| painter.width(label, TICK));
    let left = 58.0 + widest.fold(0.0, f64::max);
    let right = match &map.colouring {
        Colouring::Bands { .. } => width - 130.0,
        Colouring::Classes(_) => width - 24.0,
    };
    let mut entries: Vec<_> = match &map.colouring {
        Colouring::Bands { .. } => Vec::new(),
        Colouring::Classes(classes) => classes.iter().map(|(name, c)| (name.as_str(), Sample::Field(*c))).collect(),
    };
    let curves = map.curves.iter().filter(|curve| !curve.label.is_empty());
    entries.extend(curves.map(|curve| (curve.label.as_str(), Sample::Curve(curve))));
    let legend = Legend::new(painter, entries, right - left);
    let mut frame = Frame { left, top: 50.0 + legend.height(), right, bottom: height - 72.0 };
    if map.equal {
        let ratio = (x_range.1 - x_range.0) / (y_range.1 - y_range.0);
        let (wide, high) = (frame.right - frame.left, frame.bottom - frame.top);
        frame.right = frame.left + wide.min(high * ratio);
        frame.bottom = frame.top + high.min(wide / ratio);
    }
    let (x_ticks, x_power) = ticks(Scale::Linear, x_range, ((frame.right - frame.left) / 85.0) as usize);
    let x = Mapping { scale: Scale::Linear, range: x_range, ends: (frame.left, frame.right) };
    let y = Mapping { scale: Scale::Linear, range: y_range, ends: (frame.bottom, frame.top) };

    title(painter, &map.title, &frame)?;
    field(map, painter, &frame, (&x, &y))?;
    for curve in &map.curves {
        painter.curve(curve, &frame, &x, &y)?;
    }
    painter.axes(&frame, (&x, &x_ticks), (&y, &y_ticks))?;
    labels(painter, &frame, &with_power(&map.x, x_power), &with_power(&map.y, y_power))?;
    if let Colouring::Bands { label, levels, .. } = &map.colouring {
        bar(map, painter, &frame, (label, levels))?;
    }
    legend.draw(painter, &frame)
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

/// The colour bar right of the frame.
fn bar<DB: DrawingBackend>(
    map: &Map,
    painter: &Painter<DB>,
    frame: &Frame,
    (label, levels): (&str, &[f64]),
) -> Result<()> {
    let (left, bands) = (frame.right + 18.0, levels.len() - 1);
    let bar = Frame { left, right: left + BAR, ..*frame };
    let at = |i: usize| bar.bottom + (bar.top - bar.bottom) * i as f64 / bands as f64;
    for i in 0..bands {
        painter.rectangle((bar.left, at(i + 1)), (bar.right, at(i)), map.colouring.colour(i))?;
    }
    let (Frame { left, top, right, bottom }, ink) = (bar, (40, 40, 40));
    painter.line(&[(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], ink, 1.0)?;
    let every = bands.div_ceil(10).max(1);
    // The levels as the ticks of an axis would say them.
    let (told, exponent) = names(levels);
    let mut widest = 0.0f64;
    for (i, name) in told.iter().enumerate().step_by(every) {
        painter.line(&[(right, at(i)), (right + 6.0, at(i))], ink, 1.0)?;
        painter.text(name, (right + 10.0, at(i)), TICK, HPos::Left)?;
        widest = widest.max(painter.width(name, TICK));
    }
    let text = with_power(&Axis::linear(label), exponent);
    let beside = (right + 10.0 + widest + 0.75 * LABEL, 0.5 * (top + bottom));
    painter.upright(&text, beside)
}

/// The levels in as few digits as tell them apart, and the power of ten they leave out.
fn names(levels: &[f64]) -> (Vec<String>, i32) {
    let (low, high) = (levels[0], levels[levels.len() - 1]);
    let (ticks, exponent) = ticks(Scale::Linear, (low, high), 2 * levels.len());
    let unit = 10f64.powi(exponent);
    let step = (high - low) / (levels.len() - 1) as f64 / unit;
    let decimals = (0..9).find(|d| (step * 10f64.powi(*d) - (step * 10f64.powi(*d)).round()).abs() < 1e-6).unwrap_or(3);
    let name = |level: &f64| match ticks.iter().find(|tick: &&Tick| (tick.at - level).abs() < 1e-9 * unit) {
        Some(_) if *level == 0.0 => "0".to_owned(),
        _ => format!("{:.*}", decimals as usize, level / unit).replace('-', "−"),
    };
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
