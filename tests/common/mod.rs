//! Shared by the integration tests; each uses a part of it.
#![allow(dead_code)]
pub mod bad;
pub mod compare;
pub mod loads;
pub mod mpi;
pub mod msh;
pub mod program;
pub mod sample;
pub mod scene;
pub mod smallest;
pub mod solid;

use std::path::{Path, PathBuf};

/// A directory of the repository.
pub fn directory(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The scenes (`.toml`) of a directory of the repository, by name.
pub fn scenes(path: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(directory(path)).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries.filter(|file| file.extension().is_some_and(|end| end == "toml")).collect();
    files.sort();
    files
}
