//! The indenter and the face under it.

use super::Run;
use super::face::Face;
use crate::error::Result;
use crate::output::reader::Field;
use crate::plot::numbers::short;
use crate::plot::{Axis, Curve, Figure, PALETTE, REFERENCE, Sheet, Stroke};

/// At the end of the approach and at the end: the profile where it stands, and the face as it is deformed, around the
/// contact.
pub fn sheet(run: &Run) -> Result<Sheet> {
    if run.is_in_space() {
        return super::space::sections::shapes(run);
    }
    let face = run.face()?;
    let fields = Fields { gap: face.field("gap")?, height: face.field("displacement_z")? };
    let first = face.at(run.approach_time());
    let last = face.time.len() - 1;
    let seconds = |frame: usize| format!("t = {} s", short(face.time[frame], 4));
    let mut figures = vec![figure(&face, &fields, first, format!("End of the approach, {}", seconds(first)))];
    if last != first {
        let slid = short(run.slid(face.time[last]), 4);
        figures.push(figure(&face, &fields, last, format!("End, {}, after sliding by {slid} m", seconds(last))));
    }
    Ok(Sheet::stacked(figures, 400))
}

struct Fields {
    gap: Field,
    height: Field,
}

fn figure(face: &Face, fields: &Fields, frame: usize, title: String) -> Figure {
    let window = face.window(&[frame]);
    let shown = |(x, _): &(f64, f64)| (window.ends.0..=window.ends.1).contains(x);
    let cut = |field: &Field| face.profile(field, frame, &window).into_iter().filter(shown).collect::<Vec<_>>();
    let (surface, gap) = (cut(&fields.height), cut(&fields.gap));
    // The gap is what lies between the face and the indenter.
    let indenter = surface.iter().zip(&gap).map(|(surface, gap)| (surface.0, surface.1 + gap.1)).collect();
    let curves = vec![
        Curve::line("indenter", indenter, REFERENCE),
        Curve::line("face of the body", surface, PALETTE[1]).stroked(Stroke::Dashed),
    ];
    Figure::new(title, Axis::linear("x, m").over(window.ends.0, window.ends.1), Axis::linear("z, m"), curves)
}
