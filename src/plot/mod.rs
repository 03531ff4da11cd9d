//! Figures: curves over labelled axes, written as PNG and SVG at once.
//!
//! The fonts are part of the program, so that a figure looks the same everywhere. Colours are those of Okabe and Ito
//! (Color Universal Design, 2008), which readers with any colour vision tell apart; curves also differ by their dashes.

mod colours;
mod draw;
mod files;
mod map;
pub mod material;
mod painter;
pub mod results;
pub mod sweep;
mod ticks;

pub use colours::Ramp;
pub use files::replaceable;
pub use map::{Colouring, Map, Raster};

use crate::rheology::Band;

/// A colour: red, green, blue.
pub type Colour = (u8, u8, u8);

/// Black, for what the other curves are measured against.
pub const REFERENCE: Colour = (0, 0, 0);

/// Blue, vermilion, bluish green, reddish purple, orange, sky blue. The palette's yellow is too pale for a line.
pub const PALETTE: [Colour; 6] =
    [(0, 114, 178), (213, 94, 0), (0, 158, 115), (204, 121, 167), (230, 159, 0), (86, 180, 233)];

/// How values become positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// In proportion.
    Linear,
    /// By their logarithm; values that have none are left out.
    Log,
}

/// One axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The quantity and its unit: `time, s`.
    pub label: String,
    /// How values become positions.
    pub scale: Scale,
    /// Its ends; none = around the data.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// A linear axis around the data.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None }
    }

    /// A logarithmic axis around the data.
    pub fn log(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Log, range: None }
    }

    /// The same axis from `from` to `to`.
    #[must_use]
    pub fn over(self, from: f64, to: f64) -> Self {
        Self { range: Some((from, to)), ..self }
    }
}

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// A line.
    Solid,
    /// A dashed line.
    Dashed,
    /// A dotted line.
    Dotted,
    /// A ring at each point, no line.
    Points,
}

/// Points that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The entry in the legend; empty = none.
    pub label: String,
    /// (x, y) in the units of the axes.
    pub points: Vec<(f64, f64)>,
    /// Its colour.
    pub colour: Colour,
    /// Its stroke.
    pub stroke: Stroke,
}

/// Curves over one pair of axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Above everything.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// In drawing order: later ones lie above.
    pub curves: Vec<Curve>,
    /// A range of x to shade, and its entry in the legend.
    pub shaded: Option<(Band, String)>,
}

/// One pair of axes and what stands over them.
#[derive(Debug, Clone, PartialEq)]
pub enum Panel {
    /// Curves.
    Curves(Figure),
    /// A field of colours.
    Map(Map),
}

/// Panels of one size, row after row.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Not empty.
    pub panels: Vec<Panel>,
    /// Panels in a row, >= 1.
    pub columns: usize,
    /// Width and height of a panel, px.
    pub size: (u32, u32),
}

impl Sheet {
    /// Panels of curves.
    pub fn of_curves(figures: Vec<Figure>, columns: usize, size: (u32, u32)) -> Self {
        Self { panels: figures.into_iter().map(Panel::Curves).collect(), columns, size }
    }
}
