//! Strokes, text and frames on a drawing area, the same for every file format.

use plotters::coord::Shift;
use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::prelude::{DrawingArea, DrawingBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, ShapeStyle, TextStyle};

use super::ticks::Tick;
use super::{Colour, Curve, Scale, Stroke};
use crate::error::{Error, Result};

/// Drawing units per px.
pub const UNIT: u32 = 4;
/// The embedded font by its name, and what a viewer of an SVG without it may take instead.
pub const FONT: &str = "DejaVu Sans, Verdana, sans-serif";
/// Size of the labels of axes, px.
pub const LABEL: f64 = 18.0;
/// Size of the labels of ticks and of the legend, px.
pub const TICK: f64 = 15.0;

const INK: Colour = (40, 40, 40);
const GRID: Colour = (225, 225, 225);

/// A rectangle, px, y downwards.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// px
    pub left: f64,
    /// px
    pub top: f64,
    /// px
    pub right: f64,
    /// px
    pub bottom: f64,
}

/// From values to positions along one side of the frame.
pub struct Mapping {
    /// How values become positions.
    pub scale: Scale,
    /// The values at the two ends.
    pub range: (f64, f64),
    /// The positions of the two ends, px.
    pub ends: (f64, f64),
}

impl Mapping {
    /// The position of `value`; none where the axis has none.
    pub fn position(&self, value: f64) -> Option<f64> {
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

/// Draws in px on an area of UNIT drawing units each.
pub struct Painter<'a, DB: DrawingBackend> {
    /// The area.
    pub area: &'a DrawingArea<DB, Shift>,
    /// By how much of its size the backend sets vertically centred text too high.
    pub sink: f64,
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

/// The error of the drawing library.
pub fn refused(error: impl std::fmt::Display) -> Error {
    Error::Internal(format!("the figure cannot be drawn: {error}"))
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
    pub fn width(&self, text: &str, size: f64) -> f64 {
        let style = Self::style(size, HPos::Left);
        // Without the font, which files::fonts excludes, any estimate will do.
        let units =
            self.area.estimate_text_size(text, &style).map_or(0.6 * size * text.len() as f64, |s| f64::from(s.0));
        units / f64::from(UNIT)
    }

    /// Text whose digits and capitals are centred on the height of `at`.
    pub fn text(&self, text: &str, at: (f64, f64), size: f64, anchor: HPos) -> Result<()> {
        let at = (at.0, at.1 + self.sink * size);
        self.area.draw(&Text::new(text.to_owned(), Self::at(at), Self::style(size, anchor))).map_err(refused)
    }

    /// Text that reads upwards, centred at `at`.
    pub fn upright(&self, text: &str, at: (f64, f64)) -> Result<()> {
        let at = (at.0 + self.sink * LABEL, at.1);
        let mut style = Self::style(LABEL, HPos::Center);
        style.font = style.font.transform(FontTransform::Rotate270);
        self.area.draw(&Text::new(text.to_owned(), Self::at(at), style)).map_err(refused)
    }

    /// A polyline, `width` px wide.
    pub fn line(&self, points: &[(f64, f64)], colour: Colour, width: f64) -> Result<()> {
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

    /// A filled rectangle between two corners.
    pub fn rectangle(&self, a: (f64, f64), b: (f64, f64), colour: Colour) -> Result<()> {
        let style = RGBColor(colour.0, colour.1, colour.2).filled();
        self.area.draw(&Rectangle::new([Self::at(a), Self::at(b)], style)).map_err(refused)
    }

    /// A small ring.
    pub fn ring(&self, at: (f64, f64), colour: Colour) -> Result<()> {
        // A ring as two discs: the bitmap backend draws thick circles with holes.
        let disc = |radius: f64, colour: Colour| {
            let style = RGBColor(colour.0, colour.1, colour.2).filled();
            self.area.draw(&Circle::new(Self::at(at), Self::units(radius), style)).map_err(refused)
        };
        disc(4.0, colour)?;
        disc(2.5, (255, 255, 255))
    }

    /// Lines at the labelled ticks.
    pub fn grid(&self, frame: &Frame, x: (&Mapping, &[Tick]), y: (&Mapping, &[Tick])) -> Result<()> {
        for at in x.1.iter().filter(|tick| tick.label.is_some()).filter_map(|tick| x.0.position(tick.at)) {
            self.line(&[(at, frame.top), (at, frame.bottom)], GRID, 1.0)?;
        }
        for at in y.1.iter().filter(|tick| tick.label.is_some()).filter_map(|tick| y.0.position(tick.at)) {
            self.line(&[(frame.left, at), (frame.right, at)], GRID, 1.0)?;
        }
        Ok(())
    }

    /// The frame, its ticks and their labels.
    pub fn axes(&self, frame: &Frame, x: (&Mapping, &[Tick]), y: (&Mapping, &[Tick])) -> Result<()> {
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

    /// The part of a curve inside the frame.
    pub fn curve(&self, curve: &Curve, frame: &Frame, x: &Mapping, y: &Mapping) -> Result<()> {
        let points: Vec<_> = curve.points.iter().map(|p| x.position(p.0).zip(y.position(p.1))).collect();
        if curve.stroke == Stroke::Points {
            let within =
                |p: &(f64, f64)| (frame.left..=frame.right).contains(&p.0) && (frame.top..=frame.bottom).contains(&p.1);
            return points.into_iter().flatten().filter(within).try_for_each(|point| self.ring(point, curve.colour));
        }
        inside(frame, &points).iter().try_for_each(|run| self.stroke(run, curve.colour, curve.stroke))
    }

    /// A polyline in its stroke.
    pub fn stroke(&self, run: &[(f64, f64)], colour: Colour, stroke: Stroke) -> Result<()> {
        let strokes = match stroke {
            Stroke::Solid | Stroke::Points => vec![run.to_vec()],
            Stroke::Dashed => dashes(run, (11.0, 6.0)),
            Stroke::Dotted => dashes(run, (3.0, 4.5)),
        };
        strokes.iter().try_for_each(|stroke| self.line(stroke, colour, 2.5))
    }
}
