//! Columns of numbers out of text files as instruments and spreadsheets write them.
//!
//! It knows nothing of what the columns mean. Lines of titles and units before the numbers, separators, decimal commas
//! and encodings are found out; points without a value are left out and counted; what is wrong has its line.

mod curve;
mod encoding;
mod format;
mod titles;
mod unit;

use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::str::FromStr;

pub use curve::Curve;
pub use unit::{Quantity, Unit};

use self::format::{Cell, Shape};
use self::titles::Title;
use crate::error::Error;

/// A line that cannot be used, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// Counted from 1.
    pub line: usize,
    /// What is wrong and what would be accepted.
    pub reason: String,
}

impl Fault {
    /// The error that it is of `file`.
    pub fn of(self, file: &Path) -> Error {
        Error::scene(file, format!("line {}", self.line), self.reason)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.reason)
    }
}

/// A column, as a user names it.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
#[serde(untagged)]
pub enum Choice {
    /// Its number, from 1.
    Number(usize),
    /// Its title, without the unit.
    Title(String),
}

impl FromStr for Choice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text.trim(), text.trim().parse()) {
            ("", _) | (_, Ok(0)) => Err("columns are numbers from 1, or titles".into()),
            (_, Ok(number)) => Ok(Self::Number(number)),
            (title, Err(_)) => Ok(Self::Title(title.to_owned())),
        }
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Title(title) => f.write_str(&quoted(title)),
        }
    }
}

/// A file's text, and where its numbers are.
#[derive(Debug, Clone)]
pub struct Table {
    text: String,
    /// Number and place of each line from the first one of numbers on.
    lines: Vec<(usize, Range<usize>)>,
    shape: Shape,
    titles: Vec<Title>,
}

/// The chosen columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// In the order of the file.
    pub rows: Vec<Row>,
    /// How many points had no value in one of them.
    pub skipped: usize,
}

/// One line of the chosen columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Counted from 1.
    pub line: usize,
    /// Finite, as many as columns were chosen.
    pub values: Vec<f64>,
}

impl Columns {
    /// Sorts the rows by their first column, those of one value by their line; whether they were not so already.
    pub fn sort(&mut self) -> bool {
        let sorted = self.rows.is_sorted_by(|a, b| a.values[0] <= b.values[0]);
        self.rows.sort_by(|a, b| a.values[0].total_cmp(&b.values[0]));
        !sorted
    }
}

