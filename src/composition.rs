//! The composition root: the one place that matches on what a scene asks for and builds the parts for it.

mod body;
mod cohesive;
mod course;
mod estimate;
mod inputs;
mod laws;
mod map;
mod means;
mod outline;
mod pressed;
mod profile;
mod share;
mod steady;
mod strategy;
mod surface;

use std::path::Path;
use std::rc::Rc;

use mpi::topology::SimpleCommunicator;

use crate::error::Result;
use crate::interface::{Interface, Laws};
use crate::loading::Phase;
use crate::mesh::Source;
use crate::parallel::share_numbers;
use crate::petsc::{Integrator, Matrix, Vector};
use crate::profile::{Extruded, Profile, Surface};
use crate::scene::Scene;
use crate::solve::{Heated, Means, Solid, TransientProblem};

use body::Materials;
pub use body::Meshed;
pub use cohesive::{cohesive, cohesive_zone};
pub use course::{course, phases};
pub use estimate::{Estimate, affordable, countable};
pub use inputs::inputs;
use laws::{adhering, friction, heat_of, quadrature, wearing};
pub use means::{Chosen, MOST_DENSE, choose, means};
pub use outline::{Outline, Stretch, outline};
pub use pressed::PressedEnd;
pub use profile::{Elevations, Finest, Shape, elevations, measured, reach, seam_doubt, shape};
pub use share::shares_face;
pub use steady::{heading, last_velocity, steady};
use strategy::Strategy;
pub use strategy::{Compliances, Form, form};

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
    let means = means::shared(comm, scene, &Outline::of(scene, &mesh))?;
    let (strategy, phases) = match mesh.clone() {
        Meshed::Plane(source) => assembled(comm, scene, (source, surface), (compliances, means))?,
        Meshed::Space(source) => assembled(comm, scene, (source, surface), (compliances, means))?,
    };
    let Strategy { strategy, tangent, u, integrator } = strategy;
    Ok(Problem { strategy, tangent, u, phases, integrator, mesh })
}

/// The strategy of a scene in D dimensions, and the phases that it goes through.
fn assembled<const D: usize>(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (source, surface): (Source<D>, Rc<dyn Surface>),
    (compliances, means): (&Compliances, Means),
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
    let clearance = course::clearance(scene, &mut interface)?;
    if scene.adhesion.is_some() {
        interface.measure_gaps()?;
    }
    let heated = scene.heat.as_ref().map(|heat| (heat_of(scene, heat, &materials), solid.clone()));
    let mut problem = match form(scene) {
        Form::Monolithic => strategy::monolithic(comm, scene, (solid, materials), (interface, means))?,
        Form::FaceMemory => strategy::face_memory(comm, scene, (solid, materials), interface, (compliances, means))?,
        Form::BulkMemory | Form::Coupled => strategy::bulk_memory(comm, scene, (solid, materials), (interface, means))?,
    };
    let phases = phases(scene, course::penetration(scene, problem.strategy.as_mut(), clearance)?);
    if let Some((heat, solid)) = heated {
        problem.strategy = Box::new(Heated::new(comm, problem.strategy, &solid, heat)?);
    }
    if scene.output.energy {
        problem.strategy.keep_account(&problem.u)?;
    }
    Ok((problem, phases))
}
