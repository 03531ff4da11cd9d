//! The titles and units of columns, out of the lines before the numbers.

use super::format::Shape;
use super::unit::Unit;

/// What is said of a column.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Title {
    /// Without the unit.
    pub name: String,
    pub unit: Option<Unit>,
}

impl Title {
    /// Whether a user may mean this column by `name`.
    pub fn is_called(&self, name: &str) -> bool {
        !self.name.is_empty() && self.name.to_lowercase() == name.trim().to_lowercase()
    }
}

/// The titles in the last line of words that has as many fields as the numbers have, and the units in it or in a line
/// of its own under it. Comments may hold them too.
pub(super) fn of<'a>(preamble: impl DoubleEndedIterator<Item = &'a str>, shape: Shape) -> Vec<Title> {
    let mut lines = preamble.rev().filter_map(|line| fields(line, shape));
    let Some(last) = lines.next() else { return Vec::new() };
    let own: Vec<Option<Unit>> = last.iter().map(|field| Unit::parse(inside(field))).collect();
    let only_units = last.iter().zip(&own).all(|(field, unit)| unit.is_some() || is_pure(field));
    if !only_units || own.iter().all(Option::is_none) {
        return last.iter().map(|field| split(field)).collect();
    }
    let names = lines.next().unwrap_or_default();
    let name = |column: usize| names.get(column).map_or_else(Title::default, |field| split(field));
    own.into_iter().enumerate().map(|(column, unit)| Title { unit, ..name(column) }).collect()
}

/// The fields of a line of titles or units, if it has as many as the numbers have.
fn fields(line: &str, shape: Shape) -> Option<Vec<String>> {
    let line = line.trim().trim_start_matches(['#', '%', '\u{feff}']).trim();
    let by_mark = |mark: char| line.split(mark).map(tidy).collect::<Vec<_>>();
    let own = glued(shape.format.fields(line));
    [own, by_mark('\t'), by_mark(';'), by_mark(',')]
        .into_iter()
        .find(|fields| fields.len() == shape.fields && fields.iter().any(|field| field.contains(char::is_alphabetic)))
}

fn tidy(field: &str) -> String {
    field.trim().trim_matches('"').trim().to_owned()
}

/// Between blanks a unit in brackets is a field of its own: it belongs to the one before it.
fn glued(fields: Vec<&str>) -> Vec<String> {
    let mut whole: Vec<String> = Vec::new();
    for field in fields {
        match whole.last_mut() {
            Some(before)
                if field.starts_with(['(', '['])
                    && !before.ends_with([')', ']'])
                    && !before.is_empty()
                    && !before.starts_with(['(', '[']) =>
            {
                *before += " ";
                *before += field;
            }
            _ => whole.push(tidy(field)),
        }
    }
    whole
}

/// A column without a dimension.
fn is_pure(field: &str) -> bool {
    matches!(inside(field), "" | "-" | "1" | "%")
}

/// What is in the brackets around a field.
fn inside(field: &str) -> &str {
    field.trim().trim_start_matches(['(', '[']).trim_end_matches([')', ']']).trim()
}

/// `X (um)`, `X_[um]`, `X in um`, `X, um`, `X/um`: the name and the unit.
fn split(field: &str) -> Title {
    let of =
        |name: &str, unit: &str| Unit::parse(inside(unit)).map(|unit| Title { name: trimmed(name), unit: Some(unit) });
    let bracket = field.find(['(', '[']).and_then(|place| {
        let title = of(&field[..place], &field[place..]);
        // A unit that is not known is no part of the name either.
        title.or_else(|| Some(Title { name: trimmed(&field[..place]), unit: None })).filter(|t| !t.name.is_empty())
    });
    let after = |mark: &str| field.split_once(mark).and_then(|(name, unit)| of(name, unit));
    bracket
        .or_else(|| after(" in "))
        .or_else(|| after(", "))
        .or_else(|| after("/"))
        .unwrap_or_else(|| Title { name: trimmed(field), unit: None })
}

fn trimmed(name: &str) -> String {
    name.trim_matches([' ', '_', ':', '"']).to_owned()
}
