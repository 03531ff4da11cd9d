//! Faces whose compliance is known by its products alone, one solve with the body each: by a factor and by multigrid the same histories as by
//! the dense matrix. On small bodies an option asks for it; on large ones the size does.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::process::Stdio;

use common::program::{Outcome, Run, wait_for};
use common::solid::Body;
use mpjr::composition::{Outline, Stretch, choose};
use mpjr::solve::Means;

/// What all scenes have: two arms, no penetration, Coulomb's law itself, partial slip and sliding.
const REST: &str = r#"
[material]
shear_modulus = 568.498
poisson_ratio = 0.3
arms = [ { weight = 0.3, time = 0.2 }, { weight = 0.4, time = 2.0 } ]
poisson_rule = "constant_ratio"
[contact]
[friction]
law = "coulomb"
coefficient = 0.3
[solver]
tolerance = 1e-11
"#;
const SPACE: &str = "[indenter]\nprofile = \"paraboloid\"\nradius = 2.0\ncentre = [0.5, 0.45]\n";
const PLANE: &str = "[layer]\nwidth = 1.0\ndepth = 0.5\ncells = [24, 8]\nsides = \"free\"\n[indenter]\nprofile = \"parabola\"\nradius = 2.0\ncentre = 0.45\n";
const BOX: &str =
    "[layer]\nwidth = [1.0, 1.0]\ndepth = 0.5\ncells = [7, 6, 4]\nsides = \"free\"\nelement = \"h8_bbar\"\n";
const MESH: &str = "[mesh]\nfile = \"body.msh\"\ncontact = \"top\"\nfixed = [\"base\"]\n";
/// In partial slip, then sliding by more than a cell a step; `down` presses.
fn phases(down: &str, velocity: &str) -> String {
    format!(
        "[[phase]]\nname = \"press\"\nduration = 1.0\nsteps = 2\n{down}\n[[phase]]\nname = \"creep\"\nvelocity = {velocity}\nduration = 0.02\n\
         steps = 2\n[[phase]]\nname = \"drag\"\nvelocity = {velocity}\ndistance = 0.3\nsteps = 2\n"
    )
}
const DOWN: &str = "approach = 0.03";
const OBLIQUE: &str = "[0.1, 0.05]";
const BULK: &str = "material.poisson_rule=constant_bulk_modulus";
/// The ways beside the dense matrix.
const WAYS: [&str; 2] = ["-body_pc_type cholesky", "-body_pc_type gamg"];

/// Asserts that two runs have the same history and the same face, to so much of the largest value.
fn assert_same(a: &Outcome, b: &Outcome, within: f64, what: &str) {
    let apart = |name: &str, lists: [Vec<f64>; 2]| {
        let largest = |list: &[f64]| list.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let [x, y] = lists;
        let share = largest(&x.iter().zip(&y).map(|(x, y)| x - y).collect::<Vec<_>>()) / largest(&x);
        assert!(x.len() == y.len() && share < within, "{what}, {name}: {share:.1e}");
    };
    for column in ["normal_force", "tangential_force", "contact_fraction", "stick_fraction", "energy/stored"] {
        apart(column, [a, b].map(|run| run.history(column)));
    }
    for field in ["pressure", "shear"] {
        apart(field, [a, b].map(|run| run.results().interface(field).unwrap().values));
    }
}

/// Runs a scene by the dense matrix and by both other ways on so many ranks; the histories agree to 1e-8.
fn agree(what: &str, run: impl Fn() -> Run, ranks: usize) {
    let dense = run().done();
    assert!(
        dense.history("tangential_force").last().unwrap().abs() > 0.1 * dense.history("normal_force").last().unwrap()
    );
    assert!(!dense.stdout.contains("solves") || what.contains("bulk"), "{}", dense.stdout);
    for way in WAYS {
        let other = run().petsc(way).ranks(ranks).done();
        assert!(other.stdout.contains("solves"), "{}", other.stdout);
        assert_same(&dense, &other, 1e-8, &format!("{what} {way}"));
    }
}

