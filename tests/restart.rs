//! Runs that are killed, stopped or short of disk go on from their last checkpoint, and end with the same numbers as a
//! run that nothing befell.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use common::msh::write_msh;
use common::program::{assert_same, ends_with, errors, output_of, program, wait_for};
use mpjr::mesh::{Layer, Sides};
use mpjr::output::{checkpoint, reader::Results};

/// Two phases, of which `slide` has `steps`; `material` and `solver` are the rest of their tables.
fn scene(directory: &Path, steps: usize, material: &str, solver: &str) -> PathBuf {
    let text = format!(
        r#"
        title = "restart"
        [layer]
        width = 1.0
        depth = 0.5
        cells = [24, 8]
        sides = "periodic"
        [material]
        shear_modulus = 500.0
        poisson_ratio = 0.3
        {material}
        [indenter]
        profile = "harmonic"
        amplitude = 5e-4
        wavelength = 1.0
        [contact]
        penalty = 1e6
        [friction]
        law = "coulomb_tanh"
        coefficient = "0.15 + 0.05*exp(-s/0.02)"
        regularisation = 1e-3
        [[phase]]
        name = "indent"
        duration = 2.0
        steps = 20
        approach = 1e-3
        [[phase]]
        name = "slide"
        velocity = 0.1
        duration = 3.0
        steps = {steps}
        [solver]
        {solver}
        [output]
        interface_every = 2
        bulk_at = ["indent", 2.31, "slide"]
        checkpoint_every = 3
        "#
    );
    let file = directory.join("scene.toml");
    std::fs::write(&file, text).unwrap();
    file
}

const ARMS: &str = "arms = [{ weight = 0.4, time = 0.8 }, { weight = 0.3, time = 5.0 }]\n";

fn ratio() -> String {
    format!("{ARMS} poisson_rule = \"constant_ratio\"")
}

fn bulk() -> String {
    format!("{ARMS} poisson_rule = \"constant_bulk_modulus\"")
}

fn run(command: &mut Command, scene: &Path, out: &Path) -> Command {
    let mut run = Command::new(command.get_program());
    run.args(command.get_args());
    run.envs(command.get_envs().filter_map(|(key, value)| Some((key, value?))));
    run.arg("run").arg(scene).arg("--out").arg(out);
    run
}

/// Twenty kills at moments that no pattern of the program's can follow.
#[test]
fn nothing_is_lost_by_twenty_kills() {
    // Several times as many steps as twenty runs take before they are killed.
    let forms = [(ratio(), "strategy = \"monolithic\"", 1000), (ratio(), "", 6000), (bulk(), "", 4000)];
    for (material, solver, steps) in forms {
        let directory = tempfile::tempdir().unwrap();
        let scene = scene(directory.path(), steps, &material, solver);
        let (whole, killed) = (directory.path().join("whole.h5"), directory.path().join("killed.h5"));
        output_of(&mut run(&mut program(1), &scene, &whole));
        let mut rows_before = 0;
        for kill in 0..20_u64 {
            let mut command = run(&mut program(1), &scene, &killed);
            if checkpoint::read(&killed).unwrap().is_some() {
                command.arg("--resume");
            }
            let mut child = command.stdout(Stdio::null()).spawn().unwrap();
            let random = kill.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407) >> 40;
            wait_for(&mut child, &killed, (random % 5) as usize);
            std::thread::sleep(Duration::from_micros(random % 10_007));
            assert_eq!(child.try_wait().unwrap(), None, "kill {kill}: ended by itself");
            child.kill().unwrap();
            child.wait().unwrap();
            if !killed.exists() {
                continue;
            }
            let results = Results::open(&killed).unwrap();
            assert_eq!(results.text("status").unwrap(), "stopped");
            let Some(found) = checkpoint::read(&killed).unwrap() else { continue };
            let rows = found.fields.iter().find(|(name, _)| name == "rows").unwrap().1[0] as usize;
            assert!(results.history("time").unwrap().len() >= rows, "kill {kill}: rows are lost");
            println!("kill {kill}: {rows} rows of {steps}");
            assert!(rows >= rows_before, "kill {kill}: the checkpoint went back");
            rows_before = rows;
        }
        assert!(rows_before > 20);
        output_of(run(&mut program(1), &scene, &killed).arg("--resume"));
        assert_same(&whole, &killed, 0.0);
        assert!(!checkpoint::beside(&killed).exists());
        assert_eq!(Results::open(&killed).unwrap().text("status").unwrap(), "complete");
        let left = |end: &str| std::fs::read_to_string(directory.path().join(end)).unwrap();
        assert_eq!(left("whole.xdmf").replace("whole", "killed"), left("killed.xdmf"));
    }
}

