//! The layout of a figure and its drawing, the same for every file format.

use plotters::coord::Shift;
use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::prelude::{DrawingArea, DrawingBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, ShapeStyle, TextStyle};

use super::ticks::{Tick, power, ticks};
use super::{Axis, Colour, Curve, Figure, Scale, Stroke};
use crate::error::{Error, Result};

/// Width of a figure, px.
pub const WIDTH: u32 = 900;
/// Height of a figure, px.
pub const HEIGHT: u32 = 600;
/// Drawing units per px.
pub const UNIT: u32 = 4;
/// The embedded font by its name, and what a viewer of an SVG without it may take instead.
pub const FONT: &str = "DejaVu Sans, Verdana, sans-serif";

const INK: Colour = (40, 40, 40);
const GRID: Colour = (225, 225, 225);
const SHADE: Colour = (238, 242, 232);
const TITLE: f64 = 20.0;
const LABEL: f64 = 18.0;
const TICK: f64 = 15.0;
const LEGEND_ROW: f64 = 24.0;
const SAMPLE: f64 = 40.0;

/// A rectangle, px, y downwards.
#[derive(Debug, Clone, Copy)]
struct Frame {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

/// From values to positions along one side of the frame.
struct Mapping {
    scale: Scale,
    range: (f64, f64),
    ends: (f64, f64),
}

impl Mapping {
    /// The position of `value`; none where the axis has none.
    fn position(&self, value: f64) -> Option<f64> {
        let of = |value: f64| match self.scale {
            Scale::Linear => value,
            Scale::Log => value.ln(),
        };
        let part = (of(value) - of(self.range.0)) / (of(self.range.1) - of(self.range.0));
        let position = self.ends.0 + part * (self.ends.1 - self.ends.0);
        // Far outside is outside; the clipping must not overflow.
        (!position.is_nan()).then_some(position.clamp(-1e9, 1e9))
    }
}

struct Painter<'a, DB: DrawingBackend> {
    area: &'a DrawingArea<DB, Shift>,
    sink: f64,
}

/// Draws `figure` on an area of WIDTH x HEIGHT px of UNIT drawing units each. `sink` is by how much of its size a
/// backend sets vertically centred text too high.
pub fn draw<DB: DrawingBackend>(figure: &Figure, area: &DrawingArea<DB, Shift>, sink: f64) -> Result<()> {
    let painter = Painter { area, sink };
    area.fill(&RGBColor(255, 255, 255)).map_err(refused)?;
    let (x_range, y_range) = (range(&figure.x, figure, |p| p.0), range(&figure.y, figure, |p| p.1));
    let (y_ticks, y_power) = ticks(figure.y.scale, y_range, 7);
    let widest = y_ticks.iter().filter_map(|tick| tick.label.as_deref()).map(|label| painter.width(label, TICK));
    let (left, right) = (58.0 + widest.fold(0.0, f64::max), f64::from(WIDTH) - 24.0);
    let entries = entries(figure);
    let rows = flow(&painter, &entries, right - left);
    let top = 50.0 + LEGEND_ROW * rows.iter().map(|entry| entry.row + 1).max().unwrap_or(0) as f64;
    let frame = Frame { left, top, right, bottom: f64::from(HEIGHT) - 72.0 };
    let (x_ticks, x_power) = ticks(figure.x.scale, x_range, 9);
    let x = Mapping { scale: figure.x.scale, range: x_range, ends: (frame.left, frame.right) };
    let y = Mapping { scale: figure.y.scale, range: y_range, ends: (frame.bottom, frame.top) };

    painter.text(&figure.title, (0.5 * (frame.left + frame.right), 22.0), TITLE, HPos::Center)?;
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
    let middle = 0.5 * (frame.left + frame.right);
    painter.text(&with_power(&figure.x, x_power), (middle, frame.bottom + 50.0), LABEL, HPos::Center)?;
    painter.upright(&with_power(&figure.y, y_power), (26.0, 0.5 * (frame.top + frame.bottom)))?;
    for (entry, place) in entries.iter().zip(&rows) {
        painter.entry(entry, (frame.left + place.offset, 54.0 + LEGEND_ROW * place.row as f64))?;
    }
    area.present().map_err(refused)
}

fn refused(error: impl std::fmt::Display) -> Error {
    Error::Internal(format!("the figure cannot be drawn: {error}"))
}

