//! The layout of a panel of curves and its drawing.

use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, DrawingBackend};
use plotters::style::RGBColor;
use plotters::style::text_anchor::HPos;

use super::painter::{Frame, LABEL, Mapping, Painter, TICK, UNIT, refused};
use super::ticks::{power, ticks};
use super::{Axis, Colour, Curve, Figure, Panel, Scale, Stroke};
use crate::error::Result;

const SHADE: Colour = (238, 242, 232);
const TITLE: f64 = 20.0;
const LEGEND_ROW: f64 = 24.0;
const SAMPLE: f64 = 40.0;

/// Draws a panel on an area of UNIT drawing units a px. `sink` is by how much of its size a backend sets vertically
/// centred text too high.
pub fn draw<DB: DrawingBackend>(panel: &Panel, area: &DrawingArea<DB, Shift>, sink: f64) -> Result<()> {
    area.fill(&RGBColor(255, 255, 255)).map_err(refused)?;
    let painter = Painter { area, sink };
    match panel {
        Panel::Curves(figure) => draw_curves(figure, &painter),
        Panel::Map(map) => super::map::draw(map, &painter),
    }
}

/// Width and height of the area, px.
pub fn size<DB: DrawingBackend>(painter: &Painter<DB>) -> (f64, f64) {
    let (width, height) = painter.area.dim_in_pixel();
    (f64::from(width) / f64::from(UNIT), f64::from(height) / f64::from(UNIT))
}

fn draw_curves<DB: DrawingBackend>(figure: &Figure, painter: &Painter<DB>) -> Result<()> {
    let (width, height) = size(painter);
    let (x_range, y_range) = (range(&figure.x, figure, |p| p.0), range(&figure.y, figure, |p| p.1));
    let (y_ticks, y_power) = ticks(figure.y.scale, y_range, (height / 65.0) as usize);
    let widest = y_ticks.iter().filter_map(|tick| tick.label.as_deref()).map(|label| painter.width(label, TICK));
    let (left, right) = (58.0 + widest.fold(0.0, f64::max), width - 24.0);
    let legend = Legend::new(painter, entries(figure), right - left);
    let frame = Frame { left, top: 50.0 + legend.height(), right, bottom: height - 72.0 };
    let (x_ticks, x_power) = ticks(figure.x.scale, x_range, (width / 95.0) as usize);
    let x = Mapping { scale: figure.x.scale, range: x_range, ends: (frame.left, frame.right) };
    let y = Mapping { scale: figure.y.scale, range: y_range, ends: (frame.bottom, frame.top) };

    title(painter, &figure.title, &frame)?;
    if let Some((band, _)) = &figure.shaded
        && let (Some(from), Some(to)) = (x.position(band.from), x.position(band.to))
    {
        let (from, to) = (from.clamp(frame.left, frame.right), to.clamp(frame.left, frame.right));
        painter.rectangle((from, frame.top), (to, frame.bottom), SHADE)?;
    }
    painter.grid(&frame, (&x, &x_ticks), (&y, &y_ticks))?;
    for curve in &figure.curves {
        painter.curve(curve, &frame, &x, &y)?;
    }
    painter.axes(&frame, (&x, &x_ticks), (&y, &y_ticks))?;
    labels(painter, &frame, &with_power(&figure.x, x_power), &with_power(&figure.y, y_power))?;
    legend.draw(painter, &frame)
}

/// The title, over the middle of the frame.
pub fn title<DB: DrawingBackend>(painter: &Painter<DB>, text: &str, frame: &Frame) -> Result<()> {
    painter.text(text, (0.5 * (frame.left + frame.right), 22.0), TITLE, HPos::Center)
}

/// The labels of the two axes.
pub fn labels<DB: DrawingBackend>(painter: &Painter<DB>, frame: &Frame, x: &str, y: &str) -> Result<()> {
    painter.text(x, (0.5 * (frame.left + frame.right), frame.bottom + 50.0), LABEL, HPos::Center)?;
    painter.upright(y, (26.0, 0.5 * (frame.top + frame.bottom)))
}

