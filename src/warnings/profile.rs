//! What the mesh sees of the profile, and whether the profile is what was meant.

use super::{Before, Warning, above, cells};
use crate::composition::Finest;
use crate::scene::Indenter;

/// Cells to the shortest wave of a profile.
pub const FEWEST_CELLS_TO_A_WAVE: f64 = 4.0;
/// The root mean square of what nodes miss of the profile where it overlaps, over the deepest overlap.
pub const MOST_BETWEEN_NODES: f64 = 0.1;
/// Slope of the profile where it overlaps: strains are of its order, and are taken to be small.
pub const STEEPEST: f64 = 0.3;

/// A file that is a thousand times longer than the face has its numbers in another unit.
pub fn unit(before: &Before<'_>) -> Option<Warning> {
    Some(Warning::new("indenter.file", before.shape.unit.clone()?))
}

/// A file that repeats has a wall where its ends meet.
pub fn seam(before: &Before<'_>) -> Option<Warning> {
    let (key, text) = before.shape.seam.clone()?;
    Some(Warning::new(key, text))
}

/// Fewer than [`FEWEST_CELLS_TO_A_WAVE`].
pub fn waves(before: &Before<'_>) -> Option<Warning> {
    let Some(Finest::Wavelength(length)) = before.shape.finest else { return None };
    let face = before.outline.face;
    let cells_to_a_wave = length / face.cell();
    if !above(FEWEST_CELLS_TO_A_WAVE, cells_to_a_wave) {
        return None;
    }
    let text = format!(
        "{cells_to_a_wave:.2} cells to the shortest wave of the profile ({length} m), fewer than {FEWEST_CELLS_TO_A_WAVE}: the \
         mesh sees another profile; give at least {:.0} cells along the face",
        (FEWEST_CELLS_TO_A_WAVE * face.width() / length).ceil()
    );
    Some(Warning::new(cells(before.scene), text))
}

/// More than [`MOST_BETWEEN_NODES`].
pub fn between_nodes(before: &Before<'_>) -> Option<Warning> {
    let deepest = before.encounters.deepest();
    let share = deepest.between / deepest.overlap;
    if !(deepest.overlap > 0.0 && above(share, MOST_BETWEEN_NODES)) {
        return None;
    }
    let text = format!(
        "between the nodes ({:.3e} m apart) the profile is {:.2e} m (rms) off what they see of it, {:.0} % of the deepest \
         overlap (more than {:.0} %): the mesh sees another profile; give more cells, or a smoother profile",
        before.outline.face.cell(),
        deepest.between,
        100.0 * share,
        100.0 * MOST_BETWEEN_NODES
    );
    Some(Warning::new(cells(before.scene), text))
}

/// More than [`STEEPEST`], where the profile overlaps the face, or beside it where it slides: there flanks come into
/// contact.
pub fn slope(before: &Before<'_>) -> Option<Warning> {
    let encounters = &before.encounters;
    let touching = encounters.list.iter().filter(|met| met.overlap > 0.0).map(|met| met.slope).fold(0.0, f64::max);
    let sliding = encounters.moving().filter(|(_, phase, _)| super::encounter::slides(phase));
    let flank = sliding.map(|(.., met)| met.flank).fold(0.0, f64::max);
    let (slope, place) = if flank > touching { (flank, "beside the contact") } else { (touching, "in the contact") };
    if !above(slope, STEEPEST) {
        return None;
    }
    let unit = match before.scene.indenter {
        Indenter::Sampled { .. } | Indenter::Map { .. } if slope > 10.0 * STEEPEST => {
            "; are the elevations in another unit than x?"
        }
        _ => "",
    };
    let text = format!(
        "the profile's slope is {slope:.3} {place}, above {STEEPEST}: strains are of that order and are taken to be small; \
         take a smoother profile or less approach{unit}"
    );
    Some(Warning::new("indenter", text))
}
