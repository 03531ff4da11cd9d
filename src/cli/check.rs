//! `mpjr check`: what a run would do.

use std::path::PathBuf;

use clap::Args;

use super::telling::Telling;
use super::terminal::{answer, doubt, tell};
use super::{json, profile, summary};
use crate::composition;
use crate::error::Result;
use crate::scene::{self, Source, Strategy};
use crate::warnings::Doubts;

/// The arguments of `mpjr check`.
#[derive(Args)]
pub struct CheckArguments {
    /// The scene
    scene: PathBuf,
    /// Change a key of the scene, such as layer.depth=0.5 or phase.slide.velocity=0.1
    #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
    /// Print the summary as one JSON object on standard output, and nothing else there
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    telling: Telling,
}

/// Reads and checks the scene and prints what it resolves to: a scene, in which all else is a comment.
pub fn run(arguments: &CheckArguments) -> Result<()> {
    arguments.telling.begin(arguments.json);
    let file = &arguments.scene;
    let source = Source { file: file.clone(), overrides: arguments.set.clone() };
    let scene = scene::read(&scene::open(file)?, &source)?;
    composition::countable(&scene, file)?;
    let measured = composition::measured(&scene, file)?;
    let outline = composition::outline(&scene, file)?;
    composition::cohesive(&scene, file, &outline)?;
    // All unknowns are shared by as many ranks as a run may have.
    if scene.solver.strategy != Strategy::Monolithic {
        composition::affordable(&scene, file, &outline, 1)?;
    }
    let shape = composition::shape(&scene, file, &measured.numbers, &outline)?;
    tell(scene.to_toml().trim_end());
    tell(format_args!("\n{}", commented(&profile::describe(&scene, measured.note.as_deref(), &shape, &outline))));
    tell(commented(&summary::plan(&scene, &outline)));
    let warnings = Doubts::of(&scene, &outline, &shape).before;
    warnings.iter().for_each(doubt);
    if arguments.json {
        answer(json::plan(&scene, &outline, &warnings));
    }
    arguments.telling.judge(warnings.len())
}

/// Each line as a comment of TOML.
fn commented(text: &str) -> String {
    text.lines().map(|line| format!("# {line}").trim_end().to_owned()).collect::<Vec<_>>().join("\n")
}
