//! Forces against time.

use super::Run;
use crate::error::Result;
use crate::plot::{Axis, Curve, Figure, PALETTE, Sheet, Stroke};
use crate::scene::Friction;

/// Normal, tangential and hysteretic force; dotted lines where a phase ends.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let history = &run.history;
    let [unit, _] = run.units();
    let curve = |values: &[f64], colour: usize| against_time(run, "", values).coloured(PALETTE[colour]);
    // In space along x, and dashed along y.
    let both = |values: &[f64], across: usize, colour: usize| match &history.across {
        None => vec![curve(values, colour)],
        Some(others) => {
            let along = Curve { label: "along x".into(), ..curve(values, colour) };
            let across = Curve { label: "along y".into(), ..curve(&others[across], colour).stroked(Stroke::Dashed) };
            vec![along, across]
        }
    };
    let tangential = limits(run).into_iter().chain(both(&history.tangential, 0, 1)).collect();
    let figure = |title: &str, label: &str, curves: Vec<Curve>, first: bool| {
        with_phases(run, Figure::new(title, Axis::linear("time t, s"), Axis::linear(label), curves), first)
    };
    let hysteretic = match history.across {
        None => format!("∫ p ∂h/∂x dx, {unit}"),
        Some(_) => format!("∫ p ∇h dA, {unit}"),
    };
    let figures = vec![
        figure("Normal force", &format!("N, {unit}"), vec![curve(&history.normal, 0)], true),
        figure("Tangential force", &format!("Q, {unit}"), tangential, false),
        figure("Hysteretic force", &hysteretic, both(&history.hysteretic, 1, 2), false),
    ];
    Ok(Sheet::stacked(figures, 320))
}

/// A column of the history.
pub(super) fn against_time(run: &Run, label: &str, values: &[f64]) -> Curve {
    Curve::line(label, run.history.time.iter().copied().zip(values.iter().copied()).collect(), PALETTE[0])
}

/// The force at which all would slip, in the directions that the tangential force takes.
pub(super) fn limits(run: &Run) -> Vec<Curve> {
    let friction = run.scene.friction.as_ref().and_then(Friction::coefficient).unwrap_or(0.0);
    let history = &run.history;
    let limit = |sign: f64, label: &str| {
        let values: Vec<f64> = history.normal.iter().map(|normal| sign * friction * normal).collect();
        against_time(run, label, &values).coloured((130, 130, 130)).stroked(Stroke::Broad)
    };
    let across = history.across.iter().flat_map(|[tangential, _]| tangential);
    let all = history.tangential.iter().chain(across);
    let (low, high) = all.fold((0.0f64, 0.0f64), |(low, high), q| (low.min(*q), high.max(*q)));
    match friction {
        0.0 => Vec::new(),
        _ if low < -0.05 * high => vec![limit(1.0, "±f N"), limit(-1.0, "")],
        _ => vec![limit(1.0, "f N")],
    }
}

/// The figure with dotted lines over its whole height where a phase ends, but for the last; the first figure of a sheet
/// names them for all.
pub(super) fn with_phases(run: &Run, mut figure: Figure, named: bool) -> Figure {
    let values = || figure.curves.iter().flat_map(|curve| &curve.points).map(|p| p.1).filter(|v| v.is_finite());
    // An axis that has its ends keeps them.
    let (low, high) = figure.y.range.unwrap_or_else(|| {
        let (low, high) = values().fold((0.0f64, 0.0f64), |(low, high), v| (low.min(v), high.max(v)));
        let air = 0.06 * (high - low);
        (low - air, high + air)
    });
    figure.y = figure.y.over(low, high);
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
        let label = if named { format!("end of {names}") } else { String::new() };
        let line = Curve::line(label, vec![(end, low), (end, high)], PALETTE[3 + i % 3]);
        figure.curves.push(line.stroked(Stroke::Dotted));
    }
    figure
}
