//! Measured moduli out of a text: two columns (time, modulus) or three (frequency, storage, loss).

use super::{Residuals, Samples};

/// A line that cannot be used, counted from 1, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct LineError {
    /// The line, counted from 1.
    pub line: usize,
    /// What is wrong and what would be accepted.
    pub reason: String,
}

/// Samples and the line that each abscissa stands on.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The data.
    pub samples: Samples,
    /// The line of each point, counted from 1.
    pub lines: Vec<usize>,
}

/// Reads columns separated by commas, semicolons, tabs or blanks. `#` starts a comment; empty lines are skipped; the
/// first line may be a header.
pub fn parse(text: &str, residuals: Residuals) -> Result<Table, LineError> {
    let mut rows: Vec<(usize, Vec<f64>)> = Vec::new();
    let mut first = true;
    // Excel starts its UTF-8 files with a byte-order mark.
    for (index, raw) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let content = raw.split('#').next().unwrap_or_default().trim();
        if content.is_empty() {
            continue;
        }
        let line = index + 1;
        let fields = fields(content);
        let header = std::mem::take(&mut first) && is_header(&fields);
        if header {
            continue;
        }
        let numbers = numbers(&fields).map_err(|reason| LineError { line, reason })?;
        check(&numbers, rows.last().map(|row| (row.0, row.1.as_slice())), residuals)
            .map_err(|reason| LineError { line, reason })?;
        rows.push((line, numbers));
    }
    let Some((_, example)) = rows.first() else {
        let line = text.lines().count().max(1);
        return Err(LineError { line, reason: "the file ends here without any data".into() });
    };
    let column = |i: usize| rows.iter().map(|(_, row)| row[i]).collect::<Vec<f64>>();
    let samples = match example.len() {
        2 => Samples::relaxation(column(0), column(1)),
        _ => Samples::dynamic(column(0), column(1), column(2)),
    };
    Ok(Table { samples, lines: rows.iter().map(|row| row.0).collect() })
}

/// Words and not one number. A field without a letter is a number gone wrong, such as one with a decimal comma.
fn is_header(fields: &[&str]) -> bool {
    fields.iter().all(|field| field.parse::<f64>().is_err())
        && fields.iter().any(|field| field.contains(char::is_alphabetic))
}

/// The columns of a line; one kind of separator per line.
fn fields(content: &str) -> Vec<&str> {
    match [';', ','].into_iter().find(|separator| content.contains(*separator)) {
        Some(separator) => content.split(separator).map(str::trim).collect(),
        None => content.split_whitespace().collect(),
    }
}

fn numbers(fields: &[&str]) -> Result<Vec<f64>, String> {
    if !(2..=3).contains(&fields.len()) {
        return Err(format!(
            "{} column{}; two (time, modulus) or three (frequency, storage, loss) are read",
            fields.len(),
            if fields.len() == 1 { "" } else { "s" }
        ));
    }
    fields.iter().map(|field| number(field)).collect()
}

fn number(field: &str) -> Result<f64, String> {
    match field.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("`{field}` is not a finite number")),
        Err(_) if field.is_empty() => Err("an empty column".into()),
        Err(_) if field.contains(',') => {
            Err(format!("`{field}` is not a number; the decimal mark is a point, as in 0.5"))
        }
        Err(_) => Err(format!("`{field}` is not a number")),
    }
}

/// One row, after the row `before` it.
fn check(row: &[f64], before: Option<(usize, &[f64])>, residuals: Residuals) -> Result<(), String> {
    let dynamic = row.len() == 3;
    let (name, unit) = if dynamic { ("frequency", "") } else { ("time", " s") };
    if let Some((line, last)) = before {
        if last.len() != row.len() {
            return Err(format!("{} columns, but line {line} has {}", row.len(), last.len()));
        }
        if row[0] <= last[0] {
            let how = if row[0] == last[0] { "repeats" } else { "comes after" };
            return Err(format!(
                "the {name} {}{unit} {how} {}{unit} of line {line}; each must be larger than the one before",
                row[0], last[0]
            ));
        }
    }
    if row[0] < 0.0 || dynamic && row[0] == 0.0 {
        return Err(format!("a {name} of {}{unit}; it must {}", row[0], if dynamic { "be > 0" } else { "be >= 0" }));
    }
    let names: &[&str] = if dynamic { &["storage modulus", "loss modulus"] } else { &["relaxation modulus"] };
    for (i, (value, name)) in row[1..].iter().zip(names).enumerate() {
        // A perfectly elastic point has no loss; its logarithm has no value.
        let may_vanish = i == 1 && residuals == Residuals::Linear;
        if *value < 0.0 || *value == 0.0 && !may_vanish {
            return Err(format!("a {name} of {value} Pa; it must be {} 0", if may_vanish { ">=" } else { ">" }));
        }
    }
    Ok(())
}
