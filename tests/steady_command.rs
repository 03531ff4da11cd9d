//! `mpjr steady` as a command: its file, its figures, and what it refuses.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::program::{Outcome, mpjr, names, program};
use mpjr::output::reader::Results;

const SCENE: &str = include_str!("scenes/steady.toml");

/// `mpjr steady scene.toml ARGUMENTS`.
fn steady(ranks: usize, arguments: &[&str]) -> Outcome {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("scene.toml"), SCENE).unwrap();
    let output =
        program(ranks).current_dir(&directory).args(["steady", "scene.toml"]).args(arguments).output().unwrap();
    Outcome::new(output, directory)
}

/// The file has what the reference says, with scales; on three ranks it is the same to round-off; without --velocities it has the last
/// phase's alone, and `plot` draws what there is.
#[test]
fn the_file_is_whole_on_any_ranks() {
    let ladder = ["--velocities", "1e-3:1e1:3", "--out", "curve.h5"];
    let [one, three] = [1, 3].map(|ranks| steady(ranks, &ladder));
    for outcome in [&one, &three] {
        assert_eq!(outcome.code, 0, "{}", outcome.stderr);
        outcome.assert_clean();
    }
    let [one_file, other] =
        [&one, &three].map(|outcome| Results::open(&outcome.directory.path().join("curve.h5")).unwrap());
    for (name, columns) in [
        ("velocity", 1),
        ("approach", 1),
        ("normal_force", 1),
        ("tangential_force", 1),
        ("hysteretic_force", 1),
        ("contact_fraction", 1),
        ("arm_dissipation", 1),
        ("pressure", 64),
        ("shear", 64),
        ("gap", 64),
    ] {
        let (a, b) = (one_file.steady(name).unwrap(), other.steady(name).unwrap());
        assert_eq!((a.rows, a.columns), (13, columns), "{name}");
        let size = a.values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        let apart = a.values.iter().zip(&b.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart <= 1e-9 * size, "{name}: {apart}");
    }
    assert_eq!(one_file.text("status").unwrap(), "complete");
    assert_eq!(one_file.interface("x").unwrap().rows, 64);
    let drawn = program(1).current_dir(&one.directory).args(["plot", "curve.h5"]).output().unwrap();
    assert!(drawn.status.success(), "{}", String::from_utf8_lossy(&drawn.stderr));
    let drawn = names(one.directory.path());
    for figure in ["friction", "dissipation", "steady"] {
        assert!(drawn.contains(&format!("curve-{figure}.png")) && drawn.contains(&format!("curve-{figure}.svg")));
    }
    let single = steady(1, &[]);
    assert_eq!(single.results().steady("velocity").unwrap().values, [0.1]);
    let refused = program(1).current_dir(&single.directory).args(["plot", "scene.h5", "friction"]).output().unwrap();
    assert!(String::from_utf8_lossy(&refused.stderr).contains("several velocities"));
}

/// What cannot be done is said, with its key, and nothing is written.
#[test]
fn what_is_never_steady_is_refused() {
    for (change, message) in [
        ("layer.sides=free", "layer.sides: mpjr steady takes \"periodic\" sides"),
        ("phase.slide.velocity=0", "phase.slide.velocity: the last phase has none"),
        ("friction.coefficient=0.2 + s", "friction.coefficient: mpjr steady takes no s"),
        ("material.arms.0.weight=1", "material.arms: mpjr steady needs weights that sum to less than 1"),
        ("phase.press.approach=0", "phase.slide.approach: mpjr steady reaches the layer above 0e0 m"),
    ] {
        let mut arguments = vec!["--set", change];
        if change.starts_with("phase.slide.velocity") {
            arguments.extend(["--set", "phase.slide.distance=", "--set", "phase.slide.duration=1"]);
        }
        let outcome = steady(1, &arguments);
        assert_eq!(outcome.code, 2, "{change}: {}", outcome.stderr);
        outcome.assert_single_message(message);
        assert_eq!(names(outcome.directory.path()), ["scene.toml"]);
    }
    let outcome = steady(1, &["--velocities", "1:0.1:3"]);
    assert!(outcome.code == 2 && outcome.stderr.contains("FROM:TO:PER_DECADE"), "{}", outcome.stderr);
    let other = tempfile::tempdir().unwrap();
    let path = other.path().join("notes.h5");
    std::fs::write(&path, "mine").unwrap();
    let outcome = steady(1, &["--out", path.to_str().unwrap()]);
    assert_eq!(outcome.code, 4);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
    assert_eq!(mpjr(1, &["steady", "absent.toml"]).code, 4);
}
