//! The `[adhesion]` table as data.

use serde::{Serialize, Serializer};

/// What the surfaces pull each other with across a gap.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Adhesion {
    /// How the pull falls with the gap.
    pub law: AdhesionLaw,
    /// Its integral over the gap, J/m^2, > 0.
    pub work: f64,
    /// m, > 0
    pub range: f64,
    /// What a closed gap bears along the face without pressure.
    pub friction: Bond,
}

/// How the pull falls with the gap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum AdhesionLaw {
    /// (work/range) exp(-g/range)
    Exponential,
    /// (2 work/range) (1 - g/range) up to the range
    Bilinear,
    /// work/range up to about the range
    Dugdale,
}

/// What a closed gap bears along the face without pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bond {
    /// Nothing.
    None,
    /// Pa, > 0
    ShearStrength(f64),
}

/// How no friction in tension is written.
pub(super) const NONE: &str = "none";
/// The key of the other.
pub(super) const SHEAR_STRENGTH: &str = "shear_strength";

impl Serialize for Bond {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::None => serializer.serialize_str(NONE),
            Self::ShearStrength(strength) => serializer.collect_map([(SHEAR_STRENGTH, strength)]),
        }
    }
}
