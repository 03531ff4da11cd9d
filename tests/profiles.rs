//! Profiles from the scene to the result file: what differs only in how it is written gives the same contact.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::Path;

use mpjr::composition::{elevations, outline, shape};
use mpjr::oracle::{Layer, Moduli};
use mpjr::output::reader::Results;
use mpjr::profile::Profile;
use mpjr::scene::{Source, added_compliance, read};

const SCENE: &str = r#"
[layer]
width = 1.0
depth = 0.5
cells = [32, 4]
sides = "periodic"
[material]
shear_modulus = 568.498
poisson_ratio = 0.3
arms = [ { weight = 0.579, time = 0.817 } ]
poisson_rule = "constant_ratio"
[contact]
tolerance = 1e-2
[friction]
law = "coulomb_tanh"
coefficient = 0.2
regularisation = 2e-4
[solver]
tolerance = 1e-14
[[phase]]
duration = 1.0
steps = 3
approach = 4e-4
[[phase]]
velocity = 0.02
distance = 0.11
steps = 5
[indenter]
"#;

const HARMONIC: &str = "profile = \"harmonic\"\namplitude = 5e-4\nwavelength = 1.0\n";
const ROUGH: &str = "profile = \"rough\"\nhurst = 0.8\nrms_height = 2e-4\nshortest = 0.125\nlongest = 0.5\nseed = 11\n";

/// Points of the harmonic profile over one period, the last one left out.
fn write_cosine(file: &Path, points: usize) -> Vec<f64> {
    let height = |k: usize| 5e-4 * (1.0 - (2.0 * std::f64::consts::PI * k as f64 / points as f64).cos());
    let heights: Vec<f64> = (0..points).map(height).collect();
    let line = |(k, h): (usize, &f64)| format!("{:?} {h:?}\n", k as f64 / points as f64);
    std::fs::write(file, heights.iter().enumerate().map(line).collect::<String>()).unwrap();
    heights
}

/// Normal, tangential and hysteretic force of all steps of a run in `directory`.
fn run(directory: &Path, indenter: &str, ranks: usize) -> [Vec<f64>; 3] {
    let [scene, out] = ["scene.toml", "scene.h5"].map(|name| directory.join(name));
    std::fs::write(&scene, SCENE.to_owned() + indenter).unwrap();
    let mut command = common::mpi::mpirun(ranks);
    command.arg(env!("CARGO_BIN_EXE_mpjr")).arg("run").arg(&scene).arg("--out").arg(&out);
    let output = command.env("OMP_NUM_THREADS", "1").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let results = Results::open(&out).unwrap();
    ["normal_force", "tangential_force", "hysteretic_force"].map(|name| results.history(name).unwrap())
}

/// The greatest difference of each force of two runs, relative to its greatest value.
fn differences(one: &[Vec<f64>; 3], other: &[Vec<f64>; 3]) -> [f64; 3] {
    [0, 1, 2].map(|force| {
        let (a, b) = (&one[force], &other[force]);
        assert_eq!((a.len(), b.len()), (9, 9));
        let scale = a.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        assert!(scale > 0.0);
        a.iter().zip(b).map(|(a, b)| (a - b).abs() / scale).fold(0.0, f64::max)
    })
}

fn difference(one: &[Vec<f64>; 3], other: &[Vec<f64>; 3]) -> f64 {
    differences(one, other).into_iter().fold(0.0, f64::max)
}

#[test]
fn one_profile_written_three_ways() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    let harmonic = run(directory, HARMONIC, 1);
    let formula = "profile = \"expression\"\nformula = \"5e-4*(1-cos(2*pi*x))\"\n";
    // 1 - cos loses digits that 2 sin^2 of the half angle keeps: eps times the amplitude, 1e-19 m, of a penetration
    // of 1e-8 m and up is 1e-11 of the traction there.
    for ranks in [1, 2] {
        let expression = difference(&harmonic, &run(directory, formula, ranks));
        assert!(expression < 1e-11, "expression on {ranks}: {expression:e}");
    }
    // Linear interpolation is off by (2 pi)^2 / (8 n^2) of the amplitude in height, by 2 pi / (2 n) in slope.
    let sampled = "profile = \"sampled\"\nfile = \"data/cosine.txt\"\nextend = \"periodic\"\n";
    std::fs::create_dir(directory.join("data")).unwrap();
    for points in [100, 1000, 10_000] {
        write_cosine(&directory.join("data/cosine.txt"), points);
        let [normal, tangential, hysteretic] = differences(&harmonic, &run(directory, sampled, 2));
        let n = points as f64;
        println!("{points} points: {normal:e} {tangential:e} {hysteretic:e}");
        assert!(normal.max(tangential) < 20.0 / n.powi(2), "{points} points: {normal:e} {tangential:e}");
        assert!(hysteretic < 20.0 / n, "{points} points: {hysteretic:e}");
    }
}

