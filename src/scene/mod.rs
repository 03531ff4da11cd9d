//! A scene as plain typed data: what the user asked for, read, checked and resolved.
//!
//! The only place that knows a key's name. All quantities are SI; every number here is finite and within the range
//! its field states, because [`read`] refuses a file that says otherwise.

mod adhesion;
mod checks;
mod differences;
mod document;
mod friction;
mod heat;
mod include;
mod indenter;
mod kept;
mod keys;
mod load;
mod material;
mod mount;
mod overrides;
mod penalty;
mod read;
mod record;
mod resolved;
pub mod schema;
pub mod sweep;
mod wear;

use std::path::PathBuf;

use nalgebra::Vector2;
use serde::Serialize;

pub use adhesion::{Adhesion, AdhesionLaw, Bond};
pub use checks::whole_periods;
pub use differences::{differences, obstacles};
pub use document::parse;
pub use friction::{Coefficient, Friction, Law};
pub use heat::{Base, Convection, Heat};
pub use include::{Load, include, open};
pub use indenter::{Detrend, Extend, Indenter, Reading, Rms, Seam};
pub(crate) use keys::nearest;
pub use load::{from_table, read, read_with};
pub use mount::{Mount, MountEnd};
pub use overrides::{get, set};
pub use penalty::{added_compliance, penalty_for, penalty_on_mesh, shortest_step};
pub use record::Record;
pub use wear::{Wear, WearLaw, Wearing};

/// One scene: the layer, its material, the indenter, the contact, the loading history, and what to keep of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scene {
    /// Free text, copied to the results.
    pub title: String,
    /// The deformable body: `[layer]` or `[mesh]`.
    #[serde(flatten)]
    pub body: Body,
    /// What the body is made of: one material, or one for each region of a mesh or stratum of a layer (top down).
    #[serde(rename = "material", serialize_with = "resolved::materials")]
    pub materials: Vec<Material>,
    /// The rigid indenter.
    pub indenter: Indenter,
    /// How non-penetration is enforced.
    pub contact: Contact,
    /// The friction law; none = frictionless.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<Friction>,
    /// The temperature of the body; none = not modelled.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heat: Option<Heat>,
    /// What is between the indenter and what moves it; none = it is moved as it is told.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mount: Option<Mount>,
    /// How the contact wears; none = not at all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wear: Option<Wear>,
    /// What the surfaces pull each other with across a gap; none = not at all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adhesion: Option<Adhesion>,
    /// The loading history, in order; never empty.
    #[serde(rename = "phase")]
    pub phases: Vec<Phase>,
    /// How it is solved.
    pub solver: Solver,
    /// What is written.
    pub output: Output,
}

/// The deformable body.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Body {
    /// Meshed by this program.
    Layer(Layer),
    /// Meshed by Gmsh.
    Mesh(MeshFile),
}

/// A Gmsh file and what its named curves, or surfaces, are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshFile {
    /// The .msh file, as an absolute path.
    pub file: PathBuf,
    /// Physical curve, in space surface: the contact face.
    pub contact: String,
    /// Physical curves, or surfaces, without displacement; at least one.
    pub fixed: Vec<String>,
    /// Physical curves, straight and along x or z, or surfaces across x, y or z, without displacement across them.
    pub roller: Vec<String>,
    /// What its quadrilaterals or hexahedra are; none: fully integrated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub element: Option<Element>,
}

/// The element for quadrilaterals, and for hexahedra.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Element {
    /// Bilinear, fully integrated.
    #[serde(rename = "q4")]
    Quad4,
    /// The same with mean dilatation, for Poisson ratios near 1/2.
    #[serde(rename = "q4_bbar")]
    Quad4Bbar,
    /// Trilinear, fully integrated.
    #[serde(rename = "h8")]
    Hex8,
    /// The same with mean dilatation.
    #[serde(rename = "h8_bbar")]
    Hex8Bbar,
}

