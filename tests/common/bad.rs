//! The scenes that must be refused: a line each of `tests/scenes/bad.toml`, whose head tells the keys, and the files of
//! `tests/scenes/bad/`, for what depends on how a file is written. Those begin with comments of the same names:
//!
//! ```toml
//! # message: line 7, column 1: not TOML: duplicate key
//! ```

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::{fs, mem};

use serde::Deserialize;
use toml::{Table, Value};

use super::{directory, scenes};

/// A scene that must be refused.
#[derive(Debug)]
pub struct BadScene {
    /// The file.
    pub file: PathBuf,
    /// Its content.
    pub text: String,
    /// What the error must say after the name of the file, on one line.
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

    fn new(file: PathBuf, text: String, refusal: Refusal) -> Self {
        let args = refusal.args.split_whitespace().map(str::to_owned).collect();
        Self { file, text, args, message: refusal.message, exit: refusal.exit.unwrap_or(2) }
    }

    /// A file that says in its first lines what it must give.
    fn load(file: PathBuf) -> Self {
        let text = fs::read_to_string(&file).unwrap();
        let header = |name: &str| {
            let prefix = format!("# {name}: ");
            let comments = text.lines().take_while(|line| line.starts_with('#'));
            comments.filter_map(|line| line.strip_prefix(&prefix)).next().map(str::to_owned)
        };
        let message = header("message").unwrap_or_else(|| panic!("{}: no '# message: ' header", file.display()));
        let exit = header("exit").map(|code| code.parse().unwrap());
        let refusal = Refusal { message, exit, args: header("args").unwrap_or_default() };
        Self::new(file, text, refusal)
    }
}

/// How a scene is refused.
#[derive(Deserialize)]
struct Refusal {
    message: String,
    #[serde(default)]
    args: String,
    exit: Option<i32>,
}

/// What is done to a base.
#[derive(Deserialize)]
struct Edit {
    base: Option<String>,
    #[serde(default)]
    without: Vec<String>,
    #[serde(default)]
    set: Table,
}

impl Edit {
    fn apply(self, bases: &Table) -> Table {
        let base = self.base.as_deref().unwrap_or("layer");
        let mut scene = bases[base].as_table().unwrap().clone();
        for path in &self.without {
            remove(&mut scene, path);
        }
        merge(&mut scene, self.set);
        scene
    }
}

#[derive(Deserialize)]
struct Case {
    #[serde(flatten)]
    edit: Edit,
    #[serde(flatten)]
    refusal: Refusal,
}

#[derive(Deserialize)]
struct Cases {
    base: Table,
    derived: std::collections::BTreeMap<String, Edit>,
    case: std::collections::BTreeMap<String, Case>,
}

/// Takes away what stands at a path; that of a phase has its name.
fn remove(table: &mut Table, path: &str) {
    let Some((first, rest)) = path.split_once('.') else {
        table.remove(path).unwrap_or_else(|| panic!("{path}: is not in the base"));
        return;
    };
    match &mut table[first] {
        Value::Table(inner) => remove(inner, rest),
        Value::Array(phases) => edit_named(phases, |named| remove(named, rest)),
        other => panic!("{path}: {first} is {other}"),
    }
}

/// Puts the keys of `new` into `table`, those of a table into the table that is there.
fn merge(table: &mut Table, new: Table) {
    for (key, value) in new {
        match (table.get_mut(&key), value) {
            (Some(Value::Table(old)), Value::Table(value)) => merge(old, value),
            (Some(Value::Array(phases)), Value::Table(value)) => edit_named(phases, |named| merge(named, value)),
            (_, value) => {
                table.insert(key, value);
            }
        }
    }
}

/// Edits phases as one table of them by their names.
fn edit_named(phases: &mut Vec<Value>, edit: impl FnOnce(&mut Table)) {
    let name = |phase: &Value| phase["name"].as_str().unwrap().to_owned();
    let mut named: Table = mem::take(phases).into_iter().map(|phase| (name(&phase), phase)).collect();
    edit(&mut named);
    phases.extend(named.into_iter().map(|(name, mut phase)| {
        phase.as_table_mut().unwrap().entry("name").or_insert(Value::String(name));
        phase
    }));
}

/// All scenes that must be refused, by name. Those of the table are written once for each program of tests, into a
/// directory from which `../data` is what it is from `tests/scenes/bad/`.
pub fn bad_scenes() -> &'static [BadScene] {
    static SCENES: OnceLock<Vec<BadScene>> = OnceLock::new();
    SCENES.get_or_init(|| {
        let written = Path::new(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_CRATE_NAME"));
        fs::create_dir_all(written.join("bad")).unwrap();
        let _ = std::os::unix::fs::symlink(directory("tests/scenes/data"), written.join("data"));
        let files = scenes("tests/scenes/bad").into_iter().map(BadScene::load);
        let mut all: Vec<BadScene> = table(&written.join("bad")).into_iter().chain(files).collect();
        all.sort_by(|a, b| a.file.file_name().cmp(&b.file.file_name()));
        all
    })
}

/// The scenes of the table, written into a directory.
fn table(written: &Path) -> Vec<BadScene> {
    let Cases { mut base, derived, case } = toml::from_str(include_str!("../scenes/bad.toml")).unwrap();
    for (name, edit) in derived {
        let scene = edit.apply(&base);
        base.insert(name, Value::Table(scene));
    }
    let write = |(name, case): (String, Case)| {
        let file = written.join(format!("{name}.toml"));
        let text = toml::to_string(&case.edit.apply(&base)).unwrap();
        fs::write(&file, &text).unwrap();
        BadScene::new(file, text, case.refusal)
    };
    case.into_iter().map(write).collect()
}
