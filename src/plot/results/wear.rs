//! What wears off: its depth along the face, what that makes of the profile and of the pressure, and its volume against time.

use super::history::{against_time, with_phases};
use super::{Run, spread};
use crate::error::Result;
use crate::output::reader::Field;
use crate::plot::numbers::alike;
use crate::plot::{Axis, Curve, Figure, Key, Ramp, Sheet};
use crate::scene::Wearing;

/// Curves in a panel.
const INSTANTS: usize = 5;

/// Depth, worn profile where there is one, pressure, volume.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let face = run.face()?;
    let frames = spread(&(0..face.time.len()).collect::<Vec<_>>(), INSTANTS);
    let times: Vec<f64> = frames.iter().map(|&frame| face.time[frame]).collect();
    let colours = Ramp::lines(frames.len());
    let panel = |title: &str, field: &Field, (place, label): (&str, &str)| {
        let curve = |(&frame, &colour): (&usize, &_)| {
            Curve::line("", face.x.iter().copied().zip(field.row(frame).iter().copied()).collect(), colour)
        };
        let curves = frames.iter().zip(&colours).map(curve).collect();
        let entries = alike(&times).into_iter().zip(colours.clone()).collect();
        let figure = Figure::new(title, Axis::linear(place), Axis::linear(label), curves);
        Figure { key: Some(Key { label: "time t, s".into(), entries }), ..figure }
    };
    const FACE: &str = "x, m";
    const OWN: &str = "x in the frame of the indenter, m";
    let of_indenter = run.scene.wear.is_some_and(|wear| wear.of == Wearing::Indenter);
    let place = if of_indenter { OWN } else { FACE };
    let mut figures = vec![panel("Worn depth", &face.field("worn_depth")?, (place, "worn depth, m"))];
    if of_indenter {
        figures.push(panel("Profile of the indenter", &face.field("worn_profile")?, (OWN, "elevation, m")));
    }
    figures.push(panel("Pressure", face.pressure(), (FACE, "p, Pa")));
    let volume = run.results.history("worn_volume")?;
    let curve = against_time(run, "", &volume);
    let volume = Figure::new("Worn volume", Axis::linear("time t, s"), Axis::linear("volume, m^{2}"), vec![curve]);
    figures.push(with_phases(run, volume, true));
    Ok(Sheet::in_pairs(figures, 380))
}
