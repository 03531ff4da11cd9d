//! Whether the mesh resolves a rough profile.

use super::{Climbed, Run};
use crate::output::HistoryRow;
use crate::scene::{Indenter, Scene};

/// The share of contact area and force up to which two meshes are said to agree.
const AGREE: f64 = 0.05;

/// One line on a scene with a rough profile: the cells to its shortest wave, and by how much contact area and normal force change from
/// the last mesh but one of a ladder to the last, where the force is largest. None without such a profile, or two meshes.
pub fn resolved(scene: &Scene, climbed: &[Climbed]) -> Option<String> {
    let (Indenter::Rough { shortest, .. }, Some(layer)) = (&scene.indenter, scene.layer()) else { return None };
    let to_a_wave =
        layer.spans.iter().map(|span| shortest * span.cells as f64 / span.width).fold(f64::INFINITY, f64::min);
    let meshes = climbed.iter().find_map(|ladder| {
        let settings = ladder.ladder.rungs.iter().zip(&ladder.rungs);
        let meshes =
            settings.filter(|(setting, _)| setting.changes.iter().any(|change| change.starts_with("layer.cells")));
        let runs: Vec<_> = meshes.filter_map(|(setting, rung)| Some((&setting.label, rung.run.as_ref()?))).collect();
        let &[.., coarse, fine] = runs.as_slice() else { return None };
        Some([coarse, fine])
    });
    let [(from, coarse), (to, fine)] = meshes?;
    let change = |of: fn(&HistoryRow) -> f64| -> Option<f64> {
        let [coarse, fine] = [of(heaviest(coarse)?), of(heaviest(fine)?)];
        (fine > 0.0).then(|| (coarse / fine - 1.0).abs())
    };
    let (area, force) = (change(|row| row.contact_fraction)?, change(|row| row.normal_force)?);
    let verdict = match area.max(force) <= AGREE {
        true => "resolved",
        false => "not resolved: give more cells along the face, or leave short waves out",
    };
    Some(format!(
        "roughness: {to_a_wave:.1} cells to the shortest wave as it is; from {from} to {to} contact area changes by {:.1} % and N by \
         {:.1} %: {verdict}",
        100.0 * area,
        100.0 * force
    ))
}

/// Where the normal force of a run is largest.
fn heaviest(run: &Run) -> Option<&HistoryRow> {
    run.history.iter().max_by(|a, b| a.normal_force.total_cmp(&b.normal_force))
}