#[test]
fn a_rough_profile_does_not_depend_on_the_ranks() {
    let directory = tempfile::tempdir().unwrap();
    let alone = run(directory.path(), ROUGH, 1);
    let ranks = difference(&alone, &run(directory.path(), ROUGH, 2));
    assert!(ranks < 1e-11, "{ranks:e}");
    let other = run(directory.path(), &ROUGH.replace("seed = 11", "seed = 12"), 1);
    assert!(difference(&alone, &other) > 1e-3);
}

/// With the nodes on the sampling points and no sliding, the nodal elevations are the file's numbers.
#[test]
fn nodes_on_sampling_points_have_the_file_s_numbers() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("scene.toml");
    let heights = write_cosine(&directory.path().join("wave.txt"), 48);
    for (sides, extend, cells) in [("periodic", "periodic", 48), ("free", "error", 47)] {
        let mut text = SCENE.replace("\"periodic\"", &format!("{sides:?}"));
        text = text.replace("[32, 4]", &format!("[{cells}, 1]")).replace("0.02\ndistance = 0.11", "0\nduration = 1");
        text = text.replace("width = 1.0", &format!("width = {:?}", f64::from(cells) / 48.0));
        text += &format!("profile = \"sampled\"\nfile = \"wave.txt\"\nextend = {extend:?}\n");
        let scene = read(&text, &Source { file: file.clone(), overrides: vec![] }).unwrap();
        let face = outline(&scene, &file).unwrap().face;
        let profile = shape(&scene, &file, &elevations(&scene, &file).unwrap(), face).unwrap().profile;
        for (k, height) in heights.iter().enumerate() {
            // As the mesh has its nodes.
            let x = scene.layer().unwrap().width * k as f64 / f64::from(cells);
            assert_eq!(profile.at(x).unwrap().height, *height, "{sides} {k}");
        }
    }
}

/// A file that is not there is an error of files, and says who wants it.
#[test]
fn a_missing_file_is_named() {
    let text = SCENE.to_owned() + "profile = \"sampled\"\nfile = \"none.txt\"\nextend = \"periodic\"\n";
    let file = Path::new("some/dir/scene.toml");
    let scene = read(&text, &Source { file: file.to_owned(), overrides: vec![] }).unwrap();
    let error = elevations(&scene, file).unwrap_err();
    assert_eq!(error.exit_code(), 4);
    let message = error.to_string();
    assert!(message.starts_with("some/dir/none.txt: cannot be read: No such file"), "{message}");
    assert!(message.ends_with("; it is indenter.file of some/dir/scene.toml"), "{message}");
}

/// The penalty that a tolerance gives adds no more than that to any wave that the mesh resolves, and not much less to
/// the one that the layer is stiffest to.
#[test]
fn a_tolerance_bounds_the_added_compliance() {
    for ratio in [-0.5, 0.0, 0.3, 0.49, 0.4999, 0.499_999] {
        for depth in [0.1, 1.0, 10.0] {
            let set = [format!("material.poisson_ratio={ratio}"), format!("layer.depth={depth}")];
            let file = Path::new("scene.toml").to_owned();
            let scene = read(&(SCENE.to_owned() + HARMONIC), &Source { file, overrides: set.to_vec() }).unwrap();
            let penalty = scene.contact.penalty.stiffness().unwrap();
            let layer = Layer { depth };
            let moduli = Moduli { shear: scene.materials[0].shear_modulus.into(), poisson: ratio.into() };
            // From no wave to the wave of two cells.
            let wave = |j: usize| std::f64::consts::PI * 32.0 * j as f64 / 3200.0;
            let added = (0..=3200).map(|j| 1.0 / (penalty * layer.compliance(wave(j), moduli).zz.re));
            let most = added.fold(0.0, f64::max);
            assert!((0.99e-2..1.02e-2).contains(&most), "{ratio} {depth}: {most:e}");
            let said = added_compliance(penalty, scene.layer().unwrap(), &scene.materials);
            assert!((said / 1e-2 - 1.0).abs() < 1e-12);
        }
    }
}
