//! Bodies of several materials and bodies from .msh files, through the whole program.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

use common::msh::write_msh;
use common::program::{Run, assert_same, output_of, program};
use mpjr::mesh::{Layer, Mesh, Sides};
use mpjr::output::checkpoint;

/// A plate of 0.1 m on a soft layer of 0.3 m.
const CELLS: [usize; 2] = [40, 12];

/// The body of all of them.
fn body() -> Mesh<2> {
    Layer { strata: vec![PLATE], ..Layer::in_plane([1.0, 0.4], CELLS, Sides::Roller) }.mesh()
}
const PLATE: f64 = 0.1;

const AS_LAYER: &str = "[layer]\nwidth = 1.0\ndepth = 0.4\ncells = [40, 12]\nsides = \"roller\"\n\
                        element = \"q4_bbar\"\n[[material]]\nthickness = 0.1\n";
const AS_MESH: &str = "[mesh]\nfile = \"body.msh\"\ncontact = \"top\"\nfixed = [\"base\"]\nroller = [\"sides\"]\n\
                       element = \"q4_bbar\"\n[[material]]\nregion = \"plate\"\n";

/// A stiff plate on a soft layer that relaxes, under a parabola; `body` ends where the first material begins.
fn scene(body: &str, region_of_second: &str) -> String {
    format!(
        r#"{body}young_modulus = 1e5
        poisson_ratio = 0.2
        [[material]]
        {region_of_second}
        shear_modulus = 600.0
        poisson_ratio = 0.49
        arms = [{{ weight = 0.5, time = 0.4 }}]
        poisson_rule = "constant_bulk_modulus"
        [indenter]
        profile = "parabola"
        radius = 2.0
        centre = 0.45
        [contact]
        penalty = 1e8
        [friction]
        law = "coulomb_tanh"
        coefficient = 0.2
        regularisation = 1e-3
        [[phase]]
        name = "press"
        duration = 1.0
        steps = 8
        approach = 2e-3
        [[phase]]
        name = "drag"
        velocity = 0.1
        distance = 0.1
        steps = 8
        [solver]
        tolerance = 1e-11
        [output]
        bulk_at = ["drag"]
        "#
    )
}

/// The results of a run that keeps its directory.
fn results(run: Run) -> (tempfile::TempDir, PathBuf) {
    let outcome = run.done();
    let file = outcome.directory.path().join("scene.h5");
    (outcome.directory, file)
}

/// A layer of two strata, and the same nodes and cells from a file with two physical surfaces: the same numbers, with
/// either strategy, on one rank and on two.
#[test]
fn regions_of_a_mesh_are_strata_of_a_layer() {
    let (_kept, layer) = results(Run::new(&scene(AS_LAYER, "")));
    for (strategy, ranks) in [("condensed", 1), ("condensed", 2), ("monolithic", 1), ("monolithic", 2)] {
        let run =
            Run::new(&scene(AS_MESH, "region = \"soft\"")).set(format!("solver.strategy={strategy}")).ranks(ranks);
        write_msh(&body(), CELLS, &["plate", "soft"], &run.directory().join("body.msh"));
        let (_kept, mesh) = results(run);
        let [a, b] = [&layer, &mesh].map(|file| mpjr::output::reader::Results::open(file).unwrap());
        for column in ["normal_force", "tangential_force", "hysteretic_force"] {
            let (a, b) = (a.history(column).unwrap(), b.history(column).unwrap());
            let scale = a.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            let apart = a.iter().zip(&b).fold(0.0f64, |most, (x, y)| most.max((x - y).abs()));
            assert!(apart < 1e-8 * scale, "{strategy} on {ranks}: {column} {apart:e} of {scale:e}");
        }
        let stress = |results: &mpjr::output::reader::Results| {
            let values = results.bulk("stress").unwrap().values;
            values.iter().map(|s| s * s).sum::<f64>().sqrt()
        };
        assert!((stress(&a) / stress(&b) - 1.0).abs() < 1e-8, "{strategy} on {ranks}");
    }
}

