//! The composition root: the one place that matches on what a scene asks for and builds the parts for it.

mod body;
mod cohesive;
mod estimate;
mod inputs;
mod map;
mod outline;
mod pressed;
mod profile;
mod share;
mod steady;
mod surface;

use std::any::Any;
use std::cell::RefCell;
use std::collections::HashSet;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use nalgebra::Vector2;

use crate::adhesion::{self, Bilinear, Dugdale, Exponential};
use crate::bulk::Arms;
use crate::element::mpjr::Quadrature;
use crate::error::{Error, Result};
use crate::friction::{Coefficient, Coulomb, CoulombTanh, ElasticSlip, Law, Strength};
use crate::interface::{Interface, Laws};
use crate::loading::{self, Adaptive, DIRECTIONS, Moment, Motion, Mount, Phase, Placement, Track};
use crate::mesh::Source;
use crate::parallel::{Team, agree, share_numbers};
use crate::petsc::{Integrator, Linear, Matrix, Search, Settings, Vector};
use crate::profile::{Extruded, Profile, Surface};
use crate::scene::{self, Scene, Stepping, When};
use crate::solve::{
    Body, Bordered, Compliance, Condensed, Convection, Coupled, Following, Freedom, Heat, Heated, Inside, Interior,
    LARGE_FACE, LARGE_PERIODIC_FACE, Layered, MAX_NEWTON, MAX_NEWTON_OF_JUMPS, Medium, Monolithic, PeriodicColumn,
    Relaxation, Remembering, Response, Solid, Sparse, TransientProblem, Way,
};
use crate::wear::{self, Wear};

use body::Materials;
pub use body::Meshed;
pub use cohesive::{cohesive, cohesive_zone};
pub use estimate::{Estimate, affordable, countable};
pub use inputs::inputs;
pub use outline::{Outline, Stretch, outline};
pub use pressed::PressedEnd;
pub use profile::{Elevations, Finest, Shape, elevations, measured, reach, seam_doubt, shape};
pub use share::shares_face;
pub use steady::{heading, last_velocity, steady};

