//! `mpjr study`: the program from a scene to its tables, its figure and its advice.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use common::program::{MPJR, Run, ends_with, errors, output_of, program};
use common::scene::{COSINE, Text, coulomb, elastic, layer, phase};
use mpjr::output::HistoryRow;
use mpjr::study::Difference;
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
    assert!(ends_with(&mut study(&scene, 1, &[]), 4).contains("exists and was not written by mpjr"));
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

/// Partial slip under Coulomb's law itself without penetration.
static EXACT: Text = Text::new(|| {
    let press = phase("press", 4) + "duration = 1.0\napproach = 5e-4\n";
    let forth = phase("forth", 20) + "duration = 1.0\nvelocity = 1e-4\n[solver]\ntolerance = 1e-11\n";
    layer("1.0", "0.7", "[64, 16]") + &elastic("300.0", "0.3") + COSINE + &coulomb("0.3") + &press + &forth
});

/// Penalty, elastic slip and regularisation come to the exact laws, which the scene has, at first order: each rung is ten times closer than
/// the one before (the order that is told, from the last two of them). The error of the last one, against the exact laws: 2.0e-4 at
/// 1e7 Pa/m, 7.4e-5 at 1e-8 m, 4.4e-5 at 1e-8 m/s (measured). The scene as it is has none but round-off, and two quadratures are
/// not compared, as the other one takes no exact law.
#[test]
fn softer_laws_come_to_the_exact_ones() {
    let directory = tempfile::tempdir().unwrap();
    let scene = directory.path().join("exact.toml");
    std::fs::write(&scene, &**EXACT).unwrap();
    for (vary, bound) in [
        ("contact.penalty=1e4,1e5,1e6,1e7", 2.2e-4),
        ("friction.elastic_slip=1e-5,1e-6,1e-7,1e-8", 8e-5),
        ("friction.regularisation=1e-6,1e-7,1e-8", 5e-5),
    ] {
        let told = output_of(&mut study(&scene, 1, &["--vary", vary, "--out", "out"]));
        let out = directory.path().join("out");
        let found: Table = std::fs::read_to_string(out.join("study.toml")).unwrap().parse().unwrap();
        let order = number(found["ladder"][0].as_table().unwrap(), "order");
        assert!((order - 1.0).abs() < 0.05, "{vary}: {order}");
        let rows = std::fs::read_to_string(out.join("runs.csv")).unwrap();
        let error = |row: &str| row.rsplit(',').next().unwrap().parse::<f64>().unwrap();
        let errors: Vec<f64> = rows.lines().skip(1).map(error).collect();
        let [.., last, exact] = errors[..] else { panic!("{rows}") };
        assert!(last < bound && last > 0.5 * bound && exact < 1e-15, "{vary}: {errors:?}");
        assert!(told.contains("  none  ") && number(&found, "error") < 1e-15, "{told}");
    }
    // From a softer scene, the law itself is where its key is taken out.
    let soft = ["--set", "contact.penalty=1e6", "--vary", "contact.penalty=1e5,1e6,none", "--out", "soft"];
    let told = output_of(&mut study(&scene, 1, &soft));
    assert!(told.contains("contact.penalty= contact.tolerance= contact.method=: 24 steps"), "{told}");
    let told = output_of(&mut study(&scene, 1, &["--out", "default"]));
    assert!(told.contains("as it is: ") && !told.contains("quadrature"), "{told}");
}

/// With `--error` nothing is printed but options, which `mpjr run` takes; what no setting meets is refused.
#[test]
fn the_cheapest_setting() {
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path());
    let steps = ["--vary", "phase.slide.steps=8,16,32,64", "--vary", "layer.cells=[8,8],[16,16]"];
    let told = output_of(study(&scene, 1, &steps).args(["--error", "0.2"]));
    let options: Vec<&str> = told.split_whitespace().collect();
    assert!(options.len() == 4 && options[0] == "--set" && told.lines().count() == 1, "{told}");
    // As docs/commands.md has it: what is printed goes through a shell, which takes no quotes off.
    let vary = steps.map(|word| format!("'{word}'")).join(" ");
    let line = format!("$MPJR run sliding.toml $($MPJR study sliding.toml {vary} --error 0.2) --out advised.h5");
    let mut shell = Command::new("sh");
    shell.args(["-c", &line]).env("MPJR", MPJR).current_dir(&directory);
    shell.envs(program(1).get_envs().filter_map(|(key, value)| Some((key, value?))));
    assert!(output_of(&mut shell).contains("results:       advised.h5"));
    assert!(!directory.path().join("sliding-study").exists());
    let refused = ends_with(study(&scene, 1, &steps).args(["--error", "1e-9"]), 2);
    assert!(refused.contains("no setting on these ladders meets it"), "{refused}");
}

