//! Phases that a measured history drives: `motion = "history.csv"`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::program::{MPJR, Outcome, Run, assert_same, ends_with, output_of, program};
use common::scene::{COSINE, ONE_ARM, Text, coulomb, layer};
use std::fs;
use std::process::Command;

/// A layer of one arm under a wave, with Coulomb's law itself.
static LAYER: Text = Text::new(|| {
    let rest = coulomb("0.2") + "[solver]\ntolerance = 1e-12\n";
    [&layer("1.0", "1.0", "[32, 16]"), ONE_ARM, COSINE, &rest].concat()
});

/// Loaded, slid, reversed and let go: every kind of phase, in binary fractions of time.
const PHASES: &str = r#"
[[phase]]
name = "load"
duration = 2.0
steps = 16
normal_force = 0.5
[[phase]]
name = "slide"
velocity = 0.0625
duration = 2.0
steps = 16
[[phase]]
name = "shake"
tangential = { amplitude = 0.01, cycles = 1.25 }
approach = 1.2e-3
duration = 1.0
steps = 16
[[phase]]
name = "off"
approach = 0.0
duration = 1.0
steps = 8
"#;

/// A run with files of motion beside its scene.
fn with_files(scene: &str, files: &[(&str, String)]) -> Run {
    let run = Run::new(scene);
    for (name, text) in files {
        fs::write(run.directory().join(name), text).unwrap();
    }
    run
}

/// The columns of the history from one time to another, both included, as a file of motion; times count from the first.
fn record(run: &Outcome, [from, to]: [f64; 2], columns: &[&str]) -> String {
    let times = run.history("time");
    let columns: Vec<(&str, Vec<f64>)> = columns.iter().map(|name| (*name, run.history(name))).collect();
    let titles: String = columns.iter().map(|(name, _)| format!(", {name}")).collect();
    let rows = times.iter().enumerate().filter(|(_, time)| (from..=to).contains(*time)).map(|(row, time)| {
        let values: String = columns.iter().map(|(_, values)| format!(", {:?}", values[row])).collect();
        format!("{:?}{values}\n", time - from)
    });
    format!("time{titles}\n") + &rows.collect::<String>()
}

/// A history whose phases are replayed from what it wrote gives the same numbers: to round-off where the file says approach, or force
/// and sliding, as the phases had; and the states of a ramp of load are those of the approach that it traced.
#[test]
fn a_replayed_history_is_the_history() {
    let original = Run::new(&(LAYER.clone() + PHASES)).done();
    let phase =
        |name: &str, steps: usize| format!("[[phase]]\nname = \"{name}\"\nsteps = {steps}\nmotion = \"{name}.csv\"\n");
    let phases = [("load", 16), ("slide", 16), ("shake", 16), ("off", 8)].map(|(name, steps)| phase(name, steps));
    let scene = LAYER.clone() + &phases.concat();
    let rest = [
        ("shake.csv", record(&original, [4.0, 5.0], &["approach", "sliding"])),
        ("off.csv", record(&original, [5.0, 6.0], &["approach"])),
    ];
    let file = |run: &Outcome| run.directory.path().join("scene.h5");
    // A force that is held, and the place that it led to.
    for (normal, within) in [("normal_force", 1e-9), ("approach", 1e-9)] {
        let files = [
            ("load.csv", record(&original, [0.0, 2.0], &[normal])),
            ("slide.csv", record(&original, [2.0, 4.0], &["sliding", normal])),
        ];
        let replayed = with_files(&scene, &[&files[..], &rest].concat()).done();
        assert_same(&file(&original), &file(&replayed), within);
    }
}

/// The path is straight between rows and from the start to the first of them, units are those of the titles, and the time of the phase may be
/// shorter than the file's; what the file does not say stays as it is.
#[test]
fn rows_are_joined_by_straight_lines() {
    let scene = LAYER.clone()
        + "[[phase]]\nsteps = 8\nmotion = \"press.csv\"\n[[phase]]\nduration = 3.0\nsteps = 12\nmotion = \"slide.csv\"\n";
    let files = [
        ("press.csv", "time (ms); approach (mm)\n500; 1.0\n2000; 0.7\n".to_owned()),
        // The sliding at 0 s is where the phase begins, whatever its number.
        ("slide.csv", "time, sliding\n0, 0.3\n1, 0.32\n4, 0.29\n".to_owned()),
    ];
    let run = with_files(&scene, &files).done();
    for (time, approach, sliding) in [
        (0.25, 5e-4, 0.0),
        (0.5, 1e-3, 0.0),
        (1.25, 8.5e-4, 0.0),
        (2.0, 7e-4, 0.0),
        (2.5, 7e-4, 0.01),
        (3.0, 7e-4, 0.02),
        (5.0, 7e-4, 0.0),
    ] {
        let found = [run.at(time, "approach"), run.at(time, "sliding")];
        assert!((found[0] - approach).abs() < 1e-17 && (found[1] - sliding).abs() < 1e-15, "{time} s: {found:?}");
    }
}

