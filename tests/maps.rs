//! Measured surfaces: what differs only in how it is written gives the same contact, and a map is what it is a map of.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::Command;

use common::compare::difference;
use common::program::run_in;
use common::scene::{ONE_ARM, Text, coulomb, layer};
use mpjr::composition::{Shape, elevations, inputs, outline, shape};
use mpjr::profile::Surface;
use mpjr::scene::{Source, read};
use nalgebra::Vector2;

static BODY: Text = Text::new(|| {
    let press = "[[phase]]\nduration = 1.0\nsteps = 3\napproach = 5e-4\n";
    let slide = "[[phase]]\nvelocity = 0.02\ndistance = 0.0537\nsteps = 5\n";
    [ONE_ARM, &coulomb("0.2"), "[solver]\ntolerance = 1e-13\n", press, slide, "[indenter]\n"].concat()
});
static SPACE: Text = Text::new(|| layer("[1.0, 0.5]", "0.5", "[16, 8, 4]"));
static PLANE: Text = Text::new(|| layer("1.0", "0.5", "[16, 4]"));

/// An array as NumPy writes it, version 1.
fn npy(columns: usize, rows: usize, h: impl Fn(usize, usize) -> f64) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({columns}, {rows}), }}\n");
    let length = u16::try_from(header.len()).unwrap().to_le_bytes();
    let data = (0..columns * rows).flat_map(|k| h(k / rows, k % rows).to_le_bytes());
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes()].concat().into_iter().chain(data).collect()
}

/// All forces of a run in `directory`, and the pressure at every node and time.
fn run(directory: &Path, text: &str) -> [Vec<f64>; 4] {
    let results = run_in(directory, text, 1);
    let force = |name: &str| results.history(name).unwrap();
    let pressure = results.interface("pressure").unwrap().values;
    [force("normal_force"), force("tangential_force"), force("hysteretic_force"), pressure]
}

/// Whether it ended well, and all that it said.
fn mpjr(directory: &Path, arguments: &[&str]) -> (bool, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mpjr"));
    let output = command.args(arguments).current_dir(directory).output().unwrap();
    let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    (output.status.success(), said.concat())
}

/// Pressures of a map of a smooth surface go to those of its formula with the square of the spacing, the hysteretic force, which
/// has the slope in it, with the spacing. All of the face is in contact, so that no node comes or goes, and the nodes are a third or
/// two thirds between points whenever they are between.
#[test]
fn a_map_of_a_formula_converges_to_it() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    let formula =
        "profile = \"expression\"\nformula = \"3e-4*(1-cos(2*pi*x)) + 1e-4*(1-cos(4*pi*y + pi/4*sin(2*pi*x)))\"\n";
    let h = |x: f64, y: f64| {
        let phase = 4.0 * PI * y + PI / 4.0 * (2.0 * PI * x).sin();
        3e-4 * (1.0 - (2.0 * PI * x).cos()) + 1e-4 * (1.0 - phase.cos())
    };
    let body = BODY.replace("approach = 5e-4", "approach = 3e-3").replace("0.0537", "0.1388888888888889");
    let exact = run(directory, &(SPACE.clone() + &body + formula));
    let error = |n: usize| {
        let at = |i: usize, j: usize| h(i as f64 / n as f64, 0.5 * j as f64 / n as f64);
        std::fs::write(directory.join("map.npy"), npy(n, n, at)).unwrap();
        let indenter = format!(
            "profile = \"map\"\nfile = \"map.npy\"\nextend = \"periodic\"\nspacing = [{:?}, {:?}]\n",
            1.0 / n as f64,
            0.5 / n as f64
        );
        let found = run(directory, &(SPACE.clone() + &body + &indenter));
        [2, 3].map(|which| difference(&exact[which], &found[which]))
    };
    let errors = [48, 96, 192].map(error);
    println!("{errors:?}");
    for pair in errors.windows(2) {
        let [hysteretic, pressure] = [0, 1].map(|which| pair[0][which] / pair[1][which]);
        assert!((pressure - 4.0).abs() < 0.1 && (hysteretic - 2.0).abs() < 0.1, "{errors:?}");
    }
    assert!(errors[2][1] < 1e-4 && errors[2][0] < 0.07, "{errors:?}");
}

