//! What a scene costs, before it is solved; and whether its memory can be had.

use std::path::Path;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::{Form, Outline, form};
use crate::error::{Error, Result};
use crate::loading::Target;
use crate::memory;
use crate::parallel::agree;
use crate::scene::{Body, Scene};

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
        let face = 2.0 * (outline.face.edges + 1) as f64;
        let newton = 3.0;
        // Nested dissection in the plane: n^1.5 operations, n log n entries; about half of both when symmetric.
        let entries = |symmetry: f64| 8.0 * 5.0 * unknowns * unknowns.max(2.0).log2() * symmetry;
        let (matrix, vector) = (18.0 * 12.0 * unknowns, 8.0 * unknowns);
        let arms = (scene.materials.iter().map(|material| material.arms.len()).sum::<usize>() + 4) as f64;
        // Half of the face in contact: a small dense factorisation and some products with the compliance.
        let contact = newton * (2e-10 * (face / 2.0).powi(3).min(face.powi(2) * 300.0) + 3e-9 * face * face);
        let solve = 3e-7 * unknowns * (1.0 + 0.05 * unknowns.max(2.0).log2());
        let by_wave = scene.period().is_some();
        let compliance = if by_wave { 0.0 } else { 8.0 * face * face };
        let (step, memory) = match form(scene) {
            Form::Monolithic => (
                newton * (2.0 * solve + 1.0e-7 * unknowns) + contact,
                8.0 * face * face + entries(0.6) + 4.0 * matrix + arms * vector,
            ),
            Form::Following if by_wave => (contact, 80.0 * unknowns),
            Form::Following => (contact, compliance + entries(0.6) + 3.0 * matrix),
            Form::Remembering if by_wave => {
                (contact + 3e-8 * unknowns * arms, (12.0 + arms) * vector + 80.0 * unknowns)
            }
            Form::Remembering => (contact + 2.0 * solve, compliance + entries(0.6) + 3.0 * matrix + arms * vector),
        };
        Self { step, memory: PROGRAM + memory }
    }
}

/// Refuses a scene that needs more memory than can be had: some libraries that get none try for ever. Collective.
///
/// The first rank has the interior of a condensed problem alone; all ranks share one system of all unknowns.
pub(super) fn fits(comm: &SimpleCommunicator, scene: &Scene, file: &Path, outline: &Outline) -> Result<()> {
    let share = if form(scene) == Form::Monolithic { f64::from(comm.size()) } else { 1.0 };
    let steps = size_of::<Target>() as f64 * scene.steps() as f64;
    let needed = (Estimate::of(scene, outline).memory - PROGRAM) / share + steps;
    let mine = match memory::available().filter(|_| comm.rank() == 0) {
        Some(found) if needed > found.bytes => {
            let (key, remedy) = match scene.body {
                _ if needed < 2.0 * steps => ("phase", "take fewer steps"),
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
        _ => Ok(()),
    };
    agree(comm, mine)
}
