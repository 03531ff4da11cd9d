//! The energy balance against time.

use super::Run;
use super::history::phase_ends;
use crate::error::Result;
use crate::plot::{Axis, Curve, Figure, PALETTE, Sheet, Stroke};

/// The columns that are shown, and their labels.
const TERMS: [(&str, &str); 5] = [
    ("external_work", "work of the indenter"),
    ("friction_dissipation", "dissipated by friction"),
    ("viscoelastic_dissipation", "dissipated in the arms"),
    ("stored", "stored in the layer"),
    ("penalty", "stored in the penalty"),
];

/// Where the work of the indenter goes: all of it, what is left of it by friction, and what does not balance.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let time = &run.history.time;
    let column = |name: &str| run.energy(name).unwrap_or_else(|| vec![0.0; time.len()]);
    let [work, friction, viscoelastic, stored, penalty] = TERMS.map(|(name, _)| column(name));
    let imbalance = column("imbalance");
    let curve = |index: usize, label: &str, values: &[f64]| Curve {
        label: label.into(),
        points: time.iter().copied().zip(values.iter().copied()).collect(),
        colour: PALETTE[index],
        stroke: Stroke::Solid,
    };
    let term = |index: usize, values: &[f64]| curve(index, TERMS[index].1, values);
    let figure = |title: String, label: &str, curves: Vec<Curve>| {
        let mut figure = Figure { title, x: Axis::linear("time t, s"), y: Axis::linear(label), curves, shaded: None };
        phase_ends(run, &mut figure);
        figure
    };
    let rest: Vec<f64> = work.iter().zip(&friction).map(|(work, friction)| work - friction).collect();
    let kept = [term(2, &viscoelastic), term(3, &stored), term(4, &penalty)];
    let mut figures = Vec::new();
    if run.scene.friction.is_some() {
        let whole = vec![term(0, &work), term(1, &friction)];
        figures.push(figure(run.scene.title.clone(), "energy, J/m", whole));
        let left = [curve(0, "work less friction", &rest)].into_iter().chain(kept).collect();
        figures.push(figure("without friction".into(), "energy, J/m", left));
    } else {
        let whole = [term(0, &work)].into_iter().chain(kept).collect();
        figures.push(figure(run.scene.title.clone(), "energy, J/m", whole));
    }
    figures.push(figure("what does not balance".into(), "imbalance, J/m", vec![curve(5, "imbalance", &imbalance)]));
    for (figure, letter) in figures.iter_mut().zip('a'..) {
        figure.title = format!("({letter}) {}", figure.title);
    }
    Ok(Sheet::of_curves(figures, 1, (900, 380)))
}