/// A signal to one of the processes stops all within a step, with exit code 5; the run ends with the same numbers on
/// as many ranks and on another number. Condensed, the same bits; with all unknowns on two ranks MUMPS adds in an order
/// of its own each time, so that not even two runs that nothing befell have the same last digits.
#[test]
fn a_signal_to_one_rank_stops_all() {
    let directory = tempfile::tempdir().unwrap();
    let elastic_slip = "friction={law=\"coulomb_elastic_slip\",coefficient=0.2,elastic_slip=1e-6}";
    let exact = ["--set", "friction={law=\"coulomb\",coefficient=0.2}", "--set", "contact={}"];
    let springs =
        "mount={normal={stiffness=1e4,damping=10.0,load=0.01},tangential={stiffness=50.0,damping=1.0,mass=0.5}}";
    let weakening = "friction={law=\"coulomb\",coefficient=\"0.2 + 0.05*exp(-v/0.1) + 0.05*exp(-s/0.02)\"}";
    let mounted = ["--set", weakening, "--set", "contact={}", "--set", springs];
    let gauss = ["--set", elastic_slip, "--set", "contact.quadrature=gauss"];
    for (material, solver, within, set) in [
        (ratio(), "", 0.0, &[][..]),
        (bulk(), "", 0.0, &exact),
        (ratio(), "", 0.0, &gauss),
        (ratio(), "", 0.0, &mounted),
        (ratio(), "", 0.0, &["--set", "phase.slide.normal_force=0.3"]),
        (bulk(), "", 0.0, &["--set", "wear={of=\"body\",law=\"energy\",coefficient=1e-3}"]),
        (ratio(), "", 0.0, &["--set", "wear={of=\"indenter\",law=\"archard\",coefficient=1e-3}"]),
        (bulk(), "", 0.0, &["--set", "adhesion={law=\"bilinear\",work=3e-4,range=4e-4}"]),
        (bulk(), "tolerance = 1e-13\nstrategy = \"monolithic\"", 1e-10, &[]),
        (bulk(), "tolerance = 1e-13\nstrategy = \"monolithic\"", 1e-10, &["--set", springs]),
    ] {
        let scene = scene(directory.path(), 40, &material, solver);
        let (whole, stopped) = (directory.path().join("whole.h5"), directory.path().join("stopped.h5"));
        output_of(run(&mut program(1), &scene, &whole).args(["--set", "output.bulk_at=[]"]).args(set));
        for (signal, ranks) in [("TERM", 2), ("INT", 1)] {
            let mut command = run(&mut program(2), &scene, &stopped);
            command.args(["--set", "output.bulk_at=[]"]).args(set);
            let mut child = command.stdout(Stdio::null()).spawn().unwrap();
            wait_for(&mut child, &stopped, 4);
            let rank = processes_of(&child).pop().unwrap();
            assert!(Command::new("kill").args([&format!("-{signal}"), &rank]).status().unwrap().success());
            assert_eq!(child.wait().unwrap().code(), Some(5));
            let results = Results::open(&stopped).unwrap();
            assert_eq!(results.text("status").unwrap(), "stopped");
            assert!(results.history("time").unwrap().len() < 60);
            drop(results);
            let resume = ["--resume", "--set", "output.bulk_at=[]"];
            output_of(run(&mut program(ranks), &scene, &stopped).args(resume).args(set));
            assert_same(&whole, &stopped, within);
        }
    }
}

/// Adaptive steps: what chooses them is part of the state; on one rank all unknowns at once end with the same bits, too, held by springs and a
/// dead load.
#[test]
fn adaptive_steps_go_on_as_they_were() {
    adaptive_steps_go_on("");
    adaptive_steps_go_on(
        "strategy = \"monolithic\"\n[mount]\nnormal = { stiffness = 1e4, load = 0.01 }\n\
         tangential = { stiffness = 50.0, damping = 1.0, mass = 0.5 }",
    );
}

