//! Whether the cells of the face resolve how the adhesion lets go.

use std::f64::consts::PI;
use std::path::Path;

use super::{Outline, adhering};
use crate::error::{Error, Result};
use crate::scene::{Body, Material, Scene};

/// Cells that the cohesive zone spans at least.
const FEWEST: f64 = 3.0;

/// E* = 2 G/(1 - nu) of the material at the face, at t = 0, Pa; of a mesh of several, the least.
fn modulus(scene: &Scene) -> f64 {
    let of = |material: &Material| 2.0 * material.shear_modulus / (1.0 - material.poisson_ratio);
    match &scene.body {
        Body::Layer(_) => scene.materials.first().map_or(f64::NAN, of),
        Body::Mesh(_) => scene.materials.iter().map(of).fold(f64::INFINITY, f64::min),
    }
}

/// The length over which a closed gap opens to where nothing pulls, pi E* w/(4 sigma_0^2), m (Dugdale's zone at the edge of a long
/// contact; E* instantaneous); none without adhesion.
pub fn cohesive_zone(scene: &Scene) -> Option<f64> {
    let law = adhering(scene.adhesion?);
    Some(PI * modulus(scene) * law.work() / (4.0 * law.strength().powi(2)))
}

/// Refuses cells of which fewer than three span the cohesive zone: the contact would be held by single nodes, one after the other.
///
/// # Errors
/// [`Error::Scene`] with the cells that it needs.
pub fn cohesive(scene: &Scene, file: &Path, outline: &Outline) -> Result<()> {
    let Some(zone) = cohesive_zone(scene) else { return Ok(()) };
    let (key, spans) = match &scene.body {
        Body::Layer(layer) => ("layer.cells", layer.spans.iter().map(|span| (span.width, span.cells)).collect()),
        Body::Mesh(_) => {
            let along = std::iter::once(outline.face).chain(outline.across);
            ("mesh.file", along.map(|stretch| (stretch.width(), stretch.edges)).collect::<Vec<_>>())
        }
    };
    let coarsest = spans.iter().map(|(width, cells)| width / *cells as f64).fold(0.0, f64::max);
    if FEWEST * coarsest <= zone * (1.0 + 1e-9) {
        return Ok(());
    }
    let needed: Vec<String> =
        spans.iter().map(|(width, _)| format!("{}", (FEWEST * width / zone * (1.0 - 1e-9)).ceil())).collect();
    let reason = format!(
        "has cells of {coarsest:.3e} m at the face, of which {:.2} span the cohesive zone of the adhesion, pi E* work/(4 sigma_0^2) = \
         {zone:.3e} m; it takes {FEWEST}: give {} along the face, or a longer adhesion.range",
        zone / coarsest,
        needed.join(" x ")
    );
    Err(Error::scene(file, key, reason))
}
