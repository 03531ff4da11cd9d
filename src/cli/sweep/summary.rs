//! `summary.csv`: one row per case, with its varied values and final figures.

use std::path::Path;

use super::folder::{Folder, State, replace};
use crate::error::Result;
use crate::output::{ours, reader::Results};
use crate::scene::sweep::Sweep;

/// The columns of the history of which the last value is given, with `energy/` ones where a run has them.
const FIGURES: [&str; 18] = [
    "time",
    "approach",
    "sliding",
    "normal_force",
    "tangential_force",
    "hysteretic_force",
    "contact_fraction",
    "stick_fraction",
    "max_penetration",
    "stuck_slip",
    "newton_iterations",
    "energy/external_work",
    "energy/stored",
    "energy/viscoelastic_dissipation",
    "energy/friction_dissipation",
    "energy/penalty",
    "energy/imbalance",
    // Empty where nothing wears.
    "worn_volume",
];

const FILE: &str = "summary.csv";
/// What stands before the keys of the sweep and after them.
const BEFORE: &str = "case";
const AFTER: [&str; 4] = ["status", "exit_code", "reason", "wall_seconds"];

/// Refuses a directory with a table of this name that no sweep wrote.
pub fn may_write(directory: &Path) -> Result<()> {
    let ours = |header: &str| header.starts_with(BEFORE) && header.contains(&AFTER.join(","));
    ours::make_way_for_table(&directory.join(FILE), ours)
}

/// Writes the file anew from what is in the directory.
pub fn write(sweep: &Sweep, folder: &Folder) -> Result<()> {
    let before = [BEFORE].into_iter().chain(sweep.keys.iter().map(String::as_str));
    let after = AFTER.into_iter().chain(["warnings"]).chain(FIGURES);
    let mut text = line(before.chain(after).map(str::to_owned));
    for (index, case) in sweep.cases.iter().enumerate() {
        let state = folder.state(sweep, index);
        let record = folder.record(index).unwrap_or_default();
        let (exit, reason) = match &state {
            State::Failed(record) => (record.exit.to_string(), record.reason.clone()),
            State::Complete => ("0".to_owned(), String::new()),
            _ => (String::new(), String::new()),
        };
        let results = match &state {
            State::Missing => None,
            _ => Results::open(&folder.results(index)).ok(),
        };
        let figure = |name: &str| {
            let values = results.as_ref().and_then(|results| results.history(name).ok());
            values.and_then(|values| values.last().copied()).map_or_else(String::new, |value| format!("{value:?}"))
        };
        let wall = match &state {
            State::Missing => String::new(),
            _ => format!("{:.3}", record.wall_seconds),
        };
        let warnings = results.as_ref().and_then(|results| results.warnings().ok());
        let warnings = warnings.map_or_else(String::new, |warnings| warnings.len().to_string());
        let cells = std::iter::once(index.to_string()).chain(case.values.iter().cloned());
        let cells = cells.chain([state.word().to_owned(), exit, reason, wall, warnings]).chain(FIGURES.map(figure));
        text.push_str(&line(cells));
    }
    replace(&folder.path().join(FILE), &text)
}

/// A line of a table separated by commas (RFC 4180).
pub fn line(cells: impl Iterator<Item = String>) -> String {
    let quoted = |cell: String| match cell.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", cell.replace('"', "\"\"")),
        false => cell,
    };
    cells.map(quoted).collect::<Vec<_>>().join(",") + "\n"
}
