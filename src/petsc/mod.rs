//! Thin safe wrappers of C libraries: the only `unsafe` in the crate.

pub mod object_address;
