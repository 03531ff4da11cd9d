//! Curves over a pair of axes.

use plotters::prelude::DrawingBackend;

use super::axes::{Mapping, Ruler};
use super::bar::Bar;
use super::layout::{Drawn, Place, Sides, labels, left_of};
use super::legend::{Legend, Sample};
use super::painter::{Frame, Painter};
use super::{Colour, Figure};
use crate::error::Result;

const SHADE: Colour = (238, 242, 232);
/// px a label of a tick.
const ACROSS: f64 = 52.0;
const UPWARDS: f64 = 32.0;

impl<DB: DrawingBackend> Drawn<DB> for Figure {
    fn title(&self) -> &str {
        &self.title
    }

    fn sides(&self, painter: &Painter<DB>, height: f64) -> Sides {
        let bar = self.key.as_ref().map_or(0.0, |key| Bar::of(key).width(painter));
        Sides { left: left_of(self.upwards(height).widest(painter)), right: bar + 20.0 }
    }

    fn legend(&self, painter: &Painter<DB>, width: f64) -> f64 {
        Legend::new(painter, entries(self), width).height()
    }

    fn draw(&self, painter: &Painter<DB>, &Place { frame, sides, height }: &Place) -> Result<()> {
        let width = frame.right - frame.left;
        let across = Ruler::new(&self.x, points(self).map(|p| p.0), (width / ACROSS) as usize);
        let upwards = self.upwards(height);
        let (x, y) = (across.along(frame.left, frame.right), upwards.along(frame.bottom, frame.top));
        if let Some((band, _)) = &self.shaded
            && let (Some(from), Some(to)) = (x.position(band.from), x.position(band.to))
        {
            let (from, to) = (from.clamp(frame.left, frame.right), to.clamp(frame.left, frame.right));
            painter.rectangle((from, frame.top), (to, frame.bottom), SHADE)?;
        }
        let frames = parts(&frame, &y);
        for part in &frames {
            painter.grid(part, (&x, &across.ticks), (&y, &upwards.ticks))?;
            self.curves.iter().try_for_each(|curve| painter.curve(curve, part, &x, &y))?;
        }
        painter.axes(&frame, (&x, &across.ticks), (&y, &upwards.ticks))?;
        frames.windows(2).try_for_each(|pair| painter.gap(&frame, pair[0].top, pair[1].bottom))?;
        labels(painter, &frame, sides, (&across.label, &upwards.label))?;
        self.key.iter().try_for_each(|key| Bar::of(key).draw(painter, &frame))?;
        Legend::new(painter, entries(self), width).draw(painter, &frame)
    }
}

impl Figure {
    /// The vertical axis in a panel of this height.
    fn upwards(&self, height: f64) -> Ruler {
        Ruler::new(&self.y, points(self).map(|p| p.1), ((height - 120.0) / UPWARDS) as usize)
    }
}

fn points(figure: &Figure) -> impl Iterator<Item = &(f64, f64)> {
    figure.curves.iter().flat_map(|curve| &curve.points)
}

/// The parts of the frame that the stretches of its vertical axis take.
fn parts(frame: &Frame, y: &Mapping) -> Vec<Frame> {
    y.ends().map(|(bottom, top)| Frame { top, bottom, ..*frame }).collect()
}

/// The curves with a label, and the shaded range.
fn entries(figure: &Figure) -> Vec<(&str, Sample<'_>)> {
    let curves = figure.curves.iter().map(|curve| (curve.label.as_str(), Sample::Curve(curve)));
    let shaded = figure.shaded.iter().map(|(_, label)| (label.as_str(), Sample::Field(SHADE)));
    curves.chain(shaded).collect()
}