/// Sets a list of keys, and asks for energy.
fn with(scene: &str, sets: &[&str]) -> Run {
    sets.iter().fold(Run::new(scene).set("output.energy=true"), |run, set| run.set(*set))
}

/// A layer with free ends in the plane, with both memories; under a force; at a penalty with an elastic slip.
#[test]
fn in_the_plane() {
    let scene = format!("{PLANE}{REST}{}", phases(DOWN, "0.1"));
    agree("ratio", || with(&scene, &[]), 1);
    agree("bulk", || with(&scene, &[BULK]), 3);
    let forced = format!("{PLANE}{REST}{}", phases("normal_force = 10.0", "0.1"));
    let soft = "friction={ law = \"coulomb_elastic_slip\", coefficient = 0.3, elastic_slip = 1e-4 }";
    agree("forced", || with(&forced, &["contact.penalty=1e5", soft]), 1);
}

/// Hexahedra with mean dilatation in space, with both memories, on one rank and on three; bulk fields behind them.
#[test]
fn hexahedra() {
    let scene = format!("{BOX}{SPACE}{REST}{}", phases(DOWN, OBLIQUE));
    agree("ratio", || with(&scene, &["output.bulk_at=[\"press\"]"]), 3);
    agree("bulk", || with(&scene, &[BULK, "material.poisson_ratio=0.49"]), 1);
}

/// The bulk fields of a body whose interior follows its face are the same by multigrid: displacements and stresses to 1e-8.
#[test]
fn fields_behind_the_face() {
    let scene = format!("{BOX}{SPACE}{REST}{}", phases(DOWN, OBLIQUE));
    let [dense, other] =
        ["", WAYS[1]].map(|way| with(&scene, &["output.bulk_at=[\"press\",\"drag\"]"]).petsc(way).done());
    for name in ["displacement", "stress"] {
        let [a, b] = [&dense, &other].map(|run| run.results().bulk(name).unwrap().values.clone());
        let largest = a.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let apart = a.iter().zip(&b).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / largest;
        assert!(a.len() == b.len() && apart < 1e-8, "{name}: {apart:.1e}");
    }
}

/// Tetrahedra with a bowed face out of shape, held all around its foot and at an edge of the face itself, with both memories.
#[test]
fn tetrahedra() {
    let moved = |node: &[f64; 3]| {
        let [x, y, z] = *node;
        let inside = if [x, y].iter().all(|x| *x > 0.0 && *x < 1.0) { 0.02 } else { 0.0 };
        let bow = 0.05 * ((x - 0.5).powi(2) + (y - 0.5).powi(2));
        [x + inside * (9.0 * y + 5.0 * z).sin(), y + inside * (7.0 * x).cos(), z - bow * (1.0 + 2.0 * z)]
    };
    let body = Body::layer([1.0, 1.0, 0.5], [7, 7, 4]);
    let count = body.nodes.len();
    let tops: Vec<[f64; 3]> = body.nodes.iter().filter(|node| node[2] == 0.0).map(moved).collect();
    let body = body.tetrahedra().moved(moved);
    assert_eq!(count, body.nodes.len());
    let top = |node: &[f64; 3]| tops.contains(node);
    let base = |node: &[f64; 3]| node[2] == -0.5 || (node[0] == 0.0 && node[2] > -0.2);
    let scene = format!("{MESH}{SPACE}{REST}{}", phases("approach = 0.02", OBLIQUE));
    let on = |sets: &[&str]| {
        let run = with(&scene, sets);
        body.write(&[("top", &top), ("base", &base)], &run.directory().join("body.msh"));
        run
    };
    agree("ratio", || on(&[]), 1);
    agree("bulk", || on(&[BULK]), 3);
}

