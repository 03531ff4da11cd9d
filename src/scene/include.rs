//! What a scene takes from other files, so that its table holds it in full: materials, `material = { file = "material.toml" }`,
//! the tables that the coefficient of friction names, and the motions of phases, `motion = "history.csv"`.

use std::path::Path;

use toml::{Table, Value};

use super::document::parse;
use super::friction::tables_in;
use super::keys::tables::MATERIAL_FILE;
use super::keys::{self, Section};
use super::read::{material, phase, record};
use crate::checksum;
use crate::error::{Error, Result};
use crate::input;
use crate::table::{self as numbers, Fault};

/// How the text of a file is come by: on one process by opening it, on several from the one that did.
pub type Load<'a> = &'a dyn Fn(&Path) -> Result<String>;

/// Puts into the table of a scene what it takes from other files. Paths are relative to the scene `file`.
pub fn include(table: &mut Table, file: &Path, load: Load) -> Result<()> {
    materials(table, file, load)?;
    motions(table, file, load)?;
    match table.get_mut("friction") {
        Some(Value::Table(friction)) => tables(friction, file, load),
        _ => Ok(()),
    }
}

/// The tables that the coefficient of friction names and that are not there yet: their first two columns.
fn tables(friction: &mut Table, scene: &Path, load: Load) -> Result<()> {
    const KEY: &str = "friction.coefficient";
    let Some(formula) = friction.get("coefficient").and_then(Value::as_str).map(str::to_owned) else { return Ok(()) };
    for name in tables_in(&formula) {
        match friction.get("tables") {
            Some(Value::Table(tables)) if tables.contains_key(&name) => continue,
            // What it is instead is said where it is read.
            Some(Value::Table(_)) | None => {}
            Some(_) => return Ok(()),
        }
        let text = load_beside(&name, (scene, KEY), load)?;
        let wrong = |fault: Fault| Error::scene(scene, KEY, format!("{name}: {fault}"));
        let columns = numbers::Table::read(text.as_bytes()).and_then(|table| table.columns(&[0, 1])).map_err(wrong)?;
        let points = columns.rows.into_iter().map(|row| row.values.into()).collect();
        if let Value::Table(tables) = friction.entry("tables").or_insert_with(|| Value::Table(Table::new())) {
            tables.insert(name, Value::Array(points));
        }
        if let Value::Array(sums) = friction.entry("checksums").or_insert_with(|| Value::Array(Vec::new())) {
            sums.push(Value::String(checksum::text(text.as_bytes())));
        }
    }
    Ok(())
}

/// Replaces the file of each measured motion by what it says.
fn motions(table: &mut Table, scene: &Path, load: Load) -> Result<()> {
    let Some(Value::Array(phases)) = table.get_mut("phase") else { return Ok(()) };
    for (index, phase) in phases.iter_mut().enumerate() {
        let Some(phase) = phase.as_table_mut() else { continue };
        let Some(file) = phase.get("motion").and_then(Value::as_str).map(str::to_owned) else { continue };
        let name = phase.get("name").and_then(Value::as_str).map_or_else(|| phase::default_name(index), str::to_owned);
        let key = format!("phase.{name}.motion");
        let text = load_beside(&file, (scene, &key), load)?;
        let record =
            record::table(&file, &text).map_err(|reason| Error::scene(scene, &key, format!("{file:?}: {reason}")))?;
        phase.insert("motion".into(), Value::Table(record));
    }
    Ok(())
}

/// The text of the file `name` beside the scene, which a key names.
fn load_beside(name: &str, (scene, key): (&Path, &str), load: Load) -> Result<String> {
    load(&scene.parent().unwrap_or(Path::new("")).join(name)).map_err(|error| match error {
        Error::File { file, reason } => {
            Error::File { file, reason: format!("{reason} ({key} of {})", scene.display()) }
        }
        other => other,
    })
}

/// Replaces every `file` of a scene's materials by what the file says. The file is the `[material]` table of a scene, whole; the
/// keys beside `file` go before the same keys in it.
fn materials(table: &mut Table, file: &Path, load: Load) -> Result<()> {
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
    let text = load_beside(&name, (scene, &key), load)?;
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
    let table = parse(text, file)?;
    let root = Section::root(file, &table, &MATERIAL_FILE);
    let section = root.section("material")?;
    root.only_known()?;
    if section.has("file") {
        return Err(section.error("file", "a material file cannot take another one; write its table in full"));
    }
    material::check(&section)?;
    Ok(table.get("material").and_then(Value::as_table).cloned().unwrap_or_default())
}
