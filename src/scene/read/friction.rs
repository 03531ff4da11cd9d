//! The `[friction]` table.

use std::collections::BTreeMap;

use toml::Value;

use crate::error::Result;
use crate::friction::KINDS;
use crate::scene::keys::{Section, number};
use crate::scene::{Coefficient, Friction, Law};

/// Reads it.
pub(super) fn read(section: &Section) -> Result<Friction> {
    section.only_known()?;
    let kind = section.choice("law", &KINDS.map(|kind| (kind.name, kind)), &[])?;
    let softness = kind.softness.as_ref().map(|softness| section.number(softness.key)).transpose()?;
    let law = Law { kind, softness: softness.unwrap_or(0.0) };
    let shear_limit = section.optional_number("shear_limit")?;
    let friction = Friction {
        law,
        coefficient: coefficient(section)?,
        shear_limit,
        tables: tables(section)?,
        checksums: checksums(section)?,
    };
    if let Coefficient::Formula(formula) = &friction.coefficient {
        friction
            .expression(formula)
            .map_err(|fault| section.error("coefficient", format!("is not a formula: {formula:?}, {fault}")))?;
    }
    Ok(friction)
}

fn coefficient(section: &Section) -> Result<Coefficient> {
    match section.optional_text("coefficient") {
        Ok(Some(formula)) => Ok(Coefficient::Formula(formula)),
        _ => section.number("coefficient").map(Coefficient::Number),
    }
}

/// The tables that the formula names, as they stand in a resolved scene.
fn tables(section: &Section) -> Result<BTreeMap<String, Vec<[f64; 2]>>> {
    let Some(tables) = section.optional_section("tables")? else { return Ok(BTreeMap::new()) };
    let point = |value: &Value| match value.as_array()?.as_slice() {
        [x, y] => Some([number(x)?, number(y)?]),
        _ => None,
    };
    let read = |(name, value): (&String, &Value)| {
        let points = value.as_array().and_then(|points| points.iter().map(point).collect::<Option<Vec<_>>>());
        match points {
            Some(points) => Ok((name.clone(), points)),
            None => Err(tables.must_be(name, "an array of points [x, y]", value)),
        }
    };
    tables.table().iter().map(read).collect()
}

/// The checksums of the files that they were read from, where that was for this scene.
fn checksums(section: &Section) -> Result<Vec<String>> {
    let sums = section.values("checksums")?.iter().enumerate();
    let text = |(index, value): (usize, &Value)| match value.as_str() {
        Some(sum) => Ok(sum.to_owned()),
        None => Err(section.must_be(&format!("checksums.{index}"), "the checksum of a file, a text", value)),
    };
    sums.map(text).collect()
}
