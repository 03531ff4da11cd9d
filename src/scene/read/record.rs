//! `motion`: a measured history that drives a phase, in a file or, as a resolved scene has it, in its columns.

use toml::{Table, Value};

use crate::checksum;
use crate::error::Result;
use crate::scene::Record;
use crate::scene::keys::{Section, advice};
use crate::table::{self, Quantity};

/// The columns, in the order of messages; `sliding` is `sliding_x`.
const COLUMNS: [(&str, Quantity); 6] = [
    ("time", Quantity::Time),
    ("approach", Quantity::Length),
    ("normal_force", Quantity::Other),
    ("sliding", Quantity::Length),
    ("sliding_x", Quantity::Length),
    ("sliding_y", Quantity::Length),
];
const TITLES: &str = "name the columns in a header line: time, and any of approach, normal_force and sliding (in space sliding_x, \
                      sliding_y)";

/// The table that a resolved scene has in the place of the name of a file with this content.
///
/// # Errors
/// What is wrong with it.
pub(in crate::scene) fn table(name: &str, text: &str) -> std::result::Result<Table, String> {
    let read = table::Table::read(text.as_bytes()).map_err(|fault| fault.to_string())?;
    let mut found = Table::new();
    found.insert("file".into(), Value::String(name.to_owned()));
    found.insert("checksum".into(), Value::String(checksum::text(text.as_bytes())));
    let names: Vec<&str> =
        (0..read.width()).map(|column| column_called(&read, column)).collect::<std::result::Result<_, _>>()?;
    let columns = read.columns(&(0..read.width()).collect::<Vec<_>>()).map_err(|fault| fault.to_string())?;
    for (column, name) in names.into_iter().enumerate() {
        let si = |value: f64| read.unit(column).map_or(value, |unit| unit.to_si(value));
        let values = columns.rows.iter().map(|row| Value::Float(si(row.values[column]))).collect();
        let key = if name == "sliding" { "sliding_x" } else { name };
        if found.insert(key.into(), Value::Array(values)).is_some() {
            return Err(format!("has two columns {key}"));
        }
    }
    Ok(found)
}

/// The name of a column, counted from 0, which must be one of those there are, in a unit of what it is.
fn column_called(read: &table::Table, column: usize) -> std::result::Result<&'static str, String> {
    let title = read.title(column);
    let known: Vec<&str> = COLUMNS.iter().map(|(name, _)| *name).collect();
    let found = COLUMNS.iter().find(|(name, _)| title.eq_ignore_ascii_case(name));
    match (found, read.unit(column)) {
        (None, _) if title.is_empty() => Err(format!("column {} has no name; {TITLES}", column + 1)),
        (None, _) => {
            Err(format!("unknown column {}; {}", table::quoted(title), advice(title, &known, "the columns are")))
        }
        (Some((name, what)), Some(unit)) if unit.quantity != *what => {
            Err(format!("column {name} cannot be in {}", unit.name))
        }
        (Some((name, _)), _) => Ok(name),
    }
}

/// Reads the table.
pub(super) fn read(phase: &Section, section: &Section) -> Result<Record> {
    section.only_known()?;
    let column = |key: &str| section.numbers(key);
    let record = Record {
        file: section.optional_text("file")?.unwrap_or_default(),
        checksum: section.optional_text("checksum")?,
        time: column("time")?,
        approach: column("approach")?,
        normal_force: column("normal_force")?,
        sliding_x: column("sliding_x")?,
        sliding_y: column("sliding_y")?,
    };
    match fault(&record) {
        None => Ok(record),
        Some(fault) => Err(phase.error("motion", format!("{:?}: {fault}", record.file))),
    }
}

/// What is wrong with a record.
fn fault(record: &Record) -> Option<String> {
    let Record { time, approach, normal_force, sliding_x, sliding_y, .. } = record;
    let columns = [approach, normal_force, sliding_x, sliding_y];
    if time.is_empty() {
        return Some(format!("has no column time; {TITLES}"));
    }
    if columns.iter().all(|column| column.is_empty()) {
        return Some(format!("drives nothing; {TITLES}"));
    }
    if !approach.is_empty() && !normal_force.is_empty() {
        return Some("has both approach and normal_force; one of them follows from the other: leave it out".into());
    }
    if columns.iter().any(|column| !column.is_empty() && column.len() != time.len()) {
        return Some("has columns of several lengths".into());
    }
    if let Some(pair) = time.windows(2).find(|pair| pair[1] <= pair[0]) {
        return Some(format!("must have times that ascend: {:?} s is followed by {:?} s", pair[0], pair[1]));
    }
    if time[0] < 0.0 || record.end() <= 0.0 {
        let wrong = if time[0] < 0.0 { time[0] } else { record.end() };
        return Some(format!("must have times since the phase began, the last of them above 0 s, got {wrong:?} s"));
    }
    let tension = normal_force.iter().zip(time).find(|(force, _)| **force < 0.0);
    tension.map(|(force, time)| format!("must have forces that press, at least 0 N/m, got {force:?} at {time:?} s"))
}

/// Where the phase says the same as its record.
pub(super) fn refuse_beside(section: &Section) -> Result<()> {
    const SAID: [&str; 5] = ["velocity", "distance", "tangential", "approach", "normal_force"];
    match SAID.into_iter().find(|key| section.has(key)) {
        Some(key) => {
            Err(section.error(key, format!("cannot stand beside motion, whose file says it; give {key} or motion")))
        }
        None => Ok(()),
    }
}

/// How long the phase takes: as long as the record unless it says a shorter time, s.
pub(super) fn duration(section: &Section, record: &Record) -> Result<f64> {
    let end = record.end();
    match section.optional_number("duration")? {
        Some(longer) if longer > end * (1.0 + 1e-9) => {
            Err(section
                .error("duration", format!("must be at most the {end:?} s of {:?}, got {longer:?}", record.file)))
        }
        Some(duration) => Ok(duration),
        None => Ok(end),
    }
}
