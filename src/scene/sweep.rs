//! A sweep: one scene, keys that vary, keys that follow them, and the scenes that all combinations make.

mod follow;

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::keys::{self, Section, tables};
use super::{Scene, from_table, get, include, open, overrides, parse, set};
use crate::error::{Error, Result};

/// More cases than this are a mistake.
const MOST_CASES: usize = 100_000;

/// A sweep with its cases, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// The file of the scene.
    pub file: PathBuf,
    /// The varied keys, slowest first.
    pub keys: Vec<String>,
    /// One case for each combination of their values, block by block.
    pub cases: Vec<Case>,
}

/// One case of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// The value of each varied key, as text.
    pub values: Vec<String>,
    /// What is solved.
    pub scene: Scene,
}

impl Sweep {
    /// What sets a case apart: `phase.slide.velocity = 0.1, ...`.
    pub fn label(&self, case: usize) -> String {
        let values = self.cases.get(case).map_or(&[][..], |case| &case.values);
        label(&self.keys, values)
    }
}

fn label(keys: &[String], values: &[String]) -> String {
    keys.iter().zip(values).map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ")
}

/// The cases of a sweep as text, for the ranks that read no files: what [`receive`] takes.
///
/// `text` is the content of `file`. The scene, and the files that whole tables come from, are looked for beside it.
pub fn read(text: &str, file: &Path) -> Result<String> {
    let table = parse(text, file)?;
    let root = Section::root(file, &table, &tables::SWEEP);
    root.only_known()?;
    let scene_file = match table.get("scene") {
        Some(Value::String(name)) => beside(file, name),
        Some(other) => return Err(root.must_be("scene", "the name of a scene file", other)),
        None => return Err(root.missing("scene", "the name of a scene file")),
    };
    let base = open(&scene_file).map_err(|error| root.error("scene", error.to_string().replacen(": ", " ", 1)))?;
    let base = parse(&base, &scene_file)?;
    // A scene that is wrong by itself says so in its own name, unless what is wrong is varied.
    let blocks = vary(&root)?;
    let keys: Vec<String> = blocks[0].iter().map(|(key, _)| key.clone()).collect();
    let follow = follow::read(&root, &keys.iter().map(String::as_str).collect::<Vec<_>>())?;

    let count = |block: &Block| block.iter().try_fold(1_usize, |count, (_, values)| count.checked_mul(values.len()));
    let counts: Option<Vec<usize>> = blocks.iter().map(count).collect();
    let counts = counts.filter(|counts| counts.iter().sum::<usize>() <= MOST_CASES).ok_or_else(|| {
        root.error("vary", format!("makes more than {MOST_CASES} cases; vary fewer keys or give fewer values"))
    })?;
    let mut list = Vec::with_capacity(counts.iter().sum());
    for chosen in blocks.iter().zip(counts).flat_map(|(block, count)| (0..count).map(|i| combination(block, i))) {
        let mut table = base.clone();
        let values: Vec<String> = chosen.iter().map(|(_, value)| shown(value)).collect();
        let label = label(&keys, &values);
        // What names the file of a material or of a motion acts before it is read, all else after, on what it says.
        let (files, others): (Vec<_>, Vec<_>) =
            chosen.into_iter().partition(|(key, _)| overrides::names_whole_file(key));
        let put = |table: &mut Table, chosen: &[(&str, &Value)]| {
            chosen.iter().try_for_each(|(key, value)| {
                let value = whole_table(table, key, value, file)?;
                set(table, key, value, file)
            })
        };
        put(&mut table, &files)?;
        include(&mut table, &scene_file, &open).map_err(|error| blame(error, file, &label))?;
        put(&mut table, &others)?;
        follow.iter().try_for_each(|follow| follow.apply(&mut table, file))?;
        let scene = from_table(&table, &scene_file).map_err(|error| blame(error, file, &label))?;
        let mut scene_table = table;
        if !keys.iter().any(|key| key == "title") {
            scene_table.insert("title".into(), Value::String(format!("{} ({label})", scene.title)));
        }
        let mut case = Table::new();
        case.insert("values".into(), Value::Array(values.into_iter().map(Value::String).collect()));
        case.insert("scene".into(), Value::Table(scene_table));
        list.push(Value::Table(case));
    }
    let mut all = Table::new();
    all.insert("file".into(), Value::String(scene_file.to_string_lossy().into_owned()));
    all.insert("keys".into(), Value::Array(keys.into_iter().map(Value::String).collect()));
    all.insert("case".into(), Value::Array(list));
    toml::to_string(&all).map_err(|error| Error::Internal(format!("the cases have no form in TOML: {error}")))
}

