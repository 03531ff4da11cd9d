//! Materials from files: `material = { file = "material.toml" }`.

use std::path::Path;

use toml::{Table, Value};

use super::keys::{self, Section};
use super::read::{self, material};
use crate::error::{Error, Result};
use crate::input;

/// How the text of a file is come by: on one process by opening it, on several from the one that did.
pub type Load<'a> = &'a dyn Fn(&Path) -> Result<String>;

/// Replaces every `file` of a scene's materials by what the file says, so that the table holds the materials in full.
/// Paths are relative to the scene `file`. The file is the `[material]` table of a scene, whole; the keys beside
/// `file` go before the same keys in it.
pub fn include(table: &mut Table, file: &Path, load: Load) -> Result<()> {
    match table.get_mut("material") {
        Some(Value::Table(material)) => expand(material, "material", file, load),
        Some(Value::Array(materials)) => {
            let tables = materials.iter_mut().enumerate().filter_map(|(i, value)| Some((i, value.as_table_mut()?)));
            tables.into_iter().try_for_each(|(i, table)| expand(table, &format!("material.{i}"), file, load))
        }
        _ => Ok(()),
    }
}

/// The text of a file, opened by this process.
pub fn open(file: &Path) -> Result<String> {
    input::text(file)
}

/// The series is what a file is for: beside `file` these would leave nothing of it.
const NOT_BESIDE: [&str; 4] = ["shear_modulus", "young_modulus", "arms", "fractional"];

/// A key beside `file`, and the keys in the file that mean nothing more with it.
const REPLACES: [(&str, &[&str]); 2] =
    [("shift", &["c1", "c2", "activation_energy"]), ("poisson_rule", &["bulk_arms"])];

fn expand(table: &mut Table, path: &str, scene: &Path, load: Load) -> Result<()> {
    let Some(value) = table.get("file") else { return Ok(()) };
    let key = format!("{path}.file");
    let name = match value.as_str() {
        Some(name) if !name.is_empty() && !name.contains(char::is_control) => name.to_owned(),
        _ => {
            let reason = format!("must be the path of a material file, got {}", keys::show(value));
            return Err(Error::scene(scene, key, reason));
        }
    };
    if let Some(beside) = NOT_BESIDE.iter().find(|key| table.contains_key(**key)) {
        let reason = format!(
            "cannot stand beside {beside}, which the file gives; remove one of them, or replace the whole table: \
             material = {{ file = {name:?} }}"
        );
        return Err(Error::scene(scene, key, reason));
    }
    let found = scene.parent().unwrap_or(Path::new("")).join(&name);
    let text = load(&found).map_err(|error| match error {
        Error::File { file, reason } => {
            Error::File { file, reason: format!("{reason} ({key} of {})", scene.display()) }
        }
        other => other,
    })?;
    let mut material = whole(&text, &found).map_err(|error| match error {
        Error::Scene { key: inner, reason, .. } if inner.is_empty() => {
            Error::scene(scene, &key, format!("{name}: {reason}"))
        }
        Error::Scene { key: inner, reason, .. } => Error::scene(scene, &key, format!("{name}: {inner}: {reason}")),
        other => other,
    })?;
    for gone in REPLACES.iter().filter(|(key, _)| table.contains_key(*key)).flat_map(|(_, gone)| *gone) {
        material.remove(*gone);
    }
    let origin = Value::String(format!("read from {name}"));
    let known = material.remove("notes").and_then(|notes| notes.as_array().cloned()).unwrap_or_default();
    material.insert("notes".into(), Value::Array([vec![origin], known].concat()));
    table.remove("file");
    material.extend(std::mem::take(table));
    *table = material;
    Ok(())
}

/// The `[material]` table of a material file, which must be one that a scene could have.
fn whole(text: &str, file: &Path) -> Result<Table> {
    let table = read::parse(text, file)?;
    let root = Section::root(file, &table);
    let section = root.section("material")?;
    root.only(&["material"])?;
    if section.has("file") {
        return Err(section.error("file", "a material file cannot take another one; write its table in full"));
    }
    material::check(&section)?;
    Ok(table.get("material").and_then(Value::as_table).cloned().unwrap_or_default())
}
