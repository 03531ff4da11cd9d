//! The materials of a run.

use super::Run;
use crate::error::Result;
use crate::plot::Sheet;
use crate::plot::material::Solid;
use crate::scene::Material;

/// Relaxation, loss and storage modulus, loss tangent, Poisson ratio.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let solid = |material: &Material| {
        let place = material.region.clone().or(material.thickness.map(|thickness| format!("{thickness} m")));
        Solid::of(material, &place.unwrap_or_default())
    };
    Ok(crate::plot::material::sheet(&run.scene.materials.iter().map(solid).collect::<Vec<_>>(), run.law))
}
