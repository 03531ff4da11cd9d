//! How a scene is solved, and what is built for it.

use std::any::Any;
use std::cell::RefCell;
use std::rc::Rc;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::body::Materials;
use super::laws::mounts;
use crate::bulk::Arms;
use crate::error::{Error, Result};
use crate::interface::Interface;
use crate::parallel::{Team, agree};
use crate::petsc::{Integrator, Linear, Matrix, Search, Settings, Vector};
use crate::scene::{self, Scene};
use crate::solve::{
    Body, Bordered, BulkMemory, Compliance, Condensed, Coupled, FaceMemory, Freedom, Interior, LARGE_FACE,
    LARGE_PERIODIC_FACE, Layered, MAX_NEWTON, MAX_NEWTON_OF_JUMPS, Means, Monolithic, PeriodicColumn, Recovery,
    Relaxation, Response, Solid, Sparse, TransientProblem, Way,
};

/// The last elastic compliance on this rank, for the next scene with the same mesh and moduli: in a sweep it is
/// computed once.
#[derive(Default)]
pub struct Compliances {
    /// A solid, and the compliance of its face.
    last: RefCell<Option<Box<dyn Any>>>,
}

impl Compliances {
    fn get<const D: usize>(
        &self,
        solid: &Solid<D>,
        (team, means): (&Team, Means),
        compute: impl FnOnce() -> Result<Compliance<D>>,
    ) -> Result<Rc<Compliance<D>>> {
        let mut last = self.last.borrow_mut();
        let known = last.as_ref().and_then(|last| last.downcast_ref::<(Solid<D>, Rc<Compliance<D>>)>());
        let alike = |known: &Compliance<D>| known.is_parted() == team.is_parted() && known.means() == means;
        let known = known.filter(|(other, known)| other == solid && alike(known));
        // A scene in between may have been one rank's alone.
        let on_all = team.all_say(known.is_some());
        if let Some((_, compliance)) = known.filter(|_| on_all) {
            return Ok(compliance.clone());
        }
        // Frees the old one first.
        *last = None;
        let compliance = Rc::new(compute()?);
        *last = Some(Box::new((solid.clone(), compliance.clone())));
        Ok(compliance)
    }
}

/// A strategy with its unknowns.
pub(super) struct Strategy {
    pub strategy: Box<dyn TransientProblem>,
    pub tangent: Matrix,
    pub u: Vector,
    pub integrator: Integrator,
}

/// How a scene is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// All unknowns.
    Monolithic,
    /// On the face; the interior follows it for all time.
    FaceMemory,
    /// On the face; the interior has a memory of its own.
    BulkMemory,
    /// The same, and each cell has times of its own.
    Coupled,
}

/// How `scene` is solved: on its contact face unless it says otherwise.
pub fn form(scene: &Scene) -> Form {
    match scene.solver.strategy {
        scene::Strategy::Monolithic => Form::Monolithic,
        scene::Strategy::Auto | scene::Strategy::Condensed if scene.is_coupled() => Form::Coupled,
        scene::Strategy::Auto | scene::Strategy::Condensed if Materials::new(scene).relax_alike() => Form::FaceMemory,
        scene::Strategy::Auto | scene::Strategy::Condensed => Form::BulkMemory,
    }
}

