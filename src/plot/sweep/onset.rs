//! From stick to slip: what the time axis of Figure 7 has no room for.

use super::{Case, Model, Sweep, broken, figure7};
use crate::plot::{Axis, Figure, Sheet};

/// Tangential force against the displacement of the indenter while parts of the contact stick, for each model.
pub fn sheet(sweep: &Sweep) -> Sheet {
    let all =
        sweep.models.iter().flat_map(|model| model.cases.iter().chain(&model.instantaneous).chain(&model.long_term));
    // Until everything slips in every case, and a little more.
    let slips = |case: &Case| case.history.sliding_start().map(|row| case.history.sliding[row].abs());
    let reach = 1e3 * 1.2 * all.filter_map(slips).filter(|s| *s < 1e-2).fold(1e-5, f64::max);
    Sheet::in_pairs(sweep.models.iter().map(|model| panel(sweep, model, reach)).collect(), 420)
}

fn panel(sweep: &Sweep, model: &Model, reach: f64) -> Figure {
    let points = |case: &Case| {
        let first = case.history.approach_end();
        let points = case.history.sliding[first..].iter().zip(&case.history.tangential[first..]);
        // One step past the end, so that the line reaches it.
        let inside = case.history.sliding[first..].iter().take_while(|s| 1e3 * s.abs() < reach).count() + 1;
        points.take(inside).map(|(s, q)| (1e3 * s, *q)).collect::<Vec<_>>()
    };
    let curves = model.curves(&sweep.abscissa, points);
    let near = model.cases.iter().chain(&model.long_term).flat_map(points).map(|point| point.1);
    let far = model
        .instantaneous
        .iter()
        .filter(|_| sweep.abscissa.is_velocity())
        .map(|case| points(case).into_iter().fold(0.0f64, |high, point| high.max(point.1)));
    let y = broken("Q, N/m".into(), near, far);
    let x = Axis::linear("displacement s of the indenter, mm").over(0.0, reach);
    Figure { key: model.key(&sweep.abscissa), ..Figure::new(figure7::title(model), x, y, curves) }
}
