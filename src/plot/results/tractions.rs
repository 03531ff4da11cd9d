//! Tractions along the face: what Figure 6 of the paper shows.

use super::{Interface, Run, nearest, short, spread};
use crate::error::Result;
use crate::output::reader::Field;
use crate::plot::{Axis, Colour, Curve, Figure, Ramp, Sheet, Stroke};
use crate::scene::Friction;

/// Curves in a panel.
const INSTANTS: usize = 5;

/// The bounds of the shear traction.
const BOUND: Colour = (70, 70, 70);

/// A stretch of the history.
struct Stage {
    name: &'static str,
    frames: Vec<usize>,
}

/// Row by row the stages: the pressure on the left, the shear traction with its bounds on the right.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let interface = run.interface()?;
    let (pressure, shear) = (run.results.interface("pressure")?, run.results.interface("shear")?);
    let stages = stages(run, &interface);
    let frictional = run.scene.friction.is_some();
    let mut figures = Vec::new();
    for (stage, letter) in stages.iter().zip('a'..) {
        let title = format!("({letter}) {}", stage.name);
        figures.push(normal(run, &interface, &pressure, stage, &title));
        if frictional {
            figures.push(tangential(run, &interface, (&pressure, &shear), stage, &title));
        }
    }
    Ok(Sheet::of_curves(figures, if frictional { 2 } else { 1 }, (760, 460)))
}

/// The stages of which the file holds profiles.
fn stages(run: &Run, interface: &Interface) -> Vec<Stage> {
    let history = &run.history;
    let t0 = run.approach_time();
    let end = history.time[history.time.len() - 1];
    let mut stages =
        vec![Stage { name: "approach", frames: spread(&interface.between(f64::MIN_POSITIVE, t0), INSTANTS) }];
    if end > t0 {
        let slips = history.sliding_start().map_or(end, |row| history.time[row]);
        stages.push(Stage { name: "from stick to slip", frames: spread(&interface.between(t0, slips), INSTANTS) });
        let overlap = overlap_time(run).unwrap_or(end);
        // A while later, so that no place is near to sticking.
        let slips = history.sliding_start().map_or(end, |row| time_after(run, 1.5 * history.sliding[row].abs()));
        stages.push(Stage { name: "gross sliding", frames: spread(&interface.between(slips, overlap), INSTANTS) });
        if overlap < end {
            let name = "contact over material loaded before";
            stages.push(Stage { name, frames: spread(&interface.between(overlap, end), INSTANTS) });
        }
    }
    // One profile alone is the end of the stage before.
    stages.retain(|stage| stage.frames.len() > 1);
    if stages.is_empty() {
        let all: Vec<usize> = (0..interface.time.len()).collect();
        stages.push(Stage { name: "all profiles", frames: spread(&all, INSTANTS) });
    }
    stages
}

/// When the indenter has slid by `distance`; the end if it never does.
fn time_after(run: &Run, distance: f64) -> f64 {
    let history = &run.history;
    let row = history.sliding.iter().position(|s| s.abs() >= distance);
    history.time[row.unwrap_or(history.time.len() - 1)]
}

/// When the front of the contact reaches what the neighbouring contact of a periodic face had loaded.
fn overlap_time(run: &Run) -> Option<f64> {
    let period = run.period()?;
    let history = &run.history;
    let first = history.approach_end();
    let width = history.contact[first] * period;
    let reached = |row: &usize| history.sliding[*row].abs() >= period - width;
    (first..history.time.len()).find(reached).map(|row| history.time[row])
}

fn label(run: &Run, time: f64) -> String {
    let t0 = run.approach_time();
    if t0 <= 0.0 {
        return format!("t = {} s", short(time, 4));
    }
    let ratio = time / t0;
    // Just after t0 the ratio says little.
    if ratio > 1.0 && ratio < 1.02 {
        let row = nearest(&run.history.time, time);
        return format!("s = {:.3} mm", 1e3 * run.history.sliding[row]);
    }
    format!("t/t₀ = {ratio:.2}")
}

fn curve(label: String, points: Vec<(f64, f64)>, colour: Colour, stroke: Stroke) -> Curve {
    Curve { label, points, colour, stroke }
}

fn normal(run: &Run, interface: &Interface, pressure: &Field, stage: &Stage, title: &str) -> Figure {
    let colours = Ramp::lines(stage.frames.len());
    let curves = stage.frames.iter().zip(colours).map(|(&frame, colour)| {
        curve(label(run, interface.time[frame]), interface.profile(pressure, frame), colour, Stroke::Solid)
    });
    Figure {
        title: format!("{title}: pressure"),
        x: Axis::linear(interface.label()),
        y: Axis::linear("pressure p, Pa"),
        curves: curves.collect(),
        shaded: None,
    }
}

fn tangential(
    run: &Run,
    interface: &Interface,
    (pressure, shear): (&Field, &Field),
    stage: &Stage,
    title: &str,
) -> Figure {
    let coefficient = run.scene.friction.as_ref().map_or(0.0, Friction::coefficient);
    let colours = Ramp::lines(stage.frames.len());
    let mut curves = Vec::new();
    let bound = |frame: usize, sign: f64, colour, label: &str| {
        let points = interface.profile(pressure, frame).into_iter().map(|(x, p)| (x, sign * coefficient * p));
        curve(label.into(), points.collect(), colour, Stroke::Dotted)
    };
    let reversed = stage.frames.iter().any(|&frame| {
        let row = shear.row(frame);
        row.iter().fold(0.0f64, |low, q| low.min(*q)) < -0.02 * row.iter().fold(0.0f64, |high, q| high.max(q.abs()))
    });
    for (&frame, &colour) in stage.frames.iter().zip(&colours) {
        let label = label(run, interface.time[frame]);
        curves.push(curve(label, interface.profile(shear, frame), colour, Stroke::Solid));
    }
    // Where all slips, the bounds cover the curves: in grey, so that both are seen.
    for (&frame, &colour) in stage.frames.iter().zip(&colours) {
        curves.push(bound(frame, 1.0, if reversed { colour } else { BOUND }, ""));
        if reversed {
            curves.push(bound(frame, -1.0, colour, ""));
        }
    }
    // One entry for all bounds, in the colour of none.
    let name = if reversed { "±f p" } else { "f p" };
    curves.push(curve(name.into(), Vec::new(), BOUND, Stroke::Dotted));
    Figure {
        title: format!("{title}: shear traction"),
        x: Axis::linear(interface.label()),
        y: Axis::linear("shear traction q, Pa"),
        curves,
        shaded: None,
    }
}