/// Runs by a factor and by multigrid that are killed and go on from a checkpoint end with the same bits.
#[test]
fn goes_on_with_the_same_bits() {
    let scene = format!("{BOX}{SPACE}{REST}{}", phases(DOWN, OBLIQUE));
    for (sets, way) in [("output.energy=true", WAYS[0]), (BULK, WAYS[1])] {
        let run = || with(&scene, &[sets, "output.checkpoint_every=2", "phase.drag.steps=40"]).petsc(way);
        let (whole, killed) = (run().done(), run());
        let file = killed.directory().join("scene.h5");
        let mut child = killed.command().stdout(Stdio::null()).spawn().unwrap();
        wait_for(&mut child, &file, 6);
        assert_eq!(child.try_wait().unwrap(), None, "ended by itself");
        child.kill().unwrap();
        child.wait().unwrap();
        let on = killed.argument("--resume").done();
        for column in ["normal_force", "tangential_force", "hysteretic_force", "stick_fraction"] {
            assert_eq!(whole.history(column), on.history(column), "{way} {column}");
        }
        let [one, other] = [&whole, &on].map(|run| run.results().interface("pressure").unwrap().values);
        assert_eq!(one, other, "{way}");
    }
}

/// Where conjugate gradients do not converge the run says so, with the remedy, and ends as one that a solver ended.
#[test]
fn says_that_multigrid_did_not_converge() {
    let scene = format!("{BOX}{SPACE}{REST}{}", phases(DOWN, OBLIQUE));
    let run = with(&scene, &[]).petsc("-body_pc_type gamg -body_ksp_max_it 2").run();
    assert_eq!(run.code, 3, "{}{}", run.stdout, run.stderr);
    assert!(
        run.stderr.contains("did not solve for the body in 2 iterations")
            && run.stderr.contains("-body_pc_type cholesky")
    );
}

/// What is picked goes by the components of the face and by the memory that there is; an option is stronger. Where a force holds the indenter
/// all unknowns take a factor.
#[test]
fn picks_by_size() {
    let text = format!("{BOX}{SPACE}{REST}{}", phases(DOWN, OBLIQUE));
    let read = |text: &str| {
        let source = mpjr::scene::Source { file: "scene.toml".into(), overrides: Vec::new() };
        mpjr::scene::read(text, &source).unwrap()
    };
    let scene = read(&text);
    // 100 x 100 x 50 cells.
    let outline =
        Outline { across: Some(Stretch::default()), face_nodes: 10_201, unknowns: 1_530_150, ..Outline::default() };
    let pick = |most, bytes, asked| choose(&scene, &outline, (most, bytes), asked).unwrap();
    const PLENTY: f64 = 1e15;
    assert_eq!(pick(40_000, PLENTY, None).means, Means::Dense);
    assert_eq!(pick(30_000, PLENTY, None).means, Means::Factor);
    assert_eq!(pick(40_000, 2e10, None).means, Means::Multigrid);
    let asked = pick(40_000, PLENTY, Some("gamg"));
    assert!(asked.asked && asked.means == Means::Multigrid);
    assert_eq!(pick(40_000, 2e10, Some("cholesky")).means, Means::Factor);
    let monolithic = "law = \"coulomb_tanh\"\ncoefficient = 0.3\nregularisation = 1e-2";
    let text = text
        .replace("[contact]", "[contact]\npenalty = 1e5")
        .replace("law = \"coulomb\"\ncoefficient = 0.3", monolithic)
        .replace("[solver]", "[solver]\nstrategy = \"monolithic\"");
    let all = |text: &str, bytes| choose(&read(text), &outline, (40_000, bytes), None).unwrap().means;
    assert_eq!(all(&text, PLENTY), Means::Factor);
    assert_eq!(all(&text, 2e10), Means::Multigrid);
    assert_eq!(all(&text.replace(DOWN, "normal_force = 1.0"), 2e10), Means::Factor);
    let periodic = read(&format!("{BOX}{SPACE}{REST}{}", phases(DOWN, OBLIQUE)).replace("\"free\"", "\"periodic\""));
    assert_eq!(choose(&periodic, &outline, (0, 0.0), None), None);
}
