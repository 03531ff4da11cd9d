//! What separates the columns of a file, and what its numbers look like.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::ops::Range;

use super::{count, quoted};

/// What is between two columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Separator {
    /// One letter; nothing between two of them is an empty field. Quotes are taken off.
    Mark(char),
    /// Blanks and tabs, as many as there are.
    Blanks,
    /// Blanks and tabs, and perhaps a comma or semicolon among them.
    Any,
}

/// How the columns of a file are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Format {
    separator: Separator,
    /// 0,5 is a half.
    decimal_comma: bool,
}

/// The formats that are tried. Of two that make as much of a file the earlier is meant.
const FORMATS: [Format; 8] = {
    const fn format(separator: Separator, decimal_comma: bool) -> Format {
        Format { separator, decimal_comma }
    }
    [
        format(Separator::Mark(';'), false),
        format(Separator::Mark(';'), true),
        format(Separator::Mark('\t'), false),
        format(Separator::Mark('\t'), true),
        format(Separator::Mark(','), false),
        format(Separator::Mark(','), true),
        format(Separator::Blanks, true),
        format(Separator::Any, false),
    ]
};

/// What instruments write where they have no value, besides nothing, stars and dashes.
const MISSING: [&str; 10] = ["bad", "nan", "-nan", "nan(ind)", "na", "n/a", "null", "none", "no data", "invalid"];
/// What spreadsheets write there.
const ERRORS: [&str; 6] = ["#N/A", "#DIV/0!", "#VALUE!", "#NUM!", "#REF!", "#NAME?"];

/// What is in a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Cell {
    /// Perhaps infinite.
    Number(f64),
    /// Said not to be there.
    Missing,
    /// Anything else.
    Word,
}

/// Number (from 1) and place of each line.
pub(super) fn lines(text: &str) -> Vec<(usize, Range<usize>)> {
    // Very old files end their lines by carriage returns alone.
    let end = if text.contains('\n') { '\n' } else { '\r' };
    let mut start = 0;
    let places = text.split(end).map(|line| {
        let place = start..start + line.len();
        start = place.end + 1;
        place
    });
    places.enumerate().map(|(index, place)| (index + 1, place)).collect()
}

/// A line without its comment, which `#` begins.
pub(super) fn content(line: &str) -> &str {
    let begins = |(place, _): &(usize, &str)| !ERRORS.iter().any(|error| line[*place..].starts_with(error));
    let end = line.match_indices('#').find(begins).map_or(line.len(), |(place, _)| place);
    line[..end].trim_matches([' ', '\r', '\u{feff}'])
}

impl Format {
    /// The fields of a line.
    pub fn fields(self, content: &str) -> Vec<&str> {
        match self.separator {
            Separator::Mark(mark) => marked(content, mark),
            Separator::Blanks => content.split_whitespace().collect(),
            Separator::Any => any(content),
        }
    }

    /// What is in a field.
    pub fn cell(self, field: &str) -> Cell {
        match number(field, self.decimal_comma) {
            Some(value) => Cell::Number(value),
            None if is_missing(field) => Cell::Missing,
            None => Cell::Word,
        }
    }

    /// What a line is made of.
    fn census(self, content: &str) -> Census {
        let mut census = Census::default();
        for field in self.fields(content) {
            census.fields += 1;
            match self.cell(field) {
                Cell::Number(_) => census.numbers += 1,
                Cell::Word => census.words += 1,
                Cell::Missing => {}
            }
        }
        census
    }
}

/// How many fields a line has, and how many of them are numbers and words.
#[derive(Debug, Clone, Copy, Default)]
struct Census {
    fields: usize,
    numbers: usize,
    words: usize,
}

/// Fields between single marks; a mark inside quotes is none.
fn marked(content: &str, mark: char) -> Vec<&str> {
    let mut quoted = false;
    content
        .split(|letter| {
            quoted ^= letter == '"';
            letter == mark && !quoted
        })
        .map(|field| field.trim().trim_matches('"').trim())
        .collect()
}

/// Fields between blanks; one comma or semicolon among them goes with them, a second one has an empty field before it.
fn any(content: &str) -> Vec<&str> {
    let pieces = content.split([',', ';']).map(|piece| piece.split_whitespace().collect::<Vec<_>>());
    pieces.flat_map(|piece| if piece.is_empty() { vec![""] } else { piece }).collect()
}

