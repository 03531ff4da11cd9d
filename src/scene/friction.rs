//! The `[friction]` table as data.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::expression::{Expression, Fault};
use crate::friction::{KINDS, Kind, Softness, TEMPERATURE, VARIABLES};
use crate::table::Curve;

/// The friction law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Friction {
    /// How it turns from stick to slip.
    #[serde(flatten)]
    pub law: Law,
    /// f in |q| <= f p.
    pub coefficient: Coefficient,
    /// Which |q| does not exceed, Pa, > 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shear_limit: Option<f64>,
    /// The files that the coefficient names, as points (x, y).
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub tables: BTreeMap<String, Vec<[f64; 2]>>,
    /// The checksums of their bytes, of those that were read for this scene, which then depends on them.
    #[serde(skip)]
    pub checksums: Vec<String>,
}

/// How friction turns from stick to slip.
#[derive(Debug, Clone, Copy)]
pub struct Law {
    /// Which law.
    pub kind: &'static Kind,
    /// Its softness, > 0; of an exact law 0.
    pub softness: f64,
}

/// The coefficient of friction.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Coefficient {
    /// At least 0.
    Number(f64),
    /// Of v, m/s, p, Pa, s, m, and T, K.
    Formula(String),
}

impl Law {
    /// q = f p where a point slips, and up to that where it sticks.
    pub fn exact() -> Self {
        Self { kind: KINDS[0], softness: 0.0 }
    }

    /// q = f p tanh(slip_rate / regularisation), Eq. (4), > 0, m/s.
    pub fn tanh(regularisation: f64) -> Self {
        Self { kind: KINDS[1], softness: regularisation }
    }

    /// q = f p e/elastic_slip, e the elastic part of the slip, at most elastic_slip (> 0, m) either way.
    pub fn elastic_slip(elastic_slip: f64) -> Self {
        Self { kind: KINDS[2], softness: elastic_slip }
    }

    /// Whether what sticks does not move.
    pub fn is_exact(&self) -> bool {
        self.kind.softness.is_none()
    }

    /// The slip rate that it is softened by, m/s; none where it is not by a rate.
    pub fn rate(&self) -> Option<f64> {
        self.kind.softness.as_ref().filter(|softness| softness.is_rate).map(|_| self.softness)
    }

    /// The slip that it is softened by, m; none where it is not by a slip.
    pub fn slip(&self) -> Option<f64> {
        self.kind.softness.as_ref().filter(|softness| !softness.is_rate).map(|_| self.softness)
    }
}

impl PartialEq for Law {
    fn eq(&self, other: &Self) -> bool {
        self.kind.name == other.kind.name && self.softness == other.softness
    }
}

/// As the keys of the table.
impl Serialize for Law {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("law", self.kind.name)?;
        if let Some(Softness { key, .. }) = self.kind.softness {
            map.serialize_entry(key, &self.softness)?;
        }
        map.end()
    }
}

impl Friction {
    /// With a coefficient that is a number, and no limit.
    pub fn constant(law: Law, coefficient: f64) -> Self {
        Self {
            law,
            coefficient: Coefficient::Number(coefficient),
            shear_limit: None,
            tables: BTreeMap::new(),
            checksums: Vec::new(),
        }
    }

    /// The coefficient, where it is a number and says all.
    pub fn coefficient(&self) -> Option<f64> {
        match (&self.coefficient, self.shear_limit) {
            (Coefficient::Number(coefficient), None) => Some(*coefficient),
            _ => None,
        }
    }

    /// Whether there is none in fact.
    pub fn is_none(&self) -> bool {
        self.coefficient == Coefficient::Number(0.0)
    }

    /// Whether the coefficient is a formula of the temperature.
    pub fn knows_temperature(&self) -> bool {
        let Coefficient::Formula(formula) = &self.coefficient else { return false };
        self.expression(formula).is_ok_and(|expression| expression.has(TEMPERATURE))
    }

    /// The expression of a coefficient, with its tables.
    ///
    /// # Errors
    /// What is wrong with the formula, and where.
    pub fn expression(&self, formula: &str) -> Result<Expression, Fault> {
        let table = |name: &str| match self.tables.get(name) {
            Some(points) => Curve::new(points.clone()).map(Arc::new).map_err(|reason| format!("{name} {reason}")),
            None => Err(format!("{name:?} is not among friction.tables")),
        };
        Expression::with_tables(formula, &VARIABLES, &table)
    }
}

/// The files that a formula of the coefficient names.
pub(super) fn tables_in(formula: &str) -> Vec<String> {
    let names = std::cell::RefCell::new(Vec::new());
    let note = |name: &str| {
        names.borrow_mut().push(name.to_owned());
        Curve::new(vec![[0.0; 2]]).map(Arc::new)
    };
    // What is wrong with it is said where the formula is read.
    let _ = Expression::with_tables(formula, &VARIABLES, &note);
    names.into_inner()
}
