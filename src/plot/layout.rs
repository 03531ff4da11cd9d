//! Panels on a sheet: all frames are of one width, those of a column below one another, those of a row
//! side by side.

use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, DrawingBackend};
use plotters::style::RGBColor;
use plotters::style::text_anchor::HPos;

use super::painter::{Frame, LABEL, Painter, TICK, refused};
use super::{Panel, Sheet};
use crate::error::Result;

const TITLE: f64 = 18.0;
/// Room above the legend for the title, below the frame for the horizontal axis, and for a row of the note, px.
const HEAD: f64 = 40.0;
const FOOT: f64 = 66.0;
const NOTE: f64 = 26.0;

/// What a panel takes of its area on either side of its frame, px.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sides {
    pub left: f64,
    pub right: f64,
}

/// Where a panel is drawn.
pub struct Place {
    /// Around the data.
    pub frame: Frame,
    /// What all panels have beside their frames.
    pub sides: Sides,
    /// The height of the whole panel, px.
    pub height: f64,
}

/// What can be drawn on a part of a sheet.
pub trait Drawn<DB: DrawingBackend> {
    /// What is shown.
    fn title(&self) -> &str;
    /// The room it needs beside its frame, on an area of this height.
    fn sides(&self, painter: &Painter<DB>, height: f64) -> Sides;
    /// The height of its legend over a frame of this width.
    fn legend(&self, painter: &Painter<DB>, width: f64) -> f64;
    /// Draws all but the title.
    fn draw(&self, painter: &Painter<DB>, place: &Place) -> Result<()>;
}

impl Panel {
    fn drawn<DB: DrawingBackend>(&self) -> &dyn Drawn<DB> {
        match self {
            Self::Curves(figure) => figure,
            Self::Map(map) => map,
        }
    }
}

impl Sheet {
    fn rows(&self) -> usize {
        self.panels.len().div_ceil(self.columns)
    }

    /// Width and height of everything, px.
    pub(super) fn extent(&self) -> (u32, u32) {
        let note = if self.note.is_empty() { 0 } else { NOTE as u32 * self.note.lines().count() as u32 };
        (self.size.0 * self.columns as u32, self.size.1 * self.rows() as u32 + note)
    }

    /// Draws everything. `sink` is by how much of its size a backend sets vertically centred text too high.
    pub(super) fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>, sink: f64) -> Result<()> {
        area.fill(&RGBColor(255, 255, 255)).map_err(refused)?;
        let painter = Painter { area, sink };
        let (width, height) = (f64::from(self.size.0), f64::from(self.size.1));
        let panels: Vec<&dyn Drawn<DB>> = self.panels.iter().map(Panel::drawn).collect();
        // All frames are of one width: panels can be compared.
        let sides = panels.iter().map(|panel| panel.sides(&painter, height));
        let sides =
            sides.fold(Sides::default(), |a, b| Sides { left: a.left.max(b.left), right: a.right.max(b.right) });
        let inner = width - sides.left - sides.right;
        for (row, panels) in panels.chunks(self.columns).enumerate() {
            let legend = panels.iter().map(|panel| panel.legend(&painter, inner)).fold(0.0, f64::max);
            for (column, panel) in panels.iter().enumerate() {
                let (x, y) = (column as f64 * width, row as f64 * height);
                let left = x + sides.left;
                let frame = Frame { left, top: y + HEAD + legend, right: left + inner, bottom: y + height - FOOT };
                let title = match row * self.columns + column {
                    _ if self.panels.len() == 1 => panel.title().to_owned(),
                    index => format!("({}) {}", letter(index), panel.title()),
                };
                painter.text(&title, (frame.left, y + 20.0), TITLE, HPos::Left)?;
                panel.draw(&painter, &Place { frame, sides, height })?;
            }
        }
        for (i, line) in self.note.lines().enumerate() {
            let y = height * self.rows() as f64 + NOTE * (i as f64 + 0.3);
            painter.text(line, (sides.left, y), TICK, HPos::Left)?;
        }
        area.present().map_err(refused)
    }
}

/// a, b, ..., z, a1, b1, ...
fn letter(index: usize) -> String {
    let letter = char::from(b'a' + (index % 26) as u8);
    if index < 26 { letter.into() } else { format!("{letter}{}", index / 26) }
}

/// The room left of a frame whose labels of ticks are so wide, px.
pub fn left_of(widest: f64) -> f64 {
    LABEL + 34.0 + widest
}

/// The labels of the two axes around the frame; the vertical ones of a column stand below one another.
pub fn labels<DB: DrawingBackend>(
    painter: &Painter<DB>,
    frame: &Frame,
    sides: Sides,
    (x, y): (&str, &str),
) -> Result<()> {
    painter.text(x, (0.5 * (frame.left + frame.right), frame.bottom + 45.0), LABEL, HPos::Center)?;
    painter.upright(y, (frame.left - sides.left + LABEL, 0.5 * (frame.top + frame.bottom)))
}
