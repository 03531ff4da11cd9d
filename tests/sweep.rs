//! Sweeps: which cases there are, that none is run twice or lost, and that shared phases change nothing.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use common::program::{assert_same, ends_with, errors, names, output_of, program};
use common::scene::{COSINE, Text, elastic, layer, phase, regularised};
use mpjr::output::reader::Results;

static SCENE: Text = Text::new(|| {
    let indent = phase("indent", 10) + "duration = 2.0\napproach = 1e-3\n";
    let slide = phase("slide", 12) + "velocity = 0.1\ndistance = 0.2\n";
    let output = "[output]\ninterface_every = 2\nbulk_at = [\"indent\", \"slide\"]\n";
    let body = layer("1.0", "0.5", "[16, 6]") + &elastic("500.0", "0.3");
    "title = \"base\"\n".to_owned() + &body + COSINE + &regularised("1e6", "0.2") + &indent + &slide + output
});

const SOFT: &str = "[material]\nyoung_modulus = 1000.0\npoisson_ratio = 0.2\n\
                    arms = [{ weight = 0.5, time = 0.3 }]\npoisson_rule = \"constant_ratio\"\n";

const SWEEP: &str = r#"
scene = "scene.toml"
[vary]
"material" = ["soft.toml", { file = "hard.toml" }]
"phase.slide.velocity" = [0.01, 0.1, 1]
[follow]
"contact.penalty" = "2 * contact.penalty"
"#;

/// A directory with a scene, two materials and the sweep.
fn prepare(sweep: &str) -> (tempfile::TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| std::fs::write(directory.path().join(name), text).unwrap();
    put("scene.toml", &SCENE);
    put("soft.toml", SOFT);
    put("hard.toml", &SOFT.replace("1000.0", "4000.0"));
    put("sweep.toml", sweep);
    let out = directory.path().join("out");
    (directory, out)
}

fn sweep(mut command: Command, out: &Path, more: &[&str]) -> Command {
    command.arg("sweep").arg(out.with_file_name("sweep.toml")).arg("--out").arg(out).args(more);
    command
}

