//! The temperature of the body against time, and where its heat goes.

use super::Run;
use super::history::with_phases;
use crate::error::Result;
use crate::plot::{Axis, Curve, Figure, PALETTE, REFERENCE, Sheet, Stroke};

/// Highest and mean temperature; what entered of heat, and what became of it where that was kept.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let time = &run.history.time;
    let curve = |label: &str, colour: usize, values: &[f64]| {
        Curve::line(label, time.iter().copied().zip(values.iter().copied()).collect(), PALETTE[colour])
    };
    let mut figures = Vec::new();
    let mut add = |title: &str, axis: Axis, curves: Vec<Curve>| {
        let figure = Figure::new(title, Axis::linear("time t, s"), axis, curves);
        figures.push(with_phases(run, figure, figures.is_empty()));
    };
    let temperatures = [("highest", 1, "max_temperature"), ("mean, by heat capacity", 0, "mean_temperature")];
    let temperatures = temperatures.map(|(label, colour, column)| Ok((label, colour, run.results.history(column)?)));
    let temperatures = temperatures.into_iter().collect::<Result<Vec<_>>>()?;
    let curves = temperatures.iter().map(|(label, colour, values)| curve(label, *colour, values)).collect();
    let all: Vec<&[f64]> = temperatures.iter().map(|(_, _, values)| values.as_slice()).collect();
    add("Temperature", around("T, K", &all), curves);
    if let Some(entered) = run.energy("heat") {
        let parts =
            [("stored", 0, "heat_stored"), ("to the air", 2, "heat_convected"), ("to the base", 4, "heat_conducted")];
        let parts = parts.into_iter().filter_map(|(label, colour, name)| Some((label, colour, run.energy(name)?)));
        let mut curves: Vec<Curve> = parts.map(|(label, colour, values)| curve(label, colour, &values)).collect();
        curves.push(Curve { colour: REFERENCE, ..curve("entered", 0, &entered).stroked(Stroke::Dashed) });
        add("Heat and where it goes", Axis::linear("heat, J/m"), curves);
    }
    Ok(Sheet::stacked(figures, 320))
}

/// An axis around values that are far from 0, and not less than 0.1 K long: temperatures that stay show as such.
fn around(label: &str, values: &[&[f64]]) -> Axis {
    let all = || values.iter().flat_map(|values| values.iter().copied());
    let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    let margin = (0.06 * (high - low)).max(0.05);
    Axis::linear(label).over(low - margin, high + margin)
}
