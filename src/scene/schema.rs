//! The JSON schema of scenes, sweeps and material files, from the tables of keys: for completion and checks in editors.
//!
//! Draft-07, which the TOML servers of editors carry out: tuples are arrays of `items`, and what a key decides is a `oneOf`
//! of whole tables, since nothing later than `additionalProperties` is understood. It refuses misspelt keys and numbers out
//! of range; what one key has to do with another is for `mpjr check`.

use serde_json::{Map, Value, json};

use super::keys::kind::{Key, Keys, Kind};
use super::keys::quantity::{Bound, Quantity};
use super::keys::tables::{MATERIAL_FILE, SCENE, SWEEP};

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum File {
    /// Any of those below.
    Any,
    /// A scene.
    Scene,
    /// A sweep.
    Sweep,
    /// A material file.
    Material,
}

/// The schema.
pub fn schema(of: File) -> Value {
    let mut schema = match of {
        // Each has a key that the others lack: one mismatch is told, not three.
        File::Any => json!({
            "if": { "required": ["scene"] },
            "then": table(&SWEEP),
            "else": { "if": { "required": ["phase"] }, "then": table(&SCENE), "else": material_or_scene() },
        }),
        File::Scene => table(&SCENE),
        File::Sweep => table(&SWEEP),
        File::Material => table(&MATERIAL_FILE),
    };
    if let Some(schema) = schema.as_object_mut() {
        schema.insert("$schema".into(), json!("http://json-schema.org/draft-07/schema#"));
        schema.insert("title".into(), json!("mpjr"));
    }
    schema
}

/// Of a file without phases: a material where that is all there is, otherwise a scene that is not complete.
fn material_or_scene() -> Value {
    json!({
        "if": { "required": ["material"], "maxProperties": 1 },
        "then": table(&MATERIAL_FILE),
        "else": table(&SCENE),
    })
}

fn table(keys: &'static Keys) -> Value {
    let Some(decides) = &keys.decides else {
        return object(keys, &keys.beside(None), None);
    };
    let one = |(word, _): &(&'static str, _)| object(keys, &keys.beside(Some(word)), Some((decides.by, word)));
    json!({ "description": keys.about, "type": "object", "oneOf": decides.of.iter().map(one).collect::<Vec<_>>() })
}

/// A table with these keys, one of which may be a certain word.
fn object(keys: &'static Keys, names: &[&'static str], fixed: Option<(&str, &str)>) -> Value {
    let known = || names.iter().filter_map(|name| keys.get(name));
    let property = |key: &'static Key| {
        let value = match fixed {
            Some((by, word)) if by == key.name => json!({ "const": word, "description": description(key) }),
            _ => property(key),
        };
        (key.name.to_owned(), value)
    };
    let required: Vec<&str> = known().filter(|key| key.required).map(|key| key.name).collect();
    json!({
        "description": keys.about,
        "type": "object",
        "properties": known().map(property).collect::<Map<_, _>>(),
        "required": required,
        "additionalProperties": false,
    })
}

/// What a key takes, with what is said of it.
fn property(key: &Key) -> Value {
    let mut value = kind(&key.kind);
    if let Some(value) = value.as_object_mut() {
        // A table says itself what it is.
        value.entry("description").or_insert_with(|| json!(description(key)));
        let default = key.default.and_then(|default| default.parse::<toml::Value>().ok());
        if let Some(default) = default.and_then(|default| serde_json::to_value(default).ok()) {
            value.insert("default".into(), default);
        }
    }
    value
}

/// What a key takes, in words, and what more there is to say of it.
fn description(key: &Key) -> String {
    let what = match key.kind {
        Kind::Table(keys) | Kind::OneOrTables(keys) => keys.about.to_owned(),
        _ => key.kind.words().map_or_else(|| key.kind.what().into(), |words| format!("one of {}", words.join(", "))),
    };
    let about: Vec<&str> = [&what, key.about].into_iter().filter(|text| !text.is_empty()).collect();
    about.join("; ")
}