/// A scene made ready to run.
pub struct Problem {
    /// The discretised problem, in the form that the scene's strategy gives it.
    pub strategy: Box<dyn TransientProblem>,
    /// Its tangent.
    pub tangent: Matrix,
    /// Its solution, at rest.
    pub u: Vector,
    /// The loading history.
    pub phases: Vec<Phase>,
    /// TS and SNES, ready to solve it.
    pub integrator: Integrator,
    /// The body's mesh, for output.
    pub mesh: Meshed,
}

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
        team: &Team,
        compute: impl FnOnce() -> Result<Compliance<D>>,
    ) -> Result<Rc<Compliance<D>>> {
        let mut last = self.last.borrow_mut();
        let known = last.as_ref().and_then(|last| last.downcast_ref::<(Solid<D>, Rc<Compliance<D>>)>());
        let known = known.filter(|(other, known)| other == solid && known.is_parted() == team.is_parted());
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

/// The body and the indenter of a scene, read and checked: all that it may be refused for.
pub struct Parts {
    /// The body's mesh.
    pub mesh: Meshed,
    /// The indenter's profile.
    pub shape: Shape,
}

/// What `scene`, which was read from `file`, is made of, on every rank of `comm`. What it needs of other files is read by
/// one of them. Collective.
pub fn prepare(comm: &SimpleCommunicator, scene: &Scene, file: &Path) -> Result<Parts> {
    let elevations = share_numbers(comm, || elevations(scene, file))?;
    if scene.layer().is_some() {
        // A layer's outline is known before its mesh, which takes memory itself.
        let outline = outline(scene, file)?;
        cohesive(scene, file, &outline)?;
        estimate::fits(comm, scene, file, &outline)?;
    }
    let mesh = body::mesh(comm, scene, file)?;
    if scene.layer().is_none() {
        let outline = Outline::of(scene, &mesh);
        cohesive(scene, file, &outline)?;
        estimate::fits(comm, scene, file, &outline)?;
    }
    let shape = shape(scene, file, &elevations, &Outline::of(scene, &mesh))?;
    Ok(Parts { mesh, shape })
}

/// As [`prepare`], with the bytes of the .msh file that the scene names, on every rank, instead of the file.
pub fn prepare_on_mesh(scene: &Scene, bytes: &[u8]) -> Result<Parts> {
    let mesh = body::mesh_of(bytes, scene)?;
    let shape = shape(scene, Path::new(""), &[], &Outline::of(scene, &mesh))?;
    Ok(Parts { mesh, shape })
}

/// Builds what `scene`, which was read from `file`, asks for, distributed over `comm`.
pub fn build(comm: &SimpleCommunicator, scene: &Scene, file: &Path) -> Result<Problem> {
    let Parts { mesh, shape } = prepare(comm, scene, file)?;
    assemble(comm, scene, (mesh, shape.surface), &Compliances::default())
}

/// As [`build`], with another profile than the scene's.
pub fn build_with_profile(comm: &SimpleCommunicator, scene: &Scene, profile: Box<dyn Profile>) -> Result<Problem> {
    let surface = Rc::new(Extruded(profile));
    assemble(comm, scene, (body::mesh(comm, scene, Path::new(""))?, surface), &Compliances::default())
}

/// Makes a problem of the scene's mesh and profile, with what scenes before this one had computed.
pub fn assemble(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (mesh, surface): (Meshed, Rc<dyn Surface>),
    compliances: &Compliances,
) -> Result<Problem> {
    let (strategy, phases) = match mesh.clone() {
        Meshed::Plane(source) => assembled(comm, scene, (source, surface), compliances)?,
        Meshed::Space(source) => assembled(comm, scene, (source, surface), compliances)?,
    };
    let Strategy { strategy, tangent, u, integrator } = strategy;
    Ok(Problem { strategy, tangent, u, phases, integrator, mesh })
}

/// A strategy with its unknowns.
struct Strategy {
    strategy: Box<dyn TransientProblem>,
    tangent: Matrix,
    u: Vector,
    integrator: Integrator,
}

/// The strategy of a scene in D dimensions, and the phases that it goes through.
fn assembled<const D: usize>(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (source, surface): (Source<D>, Rc<dyn Surface>),
    compliances: &Compliances,
) -> Result<(Strategy, Vec<Phase>)> {
    let materials = Materials::new(scene);
    let bond = scene.adhesion.map(|adhesion| adhesion.friction);
    let friction = scene.friction.as_ref().map(|law| friction(law, bond)).transpose()?;
    let (penalty, wear) = (body::penalty(scene, &source), scene.wear.map(wearing));
    let adhesion = scene.adhesion.map(adhering);
    let laws = Laws { profile: Box::new(surface), penalty, friction, wear, adhesion };
    let mut interface = Interface::new(source.face(), laws, quadrature(scene.contact.quadrature));
    let solid = Solid { source, dilatation: body::dilatation(scene), regions: materials.regions.clone() };
    interface = interface.among(&share::team(comm, scene));
    let clearance = clearance(scene, &mut interface)?;
    if scene.adhesion.is_some() {
        interface.measure_gaps()?;
    }
    let heated = scene.heat.as_ref().map(|heat| (heat_of(scene, heat, &materials), solid.clone()));
    let mut problem = match form(scene) {
        Form::Monolithic => monolithic(comm, scene, (solid, materials), interface)?,
        Form::Following => following(comm, scene, (solid, materials), interface, compliances)?,
        Form::Remembering | Form::Coupled => remembering(comm, scene, (solid, materials), interface)?,
    };
    let phases = phases(scene, penetration(scene, problem.strategy.as_mut(), clearance)?);
    if let Some((heat, solid)) = heated {
        problem.strategy = Box::new(Heated::new(comm, problem.strategy, &solid, heat)?);
    }
    if scene.output.energy {
        problem.strategy.keep_account(&problem.u)?;
    }
    Ok((problem, phases))
}

/// How a scene is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// All unknowns.
    Monolithic,
    /// On the face; the interior follows it for all time.
    Following,
    /// On the face; the interior has a memory of its own.
    Remembering,
    /// The same, and each cell has times of its own.
    Coupled,
}

/// How `scene` is solved: on its contact face unless it says otherwise.
pub fn form(scene: &Scene) -> Form {
    match scene.solver.strategy {
        scene::Strategy::Monolithic => Form::Monolithic,
        scene::Strategy::Auto | scene::Strategy::Condensed if scene.is_coupled() => Form::Coupled,
        scene::Strategy::Auto | scene::Strategy::Condensed if Materials::new(scene).relax_alike() => Form::Following,
        scene::Strategy::Auto | scene::Strategy::Condensed => Form::Remembering,
    }
}

