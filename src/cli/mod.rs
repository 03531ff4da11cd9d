//! The commands of `mpjr`, one module each.

pub mod fit;
