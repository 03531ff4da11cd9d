//! Figures of a run in space: maps of the face from above, and sections.

pub mod maps;
pub mod sections;

use super::{Run, nearest, spread};
use crate::error::{Error, Result};
use crate::output::reader::Field;
use crate::plot::numbers::short;

/// The contact face of two directions: where its nodes are, and when.
pub struct Plain<'a> {
    run: &'a Run,
    /// Of the nodes along x and along y, m.
    places: [Vec<f64>; 2],
    /// Along x and y, whether the last node is followed by the first.
    periodic: [bool; 2],
    /// s
    time: Vec<f64>,
    pressure: Field,
}

/// A rectangle of nodes: along each direction the first, how many there are, and where the first is shown, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window([Stretch; 2]);

/// Nodes along one direction, one after the other; beyond the end of a periodic face it goes on at its beginning.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Stretch {
    first: usize,
    count: usize,
    /// Of all nodes.
    all: usize,
    /// Where the first one is shown, and from one to the next, m.
    from: f64,
    step: f64,
}

impl Stretch {
    /// The nodes, and where each is shown.
    fn nodes(self) -> impl Iterator<Item = (usize, f64)> {
        (0..self.count).map(move |k| ((self.first + k) % self.all, self.from + self.step * k as f64))
    }

    /// The ends of what is shown: half a step beyond the nodes.
    fn ends(self) -> (f64, f64) {
        (self.from - 0.5 * self.step, self.from + self.step * (self.count as f64 - 0.5))
    }
}

impl<'a> Plain<'a> {
    /// Of a run in space whose face is a grid.
    pub fn of(run: &'a Run) -> Result<Self> {
        let damaged = |what: &str| Error::file(&run.path, format!("is damaged: {what}"));
        let Some(layer) = run.scene.layer().filter(|layer| layer.spans.len() == 2) else {
            return Err(Error::file(&run.path, "has no face of two directions"));
        };
        let periodic = [0, 1].map(|axis| layer.spans[axis].sides == crate::scene::Sides::Periodic);
        let [columns, rows] = [0, 1].map(|axis| layer.spans[axis].cells + usize::from(!periodic[axis]));
        let coordinates = run.results.interface("coordinates")?;
        let coordinates = run.checked("interface/coordinates", coordinates, (columns * rows, 2))?.values;
        let time = run.results.interface("time")?;
        let count = time.rows;
        let time = run.checked("interface/time", time, (count, 1))?.values;
        if time.is_empty() {
            return Err(damaged("/interface/time is empty"));
        }
        let places = [
            (0..columns).map(|i| coordinates[2 * i * rows]).collect(),
            (0..rows).map(|j| coordinates[2 * j + 1]).collect(),
        ];
        let pressure = Field { rows: 0, columns: 0, values: Vec::new() };
        let mut face = Self { run, places, periodic, time, pressure };
        face.pressure = face.field("pressure", 1)?;
        Ok(face)
    }

    fn count(&self) -> usize {
        self.places[0].len() * self.places[1].len()
    }

    /// A field with so many components at each node and time.
    fn field(&self, name: &str, components: usize) -> Result<Field> {
        let shape = (self.time.len(), components * self.count());
        self.run.checked(&format!("interface/{name}"), self.run.results.interface(name)?, shape)
    }

    /// The node in the list of a field.
    fn node(&self, i: usize, j: usize) -> usize {
        i * self.places[1].len() + j
    }

    fn touches(&self, frame: usize, node: usize) -> bool {
        self.pressure.row(frame)[node] > 0.0
    }

    /// The frame at the end of the approach, and the last one.
    fn ends(&self) -> Vec<usize> {
        let (first, last) = (nearest(&self.time, self.run.approach_time()), self.time.len() - 1);
        if first == last { vec![last] } else { vec![first, last] }
    }

    /// At most `count` frames from the end of the approach until all slips, and the last one.
    fn onset(&self, count: usize) -> Vec<usize> {
        let ends = self.ends();
        let Some(row) = self.run.history.sliding_start() else { return ends };
        let until = self.run.history.time[row];
        let last = self.time.partition_point(|time| *time <= until * (1.0 + 1e-9)).max(ends[0] + 1);
        let mut frames = spread(&(ends[0]..last.min(self.time.len())).collect::<Vec<_>>(), count);
        frames.extend(ends.get(1).filter(|end| !frames.contains(end)));
        frames
    }

