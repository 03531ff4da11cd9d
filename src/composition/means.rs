//! Whether a body is solved for by a dense matrix of its face, by a factor or by multigrid: by size, and by the memory that there is.

use std::ffi::CStr;

use mpi::topology::SimpleCommunicator;

use super::{Estimate, Form, Outline, form};
use crate::error::Result;
use crate::memory;
use crate::parallel::share_numbers;
use crate::petsc;
use crate::scene::{self, Scene};
use crate::solve::Means;

/// Components of a face up to which a dense matrix of it is worth its inversion: of so many 2 GB and some 20 s, which a
/// few steps make good.
pub const MOST_DENSE: usize = 8192;
/// The share of the memory that there is which an estimate may take: address space is taken before it is used, and the estimate is no better.
const MARGIN: f64 = 0.7;
/// Says which is to be taken: a factor, or what else PETSc preconditions conjugate gradients by.
const OPTION: &CStr = c"-body_pc_type";

/// What a choice is made among.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chosen {
    /// What was picked.
    pub means: Means,
    /// Whether a PETSc option says so.
    pub asked: bool,
}

/// How the body of a scene is solved for; none where transforms of the face or small factors do that, so that there is nothing to choose.
pub fn means(scene: &Scene, outline: &Outline) -> Option<Chosen> {
    let available = memory::available().map_or(f64::INFINITY, |found| found.bytes);
    let asked = petsc::option(OPTION);
    choose(scene, outline, (MOST_DENSE, available), asked.as_deref())
}

/// The same where dense matrices are worth it up to so many components, with so many bytes, and for an option's value.
pub fn choose(
    scene: &Scene,
    outline: &Outline,
    (most, available): (usize, f64),
    asked: Option<&str>,
) -> Option<Chosen> {
    let periodic = scene.layer().is_some_and(scene::Layer::is_periodic);
    let fits = |means: Means| Estimate::by(scene, outline, means).memory <= MARGIN * available;
    let picked = |means| Some(Chosen { means, asked: false });
    match form(scene) {
        Form::Monolithic => {
            // The place of an indenter that something holds is eliminated by the factor; in the plane it is small.
            let free = outline.is_in_space() && !scene.is_loaded() && scene.mount.is_none();
            picked(if free && !fits(Means::Factor) { Means::Multigrid } else { Means::Factor })
        }
        Form::Coupled => None,
        Form::FaceMemory | Form::BulkMemory if periodic => None,
        Form::FaceMemory | Form::BulkMemory => match asked {
            Some("cholesky" | "lu") => Some(Chosen { means: Means::Factor, asked: true }),
            Some(_) => Some(Chosen { means: Means::Multigrid, asked: true }),
            None => {
                let axes = if outline.is_in_space() { 3 } else { 2 };
                let dense = axes * outline.face_nodes <= most;
                picked(match [Means::Dense, Means::Factor].map(fits) {
                    [true, _] if dense => Means::Dense,
                    [_, true] => Means::Factor,
                    _ => Means::Multigrid,
                })
            }
        },
    }
}

/// That of all ranks, by what the first one has. Collective.
pub(super) fn shared(comm: &SimpleCommunicator, scene: &Scene, outline: &Outline) -> Result<Means> {
    const ALL: [Means; 3] = [Means::Dense, Means::Factor, Means::Multigrid];
    let mine = || {
        let means = means(scene, outline).map_or(Means::Dense, |chosen| chosen.means);
        Ok(vec![ALL.iter().take_while(|other| **other != means).count() as f64])
    };
    Ok(ALL[(share_numbers(comm, mine)?[0] as usize).min(2)])
}
