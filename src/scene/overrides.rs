//! `--set key.path=value`: changes of a scene's table before it is read.

use std::path::Path;

use toml::{Table, Value};

use super::keys;
use super::read::phase;
use crate::error::{Error, Result};

/// Applies the overrides in order; one without a value takes the key out of the scene.
pub(super) fn apply(table: &mut Table, overrides: &[String], file: &Path) -> Result<()> {
    for typed in overrides {
        let (path, text) = split(typed)?;
        match text {
            "" => take(table, path),
            _ => set(table, path, value(text, typed)?, file)?,
        }
    }
    Ok(())
}

/// The overrides that act before files are read, those that may name one and so decide what other keys there are, and the others. A
/// phase as a whole, which few of them have a file for, still replaces what was set in it before.
pub(super) fn around_files(typed: &[String]) -> [Vec<String>; 2] {
    let names = |path: &str| names_whole_file(path) || matches!(path, "friction" | "friction.coefficient");
    let replaced = |place: usize, path: &str| {
        let keys = split_path(path);
        let mut later = typed[place + 1..].iter().map(|typed| path_of(typed));
        keys[0] == "phase" && later.any(|later| names(&later) && keys.starts_with(&split_path(&later)))
    };
    let mut parts = [Vec::new(), Vec::new()];
    for (place, typed) in typed.iter().enumerate() {
        let path = path_of(typed);
        parts[usize::from(!names(&path) && !replaced(place, &path))].push(typed.clone());
    }
    parts
}

/// The path of an override; nothing where there is none, which is said where it acts.
fn path_of(typed: &str) -> String {
    split(typed).map(|(path, _)| path.to_owned()).unwrap_or_default()
}

/// Whether the path is that of a material as a whole or of its file, or of a measured motion or what it may be in.
pub(super) fn names_whole_file(path: &str) -> bool {
    let keys = split_path(path);
    match keys.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["material"] | ["material", "file"] | ["material", _, "file"] => true,
        ["material", index] => index.parse::<usize>().is_ok(),
        // A whole phase may have one.
        ["phase"] | ["phase", _] | ["phase", _, "motion"] => true,
        _ => false,
    }
}

/// Sets `path`, dotted keys such as `layer.width`, in the table of a scene. An element of an array is addressed by
/// its index from 0 or, where it has one, by its name or region (`phase.slide.velocity`); a key with a dot in it is quoted
/// (`phase."1.5 s".steps`). Tables on the way are made. Whether the keys exist is for the reader of the table to say.
pub fn set(table: &mut Table, path: &str, value: Value, file: &Path) -> Result<()> {
    // Deeper than any key of a scene, and no strain on the stack.
    const DEEPEST: usize = 16;
    let keys = split_path(path);
    if keys.len() > DEEPEST || keys.iter().any(String::is_empty) {
        return Err(Error::scene(file, path, "must be keys joined by dots, such as layer.width"));
    }
    put_in_table(table, &keys, 0, value).map_err(|(depth, reason)| Error::scene(file, keys[..depth].join("."), reason))
}

/// Takes out what stands at `path`, a path as [`set`] takes it, if anything does.
fn take(table: &mut Table, path: &str) {
    let keys = split_path(path);
    let Some((last, before)) = keys.split_last() else { return };
    let mut table = table;
    let mut at = before.iter().peekable();
    while let Some(key) = at.next() {
        let within = match table.get_mut(key) {
            Some(Value::Array(array)) => at.next().and_then(|word| {
                let index = element(array, key, word).ok()?;
                array.get_mut(index)
            }),
            other => other,
        };
        let Some(Value::Table(next)) = within else { return };
        table = next;
    }
    table.remove(last);
}

/// What stands at `path`, a path as [`set`] takes it; none where there is nothing.
pub fn get<'a>(table: &'a Table, path: &str) -> Option<&'a Value> {
    let keys = split_path(path);
    let (first, rest) = keys.split_first()?;
    let mut before = first;
    rest.iter().try_fold(table.get(first)?, |value, key| {
        let found = match value {
            Value::Table(table) => table.get(key),
            Value::Array(array) => element(array, before, key).ok().and_then(|index| array.get(index)),
            _ => None,
        };
        before = key;
        found
    })
}