/// A map that does not depend on y is the sampled profile of the plane: nodes on its points, and between them while it slides.
#[test]
fn the_same_for_every_y_is_the_plane() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    let height = |i: usize| {
        let x = i as f64 / 40.0;
        3e-4 * (1.0 - (2.0 * PI * x).cos()) + 5e-5 * (14.0 * PI * x).sin()
    };
    let mut lines = String::new();
    (0..40).for_each(|i| writeln!(lines, "{:?} {:?}", i as f64 / 40.0, height(i)).unwrap());
    std::fs::write(directory.join("line.txt"), lines).unwrap();
    std::fs::write(directory.join("map.npy"), npy(40, 4, |i, _| height(i))).unwrap();
    let keys = "extend = \"periodic\"\ninvert = true\ndetrend = \"mean\"\noffset = 2e-4\n";
    let sampled = format!("profile = \"sampled\"\nfile = \"line.txt\"\n{keys}");
    let map = format!("profile = \"map\"\nfile = \"map.npy\"\nspacing = [0.025, 0.125]\n{keys}");
    let plane = run(directory, &(PLANE.clone() + &BODY + &sampled));
    let mut space = run(directory, &(SPACE.clone() + &BODY + &map));
    space[..3].iter_mut().flatten().for_each(|force| *force /= 0.5);
    // Every node of the plane stands for eight.
    let every = plane[3].iter().flat_map(|pressure| [*pressure; 8]).collect();
    let plane = [plane[0].clone(), plane[1].clone(), plane[2].clone(), every];
    let differences = [0, 1, 2, 3].map(|which| difference(&plane[which], &space[which]));
    println!("{differences:?}");
    assert!(differences.iter().all(|difference| *difference < 1e-9), "{differences:?}");
}

const COUNTS: [usize; 2] = [8, 6];

/// Of no symmetry, and all digits of it short.
fn height(i: usize, j: usize) -> f64 {
    ((i * i * 37 + j * 11 + i * j * 5) % 97) as f64
}

/// A file of each format with these heights in um, and the keys that go with it.
fn formats(directory: &Path) -> Vec<String> {
    let [columns, rows] = COUNTS;
    let write = |name: &str, bytes: &[u8]| std::fs::write(directory.join(name), bytes).unwrap();
    write("m.npy", &npy(columns, rows, height));
    let line = |i: usize| (0..rows).map(|j| format!("{}", height(i, j))).collect::<Vec<_>>().join(" ") + "\n";
    write("m.txt", (0..columns).map(line).collect::<String>().as_bytes());
    let point = |k: usize| format!("{},{},{}\n", 125 * (k / rows), 250 * (k % rows), height(k / rows, k % rows));
    write(
        "m.xyz",
        ("x (mm),y (mm),z (um)\n".to_owned() + &(0..columns * rows).map(point).collect::<String>()).as_bytes(),
    );
    let file = hdf5::File::create(directory.join("m.h5")).unwrap();
    let values: Vec<f32> = (0..columns * rows).map(|k| height(k / rows, k % rows) as f32).collect();
    let group = file.create_group("scan").unwrap();
    let set = group.new_dataset::<f32>().shape([columns, rows]).create("z").unwrap();
    set.write_raw(&values).unwrap();
    drop((set, group, file));
    let x_fastest: Vec<f64> = (0..columns * rows).map(|k| height(k % columns, k / columns)).collect();
    let words: Vec<String> = x_fastest.iter().map(ToString::to_string).collect();
    let header = "aISO-1.0\nNumPoints=8\nNumProfiles=6\nXscale=0.125\nYscale=0.25\nZscale=1e-6\nDataType=7\n*\n";
    write("m.sdf", format!("{header}{}\n*\n", words.join(" ")).as_bytes());
    let index = "<p:ISO5436_2 xmlns:p='http://www.opengps.eu/2008/ISO5436_2'><Record1><FeatureType>SUR</FeatureType><Axes><CX><AxisType>I\
                 </AxisType><Increment>0.125</Increment></CX><CY><AxisType>I</AxisType><Increment>0.25</Increment></CY><CZ><AxisType>A\
                 </AxisType><DataType>I</DataType><Increment>1e-6</Increment></CZ></Axes></Record1><Record3><MatrixDimension><SizeX>8\
                 </SizeX><SizeY>6</SizeY><SizeZ>1</SizeZ></MatrixDimension><DataLink><PointDataLink>bindata/data.bin</PointDataLink>\
                 </DataLink></Record3></p:ISO5436_2>";
    let data: Vec<u8> = x_fastest.iter().flat_map(|h| (*h as i16).to_le_bytes()).collect();
    let mut archive = zip::ZipWriter::new(std::fs::File::create(directory.join("m.x3p")).unwrap());
    for (name, content) in [("main.xml", index.as_bytes()), ("bindata/data.bin", &data)] {
        archive.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        archive.write_all(content).unwrap();
    }
    archive.finish().unwrap();
    let keys = |name: &str, more: &str| {
        format!("profile = \"map\"\nextend = \"periodic\"\nperiod = [1.0, 1.5]\nfile = \"{name}\"\n{more}")
    };
    let spaced = "spacing = [0.125, 0.25]\nunit = \"um\"\n";
    vec![
        keys("m.npy", spaced),
        keys("m.txt", spaced),
        keys("m.xyz", ""),
        keys("m.h5", &format!("{spaced}dataset = \"scan/z\"\n")),
        keys("m.sdf", ""),
        keys("m.x3p", "unit = \"m\"\n"),
    ]
}

