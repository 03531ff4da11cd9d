//! The file of results as it is documented: names, shapes, types, attributes, and what is refused.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::Path;

use common::sample::{self, FACE};
use hdf5::types::{FloatSize, IntSize, TypeDescriptor, VarLenUnicode};
use mpjr::error::Error;
use mpjr::output::{FacePlan, HistoryRow, Plan, Recorder, Status, reader::Results};

fn record(path: &Path, planned: usize, rows: usize) {
    let recorder =
        Recorder::create(path, &sample::metadata(), sample::plan(planned, 2), &HistoryRow::default()).unwrap();
    for i in 1..rows {
        recorder.history(sample::row(i)).unwrap();
        if i % 2 == 0 {
            recorder.interface(sample::frame(i, FACE)).unwrap();
        }
        if i % 3 == 0 {
            recorder.flush().unwrap();
        }
    }
    recorder.finish(Status::Complete).unwrap();
}

fn string(object: &hdf5::Location, name: &str) -> String {
    object.attr(name).unwrap().read_scalar::<VarLenUnicode>().unwrap().to_string()
}

/// Reads everything back and compares it with the sample.
fn check_rows(path: &Path, rows: usize) {
    let results = Results::open(path).unwrap();
    let time = results.history("time").unwrap();
    assert_eq!(time, (0..rows).map(|i| i as f64).collect::<Vec<_>>());
    for (name, factor) in sample::COLUMNS {
        assert_eq!(results.history(name).unwrap(), time.iter().map(|t| factor * t).collect::<Vec<_>>(), "{name}");
    }
    assert_eq!(results.history("phase").unwrap(), time.iter().map(|t| t % 2.0).collect::<Vec<_>>());
    let stored: Vec<usize> = (1..rows).filter(|i| i % 2 == 0).collect();
    for (f, name) in sample::FIELDS.iter().enumerate() {
        let field = results.interface(name).unwrap();
        assert_eq!((field.rows, field.columns), (stored.len(), FACE));
        for (k, i) in stored.iter().enumerate() {
            let expected: Vec<f64> = (0..FACE).map(|node| (1000 * (f + 1) * i + node) as f64).collect();
            assert_eq!(field.row(k), expected, "{name}");
        }
    }
}

#[test]
fn rows_come_back_as_they_were_given() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.h5");
    record(&path, 20, 20);
    check_rows(&path, 20);
    let results = Results::open(&path).unwrap();
    assert_eq!(results.text("status").unwrap(), "complete");
    assert_eq!(results.phase_names().unwrap(), ["indent", "slide"]);
    assert!(results.number("wall_seconds").unwrap() > 0.0);
    // Nothing else is left in the directory.
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
}

#[test]
fn more_rows_than_planned_are_kept() {
    let directory = tempfile::tempdir().unwrap();
    for planned in [0, 1, 2, 7] {
        let path = directory.path().join(format!("{planned}.h5"));
        record(&path, planned, 50);
        check_rows(&path, 50);
        let file = hdf5::File::open(&path).unwrap();
        assert_eq!(string(&file, "status"), "complete");
        assert_eq!(string(&file, "scene"), sample::metadata().scene);
    }
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 4);
}

