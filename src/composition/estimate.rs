//! What a scene costs, before it is solved; and whether its memory can be had.

use std::path::Path;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::{Form, Outline, form};
use crate::error::{Error, Result};
use crate::loading::Target;
use crate::memory;
use crate::parallel::agree;
use crate::scene::{Body, Layer, Scene};

/// What the program and its libraries take before they do anything, bytes.
const PROGRAM: f64 = 5e7;

/// A rough cost, from measured times: within a factor of three on a recent core.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// s per step.
    pub step: f64,
    /// bytes
    pub memory: f64,
}

impl Estimate {
    /// Of a scene whose body is as the outline says.
    pub fn of(scene: &Scene, outline: &Outline) -> Self {
        let unknowns = outline.unknowns as f64;
        let axes = if outline.is_in_space() { 3.0 } else { 2.0 };
        let face = axes * outline.face_nodes as f64;
        let newton = 3.0;
        let fill = Fill::of(unknowns, outline.is_in_space());
        // Blocks to a row of nodes: 9 in the plane, 27 in space.
        let (matrix, vector) = (axes * 3.0_f64.powf(axes) * 12.0 * unknowns, 8.0 * unknowns);
        let arms = (scene.materials.iter().map(|material| material.arms.len()).sum::<usize>() + 4) as f64;
        // Half of the face in contact: a small dense factorisation and some products with the compliance.
        let contact = newton * (2e-10 * (face / 2.0).powi(3).min(face.powi(2) * 300.0) + 3e-9 * face * face);
        let by_wave = scene.layer().is_some_and(Layer::is_periodic);
        // Of a periodic layer in space transforms of the face, else products with the whole compliance.
        let contact = match by_wave && outline.is_in_space() {
            true => 20.0 * newton * 1e-7 * face,
            false => contact,
        };
        // While it is made there are three of it beside the factor's own.
        let compliance = if outline.is_in_space() { 32.0 } else { 8.0 } * face * face;
        // A factor is kept for the step lengths of two phases.
        let kept = if scene.phases.len() > 1 && outline.is_in_space() { 2.0 } else { 1.0 };
        let (step, memory) = match form(scene) {
            Form::Monolithic => (
                newton * (2.0 * fill.solve + 1.0e-7 * unknowns) + contact,
                8.0 * face * face + fill.memory + 4.0 * matrix + arms * vector,
            ),
            Form::Following if by_wave && outline.is_in_space() => (contact, 1e3 * face),
            Form::Following if by_wave => (contact, 80.0 * unknowns),
            Form::Following => (contact, compliance + fill.memory + 3.0 * matrix),
            Form::Remembering if by_wave => {
                (contact + 3e-8 * unknowns * arms, (12.0 + arms) * vector + 80.0 * unknowns)
            }
            Form::Remembering => {
                (contact + 2.0 * fill.solve, kept * (compliance + fill.memory) + 3.0 * matrix + arms * vector)
            }
        };
        Self { step, memory: PROGRAM + memory }
    }
}

/// What a sparse factor costs.
struct Fill {
    /// bytes
    memory: f64,
    /// s for one solve
    solve: f64,
}

impl Fill {
    /// By nested dissection of a body with so many unknowns: in the plane n log n entries, half of them where it is symmetric; in space
    /// n^(4/3), with the workspace of MUMPS as measured on blocks of up to 52,000 unknowns.
    fn of(unknowns: f64, in_space: bool) -> Self {
        let log = unknowns.max(2.0).log2();
        let memory = match in_space {
            false => 8.0 * 5.0 * unknowns * log * 0.6,
            true => 8.0 * 65.0 * unknowns.powf(4.0 / 3.0),
        };
        let solve = match in_space {
            false => 3e-7 * unknowns * (1.0 + 0.05 * log),
            true => 2e-10 * memory,
        };
        Self { memory, solve }
    }
}

/// Refuses a scene that needs more memory than can be had: some libraries that get none try for ever. Collective.
pub(super) fn fits(comm: &SimpleCommunicator, scene: &Scene, file: &Path, outline: &Outline) -> Result<()> {
    let mine = if comm.rank() == 0 { affordable(scene, file, outline, comm.size() as usize) } else { Ok(()) };
    agree(comm, mine)
}

/// The same for this process, the first of so many ranks.
///
/// The first rank has the interior of a condensed problem alone; all ranks share one system of all unknowns.
///
/// # Errors
/// [`Error::Scene`] with the remedy.
pub fn affordable(scene: &Scene, file: &Path, outline: &Outline, ranks: usize) -> Result<()> {
    let share = if form(scene) == Form::Monolithic { ranks as f64 } else { 1.0 };
    let steps = size_of::<Target>() as f64 * scene.steps() as f64;
    let needed = (Estimate::of(scene, outline).memory - PROGRAM) / share + steps;
    let Some(found) = memory::available().filter(|found| needed > found.bytes) else { return Ok(()) };
    let (key, remedy) = match &scene.body {
        _ if needed < 2.0 * steps => ("phase", "take fewer steps"),
        Body::Layer(layer) if outline.is_in_space() && !layer.is_periodic() => (
            "layer.cells",
            "take fewer cells, or sides that are periodic along x and y, which need no factor of the body",
        ),
        Body::Layer(_) => ("layer.cells", "take fewer cells"),
        Body::Mesh(_) => ("mesh.file", "take fewer cells"),
    };
    let reason = format!(
        "needs about {:.3} GB more memory, and {} leaves {:.3} GB; {remedy}, or raise that",
        needed / 1e9,
        found.bound,
        found.bytes.max(0.0) / 1e9
    );
    Err(Error::scene(file, key, reason))
}
