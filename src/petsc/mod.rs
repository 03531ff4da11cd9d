//! Thin safe wrappers of C libraries: the only `unsafe` in the crate.

pub mod collective_write;
pub mod object_address;