/// Each format gives the same surface, and its bytes are what a resumed run looks at.
#[test]
fn every_format_is_the_same_surface() {
    let directory = tempfile::tempdir().unwrap();
    let wide = |indenter: &str| {
        // The map repeats after 1.5 m along y: so does the layer.
        let text = SPACE.replace("[1.0, 0.5]", "[1.0, 1.5]") + &BODY + indenter;
        let file = directory.path().join("scene.toml");
        let scene = read(&text, &Source { file: file.clone(), overrides: Vec::new() }).unwrap();
        let numbers = elevations(&scene, &file).unwrap();
        let shape = shape(&scene, &file, &numbers, &outline(&scene, &file).unwrap()).unwrap();
        // What it resolves to is the same scene.
        let again = read(&scene.to_toml(), &Source { file: file.clone(), overrides: Vec::new() }).unwrap();
        assert_eq!(scene.to_toml(), again.to_toml());
        assert!(inputs(&scene, &file).unwrap().starts_with("indenter.file "));
        shape
    };
    let shapes: Vec<Shape> = formats(directory.path()).iter().map(|indenter| wide(indenter)).collect();
    for (i, j) in [(0, 0), (1, 0), (0, 1), (7, 5), (3, 4)] {
        let place = Vector2::new(0.125 * i as f64, 0.25 * j as f64);
        for shape in &shapes {
            assert!((shape.surface.at(place).unwrap().height - 1e-6 * height(i, j)).abs() < 1e-20);
            let between = shape.surface.at(place + Vector2::new(0.05, 0.1)).unwrap();
            let first = shapes[0].surface.at(place + Vector2::new(0.05, 0.1)).unwrap();
            assert!(
                (between.height - first.height).abs() < 1e-18 && (between.gradient - first.gradient).norm() < 1e-16
            );
        }
    }
}

/// A bounded map has to cover what the face meets, from its origin on.
#[test]
fn bounded_maps_cover_the_face() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("m.npy"), npy(23, 17, |i, j| 1e-5 * (i + j) as f64)).unwrap();
    let free = |origin: &str| {
        let text = format!("profile = \"map\"\nfile = \"m.npy\"\nextend = \"error\"\nspacing = 0.05\n{origin}");
        let file = directory.path().join("scene.toml");
        let source = Source {
            file: file.clone(),
            overrides: vec!["layer.sides=\"free\"".to_owned(), "layer.depth=0.4".to_owned()],
        };
        let make = || {
            let scene = read(&(SPACE.clone() + &BODY + &text), &source)?;
            shape(&scene, &file, &elevations(&scene, &file)?, &outline(&scene, &file)?)
        };
        make().map(drop).map_err(|error: mpjr::error::Error| error.to_string())
    };
    free("origin = [-0.0875, -0.1]\n").unwrap();
    let message = free("").unwrap_err();
    let expected = "indenter.file: its x must cover -0.05369999999999999 to 1.0 m (a face of 1.0 m, and the sliding of all phases), got 0.0 to 1.1 m; \
                    give a larger map or an origin, slide less, or say extend = \"periodic\"";
    assert!(message.ends_with(expected), "{message}");
}

