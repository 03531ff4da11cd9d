//! The command line as it is documented: exit codes 0, 2, 3, 4; one message, on standard error, once for
//! all ranks; nothing written where nothing should be; no panic and no library's stack trace.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::Path;
use std::process::Command;

use common::mpi::mpirun;
use common::program::{MPJR, Outcome, Run, assert_same, errors, mpjr, names, program};

const SLIDING: &str = include_str!("scenes/sliding.toml");

/// A run of 8 x 8 cells and a few steps.
fn small() -> Run {
    Run::new(SLIDING).set("layer.cells=[8,8]").set("phase.indent.steps=4").set("phase.slide.steps=4")
}

/// The same, fast enough to be started many times.
fn out(path: &str) -> Run {
    small().argument("--out").argument(path)
}

/// Runs `command` on a scene that must be refused.
fn refused(mut command: Command, scene: &common::bad::BadScene) {
    let directory = tempfile::tempdir().unwrap();
    let output = command.arg(&scene.file).args(&scene.args).current_dir(&directory).output().unwrap();
    let left = names(directory.path());
    let outcome = Outcome::new(output, directory);
    assert_eq!(outcome.code, scene.exit, "{}: {outcome:?}", scene.file.display());
    // What is wrong with the command line itself is not said of the file.
    let file = if scene.message.starts_with("--set") { String::new() } else { format!("{}: ", scene.file.display()) };
    outcome.assert_single_message(&format!("mpjr: {file}{}\n", scene.message));
    assert_eq!((outcome.stdout.as_str(), left.len()), ("", 0), "{}: {left:?}", scene.file.display());
}

#[test]
fn check_refuses_each_bad_scene() {
    for scene in common::bad::bad_scenes() {
        let mut command = Command::new(MPJR);
        command.arg("check");
        refused(command, scene);
    }
}

/// `run` starts MPI before it reads the scene, which takes its time: every fifteenth scene.
#[test]
fn run_refuses_bad_scenes_on_one_rank() {
    for scene in common::bad::bad_scenes().iter().step_by(15) {
        let mut command = Command::new(MPJR);
        command.arg("run");
        refused(command, scene);
    }
}

/// On several ranks there is still one message, and mpirun, which ends all processes as soon as one exits with an
/// error, does not cut it off.
#[test]
fn bad_scenes_are_refused_once_under_mpirun() {
    for (i, scene) in common::bad::bad_scenes().iter().enumerate().skip(3).step_by(12) {
        for (action, ranks) in [("check", 4), ("run", 2)] {
            if action == "check" || i % 24 == 3 {
                let mut command = mpirun(ranks);
                command.args([MPJR, action]);
                refused(command, scene);
            }
        }
    }
}

#[test]
fn a_scene_that_cannot_be_read_is_an_error_of_files() {
    for ranks in [1, 2] {
        for (arguments, message) in [
            (["run", "none.toml"], "mpjr: none.toml: cannot be read: No such file or directory"),
            (["check", "none.toml"], "mpjr: none.toml: cannot be read: No such file or directory"),
            (["check", "/dev"], "mpjr: /dev: cannot be read: Is a directory"),
        ] {
            let outcome = mpjr(ranks, &arguments);
            assert_eq!(outcome.code, 4, "{outcome:?}");
            outcome.assert_single_message(message);
            assert_eq!(names(outcome.directory.path()).len(), 0);
        }
    }
}

/// Also a scene that is not text.
#[test]
fn a_scene_that_is_not_text_is_an_error_of_files() {
    let run = small();
    std::fs::write(run.directory().join("scene.toml"), [0xff, 0xfe, 0x00, 0x41]).unwrap();
    let outcome = run.run();
    assert_eq!(outcome.code, 4);
    outcome.assert_single_message("mpjr: scene.toml: cannot be read: ");
}

