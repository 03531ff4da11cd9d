//! Nothing that this program did not write is removed or replaced, under whatever name it uses; what a process of it that
//! was killed left half written is removed by the next.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::Path;

use common::program::{Run, ends_with, names, output_of, program};

const SLIDING: &str = include_str!("scenes/sliding.toml");

/// Two steps on 8 x 8 cells, with an XDMF file.
fn small() -> Run {
    let run = Run::new(SLIDING).set("layer.cells=[8,8]").set("phase.indent.steps=1").set("phase.slide.steps=1");
    run.set("output.bulk_at=[\"slide\"]")
}

#[test]
fn foreign_files_beside_results_stay() {
    for foreign in ["out.h5", "out.xdmf", "out.h5.checkpoint"] {
        for text in ["mine", "", "\u{0}\u{0}\u{0}\u{0}\u{0}\u{0}\u{0}\u{0}"] {
            let run = small().argument("--out").argument("out.h5");
            let file = run.directory().join(foreign);
            std::fs::write(&file, text).unwrap();
            let outcome = run.run();
            assert_eq!(outcome.code, 4, "{foreign}: {outcome:?}");
            outcome.assert_single_message(&format!("/{foreign}: exists and was not written by mpjr"));
            assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
            assert_eq!(names(outcome.directory.path()).len(), 2);
        }
    }
    // Names that this program keeps for its other files, which a later run would take for those.
    for name in ["out.h5.checkpoint", "out.xdmf", "out.h5.mpjr-1.part"] {
        let outcome = small().argument("--out").argument(name).run();
        assert_eq!(outcome.code, 4, "{name}: {outcome:?}");
        outcome.assert_single_message("; end the name of the results in .h5");
    }
    // Its own are replaced.
    let run = small();
    let directory = run.directory();
    let again = || {
        let mut command = program(1);
        command.current_dir(&directory).args(["run", "scene.toml", "--set", "phase.indent.steps=1"]);
        output_of(command.args(["--set", "phase.slide.steps=1", "--set", "output.bulk_at=[\"slide\"]"]));
    };
    again();
    again();
    assert_eq!(names(&directory), ["scene.h5", "scene.toml", "scene.xdmf"]);
}

/// No process can have a number beyond 2^22.
#[test]
fn the_remains_of_killed_processes_are_removed() {
    const GONE: &str = "mpjr-4194305.part";
    let run = small();
    let directory = run.directory();
    let put = |name: &str, bytes: &[u8]| std::fs::write(directory.join(name), bytes).unwrap();
    put(&format!("scene.h5.{GONE}"), b"\x89HDF\r\n\x1a\n and no more");
    put(&format!("scene.h5.checkpoint.{GONE}"), b"mpjr checkpoint 4\n");
    let kept = [
        // Somebody else's, another result's, and that of a process that lives.
        format!("scene.xdmf.{GONE}"),
        format!("other.h5.{GONE}"),
        format!("scene.h5.mpjr-{}.part", std::process::id()),
    ];
    kept.iter().for_each(|name| put(name, if name.contains("xdmf") { b"mine" } else { b"" }));
    let outcome = run.done();
    let left = names(outcome.directory.path());
    let mut expected: Vec<&str> =
        kept.iter().map(String::as_str).chain(["scene.h5", "scene.toml", "scene.xdmf"]).collect();
    expected.sort_unstable();
    assert_eq!(left, expected);
}

#[test]
fn foreign_tables_of_sweeps_and_studies_stay() {
    let directory = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| {
        let file = directory.path().join(name);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, text).unwrap();
    };
    put("scene.toml", SLIDING);
    put("sweep.toml", "scene = \"scene.toml\"\n[vary]\n\"phase.slide.steps\" = [1, 2]\n");
    let stays = |name: &str, command: &[&str]| {
        put(name, "case,of mine\n");
        let message = ends_with(program(1).current_dir(&directory).args(command), 4);
        assert!(message.contains("exists and was not written by mpjr") && message.lines().count() == 1, "{message}");
        assert_eq!(std::fs::read_to_string(directory.path().join(name)).unwrap(), "case,of mine\n");
        let folder = Path::new(name).parent().unwrap();
        assert_eq!(names(&directory.path().join(folder)).len(), 1, "{name}");
    };
    stays("sweep/summary.csv", &["sweep", "sweep.toml"]);
    stays("study/runs.csv", &["study", "scene.toml", "--out", "study"]);
    stays("again/study.toml", &["study", "scene.toml", "--out", "again"]);
}