/// The label of an axis with the power of ten that its ticks leave out.
fn with_power(axis: &Axis, exponent: i32) -> String {
    match exponent {
        0 => axis.label.clone(),
        exponent => match axis.label.rsplit_once(", ") {
            Some((quantity, unit)) => format!("{quantity}, {} {unit}", power(exponent)),
            None => format!("{} / {}", axis.label, power(exponent)),
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

/// What the legend shows: the curves with a label, and the shaded range.
fn entries(figure: &Figure) -> Vec<(&str, Option<&Curve>)> {
    let curves = figure.curves.iter().filter(|curve| !curve.label.is_empty());
    let shaded = figure.shaded.iter().filter(|(_, label)| !label.is_empty()).map(|(_, label)| (label.as_str(), None));
    curves.map(|curve| (curve.label.as_str(), Some(curve))).chain(shaded).collect()
}

/// Where an entry of the legend stands.
struct Place {
    row: usize,
    offset: f64,
}

/// Entries from left to right, in as many rows as they take.
fn flow<DB: DrawingBackend>(painter: &Painter<DB>, entries: &[(&str, Option<&Curve>)], width: f64) -> Vec<Place> {
    let (mut row, mut offset) = (0, 0.0);
    let place = |(label, _): &(&str, Option<&Curve>)| {
        let wide = SAMPLE + 8.0 + painter.width(label, TICK);
        if offset > 0.0 && offset + wide > width {
            (row, offset) = (row + 1, 0.0);
        }
        let place = Place { row, offset };
        offset += wide + 24.0;
        place
    };
    entries.iter().map(place).collect()
}

/// The part of the segment from `a` to `b` inside the frame, by Liang and Barsky, ACM Trans. Graph. 3 (1984) 1.
fn clipped(frame: &Frame, a: (f64, f64), b: (f64, f64)) -> Option<[(f64, f64); 2]> {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut start, mut end) = (0.0f64, 1.0f64);
    let sides = [(-dx, a.0 - frame.left), (dx, frame.right - a.0), (-dy, a.1 - frame.top), (dy, frame.bottom - a.1)];
    for (towards, room) in sides {
        if towards == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if towards < 0.0 {
            start = start.max(room / towards);
        } else {
            end = end.min(room / towards);
        }
    }
    let at = |part: f64| (a.0 + part * dx, a.1 + part * dy);
    (start <= end).then(|| [at(start), at(end)])
}

/// The runs of a polyline inside the frame.
fn inside(frame: &Frame, points: &[Option<(f64, f64)>]) -> Vec<Vec<(f64, f64)>> {
    let mut runs: Vec<Vec<(f64, f64)>> = Vec::new();
    for pair in points.windows(2) {
        let Some([a, b]) = pair[0].zip(pair[1]).and_then(|(a, b)| clipped(frame, a, b)) else { continue };
        match runs.last_mut() {
            Some(run) if run.last() == Some(&a) => run.push(b),
            _ => runs.push(vec![a, b]),
        }
    }
    runs
}

/// A polyline cut into strokes: `pattern` is the length of a stroke and of the gap after it, px.
fn dashes(run: &[(f64, f64)], pattern: (f64, f64)) -> Vec<Vec<(f64, f64)>> {
    let mut strokes = Vec::new();
    let (mut drawing, mut left) = (true, pattern.0);
    let mut stroke: Vec<(f64, f64)> = run.first().copied().into_iter().collect();
    for pair in run.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        loop {
            let length = (to.0 - from.0).hypot(to.1 - from.1);
            if length <= left {
                left -= length;
                stroke.push(to);
                break;
            }
            let part = left / length;
            from = (from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1));
            stroke.push(from);
            let done = std::mem::replace(&mut stroke, vec![from]);
            if drawing {
                strokes.push(done);
            }
            drawing = !drawing;
            left = if drawing { pattern.0 } else { pattern.1 };
        }
    }
    if drawing && stroke.len() > 1 {
        strokes.push(stroke);
    }
    strokes
}