#[test]
fn results_that_cannot_be_written_are_an_error_of_files() {
    for ranks in [1, 2] {
        for (target, reason) in [
            ("missing/a.h5", "missing does not exist; create it or name another with --out"),
            (".", ": is a directory; name a file with --out"),
            ("scene.toml", ": exists and was not written by mpjr; remove it or name another file with --out"),
            ("scene.toml/a.h5", "scene.toml is not a directory"),
            ("/proc/a.h5", "mpjr: /proc/a.h5: cannot be created: "),
            ("/dev/full", "mpjr: /dev/full: exists and was not written by mpjr"),
        ] {
            let run = out(target).ranks(ranks);
            let directory = run.directory();
            let before = std::fs::read_to_string(directory.join("scene.toml")).unwrap();
            let outcome = run.run();
            assert_eq!(outcome.code, 4, "{target}: {outcome:?}");
            outcome.assert_single_message(reason);
            assert_eq!(names(&directory), ["scene.toml"], "{target}");
            assert_eq!(std::fs::read_to_string(directory.join("scene.toml")).unwrap(), before);
        }
    }
}

/// An HDF5 file of another program stays; one of this program is replaced, and so is its XDMF file.
#[test]
fn only_own_files_are_replaced() {
    let run = small();
    let foreign = run.directory().join("scene.h5");
    hdf5::File::create(&foreign).unwrap().create_group("theirs").unwrap();
    let before = std::fs::read(&foreign).unwrap();
    let outcome = run.run();
    assert_eq!(outcome.code, 4, "{outcome:?}");
    outcome.assert_single_message("scene.h5: exists and was not written by mpjr");
    assert_eq!(std::fs::read(&foreign).unwrap(), before);

    let first = small().set("output.bulk_at=[\"indent\"]").done();
    assert_eq!(names(first.directory.path()), ["scene.h5", "scene.toml", "scene.xdmf"]);
    assert_eq!(first.history("time").len(), 9);
    let again = Command::new(MPJR)
        .args(["run", "scene.toml", "--set", "layer.cells=[8,8]", "--set", "phase.indent.steps=2"])
        .args(["--set", "phase.slide.steps=1"])
        .current_dir(&first.directory)
        .status();
    assert!(again.unwrap().success());
    assert_eq!(first.history("time").len(), 4);
    assert!(!first.results().has("bulk/stress"));
    assert_eq!(names(first.directory.path()), ["scene.h5", "scene.toml"]);
}

/// `--out` names the file; `--set` changes keys, the last one wins, and the file tells the scene as it was run.
#[test]
fn out_and_set() {
    let run = out("sub/name.h5").set("phase.indent.steps=3").set("title=\"another\"");
    std::fs::create_dir(run.directory().join("sub")).unwrap();
    let outcome = run.done();
    let results = mpjr::output::reader::Results::open(&outcome.directory.path().join("sub/name.h5")).unwrap();
    assert_eq!(results.history("time").unwrap().len(), 1 + 3 + 4);
    assert_eq!(results.text("title").unwrap(), "another");
    assert_eq!(results.text("status").unwrap(), "complete");
    assert_eq!(results.phase_names().unwrap(), ["indent", "slide"]);
    let scene: toml::Table = results.text("scene").unwrap().parse().unwrap();
    assert_eq!(scene["phase"][0]["steps"].as_integer(), Some(3));
    assert_eq!(scene["layer"]["cells"][1].as_integer(), Some(8));
    assert!(outcome.stdout.contains("results:       sub/name.h5"), "{}", outcome.stdout);
    assert_eq!(errors(&outcome.stderr), "");
    // The resolved scene runs as it stands and gives the same.
    let again = Run::new(&results.text("scene").unwrap()).done();
    assert_eq!(again.history("normal_force"), results.history("normal_force").unwrap());
}

#[test]
fn wrong_command_lines() {
    for (arguments, word) in [
        (vec!["frobnicate"], "frobnicate"),
        (vec!["run"], "<SCENE>"),
        (vec!["run", "scene.toml", "--frob"], "--frob"),
        (vec!["run", "scene.toml", "--out"], "--out"),
        (vec!["run", "a.toml", "b.toml"], "b.toml"),
        (vec![], "Usage"),
    ] {
        for ranks in [1, 2] {
            let outcome = mpjr(ranks, &arguments);
            assert_eq!(outcome.code, 2, "{arguments:?}: {outcome:?}");
            assert!(outcome.stderr.contains(word), "{outcome:?}");
            let once = if arguments.is_empty() { "Usage: " } else { "error: " };
            assert_eq!(outcome.stderr.matches(once).count(), 1, "{outcome:?}");
            assert_eq!((outcome.stdout.as_str(), names(outcome.directory.path()).len()), ("", 0));
            outcome.assert_clean();
        }
    }
}

