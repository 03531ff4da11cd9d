//! What a scene costs, before it is solved; and whether its memory can be had.

use std::path::Path;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::{Form, Outline, form, means, shares_face};
use crate::error::{Error, Result};
use crate::loading::Target;
use crate::memory;
use crate::parallel::agree;
use crate::scene::{Body, Layer, Scene};
use crate::solve::Means;

/// What the program and its libraries take before they do anything, bytes.
const PROGRAM: f64 = 5.7e7;
/// Per node of a periodic face in space, with friction and without: the points and their states, what of a step is tried, GMRES; and for
/// each arm. Measured with 128, 256 and 512 nodes a side; those below with 128.
const FACE_NODE: [f64; 2] = [1650.0, 1550.0];
const FACE_ARM: f64 = 30.0;
/// Per node of a periodic layer in space whose interior has a memory: its elimination at two step lengths, and what is beside the arms;
/// for each part that relaxes by itself; for each arm.
const WAVE_NODE: f64 = 330.0;
const WAVE_PART: f64 = 72.0;
const WAVE_ARM: f64 = 24.5;
/// s per step and node of such a face with friction and without, and per step and node of such a layer.
const FACE_STEP: [f64; 2] = [4e-6, 1.5e-6];
const WAVE_STEP: f64 = 5e-8;
/// s per cube of the components of a face, for its dense compliance.
const FACE_INVERSE: f64 = 4e-11;
/// Multigrid: what it takes of a matrix, beside that; s per unknown for a solve on average, and for a Newton step of all unknowns. Measured on
/// blocks of 5,000 to 53,000 unknowns.
const MULTIGRID: f64 = 2.0;
const MULTIGRID_SOLVE: f64 = 8e-6;
const MULTIGRID_STEP: f64 = 4e-5;
/// A factor without the complement of the face, over one with it: measured on the same blocks.
const BARE_FACTOR: f64 = 0.6;
/// Where C is known by its products: bytes per component of the face, and products per Newton step.
const FACE_COMPONENT: f64 = 2000.0;
const PRODUCTS: f64 = 8.0;
/// The most components of a face whose arms follow the temperature.
const MOST_COUPLED: usize = 4096;
/// What an index of PETSc counts.
const MOST: f64 = i32::MAX as f64;

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
        let means = means(scene, outline).map_or(Means::Dense, |chosen| chosen.means);
        Self::by(scene, outline, means)
    }

    /// The same where the body is solved for in this way.
    pub fn by(scene: &Scene, outline: &Outline, means: Means) -> Self {
        if let Some(layer) = scene.layer().filter(|layer| by_transforms(scene, layer)) {
            return Self::of_waves(scene, layer);
        }
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
        let periodic = scene.layer().is_some_and(Layer::is_periodic);
        let by_wave = periodic && form(scene) != Form::Coupled;
        // Of a periodic layer in space transforms of the face, else products with the whole compliance.
        let contact = match by_wave && outline.is_in_space() {
            true => 20.0 * newton * 1e-7 * face,
            false => contact,
        };
        // While it is made there are three of it beside the factor's own.
        let compliance = if outline.is_in_space() { 32.0 } else { 8.0 } * face * face;
        // A factor is kept for the step lengths of two phases.
        let kept = if scene.phases.len() > 1 && outline.is_in_space() { 2.0 } else { 1.0 };
        // Beside the matrix; of each product with C.
        let (held, solve) = match means {
            Means::Multigrid => (MULTIGRID * matrix, MULTIGRID_SOLVE * unknowns),
            Means::Factor | Means::Dense => (BARE_FACTOR * fill.memory, BARE_FACTOR * fill.solve),
        };
        let products = PRODUCTS * newton;
        let (step, memory) = match form(scene) {
            Form::Monolithic if means == Means::Multigrid => {
                (newton * MULTIGRID_STEP * unknowns, (MULTIGRID + 1.5) * matrix + arms * vector)
            }
            Form::Monolithic => (
                newton * (2.0 * fill.solve + 1.0e-7 * unknowns) + contact,
                8.0 * face * face + fill.memory + 4.0 * matrix + arms * vector,
            ),
            Form::FaceMemory if by_wave && outline.is_in_space() => (contact, 1e3 * face),
            Form::FaceMemory if by_wave => (contact, 80.0 * unknowns),
            Form::FaceMemory if means != Means::Dense => {
                (products * solve, held + FACE_COMPONENT * face + 2.0 * matrix + 8.0 * vector)
            }
            Form::FaceMemory => (contact, compliance + fill.memory + 3.0 * matrix),
            Form::BulkMemory if by_wave => (contact + 3e-8 * unknowns * arms, (12.0 + arms) * vector + 80.0 * unknowns),
            // Each step makes one anew; arms are at the corners of each cell.
            Form::Coupled => (
                contact + 2.0 * fill.solve + fill.factor + FACE_INVERSE * face.powi(3),
                compliance + fill.memory + 3.0 * matrix + 2.0_f64.powf(axes) * arms * vector,
            ),
            Form::BulkMemory if means != Means::Dense => {
                ((products + 2.0) * solve, kept * held + FACE_COMPONENT * face + 3.0 * matrix + (8.0 + arms) * vector)
            }
            Form::BulkMemory => {
                (contact + 2.0 * fill.solve, kept * (compliance + fill.memory) + 3.0 * matrix + arms * vector)
            }
        };
        // One component, with a factor or a chain of its own.
        let [more_step, more_memory] = match (&scene.heat, periodic) {
            (None, _) => [0.0; 2],
            (Some(_), true) => [6e-8 * unknowns / axes, 60.0 * unknowns / axes],
            (Some(_), false) => {
                [fill.solve / axes, (fill.memory + compliance) / (axes * axes) + 3.0 * matrix / (axes * axes)]
            }
        };
        Self { step: step + more_step, memory: PROGRAM + memory + more_memory }
    }

    /// Of a periodic layer in space.
    fn of_waves(scene: &Scene, layer: &Layer) -> Self {
        let (nodes, rows) = (layer.face_nodes() as f64, layer.rows as f64);
        let arms =
            scene.materials.iter().map(|material| material.arms.len() + material.bulk_arms.len()).sum::<usize>() as f64;
        let (step, node) = match scene.friction {
            Some(_) => (FACE_STEP[0], FACE_NODE[0]),
            None => (FACE_STEP[1], FACE_NODE[1]),
        };
        match form(scene) {
            Form::FaceMemory | Form::Monolithic => {
                Self { step: step * nodes, memory: PROGRAM + nodes * (node + FACE_ARM * arms) }
            }
            Form::BulkMemory | Form::Coupled => {
                // The shear and the bulk of each material.
                let parts = 2.0 * scene.materials.len() as f64;
                let of_row = WAVE_NODE + WAVE_PART * parts + WAVE_ARM * arms;
                Self { step: nodes * (step + WAVE_STEP * rows), memory: PROGRAM + nodes * (node + of_row * rows) }
            }
        }
    }
}

