//! What a sweep varied: the first columns of its `summary.csv`.

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::{Error, Result};
use crate::input;

/// The varied keys and their values in each case.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Slowest first.
    pub keys: Vec<String>,
    /// As they were typed, by the number of the case.
    pub values: BTreeMap<usize, Vec<String>>,
}

impl Table {
    /// Of the sweep in `directory`; none where it has no such file, as while it runs.
    pub fn read(directory: &Path) -> Result<Option<Self>> {
        let file = directory.join("summary.csv");
        if !file.exists() {
            return Ok(None);
        }
        let wrong = || Error::file(&file, "is not the summary of a sweep; mpjr sweep writes it anew");
        Self::parse(&input::text(&file)?).ok_or_else(wrong).map(Some)
    }

    fn parse(text: &str) -> Option<Self> {
        let mut rows = rows(text).into_iter();
        let head = rows.next()?;
        let last = head.iter().position(|name| name == "status")?;
        let keys = head.get(1..last).filter(|keys| !keys.is_empty() && head[0] == "case")?.to_vec();
        let value = |row: Vec<String>| Some((row.first()?.parse().ok()?, row.get(1..last)?.to_vec()));
        Some(Self { keys, values: rows.map(value).collect::<Option<_>>()? })
    }
}

/// The cells of a table separated by commas (RFC 4180).
fn rows(text: &str) -> Vec<Vec<String>> {
    let (mut rows, mut row, mut cell, mut quoted) = (Vec::new(), Vec::new(), String::new(), false);
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        match character {
            '"' if quoted && characters.peek() == Some(&'"') => cell.extend(characters.next()),
            '"' => quoted = !quoted,
            ',' if !quoted => row.push(std::mem::take(&mut cell)),
            '\n' if !quoted => {
                row.push(std::mem::take(&mut cell));
                rows.push(std::mem::take(&mut row));
            }
            '\r' if !quoted => {}
            other => cell.push(other),
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_and_values_are_read_and_other_tables_are_not() {
        let text =
            "case,a.b,c,status,reason\n0,\"{x = 1, y = \"\"z\"\"}\",0.5,complete,\n1,two,1.5,failed,\"no\nway\"\n";
        let table = Table::parse(text).map(|table| (table.keys, table.values.into_values().collect::<Vec<_>>()));
        let texts = |texts: [&str; 2]| texts.map(String::from).to_vec();
        assert_eq!(
            table,
            Some((texts(["a.b", "c"]), vec![texts(["{x = 1, y = \"z\"}", "0.5"]), texts(["two", "1.5"])]))
        );
        assert_eq!(Table::parse("time,force\n0,1\n"), None);
        assert_eq!(Table::parse(""), None);
    }
}
