//! What makes a result doubtful: said of a scene before it is solved, and of a history after that.
//!
//! Each warning is a function with its threshold; a new one is a function and a line in `BEFORE` or `AFTER`. They are
//! about results that mean little although nothing stops the solver, and they estimate: what is as fine as it has to be
//! gets none. docs/warnings.md has the table of all thresholds.

mod body;
mod contact;
mod encounter;
mod heat;
mod loading;
mod outcome;
mod profile;

use std::fmt;

use crate::composition::{Outline, Shape};
use crate::output::HistoryRow;
use crate::scene::Scene;

use encounter::Encounters;

/// One doubt, in one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Warning {
    /// The dotted path of the key that the remedy is about.
    pub key: String,
    /// What it is, by how much, and the remedy.
    pub text: String,
}

impl Warning {
    /// About a key.
    pub fn new(key: impl Into<String>, text: impl Into<String>) -> Self {
        Self { key: key.into(), text: text.into() }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.key, self.text)
    }
}

/// What is known of a scene before it is solved.
struct Before<'a> {
    scene: &'a Scene,
    outline: &'a Outline,
    shape: &'a Shape,
    /// The indenter and the undeformed face, over the history.
    encounters: Encounters,
}

/// What is known of it after that.
struct After<'a> {
    scene: &'a Scene,
    /// Nodes of the contact face: along it as if all edges were like the shortest, in space all of them.
    nodes: f64,
    /// Whether it is in space.
    in_space: bool,
    /// The approach at which the indenter first touches, m.
    touch: f64,
    /// Row 0 is the unloaded state.
    history: &'a [HistoryRow],
}

const BEFORE: &[fn(&Before<'_>) -> Option<Warning>] = &[
    profile::unit,
    profile::seam,
    profile::waves,
    profile::between_nodes,
    profile::slope,
    contact::never_touches,
    contact::leaves_the_body,
    contact::few_nodes,
    contact::pressed_end,
    contact::penalty,
    body::locking,
    body::large_strains,
    body::modulus_unit,
    body::digits,
    loading::regularisation,
    loading::elastic_slip,
    loading::cycles,
    loading::arms,
    heat::skin,
    heat::told,
];

const AFTER: &[fn(&After<'_>) -> Option<Warning>] = &[
    outcome::no_contact,
    outcome::imbalance,
    outcome::penetration,
    outcome::digits,
    outcome::few_nodes,
    outcome::between_nodes,
    outcome::stuck_slip,
    outcome::oscillation,
    heat::reached,
];

/// What is doubtful about a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Doubts {
    /// What can be said before it is solved.
    pub before: Vec<Warning>,
    nodes: f64,
    in_space: bool,
    touch: f64,
}

impl Doubts {
    /// Of a scene with this body and this indenter.
    pub fn of(scene: &Scene, outline: &Outline, shape: &Shape) -> Self {
        let encounters = Encounters::new(scene, outline, shape);
        let touch = encounters.low;
        let before = Before { scene, outline, shape, encounters };
        let before = BEFORE.iter().filter_map(|check| check(&before)).collect();
        let lengths = outline.nodes.windows(2).map(|pair| pair[1][0] - pair[0][0]);
        let in_space = outline.is_in_space();
        let nodes = match in_space {
            true => outline.face_nodes as f64,
            false => outline.face.width() / lengths.fold(outline.face.cell(), f64::min),
        };
        Self { before, nodes, in_space, touch }
    }

    /// What the history of the same scene says besides.
    pub fn after(&self, scene: &Scene, history: &[HistoryRow]) -> Vec<Warning> {
        let after = After { scene, nodes: self.nodes, in_space: self.in_space, touch: self.touch, history };
        AFTER.iter().filter_map(|check| check(&after)).collect()
    }
}

/// Whether `value` is above `limit` by more than round-off.
fn above(value: f64, limit: f64) -> bool {
    value > limit * (1.0 + 1e-9)
}

/// The key of a phase.
fn phase(scene: &Scene, index: usize, key: &str) -> String {
    let name = scene.phases.get(index).map_or("", |phase| phase.name.as_str());
    format!("phase.{name}.{key}")
}

/// The key of a material.
fn material(scene: &Scene, index: usize, key: &str) -> String {
    match scene.materials.as_slice() {
        [_] => format!("material.{key}"),
        several => match several.get(index).and_then(|material| material.region.as_ref()) {
            Some(region) => format!("material.{region}.{key}"),
            None => format!("material.{index}.{key}"),
        },
    }
}

/// The key that makes the contact face finer.
fn cells(scene: &Scene) -> &'static str {
    if scene.layer().is_some() { "layer.cells" } else { "mesh.file" }
}