/// A rectangular layer, in space a box; the lower face is clamped, the upper one is the contact face.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Along x and, in space, along y.
    pub spans: Vec<Span>,
    /// Depth, m, > 0.
    pub depth: f64,
    /// Cells through the depth, >= 1.
    pub rows: usize,
    /// Height of the lowest cell over that of the top cell, > 0; 1 = uniform.
    pub grading: f64,
    /// What its cells are.
    pub element: Element,
}

/// A layer in one direction along its face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Width, m, > 0; one period when `sides` is periodic.
    pub width: f64,
    /// Cells, >= 1 (>= 2 where it is periodic).
    pub cells: usize,
    /// What holds the two sides.
    pub sides: Sides,
}

/// What holds the sides of a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Sides {
    /// Left and right are the same nodes.
    Periodic,
    /// No traction.
    Free,
    /// No displacement across them.
    Roller,
    /// No displacement.
    Fixed,
}

/// A linear viscoelastic solid: instantaneous elasticity and the Prony arms of the shear modulus.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Material {
    /// The physical surface, in space volume, of the mesh that it fills; none = all of the mesh, or a stratum of a layer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub region: Option<String>,
    /// Thickness of its stratum, m; none = all that the strata above leave.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness: Option<f64>,
    /// Instantaneous (t = 0) shear modulus, Pa, > 0.
    pub shear_modulus: f64,
    /// Instantaneous Poisson ratio, in (-1, 0.5).
    pub poisson_ratio: f64,
    /// Prony arms of the shear modulus, at the temperature of the scene; empty = it does not relax. The weights sum to at most 1.
    pub arms: Vec<Arm>,
    /// How the bulk modulus relaxes; always present when there are arms of either modulus.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub poisson_rule: Option<PoissonRule>,
    /// Prony arms of the bulk modulus, with the rule of that name only. The weights sum to at most 1.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bulk_arms: Vec<Arm>,
    /// The update of the arms over a step.
    pub memory: Memory,
    /// Of heat, W/m/K, > 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub conductivity: Option<f64>,
    /// Heat capacity per volume, J/m^3/K, > 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heat_capacity: Option<f64>,
    /// How the times go with the temperature, where that of the body is coupled: from the one that they are those of.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub shift: Option<Shifting>,
    /// Where all this comes from: the file, the power law and the error of its series, the shift of the times.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// The law by which the times of a material go with the temperature, as keys.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "shift", rename_all = "lowercase")]
pub enum Shifting {
    /// log10 a_T = -c1 (T - T_ref)/(c2 + T - T_ref)
    Wlf {
        /// K
        reference_temperature: f64,
        /// That of the arms as they stand here, K: the reference.
        temperature: f64,
        /// -
        c1: f64,
        /// K
        c2: f64,
    },
    /// ln a_T = E_a/R (1/T - 1/T_ref)
    Arrhenius {
        /// K
        reference_temperature: f64,
        /// That of the arms as they stand here, K: the reference.
        temperature: f64,
        /// J/mol
        activation_energy: f64,
    },
}

/// One arm of a Prony series: M(t) = M_inst (1 - sum_i weight_i (1 - exp(-t / time_i))).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Arm {
    /// Share of the instantaneous modulus, in (0, 1].
    pub weight: f64,
    /// Relaxation time, s, > 0.
    pub time: f64,
}

/// How the bulk modulus goes with the relaxing shear modulus.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PoissonRule {
    /// The Poisson ratio stays; the bulk modulus relaxes with the shear modulus.
    ConstantRatio,
    /// The bulk modulus stays; the Poisson ratio rises as the shear modulus relaxes.
    ConstantBulkModulus,
    /// The bulk modulus has arms of its own.
    BulkArms,
}

/// The time integration of an arm over one step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Memory {
    /// Exact for a displacement linear over the step; second order.
    Exponential,
    /// First order.
    BackwardEuler,
}

/// How non-penetration is enforced.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contact {
    /// p = -penalty * gap where gap < 0; none = no penetration.
    #[serde(flatten)]
    pub penalty: Option<Penalty>,
    /// Where the interface element evaluates the laws.
    pub quadrature: Quadrature,
}

