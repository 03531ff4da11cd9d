//! The `[wear]` table as data.

use serde::Serialize;

/// How the contact wears.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Wear {
    /// What wears.
    pub of: Wearing,
    /// By which law.
    pub law: WearLaw,
    /// 1/Pa, > 0.
    pub coefficient: f64,
}

/// What wears.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Wearing {
    /// The face of the body.
    Body,
    /// The profile.
    Indenter,
}

/// What the rate of wear goes with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum WearLaw {
    /// coefficient p |w|
    Archard,
    /// coefficient q.w
    Energy,
}
