//! A table of the scene while it is read: typed access by key, with messages that name the dotted path of the key,
//! what is wrong and what would be accepted. Which keys there are, and what each takes, is in [`tables`].

pub(crate) mod kind;
pub(crate) mod quantity;
pub(crate) mod tables;

use std::ops::RangeInclusive;
use std::path::Path;

use nalgebra::Vector2;
use toml::{Table, Value};

use kind::{Key, Keys, Kind};
use quantity::Quantity;

use crate::error::{Error, Result};

/// One table of the scene, and where it is.
#[derive(Clone)]
pub(super) struct Section<'a> {
    file: &'a Path,
    path: String,
    table: &'a Table,
    keys: &'static Keys,
}

impl<'a> Section<'a> {
    /// The whole file.
    pub fn root(file: &'a Path, table: &'a Table, keys: &'static Keys) -> Self {
        Self { file, path: String::new(), table, keys }
    }

    /// What the table says of a key; that it says nothing is a defect.
    fn key(&self, key: &str) -> Result<&'static Key> {
        self.keys.get(key).ok_or_else(|| Error::Internal(format!("{} is not in the tables of keys", self.path_of(key))))
    }

    /// Completes "must be ..." for a key.
    pub fn what(&self, key: &str) -> &'static str {
        self.keys.get(key).map_or("", |key| key.kind.what())
    }

    /// The same table, called `path` in messages.
    pub fn called(self, path: String) -> Self {
        Self { path, ..self }
    }

    /// The dotted path of one of the keys.
    pub fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// An error at one of the keys.
    pub fn error(&self, key: &str, reason: impl Into<String>) -> Error {
        Error::scene(self.file, self.path_of(key), reason)
    }

    /// Whether the file says this key.
    pub fn has(&self, key: &str) -> bool {
        self.table.contains_key(key)
    }

    /// The table itself.
    pub fn table(&self) -> &'a Table {
        self.table
    }

    /// Refuses every key that the table does not have. To be called before anything is read, so that a misspelt key is
    /// reported as such and not as a missing one.
    pub fn only_known(&self) -> Result<()> {
        let word = self.keys.decides.as_ref().and_then(|decides| self.table.get(decides.by)?.as_str());
        let known = self.keys.beside(word);
        match self.table.keys().find(|key| !known.contains(&key.as_str())) {
            None => Ok(()),
            Some(key) => Err(self.error(key, format!("unknown key; {}", advice(key, &known, "known keys")))),
        }
    }

    /// Refuses keys that belong to later versions: `(key, what to write instead)`.
    pub fn later(&self, keys: &[(&str, &str)]) -> Result<()> {
        match keys.iter().find(|(key, _)| self.has(key)) {
            None => Ok(()),
            Some((key, instead)) => Err(self.error(key, format!("not supported by this version; {instead}"))),
        }
    }

    /// A number that must be there.
    pub fn number(&self, key: &str) -> Result<f64> {
        self.optional_number(key)?.ok_or_else(|| self.missing(key, self.what(key)))
    }

    /// A number that may be absent. Whole numbers are numbers.
    pub fn optional_number(&self, key: &str) -> Result<Option<f64>> {
        let quantity = self.quantity(key)?;
        let Some(value) = self.table.get(key) else { return Ok(None) };
        match number(value) {
            Some(number) if !number.is_finite() => Err(self.must_be(key, &format!("finite: {}", quantity.what), value)),
            Some(number) if quantity.accepts(number) => Ok(Some(number)),
            _ => Err(self.must_be(key, quantity.what, value)),
        }
    }

    /// A number, or none for a word; one of them must be there.
    pub fn number_or_word(&self, key: &str, word: &str) -> Result<Option<f64>> {
        let Kind::NumberOrWord(quantity, _, what) = self.key(key)?.kind else {
            return Err(self.not_a("number or word", key));
        };
        match self.table.get(key) {
            None => Err(self.missing(key, what)),
            Some(Value::String(text)) if text == word => Ok(None),
            Some(value) => match number(value).filter(|number| number.is_finite() && quantity.accepts(*number)) {
                Some(number) => Ok(Some(number)),
                None => Err(self.must_be(key, what, value)),
            },
        }
    }

    /// A table, or none for a word or where there is neither.
    pub fn word_or_section(&self, key: &str, word: &str) -> Result<Option<Section<'a>>> {
        match self.table.get(key) {
            None => Ok(None),
            Some(Value::String(text)) if text == word => Ok(None),
            Some(Value::Table(table)) => Ok(Some(self.child(key, self.path_of(key), table)?)),
            Some(value) => Err(self.must_be(key, self.what(key), value)),
        }
    }

    /// What a number at the key must be.
    fn quantity(&self, key: &str) -> Result<Quantity> {
        match self.key(key)?.kind {
            Kind::Number(quantity) | Kind::OneOrTwo(quantity) | Kind::NumberOrFormula(quantity) => Ok(quantity),
            _ => Err(self.not_a("number", key)),
        }
    }

    /// One number, or an array of one for x and one for y. Absent is none.
    pub fn one_or_two(&self, key: &str) -> Result<Option<Vec<f64>>> {
        let quantity = self.quantity(key)?;
        let Some(Value::Array(values)) = self.table.get(key) else {
            return Ok(self.optional_number(key)?.map(|number| vec![number]));
        };
        let accepted = |value: &Value| number(value).filter(|number| number.is_finite() && quantity.accepts(*number));
        match values.iter().map(accepted).collect::<Option<Vec<f64>>>() {
            Some(numbers) if numbers.len() == 2 => Ok(Some(numbers)),
            _ => Err(self.error(key, format!("must be {}, or an array of two, for x and for y", quantity.what))),
        }
    }

    /// A vector along the face: a number is its component along x.
    pub fn along_the_face(&self, key: &str) -> Result<Option<Vector2<f64>>> {
        let numbers = self.one_or_two(key)?;
        Ok(numbers.map(|numbers| Vector2::new(numbers[0], numbers.get(1).copied().unwrap_or(0.0))))
    }

    /// A whole number that must be there.
    pub fn count(&self, key: &str) -> Result<usize> {
        self.optional_count(key)?.ok_or_else(|| self.missing(key, self.what(key)))
    }

    /// A whole number that may be absent.
    pub fn optional_count(&self, key: &str) -> Result<Option<usize>> {
        let Kind::Count(what, [least, most]) = self.key(key)?.kind else { return Err(self.not_a("count", key)) };
        self.table.get(key).map(|value| self.whole(key, value, what, least..=most)).transpose()
    }

    fn not_a(&self, kind: &str, key: &str) -> Error {
        Error::Internal(format!("{} is no {kind} in the tables of keys", self.path_of(key)))
    }

    /// True or false, or nothing.
    pub fn optional_flag(&self, key: &str) -> Result<Option<bool>> {
        match self.table.get(key) {
            None => Ok(None),
            Some(Value::Boolean(flag)) => Ok(Some(*flag)),
            Some(value) => Err(self.must_be(key, "true or false", value)),
        }
    }

    /// The whole numbers of a body with so many directions along its face, which must be there.
    pub fn cells(&self, key: &str, directions: usize) -> Result<Vec<usize>> {
        let Kind::Cells(whats, [least, most]) = self.key(key)?.kind else {
            return Err(self.not_a("list of cells", key));
        };
        let what = whats.get(directions - 1).copied().unwrap_or_default();
        match self.table.get(key) {
            None => Err(self.missing(key, what)),
            Some(Value::Array(values)) if values.len() == directions + 1 => {
                values.iter().map(|value| self.whole(key, value, what, least..=most)).collect()
            }
            Some(Value::Array(values)) => Err(self.error(key, format!("must be {what}, got {} values", values.len()))),
            Some(value) => Err(self.must_be(key, what, value)),
        }
    }

    fn whole(&self, key: &str, value: &Value, what: &str, range: RangeInclusive<usize>) -> Result<usize> {
        match *value {
            Value::Integer(number) => usize::try_from(number).ok().filter(|number| range.contains(number)),
            Value::Float(number) if number.fract() == 0.0 => {
                let reason = format!("must be {what}, got {} (write {number:.0})", show(value));
                return Err(self.error(key, reason));
            }
            _ => None,
        }
        .ok_or_else(|| self.must_be(key, what, value))
    }

    /// A text that may be absent. Control characters are refused: the text goes to HDF5 and to the terminal.
    pub fn optional_text(&self, key: &str) -> Result<Option<String>> {
        let what = self.key(key)?.kind.what();
        match self.table.get(key) {
            None => Ok(None),
            Some(Value::String(text)) if !text.chars().any(char::is_control) => Ok(Some(text.clone())),
            Some(value) => Err(self.must_be(key, what, value)),
        }
    }

    /// A name that may be absent: a text, or a whole number as the text that it stands for.
    pub fn optional_label(&self, key: &str) -> Result<Option<String>> {
        match self.table.get(key).and_then(label) {
            Some(number) => Ok(Some(number)),
            None => self.optional_text(key),
        }
    }

    /// One of the `accepted` words, which must be there; the words in `later` belong to later versions.
    pub fn choice<T: Copy>(&self, key: &str, accepted: &[(&str, T)], later: &[&str]) -> Result<T> {
        self.optional_choice(key, accepted, later)?.ok_or_else(|| self.missing(key, &either(accepted)))
    }

    /// One of the `accepted` words, or nothing.
    pub fn optional_choice<T: Copy>(&self, key: &str, accepted: &[(&str, T)], later: &[&str]) -> Result<Option<T>> {
        let known = self.key(key)?.kind.words().unwrap_or_default();
        if !accepted.iter().all(|(word, _)| known.contains(word)) {
            return Err(self.not_a("choice of these words", key));
        }
        let Some(value) = self.table.get(key) else { return Ok(None) };
        let word = value.as_str().unwrap_or_default();
        if let Some((_, choice)) = accepted.iter().find(|(name, _)| *name == word) {
            return Ok(Some(*choice));
        }
        let either = either(accepted);
        if later.contains(&word) {
            return Err(self.error(key, format!("\"{word}\" is not supported by this version; use {either}")));
        }
        let names: Vec<&str> = accepted.iter().map(|(name, _)| *name).collect();
        let hint = match nearest(word, &names) {
            Some(name) if names.len() > 1 => format!("; did you mean \"{name}\"?"),
            _ => String::new(),
        };
        Err(self.error(key, format!("must be {either}, got {}{hint}", show(value))))
    }

    /// A table that must be there.
    pub fn section(&self, key: &str) -> Result<Section<'a>> {
        self.optional_section(key)?.ok_or_else(|| self.missing(key, &format!("the [{}] table", self.path_of(key))))
    }

    /// A table that may be absent.
    pub fn optional_section(&self, key: &str) -> Result<Option<Section<'a>>> {
        match self.table.get(key) {
            None => Ok(None),
            Some(Value::Table(table)) => Ok(Some(self.child(key, self.path_of(key), table)?)),
            Some(value) => Err(self.must_be(key, "a table", value)),
        }
    }

    /// An array of tables, numbered from 0 in messages; empty when absent.
    pub fn sections(&self, key: &str) -> Result<Vec<Section<'a>>> {
        let what = self.what(key);
        let values = match self.table.get(key) {
            None => return Ok(Vec::new()),
            Some(Value::Array(values)) => values,
            Some(value) => return Err(self.must_be(key, what, value)),
        };
        let section = |(index, value): (usize, &'a Value)| match value {
            Value::Table(table) => self.child(key, format!("{}.{index}", self.path_of(key)), table),
            value => Err(self.error(&format!("{key}.{index}"), format!("must be a table, got {}", show(value)))),
        };
        values.iter().enumerate().map(section).collect()
    }

    /// A table at one of the keys.
    fn child(&self, key: &str, path: String, table: &'a Table) -> Result<Section<'a>> {
        // Tables whose keys are paths of a scene have none of their own.
        let keys = self.key(key)?.kind.table().unwrap_or(&tables::NONE);
        Ok(Section { file: self.file, path, table, keys })
    }

    /// An array of anything; empty when absent.
    pub fn values(&self, key: &str) -> Result<&'a [Value]> {
        let what = self.key(key)?.kind.what();
        match self.table.get(key) {
            None => Ok(&[]),
            Some(Value::Array(values)) => Ok(values),
            Some(value) => Err(self.must_be(key, what, value)),
        }
    }

    /// An array of finite numbers; empty when absent.
    pub fn numbers(&self, key: &str) -> Result<Vec<f64>> {
        let finite = |(index, value): (usize, &Value)| {
            let found = number(value).filter(|number| number.is_finite());
            found.ok_or_else(|| self.must_be(&format!("{key}.{index}"), "a finite number", value))
        };
        self.values(key)?.iter().enumerate().map(finite).collect()
    }

    /// The error for an absent key.
    pub fn missing(&self, key: &str, what: &str) -> Error {
        self.error(key, format!("missing; give {what}"))
    }

    /// The error for a value that is not accepted.
    pub fn must_be(&self, key: &str, what: &str, value: &Value) -> Error {
        self.error(key, format!("must be {what}, got {}", show(value)))
    }
}

