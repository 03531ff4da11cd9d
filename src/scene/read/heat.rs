//! The `[heat]` table.

use crate::error::Result;
use crate::scene::heat::INSULATED;
use crate::scene::keys::Section;
use crate::scene::{Base, Convection, Heat};

/// Reads it.
pub(super) fn read(section: &Section) -> Result<Heat> {
    section.only_known()?;
    let base = section.number_or_word("base", INSULATED)?.map_or(Base::Insulated, Base::Held);
    Ok(Heat {
        initial: section.number("initial")?,
        base,
        convection: section.optional_section("convection")?.as_ref().map(convection).transpose()?,
        share: section.optional_number("share")?.unwrap_or(1.0),
        arms: section.optional_flag("arms")?.unwrap_or(false),
        coupled: section.optional_flag("coupled")?.unwrap_or(false),
    })
}

fn convection(section: &Section) -> Result<Convection> {
    section.only_known()?;
    Ok(Convection { coefficient: section.number("coefficient")?, temperature: section.number("temperature")? })
}
