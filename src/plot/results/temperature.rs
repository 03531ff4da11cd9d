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
    let mut add = |title: &str, label: &str, curves: Vec<Curve>| {
        let figure = Figure::new(title, Axis::linear("time t, s"), Axis::linear(label), curves);
        figures.push(with_phases(run, figure, figures.is_empty()));
    };
    let temperatures = [("highest", 1, "max_temperature"), ("mean, by heat capacity", 0, "mean_temperature")];
    let temperatures = temperatures.map(|(label, colour, column)| Ok((label, colour, run.results.history(column)?)));
    let temperatures = temperatures.into_iter().collect::<Result<Vec<_>>>()?;
    let curves = temperatures.iter().map(|(label, colour, values)| curve(label, *colour, values)).collect();
    add("Temperature", "T, K", curves);
    if let Some(entered) = run.energy("heat") {
        let parts =
            [("stored", 0, "heat_stored"), ("to the air", 2, "heat_convected"), ("to the base", 4, "heat_conducted")];
        let parts = parts.into_iter().filter_map(|(label, colour, name)| Some((label, colour, run.energy(name)?)));
        let mut curves: Vec<Curve> = parts.map(|(label, colour, values)| curve(label, colour, &values)).collect();
        curves.push(Curve { colour: REFERENCE, ..curve("entered", 0, &entered).stroked(Stroke::Dashed) });
        add("Heat and where it goes", "heat, J/m", curves);
    }
    Ok(Sheet::stacked(figures, 320))
}
