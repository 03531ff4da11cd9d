//! The `[friction]` table.

use std::collections::BTreeMap;

use toml::Value;

use crate::error::Result;
use crate::scene::keys::{Quantity, Section, number};
use crate::scene::{Coefficient, Friction, Law};

/// Reads it.
pub(super) fn read(section: &Section) -> Result<Friction> {
    const LIMIT: Quantity = Quantity::positive("a positive shear traction in Pa");
    const REGULARISATION: Quantity = Quantity::positive("a positive slip rate in m/s");
    const ELASTIC_SLIP: Quantity = Quantity::positive("a positive length in m");
    const ANY: [&str; 4] = ["law", "coefficient", "shear_limit", "tables"];

    // The law decides which keys there are; where it is absent, perhaps it is misspelt.
    if !section.has("law") {
        section.only(&[&ANY[..], &["regularisation", "elastic_slip"]].concat())?;
    }
    let laws = [
        ("coulomb", None),
        ("coulomb_tanh", Some(("regularisation", REGULARISATION))),
        ("coulomb_elastic_slip", Some(("elastic_slip", ELASTIC_SLIP))),
    ];
    let sharpness = section.choice("law", &laws, &[])?;
    section.only(&ANY.into_iter().chain(sharpness.map(|(key, _)| key)).collect::<Vec<_>>())?;
    let law = match sharpness {
        None => Law::Coulomb,
        Some((key @ "elastic_slip", what)) => Law::CoulombElasticSlip { elastic_slip: section.number(key, what)? },
        Some((key, what)) => Law::CoulombTanh { regularisation: section.number(key, what)? },
    };
    let shear_limit = section.optional_number("shear_limit", LIMIT)?;
    let friction = Friction { law, coefficient: coefficient(section)?, shear_limit, tables: tables(section)? };
    if let Coefficient::Formula(formula) = &friction.coefficient {
        friction
            .expression(formula)
            .map_err(|fault| section.error("coefficient", format!("is not a formula: {formula:?}, {fault}")))?;
    }
    Ok(friction)
}

fn coefficient(section: &Section) -> Result<Coefficient> {
    const NUMBER: Quantity = Quantity { what: "a friction coefficient, at least 0", accepts: |f| f >= 0.0 };

    match section.optional_text("coefficient", "a friction coefficient, at least 0, or a formula of v, p and s") {
        Ok(Some(formula)) => Ok(Coefficient::Formula(formula)),
        _ => section.number("coefficient", NUMBER).map(Coefficient::Number),
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