/// The stiffness of the contact, or what decides it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Penalty {
    /// Pa/m, > 0; for a layer always this (from `tolerance` where the file says that).
    #[serde(rename = "penalty")]
    Stiffness(f64),
    /// For a mesh: the share by which it may soften the body, in (0, 1); see [`penalty_on_mesh`].
    #[serde(rename = "tolerance")]
    Tolerance(f64),
}

impl Contact {
    /// The penalty, Pa/m, where there is one that is known without the mesh.
    pub fn stiffness(&self) -> Option<f64> {
        match self.penalty {
            Some(Penalty::Stiffness(stiffness)) => Some(stiffness),
            Some(Penalty::Tolerance(_)) | None => None,
        }
    }
}

/// Points of an interface element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Quadrature {
    /// At the nodes.
    Nodal,
    /// Two Gauss points.
    Gauss,
}

/// One phase of the loading history.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Phase {
    /// Unique name, not empty.
    pub name: String,
    /// s, > 0; always resolved (from `distance` and `velocity` where the file says those).
    pub duration: f64,
    /// How it is divided into steps.
    #[serde(flatten)]
    pub stepping: Stepping,
    /// Normal approach of the indenter at the end of the phase, m, linear in time; none = unchanged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub approach: Option<f64>,
    /// The normal force on the indenter at the end of the phase, N/m, at least 0, linear in time, instead of the approach; none =
    /// as said by `approach`, or what the phase before controlled.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal_force: Option<f64>,
    /// Tangential motion of the indenter.
    #[serde(flatten)]
    pub motion: Motion,
}

/// How a phase is divided into steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Stepping {
    /// So many equal steps, >= 1.
    Steps(usize),
    /// Steps chosen as the phase goes, so that the local error of each is at most this share of the greatest penetration
    /// of the undeformed face that the history asks for; in (0, 1).
    Tolerance(f64),
}

/// Tangential motion of the indenter over one phase, relative to where the phase found it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Motion {
    /// Constant velocity along x and, in space, y, m/s; may be 0 or negative.
    Velocity(#[serde(serialize_with = "resolved::number_or_pair")] Vector2<f64>),
    /// amplitude (sin(2 pi cycles t / duration + phase) - sin(phase)), in each direction by itself.
    Tangential {
        /// m
        #[serde(serialize_with = "resolved::number_or_pair")]
        amplitude: Vector2<f64>,
        /// > 0; need not be whole
        cycles: f64,
        /// degrees
        #[serde(serialize_with = "resolved::number_or_pair", skip_serializing_if = "is_zero")]
        phase: Vector2<f64>,
    },
    /// As it was measured, and with it perhaps the approach or the normal force, which the phase then does not say.
    #[serde(rename = "motion")]
    Measured(Record),
}

fn is_zero(vector: &Vector2<f64>) -> bool {
    vector.amax() == 0.0
}

/// How the scene is solved.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Solver {
    /// Which form of the problem.
    pub strategy: Strategy,
    /// Relative, on the residual; in (0, 1).
    pub tolerance: f64,
}

/// Which form of the problem is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Strategy {
    /// The program picks, and says why.
    Auto,
    /// All unknowns.
    Monolithic,
    /// The unknowns of the contact face.
    Condensed,
}

/// What is written.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Output {
    /// Steps between stored interface profiles; 0 = only at the ends of phases.
    pub interface_every: usize,
    /// When bulk fields are written; empty = never.
    pub bulk_at: Vec<When>,
    /// Steps between checkpoints; 0 = only on a signal.
    pub checkpoint_every: usize,
    /// Whether the energy balance is.
    pub energy: bool,
}

/// A moment of the loading history.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum When {
    /// The end of the phase of this name.
    PhaseEnd(String),
    /// s; a step ends there.
    Time(f64),
}

impl When {
    /// The name of the phase whose end it is, if it is one.
    pub fn phase_end(&self) -> Option<&str> {
        match self {
            Self::PhaseEnd(name) => Some(name),
            Self::Time(_) => None,
        }
    }
}

/// Where a scene came from: the file and the `--set` overrides, for messages.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// The scene file.
    pub file: PathBuf,
    /// `key.path=value` as typed, applied in order.
    pub overrides: Vec<String>,
}
