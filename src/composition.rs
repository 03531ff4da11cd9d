//! The composition root: the one place that matches on what a scene asks for and builds the parts for it.

mod body;
mod profile;

use std::path::Path;

use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Root};

use crate::bulk::{Arms, Bulk};
use crate::element::mpjr::Quadrature;
use crate::error::Result;
use crate::friction::{CoulombTanh, ElasticSlip, Friction};
use crate::interface::{Interface, Laws};
use crate::loading::{self, Motion, Phase};
use crate::mesh::Mesh;
use crate::parallel::{agree, share_numbers};
use crate::petsc::{Integrator, Linear, Matrix, Settings, Vector};
use crate::profile::Profile;
use crate::scene::{self, Scene, When};
use crate::solve::{
    Backing, Body, Compliance, Condensed, Following, Interior, LARGE_FACE, MAX_NEWTON, Monolithic, PeriodicColumn,
    Relaxation, Remembering, Solid, Source, TransientProblem,
};

use body::Materials;
pub use body::{Outline, Stretch, outline};
pub use profile::{Finest, Shape, elevations, shape};

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
    pub mesh: Mesh,
}

/// Builds what `scene`, which was read from `file`, asks for, distributed over `comm`. What it needs of other files is
/// read by one rank.
pub fn build(comm: &SimpleCommunicator, scene: &Scene, file: &Path) -> Result<Problem> {
    // First what the scene may be refused for.
    let elevations = share_numbers(comm, || elevations(scene, file))?;
    let mesh = body::mesh(comm, scene, file)?;
    let profile = shape(scene, file, &elevations, Stretch::of(scene, &mesh.face))?.profile;
    assemble(comm, scene, mesh, profile)
}

/// As [`build`], with another profile than the scene's.
pub fn build_with_profile(comm: &SimpleCommunicator, scene: &Scene, profile: Box<dyn Profile>) -> Result<Problem> {
    assemble(comm, scene, body::mesh(comm, scene, Path::new(""))?, profile)
}

fn assemble(comm: &SimpleCommunicator, scene: &Scene, mesh: Mesh, profile: Box<dyn Profile>) -> Result<Problem> {
    let materials = Materials::new(scene);
    let laws = Laws {
        profile,
        penalty: scene.contact.penalty,
        augmentation: match scene.contact.method {
            scene::Method::Penalty => None,
            scene::Method::Augmented { augmentation_tolerance } => Some(augmentation_tolerance),
        },
        friction: scene.friction.as_ref().map(friction),
    };
    let interface = Interface::new(mesh.face.clone(), laws, quadrature(scene.contact.quadrature));
    let solid = Solid { mesh, quadrilateral: body::quadrilateral(scene), regions: materials.regions.clone() };
    match form(scene) {
        Form::Monolithic => monolithic(comm, scene, (solid, materials), interface),
        Form::Following => following(comm, scene, (solid, materials), interface),
        Form::Remembering => remembering(comm, scene, (solid, materials), interface),
    }
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
}

/// How `scene` is solved: on its contact face unless it says otherwise.
pub fn form(scene: &Scene) -> Form {
    match scene.solver.strategy {
        scene::Strategy::Monolithic => Form::Monolithic,
        scene::Strategy::Auto | scene::Strategy::Condensed if Materials::new(scene).relax_alike() => Form::Following,
        scene::Strategy::Auto | scene::Strategy::Condensed => Form::Remembering,
    }
}

fn monolithic(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (solid, materials): (Solid, Materials),
    interface: Interface,
) -> Result<Problem> {
    let mesh = solid.mesh.clone();
    let body = Body::new(comm.duplicate(), solid)?;
    let u = body.vector()?;
    let bulk = materials.bulk(&body, &u)?;
    let mut tangent = bulk.new_tangent()?;
    tangent.set_near_null_space(&mut body.coordinates()?)?;
    let linear = if interface.friction().is_some() { Linear::Lu } else { Linear::Cholesky };
    if linear == Linear::Cholesky {
        tangent.declare_positive_definite()?;
    }
    let integrator = integrator(comm, linear, &mut tangent)?;
    let strategy = Box::new(Monolithic::new(bulk, body, interface, &u, scene.solver.tolerance)?);
    Ok(Problem { strategy, tangent, u, phases: phases(scene), integrator, mesh })
}

fn following(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (solid, materials): (Solid, Materials),
    interface: Interface,
) -> Result<Problem> {
    let u = face_vector(comm, &solid.mesh)?;
    let mine = if comm.rank() == 0 { compliance(scene, &solid).map(Some) } else { Ok(None) };
    let compliance = agree(comm, mine)?;
    let mut softness = compliance.as_ref().map_or(0.0, Compliance::largest);
    comm.process_at_rank(0).broadcast_into(&mut softness);
    let mesh = solid.mesh.clone();
    let Materials { series, times, memory, .. } = materials;
    let relaxation = match series.into_iter().next().flatten() {
        Some(series) => Some(Relaxation { arms: Arms::new(times, memory, &u)?, series }),
        None => None,
    };
    let interior = Interior::new(comm, solid);
    let backing = Following { compliance, softness, relaxation, interior, secant: 1.0 };
    condensed(comm, scene, mesh, u, (interface, backing))
}

