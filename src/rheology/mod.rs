//! Linear viscoelasticity: pure laws, numbers in and numbers out.

pub mod memory;
pub mod prony;

pub use memory::{Factors, Memory};
pub use prony::{Arm, Prony};