/// Steps that are chosen end at each row, and at the moments of bulk output beside them, where alone there are bulk fields.
#[test]
fn chosen_steps_end_at_rows() {
    let scene = LAYER.clone() + "[[phase]]\ntolerance = 1e-2\nmotion = \"press.csv\"\n[output]\nbulk_at = [0.7]\n";
    let rows = "time, approach, sliding\n0, 0, 0\n0.3, 4e-4, 0\n0.55, 1e-3, 0.001\n1.1, 1e-3, 0.002\n";
    let run = with_files(&scene, &[("press.csv", rows.to_owned())]).done();
    let times = run.history("time");
    for row in [0.3, 0.55, 0.7, 1.1] {
        assert!(times.iter().any(|time| (time - row).abs() < 1e-12), "{row}: {times:?}");
    }
    assert_eq!(run.results().bulk("time").unwrap().values, [0.7]);
    assert!((run.at(0.3, "approach") - 4e-4).abs() < 1e-17 && (run.last("sliding") - 0.002).abs() < 1e-17);
}

/// A resolved scene has the columns and needs no file, `mpjr check`'s and the one in the results; a file that has changed is noticed by a run
/// that is to go on and by a sweep.
#[test]
fn a_changed_file_is_noticed() {
    let scene = LAYER.clone() + "[[phase]]\nname = \"press\"\nsteps = 4\nmotion = \"press.csv\"\n";
    let [before, after] = ["1e-3", "1.1e-3"].map(|depth| format!("time, approach\n1, {depth}\n"));
    let run = with_files(&scene, &[("press.csv", before.clone())]);
    let directory = run.directory();
    let sweep = "scene = \"scene.toml\"\n[vary]\n\"friction.coefficient\" = [0.1]\n";
    fs::write(directory.join("sweep.toml"), sweep).unwrap();
    let swept = || output_of(program(1).current_dir(&directory).args(["sweep", "sweep.toml"]));
    swept();
    assert!(swept().contains("1 of 1 case(s) were complete before"), "a case that is done is not run again");
    let mut check = Command::new(MPJR);
    let checked = output_of(check.current_dir(&directory).args(["check", "scene.toml"]));
    fs::write(directory.join("press.csv"), &after).unwrap();
    assert!(!swept().contains("were complete before"), "the motion is another");
    fs::write(directory.join("press.csv"), &before).unwrap();
    let outcome = run.done();
    let text = outcome.results().text("scene").unwrap();
    for resolved in [checked, text] {
        let again = Run::new(&resolved).done();
        assert_same(&outcome.directory.path().join("scene.h5"), &again.directory.path().join("scene.h5"), 0.0);
    }
    fs::write(directory.join("press.csv"), &after).unwrap();
    let told = ends_with(program(1).current_dir(&directory).args(["run", "scene.toml", "--resume"]), 2);
    assert!(told.contains("phase.0.motion.approach.0: 0.001 there, 0.0011 here"), "{told}");
}

/// The results have the checksums of what was read: of a motion, and of a table of friction. A file that says the same in other bytes is
/// another one, to a run that is to go on and to a sweep.
#[test]
fn the_bytes_of_a_file_are_among_the_inputs() {
    let scene = LAYER.replace("coefficient = 0.2", "coefficient = 'table(\"f.csv\", v)'")
        + "[[phase]]\nname = \"first press\"\nsteps = 4\nmotion = \"press.csv\"\n";
    let [motion, table] = ["time, approach\n1, 1e-3\n", "v, f\n0, 0.2\n1, 0.3\n"].map(str::to_owned);
    let run = with_files(&scene, &[("press.csv", motion.clone()), ("f.csv", table.clone())]);
    let directory = run.directory();
    fs::write(directory.join("sweep.toml"), "scene = \"scene.toml\"\n[vary]\n\"solver.tolerance\" = [1e-9]\n").unwrap();
    let swept = || output_of(program(1).current_dir(&directory).args(["sweep", "sweep.toml"]));
    swept();
    let outcome = run.done();
    let sum = |text: &str| mpjr::checksum::text(text.as_bytes());
    let inputs = format!("friction.coefficient {}\nphase.first press.motion {}\n", sum(&table), sum(&motion));
    assert_eq!(outcome.results().text("inputs").unwrap(), inputs);
    for (file, content, key) in
        [("press.csv", &motion, "phase.first press.motion"), ("f.csv", &table, "friction.coefficient")]
    {
        assert!(swept().contains("1 of 1 case(s) were complete before"));
        fs::write(directory.join(file), content.replace(", ", ",")).unwrap();
        let told = ends_with(program(1).current_dir(&directory).args(["run", "scene.toml", "--resume"]), 2);
        assert!(told.contains(&format!("the file that {key} names is not what it was")), "{told}");
        assert!(!swept().contains("were complete before"), "{file} is another");
        fs::write(directory.join(file), content).unwrap();
        swept();
    }
}

/// Several ranks read it as one does.
#[test]
fn ranks_agree() {
    let scene = LAYER.clone() + "[[phase]]\nsteps = 8\nmotion = \"press.csv\"\n";
    let files = [("press.csv", "time, normal_force, sliding\n1, 0.5, 0\n2, 0.4, 0.03\n".to_owned())];
    let [alone, together] = [1, 2].map(|ranks| with_files(&scene, &files).ranks(ranks).done());
    let file = |run: &Outcome| run.directory.path().join("scene.h5");
    assert_same(&file(&alone), &file(&together), 1e-9);
}