    /// t = 10 s, or how far the indenter has slid.
    fn moment(&self, frame: usize) -> String {
        let time = short(self.time[frame], 4);
        match self.run.slid(self.time[frame]) {
            0.0 => format!("t = {time} s"),
            slid => format!("t = {time} s, slid {} m", short(slid, 3)),
        }
    }

    /// The node with the greatest pressure.
    fn deepest(&self, frame: usize) -> [usize; 2] {
        let row = self.pressure.row(frame);
        let deepest = (0..row.len()).max_by(|a, b| row[*a].total_cmp(&row[*b])).unwrap_or(0);
        [deepest / self.places[1].len(), deepest % self.places[1].len()]
    }

    /// Where the pressure is greatest at the frame nearest to a time, m.
    pub fn deepest_at(&self, time: f64) -> [f64; 2] {
        let node = self.deepest(nearest(&self.time, time));
        [0, 1].map(|axis| self.places[axis][node[axis]])
    }

    /// The part of the face that is in contact in any of `frames`, and a little more; all of it where nothing or nearly all is.
    fn window(&self, frames: &[usize]) -> Window {
        let [columns, rows] = [self.places[0].len(), self.places[1].len()];
        let mut touched = [vec![false; columns], vec![false; rows]];
        for &frame in frames {
            for node in (0..columns * rows).filter(|&node| self.touches(frame, node)) {
                touched[0][node / rows] = true;
                touched[1][node % rows] = true;
            }
        }
        Window([0, 1].map(|axis| stretch(&touched[axis], &self.places[axis], self.periodic[axis])))
    }
}

/// The nodes that are touched along a direction, and a margin of an eighth on either side.
fn stretch(touched: &[bool], places: &[f64], periodic: bool) -> Stretch {
    /// Of a face, what may be left out for the sake of what is shown.
    const SPARED: f64 = 0.2;
    let all = touched.len();
    let step = if all > 1 { (places[all - 1] - places[0]) / (all - 1) as f64 } else { 1.0 };
    let whole = Stretch { first: 0, count: all, all, from: places.first().copied().unwrap_or(0.0), step };
    let Some(first) = touched.iter().position(|touched| *touched) else { return whole };
    // Where the longest stretch without contact ends the contact begins.
    let (mut start, mut longest) = (first, 0);
    let mut gap = 0;
    for k in first + 1..=first + all {
        match touched[k % all] {
            true => {
                let wraps = k >= all;
                if gap > longest && (periodic || !wraps) {
                    (start, longest) = (k % all, gap);
                }
                gap = 0;
            }
            false => gap += 1,
        }
    }
    let (start, count) = match periodic {
        true => (start, all - longest),
        // What is not touched in the middle of a bounded face belongs to it.
        false => (first, touched.iter().rposition(|touched| *touched).unwrap_or(first) + 1 - first),
    };
    let margin = (count / 8).max(2);
    if count + 2 * margin >= all || (all - count) as f64 <= SPARED * all as f64 {
        return whole;
    }
    if !periodic {
        let (from, to) = (start.saturating_sub(margin), (start + count + margin).min(all));
        return Stretch { first: from, count: to - from, from: places[from], ..whole };
    }
    // Shown from where it is, or a period to the left.
    let from = whole.from + step * (start as f64 - margin as f64);
    Stretch { first: (start + all - margin) % all, count: count + 2 * margin, from, ..whole }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A contact across the ends of a periodic face is in one piece; one of nearly all of the face is all of it.
    #[test]
    fn stretches_are_around_the_contact() {
        let places: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
        let touched = |from: usize, to: usize| {
            (0..40).map(|k| if from <= to { (from..to).contains(&k) } else { k >= from || k < to }).collect::<Vec<_>>()
        };
        let across = stretch(&touched(36, 4), &places, true);
        assert_eq!((across.first, across.count), (34, 12));
        assert!(
            (across.from - 3.4).abs() < 1e-12
                && across.nodes().nth(6).is_some_and(|(node, x)| node == 0 && (x - 4.0).abs() < 1e-12)
        );
        let inside = stretch(&touched(10, 18), &places, false);
        assert_eq!((inside.first, inside.count), (8, 12));
        for whole in [stretch(&touched(2, 37), &places, true), stretch(&[false; 40], &places, true)] {
            assert_eq!((whole.first, whole.count), (0, 40));
        }
        assert_eq!(stretch(&touched(0, 5), &places, false).first, 0);
    }
}