pub(super) fn monolithic<const D: usize>(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (solid, materials): (Solid<D>, Materials),
    (interface, means): (Interface<D>, Means),
) -> Result<Strategy> {
    let body = Body::new(comm.duplicate(), &solid)?;
    let u = body.vector()?;
    let bulk = materials.bulk(&body, &u)?;
    let mut tangent = bulk.new_tangent()?;
    tangent.set_near_null_space(&mut body.coordinates()?, D)?;
    if interface.friction().is_none() {
        tangent.declare_positive_definite()?;
    }
    let freedom = freedom::<D>(scene, solid.source.height());
    let held = freedom.unknowns() > 0;
    let parts = (interface, mounts::<D>(scene));
    let mut strategy = Monolithic::new(bulk, body, parts, &u, scene.solver.tolerance)?;
    let linear = match (held, means) {
        (true, _) => Linear::OwnPreconditioned,
        (false, Means::Multigrid) => Linear::Multigrid,
        (false, Means::Factor | Means::Dense) => Linear::Preconditioned,
    };
    let settings = Settings { linear, max_newton: MAX_NEWTON, max_unsolved: 1, search: Search::Least };
    if !held {
        let integrator = Integrator::new(comm, settings, &mut tangent)?;
        if integrator.asks_for_solves()? {
            strategy.starts_from_the_laws();
        }
        return Ok(Strategy { strategy: Box::new(strategy), tangent, u, integrator });
    }
    strategy.starts_from_the_laws();
    let (strategy, u) = Bordered::new(comm, strategy, (tangent, u), freedom)?;
    let mut tangent = Matrix::shell(comm, u.local_len())?;
    let integrator = Integrator::new(comm, settings, &mut tangent)?;
    if !integrator.asks_for_solves()? {
        let reason = "the place of an indenter that a force or a mount holds is eliminated by a solver of its own: leave -pc_type out";
        return Err(Error::Usage(reason.into()));
    }
    Ok(Strategy { strategy: Box::new(strategy), tangent, u, integrator })
}

/// What of the indenter's place may be unknown over a body of a height, m.
fn freedom<const D: usize>(scene: &Scene, height: f64) -> Freedom {
    let mounts = mounts::<D>(scene);
    Freedom { directions: [scene.is_loaded(), mounts[1].is_some(), mounts[2].is_some()], height }
}

pub(super) fn face_memory<const D: usize>(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (solid, materials): (Solid<D>, Materials),
    interface: Interface<D>,
    (compliances, means): (&Compliances, Means),
) -> Result<Strategy> {
    let u = face_vector(comm, &interface)?;
    let team = interface.team();
    let get = || compliances.get(&solid, (team, means), || compliance(&solid, (team, means))).map(Some);
    let compliance = agree(comm, if comm.rank() == 0 || team.is_parted() { get() } else { Ok(None) })?;
    let Materials { series, times, memory, .. } = materials;
    let relaxation = match series.into_iter().next().flatten() {
        Some(series) => Some(Relaxation { arms: Arms::new(times, memory, &u)?, series }),
        None => None,
    };
    let column = PeriodicColumn::new(&solid);
    let height = solid.source.height();
    let recovery = Recovery::new(comm, solid, (column, means));
    let backing = FaceMemory { compliance, relaxation, recovery, secant: 1.0, account: None };
    condensed(comm, scene, (u, height), (interface, backing, means))
}

pub(super) fn bulk_memory<const D: usize>(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (solid, materials): (Solid<D>, Materials),
    (interface, means): (Interface<D>, Means),
) -> Result<Strategy> {
    let team = interface.team();
    let here = comm.rank() == 0 || team.is_parted();
    let make = || match scene.is_coupled() {
        true => coupled(scene, &solid, materials),
        false => inside(&solid, materials, (team, means)),
    };
    let inside = if here { make().map(Some) } else { Ok(None) };
    let backing = BulkMemory::new(comm, agree(comm, inside)?);
    let u = face_vector(comm, &interface)?;
    condensed(comm, scene, (u, solid.source.height()), (interface, backing, means))
}

