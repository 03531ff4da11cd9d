//! Where the indenter presses on what cannot give way.

use std::path::Path;

use nalgebra::Vector2;

use super::{Outline, Stretch, phases};
use crate::error::{Error, Result};
use crate::loading::{Phase, Placement};
use crate::profile::Surface;
use crate::scene::Scene;

/// A clamped end of the face, or a node of a clamped edge in space, under the indenter.
#[derive(Debug, Clone, PartialEq)]
pub struct PressedEnd {
    /// "x = 0.04 m", in space "x = 0.04, y = 0.01 m".
    pub place: String,
    /// The end of the first step in which it is, s.
    pub time: f64,
}

/// Where and when the indenter first presses on a clamped end of the face, as far as planned steps can tell.
///
/// # Errors
/// [`Error::Scene`] where no penetration is to be left there.
pub(super) fn pressed_end(
    surface: &dyn Surface,
    (scene, file): (&Scene, &Path),
    outline: &Outline,
) -> Result<Option<PressedEnd>> {
    let pressed = first(surface, scene, outline);
    match (&pressed, &scene.contact.penalty) {
        (Some(PressedEnd { place, time }), None) => {
            let reason = format!(
                "is contact without penetration, but from t = {time:.4e} s the indenter presses on the clamped end of the \
                 face at {place}, which cannot give way; keep it off the ends, or give a penalty"
            );
            Err(Error::scene(file, "contact", reason))
        }
        _ => Ok(pressed),
    }
}

fn first(surface: &dyn Surface, scene: &Scene, outline: &Outline) -> Option<PressedEnd> {
    /// Of an adaptive phase, whose steps are not planned.
    const MOMENTS: u32 = 64;
    let nodes = clamped(outline);
    if nodes.is_empty() {
        return None;
    }
    let name = |place: Vector2<f64>| match outline.across {
        None => format!("x = {:?} m", place.x),
        Some(_) => format!("x = {:?}, y = {:?} m", place.x, place.y),
    };
    let pressed = |phase: &Phase, time: f64| {
        let Placement { approach, sliding, .. } = phase.placement(time, 0.0);
        let presses = |&&(place, recess): &&(Vector2<f64>, f64)| {
            surface.at(place - sliding).is_ok_and(|h| h.height + recess < approach)
        };
        nodes.iter().find(presses).map(|&(place, _)| PressedEnd { place: name(place), time })
    };
    // Adaptive steps are not looked at, whatever their tolerance is a share of.
    phases(scene, 1.0).iter().find_map(|phase| match phase.adaptive {
        Some(_) => {
            let times = (1..=MOMENTS).map(|i| phase.start + phase.duration * f64::from(i) / f64::from(MOMENTS));
            times.into_iter().find_map(|time| pressed(phase, time))
        }
        None => phase.steps.iter().find_map(|step| pressed(phase, step.time)),
    })
}

/// The clamped nodes of the face, m, and how far each is below the highest node, m: in the plane ends of it, in space
/// whole edges, of a mesh those that are held along z.
fn clamped(outline: &Outline) -> Vec<(Vector2<f64>, f64)> {
    if !outline.relief.is_empty() {
        return outline.clamped.iter().map(|spot| (spot.at, spot.recess)).collect();
    }
    let ends = |along: Stretch| {
        [along.from, along.to].into_iter().zip(along.clamped).filter_map(|(at, recess)| Some((at, recess?)))
    };
    let Some(across) = outline.across else {
        return ends(outline.face).map(|(x, recess)| (Vector2::new(x, 0.0), recess)).collect();
    };
    let beside_y = ends(outline.face).flat_map(|(x, recess)| across.nodes().map(move |y| (Vector2::new(x, y), recess)));
    let beside_x = ends(across).flat_map(|(y, recess)| outline.face.nodes().map(move |x| (Vector2::new(x, y), recess)));
    beside_y.chain(beside_x).collect()
}
