//! Warnings: each at its threshold with its number, and what commands make of them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::f64::consts::{PI, SQRT_2};
use std::process::Command;

use common::program::{MPJR, Outcome, Run, output_of, program};
use mpjr::oracle::layer::Layer;
use mpjr::oracle::solid::Moduli;
use mpjr::output::reader::Results;

const BLOCK: &str = include_str!("scenes/block.toml");
const WAVE: &str = include_str!("scenes/wave.toml");

/// Friction of a coefficient of 0.3 with its length or rate.
fn tanh(rate: f64) -> String {
    format!(r#"friction={{law="coulomb_tanh",coefficient=0.3,regularisation={rate:e}}}"#)
}

fn slip(length: f64) -> String {
    format!(r#"friction={{law="coulomb_elastic_slip",coefficient=0.3,elastic_slip={length:e}}}"#)
}

/// Pressed by 2e-4 m within 0.5 s, then something else.
fn then(phase: &str) -> String {
    format!(r#"phase=[{{name="press",duration=0.5,steps=10,approach=2e-4}},{{name="move",{phase}}}]"#)
}

fn approach(depth: f64) -> String {
    format!("phase.press.approach={depth:e}")
}

/// What `mpjr check` warns of.
fn warned(scene: &str, changes: &[String]) -> String {
    let run = Run::new(scene);
    std::fs::write(run.directory().join("long.txt"), "-1 0\n0 1e-3\n0.02 0\n0.05 1e-3\n39.1 1\n").unwrap();
    std::fs::write(run.directory().join("shorter.txt"), "-1 0\n0 1e-3\n0.02 0\n0.05 1e-3\n38.9 1\n").unwrap();
    let mut command = program(1);
    command.current_dir(run.directory()).args(["check", "-q", "scene.toml"]);
    changes.iter().for_each(|change| {
        command.args(["--set", change]);
    });
    let output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && output.stdout.is_empty(), "{changes:?}: {text}");
    assert!(text.lines().all(|line| line.starts_with("warning: ")), "{text}");
    text
}

/// The scene with the changes of the first list gives the warning that starts so, with those of the second it does not.
fn at_threshold(scene: &str, warning: &str, fires: &[String], silent: &[String]) {
    let (found, other) = (warned(scene, fires), warned(scene, silent));
    assert_eq!(found.matches(warning).count(), 1, "{fires:?} should give {warning:?}:\n{found}");
    let key = warning.split(": ").take(2).collect::<Vec<_>>().join(": ");
    let kind = found.lines().find(|line| line.starts_with(warning)).unwrap();
    let words = kind.rsplit_once("; ").unwrap().1.split_whitespace().take(2).collect::<Vec<_>>().join(" ");
    let same = |line: &&str| line.starts_with(&key) && line.contains(&words);
    assert_eq!(other.lines().find(same), None, "{silent:?} should not give {warning:?}");
}

fn strings(list: &[&str]) -> Vec<String> {
    list.iter().map(|text| (*text).to_owned()).collect()
}

/// The profile of the block is 25 (x - 0.015 m)^2; points are 1.25e-4 m apart, a quarter of a cell.
#[test]
fn contact_at_its_thresholds() {
    let raised = |height: f64| vec![format!(r#"indenter={{profile="expression",formula="{height:e}+25*(x-0.02)^2"}}"#)];
    let never = "warning: phase.press.approach: the indenter never touches: it stays 8.000e-4 m above the face";
    at_threshold(BLOCK, never, &raised(1e-3), &raised(1.99e-4));
    let leaves = "warning: phase.move.distance: the indenter leaves the body: its lowest point is beyond the end of the face at \
                  x = 0.04 m";
    let slide = |distance: f64| vec![then(&format!("velocity=0.01,distance={distance},steps=100"))];
    at_threshold(BLOCK, leaves, &slide(0.0255), &slide(0.0249));
    // 15 and 17 points overlap: 3.75 and 4.25 edges over sqrt(2).
    let few = "warning: layer.cells: about 2.7 nodes of the face in contact";
    at_threshold(BLOCK, few, &[approach(2.5e-5)], &[approach(3e-5)]);
    let pressed = |centre: f64| vec![r#"layer.sides="fixed""#.to_owned(), format!("indenter.centre={centre}")];
    at_threshold(
        BLOCK,
        "warning: layer.sides: from t = 5.0000e-2 s the indenter presses",
        &pressed(0.0),
        &pressed(0.015),
    );
}

/// The penalty adds 1/(penalty C_zz(k)), k = pi over the width of the contact: 45 points overlap. C_zz is the bonded layer's.
#[test]
fn penalty_at_its_threshold() {
    let width = 45.0 * 1.25e-4 / SQRT_2;
    let softness = Layer { depth: 0.01 }.compliance(PI / width, Moduli::from_young(2e6, 0.3)).zz.re;
    let taking = |share: f64| vec![format!("contact={{penalty={:e}}}", 1.0 / (share * softness))];
    let penalty = taking(0.06)[0].split('=').next_back().unwrap().trim_end_matches('}').parse::<f64>().unwrap();
    let warning =
        format!("warning: contact.penalty: the penalty of {penalty:.2e} Pa/m adds 0.060 times the compliance");
    at_threshold(BLOCK, &warning, &taking(0.06), &taking(0.0499));
}

#[test]
fn profiles_at_their_thresholds() {
    let file = |name: &str| vec![format!(r#"indenter={{profile="sampled",file="{name}.txt",extend="error"}}"#)];
    let unit = "warning: indenter.file: the file looks like mm read as m: it is 40.1 m long, 1e3 times the face";
    at_threshold(BLOCK, unit, &file("long"), &file("shorter"));
    let rough = |shortest: f64| {
        let keys = format!("hurst=0.8,rms_slope=0.001,shortest={shortest},longest=1.0,seed=1");
        vec![format!(r#"indenter={{profile="rough",{keys}}}"#)]
    };
    at_threshold(WAVE, "warning: layer.cells: 3.84 cells to the shortest wave", &rough(0.12), &rough(0.125));
    // A wedge of slope s between nodes is off by s dx/4, s dx/2, s dx/4 at the points of one edge of n that overlap: its root
    // mean square is s dx sqrt(0.375/(3 n)), 1.02e-5 m of 7.4e-5 m for n = 3 and 7.9e-6 m of 1e-4 m for n = 5.
    let wedge = |slope: f64, centre: f64, depth: f64| {
        vec![format!(r#"indenter={{profile="wedge",slope={slope},centre={centre}}}"#), approach(depth)]
    };
    let between = "warning: layer.cells: between the nodes (5.000e-4 m apart) the profile is 1.02e-5 m (rms) off what they see of \
                   it, 14 % of the deepest overlap";
    at_threshold(BLOCK, between, &wedge(0.1, 0.01525, 7.4e-5), &wedge(0.1, 0.01525, 1e-4));
    let slope = "warning: indenter: the profile's slope is 0.301 in the contact";
    at_threshold(BLOCK, slope, &wedge(0.301, 0.015, 2e-4), &wedge(0.3, 0.015, 2e-4));
    // A flank that the punch brings along when it slides, and never touches when it does not.
    let punch = r#"indenter={profile="expression",formula="2*max(0,abs(x-0.02)-0.005)"}"#.to_owned();
    let slides = vec![punch.clone(), then("velocity=0.01,distance=0.005,steps=60")];
    at_threshold(BLOCK, "warning: indenter: the profile's slope is 2.000 beside the contact", &slides, &[punch]);
}

/// The overlap of sqrt(2) 4.0 mm passes in 0.4 s at 1 cm/s: heat enters sqrt(D 0.4 s), beside cells of 0.38 mm. The pole of the law is at
/// 241.4 K.
#[test]
fn heat_at_its_thresholds() {
    let warm = |conductivity: f64, coupled: &[String]| {
        let heat = format!("heat={{initial=293.0,base=293.0,coupled={}}}", !coupled.is_empty());
        let own = [heat, format!("material.conductivity={conductivity}"), "material.heat_capacity=2e6".to_owned()];
        let slides = [tanh(1e-6), then("velocity=0.01,distance=0.01,steps=100")];
        [&own[..], &slides, coupled].concat()
    };
    let skin = "warning: layer.cells: cells at the face are 3.80e-4 m high";
    at_threshold(BLOCK, skin, &warm(0.7, &[]), &warm(0.75, &[]));
    let law = |initial: f64| {
        let arms = ["material.arms=[{weight=0.3,time=1.0}]", "material.poisson_rule=\"constant_ratio\""];
        let shift =
            ["material.shift=\"wlf\"", "material.c1=17.44", "material.c2=51.6", "material.reference_temperature=293"];
        let told = [format!("heat.initial={initial}"), format!("material.temperature={initial}")];
        [strings(&arms), strings(&shift), told.to_vec()].concat()
    };
    let told = "warning: material.shift: the body reaches 291.3 K, 49.9 K above the pole of the WLF law";
    at_threshold(BLOCK, told, &warm(1.0, &law(291.3)), &warm(1.0, &law(291.5)));
}

#[test]
fn bodies_at_their_thresholds() {
    let ratio = |nu: f64| vec![format!("material.poisson_ratio={nu}")];
    at_threshold(BLOCK, "warning: layer.element: q4 with a Poisson ratio of 0.45010000", &ratio(0.4501), &ratio(0.45));
    // K/G = 2 (1 + nu)/(3 (1 - 2 nu)) = 14/3 at nu = 0.4; with G relaxed to 0.4, (3K - 2G)/(2 (3K + G)) = 0.458333.
    let relaxing = |rule: &str| {
        let arms = "material.arms=[{weight=0.6,time=1.0}]";
        strings(&["material.poisson_ratio=0.4", arms, &format!(r#"material.poisson_rule="{rule}""#)])
    };
    let locks = "warning: layer.element: q4 with a Poisson ratio of 0.45833333";
    at_threshold(BLOCK, locks, &relaxing("constant_bulk_modulus"), &relaxing("constant_ratio"));
    let deep = "warning: phase.press.approach: the indenter goes 1.010e-3 m into a body of 1.000e-2 m, 0.101 of it";
    at_threshold(BLOCK, deep, &[approach(1.01e-3)], &[approach(1e-3)]);
    let young = |pascal: f64| vec![format!("material.young_modulus={pascal}")];
    at_threshold(BLOCK, "warning: material.shear_modulus: Young's modulus is 99.0000 Pa", &young(99.0), &young(100.0));
    let arm = |weight: f64| {
        strings(&[
            &format!("material.arms=[{{weight={weight:?},time=1e-22}}]"),
            r#"material.poisson_rule="constant_ratio""#,
            "contact={penalty=1e12}",
        ])
    };
    let digits =
        "warning: material.arms: the instantaneous modulus is 1.0e9 times what the shortest step (5.00e-2 s) meets";
    at_threshold(BLOCK, digits, &arm(1.0 - 1e-9), &arm(1.0 - 2e-8));
}

#[test]
fn loading_at_its_thresholds() {
    // The approach is at 4e-4 m/s.
    let approaching = "warning: friction.regularisation: 8.000e-6 m/s is 0.020 times the slowest motion that friction resists, \
                       the approach of \"press\" at 4.000e-4 m/s";
    at_threshold(BLOCK, approaching, &[tanh(8e-6)], &[tanh(4e-6)]);
    let sliding = "warning: friction.regularisation: 4.000e-6 m/s is 0.040 times the slowest motion that friction resists, the \
                   sliding of \"move\" at 1.000e-4 m/s";
    let slow = |rate: f64| vec![tanh(rate), then("velocity=1e-4,distance=5e-5,steps=10")];
    at_threshold(BLOCK, sliding, &slow(4e-6), &slow(1e-6));
    // 0.3 times the approach, 6e-5 m; a slide of 5e-5 m.
    let slipping = "warning: friction.elastic_slip: 1.200e-6 m is 0.020 times the shortest motion";
    at_threshold(BLOCK, slipping, &[slip(1.2e-6)], &[slip(6e-7)]);
    let short = |length: f64| vec![slip(length), then("velocity=1e-4,distance=5e-5,steps=10")];
    at_threshold(BLOCK, "warning: friction.elastic_slip: 6.000e-7 m is 0.012 times", &short(6e-7), &short(5e-7));
    let fret = |steps: usize| {
        vec![slip(1e-7), then(&format!("duration=1.0,steps={steps},tangential={{amplitude=2e-5,cycles=5}}"))]
    };
    at_threshold(BLOCK, "warning: phase.move.steps: 7.80 steps to a cycle", &fret(39), &fret(40));
    // The contact of 3.98e-3 m passes in 0.398 s, to which the arm of 0.01 s does not matter, and a quarter of which is 0.0994 s.
    let arms = |steps: usize| {
        let arms = "material.arms=[{weight=0.3,time=0.01},{weight=0.3,time=0.1}]".to_owned();
        let slide = then(&format!("velocity=0.01,distance=0.005,steps={steps}"));
        vec![arms, r#"material.poisson_rule="constant_ratio""#.to_owned(), slide]
    };
    let slow = "warning: phase.move.steps: steps of 1.250e-1 s are 1.2 times the arm of 1.000e-1 s, which matters to a motion over \
                3.98e-1 s";
    at_threshold(BLOCK, slow, &arms(4), &arms(5));
}

/// A scene with one warning before it is solved and one after: its penalty is a hundred times too soft.
fn doubtful() -> Run {
    Run::new(BLOCK).set("contact={penalty=1e8}").set("layer.cells=[48,6]")
}

fn keys(outcome: &Outcome) -> Vec<String> {
    let warnings = outcome.results().warnings().unwrap();
    warnings.iter().map(|warning| warning.split(": ").next().unwrap().to_owned()).collect()
}

/// Each warning is told once, on standard error, by the first of two ranks too; the file has them all and the summary counts
/// them; denied they give exit code 6, with the same results.
#[test]
fn warnings_are_told_counted_and_kept() {
    for ranks in [1, 2] {
        let outcome = doubtful().ranks(ranks).done();
        assert_eq!(outcome.stderr.matches("warning: contact.penalty: ").count(), 2, "{}", outcome.stderr);
        assert_eq!(outcome.stderr.matches("penetrated the face by").count(), 1, "{}", outcome.stderr);
        assert!(outcome.stdout.contains("warnings:      2"), "{}", outcome.stdout);
        assert_eq!(keys(&outcome), ["contact.penalty", "contact.penalty"]);
        let denied = doubtful().ranks(ranks).argument("--deny-warnings").run();
        assert_eq!((denied.code, denied.stderr.matches("mpjr: ").count()), (6, 1), "{}", denied.stderr);
        assert_eq!(denied.results().text("status").unwrap(), "complete");
        assert_eq!(denied.history("normal_force"), outcome.history("normal_force"));
    }
    let quiet = doubtful().argument("-q").done();
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.lines().count()), ("", 2));
    let sound = Run::new(BLOCK).argument("--deny-warnings").argument("-q").done();
    assert_eq!((sound.stdout + &sound.stderr, sound.directory.path().join("scene.h5").exists()), (String::new(), true));
}

/// The summary as JSON: the last row of the history under its names, and the warnings.
#[test]
fn summaries_as_json() {
    let outcome = doubtful().argument("--json").done();
    let summary: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(summary["status"], "complete");
    assert_eq!(summary["warnings"].as_array().unwrap().len(), 2);
    assert_eq!(summary["last"]["normal_force"].as_f64().unwrap(), outcome.last("normal_force"));
    assert_eq!(summary["last"]["energy/stored"].as_f64().unwrap(), outcome.last("energy/stored"));
    let run = doubtful();
    let mut check = Command::new(MPJR);
    check.current_dir(run.directory()).args(["check", "--json", "scene.toml", "--set", "contact={penalty=1e8}"]);
    let plan: serde_json::Value = serde_json::from_str(&output_of(&mut check)).unwrap();
    assert_eq!((plan["steps"].as_u64(), plan["warnings"].as_array().unwrap().len()), (Some(10), 1));
    assert_eq!(plan["unknowns"].as_u64(), Some(2 * 81 * 12));
}

/// A run that was stopped and goes on ends with the warnings of one that was not.
#[test]
fn warnings_after_a_stop() {
    let whole = doubtful().set("output.checkpoint_every=4").done();
    let run = doubtful().set("output.checkpoint_every=4");
    let directory = run.directory();
    // Killed once there is a checkpoint; where it was faster, it is complete.
    let mut child = run.command().stdout(std::process::Stdio::null()).spawn().unwrap();
    while !directory.join("scene.h5.checkpoint").exists() && child.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    let _ = child.kill();
    child.wait().unwrap();
    let resumed = run.argument("--resume").run();
    assert_eq!(resumed.code, 0, "{}", resumed.stderr);
    assert_eq!(keys(&resumed), keys(&whole));
}

/// A sweep tells a warning that its cases share once, counts them in its table, and denies them at its end.
#[test]
fn a_sweep_tells_of_its_cases() {
    let run = doubtful();
    let sweep = "scene = \"scene.toml\"\n[vary]\n\"contact.penalty\" = [1e8, 2e8, 1e13]\n";
    let scene = BLOCK.replace("tolerance = 0.01", "penalty = 1e11");
    std::fs::write(run.directory().join("scene.toml"), scene).unwrap();
    std::fs::write(run.directory().join("sweep.toml"), sweep).unwrap();
    let mut command = program(1);
    command.current_dir(run.directory()).args(["sweep", "sweep.toml", "-q", "--deny-warnings"]);
    let output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(6), 0), "{text}");
    let told: Vec<&str> = text.lines().filter(|line| line.starts_with("warning: contact.penalty: ")).collect();
    assert_eq!(told.len(), 1, "{text}");
    assert!(told[0].ends_with("(case 0 and 1 more)"), "{text}");
    let table = std::fs::read_to_string(run.directory().join("sweep/summary.csv")).unwrap();
    let column = table.lines().next().unwrap().split(',').position(|name| name == "warnings").unwrap();
    let counts: Vec<&str> = table.lines().skip(1).map(|line| line.split(',').nth(column).unwrap()).collect();
    assert_eq!(counts, ["2", "2", "0"]);
    let case = Results::open(&run.directory().join("sweep/case-0002.h5")).unwrap();
    assert!(case.warnings().unwrap().is_empty());
}

/// Numbers that have lost digits are refused, and those that overflow end the run with what was good.
#[test]
fn numbers_that_are_none() {
    let arm = |time: &str| {
        let arms = format!("material.arms=[{{weight=0.5,time={time}}}]");
        Run::new(WAVE).set(arms).set(r#"material.poisson_rule="constant_ratio""#)
    };
    let refused = arm("5e-324").run();
    assert_eq!(refused.code, 2);
    refused.assert_single_message("material.arms.0.time: must be a positive relaxation time in s, at least 2.3e-308");
    let carried = arm("1e-307").done();
    assert!(carried.history("energy/viscoelastic_dissipation").iter().all(|value| value.is_finite()));
}