#[test]
fn layout_is_that_of_the_contract() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.h5");
    record(&path, 10, 10);
    let file = hdf5::File::open(&path).unwrap();
    let metadata = sample::metadata();
    for (name, value) in [
        ("title", metadata.title.as_str()),
        ("scene", &metadata.scene),
        ("mpjr_version", "0.1.0"),
        ("git_commit", "abcdef"),
        ("petsc_version", "3.18.5"),
        ("units", "SI"),
        ("status", "complete"),
    ] {
        assert_eq!(string(&file, name), value, "{name}");
    }
    assert!(string(&file, "started").ends_with('Z'));
    assert_eq!(file.attr("mpi_ranks").unwrap().read_scalar::<i64>().unwrap(), 3);

    let float = TypeDescriptor::Float(FloatSize::U8);
    let integer = TypeDescriptor::Integer(IntSize::U8);
    let mut expected: Vec<(String, Vec<usize>, TypeDescriptor, &str)> = Vec::new();
    for (names, units) in [
        ("time", "s"),
        ("approach sliding max_penetration stuck_slip mount_normal mount_tangential", "m"),
        ("normal_force tangential_force hysteretic_force", "N/m"),
        ("contact_fraction stick_fraction traction_oscillation", "1"),
        ("energy/external_work energy/stored energy/viscoelastic_dissipation energy/friction_dissipation", "J/m"),
        ("max_temperature mean_temperature", "K"),
        ("energy/heat energy/heat_stored energy/heat_convected energy/heat_conducted", "J/m"),
        ("energy/penalty energy/mount_spring energy/mount_dashpot energy/kinetic energy/imbalance", "J/m"),
        ("energy/wear energy/adhesion energy/jumps", "J/m"),
        ("worn_volume", "m^2"),
    ] {
        expected.extend(names.split(' ').map(|name| (format!("/history/{name}"), vec![10], float.clone(), units)));
    }
    for name in ["phase", "newton_iterations"] {
        expected.push((format!("/history/{name}"), vec![10], integer.clone(), "1"));
    }
    expected.push(("/interface/x".into(), vec![FACE], float.clone(), "m"));
    expected.push(("/interface/time".into(), vec![4], float.clone(), "s"));
    for (name, units) in sample::FIELDS.iter().zip(["Pa", "Pa", "m", "m/s", "m", "m", "m", "m", "K", "W/m^2"]) {
        expected.push((format!("/interface/{name}"), vec![4, FACE], float.clone(), units));
    }
    expected.push(("/bulk/coordinates".into(), vec![35, 2], float.clone(), "m"));
    expected.push(("/bulk/cells".into(), vec![24, 4], integer.clone(), "1"));
    for (name, length) in [("node", 35), ("cell", 24), ("corner", 4)] {
        expected.push((format!("/bulk/{name}"), vec![length], integer.clone(), "1"));
    }
    for (name, length) in [("axis", 2), ("component", 4)] {
        expected.push((format!("/bulk/{name}"), vec![length], TypeDescriptor::VarLenUnicode, "1"));
    }
    expected.push(("/bulk/time".into(), vec![0], float.clone(), "s"));
    expected.push(("/bulk/displacement".into(), vec![0, 35, 2], float.clone(), "m"));
    expected.push(("/bulk/stress".into(), vec![0, 35, 4], float.clone(), "Pa"));
    expected.push(("/bulk/temperature".into(), vec![0, 35], float, "K"));

    let mut found = Vec::new();
    for group in ["history", "history/energy", "interface", "bulk"] {
        for set in file.group(group).unwrap().datasets().unwrap() {
            assert!(!string(&set, "long_name").is_empty(), "{}", set.name());
            found.push((set.name(), set.shape(), set.dtype().unwrap().to_descriptor().unwrap(), string(&set, "units")));
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    expected.sort_by(|a, b| a.0.cmp(&b.0));
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!(
            (&found.0, &found.1, &found.2, found.3.as_str()),
            (&expected.0, &expected.1, &expected.2, expected.3)
        );
    }
    let names = file.dataset("history/phase").unwrap().attr("names").unwrap().read_raw::<VarLenUnicode>().unwrap();
    assert_eq!(names.iter().map(|name| name.as_str()).collect::<Vec<_>>(), ["indent", "slide"]);
    let components = file.dataset("bulk/stress").unwrap().attr("components").unwrap();
    let components = components.read_raw::<VarLenUnicode>().unwrap();
    assert_eq!(components.iter().map(|name| name.as_str()).collect::<Vec<_>>(), ["xx", "zz", "yy", "xz"]);
}

