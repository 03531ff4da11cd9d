//! What `mpjr check` says of the indenter's profile.

use std::fmt::Write;

use crate::composition::{Finest, Shape, Stretch};
use crate::profile::profilometer::Measured;
use crate::scene::{Indenter, Scene};

/// A few lines about the profile over the face, with a sketch.
pub fn describe(scene: &Scene, measured: Option<&Measured>, shape: &Shape, face: Stretch) -> String {
    const COLUMNS: usize = 64;
    const ROWS: usize = 4;
    let survey = &shape.survey;
    let [low, high] = survey.range();
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write!(text, "profile:       {}", name(&scene.indenter));
    if let Some(detail) = &shape.detail {
        let _ = write!(text, ": {detail}");
    }
    if let Some(measured) = measured {
        let _ = write!(text, "\n               the file is {}", measured.note());
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
    }
}
