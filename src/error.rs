//! The one error type of the program: what went wrong, where, and what would be accepted.

use std::fmt;
use std::path::{Path, PathBuf};

/// The result of anything that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// What can go wrong. Each kind has one exit code (see [`Error::exit_code`]); the text says the file, the key and
/// the remedy and is printed once, on rank 0.
#[derive(Debug, Clone, PartialEq)]
pub enum Error {
    /// The scene, sweep or data file says something that cannot be done. Exit code 2.
    Scene {
        /// The file the user wrote.
        file: PathBuf,
        /// The dotted path of the key, such as `layer.width` or `phase.slide.steps`; empty when the whole file is meant.
        key: String,
        /// What is wrong and what would be accepted.
        reason: String,
    },
    /// The command line says something that cannot be done. Exit code 2.
    Usage(String),
    /// The solver could not converge; what was accepted so far is kept. Exit code 3.
    Solver(String),
    /// A file could not be read or written. Exit code 4.
    File {
        /// The file.
        file: PathBuf,
        /// What the system said, and the remedy.
        reason: String,
    },
    /// A law cannot respond at the point it was asked for. Inside a solve the step is cut; outside it is an error of
    /// the scene.
    Domain(String),
    /// What was computed is not what is known to be right: a defect of this program or of its installation. Exit code 1.
    Mismatch(String),
    /// A library refused a call it should have taken: a defect of this program or of its installation. Exit code 1.
    Internal(String),
    /// A signal stopped the run, and a checkpoint was written. Exit code 5.
    Stopped(String),
    /// Something is doubtful, and that was asked to be an error; results are kept. Exit code 6.
    Doubtful(String),
}

impl Error {
    /// An error of the scene `file` at `key`.
    pub fn scene(file: &Path, key: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Scene { file: file.to_owned(), key: shortened(key.into(), 200), reason: shortened(reason.into(), 1000) }
    }

    /// A file that cannot be read or written.
    pub fn file(file: &Path, reason: impl fmt::Display) -> Self {
        Self::File { file: file.to_owned(), reason: reason.to_string() }
    }

    /// The exit code of the process: 2 scene or command line, 3 no convergence, 4 files, 5 stopped by a signal,
    /// 6 warnings that are denied, 1 anything else.
    pub fn exit_code(&self) -> i32 {
        match self {
            Self::Scene { .. } | Self::Usage(_) => 2,
            Self::Solver(_) | Self::Domain(_) => 3,
            Self::File { .. } => 4,
            Self::Stopped(_) => 5,
            Self::Doubtful(_) => 6,
            Self::Mismatch(_) | Self::Internal(_) => 1,
        }
    }
}

/// A text of at most about so many characters: what a user typed may be in it, however long that is.
fn shortened(text: String, most: usize) -> String {
    if text.chars().nth(most).is_none() {
        return text;
    }
    let letters: Vec<char> = text.chars().collect();
    let [begin, end] = [&letters[..most / 2], &letters[letters.len() - most / 2..]].map(String::from_iter);
    format!("{begin} ... {end}")
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene { file, key, reason } if key.is_empty() => {
                write!(f, "{}: {reason}", file.display())
            }
            Self::Scene { file, key, reason } => write!(f, "{}: {key}: {reason}", file.display()),
            Self::File { file, reason } => write!(f, "{}: {reason}", file.display()),
            Self::Usage(text)
            | Self::Solver(text)
            | Self::Domain(text)
            | Self::Mismatch(text)
            | Self::Internal(text)
            | Self::Stopped(text)
            | Self::Doubtful(text) => f.write_str(text),
        }
    }
}

impl std::error::Error for Error {}

/// The HDF5 library's error in one line, without its stack: the system's words where it quotes them.
pub(crate) fn plain(error: &hdf5::Error) -> String {
    let text = error.to_string();
    let quoted = text.split("error message = '").nth(1).and_then(|rest| rest.split('\'').next());
    quoted.or_else(|| text.lines().next()).unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A formula of a million characters does not fill the screen; what is wrong with it, which comes last, is there.
    #[test]
    fn what_was_typed_is_shortened() {
        let error = Error::scene(Path::new("a.toml"), "x", format!("{:?}, column 7: is no name", "x+".repeat(500_000)));
        let text = error.to_string();
        assert!(text.len() < 1100 && text.ends_with("column 7: is no name"), "{}", text.len());
        assert_eq!(Error::scene(Path::new("a.toml"), "x", "short").to_string(), "a.toml: x: short");
    }
}
