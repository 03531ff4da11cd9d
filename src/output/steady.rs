//! The result file of steady sliding: `/steady` with a row for each velocity.

use std::path::Path;
use std::time::SystemTime;

use super::scratch::scratch;
use super::skeleton::{Purpose, Skeleton, root_attributes};
use super::{Metadata, Status, ours};
use crate::error::{Error, Result, plain};

/// The steady state at a velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Of the indenter along +x, m/s.
    pub velocity: f64,
    /// D, m
    pub approach: f64,
    /// N/m
    pub normal_force: f64,
    /// N/m, on the layer.
    pub tangential_force: f64,
    /// The integral of p dh/dx, N/m.
    pub hysteretic_force: f64,
    /// Share of the face.
    pub contact_fraction: f64,
    /// What each arm dissipates, W/m.
    pub arm_dissipation: Vec<f64>,
    /// Of each node, Pa.
    pub pressure: Vec<f64>,
    /// Of each node, on the layer, Pa.
    pub shear: Vec<f64>,
    /// Of each node, m; negative where the indenter penetrates.
    pub gap: Vec<f64>,
}

/// What is written.
pub struct Curve<'a> {
    /// The relaxation times of the arms, s.
    pub times: &'a [f64],
    /// The nodes along the face, m.
    pub x: &'a [f64],
    /// The states, in the order of their velocities.
    pub states: &'a [State],
}

const GROUP: &str = "steady";
/// Name, unit, words, and where a number is in a state.
type Column = (&'static str, &'static str, &'static str, fn(&State) -> f64);
/// The same of a field along the face.
type Field = (&'static str, &'static str, &'static str, fn(&State) -> &[f64]);

#[rustfmt::skip]
const COLUMNS: [Column; 6] = [
    ("velocity", "m/s", "velocity of the indenter along +x", |s| s.velocity),
    ("approach", "m", "normal approach of the indenter", |s| s.approach),
    ("normal_force", "N/m", "normal force per unit thickness, compression positive", |s| s.normal_force),
    ("tangential_force", "N/m", "tangential force on the layer per unit thickness, positive along +x", |s| s.tangential_force),
    ("hysteretic_force", "N/m", "integral of pressure times slope of the profile, per unit thickness", |s| s.hysteretic_force),
    ("contact_fraction", "1", "share of the contact face in contact", |s| s.contact_fraction),
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

fn fill(path: &Path, metadata: &Metadata, Curve { times, x, states }: &Curve<'_>) -> hdf5::Result<()> {
    let file = hdf5::File::create(path)?;
    let seconds = SystemTime::now().duration_since(metadata.started).map_or(0.0, |took| took.as_secs_f64());
    root_attributes(&file, metadata, (Status::Complete, seconds))?;
    file.create_group(GROUP)?;
    file.create_group("interface")?;
    let mut skeleton = Skeleton::new(&file, Purpose::Packed);
    let (velocity, arm) = (("velocity", states.len()), ("relaxation_time", times.len()));
    for (name, unit, words, value) in COLUMNS {
        let values: Vec<f64> = states.iter().map(value).collect();
        skeleton.fixed((GROUP, name), &values, (unit, words), &[velocity])?;
    }
    skeleton.fixed((GROUP, "relaxation_time"), times, ("s", "relaxation time of each arm"), &[arm])?;
    let dissipated: Vec<f64> = states.iter().flat_map(|state| state.arm_dissipation.iter().copied()).collect();
    let words = "power that each arm dissipates, per unit thickness";
    skeleton.fixed((GROUP, "arm_dissipation"), &dissipated, ("W/m", words), &[velocity, arm])?;
    for (name, unit, words, field) in FIELDS {
        let values: Vec<f64> = states.iter().flat_map(|state| field(state).iter().copied()).collect();
        skeleton.fixed((GROUP, name), &values, (unit, words), &[velocity, ("x", x.len())])?;
    }
    skeleton.fixed(
        (GROUP, "x"),
        x,
        ("m", "coordinate along the contact face, in the frame of the indenter"),
        &[("x", x.len())],
    )?;
    skeleton.fixed(("interface", "x"), x, ("m", "undeformed coordinate along the contact face"), &[("x", x.len())])?;
    skeleton.finish()?;
    file.close()
}