#[test]
fn help_and_version() {
    for ranks in [1, 2] {
        let version = mpjr(ranks, &["--version"]);
        assert_eq!((version.code, version.stdout.as_str()), (0, concat!("mpjr ", env!("CARGO_PKG_VERSION"), "\n")));
        for arguments in [vec!["--help"], vec!["help", "run"], vec!["run", "--help"], vec!["check", "-h"]] {
            let help = mpjr(ranks, &arguments);
            assert_eq!((help.code, help.stderr.as_str()), (0, ""), "{help:?}");
            assert_eq!(help.stdout.matches("Usage:").count(), 1, "{help:?}");
            assert!(!help.stdout.contains('\u{1b}'), "{help:?}");
        }
    }
}

/// `check` prints the resolved scene, which is a scene, and writes nothing.
#[test]
fn check_prints_the_resolved_scene() {
    let run = small();
    for ranks in [1, 3] {
        let mut command = program(ranks);
        let output = command.args(["check", "scene.toml", "--set", "layer.cells=[4,6]"]).current_dir(run.directory());
        let text = String::from_utf8(output.output().unwrap().stdout).unwrap();
        // All but the scene is comments.
        let resolved: toml::Table = text.parse().unwrap();
        assert_eq!(resolved["layer"]["cells"][1].as_integer(), Some(6));
        assert_eq!(text.matches("modelled:  ").count(), 2, "once each, said and not said: {text}");
        assert_eq!(names(&run.directory()), ["scene.toml"]);
    }
}

/// A solver that is allowed one Newton iteration cannot follow strong friction that begins to slip: after the stated number of cuts the
/// run ends with code 3, and the file holds what was accepted: rows of finite numbers, ever later, each of them a
/// converged state (the force of a shorter run that ends at the same time).
#[test]
fn no_convergence_keeps_what_was_accepted() {
    for ranks in [1, 2] {
        let strong = || Run::new(SLIDING).set("layer.cells=[8,8]").set("friction.coefficient=5.0");
        let outcome = strong().petsc("-snes_max_it 1").ranks(ranks).run();
        assert_eq!(outcome.code, 3, "{outcome:?}");
        outcome.assert_single_message(": no convergence in the step to t = ");
        assert!(outcome.stderr.contains("mpjr: scene.toml: phase \""), "{}", outcome.stderr);
        assert!(outcome.stderr.contains("; scene.h5 holds the results up to there"), "{}", outcome.stderr);
        assert!(outcome.stdout.contains("status:        not converged at t = "), "{}", outcome.stdout);
        let results = outcome.results();
        assert_eq!(results.text("status").unwrap(), "not converged");
        let (time, force) = (outcome.history("time"), outcome.history("normal_force"));
        assert!(time.len() > 5 && time.windows(2).all(|pair| pair[0] < pair[1]), "{time:?}");
        assert!(force[..50].windows(2).skip(1).all(|pair| pair[0] < pair[1]), "{force:?}");
        assert_eq!(results.interface("time").unwrap().rows, results.interface("pressure").unwrap().rows);
        // Steps of a multiple of 0.2 s are planned ones, here taken in one iteration each.
        let reference = strong().set("phase.slide.steps=1").done();
        assert!((outcome.at(2.4, "normal_force") / reference.at(2.4, "normal_force") - 1.0).abs() < 1e-9);
    }
}

/// PETSc options after `--` reach PETSc; one that nothing asked for is told.
#[test]
fn petsc_options() {
    let quiet = small().set("solver.strategy=\"monolithic\"").done();
    let unused = "PETSc option was never asked for";
    assert!(!quiet.stdout.contains("SNES Function norm") && !quiet.stderr.contains(unused), "{quiet:?}");
    let outcome = small().set("solver.strategy=\"monolithic\"").petsc("-snes_monitor -frobnicate 3").done();
    assert!(outcome.stdout.contains("0 SNES Function norm"), "{}", outcome.stdout);
    assert!(
        outcome.stderr.contains("warning: -frobnicate: this PETSc option was never asked for"),
        "{}",
        outcome.stderr
    );
    assert_eq!(outcome.stderr.matches(unused).count(), 1);
    assert_eq!(outcome.history("normal_force"), quiet.history("normal_force"));
}

