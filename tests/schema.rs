//! `mpjr schema`: what editors accept and refuse is what the program does, as far as single keys go.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::{Path, PathBuf};
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

/// What a schema of single keys cannot see, of those refused for a key that is unknown, absent or of the wrong kind: what
/// depends on another key, on the loading or on a file, and `8.0`, which is a whole number to JSON.
const BEYOND: &[&str] = &[
    "approach-through-circle",
    "approach-through-layer",
    "bulk-arms-missing",
    "bulk-at-too-late",
    "cells-three-numbers",
    "cells-whole-float",
    "coulomb-gauss",
    "duration-overflow",
    "layer-missing",
    "material-file-misspelt-key",
    "material-file-negative-time",
    "material-file-with-a-layer",
    "material-file-without-a-table",
    "material-modulus-missing",
    "material-poisson-missing",
    "mesh-not-a-number",
    "mesh-too-deep",
    "penalty-missing",
    "period-longer-than-layer",
    "period-not-whole",
    "phase-duration-missing",
    "phase-name-empty",
    "phase-steps-missing",
    "reference-temperature-missing",
    "region-memories",
    "region-missing",
    "rough-longest-below-shortest",
    "rough-longest-not-whole",
    "rough-no-rms",
    "rough-period-below-longest",
    "sampled-error-periodic-sides",
    "sampled-period-not-whole",
    "sampled-period-short",
    "space-cells-of-the-plane",
    "space-element-of-the-plane",
    "space-harmonic-centre",
    "space-waves-that-do-not-fit",
    "steps-whole-float",
    "strata-thickness-missing",
    "temperature-missing",
    "wlf-coefficient-missing",
];

/// A scene that is refused for an unknown key, or for a value of the wrong kind or out of range, is refused by the schema.
#[test]
fn bad_scenes_are_refused() {
    let validator = jsonschema::draft7::new(&schema()).unwrap();
    let (mut refused, mut missed) = (0, Vec::new());
    for scene in bad_scenes().iter().filter(|scene| scene.args.is_empty()) {
        let name = scene.file.file_stem().unwrap().to_str().unwrap();
        let of_a_key =
            [": unknown key", ": must be ", ": missing; give"].iter().any(|said| scene.message.contains(said));
        match errors(&validator, &scene.text).is_empty() {
            false => refused += 1,
            true if of_a_key && !BEYOND.contains(&name) => missed.push(format!("{name}: {}", scene.message)),
            true => {}
        }
    }
    println!("the schema refuses {refused} bad scenes");
    assert!(missed.is_empty() && refused > 100, "{refused} refused; missed: {missed:#?}");
}

/// Taplo, which the editors' TOML extension is made of, accepts the scenes of `runs/` and refuses a misspelt key.
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
    let check = |scene: &Path| {
        let schema = format!("file://{}", file.display());
        Command::new(&taplo).args(["check", "--schema", &schema]).arg(scene).output().unwrap()
    };
    for scene in scenes("runs").into_iter().chain(scenes("runs/materials")) {
        let outcome = check(&scene);
        assert!(outcome.status.success(), "{}: {}", scene.display(), String::from_utf8_lossy(&outcome.stderr));
    }
    let bad = directory.path().join("bad.toml");
    let text = std::fs::read_to_string(common::directory("runs/eva-one-arm.toml")).unwrap();
    for (right, wrong) in [("depth ", "dept "), ("\"periodic\"", "\"periodical\""), ("[128, 128]", "[128, 0]")] {
        assert!(text.contains(right), "{right}");
        std::fs::write(&bad, text.replacen(right, wrong, 1)).unwrap();
        assert!(!check(&bad).status.success(), "{wrong} is accepted");
    }
}
