//! Where the face sticks, slips and has no contact, in time.

use super::face::Face;
use super::{Run, nearest};
use crate::error::Result;
use crate::output::reader::Field;
use crate::plot::{Axis, Colour, Colouring, Map, Panel, Raster, Sheet};

/// What there is, and its colour.
pub(super) const CLASSES: [(&str, Colour); 3] =
    [("no contact", (226, 226, 226)), ("stick", (0, 114, 178)), ("slip", (230, 159, 0))];

/// Fields of the map along the time.
const COLUMNS: usize = 900;

/// The approach, the transition to sliding, and the whole history.
pub fn sheet(run: &Run) -> Result<Sheet> {
    if run.is_in_space() {
        return super::space::maps::stick_slip(run);
    }
    let face = run.face()?;
    let state = State { run, face: &face, shear: face.field("shear")?, slip_rate: face.field("slip_rate")? };
    let t0 = run.approach_time();
    let end = face.time[face.time.len() - 1];
    let mut panels = Vec::new();
    if t0 > 0.0 {
        panels.push(map(&state, (0.0, t0.min(end)), 0.0, ("Approach", "time t, s")));
    }
    if let Some(row) = run.history.sliding_start() {
        let all_slips = run.history.time[row];
        let until = (t0 + 1.6 * (all_slips - t0)).min(end);
        // With fewer profiles than this there is no transition to see.
        if face.between(t0, until).len() > 4 {
            panels.push(map(&state, (t0, until), t0, ("From stick to slip", "t − t_{0}, s")));
        }
    }
    if end > t0 {
        panels.push(map(&state, (0.0, end), 0.0, ("Whole history", "time t, s")));
    }
    Ok(Sheet { panels, columns: 1, size: (720, 360), note: String::new() })
}

struct State<'a> {
    run: &'a Run,
    face: &'a Face<'a>,
    shear: Field,
    slip_rate: Field,
}

impl State<'_> {
    /// 0 no contact, 1 sticks, 2 slips: as `stick_fraction` counts them.
    fn class(&self, frame: usize, node: usize) -> f64 {
        let fields = [self.face.pressure(), &self.shear, &self.slip_rate];
        let [pressure, shear, rate] = fields.map(|field| field.row(frame)[node]);
        match pressure > 0.0 {
            false => 0.0,
            true if sticks(self.run, (pressure, shear.abs(), rate.abs())) => 1.0,
            true => 2.0,
        }
    }
}

/// Whether a point in contact sticks, with its pressure and what its shear and slip rate amount to.
pub(super) fn sticks(run: &Run, (pressure, shear, rate): (f64, f64, f64)) -> bool {
    let friction = run.scene.friction.as_ref();
    match friction.map(|friction| (friction.law.rate(), friction.coefficient())) {
        Some((Some(regularisation), _)) => rate < regularisation,
        // Up to round-off.
        Some((_, Some(coefficient))) => shear < (1.0 - 1e-12) * coefficient * pressure,
        Some((_, None)) => rate == 0.0,
        None => false,
    }
}

/// The state from one time to another, counted from `origin`; what is shown and the label of the times.
fn map(state: &State<'_>, (from, to): (f64, f64), origin: f64, (title, label): (&str, &str)) -> Panel {
    let face = state.face;
    // The nodes in the order of their places; the fields of a map are as wide as the cells of a uniform face.
    let (places, nodes): (Vec<f64>, Vec<usize>) = face.nodes(&face.whole()).into_iter().unzip();
    let (low, high) = (places[0], places[places.len() - 1]);
    let rows = nodes.len().clamp(2, 512);
    let half = 0.5 * (high - low) / (nodes.len() - 1).max(1) as f64;
    let ends = (low - half, high + half);
    let picked: Vec<usize> = (0..rows)
        .map(|i| nodes[nearest(&places, ends.0 + (ends.1 - ends.0) * (i as f64 + 0.5) / rows as f64)])
        .collect();
    let frames: Vec<usize> = (0..COLUMNS)
        .map(|j| {
            // A step's profile stands for the time since the one before.
            let time = from + (to - from) * (j as f64 + 0.5) / COLUMNS as f64;
            face.time.partition_point(|t| *t < time).min(face.time.len() - 1)
        })
        .collect();
    let values = picked.iter().flat_map(|&node| frames.iter().map(move |&frame| state.class(frame, node))).collect();
    let time = (from - origin, to - origin);
    Panel::Map(Map {
        title: title.into(),
        x: Axis::linear(label).over(time.0, time.1),
        y: Axis::linear("x, m"),
        raster: Raster { x: time, y: ends, columns: COLUMNS, values },
        colouring: Colouring::Classes(CLASSES.map(|(name, colour)| (name.into(), colour)).to_vec()),
        equal: false,
        arrows: Vec::new(),
    })
}
