//! Entries of a legend.

use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::HPos;

use super::painter::{Frame, Painter, TICK};
use super::{Colour, Curve, Stroke};
use crate::error::Result;

const ROW: f64 = 22.0;
const SAMPLE: f64 = 34.0;

/// What stands before the text of an entry.
pub enum Sample<'a> {
    /// A piece of the curve.
    Curve(&'a Curve),
    /// A field of its colour.
    Field(Colour),
}

/// Entries from left to right above the frame, in as many rows as they take.
pub struct Legend<'a> {
    entries: Vec<(&'a str, Sample<'a>)>,
    places: Vec<Place>,
}

/// Where an entry stands.
struct Place {
    row: usize,
    offset: f64,
}

impl<'a> Legend<'a> {
    /// The entries that have a text, laid out over `width` px.
    pub fn new<DB: DrawingBackend>(painter: &Painter<DB>, entries: Vec<(&'a str, Sample<'a>)>, width: f64) -> Self {
        let entries: Vec<_> = entries.into_iter().filter(|(label, _)| !label.is_empty()).collect();
        let (mut row, mut offset) = (0, 0.0);
        let place = |(label, _): &(&str, Sample)| {
            let wide = SAMPLE + 7.0 + painter.width(label, TICK);
            if offset > 0.0 && offset + wide > width {
                (row, offset) = (row + 1, 0.0);
            }
            let place = Place { row, offset };
            offset += wide + 20.0;
            place
        };
        let places = entries.iter().map(place).collect();
        Self { entries, places }
    }

    /// px
    pub fn height(&self) -> f64 {
        ROW * self.places.iter().map(|place| place.row + 1).max().unwrap_or(0) as f64
    }

    /// Draws it right above `frame`.
    pub fn draw<DB: DrawingBackend>(&self, painter: &Painter<DB>, frame: &Frame) -> Result<()> {
        let top = frame.top - self.height();
        for ((label, sample), place) in self.entries.iter().zip(&self.places) {
            let y = top + ROW * (place.row as f64 + 0.5) - 3.0;
            let x = frame.left + place.offset;
            match sample {
                Sample::Curve(curve) if curve.stroke == Stroke::Points => {
                    painter.ring((x + 0.5 * SAMPLE, y), curve.colour)?;
                }
                Sample::Curve(curve) => painter.stroke(&[(x, y), (x + SAMPLE, y)], curve.colour, curve.stroke)?,
                Sample::Field(colour) => painter.rectangle((x, y - 6.0), (x + SAMPLE, y + 6.0), *colour)?,
            }
            painter.text(label, (x + SAMPLE + 7.0, y), TICK, HPos::Left)?;
        }
        Ok(())
    }
}
