//! Profiles from the scene to the result file: what differs only in how it is written gives the same contact.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::Path;

use common::compare;
use common::program::run_in;
use common::scene::{ONE_ARM, Text, layer};
use mpjr::composition::{Shape, elevations, outline, seam_doubt, shape};
use mpjr::oracle::{Layer, Moduli};
use mpjr::profile::Profile;
use mpjr::scene::{Penalty, Scene, Source, added_compliance, read, shortest_step};

static SCENE: Text = Text::new(|| {
    let law = "law = \"coulomb_tanh\"\ncoefficient = 0.2\nregularisation = 2e-4\n";
    let rest = format!("[contact]\ntolerance = 1e-2\n[friction]\n{law}[solver]\ntolerance = 1e-14\n");
    let press = "[[phase]]\nduration = 1.0\nsteps = 3\napproach = 4e-4\n";
    let slide = "[[phase]]\nvelocity = 0.02\ndistance = 0.11\nsteps = 5\n";
    [&layer("1.0", "0.5", "[32, 4]"), ONE_ARM, &rest, press, slide, "[indenter]\n"].concat()
});

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
    let results = run_in(directory, &(SCENE.clone() + indenter), ranks);
    ["normal_force", "tangential_force", "hysteretic_force"].map(|name| results.history(name).unwrap())
}

/// The greatest difference of each force of two runs, relative to its greatest value.
fn differences(one: &[Vec<f64>; 3], other: &[Vec<f64>; 3]) -> [f64; 3] {
    [0, 1, 2].map(|force| {
        assert!(one[force].len() == 9 && one[force].iter().any(|value| *value != 0.0));
        compare::difference(&one[force], &other[force])
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
        let outline = outline(&scene, &file).unwrap();
        let profile = shape(&scene, &file, &elevations(&scene, &file).unwrap(), &outline).unwrap().profile;
        for (k, height) in heights.iter().enumerate() {
            // As the mesh has its nodes.
            let x = scene.layer().unwrap().spans[0].width * k as f64 / f64::from(cells);
            assert_eq!(profile.at(x).unwrap().height, *height, "{sides} {k}");
        }
    }
}

/// A file that is not there is an error of files, and says who wants it.
#[test]
fn a_missing_file_is_named() {
    let text = SCENE.clone() + "profile = \"sampled\"\nfile = \"none.txt\"\nextend = \"periodic\"\n";
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
            let scene = read(&(SCENE.clone() + HARMONIC), &Source { file, overrides: set.to_vec() }).unwrap();
            let penalty = match scene.contact.penalty {
                Some(Penalty::Stiffness(stiffness)) => stiffness,
                other => panic!("{other:?}"),
            };
            let layer = Layer { depth };
            // The mean over the shortest step.
            let material = &scene.materials[0];
            let step = shortest_step(&scene.phases);
            let relaxed = material.shear_series().integral(step) / step;
            let moduli = Moduli { shear: (material.shear_modulus * relaxed).into(), poisson: ratio.into() };
            // From no wave to the wave of two cells.
            let wave = |j: usize| std::f64::consts::PI * 32.0 * j as f64 / 3200.0;
            let added = (0..=3200).map(|j| 1.0 / (penalty * layer.compliance(wave(j), moduli).zz.re));
            let most = added.fold(0.0, f64::max);
            assert!((0.99e-2..1.02e-2).contains(&most), "{ratio} {depth}: {most:e}");
            let said =
                added_compliance(penalty, scene.layer().unwrap(), &scene.materials, shortest_step(&scene.phases));
            assert!((said / 1e-2 - 1.0).abs() < 1e-12);
        }
    }
}

/// A scene with a sampled profile that reads `text`, a free-sided face of 1 m unless `set` says otherwise.
fn sampled(text: &[u8], keys: &str, set: &[&str]) -> (tempfile::TempDir, std::path::PathBuf, Scene) {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("line.txt"), text).unwrap();
    let file = directory.path().join("scene.toml");
    let still = SCENE.replace("0.02\ndistance = 0.11", "0\nduration = 1");
    let scene = still + "profile = \"sampled\"\nfile = \"line.txt\"\n" + keys;
    std::fs::write(&file, &scene).unwrap();
    let overrides = set.iter().map(|&set| set.to_owned()).collect();
    let scene = read(&scene, &Source { file: file.clone(), overrides }).unwrap();
    (directory, file, scene)
}

const BOUNDED: [&str; 3] = ["layer.sides=free", "indenter.extend=error", "layer.cells=[16,4]"];

fn shape_of(file: &Path, scene: &Scene) -> Result<Shape, mpjr::error::Error> {
    let outline = outline(scene, file)?;
    shape(scene, file, &elevations(scene, file)?, &outline)
}

