//! The files whose content a run depends on, besides its scene.

use std::path::Path;

use super::{body, profile};
use crate::checksum;
use crate::error::Result;
use crate::scene::{Body, Indenter, Scene};

/// What tells whether the files that the scene in `file` names have changed: a line `KEY CHECKSUM` for each, the checksum
/// that of its bytes. Motions and tables of friction are in the resolved scene, too, of which a run from that alone depends on no file
/// and has no such line. Materials are in the resolved scene, and not here.
///
/// # Errors
/// [`crate::error::Error::File`] for a file that cannot be read.
pub fn inputs(scene: &Scene, file: &Path) -> Result<String> {
    let mut text = String::new();
    let mut add = |key: &str, sum: &str| text += &format!("{} {sum}\n", key.escape_debug());
    if let Body::Mesh(mesh) = &scene.body {
        add("mesh.file", &checksum::text(&body::bytes(mesh)?));
    }
    if let Indenter::Sampled { file: name, .. } | Indenter::Map { file: name, .. } = &scene.indenter {
        add("indenter.file", &checksum::text(&profile::bytes(name, file)?));
    }
    let sums = scene.friction.iter().flat_map(|friction| &friction.checksums);
    sums.for_each(|sum| add("friction.coefficient", sum));
    for phase in &scene.phases {
        if let Some(sum) = phase.record().and_then(|record| record.checksum.as_ref()) {
            add(&format!("phase.{}.motion", phase.name), sum);
        }
    }
    Ok(text)
}
