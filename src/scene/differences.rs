//! In what two resolved scenes differ.

use std::collections::BTreeMap;

use toml::{Table, Value};

use super::keys;

/// Keys that change nothing in what is computed or kept of it.
const WITHOUT_EFFECT: [&str; 2] = ["title", "output.checkpoint_every"];

/// Keys that decide only which states are kept from then on.
const OF_WHAT_IS_KEPT: [&str; 2] = ["output.interface_every", "output.bulk_at"];

/// The differences that keep a run from going on where another left it. Which states are kept may change, as long as steps
/// end where they did (the times in `bulk_at` stay, its names of phases need not) and the file has a place for them.
pub fn obstacles(there: &str, here: &str) -> Vec<String> {
    let moments = |scene: &str| -> Vec<Value> {
        leaves(scene)
            .into_iter()
            .filter(|(path, _)| path.starts_with("output.bulk_at."))
            .map(|(_, value)| value)
            .collect()
    };
    let times = |moments: &[Value]| moments.iter().filter(|value| !value.is_str()).cloned().collect::<Vec<_>>();
    let (before, now) = (moments(there), moments(here));
    let same_steps = times(&before) == times(&now) && before.is_empty() == now.is_empty();
    let [interface, bulk] = OF_WHAT_IS_KEPT;
    let mut found = differences(there, here);
    found.retain(|path| !(path.starts_with(interface) || path.starts_with(bulk) && same_steps));
    found
}

/// For each key path at which the scenes differ, `path: 1.0 there, 2.0 here`. Both are resolved scenes as TOML.
pub fn differences(there: &str, here: &str) -> Vec<String> {
    let (there, here) = (leaves(there), leaves(here));
    let shown = |value: Option<&Value>| value.map_or_else(|| "nothing".to_owned(), keys::show);
    let mut paths: Vec<&String> = there.keys().chain(here.keys().filter(|path| !there.contains_key(*path))).collect();
    paths.retain(|path| there.get(*path) != here.get(*path) && !WITHOUT_EFFECT.contains(&path.as_str()));
    let text = |path: &String| format!("{path}: {} there, {} here", shown(there.get(path)), shown(here.get(path)));
    paths.into_iter().map(text).collect()
}

/// The values of a document that are neither tables nor arrays, by their paths.
fn leaves(text: &str) -> BTreeMap<String, Value> {
    let mut found = BTreeMap::new();
    if let Ok(table) = text.parse::<Table>() {
        collect("", &Value::Table(table), &mut found);
    }
    found
}

fn collect(path: &str, value: &Value, found: &mut BTreeMap<String, Value>) {
    let at = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        Value::Table(table) => table.iter().for_each(|(key, value)| collect(&at(key), value, found)),
        Value::Array(values) if !values.is_empty() => {
            values.iter().enumerate().for_each(|(index, value)| collect(&at(&index.to_string()), value, found));
        }
        other => {
            found.insert(path.to_owned(), other.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_named_by_its_path() {
        let there = "title = \"a\"\n[layer]\nwidth = 1.0\n[[phase]]\nname = \"indent\"\nsteps = 3\n";
        let here = "title = \"b\"\n[layer]\nwidth = 2.0\n[[phase]]\nname = \"indent\"\nsteps = 3\nvelocity = 0.5\n";
        assert_eq!(
            differences(there, here),
            ["layer.width: 1.0 there, 2.0 here", "phase.0.velocity: nothing there, 0.5 here"]
        );
        assert!(differences(there, &there.replace("\"a\"", "\"b\"")).is_empty());
    }
}