/// Damaged HDF5 files end in an answer; those that say more than they have are refused.
#[test]
fn damaged_datasets_are_survived() {
    let directory = tempfile::tempdir().unwrap();
    formats(directory.path());
    let whole = std::fs::read(directory.path().join("m.h5")).unwrap();
    let path = directory.path().join("damaged.h5");
    let mut refused = 0;
    let mut state = 7_u64;
    for round in 0..400 {
        let mut bytes = whole.clone();
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let at = (state >> 33) as usize % bytes.len();
        if round % 4 == 0 {
            bytes.truncate(at)
        } else {
            bytes[at] ^= 1 << (round % 8)
        }
        std::fs::write(&path, bytes).unwrap();
        refused += usize::from(mpjr::heightmap::dataset(&path, "scan/z", None).is_err());
    }
    assert!(refused > 100, "{refused}");
    // Another name: what was damaged may be locked yet.
    let path = directory.path().join("odd.h5");
    let file = hdf5::File::create(&path).unwrap();
    file.new_dataset::<f64>().chunk([64, 64]).shape([1 << 20, 1 << 20]).create("huge").unwrap();
    file.new_dataset::<f64>().shape([2, 2, 2]).create("cube").unwrap();
    drop(file);
    let message = |name: &str| mpjr::heightmap::dataset(&path, name, None).unwrap_err();
    assert!(message("huge").contains("but does not have them all"), "{}", message("huge"));
    assert_eq!(message("cube"), "\"cube\" must have two dimensions, but has 3");
    assert_eq!(message("no"), "has no dataset \"no\"; it has /cube, /huge");
}

/// `check` draws it: x to the right, y upward, what touches first as #; a wall at a seam and a unit are doubted.
#[test]
fn check_draws_the_map_and_doubts_it() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path();
    // Lowest at the left, in the upper half.
    let bowl = |i: usize, j: usize| 1e-4 * ((i as f64 / 31.0 - 0.1).powi(2) + (j as f64 / 31.0 - 0.9).powi(2));
    std::fs::write(directory.join("m.npy"), npy(32, 32, bowl)).unwrap();
    let indenter = "profile = \"map\"\nfile = \"m.npy\"\nextend = \"periodic\"\nspacing = [0.03125, 0.015625]\n";
    std::fs::write(directory.join("scene.toml"), [&SPACE, &BODY, indenter].concat()).unwrap();
    let (done, said) = mpjr(directory, &["check", "scene.toml"]);
    assert!(done, "{said}");
    let lines: Vec<&str> = said.lines().filter(|line| line.contains('|')).collect();
    assert_eq!(lines.len(), 16, "{said}");
    // What stands between the bars; the line itself is a comment.
    let drawn: Vec<&str> = lines.iter().map(|line| line.split('|').nth(1).unwrap()).collect();
    assert!(drawn.iter().all(|line| line.len() == 64) && drawn[1].contains('#') && !drawn[15].contains('#'), "{said}");
    // Through its lowest point it is in the lowest eighth up to x = 0.1 + sqrt(0.2) m, the 35th of 64 letters.
    let there = |range: std::ops::Range<usize>| drawn[1][range].matches('#').count();
    assert!(there(0..33) == 33 && there(37..62) == 0, "{said}");
    assert!(said.contains("x = 0.0 to 1.0 m to the right, y = 0.0 to 0.5 m upward"), "{said}");
    assert!(
        said.contains("warning: indenter.seam: where the map repeats along x its edges are 8.000e-5 m (rms) apart"),
        "{said}"
    );
    let (done, said) = mpjr(directory, &["check", "scene.toml", "--set", "indenter.seam=\"blend\""]);
    assert!(done && !said.contains("warning: indenter.seam"), "{said}");
}
