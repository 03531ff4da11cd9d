//! What `mpjr check` says of the indenter's profile.

use std::fmt::Write;

use crate::composition::{Finest, Outline, Shape};
use crate::profile::Relief;
use crate::scene::{Indenter, Scene};

/// A few lines about the profile over the face, with a sketch.
pub fn describe(scene: &Scene, note: Option<&str>, shape: &Shape, outline: &Outline) -> String {
    const COLUMNS: usize = 64;
    const ROWS: usize = 4;
    let face = outline.face;
    let survey = &shape.survey;
    let [low, high] = survey.range();
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write!(text, "profile:       {}", name(&scene.indenter));
    if let Some(detail) = &shape.detail {
        let _ = write!(text, ": {detail}");
    }
    if let Some(note) = note {
        let _ = write!(text, "\n               the file is {note}");
    }
    if let (Indenter::Map { .. }, Some(across)) = (&scene.indenter, outline.across) {
        text += &over_the_face(shape, [[face.from, face.to], [across.from, across.to]]);
    }
    let _ = write!(
        text,
        "\n               over the face h = {low:.3e} to {high:.3e} m, rms height {:.3e} m, rms slope {:.3e}",
        survey.rms_height(),
        survey.rms_slope()
    );
    let _ = write!(text, "\n               the indenter (#) over the face (-): where h is lowest (^) it touches first");
    for line in survey.drawing(COLUMNS, ROWS) {
        let _ = write!(text, "\n               {}", line.trim_end());
    }
    let cell = face.cell();
    match shape.finest {
        Some(Finest::Wavelength(length)) => {
            let _ = write!(text, "\n               {:.1} cells to the shortest wave ({length} m)", length / cell);
        }
        Some(Finest::Spacing(length)) => {
            let _ = write!(text, "\n               {:.2} sampling points to a cell", cell / length);
        }
        None => {}
    }
    if low.abs() > 1e-3 * (high - low) {
        let _ = write!(text, "\n               its lowest point touches at an approach of {low:.3e} m");
    }
    text
}

/// A map seen from above, and the section that is drawn after it.
fn over_the_face(shape: &Shape, stretches: [[f64; 2]; 2]) -> String {
    const SIZE: [usize; 2] = [64, 16];
    // Where it is not known it was refused.
    let Ok(relief) = Relief::new(&*shape.surface, stretches, SIZE) else { return String::new() };
    let [x, y] = stretches;
    let [low, high] = relief.range();
    let mut text = format!(
        "\n               seen from above, x = {:?} to {:?} m to the right, y = {:?} to {:?} m upward; h from {low:.3e} m\n               \
         (#, where it touches first) to {high:.3e} m (blank):",
        x[0], x[1], y[0], y[1]
    );
    for line in relief.drawing() {
        text += &format!("\n               |{line}|");
    }
    text + "\n               along x, where it is lowest:"
}

fn name(indenter: &Indenter) -> String {
    match indenter {
        Indenter::Harmonic { .. } => "harmonic".to_owned(),
        Indenter::Parabola { .. } => "parabola".to_owned(),
        Indenter::Circle { .. } => "circle".to_owned(),
        Indenter::Wedge { .. } => "wedge".to_owned(),
        Indenter::Expression { formula } => format!("expression h = {formula}"),
        Indenter::Sampled { file, .. } => format!("sampled {file:?}"),
        Indenter::Rough { seed, .. } => format!("rough, seed {seed}"),
        Indenter::Paraboloid { .. } => "paraboloid".to_owned(),
        Indenter::Sphere { .. } => "sphere".to_owned(),
        Indenter::Cone { .. } => "cone".to_owned(),
        Indenter::Waves { .. } => "waves".to_owned(),
        Indenter::Map { file, .. } => format!("map {file:?}"),
    }
}