/// The number that is written in a field: with a point or a comma, the exponent behind an e or Fortran's d.
fn number(field: &str, decimal_comma: bool) -> Option<f64> {
    let digits = field.strip_prefix(['+', '-', '\u{2212}']).unwrap_or(field);
    let mark = if decimal_comma { ',' } else { '.' };
    let other = if decimal_comma { '.' } else { ',' };
    let fraction = digits.strip_prefix(mark).unwrap_or(digits);
    // Rust reads `inf`, `nan` and a bare point as well.
    if !fraction.starts_with(|letter: char| letter.is_ascii_digit()) || field.contains(other) {
        return None;
    }
    if decimal_comma && digits.ends_with(',') {
        return None;
    }
    if !decimal_comma && field.is_ascii() && !field.contains(['d', 'D']) {
        return field.parse().ok();
    }
    let plain: String = field
        .chars()
        .map(|c| match c {
            ',' => '.',
            'd' | 'D' => 'e',
            '\u{2212}' => '-',
            c => c,
        })
        .collect();
    plain.parse().ok()
}

fn is_missing(field: &str) -> bool {
    field.chars().all(|letter| matches!(letter, '*' | '-' | '\u{2013}' | '?'))
        || MISSING.iter().any(|word| word.eq_ignore_ascii_case(field))
        || ERRORS.iter().any(|word| word.eq_ignore_ascii_case(field))
}

/// What most lines of numbers have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shape {
    pub format: Format,
    /// How many fields they have.
    pub fields: usize,
    /// Whether there are words among them.
    pub words: bool,
}

/// What is wrong with a line of another number of columns than most.
pub(super) fn other_width(fields: usize, most: usize) -> String {
    format!("{}, but most lines have {most}", count(fields, "column"))
}

impl Shape {
    /// The shape that most lines of a file have, as far as the first of them tell; a line without words counts twice.
    pub fn of<'a>(contents: impl Iterator<Item = &'a str>) -> Option<Self> {
        const LOOKED_AT: usize = 1000;
        let contents: Vec<&str> = contents.filter(|content| !content.is_empty()).take(LOOKED_AT).collect();
        let shapes = FORMATS.into_iter().flat_map(|format| {
            let rows: Vec<Census> = contents.iter().map(|content| format.census(content)).collect();
            [false, true].map(|words| Self::among(&rows, format, words))
        });
        // Of equals `max_by_key` takes the last, and the first is meant.
        shapes.flatten().collect::<Vec<_>>().into_iter().rev().max_by_key(|(score, _)| *score).map(|(_, shape)| shape)
    }

    /// The most frequent number of fields, and how well that does: by the lines, and by how few words are left in the file.
    fn among(rows: &[Census], format: Format, words: bool) -> Option<((usize, Reverse<usize>), Self)> {
        let mut lines: BTreeMap<usize, usize> = BTreeMap::new();
        for row in rows.iter().filter(|row| row.numbers >= 2 && (row.words > 0) == words) {
            *lines.entry(row.fields).or_default() += 1;
        }
        let (fields, count) = lines.into_iter().max_by_key(|(_, count)| *count)?;
        let weight = if words { 1 } else { 2 };
        let left = rows.iter().map(|row| row.words).sum();
        Some(((weight * count, Reverse(left)), Self { format, fields, words }))
    }

    /// Whether a line can be the first one of numbers.
    pub fn begins(self, content: &str) -> bool {
        let Census { fields, numbers, words } = self.format.census(content);
        fields == self.fields && if self.words { numbers >= 2 } else { words == 0 && numbers >= 1 }
    }

    /// Refuses a line before the first one of numbers that was meant to be one: numbers in another number of columns,
    /// or as many fields of which the first is no word but another is.
    pub fn check_preamble(self, content: &str) -> Result<(), String> {
        let fields = self.format.fields(content);
        let Census { numbers, words, .. } = self.format.census(content);
        if words == 0 && numbers >= 2 {
            return Err(other_width(fields.len(), self.fields) + "; begin comments with #");
        }
        let begins_with_word =
            fields.first().is_none_or(|first| first.is_empty() || first.contains(char::is_alphabetic));
        if numbers == 0 || begins_with_word || fields.len() != self.fields {
            return Ok(());
        }
        let word = fields.into_iter().find(|field| self.format.cell(field) == Cell::Word);
        word.map_or(Ok(()), |word| Err(format!("{} is not a number; begin comments with #", quoted(word))))
    }
}
