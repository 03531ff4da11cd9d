//! A run that is killed: its file opens at any moment and holds consistent rows, those of an undisturbed run, and no
//! more than the last 2 s of them are lost.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::process::Stdio;
use std::time::{Duration, Instant};

use common::program::{Run, names};
use mpjr::output::reader::Results;

/// A run of very many short steps, with interface and bulk fields; it would take minutes.
fn endless() -> Run {
    Run::new(include_str!("scenes/sliding.toml"))
        .set("layer.cells=[8,4]")
        .set("phase.indent.steps=3000")
        .set("phase.slide.steps=100000")
        .set("output.bulk_at=[0.5, 1.0, 2.0, 3.0, 5.0, \"indent\"]")
}

/// Whether the file has rows that fit together: as many in each column, times that rise, finite forces; interface rows
/// one per step. Gives the number of rows.
fn consistent(results: &Results) -> usize {
    let time = results.history("time").unwrap();
    assert!(!time.is_empty() && time[0] == 0.0);
    assert!(time.windows(2).all(|pair| pair[0] < pair[1]), "{time:?}");
    for column in ["approach", "sliding", "normal_force", "tangential_force", "hysteretic_force", "newton_iterations"] {
        let values = results.history(column).unwrap();
        assert_eq!(values.len(), time.len(), "{column}");
        assert!(values.iter().all(|value| value.is_finite()), "{column}");
    }
    let face = results.interface("x").unwrap().rows;
    let stored = results.interface("time").unwrap().rows;
    // Each step has its profile; row 0 of the history is the unloaded state.
    assert_eq!(stored + 1, time.len());
    for field in ["pressure", "shear", "gap", "slip_rate", "displacement_x", "displacement_z"] {
        let field = results.interface(field).unwrap();
        assert_eq!((field.rows, field.columns, field.values.len()), (stored, face, stored * face));
    }
    let frames = results.bulk("time").unwrap().rows;
    assert_eq!(results.bulk("stress").unwrap().rows, frames);
    assert_eq!(results.bulk("displacement").unwrap().rows, frames);
    time.len()
}

/// Killed at many moments on one rank, from before the file exists to well within the run.
#[test]
fn killed_at_any_moment() {
    // What the rows must be: the same run as far as it goes.
    let whole = endless().set("phase.slide.steps=1").done();
    let (time, force) = (whole.history("time"), whole.history("normal_force"));
    let mut most = 0;
    for i in 0..14 {
        let run = endless();
        let mut child = run.command().stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        // Moments with no common measure with the second between two writes.
        std::thread::sleep(Duration::from_millis(40 + 97 * i + 13 * (i * i) % 71));
        child.kill().unwrap();
        child.wait().unwrap();
        let path = run.directory().join("scene.h5");
        if !path.exists() {
            continue;
        }
        let results = Results::open(&path).unwrap();
        assert_eq!(results.text("status").unwrap(), "stopped");
        let rows = consistent(&results);
        most = most.max(rows);
        let known = rows.min(time.len() - 1);
        assert_eq!(results.history("time").unwrap()[..known], time[..known]);
        assert_eq!(results.history("normal_force").unwrap()[..known], force[..known]);
    }
    assert!(most > 100, "only {most} rows in the longest");
}

/// The rows lost are those of the last 2 s: the file of a run killed after a while holds a row that was computed less
/// than 2 s before. `wall_seconds` is the time of the last write.
#[test]
fn at_most_two_seconds_are_lost() {
    let run = endless();
    let mut child = run.command().stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let path = run.directory().join("scene.h5");
    let begun = Instant::now();
    while !path.exists() && begun.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let created = Instant::now();
    std::thread::sleep(Duration::from_millis(3700));
    child.kill().unwrap();
    child.wait().unwrap();
    let alive = created.elapsed().as_secs_f64();
    let results = Results::open(&path).unwrap();
    consistent(&results);
    let written = results.number("wall_seconds").unwrap();
    assert!(
        written > alive - 2.0,
        "last written {written} s after the start, killed {alive} s after the file was made"
    );
}

/// A reader can open the file while the run is going on; under mpirun too, where all ranks are killed at once.
#[test]
fn readable_while_running_and_after_mpirun_is_killed() {
    let run = endless().ranks(2);
    let mut child = run.command().stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let (path, copy) = (run.directory().join("scene.h5"), run.directory().join("copy.h5"));
    let (begun, mut seen) = (Instant::now(), Vec::new());
    while seen.last() <= seen.first() && begun.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(130));
        if path.exists() {
            // Opened in place, tables read one after the other may be from before and after a flush: only a copy, whose
            // extents were read at one moment, can be held to the same number of rows in all of them.
            assert_eq!(Results::open(&path).unwrap().text("status").unwrap(), "stopped");
            std::fs::copy(&path, &copy).unwrap();
            seen.push(consistent(&Results::open(&copy).unwrap()));
        }
    }
    // mpirun ends its processes when it is told to end.
    child.kill().unwrap();
    child.wait().unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    assert!(seen.windows(2).all(|pair| pair[0] <= pair[1]), "{seen:?}");
    assert!(seen.last() > seen.first(), "{seen:?}");
    consistent(&Results::open(&path).unwrap());
    assert!(names(&run.directory()).iter().all(|name| !name.ends_with(".part")), "{:?}", names(&run.directory()));
}
