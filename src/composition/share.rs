//! Whether the ranks share the face of a scene, or one of them has it all.

use std::rc::Rc;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::{Form, form};
use crate::parallel::Team;
use crate::scene::{Quadrature, Scene};
use crate::solve::LARGE_FACE;

/// Lines of nodes to a rank at least.
const LEAST_LINES: usize = 2;

/// Lines and columns of nodes of a face that so many ranks share: of a large periodic one in space, which is solved by transforms alone.
///
/// Heat is conducted by one rank, which has to have the whole face, and the jumps of an adhesive one are followed by one.
fn lines(scene: &Scene, ranks: usize) -> Option<[usize; 2]> {
    let layer = scene.layer().filter(|layer| layer.is_periodic())?;
    let [lines, columns] = layer.spans.iter().map(|span| span.cells).collect::<Vec<_>>().try_into().ok()?;
    let suits = form(scene) != Form::Monolithic
        && scene.heat.is_none()
        && scene.adhesion.is_none()
        && scene.contact.quadrature == Quadrature::Nodal
        && 3 * lines * columns > LARGE_FACE;
    (ranks > 1 && suits && lines >= LEAST_LINES * ranks).then_some([lines, columns])
}

/// Whether so many ranks would share the face.
pub fn shares_face(scene: &Scene, ranks: usize) -> bool {
    lines(scene, ranks).is_some()
}

/// The ranks that share the face: all of `comm`, or each by itself, of which the first solves. Collective.
pub(super) fn team(comm: &SimpleCommunicator, scene: &Scene) -> Rc<Team> {
    lines(scene, comm.size() as usize).map_or_else(Team::alone, |lines| Team::of(comm, lines))
}