fn remembering(
    comm: &SimpleCommunicator,
    scene: &Scene,
    (solid, materials): (Solid, Materials),
    interface: Interface,
) -> Result<Problem> {
    let whole = if comm.rank() == 0 { whole_body(&solid, &materials).map(Some) } else { Ok(None) };
    let source = periodic_column(scene, &solid).map_or(Source::Schur, Source::Periodic);
    let mesh = solid.mesh;
    let backing = Remembering::new(comm, agree(comm, whole)?, source)?;
    let u = face_vector(comm, &mesh)?;
    condensed(comm, scene, mesh, u, (interface, backing))
}

fn condensed<B: Backing + 'static>(
    comm: &SimpleCommunicator,
    scene: &Scene,
    mesh: Mesh,
    u: Vector,
    (interface, backing): (Interface, B),
) -> Result<Problem> {
    let held: Vec<[bool; 2]> = mesh.face.unknown.iter().map(|&unknown| mesh.held[unknown as usize]).collect();
    let linear = if 2 * held.len() > LARGE_FACE { Linear::OwnIterative } else { Linear::Own };
    let mut tangent = Matrix::shell(comm, u.local_len())?;
    let integrator = integrator(comm, linear, &mut tangent)?;
    let strategy = Box::new(Condensed::new(interface, backing, &u, &held, scene.solver.tolerance)?);
    Ok(Problem { strategy, tangent, u, phases: phases(scene), integrator, mesh })
}

/// x, z of each face node, on rank 0.
fn face_vector(comm: &SimpleCommunicator, mesh: &Mesh) -> Result<Vector> {
    Vector::new(comm, if comm.rank() == 0 { 2 * mesh.face.unknown.len() } else { 0 })
}

/// The compliance of the face, by this rank alone.
fn compliance(scene: &Scene, solid: &Solid) -> Result<Compliance> {
    match periodic_column(scene, solid) {
        Some(column) => Ok(Compliance::of_periodic_columns(&column.stiffness(&[1.0]), column.columns)),
        None => Compliance::by_schur_complement(&Body::new(SimpleCommunicator::self_comm(), solid.clone())?),
    }
}

/// The whole body with its memory, on this rank alone.
fn whole_body(solid: &Solid, materials: &Materials) -> Result<(Bulk, Body)> {
    let body = Body::new(SimpleCommunicator::self_comm(), solid.clone())?;
    let bulk = materials.bulk(&body, &body.vector()?)?;
    Ok((bulk, body))
}

/// One column of a periodic layer; none for any other body.
fn periodic_column(scene: &Scene, solid: &Solid) -> Option<PeriodicColumn> {
    let layer = scene.layer().filter(|layer| layer.sides == scene::Sides::Periodic)?;
    Some(PeriodicColumn::new(solid, layer.cells))
}

fn integrator(comm: &SimpleCommunicator, linear: Linear, tangent: &mut Matrix) -> Result<Integrator> {
    Integrator::new(comm, Settings { linear, max_newton: MAX_NEWTON }, tangent)
}

fn friction(friction: &scene::Friction) -> Friction {
    match *friction {
        scene::Friction::CoulombTanh { coefficient, regularisation } => {
            Friction::CoulombTanh(CoulombTanh { coefficient, regularisation })
        }
        scene::Friction::CoulombElasticSlip { coefficient, elastic_slip } => {
            Friction::ElasticSlip(ElasticSlip { coefficient, elastic_slip })
        }
    }
}

fn quadrature(quadrature: scene::Quadrature) -> Quadrature {
    match quadrature {
        scene::Quadrature::Nodal => Quadrature::Nodal,
        scene::Quadrature::Gauss => Quadrature::Gauss,
    }
}

/// The phases end to end, each from where the one before left the indenter; a step ends at every moment that bulk
/// output asks for.
pub fn phases(scene: &Scene) -> Vec<Phase> {
    let at = &scene.output.bulk_at;
    let moment = |when: &When| if let When::Time(t) = when { Some(*t) } else { None };
    let mut moments: Vec<f64> = at.iter().filter_map(moment).collect();
    moments.sort_by(f64::total_cmp);
    let (mut start, mut approach, mut sliding) = (0.0, 0.0, 0.0);
    let mut list = Vec::with_capacity(scene.phases.len());
    for phase in &scene.phases {
        let to = phase.approach.unwrap_or(approach);
        let motion = match phase.motion {
            scene::Motion::Velocity(v) => Motion::Velocity(v),
            scene::Motion::Tangential { amplitude, cycles } => Motion::Sinusoid { amplitude, cycles },
        };
        let mut steps = loading::targets(start, phase.duration, phase.steps, &moments);
        if let Some(last) = steps.last_mut() {
            last.bulk_output |= at.contains(&When::PhaseEnd(phase.name.clone()));
        }
        let phase = Phase {
            name: phase.name.clone(),
            start,
            duration: phase.duration,
            approach: [approach, to],
            sliding,
            motion,
            steps,
        };
        (start, approach, sliding) = (phase.end(), to, phase.final_sliding());
        list.push(phase);
    }
    list
}
