//! `mpjr schema`: what editors accept and refuse is what the program does, as far as single keys go.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::PathBuf;
use std::process::Command;

use common::bad::bad_scenes;
use common::program::{MPJR, output_of};
use common::scenes;
use jsonschema::Validator;
use serde_json::Value;

/// What the program prints.
fn schema() -> Value {
    serde_json::from_str(&output_of(Command::new(MPJR).arg("schema"))).unwrap()
}

/// Every scene, sweep and material file of the repository that the program takes.
fn good() -> Vec<PathBuf> {
    let files = ["runs", "runs/materials", "tests/scenes"].into_iter().flat_map(scenes);
    // A table of edits of scenes.
    files.filter(|file| !file.ends_with("bad.toml")).collect()
}

fn as_json(text: &str) -> Option<Value> {
    serde_json::to_value(text.parse::<toml::Table>().ok()?).ok()
}

fn errors(validator: &Validator, text: &str) -> Vec<String> {
    let Some(value) = as_json(text) else { return vec!["not TOML".into()] };
    validator.iter_errors(&value).map(|error| format!("{}: {error}", error.instance_path())).collect()
}

/// The schema is draft-07, with none of what the servers of editors misread, and takes every file that the program takes.
#[test]
fn every_scene_of_the_repository_is_accepted() {
    let schema = schema();
    assert!(jsonschema::draft7::meta::is_valid(&schema));
    let text = schema.to_string();
    assert!(
        !["prefixItems", "unevaluatedProperties", "$defs"].iter().any(|word| text.contains(&format!("\"{word}\"")))
    );
    let validator = jsonschema::draft7::new(&schema).unwrap();
    let files = good();
    assert!(files.len() >= 25, "{} files", files.len());
    for file in files {
        let found = errors(&validator, &std::fs::read_to_string(&file).unwrap());
        assert!(found.is_empty(), "{}: {found:#?}", file.display());
    }
}

/// The schema refuses every scene with an unknown key, and most of those with a value of the wrong kind or out of range; what
/// one key has to do with another, or with a file, it does not see.
#[test]
fn bad_scenes_are_refused() {
    let validator = jsonschema::draft7::new(&schema()).unwrap();
    let (mut refused, mut missed) = (0, Vec::new());
    for scene in bad_scenes().iter().filter(|scene| scene.args.is_empty()) {
        // A file of a material is no part of the scene.
        let unknown = scene.message.contains(": unknown key") && !scene.message.starts_with("material.file");
        match errors(&validator, &scene.text).is_empty() {
            false => refused += 1,
            true if unknown => missed.push(format!("{}: {}", scene.file.display(), scene.message)),
            true => {}
        }
    }
    assert!(missed.is_empty() && refused >= 130, "{refused} refused; missed: {missed:#?}");
}

/// Taplo, which the editors' TOML extension is made of, accepts the scenes of `runs/`, and refuses all bad scenes that the schema
/// refuses.
#[test]
fn taplo_accepts_the_scenes() {
    let taplo = std::env::var("TAPLO").unwrap_or_else(|_| "taplo".into());
    if Command::new(&taplo).arg("--version").output().is_err() {
        println!("skipped: no taplo (npm install @taplo/cli, then TAPLO=node_modules/.bin/taplo; ci/editors does so)");
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("mpjr.json");
    std::fs::write(&file, schema().to_string()).unwrap();
    // One call takes a second or so, however many files.
    let check = |files: &[PathBuf]| {
        let schema = format!("file://{}", file.display());
        Command::new(&taplo).args(["check", "--schema", &schema]).args(files).output().unwrap()
    };
    let outcome = check(&scenes("runs").into_iter().chain(scenes("runs/materials")).collect::<Vec<_>>());
    assert!(outcome.status.success(), "{}", String::from_utf8_lossy(&outcome.stderr));
    // Of the scenes that the validator refuses, all that are TOML at all: each file that is refused is named.
    let validator = jsonschema::draft7::new(&schema()).unwrap();
    let (mut bad, mut messages) = (Vec::new(), Vec::new());
    for (number, scene) in bad_scenes().iter().filter(|scene| scene.args.is_empty()).enumerate() {
        if as_json(&scene.text).is_some() && !errors(&validator, &scene.text).is_empty() {
            let path = directory.path().join(format!("bad-{number}.toml"));
            std::fs::write(&path, &scene.text).unwrap();
            bad.push(path);
            messages.push(&scene.message);
        }
    }
    let outcome = check(&bad);
    let said = String::from_utf8_lossy(&outcome.stderr);
    let missed: Vec<_> = bad.iter().zip(&messages).filter(|(path, _)| !said.contains(path.to_str().unwrap())).collect();
    assert!(missed.is_empty() && bad.len() >= 130, "of {}: {missed:#?}\n{said}", bad.len());
}
