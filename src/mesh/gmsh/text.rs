//! A text as words, with the number of the line each stands on.

use std::str::FromStr;

/// Reads word by word. Errors are texts that begin with the line.
pub(super) struct Words<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    /// What is left of the present line.
    rest: &'a str,
    /// Its number, from 1.
    line: usize,
}

impl<'a> Words<'a> {
    pub fn new(text: &'a str) -> Self {
        Self { lines: text.lines().enumerate(), rest: "", line: 0 }
    }

    /// The next word, if any is left.
    pub fn word(&mut self) -> Option<&'a str> {
        loop {
            let trimmed = self.rest.trim_start();
            if trimmed.is_empty() {
                self.advance()?;
                continue;
            }
            let end = trimmed.find(char::is_whitespace).unwrap_or(trimmed.len());
            self.rest = &trimmed[end..];
            return Some(&trimmed[..end]);
        }
    }

    /// What is left of the present line.
    pub fn rest_of_line(&mut self) -> &'a str {
        std::mem::take(&mut self.rest).trim()
    }

    /// A number.
    pub fn number<T: FromStr>(&mut self, what: &str) -> Result<T, String> {
        let Some(word) = self.word() else { return Err(self.error(format!("the file ends where {what} should be"))) };
        word.parse().map_err(|_| self.error(format!("must be {what}, got {:?}", short(word))))
    }

    /// Passes over numbers.
    pub fn skip(&mut self, count: usize) -> Result<(), String> {
        (0..count).try_for_each(|_| self.number::<f64>("a number").map(|_| ()))
    }

    /// Passes over everything up to the line `$End...` of a section.
    pub fn skip_section(&mut self, section: &str) -> Result<(), String> {
        let end = format!("$End{section}");
        let start = self.line;
        self.rest = "";
        while self.advance().is_some() {
            if std::mem::take(&mut self.rest).trim() == end {
                return Ok(());
            }
        }
        Err(format!("line {start}: ${section} has no {end}"))
    }

    /// Demands the end of a section.
    pub fn end_section(&mut self, section: &str) -> Result<(), String> {
        let end = format!("$End{section}");
        match self.word() {
            Some(word) if word == end => Ok(()),
            Some(word) => Err(self.error(format!("must be {end}, got {:?}", short(word)))),
            None => Err(self.error(format!("the file ends where {end} should be"))),
        }
    }

    /// An error on the present line.
    pub fn error(&self, reason: impl std::fmt::Display) -> String {
        format!("line {}: {reason}", self.line)
    }

    fn advance(&mut self) -> Option<()> {
        let (index, line) = self.lines.next()?;
        (self.line, self.rest) = (index + 1, line);
        Some(())
    }
}

/// A word for a message.
fn short(word: &str) -> String {
    word.chars().take(20).collect()
}
