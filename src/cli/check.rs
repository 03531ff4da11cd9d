//! `mpjr check`: what a run would do.

use std::path::PathBuf;

use clap::Args;

use super::terminal::tell;
use super::{profile, summary};
use crate::composition;
use crate::error::Result;
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
    let source = Source { file: file.clone(), overrides: arguments.set.clone() };
    let scene = scene::read(&scene::open(file)?, &source)?;
    let measured = composition::measured(&scene, file)?;
    let elevations = measured.as_ref().map_or_else(Vec::new, composition::numbers);
    let outline = composition::outline(&scene, file)?;
    let shape = composition::shape(&scene, file, &elevations, outline.face)?;
    tell(scene.to_toml().trim_end());
    tell(format_args!("\n{}", profile::describe(&scene, measured.as_ref(), &shape, outline.face)));
    tell(summary::plan(&scene, &outline));
    Ok(())
}