fn adaptive_steps_go_on(solver: &str) {
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path(), 40, &bulk(), solver);
    let text = std::fs::read_to_string(&scene).unwrap();
    let adaptive = text.replace("steps = 20\n", "tolerance = 1e-3\n").replace("steps = 40\n", "tolerance = 3e-4\n");
    std::fs::write(&scene, adaptive).unwrap();
    let (whole, killed) = (directory.path().join("whole.h5"), directory.path().join("killed.h5"));
    output_of(&mut run(&mut program(1), &scene, &whole));
    for checkpoints in [2, 9] {
        let mut child = run(&mut program(1), &scene, &killed).stdout(Stdio::null()).spawn().unwrap();
        wait_for(&mut child, &killed, checkpoints);
        child.kill().unwrap();
        child.wait().unwrap();
        output_of(run(&mut program(1), &scene, &killed).arg("--resume"));
        assert_same(&whole, &killed, 0.0);
    }
}

/// A face so large that steps are solved with factors of steps before: these are part of the state.
#[test]
fn factors_that_serve_for_later_steps_come_back() {
    // A periodic face of this size has no factor.
    for (material, sides) in [(ratio(), "free"), (bulk(), "free"), (bulk(), "periodic")] {
        let directory = tempfile::tempdir().unwrap();
        let scene = scene(directory.path(), 40, &material, "");
        let (whole, killed) = (directory.path().join("whole.h5"), directory.path().join("killed.h5"));
        let sides_key = format!("layer.sides={sides}");
        let cells = ["--set", "layer.cells=[640, 3]", "--set", &sides_key];
        output_of(run(&mut program(1), &scene, &whole).args(cells));
        let mut child = run(&mut program(1), &scene, &killed).args(cells).stdout(Stdio::null()).spawn().unwrap();
        wait_for(&mut child, &killed, 8);
        child.kill().unwrap();
        child.wait().unwrap();
        let state = checkpoint::read(&killed).unwrap().unwrap();
        assert_eq!(state.fields.iter().any(|(name, _)| name == "factor"), sides == "free");
        output_of(run(&mut program(1), &scene, &killed).args(cells).arg("--resume"));
        assert_same(&whole, &killed, 0.0);
    }
}

/// The process numbers of the ranks that an mpirun started.
fn processes_of(mpirun: &Child) -> Vec<String> {
    let id = mpirun.id();
    let children = std::fs::read_to_string(format!("/proc/{id}/task/{id}/children")).unwrap();
    children.split_whitespace().map(str::to_owned).collect()
}

/// What cannot be resumed is refused with what differs; what is complete is left alone.
#[test]
fn what_cannot_be_resumed_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path(), 2000, &ratio(), "");
    let out = directory.path().join("run.h5");
    let resume = |set: &[&str]| {
        let mut command = run(&mut program(1), &scene, &out);
        command.arg("--resume").args(set.iter().flat_map(|set| ["--set", set]));
        command
    };
    let message = ends_with(&mut resume(&[]), 2);
    assert_eq!(message, format!("mpjr: {}: there is nothing to resume; run without --resume\n", out.display()));

    let mut child = run(&mut program(1), &scene, &out).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    wait_for(&mut child, &out, 2);
    assert!(Command::new("kill").arg(child.id().to_string()).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(5));
    let message = errors(&String::from_utf8_lossy(&output.stderr));
    assert!(message.starts_with("mpjr: stopped by a signal at t = ") && message.ends_with("--resume\n"), "{message}");

    let message = ends_with(&mut resume(&["phase.slide.velocity=0.2", "material.arms.1.time=6"]), 2);
    assert_eq!(
        message,
        format!(
            "mpjr: {}: is of another scene and cannot be resumed: material.arms.1.time: 5.0 there, 6.0 here; \
             phase.1.velocity: 0.1 there, 0.2 here\n",
            out.display()
        )
    );
    // The title and the checkpoints themselves change nothing.
    output_of(&mut resume(&["title=other", "output.checkpoint_every=500"]));
    assert!(output_of(&mut resume(&[])).ends_with("this run is complete; there is nothing to go on with\n"));
    let message = ends_with(&mut resume(&["layer.depth=0.25"]), 2);
    assert!(message.contains("layer.depth: 0.5 there, 0.25 here"), "{message}");

    // A damaged checkpoint, and one whose results are gone.
    let mut child = run(&mut program(1), &scene, &out).stdout(Stdio::null()).spawn().unwrap();
    wait_for(&mut child, &out, 2);
    child.kill().unwrap();
    child.wait().unwrap();
    let kept = std::fs::read(checkpoint::beside(&out)).unwrap();
    std::fs::write(checkpoint::beside(&out), &kept[..kept.len() / 2]).unwrap();
    let message = ends_with(&mut resume(&[]), 4);
    assert!(message.contains("is not a whole checkpoint") && message.lines().count() == 1, "{message}");
    std::fs::remove_file(checkpoint::beside(&out)).unwrap();
    assert!(ends_with(&mut resume(&[]), 2).contains("before its first checkpoint"));
}

