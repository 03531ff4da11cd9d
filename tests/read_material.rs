//! Materials of scenes: from files, from the power law, at a temperature.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::{Path, PathBuf};

use common::smallest::{SMALLEST, assert_round_trip, read_set};
use mpjr::error::{Error, Result};
use mpjr::scene::*;

/// A loader of files that are only here, and what it was asked for.
fn load(file: &Path) -> Result<String> {
    match file.to_str() {
        Some("dir/eva.toml") => Ok("[material]\nshear_modulus = 3\npoisson_ratio = 0.1\nshift = \"wlf\"\nc1 = 17.44\n\
                                    c2 = 51.6\nreference_temperature = 290\ntemperature = 290\n\
                                    arms = [{ weight = 0.5, time = 2 }]\nbulk_arms = [{ weight = 0.2, time = 1 }]\n\
                                    poisson_rule = \"bulk_arms\"\nnotes = [\"of a test\"]\n"
            .into()),
        Some("dir/steel.toml") => Ok("[material]\nyoung_modulus = 2.1e11\npoisson_ratio = 0.25\n".into()),
        _ => Err(Error::file(file, "cannot be read: it is not there")),
    }
}

/// The one material of a scene.
fn only(scene: Scene) -> Material {
    let [material] = scene.materials.try_into().unwrap();
    material
}

fn material_from(overrides: &[&str]) -> Result<Material> {
    let overrides = overrides.iter().map(|text| text.to_string()).collect();
    let source = Source { file: PathBuf::from("dir/smallest.toml"), overrides };
    read_with(SMALLEST, &source, &load).map(only)
}

#[test]
fn a_material_comes_from_a_file_and_the_keys_beside() {
    let material = material_from(&["material={ file = \"eva.toml\" }"]).unwrap();
    assert_eq!((material.shear_modulus, material.poisson_ratio), (3.0, 0.1));
    assert_eq!(material.arms, [Arm { weight: 0.5, time: 2.0 }]);
    assert_eq!(material.bulk_arms, [Arm { weight: 0.2, time: 1.0 }]);
    assert_eq!(material.memory, Memory::Exponential);
    assert_eq!(material.notes[..2], ["read from eva.toml", "of a test"]);
    let beside = "poisson_ratio = 0.3, memory = \"backward_euler\", poisson_rule = \"constant_ratio\"";
    let arrhenius = "shift = \"arrhenius\", temperature = 280, activation_energy = 1e5";
    let all = material_from(&[&format!("material={{ file = \"eva.toml\", {beside}, {arrhenius} }}")]).unwrap();
    assert_eq!((all.shear_modulus, all.poisson_ratio, all.memory), (3.0, 0.3, Memory::BackwardEuler));
    assert_eq!((all.poisson_rule, all.bulk_arms.len()), (Some(PoissonRule::ConstantRatio), 0));
    let factor = (1e5 / 8.314_462_618_153_24 * (1.0 / 280.0 - 1.0 / 290.0f64)).exp();
    assert!((all.arms[0].time / (2.0 * factor) - 1.0).abs() < 1e-12);
}

/// The override that names the file acts first, wherever it stands; the others change what the file says.
#[test]
fn overrides_of_a_material_file() {
    let steel = material_from(&["material.file=steel.toml", "material={ file = \"eva.toml\" }"]).unwrap();
    assert_eq!(steel.shear_modulus, 3.0);
    let file = ["material.arms.0.time=7", "material.poisson_ratio=0.2", "material={ file = \"eva.toml\" }"];
    let material = material_from(&file).unwrap();
    assert_eq!((material.arms[0].time, material.poisson_ratio), (7.0, 0.2));
    let missing = material_from(&["material={ file = \"none.toml\" }"]).unwrap_err();
    assert_eq!(missing.exit_code(), 4);
    let text = "dir/none.toml: cannot be read: it is not there (material.file of dir/smallest.toml)";
    assert_eq!(missing.to_string(), text);
}

/// A table that a sweep has changed: the file is read when the table is.
#[test]
fn a_table_takes_a_material_file() {
    let file = common::directory("tests/scenes/scene.toml");
    let mut table = parse(SMALLEST, &file).unwrap();
    let material = parse("file = \"data/eva-one-arm.toml\"", &file).unwrap();
    set(&mut table, "material", material.into(), &file).unwrap();
    assert_eq!(only(from_table(&table, &file).unwrap()).shear_modulus, 568.498);
    include(&mut table, &file, &open).unwrap();
    set(&mut table, "material.arms.0.time", 2.0.into(), &file).unwrap();
    assert_eq!(only(from_table(&table, &file).unwrap()).arms[0].time, 2.0);
}

#[test]
fn what_a_fractional_material_becomes_is_read_back() {
    let fractional = "material={ fractional = { modulus = 814.7, order = 0.226, arms = 4 }, poisson_ratio = 0.3, \
                      poisson_rule = \"constant_bulk_modulus\", shift = \"wlf\", c1 = 17.44, c2 = 51.6, \
                      reference_temperature = 290, temperature = 291 }";
    let scene = read_set(SMALLEST, &[fractional]).unwrap();
    assert_eq!(scene.materials[0].arms.len(), 4);
    assert_eq!(scene.materials[0].notes.len(), 2);
    assert_round_trip(&scene);
    // Steps of 0.5 s to 4 s in all, and where one step is all there is, a decade.
    assert_eq!(scene.band().map(|band| (band.from, band.to)), Some((0.4, 4.0)));
    // Hotter, the power law is lower by a_T^order at equal times, and so is its series.
    let cold = read_set(SMALLEST, &[fractional, "material.temperature=290"]).unwrap();
    let at = |material: &Material, t: f64| material.shear_modulus * material.shear_series().relaxation(t);
    let factor = 10f64.powf(-17.44 / 52.6);
    for t in [0.5, 1.0, 4.0] {
        let ratio = at(&scene.materials[0], t) / at(&cold.materials[0], t);
        assert!((ratio / factor.powf(0.226) - 1.0).abs() < 1e-4, "{ratio}");
    }
}
