//! Shared by the integration tests; each uses a part of it.
#![allow(dead_code)]
pub mod mpi;
pub mod msh;
pub mod program;
pub mod sample;
pub mod smallest;

use std::path::{Path, PathBuf};

/// A scene of `tests/scenes/bad/`. Its first lines are comments that say what it must give:
///
/// ```toml
/// # message: layer.width: must be a positive length in m, got -1
/// # args: --set layer.width=-1
/// # exit: 2
/// ```
///
/// `message` is the whole error after "FILE: ", on one line. `args` (default: none) are what follows the file on the
/// command line, separated by spaces, with no quoting; `exit` (default: 2) is the exit code.
#[derive(Debug)]
pub struct BadScene {
    /// The file.
    pub file: PathBuf,
    /// Its content, headers included.
    pub text: String,
    /// What the error must say after the name of the file.
    pub message: String,
    /// Arguments after the file.
    pub args: Vec<String>,
    /// The exit code.
    pub exit: i32,
}

impl BadScene {
    /// The values of the `--set` arguments, in order.
    pub fn overrides(&self) -> Vec<String> {
        let after = self.args.iter().skip(1);
        self.args.iter().zip(after).filter(|(option, _)| *option == "--set").map(|(_, value)| value.clone()).collect()
    }

    fn load(file: PathBuf) -> Self {
        let text = std::fs::read_to_string(&file).unwrap();
        let header = |name: &str| {
            let prefix = format!("# {name}: ");
            let comments = text.lines().take_while(|line| line.starts_with('#'));
            comments.filter_map(|line| line.strip_prefix(&prefix)).next().map(str::to_owned)
        };
        let message = header("message").unwrap_or_else(|| panic!("{}: no '# message: ' header", file.display()));
        let args = header("args").unwrap_or_default().split_whitespace().map(str::to_owned).collect();
        let exit = header("exit").map_or(2, |code| code.parse().unwrap());
        Self { message, args, exit, text, file }
    }
}

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

/// All scenes that must be refused.
pub fn bad_scenes() -> Vec<BadScene> {
    scenes("tests/scenes/bad").into_iter().map(BadScene::load).collect()
}
