//! The `[friction]` table as data.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Serialize;

use crate::expression::{Expression, Fault};
use crate::friction::{TEMPERATURE, VARIABLES};
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "law", rename_all = "snake_case")]
pub enum Law {
    /// q = f p tanh(slip_rate / regularisation), Eq. (4).
    CoulombTanh {
        /// m/s, > 0
        regularisation: f64,
    },
    /// q = f p e/elastic_slip, e the elastic part of the slip, at most elastic_slip either way.
    CoulombElasticSlip {
        /// m, > 0
        elastic_slip: f64,
    },
    /// q = f p where a point slips, and up to that where it sticks.
    Coulomb,
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
