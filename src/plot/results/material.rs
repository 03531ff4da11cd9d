//! The materials of a run.

use super::Run;
use crate::error::Result;
use crate::plot::Sheet;
use crate::plot::material::Solid;
use crate::scene::Material;

/// Relaxation, loss and storage modulus, loss tangent, Poisson ratio.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let materials = &run.scene.materials;
    let solid = |material: &Material| {
        let stratum = material.thickness.map(|thickness| format!("stratum of {thickness} m"));
        // The lowest stratum has no thickness of its own; of one material alone there is no place to tell.
        let rest = (materials.len() > 1).then(|| "stratum below".into());
        Solid::of(material, &material.region.clone().or(stratum).or(rest).unwrap_or_default())
    };
    Ok(crate::plot::material::sheet(&materials.iter().map(solid).collect::<Vec<_>>(), run.law))
}
