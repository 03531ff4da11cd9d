//! Keys of a sweep that follow from others by a formula.

use std::path::Path;

use toml::{Table, Value};

use crate::error::{Error, Result};
use crate::expression::{Dual, Expression};
use crate::scene::keys::{Section, number};
use crate::scene::{get, set};

/// A key and its formula in other keys.
pub(super) struct Follow {
    key: String,
    formula: String,
    /// The keys in it.
    others: Vec<String>,
    expression: Expression,
}

/// The `[follow]` table, in its order; a key may follow from one before it, and none is `varied`.
pub(super) fn read(root: &Section, varied: &[&str]) -> Result<Vec<Follow>> {
    let Some(section) = root.optional_section("follow")? else { return Ok(Vec::new()) };
    let follow = |(key, value): (&String, &Value)| {
        let formula = match value {
            Value::String(formula) => formula.clone(),
            Value::Table(_) => {
                let reason = format!("must be a formula; put a key with dots in quotes: \"{key}. ...\"");
                return Err(section.error(key, reason));
            }
            other => return Err(section.must_be(key, "a formula, such as \"0.01 * phase.slide.velocity\"", other)),
        };
        if varied.contains(&key.as_str()) {
            return Err(section.error(key, "is varied too; take it out of [vary] or of [follow]"));
        }
        let others = paths(&formula);
        let names: Vec<&str> = others.iter().map(String::as_str).collect();
        let expression = Expression::parse(&formula, &names)
            .map_err(|fault| section.error(key, format!("is not a formula: {formula:?}, {fault}")))?;
        Ok(Follow { key: key.clone(), formula, others, expression })
    };
    section.table().iter().map(follow).collect()
}

impl Follow {
    /// Sets the key in the table of a scene whose other keys are set.
    pub(super) fn apply(&self, table: &mut Table, sweep: &Path) -> Result<()> {
        let wrong = |reason: String| Error::scene(sweep, format!("follow.{:?}", self.key), reason);
        let value = |path: &String| {
            get(table, path)
                .and_then(number)
                .ok_or_else(|| wrong(format!("{path} in {:?} is not a number of the scene", self.formula)))
        };
        let values: Vec<Dual> =
            self.others.iter().map(|path| value(path).map(Dual::constant)).collect::<Result<_>>()?;
        let result = self.expression.at(&values).value;
        if result.is_finite() {
            return set(table, &self.key, Value::Float(result), sweep);
        }
        Err(wrong(format!("{:?} gives {result}, which is not a finite number", self.formula)))
    }
}

/// The dotted keys in a formula, each once.
fn paths(formula: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut rest = formula;
    while let Some(first) = rest.chars().next() {
        let length = if first.is_alphabetic() || first == '_' { word(rest) } else { first.len_utf8() };
        let (word, after) = rest.split_at(length);
        if word.contains('.') && first != '.' && !found.iter().any(|known| known == word) {
            found.push(word.to_owned());
        }
        rest = after;
    }
    found
}

/// The bytes of the key at the beginning of the text; dots and quotes are part of it.
fn word(text: &str) -> usize {
    let mut quoted = false;
    let ends = |c: char| {
        quoted ^= c == '"';
        !(quoted || c.is_alphanumeric() || ['_', '.', '"'].contains(&c))
    };
    text.find(ends).unwrap_or(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dotted_keys_are_variables() {
        for (formula, expected) in [
            ("0.01 * phase.slide.velocity", &["phase.slide.velocity"][..]),
            ("1e-3*sqrt(layer.width)/2.5 + 1.e-3 + layer.width", &["layer.width"]),
            ("phase.\"1.5 s\".velocity-phase.0.steps^2", &["phase.\"1.5 s\".velocity", "phase.0.steps"]),
        ] {
            assert_eq!(paths(formula), expected);
            assert!(Expression::parse(formula, expected).is_ok(), "{formula}");
        }
    }
}
