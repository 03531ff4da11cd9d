//! What the paper does not show: the hysteretic force, the total friction and where the work goes.

use super::{Case, Sweep, against_velocity, bounds};
use crate::plot::{Axis, Curve, Figure, Sheet};

/// Steady values against velocity.
pub fn sheet(sweep: &Sweep) -> Sheet {
    let normal = |case: &Case| case.steady(|history| &history.normal);
    let tangential = |case: &Case| case.steady(|history| &history.tangential);
    let hysteretic = |case: &Case| case.steady(|history| &history.hysteretic);
    let figure = |title: &str, label: &str, curves: Vec<Curve>| Figure {
        title: title.into(),
        x: Axis::log("velocity v, m/s"),
        y: Axis::linear(label),
        curves,
        shaded: None,
    };
    let mut loads = against_velocity(sweep, |case| Some(normal(case)));
    loads.extend(bounds(sweep, normal));
    let mut figures = vec![
        figure("(a) normal force", "steady normal force N, N/m", loads),
        figure(
            "(b) hysteretic friction",
            "∫ p ∂h/∂x dx / N",
            against_velocity(sweep, |case| Some(hysteretic(case) / normal(case))),
        ),
        figure(
            "(c) total friction",
            "(Q + ∫ p ∂h/∂x dx) / N",
            against_velocity(sweep, |case| Some((tangential(case) + hysteretic(case)) / normal(case))),
        ),
    ];
    let peak = |case: &Case| case.history.tangential.iter().fold(0.0f64, |high, q| high.max(*q)) / tangential(case);
    figures.push(figure(
        "(d) peak while sliding starts",
        "largest Q / steady Q",
        against_velocity(sweep, |case| Some(peak(case))),
    ));
    let shares = against_velocity(sweep, viscoelastic_share);
    if !shares.is_empty() {
        let stored = against_velocity(sweep, |case| case.energy.as_ref()?.stored.last().copied());
        figures.push(figure("(e) energy: the rest goes into friction", "share of the arms in the work, %", shares));
        figures.push(figure("(f) energy in the layer", "steady stored energy, J/m", stored));
    }
    Sheet::of_curves(figures, 2, (760, 520))
}

/// Of the work of the indenter in the steady state, what the arms dissipate, %; none without energies.
fn viscoelastic_share(case: &Case) -> Option<f64> {
    let energy = case.energy.as_ref()?;
    let rows = case.steady_rows();
    let gain = |column: &[f64]| Some(column.get(rows.end - 1)? - column.get(rows.start)?);
    let share = 100.0 * gain(&energy.viscoelastic)? / gain(&energy.external)?;
    share.is_finite().then_some(share)
}
