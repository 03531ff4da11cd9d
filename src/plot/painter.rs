//! Strokes, text and frames on a drawing area, the same for every file format.

use plotters::coord::Shift;
use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::prelude::{DrawingArea, DrawingBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, ShapeStyle, TextStyle};

use super::axes::Mapping;
use super::text::{Run, runs};
use super::ticks::Tick;
use super::{Colour, Curve, Stroke};
use crate::error::{Error, Result};

/// Drawing units per px.
pub const UNIT: u32 = 4;
/// The embedded font by its name, and what a viewer of an SVG without it may take instead.
pub const FONT: &str = "DejaVu Sans, Verdana, sans-serif";
/// Size of the labels of axes, px.
pub const LABEL: f64 = 17.0;
/// Size of the labels of ticks and of the legend, px.
pub const TICK: f64 = 15.0;

/// Of texts and frames.
pub const INK: Colour = (40, 40, 40);
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
        runs(text).iter().map(|run| self.run_width(run, size)).sum()
    }

    fn run_width(&self, run: &Run, size: f64) -> f64 {
        let (text, size) = (run.text.as_str(), run.size * size);
        let style = Self::style(size, HPos::Left);
        // Without the font, which files::fonts excludes, any estimate will do.
        let units =
            self.area.estimate_text_size(text, &style).map_or(0.6 * size * text.len() as f64, |s| f64::from(s.0));
        units / f64::from(UNIT) + if run.size < 1.0 { 0.1 * size } else { 0.0 }
    }

    /// Text whose digits and capitals are centred on the height of `at`.
    pub fn text(&self, text: &str, at: (f64, f64), size: f64, anchor: HPos) -> Result<()> {
        let put = |text: &str, (x, y): (f64, f64), size: f64, anchor| {
            let at = (x, y + self.sink * size);
            self.area.draw(&Text::new(text.to_owned(), Self::at(at), Self::style(size, anchor))).map_err(refused)
        };
        let runs = runs(text);
        if runs.len() < 2 {
            return put(text, at, size, anchor);
        }
        let mut x = match anchor {
            HPos::Left => at.0,
            HPos::Center => at.0 - 0.5 * self.width(text, size),
            HPos::Right => at.0 - self.width(text, size),
        };
        for run in &runs {
            put(&run.text, (x, at.1 + run.drop * size), run.size * size, HPos::Left)?;
            x += self.run_width(run, size);
        }
        Ok(())
    }

    /// The label of an axis that reads upwards, centred at `at`.
    pub fn upright(&self, text: &str, at: (f64, f64)) -> Result<()> {
        let put = |text: &str, (x, y): (f64, f64), size: f64, anchor| {
            let mut style = Self::style(size, anchor);
            style.font = style.font.transform(FontTransform::Rotate270);
            let at = (x + self.sink * size, y);
            self.area.draw(&Text::new(text.to_owned(), Self::at(at), style)).map_err(refused)
        };
        let runs = runs(text);
        if runs.len() < 2 {
            return put(text, at, LABEL, HPos::Center);
        }
        let mut y = at.1 + 0.5 * self.width(text, LABEL);
        for run in &runs {
            put(&run.text, (at.0 + run.drop * LABEL, y), run.size * LABEL, HPos::Left)?;
            y -= self.run_width(run, LABEL);
        }
        Ok(())
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

    /// The sign of a break between two heights, on either side of a frame.
    pub fn gap(&self, frame: &Frame, lower: f64, upper: f64) -> Result<()> {
        for x in [frame.left, frame.right] {
            self.rectangle((x - 3.0, upper), (x + 3.0, lower), (255, 255, 255))?;
            for y in [lower, upper] {
                self.line(&[(x - 6.0, y + 3.0), (x + 6.0, y - 3.0)], INK, 1.0)?;
            }
        }
        Ok(())
    }

    /// Lines at the labelled ticks.
    pub fn grid(&self, frame: &Frame, x: (&Mapping, &[Tick]), y: (&Mapping, &[Tick])) -> Result<()> {
        for at in x.1.iter().filter(|tick| tick.label.is_some()).filter_map(|tick| x.0.position(tick.at)) {
            self.line(&[(at, frame.top), (at, frame.bottom)], GRID, 1.0)?;
        }
        let inside = |at: &f64| (frame.top..=frame.bottom).contains(at);
        for at in y.1.iter().filter(|tick| tick.label.is_some()).filter_map(|tick| y.0.position(tick.at)).filter(inside)
        {
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
            self.line(&[(at, bottom), (at, bottom + if tick.label.is_some() { 6.0 } else { 3.0 })], INK, 1.0)?;
            if let Some(label) = &tick.label {
                self.text(label, (at, bottom + 18.0), TICK, HPos::Center)?;
            }
        }
        for tick in y.1 {
            let Some(at) = y.0.position(tick.at) else { continue };
            self.line(&[(left, at), (left - if tick.label.is_some() { 6.0 } else { 3.0 }, at)], INK, 1.0)?;
            if let Some(label) = &tick.label {
                self.text(label, (left - 10.0, at), TICK, HPos::Right)?;
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
            Stroke::Broad => return self.line(run, pale(colour), 6.0),
            Stroke::Solid | Stroke::Points => vec![run.to_vec()],
            Stroke::Dashed => dashes(run, (10.0, 5.0)),
            Stroke::Dotted => dashes(run, (2.5, 4.0)),
        };
        strokes.iter().try_for_each(|stroke| self.line(stroke, colour, 2.0))
    }
}

/// The colour mixed with white.
fn pale((red, green, blue): Colour) -> Colour {
    let mix = |part: u8| (0.38 * f64::from(part) + 0.62 * 255.0) as u8;
    (mix(red), mix(green), mix(blue))
}
