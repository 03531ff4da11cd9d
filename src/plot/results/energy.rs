//! The energy balance against time.

use super::Run;
use super::history::phase_ends;
use crate::error::Result;
use crate::plot::{Axis, Curve, Figure, PALETTE, REFERENCE, Sheet, Stroke};

/// Where the work of the indenter goes: all of it, what is left of it by friction, and what does not balance.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let time = &run.history.time;
    let column = |name: &str| run.energy(name).unwrap_or_else(|| vec![0.0; time.len()]);
    let curve = |label: &str, colour: usize, values: &[f64]| Curve {
        label: label.into(),
        points: time.iter().copied().zip(values.iter().copied()).collect(),
        colour: PALETTE[colour],
        stroke: Stroke::Solid,
    };
    let supplied =
        |label: &str, values: &[f64]| Curve { colour: REFERENCE, stroke: Stroke::Dashed, ..curve(label, 0, values) };
    let figure = |title: String, label: &str, curves: Vec<Curve>| {
        let mut figure = Figure { title, x: Axis::linear("time t, s"), y: Axis::linear(label), curves, shaded: None };
        phase_ends(run, &mut figure);
        figure
    };
    let (work, friction) = (column("external_work"), column("friction_dissipation"));
    let parts = [
        ("stored in the layer", 0, column("stored")),
        ("dissipated in the arms", 2, column("viscoelastic_dissipation")),
        ("stored in the penalty", 4, column("penalty")),
    ];
    // An elastic layer has no arms.
    let parts = parts.iter().filter(|(.., values)| values.iter().any(|energy| *energy != 0.0));
    let mut parts: Vec<Curve> = parts.map(|(label, colour, values)| curve(label, *colour, values)).collect();
    let mut figures = Vec::new();
    if run.scene.friction.is_some() {
        let whole = vec![curve("dissipated by friction", 1, &friction), supplied("work of the indenter", &work)];
        figures.push(figure(format!("(a) {}", run.scene.title), "energy, J/m", whole));
        let rest: Vec<f64> = work.iter().zip(&friction).map(|(work, friction)| work - friction).collect();
        parts.push(supplied("work less friction", &rest));
        figures.push(figure("(b) apart from friction".into(), "energy, J/m", parts));
    } else {
        parts.push(supplied("work of the indenter", &work));
        figures.push(figure(format!("(a) {}", run.scene.title), "energy, J/m", parts));
    }
    let letter = if figures.len() == 1 { 'b' } else { 'c' };
    let imbalance = vec![curve("imbalance", 5, &column("imbalance"))];
    figures.push(figure(format!("({letter}) what does not balance"), "imbalance, J/m", imbalance));
    Ok(Sheet::of_curves(figures, 1, (900, 380)))
}
