//! The `[mount]` table.

use crate::error::Result;
use crate::scene::keys::{Quantity, Section};
use crate::scene::{Mount, MountEnd};

/// Reads it.
pub(super) fn read(section: &Section) -> Result<Mount> {
    section.only(&["normal", "tangential"])?;
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
    const STIFFNESS: Quantity = Quantity { what: "a stiffness in N/m per m, at least 0", accepts: |k| k >= 0.0 };
    const DAMPING: Quantity = Quantity { what: "a damping in N s/m per m, at least 0", accepts: |c| c >= 0.0 };
    const MASS: Quantity = Quantity { what: "a mass in kg per m, at least 0", accepts: |m| m >= 0.0 };
    const LOAD: Quantity = Quantity { what: "a dead load in N/m, at least 0", accepts: |load| load >= 0.0 };

    section.only(if normal { &["stiffness", "damping", "mass", "load"] } else { &["stiffness", "damping", "mass"] })?;
    let number = |key: &str, quantity| Ok(section.optional_number(key, quantity)?.unwrap_or(0.0));
    let load = if normal { section.optional_number("load", LOAD)? } else { None };
    let end = MountEnd {
        stiffness: number("stiffness", STIFFNESS)?,
        damping: number("damping", DAMPING)?,
        mass: number("mass", MASS)?,
        load,
    };
    let holds = [end.stiffness, end.damping, end.mass, load.unwrap_or(0.0)].into_iter().any(|value| value > 0.0);
    match holds {
        true => Ok(end),
        false => {
            Err(section.missing("stiffness", "one above 0, or a damping or a mass: nothing holds the indenter here"))
        }
    }
}
