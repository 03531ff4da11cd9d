//! The result file of steady sliding: `/steady` with a row for each velocity.

use std::path::Path;
use std::time::SystemTime;

use super::scratch::scratch;
use super::skeleton::{Purpose, Skeleton, about, root_attributes};
use super::{FacePlan, Metadata, Status, ours};
use crate::error::{Error, Result, plain};

/// The steady state at a velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Of the indenter along +x, in space along the heading, m/s.
    pub velocity: f64,
    /// D, m
    pub approach: f64,
    /// N/m, in space N.
    pub normal_force: f64,
    /// N/m, on the layer; in space N, along x.
    pub tangential_force: f64,
    /// The integral of p dh/dx, N/m, in space N.
    pub hysteretic_force: f64,
    /// In space the same two along y, N.
    pub across: [f64; 2],
    /// Share of the face.
    pub contact_fraction: f64,
    /// What each arm dissipates, W/m, in space W.
    pub arm_dissipation: Vec<f64>,
    /// Of each node, Pa.
    pub pressure: Vec<f64>,
    /// Of each node, on the layer, Pa; in space along x and along y.
    pub shear: Vec<f64>,
    /// Of each node, m; negative where the indenter penetrates.
    pub gap: Vec<f64>,
}

/// What is written.
pub struct Curve<'a> {
    /// The relaxation times of the arms, s.
    pub times: &'a [f64],
    /// The nodes of the face.
    pub face: &'a FacePlan,
    /// Where a positive velocity points, along x and y.
    pub heading: [f64; 2],
    /// The states, in the order of their velocities.
    pub states: &'a [State],
}

const GROUP: &str = "steady";
/// Name, unit, words, and where a number is in a state; of a vector its two components.
type Column = (&'static str, &'static str, &'static str, fn(&State) -> f64, Option<fn(&State) -> f64>);
/// The same of a field along the face.
type Field = (&'static str, &'static str, &'static str, fn(&State) -> &[f64]);

#[rustfmt::skip]
const COLUMNS: [Column; 6] = [
    ("velocity", "m/s", "velocity of the indenter", |s| s.velocity, None),
    ("approach", "m", "normal approach of the indenter", |s| s.approach, None),
    ("normal_force", "N/m", "normal force per unit thickness, compression positive", |s| s.normal_force, None),
    ("tangential_force", "N/m", "tangential force on the layer per unit thickness, positive along +x", |s| s.tangential_force, Some(|s| s.across[0])),
    ("hysteretic_force", "N/m", "integral of pressure times slope of the profile, per unit thickness", |s| s.hysteretic_force, Some(|s| s.across[1])),
    ("contact_fraction", "1", "share of the contact face in contact", |s| s.contact_fraction, None),
];

#[rustfmt::skip]
const FIELDS: [Field; 3] = [
    ("pressure", "Pa", "contact pressure, positive in compression", |s| &s.pressure),
    ("shear", "Pa", "tangential traction on the layer, positive along +x", |s| &s.shear),
    ("gap", "m", "normal gap, negative where the indenter penetrates", |s| &s.gap),
];

/// Writes a file that is whole once it has its name. An existing one is replaced only if this program wrote it.
///
/// # Errors
/// [`Error::File`] when it is somebody else's or cannot be written; nothing was changed then.
pub fn write(path: &Path, metadata: &Metadata, curve: &Curve<'_>) -> Result<()> {
    ours::make_way(path)?;
    let scratch = scratch(path);
    let cannot = |error: &dyn std::fmt::Display| {
        Error::file(path, format!("cannot be created: {error}; name another file with --out"))
    };
    // The system's words on a directory that cannot be written are plainer than the library's.
    std::fs::File::create_new(&scratch).map_err(|error| cannot(&error))?;
    let done = fill(&scratch, metadata, curve)
        .map_err(|error| cannot(&plain(&error)))
        .and_then(|()| std::fs::rename(&scratch, path).map_err(|error| cannot(&error)));
    if done.is_err() {
        // The error at hand says more than one about a leftover.
        let _ = std::fs::remove_file(&scratch);
    }
    done
}

fn fill(path: &Path, metadata: &Metadata, Curve { times, face, heading, states }: &Curve<'_>) -> hdf5::Result<()> {
    let file = hdf5::File::create(path)?;
    let seconds = SystemTime::now().duration_since(metadata.started).map_or(0.0, |took| took.as_secs_f64());
    root_attributes(&file, metadata, (Status::Complete, seconds))?;
    file.create_group(GROUP)?;
    file.create_group("interface")?;
    let mut skeleton = Skeleton::new(&file, Purpose::Packed);
    let (velocity, arm) = (("velocity", states.len()), ("relaxation_time", times.len()));
    let (node, direction) = ((if face.in_space { "node" } else { "x" }, face.nodes()), ("direction", 2));
    for (name, unit, words, value, across) in COLUMNS {
        let about = about((unit, words), face.in_space);
        let list = |value: fn(&State) -> f64| states.iter().map(value).collect::<Vec<f64>>();
        match across.filter(|_| face.in_space) {
            None => skeleton.fixed((GROUP, name), &list(value), about, &[velocity])?,
            Some(across) => {
                let both: Vec<f64> = states.iter().flat_map(|state| [value(state), across(state)]).collect();
                skeleton.fixed((GROUP, name), &both, about, &[velocity, direction])?;
            }
        }
    }
    skeleton.fixed((GROUP, "relaxation_time"), times, ("s", "relaxation time of each arm"), &[arm])?;
    let dissipated: Vec<f64> = states.iter().flat_map(|state| state.arm_dissipation.iter().copied()).collect();
    let words = "power that each arm dissipates, per unit thickness";
    skeleton.fixed((GROUP, "arm_dissipation"), &dissipated, about(("W/m", words), face.in_space), &[velocity, arm])?;
    for (name, unit, words, field) in FIELDS {
        let values: Vec<f64> = states.iter().flat_map(|state| field(state).iter().copied()).collect();
        let vector = face.in_space && name == "shear";
        let dimensions = [velocity, node, direction];
        let about = about((unit, words), face.in_space);
        skeleton.fixed((GROUP, name), &values, about, &dimensions[..if vector { 3 } else { 2 }])?;
    }
    if face.in_space {
        let words = "where a positive velocity points, of length 1";
        skeleton.fixed((GROUP, "heading"), heading, ("1", words), &[direction])?;
        skeleton.nodes(GROUP, face)?;
        skeleton.nodes("interface", face)?;
    } else {
        let words = "coordinate along the contact face, in the frame of the indenter";
        skeleton.fixed((GROUP, "x"), &face.coordinates, ("m", words), &[node])?;
        let words = "undeformed coordinate along the contact face";
        skeleton.fixed(("interface", "x"), &face.coordinates, ("m", words), &[node])?;
    }
    skeleton.finish()?;
    file.close()
}
