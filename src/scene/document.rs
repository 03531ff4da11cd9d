//! The text of a scene, or of a file that it names, as TOML.

use std::path::Path;

use toml::Table;

use crate::error::{Error, Result};

/// The TOML of a file, not yet looked into.
pub fn parse(text: &str, file: &Path) -> Result<Table> {
    text.parse::<Table>().map_err(|error| {
        let start = error.span().map_or(0, |span| span.start);
        let reason = match table_of_several(text, start) {
            Some(name) => {
                format!("each {name} must be written [[{name}]], in double brackets, where there are several")
            }
            None => error.message().replace('\n', "; "),
        };
        let before = text.get(..start).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        Error::scene(file, "", format!("line {line}, column {column}: not TOML: {reason}"))
    })
}

/// The name of a table that a scene can have several of, if the line of the byte at `start` begins one and another line
/// does, too, in single brackets.
fn table_of_several(text: &str, start: usize) -> Option<&'static str> {
    let bare = |line: &str| line.split('#').next().unwrap_or_default().replace([' ', '\t', '\r'], "");
    let here = bare(text.get(..start)?.rsplit('\n').next()?) + &bare(text.get(start..)?.split('\n').next()?);
    ["phase", "material"].into_iter().find(|name| {
        let (one, several) = (format!("[{name}]"), format!("[[{name}]]"));
        let begin = text.lines().map(bare).filter(|line| *line == one || *line == several).count();
        (here == one || here == several) && begin > 1
    })
}