fn monolithic<const D: usize>(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (solid, materials): (Solid<D>, Materials),
    interface: Interface<D>,
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
    let linear = if held { Linear::OwnPreconditioned } else { Linear::Preconditioned };
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

fn following<const D: usize>(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (solid, materials): (Solid<D>, Materials),
    interface: Interface<D>,
    compliances: &Compliances,
) -> Result<Strategy> {
    let u = face_vector(comm, &interface)?;
    let team = interface.team();
    let get = || compliances.get(&solid, team, || compliance(&solid, team)).map(Some);
    let compliance = agree(comm, if comm.rank() == 0 || team.is_parted() { get() } else { Ok(None) })?;
    let Materials { series, times, memory, .. } = materials;
    let relaxation = match series.into_iter().next().flatten() {
        Some(series) => Some(Relaxation { arms: Arms::new(times, memory, &u)?, series }),
        None => None,
    };
    let column = PeriodicColumn::new(&solid);
    let height = solid.source.height();
    let interior = Interior::new(comm, solid, column);
    let backing = Following { compliance, relaxation, interior, secant: 1.0, account: None };
    condensed(comm, scene, (u, height), (interface, backing))
}

fn remembering<const D: usize>(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (solid, materials): (Solid<D>, Materials),
    interface: Interface<D>,
) -> Result<Strategy> {
    let team = interface.team();
    let here = comm.rank() == 0 || team.is_parted();
    let make = || match scene.is_coupled() {
        true => coupled(scene, &solid, materials),
        false => inside(&solid, materials, team),
    };
    let inside = if here { make().map(Some) } else { Ok(None) };
    let backing = Remembering::new(comm, agree(comm, inside)?);
    let u = face_vector(comm, &interface)?;
    condensed(comm, scene, (u, solid.source.height()), (interface, backing))
}

fn condensed<const D: usize, R: Response<D> + 'static>(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (u, height): (Vector, f64),
    (interface, response): (Interface<D>, R),
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
        false => Way::Newton,
    };
    let linear = match components > if periodic { LARGE_PERIODIC_FACE } else { LARGE_FACE } {
        _ if way == Way::Pressures => Linear::Own,
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
fn compliance<const D: usize>(solid: &Solid<D>, team: &Rc<Team>) -> Result<Compliance<D>> {
    match PeriodicColumn::new(solid) {
        Some(column) => column.compliance(team),
        None => Compliance::by_schur_complement(&Body::new(SimpleCommunicator::self_comm(), solid)?),
    }
}

/// The whole body with its memory, on this rank alone, or its waves on the ranks that share them.
fn inside<const D: usize>(solid: &Solid<D>, materials: Materials, team: &Rc<Team>) -> Result<Box<dyn Inside<D>>> {
    if let Some(column) = PeriodicColumn::new(solid) {
        return Ok(Box::new(Layered::new(solid.clone(), &column, materials.relaxations(), team)));
    }
    let body = Body::new(SimpleCommunicator::self_comm(), solid)?;
    let bulk = materials.bulk(&body, &body.vector()?)?;
    Ok(Box::new(Sparse::new(bulk, body)?))
}

/// The same where each cell has its own temperature.
fn coupled<const D: usize>(scene: &Scene, solid: &Solid<D>, materials: Materials) -> Result<Box<dyn Inside<D>>> {
    let shifts = scene.materials.iter().map(|material| material.shift.map(scene::Shifting::law)).collect();
    let body = Body::new(SimpleCommunicator::self_comm(), solid)?;
    Ok(Box::new(Coupled::new(solid, body, materials.relaxations(), shifts)?))
}

/// What is asked of the heat. Materials without numbers for it were refused.
fn heat_of(scene: &Scene, heat: &scene::Heat, materials: &Materials) -> Heat {
    let medium = |material: &scene::Material| Medium {
        conductivity: material.conductivity.unwrap_or(f64::NAN),
        capacity: material.heat_capacity.unwrap_or(f64::NAN),
    };
    let convection =
        |&scene::Convection { coefficient, temperature }: &scene::Convection| Convection { coefficient, temperature };
    Heat {
        media: scene.materials.iter().map(medium).collect(),
        initial: heat.initial,
        base: heat.base.temperature(),
        convection: heat.convection.as_ref().map(convection),
        share: heat.share,
        arms: heat.arms.then(|| materials.relaxations()),
        coupled: heat.coupled,
    }
}

fn friction(friction: &scene::Friction, bond: Option<scene::Bond>) -> Result<Box<dyn Law>> {
    let coefficient = match &friction.coefficient {
        scene::Coefficient::Number(number) => Coefficient::Constant(*number),
        scene::Coefficient::Formula(formula) => {
            // It was read before.
            let expression = friction.expression(formula).map_err(|fault| Error::Internal(fault.to_string()))?;
            Coefficient::Formula(Arc::new(expression))
        }
    };
    let bond = match bond {
        Some(scene::Bond::ShearStrength(strength)) => strength,
        Some(scene::Bond::None) | None => 0.0,
    };
    let strength = Strength::new(coefficient, friction.shear_limit).bonded(bond);
    Ok(match friction.law {
        scene::Law::CoulombTanh { regularisation } => Box::new(CoulombTanh { strength, regularisation }),
        scene::Law::CoulombElasticSlip { elastic_slip } => Box::new(ElasticSlip { strength, elastic_slip }),
        scene::Law::Coulomb => Box::new(Coulomb { strength }),
    })
}

fn adhering(adhesion: scene::Adhesion) -> Box<dyn adhesion::Law> {
    let scene::Adhesion { law, work, range, .. } = adhesion;
    match law {
        scene::AdhesionLaw::Exponential => Box::new(Exponential { work, range }),
        scene::AdhesionLaw::Bilinear => Box::new(Bilinear { work, range }),
        scene::AdhesionLaw::Dugdale => Box::new(Dugdale { work, range }),
    }
}

fn wearing(wear: scene::Wear) -> Wear {
    let law = match wear.law {
        scene::WearLaw::Archard => wear::Law::Archard,
        scene::WearLaw::Energy => wear::Law::Energy,
    };
    let of = match wear.of {
        scene::Wearing::Body => wear::Part::Body,
        scene::Wearing::Indenter => wear::Part::Indenter,
    };
    Wear { of, law, coefficient: wear.coefficient }
}

/// Of each direction that there is; the tangential one is the same along x and y.
fn mounts<const D: usize>(scene: &Scene) -> [Option<Mount>; DIRECTIONS] {
    let mount = |end: scene::MountEnd| {
        let scene::MountEnd { stiffness, damping, mass, load } = end;
        Mount { stiffness, damping, mass, load: load.unwrap_or(0.0) }
    };
    let [normal, tangential] = scene.mount.map_or([None; 2], |mount| mount.directions()).map(|end| end.map(mount));
    [normal, tangential, tangential.filter(|_| D > 2)]
}

fn quadrature(quadrature: scene::Quadrature) -> Quadrature {
    match quadrature {
        scene::Quadrature::Nodal => Quadrature::Nodal,
        scene::Quadrature::Gauss => Quadrature::Gauss,
    }
}

/// The gap to close before the indenter touches the face at rest, m; only for scenes with adaptive steps.
fn clearance<const D: usize>(scene: &Scene, interface: &mut Interface<D>) -> Result<f64> {
    if !scene.is_adaptive() {
        return Ok(0.0);
    }
    interface.place(Placement::default())?;
    let points = interface.points().all().iter().enumerate();
    let gaps = points.map(|(i, point)| interface.clearance(i, 0.0) * point.normal[D - 1]);
    Ok(interface.team().least(gaps.fold(f64::INFINITY, f64::min)))
}

/// The greatest penetration of the undeformed face that a history asks for, m, by approaches, by forces or on a mount; only for scenes with adaptive
/// steps. The indenter touches after an approach by `clearance`, m.
fn penetration(scene: &Scene, strategy: &mut dyn TransientProblem, clearance: f64) -> Result<f64> {
    let (force, place) = scene.mounted().unwrap_or((scene.greatest_force(), scene.deepest()));
    let pressed = match scene.is_adaptive() && force > 0.0 {
        true => Some(strategy.approach_under(force, scene.duration())?),
        false => None,
    };
    // A mount brings the indenter no deeper than its force presses it, nor than its far end goes.
    let reached = if scene.mounted().is_some() { f64::min } else { f64::max };
    let deepest = pressed.map_or(place, |pressed| reached(place, pressed)) - clearance;
    // What never touches, or just so, is given its way of getting there.
    Ok(if deepest > 0.0 { deepest } else { clearance.abs().max(1e-200) })
}

/// The phases end to end, each from where the one before left the indenter, without their steps.
pub fn course(scene: &Scene) -> Vec<Phase> {
    let (mut start, mut approach, mut sliding, mut held) = (0.0, 0.0, Vector2::zeros(), None);
    let mut list = Vec::with_capacity(scene.phases.len());
    for phase in &scene.phases {
        let pressed = phase.record().and_then(|record| track(record, &record.normal_force));
        let lowered = phase.record().and_then(|record| track(record, &record.approach));
        let end = |track: &Option<Track<f64>>, from: f64| track.as_ref().map(|track| track.at(from, phase.duration));
        let from = held.unwrap_or(0.0);
        let said = (phase.normal_force.or(end(&pressed, from)), phase.approach.or(end(&lowered, approach)));
        let force = match said {
            (Some(force), _) => Some([from, force]),
            (None, Some(_)) => None,
            (None, None) => held.map(|force| [force, force]),
        };
        // Nobody knows where a force leaves the indenter, nor with what force an approach does.
        let from_there = !list.is_empty() && (held.is_some() || force.is_some());
        held = force.map(|[_, force]| force);
        let to = said.1.unwrap_or(approach);
        let motion = match &phase.motion {
            scene::Motion::Velocity(velocity) => Motion::Velocity(*velocity),
            scene::Motion::Tangential { amplitude, cycles, phase } => {
                Motion::Sinusoid { amplitude: *amplitude, cycles: *cycles, phase: phase.map(f64::to_radians) }
            }
            scene::Motion::Measured(record) if record.slides() => Motion::Measured(Track::new(record.slid())),
            scene::Motion::Measured(_) => Motion::Velocity(Vector2::zeros()),
        };
        let phase = Phase {
            name: phase.name.clone(),
            start,
            duration: phase.duration,
            approach: [approach, to],
            force,
            measured: pressed.or(lowered),
            from_there,
            sliding,
            motion,
            steps: Vec::new(),
            adaptive: None,
        };
        (start, approach, sliding) = (phase.end(), to, phase.final_sliding());
        list.push(phase);
    }
    list
}

/// The path of a measured column; none where there is none.
fn track(record: &scene::Record, column: &[f64]) -> Option<Track<f64>> {
    (!column.is_empty()).then(|| Track::new(record.rows(column)))
}

/// The moments at which steps of a phase end, besides those of equal steps: where bulk fields are asked for, `bulk`, s, and in adaptive steps
/// the rows of what was measured.
fn moments(phase: &Phase, bulk: &[f64], adaptive: bool) -> Vec<Moment> {
    let rows = if adaptive { phase.rows() } else { Vec::new() };
    let rows = rows.into_iter().map(|row| Moment { time: phase.start + row, bulk_output: false });
    let mut all: Vec<Moment> = bulk.iter().map(|time| Moment { time: *time, bulk_output: true }).chain(rows).collect();
    all.sort_by(|one, other| one.time.total_cmp(&other.time));
    // Two moments this close are one.
    let near = 1e-9 * phase.duration;
    all.dedup_by(|next, kept| {
        let same = next.time - kept.time <= near;
        kept.bulk_output |= same && next.bulk_output;
        same
    });
    all
}

/// How fast a dead load sets the indenter moving, m/s: at once where nothing slows it down.
fn dropping(scene: &Scene) -> f64 {
    let end = scene.mount.and_then(|mount| mount.normal).unwrap_or_default();
    match end.load.unwrap_or(0.0) {
        load if load > 0.0 && end.mass == 0.0 => load / end.damping,
        _ => 0.0,
    }
}

/// The phases with their steps; a step ends at every moment that bulk output asks for. Tolerances are shares of a penetration `scale`, m.
pub fn phases(scene: &Scene, scale: f64) -> Vec<Phase> {
    let greatest = scene.greatest_force();
    let mut rates = (0.0, Vector2::zeros());
    let at = &scene.output.bulk_at;
    let moment = |when: &When| if let When::Time(t) = when { Some(*t) } else { None };
    let mut bulk: Vec<f64> = at.iter().filter_map(moment).collect();
    let ends: HashSet<&str> = at.iter().filter_map(When::phase_end).collect();
    bulk.sort_by(f64::total_cmp);
    let mut list = course(scene);
    for (phase, said) in list.iter_mut().zip(&scene.phases) {
        let (count, tolerance) = match said.stepping {
            Stepping::Steps(steps) => (steps, None),
            Stepping::Tolerance(tolerance) => (1, Some(tolerance)),
        };
        let moments = moments(phase, &bulk, tolerance.is_some());
        phase.steps = loading::targets(phase.start, phase.duration, count, &moments);
        if let Some(last) = phase.steps.last_mut() {
            last.bulk_output |= ends.contains(phase.name.as_str());
        }
        let after = phase.rates(phase.start);
        // A force that rises presses the indenter in at about this rate.
        let pressed = phase.force.map_or(0.0, |[from, to]| (to - from).abs() / greatest * scale / phase.duration);
        let pressed = if greatest > 0.0 { pressed } else { 0.0 };
        let pressed = if phase.start == 0.0 { pressed + dropping(scene) } else { pressed };
        let jump = (after.0 - rates.0).abs() + (after.1 - rates.1).norm() + pressed;
        phase.adaptive = tolerance.map(|tolerance| Adaptive::new(phase, tolerance * scale, jump));
        rates = phase.rates(phase.end());
    }
    list
}
