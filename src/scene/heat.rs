//! The `[heat]` table as data.

use serde::{Serialize, Serializer};

/// The temperature of the body: what is dissipated heats it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Heat {
    /// Of all of it at t = 0, K, at least 0.
    pub initial: f64,
    /// What the base does.
    pub base: Base,
    /// To the air beside the contact; none = insulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub convection: Option<Convection>,
    /// Of the heat of friction that enters the body, from 0 to 1.
    pub share: f64,
    /// Whether what the arms dissipate heats, too.
    pub arms: bool,
    /// Whether the temperature of a cell shifts the times of its arms.
    pub coupled: bool,
}

/// The lower face of a layer; of a mesh, what is fixed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Base {
    /// At a temperature, K, at least 0.
    Held(f64),
    /// No heat passes.
    Insulated,
}

/// How a base without a temperature is written.
pub(super) const INSULATED: &str = "insulated";

impl Base {
    /// The temperature that it is held at, K.
    pub fn temperature(self) -> Option<f64> {
        match self {
            Self::Held(temperature) => Some(temperature),
            Self::Insulated => None,
        }
    }
}

impl Serialize for Base {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Held(temperature) => serializer.serialize_f64(*temperature),
            Self::Insulated => serializer.serialize_str(INSULATED),
        }
    }
}

/// Newton's law of cooling.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Convection {
    /// W/m^2/K, at least 0.
    pub coefficient: f64,
    /// Of the air, K, at least 0.
    pub temperature: f64,
}