/// A packed file has the rows, the attributes and the shapes of the file that it replaces; its fields are compressed, and
/// take less than half the room: each is the number of the node and a constant of the row.
#[test]
fn a_packed_file_has_the_same_content() {
    const WIDE: usize = 20_000;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.h5");
    // Compression may take 5 % of a run; this one claims to have begun a minute ago.
    let started = std::time::SystemTime::now() - std::time::Duration::from_secs(60);
    let metadata = mpjr::output::Metadata { started, ..sample::metadata() };
    let plan = Plan { face: FacePlan::along_x((0..WIDE).map(|node| node as f64).collect()), ..sample::plan(20, 1) };
    let recorder = Recorder::create(&path, &metadata, plan, &HistoryRow::default()).unwrap();
    for i in 1..10 {
        recorder.history(sample::row(i)).unwrap();
        recorder.interface(sample::frame(i, WIDE)).unwrap();
    }
    recorder.finish_packed().unwrap();

    let results = Results::open(&path).unwrap();
    let file = hdf5::File::open(&path).unwrap();
    assert_eq!(string(&file, "status"), "complete");
    assert_eq!(string(&file, "scene"), metadata.scene);
    assert_eq!(results.phase_names().unwrap(), ["indent", "slide"]);
    for (name, factor) in sample::COLUMNS {
        assert_eq!(results.history(name).unwrap(), (0..10).map(|i| factor * i as f64).collect::<Vec<_>>(), "{name}");
    }
    for (f, name) in sample::FIELDS.iter().enumerate() {
        let field = results.interface(name).unwrap();
        assert_eq!((field.rows, field.columns), (9, WIDE), "{name}");
        for row in 0..9 {
            let expected = (0..WIDE).map(|node| (1000 * (f + 1) * (row + 1) + node) as f64);
            assert!(expected.eq(field.row(row).iter().copied()), "{name}, row {row}");
        }
        let set = file.dataset(&format!("interface/{name}")).unwrap();
        assert_eq!(set.filters().len(), 2, "shuffle and deflate");
        assert!(set.storage_size() < (9 * WIDE * 8 / 2) as u64, "{name}: {} bytes", set.storage_size());
    }
    assert_eq!(file.dataset("bulk/stress").unwrap().shape(), [0, 35, 4]);
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
}

#[test]
fn a_run_that_is_not_finished_is_labelled_stopped_and_has_row_0() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.h5");
    let mut plan = sample::plan(10, 0);
    plan.extra.energy = false;
    let recorder = Recorder::create(&path, &sample::metadata(), plan, &HistoryRow::default()).unwrap();
    let results = Results::open(&path).unwrap();
    assert_eq!(results.history("time").unwrap(), [0.0]);
    assert_eq!(results.interface("pressure").unwrap().rows, 0);
    assert_eq!(results.text("status").unwrap(), "stopped");
    assert!(!results.has("history/energy/stored") && !results.has("bulk/stress"));
    let message = results.history("energy/stored").unwrap_err().to_string();
    assert!(message.contains("/history/energy/stored"), "{message}");
    drop(results);
    // Rows handed over are written when the recorder goes, and the label stays.
    recorder.history(sample::row(1)).unwrap();
    drop(recorder);
    let results = Results::open(&path).unwrap();
    assert_eq!(results.history("time").unwrap(), [0.0, 1.0]);
    assert_eq!(results.text("status").unwrap(), "stopped");
}

#[test]
fn rows_reach_the_file_within_two_seconds_without_any_call() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.h5");
    let recorder = Recorder::create(&path, &sample::metadata(), sample::plan(10, 0), &HistoryRow::default()).unwrap();
    recorder.history(sample::row(1)).unwrap();
    std::thread::sleep(std::time::Duration::from_secs(2));
    assert_eq!(Results::open(&path).unwrap().history("time").unwrap(), [0.0, 1.0]);
}