fn condensed<const D: usize, R: Response<D> + 'static>(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (u, height): (Vector, f64),
    (interface, response, means): (Interface<D>, R, Means),
) -> Result<Strategy> {
    // Where each cell has times of its own a period has no waves.
    let periodic = scene.layer().is_some_and(scene::Layer::is_periodic) && !scene.is_coupled();
    let components = D * interface.nodes_everywhere();
    let mounts = mounts::<D>(scene);
    let freedom = freedom::<D>(scene, height);
    let points = interface.points();
    // Pressures alone do not pull.
    let alone = interface.is_normal_alone() && !points.share_nodes() && interface.adhesion().is_none();
    let way = match alone && periodic && components > LARGE_FACE && freedom.unknowns() == 0 {
        true => Way::Pressures,
        false if means != Means::Dense => Way::Products,
        false => Way::Newton,
    };
    let linear = match components > if periodic { LARGE_PERIODIC_FACE } else { LARGE_FACE } {
        _ if way == Way::Pressures => Linear::Own,
        _ if way == Way::Products => Linear::OwnIterative(1e-2),
        true if periodic && !points.share_nodes() => Linear::Own,
        // Where a product costs next to nothing, Newton's method need not wait for exact steps; a step from a guess that is a hundredth off
        // should end below its tolerance.
        true if components <= LARGE_FACE => Linear::OwnIterative(1e-7),
        // Most steps of Newton's method end at a kink of the laws: until the last ones, half of the way is as good as all of it.
        true if periodic => Linear::OwnIterative(0.5),
        true => Linear::OwnIterative(1e-2),
        false => Linear::Own,
    };
    // The tractions of the points, on the ranks that have them; the place of the indenter on the first.
    let points = if u.local_len() > 0 { points.count() } else { 0 };
    let last = if comm.rank() == 0 { freedom.unknowns() } else { 0 };
    let tractions = Vector::new(comm, D * points + last)?;
    let mut tangent = Matrix::shell(comm, tractions.local_len())?;
    // A contact that may jump has no system worth solving where it does.
    let (max_newton, max_unsolved) = match interface.adhesion() {
        Some(_) => (MAX_NEWTON_OF_JUMPS, MAX_NEWTON_OF_JUMPS),
        None => (MAX_NEWTON, 1),
    };
    let settings = Settings { linear, max_newton, max_unsolved, search: Search::Own };
    let integrator = Integrator::new(comm, settings, &mut tangent)?;
    let told = (scene.solver.tolerance, freedom, way);
    let strategy = Box::new(Condensed::new(comm, (interface, mounts), response, &u, told)?);
    Ok(Strategy { strategy, tangent, u: tractions, integrator })
}

/// The components of each face node, on rank 0 or on the rank that has it.
fn face_vector<const D: usize>(comm: &SimpleCommunicator, interface: &Interface<D>) -> Result<Vector> {
    let here = comm.rank() == 0 || interface.team().is_parted();
    Vector::new(comm, if here { D * interface.face().count() } else { 0 })
}

/// The compliance of the face, by the ranks that share it.
fn compliance<const D: usize>(solid: &Solid<D>, (team, means): (&Rc<Team>, Means)) -> Result<Compliance<D>> {
    if let Some(column) = PeriodicColumn::new(solid) {
        return column.compliance(team);
    }
    let body = Body::new(SimpleCommunicator::self_comm(), solid)?;
    if means == Means::Dense {
        return Compliance::by_schur_complement(&body);
    }
    let mut stiffness = body.elastic()?;
    stiffness.declare_positive_definite()?;
    Compliance::by_solves(&body, &stiffness, (means, Rc::default()))
}

/// The whole body with its memory, on this rank alone, or its waves on the ranks that share them.
fn inside<const D: usize>(
    solid: &Solid<D>,
    materials: Materials,
    (team, means): (&Rc<Team>, Means),
) -> Result<Box<dyn Interior<D>>> {
    if let Some(column) = PeriodicColumn::new(solid) {
        return Ok(Box::new(Layered::new(solid.clone(), &column, materials.relaxations(), team)));
    }
    let body = Body::new(SimpleCommunicator::self_comm(), solid)?;
    let bulk = materials.bulk(&body, &body.vector()?)?;
    Ok(Box::new(Sparse::new(bulk, body, means)?))
}

/// The same where each cell has its own temperature.
fn coupled<const D: usize>(scene: &Scene, solid: &Solid<D>, materials: Materials) -> Result<Box<dyn Interior<D>>> {
    let shifts = scene.materials.iter().map(|material| material.shift.map(scene::Shifting::law)).collect();
    let body = Body::new(SimpleCommunicator::self_comm(), solid)?;
    Ok(Box::new(Coupled::new(solid, body, materials.relaxations(), shifts)?))
}
