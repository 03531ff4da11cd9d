//! `mpjr check`: what a run would do.

use std::path::PathBuf;

use clap::Args;

use super::{is_first_process, summary};
use crate::composition;
use crate::error::{Error, Result};
use crate::scene::{self, Source};

/// The arguments of `mpjr check`.
#[derive(Args)]
pub struct CheckArguments {
    /// The scene
    scene: PathBuf,
    /// Change a key of the scene, such as layer.depth=0.5 or phase.slide.velocity=0.1
    #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
}

/// Reads and checks the scene and prints what it resolves to.
pub fn run(arguments: &CheckArguments) -> Result<()> {
    let file = &arguments.scene;
    let text = std::fs::read_to_string(file).map_err(|error| Error::file(file, format!("cannot be read: {error}")))?;
    let scene = scene::read(&text, &Source { file: file.clone(), overrides: arguments.set.clone() })?;
    // A layer's mesh has no more to say than its scene.
    let mesh = match scene.layer() {
        Some(_) => None,
        None => Some(composition::mesh_alone(&scene, file)?),
    };
    if is_first_process() {
        println!("{}", scene.to_toml().trim_end());
        println!("\n{}", summary::plan(&scene, mesh.as_ref()));
    }
    Ok(())
}