#[test]
fn only_own_files_are_replaced() {
    let directory = tempfile::tempdir().unwrap();
    let create = |name: &str| {
        let path = directory.path().join(name);
        Recorder::create(&path, &sample::metadata(), sample::plan(10, 1), &HistoryRow::default()).map(drop)
    };
    create("own.h5").unwrap();
    create("own.h5").unwrap();

    let text = directory.path().join("text.h5");
    std::fs::write(&text, "notes").unwrap();
    let other = directory.path().join("other.h5");
    hdf5::File::create(&other).unwrap().close().unwrap();
    std::fs::write(directory.path().join("taken.xdmf"), "<Xdmf/>").unwrap();
    std::fs::create_dir(directory.path().join("directory.h5")).unwrap();
    for (name, word) in [
        ("text.h5", "not written by mpjr"),
        ("other.h5", "not written by mpjr"),
        ("taken.h5", "taken.xdmf: exists and was not written by mpjr"),
        ("directory.h5", "is a directory"),
        ("missing/run.h5", "does not exist"),
        ("text.h5/run.h5", "ot a directory"),
        ("run.xdmf", "XDMF"),
    ] {
        let error = create(name).unwrap_err();
        assert_eq!(error.exit_code(), 4);
        assert!(error.to_string().contains(word), "{name}: {error}");
    }
    assert_eq!(std::fs::read(&text).unwrap(), b"notes");
    assert!(hdf5::File::open(&other).is_ok());
    let left = std::fs::read_dir(directory.path()).unwrap().map(|entry| entry.unwrap().file_name());
    assert!(left.into_iter().all(|name| !name.to_string_lossy().contains("part")));
    // A place where nobody may create files, root included.
    assert!(matches!(create("/proc/run.h5"), Err(Error::File { .. })));
}

#[test]
fn a_file_replaced_or_removed_meanwhile_is_an_error() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.h5");
    let create = || Recorder::create(&path, &sample::metadata(), sample::plan(10, 0), &HistoryRow::default()).unwrap();
    let first = create();
    let second = create();
    first.history(sample::row(1)).unwrap();
    let error = first.flush().unwrap_err();
    assert!(error.to_string().contains("replaced"), "{error}");
    second.history(sample::row(1)).unwrap();
    second.flush().unwrap();
    assert_eq!(Results::open(&path).unwrap().history("time").unwrap(), [0.0, 1.0]);
    std::fs::remove_file(&path).unwrap();
    second.history(sample::row(2)).unwrap();
    assert_eq!(second.flush().unwrap_err().exit_code(), 4);
}

#[test]
fn readers_are_told_what_is_wrong_with_a_file() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.h5");
    assert!(Results::open(&path).unwrap_err().to_string().contains("No such file"));
    std::fs::write(&path, "text").unwrap();
    assert!(Results::open(&path).unwrap_err().to_string().contains("not an HDF5 file"));
    hdf5::File::create(&path).unwrap().close().unwrap();
    assert!(Results::open(&path).unwrap_err().to_string().contains("not one that mpjr wrote"));
}

#[test]
fn a_file_can_be_read_by_many_while_it_grows() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.h5");
    let recorder = Recorder::create(&path, &sample::metadata(), sample::plan(4, 0), &HistoryRow::default()).unwrap();
    let held = Results::open(&path).unwrap();
    for i in 1..20 {
        recorder.history(sample::row(i)).unwrap();
        recorder.flush().unwrap();
    }
    assert_eq!(held.text("status").unwrap(), "stopped");
    drop(held);
    assert_eq!(Results::open(&path).unwrap().history("time").unwrap().len(), 20);
}

#[test]
fn an_interface_row_of_the_wrong_length_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("run.h5");
    let recorder = Recorder::create(&path, &sample::metadata(), sample::plan(4, 0), &HistoryRow::default()).unwrap();
    assert!(recorder.interface(sample::frame(1, FACE + 1)).is_err());
}
