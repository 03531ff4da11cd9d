//! A scene from its file: the text is parsed, what it names is included, overrides act, then it is read.

use std::path::Path;

use toml::Table;

use super::document::parse;
use super::include::{Load, include, open};
use super::{Scene, Source, overrides};
use crate::error::Result;

/// Reads and checks a scene on one process.
///
/// `text` is the content of `source.file`; of other files only those of materials are opened. The first thing that is
/// wrong is the error.
pub fn read(text: &str, source: &Source) -> Result<Scene> {
    read_with(text, source, &open)
}

/// Reads and checks a scene whose other files are come by with `load`, which all ranks call in the same order.
///
/// Overrides that may name a file act before it is read, all others after, on what it says.
pub fn read_with(text: &str, source: &Source, load: Load) -> Result<Scene> {
    let Source { file, overrides: typed } = source;
    let mut table = parse(text, file)?;
    let [files, others] = overrides::around_files(typed);
    let blame = |error| overrides::blame(error, typed);
    overrides::apply(&mut table, &files, file)?;
    include(&mut table, file, load).map_err(blame)?;
    overrides::apply(&mut table, &others, file)?;
    super::read::scene(&table, file).map_err(blame)
}

/// Reads and checks a scene whose TOML has been parsed, and perhaps changed by [`super::set`]. What it still takes from
/// other files is read from there.
pub fn from_table(table: &Table, file: &Path) -> Result<Scene> {
    let mut table = table.clone();
    include(&mut table, file, &open)?;
    super::read::scene(&table, file)
}