/// The number in a value; whole numbers are numbers.
pub(super) fn number(value: &Value) -> Option<f64> {
    match *value {
        Value::Integer(number) => Some(number as f64),
        Value::Float(number) => Some(number),
        _ => None,
    }
}

/// A whole number where a name may stand, as a text.
pub(super) fn label(value: &Value) -> Option<String> {
    value.as_integer().map(|number| number.to_string())
}

/// A value as it may stand in a message: as it would be typed, and on a short line.
pub(super) fn show(value: &Value) -> String {
    const LONGEST: usize = 60;
    let kind = match value {
        Value::Float(number) if number.is_nan() => return "nan".to_owned(),
        Value::Float(number) => return format!("{number:?}"),
        Value::Integer(number) => return number.to_string(),
        Value::Boolean(yes) => return yes.to_string(),
        Value::String(text) if text.chars().count() <= LONGEST => return format!("{text:?}"),
        Value::String(_) => "a long text",
        Value::Datetime(_) => "a date",
        Value::Array(values) if values.is_empty() => "an empty array",
        Value::Array(_) => "an array",
        Value::Table(_) => "a table",
    };
    kind.to_owned()
}

/// What to write instead of an unknown word: the nearest known one, or all of them when none is near.
pub(super) fn advice(word: &str, known: &[&str], title: &str) -> String {
    match nearest(word, known) {
        Some(name) => format!("did you mean \"{name}\"?"),
        None => format!("{title}: {}", known.join(", ")),
    }
}

/// The known word that looks most like this one, if any does.
pub(crate) fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    const ALIKE: f64 = 0.75;
    let word = word.to_lowercase();
    known
        .iter()
        .map(|name| (strsim::jaro_winkler(&word, &name.to_lowercase()), *name))
        .filter(|(likeness, _)| *likeness >= ALIKE)
        .max_by(|(one, _), (other, _)| one.total_cmp(other))
        .map(|(_, name)| name)
}

/// `"a", "b" or "c"`.
fn either<T>(accepted: &[(&str, T)]) -> String {
    let quoted: Vec<String> = accepted.iter().map(|(name, _)| format!("\"{name}\"")).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => quoted.concat(),
    }
}
