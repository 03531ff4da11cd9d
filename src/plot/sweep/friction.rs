//! What the paper does not show: the hysteretic force, the total friction and where the work goes.

use super::figure7::capital;
use super::{Case, Sweep, broken};
use crate::plot::{Axis, Curve, Figure, Sheet};

/// Values of the end of the sliding against the varied key.
pub fn sheet(sweep: &Sweep) -> Sheet {
    let normal = |case: &Case| case.mean(|history| &history.normal);
    let tangential = |case: &Case| case.mean(|history| &history.tangential);
    let hysteretic = |case: &Case| case.mean(|history| &history.hysteretic);
    let over = |title: &str, y: Axis, curves: Vec<Curve>| Figure::new(title, sweep.abscissa.axis(), y, curves);
    let figure = |title: &str, label: &str, curves: Vec<Curve>| over(title, Axis::linear(label), curves);
    let mut loads = sweep.against(|case| Some(normal(case)));
    loads.extend(sweep.bounds(normal));
    let near = sweep.models.iter().flat_map(|model| model.cases.iter().chain(&model.long_term));
    let far = sweep.models.iter().flat_map(|model| &model.instantaneous);
    let name = sweep.named("N", |history| &history.normal);
    let load_axis = broken(format!("{name}, N/m"), near.map(normal), far.map(normal));
    let mut figures = vec![
        over(&capital(&name), load_axis, loads),
        figure("Hysteretic friction", "∫ p ∂h/∂x dx / N", sweep.against(|case| Some(hysteretic(case) / normal(case)))),
        figure(
            "Total friction",
            "(Q + ∫ p ∂h/∂x dx) / N",
            sweep.against(|case| Some((tangential(case) + hysteretic(case)) / normal(case))),
        ),
    ];
    let peak = |case: &Case| case.history.tangential.iter().fold(0.0f64, |high, q| high.max(*q)) / tangential(case);
    let ratio = sweep.named("Q", |history| &history.tangential);
    let peaks = sweep.against(|case| Some(peak(case)));
    figures.push(figure("Peak while sliding starts", &format!("largest Q / {ratio}"), peaks));
    let shares = sweep.against(viscoelastic_share);
    if !shares.is_empty() {
        let stored = sweep.against(|case| case.energy.as_ref()?.stored.last().copied());
        figures.push(figure("Work that the arms dissipate", "share of the work, %", shares));
        figures.push(figure("Energy stored in the body", "stored energy at the end, J/m", stored));
    }
    Sheet::in_pairs(figures, 380).noting(sweep.note())
}

/// Of the work of the indenter over the end, what the arms dissipate, %; none without energies.
fn viscoelastic_share(case: &Case) -> Option<f64> {
    let energy = case.energy.as_ref()?;
    let rows = case.end();
    let gain = |column: &[f64]| Some(column.get(rows.end - 1)? - column.get(rows.start)?);
    let share = 100.0 * gain(&energy.viscoelastic)? / gain(&energy.external)?;
    share.is_finite().then_some(share)
}