/// Whether a layer in space is solved by transforms of its face.
fn by_transforms(scene: &Scene, layer: &Layer) -> bool {
    layer.spans.len() == 2 && layer.is_periodic() && !matches!(form(scene), Form::Monolithic | Form::Coupled)
}

/// Refuses what PETSc's 32-bit indices do not count: unknowns, and what a sparse system on one rank has of entries.
pub fn countable(scene: &Scene, file: &Path) -> Result<()> {
    let Some(layer) = scene.layer() else { return Ok(()) };
    let dimensions = (layer.spans.len() + 1) as f64;
    let face = dimensions * layer.face_nodes() as f64;
    let body = face * (layer.rows as f64 + 1.0);
    let entries = body * dimensions * 3.0_f64.powf(dimensions);
    let waves = !matches!(form(scene), Form::Monolithic | Form::Coupled);
    let (what, count) = match layer.is_periodic() && waves {
        true if scene.output.bulk_at.is_empty() => ("unknowns of the face", face),
        true => ("displacements, of which output.bulk_at makes a mesh", body),
        false => ("entries of the stiffness", entries),
    };
    if count <= MOST {
        return Ok(());
    }
    let reason = format!("{count:.3e} {what}, and PETSc's 32-bit indices count {MOST:.3e}; take fewer cells");
    Err(Error::scene(file, "layer.cells", reason))
}

/// What a sparse factor costs.
struct Fill {
    /// bytes
    memory: f64,
    /// s for one solve
    solve: f64,
    /// s for one factorisation, with what is ordered for it
    factor: f64,
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
        let factor = if in_space { 25.0 * solve } else { 5e-6 * unknowns };
        Self { memory, solve, factor }
    }
}

/// Refuses a scene that needs more memory than can be had: some libraries that get none try for ever. Collective.
pub(super) fn fits(comm: &SimpleCommunicator, scene: &Scene, file: &Path, outline: &Outline) -> Result<()> {
    countable(scene, file)?;
    let mine = if comm.rank() == 0 { affordable(scene, file, outline, comm.size() as usize) } else { Ok(()) };
    agree(comm, mine)
}

/// Refuses a face that is too large for a dense compliance in each step: with [`MOST_COUPLED`] components a step takes 8 s, and 0.8 GB.
fn coupled_face(scene: &Scene, file: &Path, outline: &Outline) -> Result<()> {
    let axes = if outline.is_in_space() { 3 } else { 2 };
    let components = axes * outline.face_nodes;
    if form(scene) != Form::Coupled || components <= MOST_COUPLED {
        return Ok(());
    }
    let key = if scene.layer().is_some() { "layer.cells" } else { "mesh.file" };
    let reason = format!(
        "{} nodes of the face, and with heat.coupled = true, which inverts a dense matrix of the face in each step, at most {} are \
         solved for; take fewer cells along the face, or coupled = false",
        outline.face_nodes,
        MOST_COUPLED / axes
    );
    Err(Error::scene(file, key, reason))
}

/// The same for this process, the first of so many ranks.
///
/// The first rank has a condensed problem alone, unless all share its face; all ranks share one system of all unknowns.
///
/// # Errors
/// [`Error::Scene`] with the remedy.
pub fn affordable(scene: &Scene, file: &Path, outline: &Outline, ranks: usize) -> Result<()> {
    coupled_face(scene, file, outline)?;
    let share = if form(scene) == Form::Monolithic || shares_face(scene, ranks) { ranks as f64 } else { 1.0 };
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
