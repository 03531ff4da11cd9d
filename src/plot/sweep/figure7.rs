//! Tangential force against time for each model, and its steady value against velocity: Figure 7 of the paper.

use super::{Case, Model, Sweep, against_velocity, bounds};
use crate::plot::{Axis, Figure, Sheet};

/// One panel for each model and one for the steady value.
pub fn sheet(sweep: &Sweep) -> Sheet {
    let highest = sweep
        .models
        .iter()
        .flat_map(Model::all)
        .flat_map(|case| &case.history.tangential)
        .fold(0.0f64, |high, q| high.max(*q));
    let mut figures: Vec<Figure> = Vec::new();
    let mut letters = 'a'..='z';
    for (model, letter) in sweep.models.iter().zip(letters.by_ref()) {
        figures.push(transient(model, letter, highest));
    }
    figures.push(steady(sweep, letters.next().unwrap_or('z')));
    Sheet::of_curves(figures, 2, (820, 600))
}

fn transient(model: &Model, letter: char, highest: f64) -> Figure {
    let points = |case: &Case| {
        case.history.time.iter().map(|t| t / case.t0).zip(case.history.tangential.iter().copied()).collect()
    };
    let curves = model.curves(points);
    let end = curves.iter().filter_map(|curve| curve.points.last()).fold(1.0f64, |end, point| end.max(point.0));
    Figure {
        title: format!("({letter}) {}; v in m/s", model.label),
        x: Axis::linear("t/t₀").over(0.8, end),
        y: Axis::linear("tangential force Q, N/m").over(-0.02 * highest, 1.06 * highest),
        curves,
        shaded: None,
    }
}

fn steady(sweep: &Sweep, letter: char) -> Figure {
    let mut curves = bounds(sweep, |case| case.steady(|history| &history.tangential));
    let own = against_velocity(sweep, |case| Some(case.steady(|history| &history.tangential)));
    // The models first in the legend, the bounds below them in the drawing.
    let names = curves.split_off(curves.len() - curves.iter().filter(|curve| !curve.label.is_empty()).count());
    curves.extend(own);
    curves.extend(names);
    Figure {
        title: format!("({letter}) steady value"),
        x: Axis::log("velocity v, m/s"),
        y: Axis::linear("steady tangential force Q, N/m"),
        curves,
        shaded: None,
    }
}