/// A profile with a hole that only the finer cells with the finer steps come upon: every ladder can be climbed, all together
/// cannot be solved. The ladders are told and kept, and the message says what failed.
#[test]
fn the_finest_together_may_be_too_much() {
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path());
    // Nodes of 16 cells are at 0.0625 m, those of 8 are not; steps of 0.015 m take the hole there, those of 0.03 m do not.
    let hole = "indenter={ profile = \"expression\", formula = \"1e-3*(x-0.5)^2 + 0*sqrt((x-0.0475)^2 - 1e-12)\" }";
    let set = ["layer.sides=free", "phase.slide.distance=0.03", "layer.cells=[8,4]", "phase.slide.steps=1", hole];
    let set = set.iter().flat_map(|set| ["--set", set]);
    let vary = ["--vary", "layer.cells=[8,4],[16,8]", "--vary", "phase.slide.steps=1,2"];
    let output = study(&scene, 1, &vary).args(set.clone()).output().unwrap();
    let [told, message] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert_eq!(output.status.code(), Some(3), "{told}{message}");
    let reason = "sliding.toml: no error can be told, as the finest of all ladders together could not be solved: phase \"slide\": ";
    assert!(message.contains(reason) && errors(&message).lines().count() == 1, "{message}");
    assert!(told.contains("  [16,8]  ") && !told.contains("NaN") && !told.contains("for 10 %"), "{told}");
    let out = directory.path().join("sliding-study");
    assert_eq!(std::fs::read_to_string(out.join("runs.csv")).unwrap().lines().count(), 5);
    let found: Table = std::fs::read_to_string(out.join("study.toml")).unwrap().parse().unwrap();
    assert_eq!(found["ladder"].as_array().unwrap().len(), 2);
    assert!(found["advice"].as_array().unwrap().is_empty() && !found.contains_key("error"), "{found}");
    assert!(out.join("work-precision.png").exists());
    // The same asked for as options: nothing but the message.
    let output = study(&scene, 1, &vary).args(set.clone()).args(["--error", "0.1"]).output().unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(3), 0));
    // What fails as it is says why.
    let fails = ["layer.cells=[16,8]", "phase.slide.steps=2"].iter().flat_map(|set| ["--set", set]);
    let message = ends_with(study(&scene, 1, &vary).args(set).args(fails), 3);
    assert!(message.contains("sliding.toml: cannot be studied as it is: phase \"slide\": "), "{message}");
}

/// A study that is stopped in the last, longest run keeps the ladders that it climbed.
#[test]
fn a_study_that_is_stopped_keeps_its_ladders() {
    let directory = tempfile::tempdir().unwrap();
    let scene = scene(directory.path());
    let vary = ["--vary", "layer.cells=[8,8],[256,8]", "--vary", "phase.slide.steps=8,20000"];
    let mut child = study(&scene, 1, &vary).stdout(std::process::Stdio::null()).spawn().unwrap();
    let runs = directory.path().join("sliding-study/runs.csv");
    let rows = || std::fs::read_to_string(&runs).map_or(0, |text| text.lines().count());
    let begun = Instant::now();
    while rows() < 5 {
        assert!(begun.elapsed() < Duration::from_secs(60) && child.try_wait().unwrap().is_none(), "no ladders come");
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    assert_eq!(child.wait().unwrap().code(), None);
    assert_eq!(rows(), 5);
}

/// A row of the table of presets in docs/scene.md: the steps, the error of N and Q, and that of the hysteretic force.
fn published(preset: &str) -> [f64; 3] {
    let page = std::fs::read_to_string(common::directory("docs/scene.md")).unwrap();
    let row = page.lines().find(|line| line.starts_with(&format!("| `\"{preset}\"` |"))).unwrap();
    let cells: Vec<&str> = row.split('|').map(str::trim).collect();
    [4, 5, 6].map(|column| cells[column].parse().unwrap())
}

/// The presets make the errors that docs/scene.md tells, on the scene that it tells them of: against steps for a hundredth of
/// the tolerance of the last, which 12 000 equal steps confirm. No more than is told, but for its last digit, and no less
/// than half of it.
#[test]
fn the_presets_are_as_accurate_as_told() {
    let scene = std::fs::read_to_string(common::directory("runs/presets.toml")).unwrap();
    let solve = |set: &[String]| {
        let outcome = set.iter().fold(Run::new(&scene), |run, set| run.set(set)).done();
        let column = |name: &str| outcome.history(name);
        let [time, n, q, h] = ["time", "normal_force", "tangential_force", "hysteretic_force"].map(column);
        let row = |i: usize| HistoryRow {
            time: time[i],
            normal_force: n[i],
            tangential_force: q[i],
            hysteretic_force: h[i],
            ..HistoryRow::default()
        };
        (0..time.len()).map(row).collect::<Vec<HistoryRow>>()
    };
    let finely = |settings: [&str; 3]| {
        let phases = ["indent", "onset", "slide"].into_iter().zip(settings);
        let set = phases.map(|(phase, setting)| format!("phase.{phase}.{setting}"));
        solve(&set.chain(["solver.tolerance=1e-11".to_owned()]).collect::<Vec<_>>())
    };
    let finest = finely(["tolerance=1e-6"; 3]);
    let equal = Difference::between(&finest, &finely(["steps=2000", "steps=2000", "steps=8000"]));
    assert!(equal.error() < 2e-4 && equal.hysteretic < 3e-4, "{equal:?}");
    for preset in ["fast", "balanced", "reference"] {
        let history = solve(&[format!("solver.preset={preset}")]);
        let found = Difference::between(&history, &finest);
        let [steps, error, hysteretic] = published(preset);
        let forces = found.normal.max(found.tangential);
        println!("{preset}: {} steps, {forces:.2e}, hysteretic {:.2e}", history.len() - 1, found.hysteretic);
        assert!(((history.len() - 1) as f64 / steps - 1.0).abs() < 0.05, "{preset}: {} steps", history.len() - 1);
        for (found, told) in [(forces, error), (found.hysteretic, hysteretic)] {
            assert!(found < 1.1 * told && found > 0.5 * told, "{preset}: {found:e}, told {told:e}");
        }
    }
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
