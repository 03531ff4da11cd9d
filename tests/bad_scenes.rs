//! Every scene of `tests/scenes/bad.toml` and `tests/scenes/bad/` is refused with exactly the message that it carries.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use mpjr::composition;
use mpjr::scene::{Source, read};

#[test]
fn each_bad_scene_gives_its_message() {
    let scenes = common::bad::bad_scenes();
    assert!(scenes.len() >= 50, "only {} scenes", scenes.len());
    let mut wrong = Vec::new();
    for scene in scenes {
        let source = Source { file: scene.file.clone(), overrides: scene.overrides() };
        // What `mpjr check` does: the scene, then what it needs of other files.
        let checked = read(&scene.text, &source).and_then(|read| {
            let elevations = composition::elevations(&read, &scene.file)?;
            let outline = composition::outline(&read, &scene.file)?;
            composition::shape(&read, &scene.file, &elevations, &outline).map(|_| ())
        });
        let (message, exit) = match checked {
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
