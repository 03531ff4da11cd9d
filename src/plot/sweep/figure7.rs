//! Tangential force against time for each model, and at the end against the varied key: Figure 7 of the paper.

use super::{Case, Model, Sweep, broken};
use crate::plot::{Axis, Figure, Sheet};

/// One panel for each model and one for the force at the end.
pub fn sheet(sweep: &Sweep) -> Sheet {
    let mut figures: Vec<Figure> = sweep.models.iter().map(|model| transient(sweep, model)).collect();
    figures.push(at_the_end(sweep));
    Sheet::in_pairs(figures, 420).noting(sweep.note())
}

/// The same axes for all models.
fn transient(sweep: &Sweep, model: &Model) -> Figure {
    let cases = || sweep.models.iter().flat_map(|model| &model.cases);
    let ratio = cases().all(|case| case.t0 > 0.0);
    let time = |case: &Case, t: f64| if ratio { t / case.t0 } else { t };
    let points = |case: &Case| {
        case.history.time.iter().map(|t| time(case, *t)).zip(case.history.tangential.iter().copied()).collect()
    };
    let end = cases().map(|case| time(case, case.history.time[case.history.time.len() - 1])).fold(1.0, f64::max);
    let x = if ratio { Axis::linear("t/t_{0}").over(0.9, end) } else { Axis::linear("time t, s").over(0.0, end) };
    // Bounds are drawn where they hold for all cases of a model.
    let bounded = sweep.abscissa.is_velocity();
    let near = cases().chain(sweep.models.iter().flat_map(|model| &model.long_term).filter(|_| bounded));
    let far = sweep.models.iter().filter_map(|model| model.instantaneous.get(model.instantaneous.len() / 2));
    let far = far.filter(|_| bounded).map(tangential);
    // What rises to these values is the figure onset's.
    let slides = |case: &Case| case.history.sliding_start().unwrap_or(0);
    let near = near.flat_map(|case| case.history.tangential[slides(case)..].iter().copied());
    let y = broken("Q, N/m".into(), near, far);
    let curves = model.curves(&sweep.abscissa, points);
    Figure { key: model.key(&sweep.abscissa), ..Figure::new(title(model), x, y, curves) }
}

/// What the panel of a model shows.
pub fn title(model: &Model) -> String {
    if model.label.is_empty() { "Tangential force".into() } else { model.label.clone() }
}

fn tangential(case: &Case) -> f64 {
    case.mean(|history| &history.tangential)
}

fn at_the_end(sweep: &Sweep) -> Figure {
    let mut curves = sweep.bounds(tangential);
    let own = sweep.against(|case| Some(tangential(case)));
    // The models first in the legend, the bounds below them in the drawing.
    let names = curves.split_off(curves.len() - curves.iter().filter(|curve| !curve.label.is_empty()).count());
    curves.extend(own);
    curves.extend(names);
    let name = sweep.named("Q", |history| &history.tangential);
    let near = sweep.models.iter().flat_map(|model| model.cases.iter().chain(&model.long_term));
    let far = sweep.models.iter().flat_map(|model| &model.instantaneous);
    let y = broken(format!("{name}, N/m"), near.map(tangential), far.map(tangential));
    Figure::new(capital(&name), sweep.abscissa.axis(), y, curves)
}

/// With a capital at its beginning.
pub fn capital(text: &str) -> String {
    let mut rest = text.chars();
    rest.next().map_or_else(String::new, |first| first.to_uppercase().chain(rest).collect())
}