fn summary(out: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(out.join("summary.csv")).unwrap();
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// How many results of phases that cases share there are.
fn shared_runs(out: &Path) -> usize {
    names(&out.join(".shared")).iter().filter(|name| name.ends_with(".h5")).count()
}

/// Each case is the run of its scene alone, the shared approach is solved once, and nothing is solved twice.
#[test]
fn every_case_is_its_scene_alone() {
    let (directory, out) = prepare(SWEEP);
    let list = output_of(&mut sweep(program(1), &out, &["--list"]));
    assert_eq!(list.lines().count(), 6);
    assert_eq!(
        list.lines().nth(4).unwrap(),
        "   4  missing        material = { file = \"hard.toml\" }, phase.slide.velocity = 0.1"
    );
    assert!(!out.exists());

    assert!(output_of(&mut sweep(program(1), &out, &[])).contains("6 of 6 case(s) complete, 0 failed"));
    assert_eq!(shared_runs(&out), 2);
    for (case, material, velocity) in [(1, "soft", "0.1"), (5, "hard", "1")] {
        let alone = directory.path().join(format!("alone-{case}.h5"));
        let table = std::fs::read_to_string(directory.path().join(format!("{material}.toml"))).unwrap();
        let scene = directory.path().join("alone.toml");
        let (before, after) = (SCENE.split("[material]").next().unwrap(), SCENE.split("[indenter]").nth(1).unwrap());
        std::fs::write(&scene, format!("{before}{table}[indenter]{after}")).unwrap();
        let velocity = format!("phase.slide.velocity={velocity}");
        let set = ["--set", &velocity, "--set", "contact.penalty=2e6"];
        output_of(program(1).arg("run").arg(&scene).arg("--out").arg(&alone).args(set));
        let file = out.join(format!("case-{case:04}.h5"));
        assert_same(&alone, &file, 0.0);
        let xdmf = |path: &Path| std::fs::read_to_string(path.with_extension("xdmf")).unwrap().matches("<Time").count();
        assert_eq!(xdmf(&file), xdmf(&alone));
    }
    let rows = summary(&out);
    assert_eq!(rows.len(), 7);
    assert_eq!(rows[0][..5], ["case", "material", "phase.slide.velocity", "status", "exit_code"]);
    let at = rows[0].iter().position(|name| name == "normal_force").unwrap();
    let force = Results::open(&out.join("case-0001.h5")).unwrap().history("normal_force").unwrap();
    assert_eq!(rows[2][..5], ["1", "soft.toml", "0.1", "complete", "0"]);
    assert_eq!(rows[2][at].parse::<f64>().unwrap(), *force.last().unwrap());

    // Again: nothing is touched. With one value changed: its cases only.
    let modified = |case: usize| std::fs::metadata(out.join(format!("case-{case:04}.h5"))).unwrap().modified().unwrap();
    let before: Vec<_> = (0..6).map(modified).collect();
    assert!(output_of(&mut sweep(program(1), &out, &[])).contains("6 of 6 case(s) were complete before"));
    assert_eq!((0..6).map(modified).collect::<Vec<_>>(), before);
    std::fs::write(directory.path().join("sweep.toml"), SWEEP.replace("0.01,", "0.02,")).unwrap();
    output_of(&mut sweep(program(1), &out, &[]));
    let changed: Vec<usize> = (0..6).filter(|&case| modified(case) != before[case]).collect();
    assert_eq!(changed, [0, 3]);
}

/// Cases whose steps are chosen as they go: what chooses them is part of the state at the end of the shared phases, so that
/// each case takes the steps of its scene alone. Their tolerance is relative to the greatest penetration of all phases, so
/// that nothing is shared before one that presses deeper.
#[test]
fn shared_phases_with_adaptive_steps() {
    for (deepest, shared) in [(1e-3, 2), (1.2e-3, 0)] {
        adaptive_cases(deepest, shared);
    }
}

/// The last phase presses to `deepest`; so many runs of phases are shared.
fn adaptive_cases(deepest: f64, shared: usize) {
    let phases = format!(
        "[[phase]]\nname = \"back\"\nvelocity = -0.05\ndistance = 0.1\napproach = {deepest:e}\ntolerance = 2e-3\n[output]"
    );
    let scene = SCENE.replace("steps = 10\n", "tolerance = 2e-3\n").replace("steps = 12\n", "tolerance = 1e-3\n");
    let (directory, out) = prepare(
        "scene = \"scene.toml\"\n[vary]\n\"phase.slide.velocity\" = [0.02, 0.1]\n\
         \"phase.back.tolerance\" = [2e-3, 5e-4]\n",
    );
    let (before, _) = scene.split_once("[material]").unwrap();
    let (_, after) = scene.split_once("[indenter]").unwrap();
    let scene = format!("{before}{SOFT}[indenter]{}", after.replace("[output]", &phases));
    let file = directory.path().join("scene.toml");
    std::fs::write(&file, scene).unwrap();
    output_of(&mut sweep(program(1), &out, &[]));
    let mut steps = Vec::new();
    for (case, (velocity, tolerance)) in [(0.02, 2e-3), (0.02, 5e-4), (0.1, 2e-3), (0.1, 5e-4)].iter().enumerate() {
        let alone = directory.path().join("alone.h5");
        let set = [format!("phase.slide.velocity={velocity}"), format!("phase.back.tolerance={tolerance:e}")];
        let set = set.iter().flat_map(|set| ["--set", set]);
        output_of(program(1).arg("run").arg(&file).arg("--out").arg(&alone).args(set));
        assert_same(&alone, &out.join(format!("case-{case:04}.h5")), 0.0);
        steps.push(Results::open(&alone).unwrap().history("time").unwrap().len());
    }
    steps.dedup();
    assert!(steps.len() == 4, "the cases differ in their steps: {steps:?}");
    assert_eq!(shared_runs(&out), shared);
}

/// Blocks that vary one after the other: 2 x 2 and 1 x 1 cases, numbered through.
#[test]
fn blocks_come_one_after_the_other() {
    let block = |penalties: &str, velocities: &str| {
        format!("[[vary]]\n\"contact.penalty\" = {penalties}\n\"phase.slide.velocity\" = {velocities}\n")
    };
    let blocks = block("[1e6, 2e6]", "[0.01, 0.1]") + &block("[3e6]", "[1.0]");
    let (_directory, out) = prepare(&format!("scene = \"scene.toml\"\n{blocks}"));
    output_of(&mut sweep(program(1), &out, &[]));
    let rows = summary(&out);
    assert_eq!(rows[0][1..3], ["contact.penalty", "phase.slide.velocity"], "{rows:?}");
    let varied: Vec<[f64; 2]> = rows[1..].iter().map(|row| [1, 2].map(|i| row[i].parse().unwrap())).collect();
    assert_eq!(varied, [[1e6, 0.01], [1e6, 0.1], [2e6, 0.01], [2e6, 0.1], [3e6, 1.0]]);
}

/// Results of a profile whose file has changed since are not those of the sweep.
#[test]
fn a_file_that_has_changed_makes_its_cases_anew() {
    let (directory, out) = prepare("scene = \"scene.toml\"\n[vary]\n\"phase.slide.velocity\" = [0.01, 0.1]\n");
    let (before, _) = SCENE.split_once("[indenter]").unwrap();
    let (_, after) = SCENE.split_once("[contact]").unwrap();
    let sampled = "profile = \"sampled\"\nfile = \"profile.txt\"\nextend = \"periodic\"";
    let scene = format!("{before}[indenter]\n{sampled}\n[contact]{after}");
    std::fs::write(directory.path().join("scene.toml"), scene).unwrap();
    let solve = |height: f64| {
        let line = |k: usize| format!("{:?} {:?}\n", k as f64 / 16.0, height * (k as f64 / 16.0 - 0.5).powi(2));
        std::fs::write(directory.path().join("profile.txt"), (0..16).map(line).collect::<String>()).unwrap();
        let told = output_of(&mut sweep(program(1), &out, &[]));
        let force = Results::open(&out.join("case-0001.h5")).unwrap().history("normal_force").unwrap();
        (told.contains("2 of 2 case(s) were complete before"), force[force.len() - 1])
    };
    let first = solve(1e-3);
    assert_eq!(solve(1e-3), (true, first.1));
    let changed = solve(2e-3);
    assert!(!changed.0 && changed.1 != first.1, "{first:?} {changed:?}");
    assert_eq!(solve(1e-3), (false, first.1));
}

/// Three ranks in groups of one and of two; one case alone; the same numbers.
#[test]
fn groups_of_ranks_share_the_work() {
    let (_directory, out) = prepare(SWEEP);
    output_of(&mut sweep(program(1), &out, &[]));
    for (ranks, more) in [(3, &["--ranks-per-case", "1"][..]), (3, &["--ranks-per-case", "2"]), (2, &["--case", "4"])] {
        let other = out.with_file_name("other");
        let _ = std::fs::remove_dir_all(&other);
        output_of(&mut sweep(program(ranks), &other, more));
        let cases = if more[0] == "--case" { 4..5 } else { 0..6 };
        for case in cases {
            let name = format!("case-{case:04}.h5");
            assert_same(&out.join(&name), &other.join(&name), 1e-10);
        }
    }
    let message = ends_with(&mut sweep(program(1), &out, &["--case", "6"]), 2);
    assert_eq!(message, "mpjr: --case 6: the sweep has the cases 0 to 5\n");
}

/// A case that fails is recorded and tried again the next time; the others go on.
#[test]
fn a_failed_case_stops_no_other() {
    let (directory, out) = prepare("scene = \"scene.toml\"\n[vary]\n\"contact.penalty\" = [1e6, 2e6, 3e6]\n");
    std::fs::create_dir_all(&out).unwrap();
    std::fs::write(out.join("case-0001.h5"), "somebody else's").unwrap();
    let message = ends_with(&mut sweep(program(1), &out, &[]), 4);
    assert!(message.contains(": 1 of 3 case(s) failed: case 1 (exit code 4): "), "{message}");
    assert!(message.contains("was not written by mpjr") && message.lines().count() == 1, "{message}");
    let rows = summary(&out);
    assert_eq!(
        rows.iter().map(|row| row[2].as_str()).collect::<Vec<_>>(),
        ["status", "complete", "failed", "complete"]
    );
    assert_eq!(rows[2][3], "4");
    std::fs::remove_file(out.join("case-0001.h5")).unwrap();
    let again = output_of(&mut sweep(program(1), &out, &[]));
    assert!(
        again.contains("2 of 3 case(s) were complete before") && again.contains("3 of 3 case(s) complete"),
        "{again}"
    );
    drop(directory);
}

/// A sweep that is killed, or stopped by a signal, goes on where it was; files left half written are recognised.
#[test]
fn a_sweep_that_is_killed_goes_on() {
    let long =
        SWEEP.replace("[follow]", "\"phase.slide.steps\" = [1500]\n\"output.checkpoint_every\" = [50]\n[follow]");
    let (_directory, out) = prepare(&long);
    let whole = out.with_file_name("whole");
    output_of(&mut sweep(program(1), &whole, &[]));
    let count = || (0..6).filter(|case| out.join(format!("case-{case:04}.h5")).exists()).count();
    for (begun, signal, code) in [(1, "KILL", None), (2, "KILL", None), (4, "TERM", Some(5))] {
        let mut child = sweep(program(1), &out, &[]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let start = Instant::now();
        while count() < begun && start.elapsed() < Duration::from_secs(120) {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(20 * begun as u64));
        Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).status().unwrap();
        assert_eq!(child.wait().unwrap().code(), code);
    }
    output_of(&mut sweep(program(1), &out, &[]));
    for case in 0..6 {
        let name = format!("case-{case:04}.h5");
        assert_same(&whole.join(&name), &out.join(&name), 0.0);
    }
}

#[test]
fn a_script_for_slurm_is_printed() {
    let (_directory, out) = prepare(SWEEP);
    let script = output_of(&mut sweep(program(1), &out, &["--slurm"]));
    assert!(script.starts_with("#!/bin/sh\n"));
    let asked = ["--slurm", "--time", "2:00:00", "--mem", "8G", "--cpus", "2", "--launcher", "srun"];
    let other = output_of(&mut sweep(program(1), &out, &asked));
    for part in ["--time=2:00:00\n", "--mem=8G\n", "--cpus-per-task=2\n", "exec srun --mpi=pmix "] {
        assert!(other.contains(part), "{part} in\n{other}");
    }
    for part in [
        "--time=24:00:00\n",
        "exec mpirun -n \"$SLURM_NTASKS\" ",
        "--array=0-5",
        "--ntasks=1",
        "--signal=B:USR1@120",
        "--case \"$SLURM_ARRAY_TASK_ID\"",
    ] {
        assert!(script.contains(part), "{part} in\n{script}");
    }
}

/// What is wrong with a sweep is said with its key, before anything is solved.
#[test]
fn bad_sweeps_are_refused() {
    let vary = |vary: &str| format!("scene = \"scene.toml\"\n[vary]\n{vary}\n");
    let with = |follow: &str| format!("{}[follow]\n{follow}\n", vary("\"layer.depth\" = [0.5]"));
    for (text, message) in [
        ("[vary]\n\"layer.depth\" = [1]".into(), "scene: missing; give the name of a scene file"),
        ("scene = 3".into(), "scene: must be the name of a scene file, got 3"),
        (
            "scene = \"none.toml\"\n[vary]\n\"layer.depth\" = [1]".into(),
            "scene: DIR/none.toml cannot be read: No such file or directory (os error 2)",
        ),
        (
            "scene = \"scene.toml\"".into(),
            "vary: missing; give the keys that vary, such as \"phase.slide.velocity\" = [0.01, 0.1]",
        ),
        (vary(""), "vary: is empty; give the keys that vary, such as \"phase.slide.velocity\" = [0.01, 0.1]"),
        (
            format!("{}[[vary]]\n\"layer.width\" = [1]\n", vary("\"layer.depth\" = [1]").replace("[vary]", "[[vary]]")),
            "vary.1: must vary the keys of the first [[vary]]: layer.depth",
        ),
        (vary("\"layer.depth\" = []"), "vary.layer.depth: is empty; give at least one value"),
        (vary("\"layer.depth\" = 2"), "vary.layer.depth: must be an array of values, got 2"),
        (
            vary("layer.depth = [2]"),
            "vary.layer: must be an array of values; put a key with dots in quotes: \"layer. ...\"",
        ),
        (
            vary("\"layer.dept\" = [1.0, 2.0]"),
            "layer.dept: unknown key; did you mean \"depth\"? (in the case layer.dept = 1.0)",
        ),
        (vary("\"phase.slid.steps\" = [1]"), "phase.slid: no such phase; did you mean \"slide\"?"),
        (
            vary("\"layer.depth\" = [1.0, -1.0]"),
            "layer.depth: must be a positive length in m, got -1.0 (in the case layer.depth = -1.0)",
        ),
        (
            vary("\"material\" = [\"none.toml\"]"),
            "vary.\"material\": DIR/none.toml cannot be read: No such file or directory (os error 2)",
        ),
        (vary("\"indenter\" = [\"soft.toml\"]"), "vary.\"indenter\": DIR/soft.toml has no [indenter] table"),
        (format!("{}[folow]\n", vary("\"layer.depth\" = [1]")), "folow: unknown key; did you mean \"follow\"?"),
        (with("\"layer.depth\" = \"1\""), "follow.layer.depth: is varied too; take it out of [vary] or of [follow]"),
        (
            with("\"layer.width\" = 1"),
            "follow.layer.width: must be a formula, such as \"0.01 * phase.slide.velocity\", got 1",
        ),
        (
            with("\"layer.width\" = \"2 * layer.breadth\""),
            "follow.\"layer.width\": layer.breadth in \"2 * layer.breadth\" is not a number of the scene",
        ),
        (
            with("\"layer.width\" = \"1 / (layer.depth - 0.5)\""),
            "follow.\"layer.width\": \"1 / (layer.depth - 0.5)\" gives inf, which is not a finite number",
        ),
    ] {
        let (directory, out) = prepare(&text);
        let expected = message.replace("DIR", &directory.path().display().to_string());
        let file = directory.path().join("sweep.toml");
        for more in [&["--list"][..], &[]] {
            let found = ends_with(&mut sweep(program(1), &out, more), 2);
            assert_eq!(found, format!("mpjr: {}: {expected}\n", file.display()));
            assert!(!out.exists());
        }
    }
    let (_directory, out) = prepare(&with("\"layer.width\" = \"2 *\""));
    let found = ends_with(&mut sweep(program(1), &out, &["--list"]), 2);
    assert!(found.contains("follow.layer.width: is not a formula: ") && found.lines().count() == 1, "{found}");
}

/// Results of a case that were damaged or emptied are moved aside, which is said, and the case is solved again; what was
/// never this program's stays, and the exit code is that of its case.
#[test]
fn damaged_cases_are_solved_again() {
    let (_directory, out) = prepare(SWEEP);
    output_of(&mut sweep(program(1), &out, &[]));
    let file = |case: usize| out.join(format!("case-{case:04}.h5"));
    let kept: Vec<Vec<u8>> = (0..6).map(|case| std::fs::read(file(case)).unwrap()).collect();
    let mut damaged = kept[1].clone();
    damaged[..64].fill(0xff);
    std::fs::write(file(1), &damaged).unwrap();
    std::fs::write(file(2), "").unwrap();
    std::fs::write(file(4), &kept[4][..kept[4].len() / 3]).unwrap();
    let output = sweep(program(1), &out, &[]).output().unwrap();
    let (told, said) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && told.contains("6 of 6 case(s) complete, 0 failed"), "{told}{said}");
    for case in [1, 2, 4] {
        assert_eq!(
            said.matches(&format!("moved to case-{case:04}.damaged, and case {case} is solved again")).count(),
            1
        );
    }
    assert_eq!(errors(&said).lines().count(), 3, "{said}");
    assert!(std::fs::read(out.join("case-0001.damaged")).unwrap() == damaged);
    let original = out.join("original.h5");
    std::fs::write(&original, &kept[1]).unwrap();
    assert_same(&original, &file(1), 0.0);

    std::fs::remove_dir_all(&out).unwrap();
    std::fs::create_dir(&out).unwrap();
    std::fs::write(file(3), "mine").unwrap();
    for _ in 0..2 {
        let message = ends_with(&mut sweep(program(1), &out, &[]), 4);
        assert!(message.contains("1 of 6 case(s) failed: case 3 (exit code 4)"), "{message}");
        assert_eq!(std::fs::read_to_string(file(3)).unwrap(), "mine");
    }
}