impl Table {
    /// Finds the numbers in the content of a file.
    ///
    /// # Errors
    /// The line at which it cannot be a table of two columns or more.
    pub fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let text = encoding::text(bytes)?;
        let lines = format::lines(&text);
        let content = |range: &Range<usize>| format::content(&text[range.clone()]);
        let Some(shape) = Shape::of(lines.iter().map(|(_, range)| content(range))) else {
            return Err(no_table(&text, &lines));
        };
        let begin = lines.iter().position(|(_, range)| shape.begins(content(range))).unwrap_or(lines.len());
        let (preamble, _) = lines.split_at(begin);
        for (line, range) in preamble {
            shape.check_preamble(content(range)).map_err(|reason| Fault { line: *line, reason })?;
        }
        let titles = titles::of(preamble.iter().map(|(_, range)| &text[range.clone()]), shape);
        let lines = lines[begin..].to_vec();
        Ok(Self { text, lines, shape, titles })
    }

    /// How many columns there are.
    pub fn width(&self) -> usize {
        self.shape.fields
    }

    /// The title of a column counted from 0, without the unit; empty if there is none.
    pub fn title(&self, column: usize) -> &str {
        self.titles.get(column).map_or("", |title| &title.name)
    }

    /// The unit of a column counted from 0, as far as the file says one that is known.
    pub fn unit(&self, column: usize) -> Option<Unit> {
        self.titles.get(column).and_then(|title| title.unit)
    }

    /// The unit of a column of lengths, counted from 0: what is said must be what the file says; m where neither says one.
    ///
    /// # Errors
    /// That they differ, or that it holds no lengths.
    pub fn length(&self, column: usize, said: Option<Unit>) -> Result<Unit, String> {
        match (self.unit(column), said) {
            (Some(unit), _) if unit.quantity != Quantity::Length => {
                Err(format!("column {} is in {}, which is no length; give columns of lengths", column + 1, unit.name))
            }
            (Some(unit), Some(said)) if unit != said => {
                Err(format!("column {} is in {} by its title, but the scene says {}", column + 1, unit.name, said.name))
            }
            (Some(unit), _) => Ok(unit),
            (None, said) => Ok(said.unwrap_or(Unit::METRE)),
        }
    }

    /// The column, counted from 0, that is chosen.
    ///
    /// # Errors
    /// That there is none, with those there are.
    pub fn find(&self, choice: &Choice) -> Result<usize, String> {
        let known = || match self.titles.iter().filter(|title| !title.name.is_empty()).count() {
            0 => format!("it has {}, without titles", count(self.width(), "column")),
            _ => {
                let names: Vec<String> = self.titles.iter().take(12).map(|title| quoted(&title.name)).collect();
                format!("it has {}: {}", count(self.width(), "column"), names.join(", "))
            }
        };
        let found = match choice {
            Choice::Number(number) => number.checked_sub(1).filter(|column| *column < self.width()),
            Choice::Title(name) => self.titles.iter().position(|title| title.is_called(name)),
        };
        found.ok_or_else(|| format!("there is no column {choice}; {}", known()))
    }

    /// The numbers of some columns, counted from 0.
    ///
    /// # Errors
    /// The first line that has something else there.
    pub fn columns(&self, columns: &[usize]) -> Result<Columns, Fault> {
        let mut picked = Columns { rows: Vec::with_capacity(self.lines.len()), skipped: 0 };
        for (line, range) in &self.lines {
            let content = format::content(&self.text[range.clone()]);
            match self.row(content, columns).map_err(|reason| Fault { line: *line, reason })? {
                Found::Values(values) => picked.rows.push(Row { line: *line, values }),
                Found::Nothing => picked.skipped += 1,
                Found::Words => {}
            }
        }
        Ok(picked)
    }

    /// The numbers of all lines, one line after the other; not a number where a point has no value.
    ///
    /// # Errors
    /// The first line that has something else there.
    pub fn matrix(&self) -> Result<Vec<f64>, Fault> {
        let mut values = Vec::with_capacity(self.lines.len() * self.width());
        for (line, range) in &self.lines {
            let fault = |reason| Fault { line: *line, reason };
            let Some((fields, cells)) = self.line(format::content(&self.text[range.clone()])).map_err(fault)? else {
                continue;
            };
            if cells.len() != self.width() {
                return Err(fault(format::other_width(cells.len(), self.width())));
            }
            for (cell, field) in cells.iter().zip(fields) {
                values.push(value(*cell, field).map_err(fault)?.unwrap_or(f64::NAN));
            }
        }
        Ok(values)
    }

    fn row(&self, content: &str, columns: &[usize]) -> Result<Found, String> {
        let Some((fields, cells)) = self.line(content)? else { return Ok(Found::Words) };
        let mut values = Vec::with_capacity(columns.len());
        for &column in columns {
            let (Some(cell), Some(field)) = (cells.get(column), fields.get(column)) else {
                return Err(format::other_width(cells.len(), self.width()));
            };
            match value(*cell, field)? {
                Some(value) => values.push(value),
                None => return Ok(Found::Nothing),
            }
        }
        Ok(Found::Values(values))
    }

    /// The fields of a line of numbers, and what is in each; none of one that has but words.
    fn line<'a>(&self, content: &'a str) -> Result<Option<Line<'a>>, String> {
        let fields = self.shape.format.fields(content);
        let cells: Vec<Cell> = fields.iter().map(|field| self.shape.format.cell(field)).collect();
        if !cells.iter().any(|cell| matches!(cell, Cell::Number(_))) {
            // Titles between two blocks of numbers, words after the last one, empty lines; or a point without any value.
            let point = cells.len() == self.width() && !cells.contains(&Cell::Word);
            return Ok(point.then_some((fields, cells)));
        }
        if !self.shape.words && cells.iter().skip(self.width()).any(|cell| *cell != Cell::Missing) {
            return Err(format::other_width(cells.len(), self.width()));
        }
        Ok(Some((fields, cells)))
    }
}

/// The finite number in a field; none where it is missing.
fn value(cell: Cell, field: &str) -> Result<Option<f64>, String> {
    match cell {
        Cell::Number(value) if value.is_finite() => Ok(Some(value)),
        Cell::Number(_) => Err(format!("{} is not a finite number", quoted(field))),
        Cell::Word => Err(format!("{} is not a number", quoted(field))),
        Cell::Missing => Ok(None),
    }
}

/// The fields of a line, and what is in each.
type Line<'a> = (Vec<&'a str>, Vec<Cell>);

/// What a line has in the columns asked for.
enum Found {
    Values(Vec<f64>),
    Nothing,
    Words,
}

/// Why there is no table: the first line that has words or one number, else the last line.
fn no_table(text: &str, lines: &[(usize, Range<usize>)]) -> Fault {
    let first = lines.iter().find(|(_, range)| {
        let content = format::content(&text[range.clone()]);
        content.starts_with(|letter: char| letter.is_ascii_digit() || matches!(letter, '+' | '-' | '.'))
    });
    match first {
        Some((line, range)) => {
            let shown = quoted(format::content(&text[range.clone()]));
            Fault { line: *line, reason: format!("{shown} is not two numbers; give at least two columns") }
        }
        None => {
            let line = text.lines().count().max(1);
            Fault { line, reason: "the file ends here without any line of two numbers".into() }
        }
    }
}

/// A piece of a file as it may stand in a message: short, and without control characters.
pub fn quoted(text: &str) -> String {
    const LONGEST: usize = 30;
    let shown: String = text.chars().take(LONGEST).map(|c| if c.is_control() { '?' } else { c }).collect();
    let more = if text.chars().nth(LONGEST).is_some() { "..." } else { "" };
    format!("`{shown}{more}`")
}

fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests;