fn kind(kind: &Kind) -> Value {
    let texts = || json!({ "type": "array", "items": { "type": "string" } });
    let name = || json!({ "type": ["string", "integer"] });
    match kind {
        Kind::Number(quantity) => number(*quantity),
        Kind::NumberOrFormula(quantity) => json!({ "anyOf": [number(*quantity), { "type": "string" }] }),
        Kind::WordOrTable(word, keys, _) => {
            json!({ "if": { "type": "string" }, "then": { "const": word }, "else": table(keys) })
        }
        Kind::NumberOrWord(quantity, word, _) => json!({ "anyOf": [number(*quantity), { "const": word }] }),
        Kind::Curves(_) => {
            let point = json!({ "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 });
            json!({ "type": "object", "additionalProperties": { "type": "array", "items": point } })
        }
        Kind::Count(_, range) => whole(*range),
        Kind::Cells(_, range) => {
            let items = [whole(*range), whole(*range), whole(*range)];
            json!({ "type": "array", "items": items, "minItems": 2, "maxItems": 3 })
        }
        Kind::OneOrTwo(quantity) => one_or_two(number(*quantity)),
        Kind::ChoiceOrPair(words) => one_or_two(json!({ "enum": words })),
        Kind::Flag => json!({ "type": "boolean" }),
        // No control characters.
        Kind::Text(_) => json!({ "type": "string", "pattern": "^[^\\u0000-\\u001f\\u007f-\\u009f]*$" }),
        Kind::Label(_) => name(),
        Kind::Labels(_) => json!({ "type": "array", "items": name(), "uniqueItems": true }),
        Kind::Moments(_) => json!({
            "type": "array",
            "items": { "anyOf": [{ "type": "string" }, { "type": "number", "exclusiveMinimum": 0.0 }] },
        }),
        Kind::Columns(_) => json!({ "type": "array", "items": [name(), name()], "minItems": 2, "maxItems": 2 }),
        Kind::Texts(_) => texts(),
        Kind::Choice(_) | Kind::LengthUnit => json!({ "enum": kind.words() }),
        Kind::Table(keys) => table(keys),
        Kind::FileOrTable(_, keys) => {
            json!({ "if": { "type": "string" }, "then": {}, "else": table(keys) })
        }
        Kind::Numbers(_) => json!({ "type": "array", "items": { "type": "number" } }),
        Kind::Tables(_, keys) => json!({ "type": "array", "items": table(keys) }),
        Kind::OneOrTables(keys) => {
            json!({ "if": { "type": "array" }, "then": { "items": table(keys), "minItems": 1 }, "else": table(keys) })
        }
        Kind::Vary => {
            let block = json!({
                "type": "object",
                "additionalProperties": { "type": "array", "minItems": 1 },
                "minProperties": 1,
            });
            json!({ "if": { "type": "array" }, "then": { "items": block, "minItems": 1 }, "else": block })
        }
        Kind::Follow => json!({ "type": "object", "additionalProperties": { "type": "string" } }),
    }
}

/// A value, or one for x and one for y.
fn one_or_two(one: Value) -> Value {
    json!({ "anyOf": [one, { "type": "array", "items": [one, one], "minItems": 2, "maxItems": 2 }] })
}

fn number(quantity: Quantity) -> Value {
    let mut value = Map::new();
    value.insert("type".into(), json!("number"));
    let mut put = |bound: Bound, at: &str, beyond: &str| match bound {
        Bound::None => {}
        Bound::At(end) => drop(value.insert(at.into(), json!(end))),
        Bound::Beyond(end) => drop(value.insert(beyond.into(), json!(end))),
    };
    put(quantity.least, "minimum", "exclusiveMinimum");
    put(quantity.most, "maximum", "exclusiveMaximum");
    Value::Object(value)
}

/// A whole number; a range without end says nothing of it.
fn whole([least, most]: [usize; 2]) -> Value {
    let mut value = json!({ "type": "integer", "minimum": least });
    if let (true, Some(value)) = (most < usize::MAX, value.as_object_mut()) {
        value.insert("maximum".into(), json!(most));
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The paths of all keys of a schema, such as `phase[].steps`; those of a table that a key decides, together.
    fn in_schema(schema: &Value, path: &str, found: &mut std::collections::BTreeSet<String>) {
        for part in ["oneOf", "then", "else", "items"] {
            match &schema[part] {
                Value::Array(list) => list.iter().for_each(|one| in_schema(one, path, found)),
                one if one.is_object() => in_schema(one, path, found),
                _ => {}
            }
        }
        for (key, value) in schema["properties"].as_object().into_iter().flatten() {
            let path = format!("{path}.{key}");
            in_schema(value, &path, found);
            found.insert(path);
        }
    }

    /// The same of the tables that the reader has.
    fn in_tables(keys: &'static Keys, path: &str, found: &mut std::collections::BTreeSet<String>) {
        for key in keys.keys {
            let path = format!("{path}.{}", key.name);
            if let Some(inner) = key.kind.table() {
                in_tables(inner, &path, found);
            }
            found.insert(path);
        }
    }

    /// The schema knows the keys that the reader knows, and no others.
    #[test]
    fn the_schema_has_the_keys_of_the_reader() {
        for (of, keys) in [(File::Scene, &SCENE), (File::Sweep, &SWEEP), (File::Material, &MATERIAL_FILE)] {
            let (mut one, mut other) = Default::default();
            in_schema(&schema(of), "", &mut one);
            in_tables(keys, "", &mut other);
            assert_eq!(one, other, "{of:?}");
        }
    }

    /// Every key has words of its own, which editors show beside it.
    #[test]
    fn every_key_is_described() {
        fn check(schema: &Value, path: &str) {
            for (key, value) in schema["properties"].as_object().into_iter().flatten() {
                assert!(value["description"].as_str().is_some_and(|text| !text.is_empty()), "{path}.{key}: {value}");
                check(value, &format!("{path}.{key}"));
            }
            for part in ["oneOf", "then", "else", "items"] {
                let parts = schema[part].as_array().cloned().unwrap_or_else(|| vec![schema[part].clone()]);
                parts.iter().filter(|part| part.is_object()).for_each(|part| check(part, path));
            }
        }
        check(&schema(File::Any), "");
    }

    /// Every default is TOML, and of the kind that its key takes: a scene that writes it out is read.
    #[test]
    fn defaults_are_values() {
        fn check(keys: &'static Keys) {
            for key in keys.keys {
                if let Some(default) = key.default {
                    assert!(default.parse::<toml::Value>().is_ok(), "{}: {default}", key.name);
                }
                if let Some(inner) = key.kind.table() {
                    check(inner);
                }
            }
        }
        check(&SCENE);
    }
}
