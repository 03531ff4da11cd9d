//! Forces against time.

use super::Run;
use crate::error::Result;
use crate::plot::{Axis, Curve, Figure, PALETTE, REFERENCE, Sheet, Stroke};
use crate::scene::Friction;

/// Normal, tangential and hysteretic force; dotted lines where a phase ends.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let history = &run.history;
    let friction = run.scene.friction.as_ref().map_or(0.0, Friction::coefficient);
    let envelope: Vec<f64> = history.normal.iter().map(|normal| friction * normal).collect();
    let mut tangential = vec![force(run, "Q", &history.tangential, 1)];
    if friction > 0.0 {
        let label = format!("f N with f = {friction}");
        let curve = Curve { colour: REFERENCE, stroke: Stroke::Dashed, ..force(run, &label, &envelope, 1) };
        tangential.push(curve);
    }
    let normal = vec![force(run, "N", &history.normal, 0)];
    let hysteretic = vec![force(run, "hysteretic force", &history.hysteretic, 2)];
    let figure = |title: String, label: &str, curves: Vec<Curve>| {
        let mut figure = Figure {
            title,
            x: Axis::linear("time t, s"),
            y: Axis::linear(format!("{label}, N/m")),
            curves,
            shaded: None,
        };
        phase_ends(run, &mut figure);
        figure
    };
    let figures = vec![
        figure(format!("(a) {}", run.scene.title), "normal force N", normal),
        figure("(b) tangential force".into(), "tangential force Q", tangential),
        figure("(c) hysteretic force".into(), "∫ p ∂h/∂x dx", hysteretic),
    ];
    Ok(Sheet::of_curves(figures, 1, (900, 380)))
}

fn force(run: &Run, label: &str, values: &[f64], colour: usize) -> Curve {
    Curve {
        label: label.into(),
        points: run.history.time.iter().copied().zip(values.iter().copied()).collect(),
        colour: PALETTE[colour],
        stroke: Stroke::Solid,
    }
}

/// Dotted lines over the whole height where a phase ends, but for the last.
pub(super) fn phase_ends(run: &Run, figure: &mut Figure) {
    let values = || figure.curves.iter().flat_map(|curve| &curve.points).map(|p| p.1).filter(|v| v.is_finite());
    let (low, high) = values().fold((0.0f64, 0.0f64), |(low, high), v| (low.min(v), high.max(v)));
    let air = 0.06 * (high - low);
    figure.y = figure.y.clone().over(low - air, high + air);
    let phases = &run.scene.phases;
    let last = run.scene.duration();
    let mut ends: Vec<(f64, String)> = Vec::new();
    let mut end = 0.0;
    for phase in phases.iter().take(phases.len().saturating_sub(1)) {
        end += phase.duration;
        // Lines that would lie on each other share an entry.
        match ends.last_mut() {
            Some((before, names)) if end - *before < 0.01 * last => *names += &format!(" and {}", phase.name),
            _ => ends.push((end, phase.name.clone())),
        }
    }
    for (i, (end, names)) in ends.into_iter().enumerate() {
        figure.curves.push(Curve {
            label: format!("end of {names}"),
            points: vec![(end, low - air), (end, high + air)],
            colour: PALETTE[3 + i % 3],
            stroke: Stroke::Dotted,
        });
    }
}