impl<DB: DrawingBackend> Painter<'_, DB> {
    fn units(px: f64) -> i32 {
        (px * f64::from(UNIT)).round() as i32
    }

    fn at((x, y): (f64, f64)) -> (i32, i32) {
        (Self::units(x), Self::units(y))
    }

    fn style(size: f64, anchor: HPos) -> TextStyle<'static> {
        TextStyle {
            font: FontDesc::new(FontFamily::Name(FONT), size * f64::from(UNIT), FontStyle::Normal),
            color: RGBColor(INK.0, INK.1, INK.2).to_backend_color(),
            pos: Pos::new(anchor, VPos::Center),
        }
    }

    /// The width of `text`, px.
    fn width(&self, text: &str, size: f64) -> f64 {
        let style = Self::style(size, HPos::Left);
        // Without the font, which files::fonts excludes, any estimate will do.
        let units =
            self.area.estimate_text_size(text, &style).map_or(0.6 * size * text.len() as f64, |s| f64::from(s.0));
        units / f64::from(UNIT)
    }

    /// Text whose digits and capitals are centred on the height of `at`.
    fn text(&self, text: &str, at: (f64, f64), size: f64, anchor: HPos) -> Result<()> {
        let at = (at.0, at.1 + self.sink * size);
        self.area.draw(&Text::new(text.to_owned(), Self::at(at), Self::style(size, anchor))).map_err(refused)
    }

    /// Text that reads upwards, centred at `at`.
    fn upright(&self, text: &str, at: (f64, f64)) -> Result<()> {
        let at = (at.0 + self.sink * LABEL, at.1);
        let mut style = Self::style(LABEL, HPos::Center);
        style.font = style.font.transform(FontTransform::Rotate270);
        self.area.draw(&Text::new(text.to_owned(), Self::at(at), style)).map_err(refused)
    }

    fn line(&self, points: &[(f64, f64)], colour: Colour, width: f64) -> Result<()> {
        let style = ShapeStyle {
            color: RGBColor(colour.0, colour.1, colour.2).to_rgba(),
            filled: false,
            stroke_width: (width * f64::from(UNIT)).round() as u32,
        };
        // The rasteriser's joints need segments longer than the round-off of their ends.
        let mut path: Vec<(i32, i32)> = Vec::with_capacity(points.len());
        for (i, &point) in points.iter().enumerate() {
            let (x, y) = Self::at(point);
            let near = path.last().is_some_and(|last| (last.0 - x).abs().max((last.1 - y).abs()) < 2 * UNIT as i32);
            if near && i + 1 < points.len() {
                continue;
            }
            if near && path.len() > 1 {
                path.pop();
            }
            path.push((x, y));
        }
        self.area.draw(&PathElement::new(path, style)).map_err(refused)
    }

    fn rectangle(&self, a: (f64, f64), b: (f64, f64), colour: Colour) -> Result<()> {
        let style = RGBColor(colour.0, colour.1, colour.2).filled();
        self.area.draw(&Rectangle::new([Self::at(a), Self::at(b)], style)).map_err(refused)
    }

    fn ring(&self, at: (f64, f64), colour: Colour) -> Result<()> {
        // A ring as two discs: the bitmap backend draws thick circles with holes.
        let disc = |radius: f64, colour: Colour| {
            let style = RGBColor(colour.0, colour.1, colour.2).filled();
            self.area.draw(&Circle::new(Self::at(at), Self::units(radius), style)).map_err(refused)
        };
        disc(4.0, colour)?;
        disc(2.5, (255, 255, 255))
    }

    fn grid(&self, frame: &Frame, x: (&Mapping, &[Tick]), y: (&Mapping, &[Tick])) -> Result<()> {
        for at in x.1.iter().filter(|tick| tick.label.is_some()).filter_map(|tick| x.0.position(tick.at)) {
            self.line(&[(at, frame.top), (at, frame.bottom)], GRID, 1.0)?;
        }
        for at in y.1.iter().filter(|tick| tick.label.is_some()).filter_map(|tick| y.0.position(tick.at)) {
            self.line(&[(frame.left, at), (frame.right, at)], GRID, 1.0)?;
        }
        Ok(())
    }

    fn axes(&self, frame: &Frame, x: (&Mapping, &[Tick]), y: (&Mapping, &[Tick])) -> Result<()> {
        let Frame { left, top, right, bottom } = *frame;
        self.line(&[(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], INK, 1.0)?;
        for tick in x.1 {
            let Some(at) = x.0.position(tick.at) else { continue };
            self.line(&[(at, bottom), (at, bottom + if tick.label.is_some() { 8.0 } else { 4.0 })], INK, 1.0)?;
            if let Some(label) = &tick.label {
                self.text(label, (at, bottom + 21.0), TICK, HPos::Center)?;
            }
        }
        for tick in y.1 {
            let Some(at) = y.0.position(tick.at) else { continue };
            self.line(&[(left, at), (left - if tick.label.is_some() { 8.0 } else { 4.0 }, at)], INK, 1.0)?;
            if let Some(label) = &tick.label {
                self.text(label, (left - 12.0, at), TICK, HPos::Right)?;
            }
        }
        Ok(())
    }

    fn curve(&self, curve: &Curve, frame: &Frame, x: &Mapping, y: &Mapping) -> Result<()> {
        let points: Vec<_> = curve.points.iter().map(|p| x.position(p.0).zip(y.position(p.1))).collect();
        if curve.stroke == Stroke::Points {
            let within =
                |p: &(f64, f64)| (frame.left..=frame.right).contains(&p.0) && (frame.top..=frame.bottom).contains(&p.1);
            return points.into_iter().flatten().filter(within).try_for_each(|point| self.ring(point, curve.colour));
        }
        inside(frame, &points).iter().try_for_each(|run| self.stroke(run, curve.colour, curve.stroke))
    }

    fn stroke(&self, run: &[(f64, f64)], colour: Colour, stroke: Stroke) -> Result<()> {
        let strokes = match stroke {
            Stroke::Solid | Stroke::Points => vec![run.to_vec()],
            Stroke::Dashed => dashes(run, (11.0, 6.0)),
            Stroke::Dotted => dashes(run, (3.0, 4.5)),
        };
        strokes.iter().try_for_each(|stroke| self.line(stroke, colour, 2.5))
    }

    fn entry(&self, (label, curve): &(&str, Option<&Curve>), (x, y): (f64, f64)) -> Result<()> {
        match curve {
            Some(curve) if curve.stroke == Stroke::Points => self.ring((x + 0.5 * SAMPLE, y), curve.colour)?,
            Some(curve) => self.stroke(&[(x, y), (x + SAMPLE, y)], curve.colour, curve.stroke)?,
            None => self.rectangle((x, y - 7.0), (x + SAMPLE, y + 7.0), SHADE)?,
        }
        self.text(label, (x + SAMPLE + 8.0, y), TICK, HPos::Left)
    }
}
