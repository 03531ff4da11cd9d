//! Bars that say what colours stand for, right of a frame.

use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::HPos;

use super::painter::{Frame, INK, LABEL, Painter, TICK};
use super::{Colour, Key};
use crate::error::Result;

/// Width of a bar, and its distance from the frame, px.
const WIDTH: f64 = 18.0;
const AWAY: f64 = 14.0;
/// The least distance of two labels, px.
const ROW: f64 = 19.0;

/// Fields of colour from the bottom up.
pub struct Bar {
    /// The quantity and its unit.
    pub label: String,
    /// At least one.
    pub fields: Vec<Colour>,
    /// Texts beside it and where they stand, in fields from the bottom; ascending.
    pub marks: Vec<(f64, String)>,
}

impl Bar {
    /// A field for each entry, named at its middle.
    pub fn of(key: &Key) -> Self {
        let marks = key.entries.iter().enumerate().map(|(i, (name, _))| (i as f64 + 0.5, name.clone()));
        let fields = key.entries.iter().map(|(_, colour)| *colour).collect();
        Self { label: key.label.clone(), fields, marks: marks.collect() }
    }

    /// All that it takes right of the frame, px.
    pub fn width<DB: DrawingBackend>(&self, painter: &Painter<DB>) -> f64 {
        self.label_at(painter) + 0.8 * LABEL
    }

    /// The distance of the middle of its label from the frame, px.
    fn label_at<DB: DrawingBackend>(&self, painter: &Painter<DB>) -> f64 {
        let widest = self.marks.iter().map(|(_, name)| painter.width(name, TICK)).fold(0.0, f64::max);
        AWAY + WIDTH + 9.0 + widest + 0.9 * LABEL
    }

    /// Draws it as high as the frame.
    pub fn draw<DB: DrawingBackend>(&self, painter: &Painter<DB>, frame: &Frame) -> Result<()> {
        let (left, right) = (frame.right + AWAY, frame.right + AWAY + WIDTH);
        let Frame { top, bottom, .. } = *frame;
        let at = |field: f64| bottom + (top - bottom) * field / self.fields.len() as f64;
        for (i, colour) in self.fields.iter().enumerate() {
            painter.rectangle((left, at(i as f64 + 1.0)), (right, at(i as f64)), *colour)?;
        }
        painter.line(&[(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], INK, 1.0)?;
        for (field, name) in self.told(bottom - top) {
            painter.line(&[(right, at(*field)), (right + 5.0, at(*field))], INK, 1.0)?;
            painter.text(name, (right + 9.0, at(*field)), TICK, HPos::Left)?;
        }
        painter.upright(&self.label, (frame.right + self.label_at(painter), 0.5 * (top + bottom)))
    }

    /// The marks that have room on `height` px: every one, or every second, ... with the middle among them.
    fn told(&self, height: f64) -> impl Iterator<Item = &(f64, String)> {
        let apart = height / self.fields.len() as f64;
        let every = (ROW / apart).ceil().max(1.0) as usize;
        self.marks.iter().skip(self.marks.len() / 2 % every).step_by(every)
    }
}
