//! What `mpjr check` says of the indenter's profile.

use std::fmt::Write;

use crate::composition::{Finest, PressedEnd, Shape, Stretch, numbers, seam_doubt};
use crate::profile::profilometer::Measured;
use crate::scene::{Indenter, Scene};

/// A few lines about the profile over the face, with a sketch, and warnings of what a run would miss.
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
    let seam = measured.and_then(|measured| seam_doubt(scene, &numbers(measured)));
    let seam = seam.map(|(key, reason)| format!("{key}: {reason}"));
    for warning in warnings(scene, shape, face).into_iter().chain(seam) {
        let _ = write!(text, "\nwarning:       {warning}");
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
    }
}

/// What the mesh does not see of the profile, and contact that is not where one expects it.
fn warnings(scene: &Scene, shape: &Shape, face: Stretch) -> Vec<String> {
    const FEWEST: f64 = 4.0;
    let cell = face.cell();
    let mut list = Vec::new();
    match shape.finest {
        Some(Finest::Wavelength(length)) if length / cell < FEWEST * (1.0 - 1e-9) => list.push(format!(
            "fewer than {FEWEST} cells to the shortest wave: the mesh sees another profile; give at least {:.0} cells",
            (FEWEST * face.width() / length).ceil()
        )),
        Some(Finest::Spacing(length)) if cell > length * (1.0 + 1e-6) => list.push(format!(
            "the file is finer than the mesh: nodes are {cell:.3e} m apart, sampling points {length:.3e} m"
        )),
        _ => {}
    }
    let [low, high] = shape.survey.range();
    if low.abs() > 1e-3 * (high - low) {
        list.push(match low < 0.0 {
            true => format!("the profile reaches below 0: contact begins already at an approach of {low:.3e} m"),
            false => format!("the profile stays above 0: contact begins only at an approach of {low:.3e} m"),
        });
    }
    let deepest = scene.deepest();
    if deepest <= low {
        list.push(format!("the indenter never touches the face where it starts: its approach ends at {deepest:.3e} m"));
    }
    if let Some(PressedEnd { x, time }) = shape.pressed {
        list.push(format!(
            "from t = {time:.4e} s the indenter presses on the clamped end of the face at x = {x:?} m, which cannot give \
             way: N grows with the penalty there"
        ));
    }
    list
}
