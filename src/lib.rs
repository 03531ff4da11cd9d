//! Parallel transient viscoelastic contact with friction, by interface finite elements with embedded profiles (MPJR).

// All that is printed goes through cli::terminal, which survives a reader that goes away.
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod bulk;
pub mod checksum;
pub mod cli;
pub mod composition;
pub mod element;
pub mod energy;
pub mod error;
pub mod expression;
pub mod friction;
pub mod input;
pub mod interface;
pub mod loading;
pub mod memory;
pub mod mesh;
pub mod oracle;
pub mod output;
pub mod parallel;
pub mod petsc;
pub mod plot;
pub mod profile;
pub mod rheology;
pub mod scene;
pub mod snapshot;
pub mod solution;
pub mod solve;
pub mod study;
pub mod table;
pub mod verify;
pub mod warnings;