/// The label of an axis with the power of ten that its ticks leave out.
pub fn with_power(axis: &Axis, exponent: i32) -> String {
    match exponent {
        0 => axis.label.clone(),
        exponent => match axis.label.rsplit_once(", ") {
            Some((quantity, unit)) => format!("{quantity}, {} {unit}", power(exponent)),
            None => format!("{}, {}", axis.label, power(exponent)),
        },
    }
}

/// The ends of an axis: as given, or around the data with a little air. Always ascending, and wide enough for ticks to
/// be told apart.
fn range(axis: &Axis, figure: &Figure, pick: impl Fn(&(f64, f64)) -> f64) -> (f64, f64) {
    let log = axis.scale == Scale::Log;
    let usable = |value: &f64| value.is_finite() && (!log || *value > 0.0);
    let of = |value: f64| if log { value.clamp(1e-300, 1e300).ln() } else { value.clamp(-1e300, 1e300) };
    let back = |value: f64| if log { value.exp().clamp(1e-307, 1e307) } else { value };
    let values = figure.curves.iter().flat_map(|curve| &curve.points).map(pick).filter(usable).map(of);
    let (low, high) = match axis.range {
        Some((from, to)) => (of(from), of(to)),
        None => values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v))),
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
/// What stands before the text of an entry.
pub enum Sample<'a> {
    /// A piece of the curve.
    Curve(&'a Curve),
    /// A field of its colour.
    Field(Colour),
}

/// The entries: the curves with a label, and the shaded range.
fn entries(figure: &Figure) -> Vec<(&str, Sample<'_>)> {
    let curves = figure.curves.iter().filter(|curve| !curve.label.is_empty());
    let shaded = figure.shaded.iter().filter(|(_, label)| !label.is_empty());
    let shaded = shaded.map(|(_, label)| (label.as_str(), Sample::Field(SHADE)));
    curves.map(|curve| (curve.label.as_str(), Sample::Curve(curve))).chain(shaded).collect()
}

/// Entries from left to right above the frame, in as many rows as they take.
pub struct Legend<'a> {
    entries: Vec<(&'a str, Sample<'a>)>,
    places: Vec<Place>,
}

/// Where an entry of the legend stands.
struct Place {
    row: usize,
    offset: f64,
}

impl<'a> Legend<'a> {
    /// Laid out over `width` px.
    pub fn new<DB: DrawingBackend>(painter: &Painter<DB>, entries: Vec<(&'a str, Sample<'a>)>, width: f64) -> Self {
        let (mut row, mut offset) = (0, 0.0);
        let place = |(label, _): &(&str, Sample)| {
            let wide = SAMPLE + 8.0 + painter.width(label, TICK);
            if offset > 0.0 && offset + wide > width {
                (row, offset) = (row + 1, 0.0);
            }
            let place = Place { row, offset };
            offset += wide + 24.0;
            place
        };
        let places = entries.iter().map(place).collect();
        Self { entries, places }
    }

    /// px
    pub fn height(&self) -> f64 {
        LEGEND_ROW * self.places.iter().map(|place| place.row + 1).max().unwrap_or(0) as f64
    }

    /// Draws it above `frame`.
    pub fn draw<DB: DrawingBackend>(&self, painter: &Painter<DB>, frame: &Frame) -> Result<()> {
        for ((label, sample), place) in self.entries.iter().zip(&self.places) {
            let y = 54.0 + LEGEND_ROW * place.row as f64;
            let x = frame.left + place.offset;
            match sample {
                Sample::Curve(curve) if curve.stroke == Stroke::Points => {
                    painter.ring((x + 0.5 * SAMPLE, y), curve.colour)?;
                }
                Sample::Curve(curve) => painter.stroke(&[(x, y), (x + SAMPLE, y)], curve.colour, curve.stroke)?,
                Sample::Field(colour) => painter.rectangle((x, y - 7.0), (x + SAMPLE, y + 7.0), *colour)?,
            }
            painter.text(label, (x + SAMPLE + 8.0, y), TICK, HPos::Left)?;
        }
        Ok(())
    }
}
