//! Parallel transient viscoelastic contact with friction, by interface finite elements with embedded profiles (MPJR).

pub mod error;
pub mod output;
pub mod petsc;
pub mod rheology;
pub mod scene;
