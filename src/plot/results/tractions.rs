//! Tractions along the face: what Figure 6 of the paper shows.

use super::face::Face;
use super::{Run, Unit, spread};
use crate::error::Result;
use crate::output::reader::Field;
use crate::plot::numbers::alike;
use crate::plot::{Axis, Colour, Curve, Figure, Key, Ramp, Sheet, Stroke};
use crate::scene::Friction;

/// Curves in a panel.
const INSTANTS: usize = 5;

/// Of entries that stand for curves of all colours.
const GREY: Colour = (90, 90, 90);

/// A stretch of the history.
struct Stage {
    title: &'static str,
    frames: Vec<usize>,
    /// What tells the frames apart, and its value at each.
    key: String,
    values: Vec<f64>,
}

/// A panel for each stage: the shear traction between the bounds that the pressure sets it, or the pressure alone.
pub fn sheet(run: &Run) -> Result<Sheet> {
    if run.is_in_space() {
        return super::space::sections::tractions(run);
    }
    let face = run.face()?;
    let shear = face.field("shear")?;
    let unit = Unit::of(run);
    let figures = stages(run, &face).iter().map(|stage| panel(run, &face, &shear, &unit, stage)).collect();
    Ok(Sheet::in_pairs(figures, 420).noting(unit.note(run)))
}

/// The stages of which the file holds profiles.
fn stages(run: &Run, face: &Face) -> Vec<Stage> {
    let history = &run.history;
    let (t0, end) = (run.approach_time(), history.time[history.time.len() - 1]);
    let stage = |title, (from, to): (f64, f64), key: &str, value: &dyn Fn(f64) -> f64| {
        let frames = spread(&face.between(from, to), INSTANTS);
        let values = frames.iter().map(|&frame| value(face.time[frame])).collect();
        Stage { title, frames, key: key.into(), values }
    };
    let mut stages = Vec::new();
    if t0 > 0.0 {
        stages.push(stage("Approach", (f64::MIN_POSITIVE, t0), "t/t_{0}", &|time| time / t0));
    }
    if end > t0 {
        let all_slip = history.sliding_start();
        let slips = all_slip.map_or(end, |row| history.time[row]);
        stages.push(stage("From stick to slip", (t0, slips), "slid distance s, mm", &|time| 1e3 * run.slid(time)));
        // A while later, so that no place is near to sticking, and over half a period.
        let start = all_slip.map_or(end, |row| time_after(run, 1.5 * history.sliding[row].abs()));
        let (length, symbol) = run.period().map_or((1.0, "s, m"), |period| (period, "s/λ"));
        let half = |from: f64| run.period().map_or(end, |period| time_after(run, from + 0.5 * period));
        let slid = |time: f64| run.slid(time) / length;
        stages.push(stage("Gross sliding", (start, half(0.0)), symbol, &slid));
        if let Some(overlap) = overlap(run) {
            let times = (time_after(run, overlap), half(overlap));
            stages.push(stage("Contact over material loaded before", times, symbol, &slid));
        }
    }
    // One profile alone is the end of the stage before.
    stages.retain(|stage| stage.frames.len() > 1);
    if stages.is_empty() {
        stages.push(stage("All profiles", (0.0, end), "time t, s", &|time| time));
    }
    stages
}

/// When the indenter has slid by `distance`; the end if it never does.
fn time_after(run: &Run, distance: f64) -> f64 {
    let history = &run.history;
    let row = history.sliding.iter().position(|s| s.abs() >= distance);
    history.time[row.unwrap_or(history.time.len() - 1)]
}

/// The distance after which the front of the contact reaches what the neighbouring contact of a periodic face had
/// loaded; none if it never does.
fn overlap(run: &Run) -> Option<f64> {
    let period = run.period()?;
    let history = &run.history;
    let distance = period * (1.0 - history.contact[history.approach_end()]);
    history.sliding.iter().any(|s| s.abs() >= distance).then_some(distance)
}

fn panel(run: &Run, face: &Face, shear: &Field, unit: &Unit, stage: &Stage) -> Figure {
    let window = face.window(&stage.frames);
    let coefficient = run.scene.friction.as_ref().and_then(Friction::coefficient).filter(|f| *f > 0.0);
    let colours = Ramp::lines(stage.frames.len());
    let profile = |field: &Field, frame: usize, factor: f64| {
        let points = face.profile(field, frame, &window).into_iter();
        let touched = touched(&face.profile(face.pressure(), frame, &window));
        let scaled = |((x, value), touched)| (x, if touched { factor * value / unit.value } else { f64::NAN });
        points.zip(touched).map(scaled).collect::<Vec<_>>()
    };
    let all = |field: &Field, factor: f64, stroke: Stroke| {
        let curve = |(&frame, &colour): (&usize, &Colour)| {
            Curve::line("", profile(field, frame, factor), colour).stroked(stroke)
        };
        stage.frames.iter().zip(&colours).map(curve).collect::<Vec<_>>()
    };
    let entry = |label: String, stroke| Curve::line(label, Vec::new(), GREY).stroked(stroke);
    let (label, curves) = match coefficient {
        None => (unit.over("p"), all(face.pressure(), 1.0, Stroke::Solid)),
        Some(f) => {
            let (p, q) = (unit.over("p"), unit.over_friction("q"));
            let reversed = stage.frames.iter().any(|&frame| {
                let (low, high) = shear.row(frame).iter().fold((0.0f64, 0.0f64), |(a, b), q| (a.min(*q), b.max(*q)));
                low < -0.02 * high
            });
            let mut curves = all(face.pressure(), 1.0, Stroke::Broad);
            if reversed {
                curves.extend(all(face.pressure(), -1.0, Stroke::Broad));
            }
            curves.extend(all(shear, 1.0 / f, Stroke::Solid));
            curves.push(entry(q.clone(), Stroke::Solid));
            curves.push(entry(if reversed { format!("±{p}") } else { p.clone() }, Stroke::Broad));
            (both(&p, &q), curves)
        }
    };
    let entries = alike(&stage.values).into_iter().zip(colours).collect();
    Figure {
        key: Some(Key { label: stage.key.clone(), entries }),
        ..Figure::new(stage.title, Axis::linear("x, m").over(window.ends.0, window.ends.1), Axis::linear(label), curves)
    }
}

/// Whether a node is in contact or beside one that is: elsewhere there is nothing to draw.
fn touched(pressure: &[(f64, f64)]) -> Vec<bool> {
    let near = |i: usize| pressure[i.saturating_sub(1)..(i + 2).min(pressure.len())].iter().any(|(_, p)| *p > 0.0);
    (0..pressure.len()).map(near).collect()
}

/// The label of an axis for two quantities in the same unit.
fn both(p: &str, q: &str) -> String {
    match p.rsplit_once(", ") {
        Some((p, _)) => format!("{p} and {q}"),
        None => format!("{p} and {q}"),
    }
}
