//! Figures: curves over labelled axes, written as PNG and SVG at once.
//!
//! The fonts are part of the program, so that a figure looks the same everywhere. Colours are those of Okabe and Ito
//! (Color Universal Design, 2008), which readers with any colour vision tell apart; curves also differ by their dashes.

mod axes;
mod bar;
mod colours;
mod curves;
mod files;
mod layout;
mod legend;
mod map;
pub mod material;
mod numbers;
mod painter;
pub mod results;
pub mod steady;
pub mod sweep;
mod text;
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
    /// The quantity and its unit: `time, s`. In all texts `_{...}` is set lower and `^{...}` higher.
    pub label: String,
    /// How values become positions.
    pub scale: Scale,
    /// Its ends; none = around the data.
    pub range: Option<(f64, f64)>,
    /// Of a linear axis with ends: a second stretch behind a break, for what lies far from all else.
    pub beyond: Option<(f64, f64)>,
    /// What stands at 1, 2, ... in place of numbers.
    pub names: Vec<String>,
}

impl Axis {
    /// A linear axis around the data.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None, beyond: None, names: Vec::new() }
    }

    /// A logarithmic axis around the data.
    pub fn log(label: impl Into<String>) -> Self {
        Self { scale: Scale::Log, ..Self::linear(label) }
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
    /// A broad pale line: what other curves keep to, legible where they lie on it.
    Broad,
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

impl Curve {
    /// A solid line.
    pub fn line(label: impl Into<String>, points: Vec<(f64, f64)>, colour: Colour) -> Self {
        Self { label: label.into(), points, colour, stroke: Stroke::Solid }
    }

    /// The same curve in another colour.
    #[must_use]
    pub fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    /// The same curve in another stroke.
    #[must_use]
    pub fn stroked(self, stroke: Stroke) -> Self {
        Self { stroke, ..self }
    }
}

/// What the colours of ordered curves stand for: a bar of colours right of the frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// The quantity and its unit.
    pub label: String,
    /// From the bottom up.
    pub entries: Vec<(String, Colour)>,
}

/// Curves over one pair of axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Above everything: what is shown.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// In drawing order: later ones lie above.
    pub curves: Vec<Curve>,
    /// A range of x to shade, and its entry in the legend.
    pub shaded: Option<(Band, String)>,
    /// What the colours stand for, where the legend does not say it.
    pub key: Option<Key>,
}

impl Figure {
    /// Curves over their axes, and nothing else.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis, curves: Vec<Curve>) -> Self {
        Self { title: title.into(), x, y, curves, shaded: None, key: None }
    }
}

/// One pair of axes and what stands over them.
#[derive(Debug, Clone, PartialEq)]
pub enum Panel {
    /// Curves.
    Curves(Figure),
    /// A field of colours.
    Map(Map),
}

/// Panels of one size, row after row; several are lettered (a), (b), ...
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Not empty.
    pub panels: Vec<Panel>,
    /// Panels in a row, >= 1.
    pub columns: usize,
    /// Width and height of a panel, px.
    pub size: (u32, u32),
    /// What holds for all of them, below; empty = nothing.
    pub note: String,
}

impl Sheet {
    /// Two panels of this width fill a page of a journal at [`files::PER_INCH`].
    const HALF: u32 = 540;

    /// Panels of curves in two columns.
    pub fn in_pairs(figures: Vec<Figure>, height: u32) -> Self {
        let columns = figures.len().clamp(1, 2);
        Self { columns, ..Self::stacked(figures, height).sized((Self::HALF, height)) }
    }

    /// Panels of curves below one another.
    pub fn stacked(figures: Vec<Figure>, height: u32) -> Self {
        let panels = figures.into_iter().map(Panel::Curves).collect();
        Self { panels, columns: 1, size: (720, height), note: String::new() }
    }

    fn sized(self, size: (u32, u32)) -> Self {
        Self { size, ..self }
    }

    /// The same sheet with a note.
    #[must_use]
    pub fn noting(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }
}
