//! The `[mount]` table as data.

use serde::Serialize;

/// What is between the indenter and what moves it; at least one of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Mount {
    /// Along the approach, which moves its far end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<MountEnd>,
    /// Along the sliding, which moves its far end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tangential: Option<MountEnd>,
}

/// A spring and a dashpot side by side, and a mass; each at least 0, and not all of them 0.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct MountEnd {
    /// N/m per m
    pub stiffness: f64,
    /// N s/m per m
    pub damping: f64,
    /// kg per m
    pub mass: f64,
    /// Dead load, N/m; of the normal one only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<f64>,
}

impl Mount {
    /// Along the approach and along the sliding.
    pub fn directions(&self) -> [Option<MountEnd>; 2] {
        [self.normal, self.tangential]
    }
}