/// The sweep that [`read`] made a text of.
pub fn receive(text: &str) -> Result<Sweep> {
    let garbled = || Error::Internal("the cases of a sweep were garbled on their way to another rank".into());
    let table: Table = text.parse().map_err(|_| garbled())?;
    let texts = |value: Option<&Value>| -> Option<Vec<String>> {
        value?.as_array()?.iter().map(|value| value.as_str().map(str::to_owned)).collect()
    };
    let file = PathBuf::from(table.get("file").and_then(Value::as_str).ok_or_else(garbled)?);
    let cases = table.get("case").and_then(Value::as_array).ok_or_else(garbled)?.iter().map(|case| {
        let scene = case.get("scene").and_then(Value::as_table).ok_or_else(garbled)?;
        Ok(Case { values: texts(case.get("values")).ok_or_else(garbled)?, scene: from_table(scene, &file)? })
    });
    let cases = cases.collect::<Result<_>>()?;
    let keys = texts(table.get("keys")).ok_or_else(garbled)?;
    Ok(Sweep { file, keys, cases })
}

/// Varied keys with their values.
type Block = Vec<(String, Vec<Value>)>;

const VARY: &str = "the keys that vary, such as \"phase.slide.velocity\" = [0.01, 0.1]";

/// `[vary]`, or each `[[vary]]`: all have the same keys in the same order.
fn vary(root: &Section) -> Result<Vec<Block>> {
    let several = matches!(root.table().get("vary"), Some(Value::Array(_)));
    let sections = if several { root.sections("vary")? } else { root.optional_section("vary")?.into_iter().collect() };
    let name = |block: usize| if several { format!("vary.{block}") } else { "vary".to_owned() };
    let blocks: Vec<Block> = sections.iter().map(block).collect::<Result<_>>()?;
    let first = blocks.first().ok_or_else(|| root.missing("vary", VARY))?;
    let alike = |block: &Block| block.iter().map(|(key, _)| key).eq(first.iter().map(|(key, _)| key));
    match blocks.iter().position(|block| block.is_empty() || !alike(block)) {
        None => Ok(blocks),
        Some(at) if blocks[at].is_empty() => Err(root.error(&name(at), format!("is empty; give {VARY}"))),
        Some(at) => {
            let keys: Vec<&str> = first.iter().map(|(key, _)| key.as_str()).collect();
            Err(root.error(&name(at), format!("must vary the keys of the first [[vary]]: {}", keys.join(", "))))
        }
    }
}

fn block(section: &Section) -> Result<Block> {
    let found =
        section.table().iter().map(|(key, value)| match value {
            Value::Array(values) if values.is_empty() => Err(section.error(key, "is empty; give at least one value")),
            Value::Array(values) => Ok((key.clone(), values.clone())),
            // A bare phase.slide.velocity is a table in TOML.
            Value::Table(_) => Err(section
                .error(key, format!("must be an array of values; put a key with dots in quotes: \"{key}. ...\""))),
            other => Err(section.must_be(key, "an array of values", other)),
        });
    found.collect()
}

/// The values of case `index`: the first key is the slowest.
fn combination(vary: &[(String, Vec<Value>)], index: usize) -> Vec<(&str, &Value)> {
    let mut rest = index;
    let mut chosen: Vec<(&str, &Value)> = vary
        .iter()
        .rev()
        .map(|(key, values)| {
            let value = &values[rest % values.len()];
            rest /= values.len();
            (key.as_str(), value)
        })
        .collect();
    chosen.reverse();
    chosen
}

/// The value itself; where it names a TOML file and the key is a table, that table of the file.
fn whole_table(scene: &Table, key: &str, value: &Value, sweep: &Path) -> Result<Value> {
    let name = value.as_str().or_else(|| match value.as_table() {
        Some(table) if table.len() == 1 => table.get("file").and_then(Value::as_str),
        _ => None,
    });
    let Some(name) = name.filter(|name| name.ends_with(".toml")) else { return Ok(value.clone()) };
    // The file of a table is for the scene to read.
    if key.ends_with(".file") || get(scene, key).is_some_and(|present| !present.is_table()) {
        return Ok(value.clone());
    }
    let wrong = |reason: String| Error::scene(sweep, format!("vary.{key:?}"), reason);
    let file = beside(sweep, name);
    let text = open(&file).map_err(|error| wrong(error.to_string().replacen(": ", " ", 1)))?;
    let mut table = parse(&text, &file)?;
    include(&mut table, &file, &open)?;
    match get(&table, key) {
        Some(found @ Value::Table(_)) => Ok(found.clone()),
        _ => Err(wrong(format!("{} has no [{key}] table", file.display()))),
    }
}

/// The error of a scene as one of the case that has it.
fn blame(error: Error, sweep: &Path, label: &str) -> Error {
    match error {
        Error::Scene { key, reason, .. } => Error::scene(sweep, key, format!("{reason} (in the case {label})")),
        other => other,
    }
}

fn beside(file: &Path, name: &str) -> PathBuf {
    file.parent().unwrap_or(Path::new("")).join(name)
}

/// A varied value as text: bare where it is a text.
fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(_) | Value::Table(_) => value.to_string(),
        other => keys::show(other),
    }
}
