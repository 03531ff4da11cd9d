//! From stick to slip: what the time axis of Figure 7 has no room for.

use super::{Case, Model, Sweep};
use crate::plot::{Axis, Figure, Sheet};

/// Tangential force against the displacement of the indenter while parts of the contact stick, for each model.
pub fn sheet(sweep: &Sweep) -> Sheet {
    let all = sweep.models.iter().flat_map(Model::all);
    // Until everything slips in every case, and a little more.
    let slips = |case: &Case| case.history.sliding_start().map(|row| case.history.sliding[row].abs());
    let reach = 1e3 * 1.2 * all.filter_map(slips).filter(|s| *s < 1e-2).fold(1e-5, f64::max);
    let figures = sweep.models.iter().zip('a'..='z').map(|(model, letter)| panel(model, letter, reach)).collect();
    Sheet::of_curves(figures, sweep.models.len().clamp(1, 2), (820, 600))
}

fn panel(model: &Model, letter: char, reach: f64) -> Figure {
    let points = |case: &Case| {
        let first = case.history.approach_end();
        let points = case.history.sliding[first..].iter().zip(&case.history.tangential[first..]);
        // One step past the end, so that the line reaches it.
        let inside = case.history.sliding[first..].iter().take_while(|s| 1e3 * s.abs() < reach).count() + 1;
        points.take(inside).map(|(s, q)| (1e3 * s, *q)).collect()
    };
    let curves = model.curves(points);
    Figure {
        title: format!("({letter}) {}; v in m/s", model.label),
        x: Axis::linear("displacement s of the indenter, mm").over(0.0, reach),
        y: Axis::linear("tangential force Q, N/m"),
        curves,
        shaded: None,
    }
}
