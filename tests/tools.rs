//! The commands around a run: `new`, `compare`, `completions`, `man`, and a resumed run that keeps other states.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::Path;
use std::process::{Command, Output};

use common::program::{MPJR, output_of};
use mpjr::output::reader::Results;

fn mpjr(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(MPJR).args(arguments).current_dir(directory).output().unwrap()
}

fn text(output: &[u8]) -> String {
    String::from_utf8_lossy(output).into_owned()
}

/// Every first scene is valid without a warning, names the schema beside it, and is solved as it is; none is replaced.
#[test]
fn first_scenes_run_as_they_are() {
    let directory = tempfile::tempdir().unwrap();
    for like in ["layer", "wheel", "rough", "laminate", "space"] {
        let file = format!("{like}.toml");
        let made = mpjr(directory.path(), &["new", &file, "--like", like]);
        assert!(made.status.success(), "{}", text(&made.stderr));
        let written = std::fs::read_to_string(directory.path().join(&file)).unwrap();
        assert!(written.starts_with("#:schema ./mpjr.schema.json\n"));
        let ran = mpjr(directory.path(), &["run", &file, "--deny-warnings"]);
        assert!(ran.status.success(), "{like}: {}", text(&ran.stderr));
    }
    let schema = std::fs::read_to_string(directory.path().join("mpjr.schema.json")).unwrap();
    assert!(schema.contains("draft-07"));
    let again = mpjr(directory.path(), &["new", "layer.toml"]);
    assert_eq!(
        (again.status.code(), text(&again.stderr)),
        (Some(4), "mpjr: layer.toml: exists; give another name\n".into())
    );
}

const SCENE: &str = r#"
layer = { width = 1.0, depth = 1.0, cells = [8, 8], sides = "periodic" }
material = { shear_modulus = 568.498, poisson_ratio = 0.3 }
indenter = { profile = "harmonic", amplitude = 5e-4, wavelength = 1.0 }
contact = {}
output = { checkpoint_every = 3, interface_every = 1, bulk_at = ["press"] }
[[phase]]
name = "press"
duration = 1.0
steps = 4
approach = 1e-3
[[phase]]
name = "hold"
duration = 1.0
steps = 4
"#;

/// A body of twice the modulus carries twice the force at the same displacements, bar rounding.
#[test]
fn files_are_compared_dataset_by_dataset() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("scene.toml"), SCENE).unwrap();
    for (file, modulus) in [("a.h5", "568.498"), ("same.h5", "568.498"), ("b.h5", "1136.996")] {
        let set = format!("material.shear_modulus={modulus}");
        assert!(mpjr(directory.path(), &["run", "scene.toml", "-o", file, "--set", &set]).status.success());
    }
    let same = mpjr(directory.path(), &["compare", "a.h5", "same.h5", "--tolerance", "0"]);
    assert!(same.status.success(), "{}", text(&same.stdout));
    let twice = mpjr(directory.path(), &["compare", "a.h5", "b.h5", "--tolerance", "1e-6"]);
    assert_eq!(twice.status.code(), Some(1));
    let table = text(&twice.stdout);
    let line = |name: &str| table.lines().find(|line| line.split(' ').next() == Some(name)).unwrap().to_owned();
    let relative = |name: &str| -> f64 { line(name).split_whitespace().nth(2).unwrap().parse().unwrap() };
    assert!((relative("/history/normal_force") - 1.0).abs() < 1e-6, "{table}");
    assert!(relative("/interface/displacement_z") < 1e-6, "{table}");
    assert!(
        line("/history/normal_force").ends_with("beyond the tolerance") && !line("/interface/gap").contains("beyond")
    );
    assert!(mpjr(directory.path(), &["compare", "a.h5", "b.h5"]).status.success());
    let shorter = mpjr(directory.path(), &["run", "scene.toml", "-o", "c.h5", "--set", "phase.hold.steps=2"]);
    assert!(shorter.status.success());
    let compared = mpjr(directory.path(), &["compare", "a.h5", "c.h5", "--tolerance", "1"]);
    assert!(compared.status.code() == Some(1) && text(&compared.stdout).contains("9 x 1 there, 7 x 1 here"));
}

/// A run that was stopped goes on with another `interface_every`: the profiles from then on are those, the history is that of
/// a run that nothing befell, and the file says the scene as it is now. Times at which a step must end cannot be added.
#[test]
fn a_run_goes_on_with_another_output() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("scene.toml");
    std::fs::write(&file, SCENE.replace("steps = 4", "steps = 400")).unwrap();
    let mut run = Command::new(MPJR);
    run.args(["run", "scene.toml"]).current_dir(directory.path()).stdout(std::process::Stdio::null());
    let mut child = run.spawn().unwrap();
    let checkpoint = directory.path().join("scene.h5.checkpoint");
    while !checkpoint.exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(5));

    let refused = mpjr(directory.path(), &["run", "scene.toml", "--resume", "--set", "output.bulk_at=[0.33]"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("output.bulk_at.0"), "{}", text(&refused.stderr));
    let other = ["--set", "output.interface_every=100", "--set", "output.bulk_at=[\"press\", \"hold\"]"];
    let resumed = mpjr(directory.path(), &[&["run", "scene.toml", "--resume"][..], &other].concat());
    assert!(resumed.status.success(), "{}", text(&resumed.stderr));
    assert!(mpjr(directory.path(), &["run", "scene.toml", "-o", "whole.h5"]).status.success());

    let open = |name: &str| Results::open(&directory.path().join(name)).unwrap();
    let (resumed, whole) = (open("scene.h5"), open("whole.h5"));
    assert_eq!(resumed.history("normal_force").unwrap(), whole.history("normal_force").unwrap());
    assert!(resumed.text("scene").unwrap().contains("interface_every = 100"));
    assert!(resumed.interface("time").unwrap().rows < whole.interface("time").unwrap().rows);
    assert_eq!((resumed.bulk("time").unwrap().rows, whole.bulk("time").unwrap().rows), (2, 1));
}

/// Completions know the commands; each command has a page.
#[test]
fn shells_and_man_know_the_commands() {
    let directory = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish"] {
        let script = output_of(Command::new(MPJR).args(["completions", shell]));
        assert!(script.contains("sweep") && script.contains("ranks-per-case"), "{shell}");
    }
    assert!(output_of(Command::new(MPJR).arg("man")).starts_with(".ie"));
    assert!(mpjr(directory.path(), &["man", "-o", "man"]).status.success());
    for page in ["mpjr.1", "mpjr-run.1", "mpjr-sweep.1", "mpjr-new.1"] {
        assert!(directory.path().join("man").join(page).exists(), "{page}");
    }
}
