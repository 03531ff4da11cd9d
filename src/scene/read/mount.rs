//! The `[mount]` table.

use crate::error::Result;
use crate::scene::keys::Section;
use crate::scene::{Mount, MountEnd};

/// Reads it.
pub(super) fn read(section: &Section) -> Result<Mount> {
    section.only_known()?;
    let normal = section.optional_section("normal")?.map(|normal| end(&normal, true)).transpose()?;
    let tangential = section.optional_section("tangential")?.map(|tangential| end(&tangential, false)).transpose()?;
    match (normal, tangential) {
        (None, None) => {
            Err(section.missing("normal", "normal or tangential, such as { stiffness = 1e3 }, or leave [mount] out"))
        }
        _ => Ok(Mount { normal, tangential }),
    }
}

fn end(section: &Section, normal: bool) -> Result<MountEnd> {
    section.only_known()?;
    let number = |key: &str| Ok(section.optional_number(key)?.unwrap_or(0.0));
    let load = if normal { section.optional_number("load")? } else { None };
    let end = MountEnd { stiffness: number("stiffness")?, damping: number("damping")?, mass: number("mass")?, load };
    let holds = [end.stiffness, end.damping, end.mass, load.unwrap_or(0.0)].into_iter().any(|value| value > 0.0);
    match holds {
        true => Ok(end),
        false => {
            Err(section.missing("stiffness", "one above 0, or a damping or a mass: nothing holds the indenter here"))
        }
    }
}