/// A reader that goes away, as `head` does, changes nothing but what is printed: the exit code is 0 and the results are
/// those of any other run. A disk that is full is an error of files, told once, after the results.
#[test]
fn standard_output_that_takes_no_more() {
    let whole = small().done();
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("scene.toml"), SLIDING).unwrap();
    let sweep = "scene = \"scene.toml\"\n[vary]\n\"layer.cells\" = [[4, 4], [8, 8]]\n";
    std::fs::write(directory.path().join("sweep.toml"), sweep).unwrap();
    for command in [
        "check scene.toml",
        "--help",
        "run scene.toml --set layer.cells=[8,8] --set phase.indent.steps=4 --set phase.slide.steps=4",
        "run scene.toml --resume --set layer.cells=[8,8] --set phase.indent.steps=4 --set phase.slide.steps=4",
        "plot scene.h5 --out figures",
        "sweep sweep.toml --list",
        "sweep sweep.toml --slurm",
        "sweep sweep.toml",
        "fit --fractional 814.7,0.226 --arms 1 --samples 10 --from 0.1 --to 10",
        "study scene.toml --vary layer.cells=[4,4],[8,8] --set phase.indent.steps=4 --set phase.slide.steps=4",
        "verify --quick --only mirror",
    ] {
        let run = |stdout: std::process::Stdio| {
            let mut run = program(1);
            run.args(command.split(' ')).current_dir(&directory).stdout(stdout).output().unwrap()
        };
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let unread = run(writer.into());
        let text = errors(&String::from_utf8_lossy(&unread.stderr));
        assert_eq!((unread.status.code(), text.as_str()), (Some(0), ""), "{command}");
        if command == "--help" {
            continue;
        }
        let full = run(std::fs::File::create("/dev/full").unwrap().into());
        let message = "mpjr: standard output: cannot be written: No space left on device (os error 28)\n";
        let text = errors(&String::from_utf8_lossy(&full.stderr));
        assert_eq!((full.status.code(), text.as_str()), (Some(4), message), "{command}");
    }
    // Nor does standard error that nobody reads change the exit code.
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let status = program(1).args(["run", "none.toml"]).current_dir(&directory).stderr(writer).status();
    assert_eq!(status.unwrap().code(), Some(4));
    assert_same(&whole.directory.path().join("scene.h5"), &directory.path().join("scene.h5"), 0.0);
    for written in ["figures", "sweep/summary.csv", "scene-study/study.toml"] {
        assert!(directory.path().join(written).exists(), "{written}");
    }
}

/// Words after `--` that are no options, and values that PETSc does not take, are errors of the command line, found
/// before anything is written.
#[test]
fn wrong_petsc_options() {
    for (options, words) in [
        ("-ksp_type frob", "KSP type frob"),
        ("-pc_type lu -pc_factor_mat_solver_type frob", "solver type frob"),
        ("-snes_max_it many", "many has no integer value"),
        ("ksp_type gmres", "\"ksp_type\" after -- is neither a PETSc option"),
        ("-ksp_rtol 1e-3 1e-4", "\"1e-4\" after --"),
    ] {
        for ranks in [1, 2] {
            let outcome = small().set("solver.strategy=\"monolithic\"").petsc(options).ranks(ranks).run();
            assert_eq!(outcome.code, 2, "{options}: {outcome:?}");
            outcome.assert_single_message(words);
            assert_eq!((outcome.stdout.as_str(), names(outcome.directory.path())), ("", vec!["scene.toml".to_owned()]));
        }
    }
    small().set("solver.strategy=\"monolithic\"").petsc("-ksp_type gmres -ksp_rtol 1e-10").done();
}

/// The directory that a scene is in is left alone; the default result is the scene's stem in the current directory.
#[test]
fn default_output_is_in_the_current_directory() {
    let run = small();
    let elsewhere = tempfile::tempdir().unwrap();
    let scene = run.directory().join("scene.toml");
    let mut command = Command::new(MPJR);
    command.arg("run").arg(&scene).args(["--set", "layer.cells=[4,4]"]).current_dir(&elsewhere);
    assert!(command.output().unwrap().status.success());
    assert_eq!(names(elsewhere.path()), ["scene.h5"]);
    assert_eq!(names(Path::new(&run.directory())), ["scene.toml"]);
}

