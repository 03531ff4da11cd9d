//! Every scene of `tests/scenes/bad/` is refused with exactly the message that it carries.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[allow(dead_code)]
mod common;

use std::path::Path;

use mpjr::error::Result;
use mpjr::scene::{Scene, Source, read};

/// Reads the mesh where the scene names a file.
fn mesh_of(scene: &Scene, file: &Path) -> Result<()> {
    match scene.layer() {
        Some(_) => Ok(()),
        None => mpjr::composition::mesh_alone(scene, file).map(|_| ()),
    }
}

#[test]
fn each_bad_scene_gives_its_message() {
    let scenes = common::bad_scenes();
    assert!(scenes.len() >= 50, "only {} scenes", scenes.len());
    let mut wrong = Vec::new();
    for scene in &scenes {
        let source = Source { file: scene.file.clone(), overrides: scene.overrides() };
        // What is wrong with a mesh shows when it is read.
        let outcome = read(&scene.text, &source).and_then(|read| mesh_of(&read, &scene.file));
        let (message, exit) = match outcome {
            Ok(_) => ("(accepted)".to_owned(), 0),
            Err(error) => {
                let message = error.to_string();
                let prefix = format!("{}: ", scene.file.display());
                (message.strip_prefix(&prefix).unwrap_or(&message).to_owned(), error.exit_code())
            }
        };
        if message != scene.message || exit != scene.exit || message.contains('\n') {
            let name = scene.file.file_name().unwrap().to_string_lossy();
            wrong.push(format!("{name} ({exit})\n  must be: {}\n  is:      {message}", scene.message));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}