/// Elevations of a valley 4 um deep over a face of 40 um, in m; the same as five instruments would write them.
#[test]
fn one_line_from_many_instruments() {
    let plain = "0 4e-6\n1e-5 1e-6\n2e-5 0\n3e-5 1.5e-6\n4e-5 4e-6\n";
    let latin = "Messung\t1\nX (\u{b5}m)\tZ (\u{b5}m)\n0,0\t4,0\n10,0\t1,0\n20,0\t0,0\n30,0\t1,5\n40,0\t4,0\n";
    let utf16: Vec<u8> = ("\u{feff}".to_owned() + latin).encode_utf16().flat_map(u16::to_le_bytes).collect();
    let latin: Vec<u8> = latin.chars().map(|letter| u8::try_from(u32::from(letter)).unwrap()).collect();
    let files: [(&[u8], &str); 6] = [
        (plain.as_bytes(), ""),
        (&latin, ""),
        (&utf16, ""),
        (b"X_(microns),Z_(microns)\r\n0,4\r\n10,1\r\n20,0\r\n30,1.5\r\n40,4\r\n", ""),
        (b"40;7;4\n30;7;1,5\n25;8;Bad\n20;7;0\n10;7;1\n0;7;4\n", "columns = [1, 3]\nunit = \"um\"\n"),
        (
            b"n,x,z\n1,0,-4000\n2,0.01,-1000\n3,0.02,0\n4,0.03,-1500\n5,0.04,-4000\n",
            "columns = [\"x\", \"z\"]\nx_unit = \"mm\"\nz_unit = \"nm\"\ninvert = true\n",
        ),
    ];
    for (text, keys) in files {
        let small = [&BOUNDED[..], &["layer.width=4e-5", "layer.depth=1e-5", "phase.0.approach=1e-7"]].concat();
        let (_directory, file, scene) = sampled(text, &format!("extend = \"periodic\"\n{keys}"), &small);
        let profile = shape_of(&file, &scene).unwrap().profile;
        for (x, height) in [(0.0, 4e-6), (5e-6, 2.5e-6), (1e-5, 1e-6), (2e-5, 0.0), (3e-5, 1.5e-6), (4e-5, 4e-6)] {
            let found = profile.at(x).unwrap().height;
            assert!((found - height).abs() < 1e-20, "{keys}: {found:e} at {x}");
        }
    }
}

/// A bump that stands up in the file touches only when it is turned over; `check` draws which points do.
#[test]
fn a_peak_that_is_to_touch_first_is_turned_over() {
    let bump = |x: f64| 1e-3 * (-((x - 0.25) / 0.05).powi(2)).exp();
    let text: String = (0..=400).map(|k| f64::from(k) / 400.0).map(|x| format!("{x} {}\n", bump(x))).collect();
    let touching = |keys: &str| {
        let (directory, file, scene) = sampled(text.as_bytes(), &format!("extend = \"periodic\"\n{keys}"), &BOUNDED);
        let lowest = shape_of(&file, &scene).unwrap().survey.range()[0];
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_mpjr"));
        command.arg("check").arg(&file).args(BOUNDED.iter().flat_map(|set| ["--set", set])).current_dir(&directory);
        let output = common::program::output_of(&mut command);
        let mark = output.lines().find(|line| line.trim_start_matches(['#', ' ']).starts_with('^')).unwrap().to_owned();
        (lowest, mark.matches('^').count())
    };
    let (lowest, columns) = touching("");
    assert!(lowest.abs() < 1e-9 && columns > 40, "{lowest:e} {columns}");
    let (lowest, columns) = touching("invert = true\noffset = 1e-3\n");
    assert!(lowest.abs() < 1e-9 && (1..8).contains(&columns), "{lowest:e} {columns}");
}

/// A tilted line is a wall where it repeats: said with its height, closed by blending or by taking off the tilt.
#[test]
fn a_wall_at_the_seam_is_said_and_closed() {
    let height = |x: f64| 1e-4 * (1.0 - (2.0 * std::f64::consts::PI * x).cos()) + 1e-3 * x;
    let text: String = (0..100).map(|k| f64::from(k) / 100.0).map(|x| format!("{x} {}\n", height(x))).collect();
    let doubt = |keys: &str| {
        let (_directory, file, scene) = sampled(text.as_bytes(), &format!("extend = \"periodic\"\n{keys}"), &[]);
        let elevations = elevations(&scene, &file).unwrap();
        let steepest = shape_of(&file, &scene).unwrap().survey.points.iter().map(|p| p.slope.abs()).fold(0.0, f64::max);
        (seam_doubt(&scene, &elevations), steepest)
    };
    let (said, steepest) = doubt("");
    let (key, reason) = said.unwrap();
    // From 0.99 um at the last point, h(0.99) = 9.9e-4 + 2e-7, to 0 at the first, over one spacing.
    assert!(key == "indenter.seam" && reason.contains("9.902e-4 m apart"), "{reason}");
    assert!((steepest - 0.099).abs() < 1e-3, "{steepest}");
    let (said, steepest) = doubt("seam = \"blend\"\n");
    // Half of the jump over 0.05 m with the smooth step's steepest slope, 1.5, beside the slopes of the line.
    assert!(said.is_none() && steepest < 0.5 * 9.9e-4 / 0.05 * 1.5 + 2e-3, "{steepest}");
    let (said, steepest) = doubt("detrend = \"line\"\n");
    assert!(said.is_none() && steepest < 2e-3, "{steepest}");
}

/// Numbers in um read as m are told from a file that is too short.
#[test]
fn a_file_in_micrometres_read_as_metres_is_told() {
    let text = "39.2 190.8\n500.0 192.0\n1723.8 191.0\n";
    let small = [&BOUNDED[..], &["layer.width=4e-5", "layer.depth=1e-5", "phase.0.approach=1e-7"]].concat();
    let (_directory, file, scene) = sampled(text.as_bytes(), "extend = \"periodic\"\n", &small);
    let message = shape_of(&file, &scene).err().unwrap().to_string();
    assert!(message.contains("the file looks like um read as m"), "{message}");
    assert!(message.contains("4e7 times the face; say unit = \"um\""), "{message}");
}
