//! The indenter and the face under it.

use super::{Interface, Run, short};
use crate::error::Result;
use crate::output::reader::Field;
use crate::plot::{Axis, Curve, Figure, PALETTE, REFERENCE, Sheet, Stroke};

/// At the end of the approach and at the end: the profile where it stands, and the face as it is deformed.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let interface = run.interface()?;
    let fields = Fields { gap: run.results.interface("gap")?, face: run.results.interface("displacement_z")? };
    let first = interface.at(run.approach_time());
    let last = interface.time.len() - 1;
    let mut figures = vec![figure(
        &interface,
        &fields,
        first,
        format!("(a) end of the approach, t = {}", seconds(&interface, first)),
    )];
    if last != first {
        let end = interface.time[last];
        let row = super::nearest(&run.history.time, end);
        let sliding = run.history.sliding[row];
        let title = format!("(b) t = {}, after sliding by {} m", seconds(&interface, last), short(sliding, 4));
        figures.push(figure(&interface, &fields, last, title));
    }
    Ok(Sheet::of_curves(figures, 1, (900, 480)))
}

struct Fields {
    gap: Field,
    face: Field,
}

fn seconds(interface: &Interface, frame: usize) -> String {
    format!("{} s", short(interface.time[frame], 4))
}

fn figure(interface: &Interface, fields: &Fields, frame: usize, title: String) -> Figure {
    let face = interface.profile(&fields.face, frame);
    let gap = interface.profile(&fields.gap, frame);
    // The gap is what lies between the face and the indenter.
    let indenter = face.iter().zip(&gap).map(|(face, gap)| (face.0, face.1 + gap.1)).collect();
    Figure {
        title,
        x: Axis::linear(interface.label()),
        y: Axis::linear("z, m"),
        curves: vec![
            Curve { label: "indenter".into(), points: indenter, colour: REFERENCE, stroke: Stroke::Solid },
            Curve { label: "face of the layer".into(), points: face, colour: PALETTE[1], stroke: Stroke::Dashed },
        ],
        shaded: None,
    }
}