/// A pipe that nobody writes to would never open, and `/dev/zero` would never end.
#[test]
fn what_is_no_regular_file_is_refused_as_such() {
    let directory = tempfile::tempdir().unwrap();
    let pipe = directory.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let pipe = pipe.to_str().unwrap();
    for (file, what) in [(pipe, "a pipe"), ("/dev/zero", "a device")] {
        for arguments in
            [vec!["check", file], vec!["fit", file, "--modulus", "shear"], vec!["plot", file], vec!["sweep", file]]
        {
            let outcome = mpjr(1, &arguments);
            assert_eq!(outcome.code, 4, "{arguments:?} {}", outcome.stderr);
            outcome.assert_single_message(&format!("{file}: cannot be read: it is {what}, not a regular file"));
        }
    }
}

/// Processes that a launcher started together, but that MPI sees each alone, would all solve everything into one file.
#[test]
fn processes_that_are_each_alone_are_refused() {
    for (name, launcher) in
        [("SLURM_NTASKS", "Slurm has 2"), ("SLURM_STEP_NUM_TASKS", "Slurm's srun has 2"), ("PMI_SIZE", "(PMI) has 2")]
    {
        let run = small();
        let outcome = Outcome::new(run.command().env(name, "2").output().unwrap(), tempfile::tempdir().unwrap());
        assert_eq!((outcome.code, names(&run.directory())), (2, vec!["scene.toml".to_owned()]), "{outcome:?}");
        outcome.assert_single_message(launcher);
    }
    // One process on purpose.
    let run = small();
    let mut alone = mpirun(1);
    alone.arg(MPJR).args(run.command().get_args()).current_dir(run.directory()).env("SLURM_NTASKS", "2");
    assert!(alone.output().unwrap().status.success());
}

/// Memory is asked for before it is taken: libraries that get none crash, or try for ever.
#[test]
fn too_little_memory_is_said() {
    for (limit, cells) in [(300_000, "[8,8]"), (900_000, "[1000,1000]")] {
        let run = Run::new(SLIDING).set(format!("layer.cells={cells}")).set("layer.sides=free");
        let directory = run.directory();
        let arguments: Vec<String> =
            run.command().get_args().map(|word| format!("'{}'", word.to_string_lossy())).collect();
        let line = format!("ulimit -v {limit}; exec {MPJR} {}", arguments.join(" "));
        let output =
            Command::new("timeout").args(["-s", "KILL", "60", "sh", "-c", &line]).current_dir(&directory).output();
        let outcome = Outcome::new(output.unwrap(), tempfile::tempdir().unwrap());
        assert_eq!(outcome.code, 2, "{limit}: {outcome:?}");
        outcome.assert_single_message("the limit of this process (ulimit -v) leaves");
        assert_eq!(names(&directory), ["scene.toml"]);
    }
}

/// `check` takes time in proportion to the length of the scene: quadratic, each of these would take minutes.
#[test]
fn long_scenes_are_checked_in_time() {
    let list = |count: usize, item: &dyn Fn(usize) -> String| (0..count).map(item).collect::<Vec<_>>().join(", ");
    let arms = list(100_000, &|i| format!("{{ weight = 9e-6, time = {:e} }}", 1e-3 * 1.0001_f64.powi(i as i32)));
    let times = list(1_000_000, &|i| format!("{:?}", 1e-5 * (i + 1) as f64));
    let head = SLIDING.split("[[phase]]").next().unwrap();
    let phases: String =
        (0..100_000).map(|i| format!("[[phase]]\nname = \"p{i}\"\nduration = 1.0\nsteps = 1\n")).collect();
    let ends = list(100_000, &|i| format!("\"p{i}\""));
    for scene in [
        SLIDING.replace("arms = [ { weight = 0.579, time = 0.817 } ]", &format!("arms = [{arms}]")),
        format!("{SLIDING}\n[output]\nbulk_at = [{times}]\n"),
        format!("{head}{phases}\n[output]\nbulk_at = [{ends}]\n"),
    ] {
        let directory = tempfile::tempdir().unwrap();
        std::fs::write(directory.path().join("scene.toml"), scene).unwrap();
        let begun = std::time::Instant::now();
        let output = Command::new("timeout").args(["60", MPJR, "check", "scene.toml"]).current_dir(&directory).output();
        let output = output.unwrap();
        assert!(output.status.success(), "{:?} {}", begun.elapsed(), String::from_utf8_lossy(&output.stderr));
    }
}