/// The penalty by tolerance: that of the layer with the same nodes, whose upper stratum is all that the shortest wave meets,
/// and is stiffer to it than all strata are to the mean.
#[test]
fn a_tolerance_is_a_penalty_on_a_mesh_too() {
    let set = |run: Run| run.set("contact={ tolerance = 1e-3 }");
    let layer = set(Run::new(&scene(AS_LAYER, ""))).done();
    let run = set(Run::new(&scene(AS_MESH, "region = \"soft\"")));
    write_msh(&body(), CELLS, &["plate", "soft"], &run.directory().join("body.msh"));
    let mesh = run.done();
    for column in ["normal_force", "max_penetration"] {
        let (layer, mesh) = (layer.last(column), mesh.last(column));
        assert!(mesh > 0.0 && (mesh / layer - 1.0).abs() < 1e-6, "{column}: {mesh} {layer}");
    }
}

/// Strata under a flat indenter between rollers are springs in series: N/width = D/(sum of h (1-2nu)/(2 G (1-nu)) + 1/alpha).
#[test]
fn strata_are_springs_in_series() {
    let flat = "indenter={ profile = \"expression\", formula = \"0*x\" }";
    let outcome =
        Run::new(&scene(AS_LAYER, "")).set(flat).set("material.1.arms=[]").set("friction.coefficient=0.0").done();
    let compliance = |h: f64, g: f64, nu: f64| h * (1.0 - 2.0 * nu) / (2.0 * g * (1.0 - nu));
    let sum = compliance(PLATE, 1e5 / 2.4, 0.2) + compliance(0.3, 600.0, 0.49) + 1e-8;
    let found = outcome.at(1.0, "normal_force");
    assert!((found * sum / 2e-3 - 1.0).abs() < 1e-9, "{found}");
}

/// A face that bulges by a parabola under a flat indenter is a flat face under the parabola, but for what the bulge changes
/// of the body.
#[test]
fn a_curved_face_meets_a_flat_indenter() {
    let solve = |bulge: f64, indenter: &str| {
        let mut mesh = body();
        mesh.nodes.iter_mut().for_each(|node| node.y -= bulge * (node.x - 0.45).powi(2));
        let run = Run::new(&scene(AS_MESH, "region = \"soft\"")).set(format!("indenter={indenter}"));
        // A parabola that is dragged far presses elsewhere; the bulge does not.
        let run = run.set("phase.drag.distance=1e-3");
        write_msh(&mesh, CELLS, &["plate", "soft"], &run.directory().join("body.msh"));
        run.done()
    };
    let parabola = solve(0.0, "{ profile = \"parabola\", radius = 10.0, centre = 0.45 }");
    let bulging = solve(0.05, "{ profile = \"expression\", formula = \"0*x\" }");
    for column in ["normal_force", "tangential_force"] {
        let (one, other) = (parabola.last(column), bulging.last(column));
        println!("{column}: {one} under a parabola, {other} bulging");
        assert!((other / one - 1.0).abs() < 0.005, "{column}: {one} under a parabola, {other} bulging");
    }
}

/// The laminate of `runs/`, a mesh of three materials of which one has a memory of its own: killed after a checkpoint, it
/// goes on to the same bits.
#[test]
fn a_mesh_of_several_materials_is_resumed() {
    let directory = tempfile::tempdir().unwrap();
    let scene = common::directory("runs/laminate-cells.toml");
    let (whole, killed) = (directory.path().join("whole.h5"), directory.path().join("killed.h5"));
    let command = |out: &Path| {
        let mut command = program(1);
        command.arg("run").arg(&scene).arg("--out").arg(out).args(["--set", "output.checkpoint_every=5"]);
        command
    };
    output_of(&mut command(&whole));
    let mut child = command(&killed).stdout(Stdio::null()).spawn().unwrap();
    let begun = Instant::now();
    while !checkpoint::beside(&killed).exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "no checkpoint comes");
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(checkpoint::beside(&killed).exists(), "ended by itself");
    output_of(command(&killed).arg("--resume"));
    assert_same(&whole, &killed, 0.0);
}