/// What was stopped is not begun anew without a word: both ways on are named, and both work.
#[test]
fn a_run_that_was_stopped_is_not_dropped() {
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path(), 200, &ratio(), "");
    let out = directory.path().join("run.h5");
    let stop = |command: &mut Command| {
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        wait_for(&mut child, &out, 2);
        assert!(Command::new("kill").arg(child.id().to_string()).status().unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(5));
    };
    stop(&mut run(&mut program(1), &scene, &out));
    let before = std::fs::read(&out).unwrap();
    for ranks in [1, 2] {
        let message = ends_with(&mut run(&mut program(ranks), &scene, &out), 2);
        assert!(message.contains("--resume") && message.contains("--restart"), "{message}");
        assert_eq!(message.matches("mpjr: ").count(), 1, "{message}");
        assert!(std::fs::read(&out).unwrap() == before);
    }
    stop(run(&mut program(1), &scene, &out).arg("--restart"));
    output_of(run(&mut program(1), &scene, &out).arg("--resume"));
    let whole = directory.path().join("whole.h5");
    output_of(&mut run(&mut program(1), &scene, &whole));
    assert_same(&whole, &out, 0.0);
    // What is complete is replaced as ever.
    output_of(&mut run(&mut program(1), &scene, &out));
}

/// Results that were damaged after their checkpoint was written are not gone on with: a byte changed anywhere among the
/// rows that count, in each group.
#[test]
fn damaged_results_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path(), 2000, &ratio(), "");
    let out = directory.path().join("run.h5");
    let mut child = run(&mut program(2), &scene, &out).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    wait_for(&mut child, &out, 12);
    assert!(Command::new("kill").args(["-USR1", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(5));
    let (whole, kept) = (std::fs::read(&out).unwrap(), std::fs::read(checkpoint::beside(&out)).unwrap());
    let results = Results::open(&out).unwrap();
    let numbers = [
        results.history("normal_force").unwrap()[7],
        results.history("energy/stored").unwrap()[9],
        results.interface("pressure").unwrap().row(5)[3],
        results.interface("displacement_x").unwrap().row(6)[2],
        results.bulk("stress").unwrap().row(0)[17],
        results.interface("x").unwrap().values[5],
        results.bulk("coordinates").unwrap().values[31],
    ];
    drop(results);
    for number in numbers {
        let bytes = number.to_ne_bytes();
        let at = whole.windows(8).position(|window| window == bytes).unwrap();
        let mut damaged = whole.clone();
        damaged[at + 3] ^= 0x10;
        std::fs::write(&out, &damaged).unwrap();
        let message = ends_with(run(&mut program(1), &scene, &out).arg("--resume"), 4);
        assert!(message.contains("was changed since the checkpoint beside it was written"), "{number}: {message}");
        assert!(std::fs::read(&out).unwrap() == damaged && std::fs::read(checkpoint::beside(&out)).unwrap() == kept);
    }
    std::fs::write(&out, &whole).unwrap();
    let mut resumed = run(&mut program(1), &scene, &out).arg("--resume").stdout(Stdio::null()).spawn().unwrap();
    wait_for(&mut resumed, &out, 1);
    resumed.kill().unwrap();
    resumed.wait().unwrap();
}

/// A signal that comes before the first step is kept for it.
#[test]
fn a_signal_while_it_starts() {
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path(), 200_000, &ratio(), "strategy = \"monolithic\"");
    let out = directory.path().join("run.h5");
    let caught = |child: &Child| {
        let about = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let mask = about
            .lines()
            .find_map(|line| line.strip_prefix("SigCgt:"))
            .map_or(0, |mask| u64::from_str_radix(mask.trim(), 16).unwrap());
        // SIGTERM is 15.
        mask >> 14 & 1 == 1
    };
    let child = run(&mut program(1), &scene, &out).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    while !caught(&child) {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(!out.exists());
    assert!(Command::new("kill").arg(child.id().to_string()).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let message = errors(&String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(5), "{message}");
    assert!(
        message.starts_with("mpjr: stopped by a signal at t = 0.1") && message.ends_with("--resume\n"),
        "{message}"
    );
}

/// A mesh or a profile whose file has changed is another one, however like the first it is: it is refused, before the end
/// of the run and after, and taken again once the file is what it was.
#[test]
fn files_that_have_changed_are_refused() {
    let put_mesh = |directory: &Path, grading: f64| {
        let layer = Layer { grading, ..Layer::in_plane([1.0, 0.5], [24, 8], Sides::Roller) };
        write_msh(&layer.mesh(), [24, 8], &["body"], &directory.join("body.msh"));
    };
    let put_profile = |directory: &Path, height: f64| {
        let line = |k: usize| format!("{:?} {:?}\n", k as f64 / 24.0, 1e-3 * height * (k as f64 / 24.0 - 0.5).powi(2));
        std::fs::write(directory.join("profile.txt"), (0..24).map(line).collect::<String>()).unwrap();
    };
    let profile = "indenter={ profile = \"sampled\", file = \"profile.txt\", extend = \"periodic\" }";
    assert_change_is_refused("mesh.file", &[], &put_mesh);
    assert_change_is_refused("indenter.file", &["--set", profile], &put_profile);
}

/// `put` makes the file that `key` names, as another one for each number.
fn assert_change_is_refused(key: &str, set: &[&str], put: &dyn Fn(&Path, f64)) {
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path(), 1000, &ratio(), "");
    if key == "mesh.file" {
        let text = std::fs::read_to_string(&scene).unwrap();
        let (_, after) = text.split_once("[material]").unwrap();
        let mesh = "[mesh]\nfile = \"body.msh\"\ncontact = \"top\"\nfixed = [\"base\"]\nroller = [\"sides\"]\n";
        std::fs::write(&scene, format!("{mesh}[material]{after}")).unwrap();
    }
    let (whole, out) = (directory.path().join("whole.h5"), directory.path().join("run.h5"));
    put(directory.path(), 1.0);
    output_of(run(&mut program(1), &scene, &whole).args(set));
    let mut child = run(&mut program(1), &scene, &out).args(set).stdout(Stdio::null()).spawn().unwrap();
    wait_for(&mut child, &out, 2);
    child.kill().unwrap();
    child.wait().unwrap();
    let message = format!(
        "mpjr: {}: cannot be resumed: the file that {key} names is not what it was when the run began; put that \
         back, or run without --resume\n",
        out.display()
    );
    let resume = || {
        let mut command = run(&mut program(1), &scene, &out);
        command.args(set).arg("--resume");
        command
    };
    put(directory.path(), 1.01);
    assert_eq!(ends_with(&mut resume(), 2), message);
    put(directory.path(), 1.0);
    output_of(&mut resume());
    assert_same(&whole, &out, 0.0);
    put(directory.path(), 1.01);
    assert_eq!(ends_with(&mut resume(), 2), message);
    // Results of a version that did not tell.
    hdf5::File::open_rw(&out).unwrap().delete_attr("inputs").unwrap();
    let message = ends_with(&mut resume(), 2);
    assert!(message.contains(&format!("does not tell the content of the file that {key} names")), "{message}");
}

/// On a full disk the program ends with exit code 4, and what is there afterwards can be gone on with elsewhere.
#[test]
fn a_full_disk_leaves_the_last_good_state() {
    let Some(mut inside) = common::mpi::mounting() else {
        eprintln!("skipped: no disk can be mounted here");
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path(), 1000, &ratio(), "strategy = \"monolithic\"");
    let disk = directory.path().join("disk");
    std::fs::create_dir(&disk).unwrap();
    let (whole, short) = (directory.path().join("whole.h5"), directory.path().join("short.h5"));
    output_of(&mut run(&mut program(1), &scene, &whole));
    // The interface profiles alone are larger.
    let size = std::fs::metadata(&whole).unwrap().len() / 2;
    let script = "mount -t tmpfs -o size=$1 tmpfs \"$0\" && { \"$2\" run \"$3\" --out \"$0/short.h5\"; code=$?; } && \
                  cp \"$0\"/short.* .. && exit $code";
    inside.args(["sh", "-c", script]).arg(&disk).arg(size.to_string()).arg(env!("CARGO_BIN_EXE_mpjr")).arg(&scene);
    inside.current_dir(&disk).env("OMPI_MCA_ess_singleton_isolated", "1").env("OMPI_MCA_btl", "self");
    let message = ends_with(&mut inside, 4);
    assert!(message.contains("No space left"), "{message}");
    assert_eq!(Results::open(&short).unwrap().text("status").unwrap(), "stopped");
    output_of(run(&mut program(1), &scene, &short).arg("--resume"));
    assert_same(&whole, &short, 0.0);
}
