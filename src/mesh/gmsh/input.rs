//! The bytes of a file as words and numbers, and where in the file each stands.
//!
//! Headers, names of sections and physical names are text in every file. What else there is stands as text too, or in
//! binary files as 4-byte integers, 8-byte sizes and 8-byte reals (Gmsh reference manual, "MSH file format").

use std::str::FromStr;

/// How numbers stand in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    Text,
    LittleEndian,
    BigEndian,
}

/// Reads a file from its beginning. Errors are texts that begin with the line, or the byte of a binary file.
pub(super) struct Input<'a> {
    bytes: &'a [u8],
    /// Where reading goes on.
    at: usize,
    /// The line of the last word, from 1.
    line: usize,
    form: Form,
}

impl<'a> Input<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, line: 1, form: Form::Text }
    }

    /// What follows, but for text, is in this form.
    pub fn set_form(&mut self, form: Form) {
        self.form = form;
    }

    /// Whether words tell one number from the next.
    pub fn is_text(&self) -> bool {
        self.form == Form::Text
    }

    /// The next word of text, if any is left.
    pub fn word(&mut self) -> Option<&'a [u8]> {
        let rest = &self.bytes[self.at..];
        let (blanks, rest) = rest.split_at(rest.iter().position(|byte| !byte.is_ascii_whitespace())?);
        let word = &rest[..rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len())];
        self.line += blanks.iter().filter(|&&byte| byte == b'\n').count();
        self.at += blanks.len() + word.len();
        Some(word)
    }

    /// What is left of the present line.
    pub fn rest_of_line(&mut self) -> String {
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        self.at += end;
        String::from_utf8_lossy(&rest[..end]).trim().to_owned()
    }

    /// A number that stands as text in every file.
    pub fn written<T: FromStr>(&mut self, what: &str) -> Result<T, String> {
        let Some(word) = self.word() else { return Err(self.ends(what)) };
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or_else(|| self.error(format!("must be {what}, got {:?}", short(word))))
    }

    /// An integer, which binary files give 4 bytes.
    pub fn int(&mut self, what: &str) -> Result<i64, String> {
        match self.form {
            Form::Text => self.written(what),
            Form::LittleEndian => self.take(what).map(|bytes| i32::from_le_bytes(bytes).into()),
            Form::BigEndian => self.take(what).map(|bytes| i32::from_be_bytes(bytes).into()),
        }
    }

    /// A size or a tag, which binary files give 8 bytes.
    pub fn size(&mut self, what: &str) -> Result<u64, String> {
        match self.form {
            Form::Text => self.written(what),
            Form::LittleEndian => self.take(what).map(u64::from_le_bytes),
            Form::BigEndian => self.take(what).map(u64::from_be_bytes),
        }
    }

    /// A real number.
    pub fn real(&mut self, what: &str) -> Result<f64, String> {
        match self.form {
            Form::Text => self.written(what),
            Form::LittleEndian => self.take(what).map(f64::from_le_bytes),
            Form::BigEndian => self.take(what).map(f64::from_be_bytes),
        }
    }

    /// A place in space, which must be finite, m.
    pub fn place(&mut self) -> Result<[f64; 3], String> {
        let mut place = [0.0_f64; 3];
        for coordinate in &mut place {
            *coordinate = self.real("a coordinate")?;
            if !coordinate.is_finite() {
                return Err(self.error("a coordinate must be finite"));
            }
        }
        Ok(place)
    }

    /// Passes over integers.
    pub fn skip_ints(&mut self, count: u64) -> Result<(), String> {
        (0..count).try_for_each(|_| self.int("a number").map(|_| ()))
    }

    /// Passes over sizes.
    pub fn skip_sizes(&mut self, count: u64) -> Result<(), String> {
        (0..count).try_for_each(|_| self.size("a number").map(|_| ()))
    }

    /// Passes over real numbers.
    pub fn skip_reals(&mut self, count: u64) -> Result<(), String> {
        (0..count).try_for_each(|_| self.real("a number").map(|_| ()))
    }

    /// Passes over everything up to the `$End...` of a section, which begins a line but for a file of bytes.
    pub fn skip_section(&mut self, section: &str) -> Result<(), String> {
        let end = format!("$End{section}");
        let (start, rest) = (self.line, &self.bytes[self.at..]);
        let Some(length) = rest.windows(end.len()).position(|window| window == end.as_bytes()) else {
            return Err(format!("line {start}: ${section} has no {end}"));
        };
        self.line += rest[..length].iter().filter(|&&byte| byte == b'\n').count();
        self.at += length + end.len();
        Ok(())
    }

    /// Demands the end of a section.
    pub fn end_section(&mut self, section: &str) -> Result<(), String> {
        let end = format!("$End{section}");
        match self.word() {
            Some(word) if word == end.as_bytes() => Ok(()),
            Some(word) => Err(self.error(format!("must be {end}, got {:?}", short(word)))),
            None => Err(self.ends(&end)),
        }
    }

    /// An error at the present place.
    pub fn error(&self, reason: impl std::fmt::Display) -> String {
        match self.form {
            Form::Text => format!("line {}: {reason}", self.line),
            _ => format!("byte {}: {reason}", self.at),
        }
    }

    /// The bytes of a number.
    fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N], String> {
        let Some(bytes) = self.bytes[self.at..].first_chunk() else { return Err(self.ends(what)) };
        self.at += N;
        Ok(*bytes)
    }

    /// Passes over the end of the line after which bytes begin.
    pub fn next_line(&mut self) {
        self.rest_of_line();
        self.at = (self.at + 1).min(self.bytes.len());
        self.line += 1;
    }

    fn ends(&self, what: &str) -> String {
        self.error(format!("the file ends where {what} should be"))
    }
}

/// A word for a message.
pub(super) fn short(word: &[u8]) -> String {
    String::from_utf8_lossy(word).chars().take(20).collect()
}
