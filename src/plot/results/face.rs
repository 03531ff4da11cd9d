//! The contact face: where its nodes are shown and which of them are in contact.

use std::f64::consts::TAU;

use super::{Run, nearest};
use crate::error::{Error, Result};
use crate::output::reader::Field;

/// Of the width of the contact, what is shown on either side of it.
const MARGIN: f64 = 0.12;

/// Where and when the profiles of a run stand.
pub struct Face<'a> {
    run: &'a Run,
    /// m
    pub x: Vec<f64>,
    /// s
    pub time: Vec<f64>,
    pressure: Field,
    /// After which the face is itself again, m; none = it does not.
    period: Option<f64>,
}

/// The part of the face around the contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// About which a periodic face is unrolled, m.
    middle: f64,
    /// The ends of the part, m.
    pub ends: (f64, f64),
}

impl<'a> Face<'a> {
    pub fn of(run: &'a Run) -> Result<Self> {
        let [x, time] = ["x", "time"].map(|name| {
            let field = run.results.interface(name)?;
            let rows = field.rows;
            run.checked(&format!("interface/{name}"), field, (rows, 1))
        });
        let (x, time) = (x?.values, time?.values);
        if x.is_empty() || time.is_empty() {
            return Err(Error::file(&run.path, "is damaged: /interface/x or /interface/time is empty"));
        }
        let mut face = Self {
            run,
            x,
            time,
            pressure: Field { rows: 0, columns: 0, values: Vec::new() },
            period: run.scene.period(),
        };
        face.pressure = face.field("pressure")?;
        Ok(face)
    }

    /// A field with a value at each node and time.
    pub fn field(&self, name: &str) -> Result<Field> {
        let shape = (self.time.len(), self.x.len());
        self.run.checked(&format!("interface/{name}"), self.run.results.interface(name)?, shape)
    }

    /// The pressure.
    pub fn pressure(&self) -> &Field {
        &self.pressure
    }

    /// The part of the face that is in contact in any of `frames`, and a little more; all of it where nothing is.
    pub fn window(&self, frames: &[usize]) -> Window {
        let middle = self.middle(frames);
        let whole = self.ends(middle);
        let touched = frames.iter().flat_map(|&frame| {
            let touched = self.x.iter().zip(self.pressure.row(frame)).filter(|(_, p)| **p > 0.0);
            touched.map(|(x, _)| self.place(*x, middle))
        });
        let (low, high) = touched.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let margin = (MARGIN * (high - low)).max(2.0 * (whole.1 - whole.0) / self.x.len() as f64);
        let ends = if low <= high { ((low - margin).max(whole.0), (high + margin).min(whole.1)) } else { whole };
        Window { middle, ends }
    }

    /// All of the face, with the first contact in the middle where it is periodic.
    pub fn whole(&self) -> Window {
        let middle = self.middle(&[self.first()]);
        Window { middle, ends: self.ends(middle) }
    }

    /// The middle of the contact between the first and the last of `frames`.
    fn middle(&self, frames: &[usize]) -> f64 {
        let (Some(first), Some(last)) = (frames.first(), frames.last()) else { return 0.0 };
        let slid = |frame: usize| self.run.slid(self.time[frame]);
        let centre = self.centre(self.first()) - slid(self.first());
        centre + 0.5 * (slid(*first) + slid(*last))
    }

    /// The first frame with contact.
    fn first(&self) -> usize {
        (0..self.time.len()).find(|&frame| self.pressure.row(frame).iter().any(|p| *p > 0.0)).unwrap_or(0)
    }

    /// The middle of the pressure of a periodic face, m: that of its first wave.
    fn centre(&self, frame: usize) -> f64 {
        let Some(period) = self.period else { return 0.0 };
        let wave = |x: &f64, p: &f64| (p * (TAU * x / period).cos(), p * (TAU * x / period).sin());
        let waves = self.x.iter().zip(self.pressure.row(frame)).map(|(x, p)| wave(x, p));
        let (cosine, sine) = waves.fold((0.0, 0.0), |sum, wave| (sum.0 + wave.0, sum.1 + wave.1));
        // To the nearest node: the middle of the pressure of a rough face is as good as any.
        (sine.atan2(cosine) / TAU * self.x.len() as f64).round() / self.x.len() as f64 * period
    }

    fn ends(&self, middle: f64) -> (f64, f64) {
        match self.period {
            Some(period) => (middle - 0.5 * period, middle + 0.5 * period),
            None => self.x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x))),
        }
    }

    fn place(&self, x: f64, middle: f64) -> f64 {
        match self.period {
            Some(period) => (x - middle + 0.5 * period).rem_euclid(period) + middle - 0.5 * period,
            None => x,
        }
    }

    /// The nodes from left to right, each with where it is shown, m.
    pub fn nodes(&self, window: &Window) -> Vec<(f64, usize)> {
        let mut nodes: Vec<(f64, usize)> =
            self.x.iter().enumerate().map(|(node, x)| (self.place(*x, window.middle), node)).collect();
        nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
        nodes
    }

    /// The profile of `field` at frame `frame` from left to right.
    pub fn profile(&self, field: &Field, frame: usize, window: &Window) -> Vec<(f64, f64)> {
        let row = field.row(frame);
        self.nodes(window).into_iter().map(|(x, node)| (x, row[node])).collect()
    }

    /// The node nearest to `x`.
    pub fn nearest(&self, x: f64) -> usize {
        nearest(&self.x, x)
    }

    /// The frame nearest to `time`.
    pub fn at(&self, time: f64) -> usize {
        nearest(&self.time, time)
    }

    /// The frames from `from` to `to`, a rounding apart, s.
    pub fn between(&self, from: f64, to: f64) -> Vec<usize> {
        let slack = 1e-9 * to.abs();
        (0..self.time.len()).filter(|&i| self.time[i] >= from - slack && self.time[i] <= to + slack).collect()
    }
}