/// Adds to the error of a scene the last override at its key, of the table that the key is in, or of what the key
/// holds: where the user is most likely to have written what is wrong.
pub(super) fn blame(error: Error, overrides: &[String]) -> Error {
    let Error::Scene { file, key, reason } = error else { return error };
    let concerns = |typed: &&String| {
        let path = split(typed).map_or_else(|_| Vec::new(), |(path, _)| split_path(path));
        let keys = split_path(&key);
        !key.is_empty() && path.iter().zip(&keys).all(|(one, other)| one == other)
    };
    match overrides.iter().rev().find(concerns) {
        Some(typed) => Error::Scene { file, reason: format!("{reason} (from --set {typed})"), key },
        None => Error::Scene { file, key, reason },
    }
}

/// `path=value`, at the first `=` outside quotes.
fn split(typed: &str) -> Result<(&str, &str)> {
    let mut quoted = false;
    let equals = typed.char_indices().find(|(_, c)| {
        quoted ^= *c == '"';
        *c == '=' && !quoted
    });
    match equals {
        Some((at, _)) if at > 0 => Ok((typed[..at].trim(), typed[at + 1..].trim())),
        _ => Err(Error::Usage(format!(
            "--set {typed}: must be key.path=value, for example --set phase.slide.velocity=0.1"
        ))),
    }
}

/// A value as TOML, or as a bare text where it is none: `layer.sides=free`.
fn value(text: &str, typed: &str) -> Result<Value> {
    match text.parse() {
        Ok(value) => Ok(value),
        // What opens a quote or a bracket was meant as TOML.
        Err(error) if text.starts_with(['"', '\'', '[', '{']) => {
            let reason = error.message().replace('\n', "; ");
            Err(Error::Usage(format!("--set {typed}: the value is not TOML: {reason}")))
        }
        Err(_) => Ok(Value::String(text.to_owned())),
    }
}

/// The keys of a dotted path; dots inside double quotes do not separate.
fn split_path(path: &str) -> Vec<String> {
    let mut quoted = false;
    let separates = |c: char| {
        quoted ^= c == '"';
        c == '.' && !quoted
    };
    path.split(separates).map(|key| key.trim().replace('"', "")).collect()
}

/// The keys of the path that lead to what is wrong, and what is wrong.
type Misfit = (usize, String);

/// Puts the value at `keys[depth..]` of a table.
fn put_in_table(table: &mut Table, keys: &[String], depth: usize, value: Value) -> std::result::Result<(), Misfit> {
    if depth + 1 == keys.len() {
        table.insert(keys[depth].clone(), value);
        return Ok(());
    }
    let child = table.entry(keys[depth].clone()).or_insert_with(|| Value::Table(Table::new()));
    put_in_value(child, keys, depth + 1, value)
}

/// Puts the value at `keys[depth..]` of what stands at `keys[..depth]`.
fn put_in_value(target: &mut Value, keys: &[String], depth: usize, value: Value) -> std::result::Result<(), Misfit> {
    match target {
        target if depth == keys.len() => {
            *target = value;
            Ok(())
        }
        Value::Table(table) => put_in_table(table, keys, depth, value),
        Value::Array(array) => {
            let index = element(array, &keys[depth - 1], &keys[depth]).map_err(|reason| (depth + 1, reason))?;
            put_in_value(&mut array[index], keys, depth + 1, value)
        }
        other => Err((depth, format!("is {}, which has no key {}", keys::show(other), keys[depth]))),
    }
}

/// The position of the element that `word` addresses, by name or by index.
fn element(array: &[Value], key: &str, word: &str) -> std::result::Result<usize, String> {
    let name = |(index, value): (usize, &Value)| match value.as_table().and_then(|t| t.get("name").or(t.get("region")))
    {
        Some(name) => name.as_str().map(str::to_owned),
        None => (key == "phase").then(|| phase::default_name(index)),
    };
    let names: Vec<Option<String>> = array.iter().enumerate().map(name).collect();
    let by_name = || names.iter().position(|name| name.as_deref() == Some(word));
    let by_index = || word.parse().ok().filter(|&index: &usize| index < array.len());
    by_name().or_else(by_index).ok_or_else(|| {
        let known: Vec<&str> = names.iter().flatten().map(String::as_str).collect();
        match array.len() {
            0 => format!("the array {key} is empty"),
            n if known.is_empty() => format!("no such element; give an index from 0 to {}", n - 1),
            _ => format!("no such {key}; {}", keys::advice(word, &known, "known names")),
        }
    })
}
