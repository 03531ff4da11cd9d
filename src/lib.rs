//! Parallel transient viscoelastic contact with friction, by interface finite elements with embedded profiles (MPJR).

pub mod cli;
pub mod error;
pub mod plot;
pub mod rheology;
pub mod scene;
