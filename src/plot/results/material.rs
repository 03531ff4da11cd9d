//! The material of a run.

use super::Run;
use crate::error::Result;
use crate::plot::Sheet;
use crate::plot::material::Solid;

/// Relaxation, storage and loss modulus, loss tangent, Poisson ratio.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let solid = Solid::of(&run.scene.material, "");
    Ok(crate::plot::material::sheet(&[solid], None))
}
