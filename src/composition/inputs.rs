//! The files whose content a run depends on, besides its scene.

use std::path::Path;

use super::{body, profile};
use crate::checksum::checksum;
use crate::error::Result;
use crate::scene::{Body, Indenter, Scene};

/// What tells whether the files that the scene in `file` names have changed: a line `KEY CHECKSUM` for each, the checksum
/// that of its bytes. Materials, tables of friction and motions from files are in the resolved scene, and not here.
///
/// # Errors
/// [`crate::error::Error::File`] for a file that cannot be read.
pub fn inputs(scene: &Scene, file: &Path) -> Result<String> {
    let mut text = String::new();
    let mut add = |key: &str, bytes: &[u8]| text += &format!("{key} {:016x}\n", checksum(bytes));
    if let Body::Mesh(mesh) = &scene.body {
        add("mesh.file", &body::bytes(mesh)?);
    }
    if let Indenter::Sampled { file: name, .. } | Indenter::Map { file: name, .. } = &scene.indenter {
        add("indenter.file", &profile::bytes(name, file)?);
    }
    Ok(text)
}
