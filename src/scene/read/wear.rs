//! The `[wear]` table.

use crate::error::Result;
use crate::scene::Wear;
use crate::scene::keys::Section;
use crate::scene::keys::tables::{WEAR_LAWS, WEARING};

/// Reads it.
pub(super) fn read(section: &Section) -> Result<Wear> {
    section.only_known()?;
    Ok(Wear {
        of: section.choice("of", &WEARING, &[])?,
        law: section.choice("law", &WEAR_LAWS, &[])?,
        coefficient: section.number("coefficient")?,
    })
}
