//! The energy balance against time.

use super::Run;
use super::history::with_phases;
use crate::error::Result;
use crate::plot::{Axis, Curve, Figure, PALETTE, REFERENCE, Sheet, Stroke};

/// Where the work of the indenter goes: all of it, what is left of it by friction, and what does not balance.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let time = &run.history.time;
    let column = |name: &str| run.energy(name).unwrap_or_else(|| vec![0.0; time.len()]);
    let curve = |label: &str, colour: usize, values: &[f64]| {
        Curve::line(label, time.iter().copied().zip(values.iter().copied()).collect(), PALETTE[colour])
    };
    let supplied =
        |label: &str, values: &[f64]| Curve { colour: REFERENCE, ..curve(label, 0, values).stroked(Stroke::Dashed) };
    let [_, unit] = run.units();
    let energy = format!("energy, {unit}");
    let mut figures = Vec::new();
    let mut add = |title: &str, label: &str, curves: Vec<Curve>| {
        let figure = Figure::new(title, Axis::linear("time t, s"), Axis::linear(label), curves);
        figures.push(with_phases(run, figure, figures.is_empty()));
    };
    let (work, friction) = (column("external_work"), column("friction_dissipation"));
    let parts = [
        ("stored in the layer", 0, column("stored")),
        ("dissipated in the arms", 2, column("viscoelastic_dissipation")),
        ("stored in the penalty", 4, column("penalty")),
        ("worn off", 3, column("wear")),
    ];
    // An elastic layer has no arms.
    let parts = parts.iter().filter(|(.., values)| values.iter().any(|energy| *energy != 0.0));
    let mut parts: Vec<Curve> = parts.map(|(label, colour, values)| curve(label, *colour, values)).collect();
    if run.scene.friction.is_some() {
        let whole = vec![curve("dissipated by friction", 1, &friction), supplied("work of the indenter", &work)];
        add("Work and friction", &energy, whole);
        let rest: Vec<f64> = work.iter().zip(&friction).map(|(work, friction)| work - friction).collect();
        parts.push(supplied("work less friction", &rest));
        add("Apart from friction", &energy, parts);
    } else {
        parts.push(supplied("work of the indenter", &work));
        add("Work and where it goes", &energy, parts);
    }
    add("What does not balance", &format!("imbalance, {unit}"), vec![curve("", 5, &column("imbalance"))]);
    Ok(Sheet::stacked(figures, 320))
}
