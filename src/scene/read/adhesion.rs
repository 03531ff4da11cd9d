//! The `[adhesion]` table.

use crate::error::Result;
use crate::scene::adhesion::{NONE, SHEAR_STRENGTH};
use crate::scene::keys::Section;
use crate::scene::keys::tables::ADHESION_LAWS;
use crate::scene::{Adhesion, Bond};

/// Reads it.
pub(super) fn read(section: &Section) -> Result<Adhesion> {
    section.only_known()?;
    Ok(Adhesion {
        law: section.choice("law", &ADHESION_LAWS, &[])?,
        work: section.number("work")?,
        range: section.number("range")?,
        friction: match section.word_or_section("friction", NONE)? {
            None => Bond::None,
            Some(bond) => {
                bond.only_known()?;
                Bond::ShearStrength(bond.number(SHEAR_STRENGTH)?)
            }
        },
    })
}
