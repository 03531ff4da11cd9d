//! `mpjr study`: the program from a scene to its tables, its figure and its advice.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::{Path, PathBuf};

use common::program::{ends_with, output_of, program};
use toml::{Table, Value};

/// The sliding scene, small and short.
fn scene(directory: &Path) -> PathBuf {
    let text = include_str!("scenes/sliding.toml");
    let text = text.replace("steps = 50", "steps = 16").replace("steps = 100", "steps = 32");
    let file = directory.join("sliding.toml");
    std::fs::write(&file, text).unwrap();
    file
}

fn study(scene: &Path, ranks: usize, arguments: &[&str]) -> std::process::Command {
    let mut command = program(ranks);
    command.arg("study").arg(scene).args(arguments).current_dir(scene.parent().unwrap());
    command
}

fn number(table: &Table, key: &str) -> f64 {
    table.get(key).and_then(Value::as_float).unwrap_or(f64::NAN)
}

/// The ladders that the scene suggests; each error is at least that of the finest rung, and the advice, solved again by
/// `mpjr run`, is a scene that the program takes.
#[test]
fn the_default_ladders() {
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path());
    let told = output_of(&mut study(&scene, 1, &[]));
    for word in ["cells", "steps", "penalty", "regularisation", "memory", "quadrature", "for 10 %: ", "sliding-study"] {
        assert!(told.contains(word), "{word}: {told}");
    }
    let out = directory.path().join("sliding-study");
    for name in ["work-precision.png", "work-precision.svg"] {
        assert!(out.join(name).exists(), "{name}");
    }
    let rows = std::fs::read_to_string(out.join("runs.csv")).unwrap();
    assert_eq!(rows.lines().count(), 1 + 4 + 4 + 3 + 3 + 2 + 2, "{rows}");
    let found: Table = std::fs::read_to_string(out.join("study.toml")).unwrap().parse().unwrap();
    let advice = found["advice"].as_array().unwrap();
    for advice in advice.iter().map(|advice| advice.as_table().unwrap()) {
        assert!(number(advice, "error") <= number(advice, "target"), "{advice}");
        let changes = advice["set"].as_array().unwrap().iter().flat_map(|set| ["--set", set.as_str().unwrap()]);
        output_of(program(1).arg("check").arg(&scene).args(changes));
    }
    assert!(!advice.is_empty());
    // A second study replaces what the first wrote; what another wrote stays.
    std::fs::write(out.join("runs.csv"), "mine").unwrap();
    assert!(ends_with(&mut study(&scene, 1, &[]), 4).contains("was not written by mpjr study"));
}

/// The penalty in series with the body has order 1 in 1/penalty: doubling it from 1e6 to 8e6 Pa/m halves what it
/// changes. Richardson then puts the error of the finest rung at what its last change was, over 2^p - 1. On two ranks.
#[test]
fn the_order_of_the_penalty() {
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path());
    output_of(&mut study(&scene, 2, &["--vary", "contact.penalty=1e6,2e6,4e6,8e6", "--out", "penalty"]));
    let out = directory.path().join("penalty");
    let found: Table = std::fs::read_to_string(out.join("study.toml")).unwrap().parse().unwrap();
    let ladder = found["ladder"][0].as_table().unwrap();
    let order = number(ladder, "order");
    assert!((order - 1.0).abs() < 0.02, "{order}");
    let rows = std::fs::read_to_string(out.join("runs.csv")).unwrap();
    let errors: Vec<f64> = rows.lines().skip(1).map(|row| row.rsplit(',').next().unwrap().parse().unwrap()).collect();
    // The error as estimated goes with 1/penalty itself.
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] - 2.0).abs() < 0.02, "{errors:?}");
    }
}

/// With `--error` nothing is printed but options, which `mpjr run` takes; what no setting meets is refused.
#[test]
fn the_cheapest_setting() {
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path());
    let steps = ["--vary", "phase.slide.steps=8,16,32,64", "--vary", "layer.cells=[8,8],[16,16]"];
    let told = output_of(study(&scene, 1, &steps).args(["--error", "0.2"]));
    let options: Vec<&str> = told.split_whitespace().map(|word| word.trim_matches('\'')).collect();
    assert!(options.len() == 4 && options[0] == "--set" && told.lines().count() == 1, "{told}");
    output_of(program(1).arg("run").arg(&scene).args(options).arg("--out").arg(directory.path().join("advised.h5")));
    assert!(!directory.path().join("sliding-study").exists());
    let refused = ends_with(study(&scene, 1, &steps).args(["--error", "1e-9"]), 2);
    assert!(refused.contains("no setting on these ladders meets it"), "{refused}");
}

#[test]
fn wrong_arguments_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path());
    for (arguments, words) in [
        (["--error", "1.5"], "must be above 0 and below 1"),
        (["--vary", "layer.cells"], "must be key=value,value, from coarse to fine"),
        (["--vary", "layer.cels=[4,4],[8,8]"], "did you mean \"cells\"?"),
        (["--vary", "phase.slide.steps=10,0"], "must be a whole number of steps"),
    ] {
        let message = ends_with(&mut study(&scene, 1, &arguments), 2);
        assert!(message.contains(words) && message.lines().count() == 1, "{message}");
    }
}
