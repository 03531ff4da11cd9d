//! The composition root: the one place that matches on what a scene asks for and builds the parts for it.

mod profile;

use std::path::Path;

use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Root};

use crate::bulk::{Arms, Bulk, Part, Series};
use crate::element::mpjr::Quadrature;
use crate::element::quad4;
use crate::error::Result;
use crate::friction::Friction;
use crate::interface::{Interface, Laws};
use crate::loading::{self, Motion, Phase};
use crate::mesh::{Layer, Mesh, Sides};
use crate::parallel::{agree, share_numbers};
use crate::petsc::{Integrator, Linear, Matrix, Settings, Vector};
use crate::profile::Profile;
use crate::rheology::Memory;
use crate::rheology::prony::{Prony, common_times};
use crate::scene::{self, PoissonRule, Scene, When};
use crate::solve::{
    Backing, Body, Compliance, Condensed, Following, Inside, Interior, LARGE_FACE, Layered, MAX_NEWTON, Moduli,
    Monolithic, PeriodicColumn, Relaxation, Relaxations, Remembering, Sparse, TransientProblem,
};

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
    build_with_profile(comm, scene, shape(scene, file, &elevations)?.profile)
}

/// As [`build`], with another profile than the scene's.
pub fn build_with_profile(comm: &SimpleCommunicator, scene: &Scene, profile: Box<dyn Profile>) -> Result<Problem> {
    let mesh = layer(&scene.layer).mesh();
    let laws = Laws { profile, penalty: scene.contact.penalty, friction: scene.friction.as_ref().map(friction) };
    let interface = Interface::new(mesh.face.clone(), laws, quadrature(scene.contact.quadrature));
    match form(scene) {
        Form::Monolithic => monolithic(comm, scene, mesh, interface),
        Form::Following => following(comm, scene, mesh, interface),
        Form::Remembering => remembering(comm, scene, mesh, interface),
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
    let follows = scene.material.is_elastic() || scene.material.poisson_rule == Some(PoissonRule::ConstantRatio);
    match scene.solver.strategy {
        scene::Strategy::Monolithic => Form::Monolithic,
        scene::Strategy::Auto | scene::Strategy::Condensed if follows => Form::Following,
        scene::Strategy::Auto | scene::Strategy::Condensed => Form::Remembering,
    }
}

fn monolithic(comm: &SimpleCommunicator, scene: &Scene, mesh: Mesh, interface: Interface) -> Result<Problem> {
    let moduli = moduli(&scene.material);
    let body = Body::new(comm.duplicate(), mesh.clone(), moduli)?;
    let u = body.vector()?;
    let bulk = bulk(scene, &body, moduli, &u)?;
    let mut tangent = bulk.new_tangent()?;
    tangent.set_near_null_space(&mut body.coordinates()?)?;
    if !interface.has_friction() {
        tangent.declare_positive_definite()?;
    }
    let integrator = integrator(comm, Linear::Preconditioned, &mut tangent)?;
    let strategy = Box::new(Monolithic::new(bulk, body, interface, &u, scene.solver.tolerance)?);
    Ok(Problem { strategy, tangent, u, phases: phases(scene), integrator, mesh })
}

fn following(comm: &SimpleCommunicator, scene: &Scene, mesh: Mesh, interface: Interface) -> Result<Problem> {
    let moduli = moduli(&scene.material);
    let u = face_vector(comm, &mesh)?;
    let mine = if comm.rank() == 0 { compliance(scene, &mesh, moduli).map(Some) } else { Ok(None) };
    let compliance = agree(comm, mine)?;
    let mut softness = compliance.as_ref().map_or(0.0, Compliance::largest);
    comm.process_at_rank(0).broadcast_into(&mut softness);
    let (series, times) = prony(&scene.material);
    let relaxation = match series {
        Some(series) => Some(Relaxation { arms: Arms::new(times, memory(&scene.material), &u)?, series }),
        None => None,
    };
    let interior = Interior::new(comm, mesh.clone(), moduli);
    let backing = Following { compliance, softness, relaxation, interior, secant: 1.0 };
    condensed(comm, scene, mesh, u, (interface, backing))
}

fn remembering(comm: &SimpleCommunicator, scene: &Scene, mesh: Mesh, interface: Interface) -> Result<Problem> {
    let inside = if comm.rank() == 0 { inside(scene, &mesh).map(Some) } else { Ok(None) };
    let backing = Remembering::new(comm, agree(comm, inside)?);
    let u = face_vector(comm, &mesh)?;
    condensed(comm, scene, mesh, u, (interface, backing))
}

/// The whole body with its memory, on this rank alone.
fn inside(scene: &Scene, mesh: &Mesh) -> Result<Box<dyn Inside>> {
    let moduli = moduli(&scene.material);
    if let Some(column) = periodic_column(scene, mesh) {
        return Ok(Box::new(Layered::new(mesh.clone(), &column, relaxations(&scene.material))));
    }
    let body = Body::new(SimpleCommunicator::self_comm(), mesh.clone(), moduli)?;
    let bulk = bulk(scene, &body, moduli, &body.vector()?)?;
    Ok(Box::new(Sparse::new(bulk, body)?))
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
fn compliance(scene: &Scene, mesh: &Mesh, moduli: Moduli) -> Result<Compliance> {
    match periodic_column(scene, mesh) {
        Some(column) => column.compliance(),
        None => {
            Compliance::by_schur_complement(&Body::new(SimpleCommunicator::self_comm(), mesh.clone(), moduli)?, moduli)
        }
    }
}

/// One column of a periodic layer; none for any other body.
fn periodic_column(scene: &Scene, mesh: &Mesh) -> Option<PeriodicColumn> {
    let [columns, rows] = scene.layer.cells;
    (scene.layer.sides == scene::Sides::Periodic).then(|| PeriodicColumn {
        cells: (0..rows).map(|cell| quad4::stiffness(&mesh.corners(cell))).collect(),
        moduli: moduli(&scene.material),
        columns,
    })
}

fn integrator(comm: &SimpleCommunicator, linear: Linear, tangent: &mut Matrix) -> Result<Integrator> {
    Integrator::new(comm, Settings { linear, max_newton: MAX_NEWTON }, tangent)
}

fn layer(layer: &scene::Layer) -> Layer {
    let sides = match layer.sides {
        scene::Sides::Periodic => Sides::Periodic,
        scene::Sides::Free => Sides::Free,
        scene::Sides::Roller => Sides::Roller,
        scene::Sides::Fixed => Sides::Fixed,
    };
    Layer { width: layer.width, depth: layer.depth, cells: layer.cells, grading: layer.grading, sides }
}

/// K = 2 G (1 + nu) / (3 (1 - 2 nu)), instantaneous.
fn moduli(material: &scene::Material) -> Moduli {
    let (g, nu) = (material.shear_modulus, material.poisson_ratio);
    Moduli { shear: g, bulk: 2.0 * g * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)) }
}

/// One part where shear and bulk modulus relax together (or not at all), two where each goes its own way.
fn bulk(scene: &Scene, body: &Body, moduli: Moduli, layout: &Vector) -> Result<Bulk> {
    let Relaxations { times, rule, series } = relaxations(&scene.material);
    let part = |moduli, diagonal, series: &Option<Series>| {
        Ok(Part { stiffness: body.stiffness(moduli, diagonal)?, series: series.clone() })
    };
    let parts = match &series[..] {
        [shear, bulk] if shear != bulk => vec![
            part(Moduli { bulk: 0.0, ..moduli }, moduli.shear, shear)?,
            part(Moduli { shear: 0.0, ..moduli }, 0.0, bulk)?,
        ],
        _ => vec![part(moduli, moduli.shear, &series[0])?],
    };
    Bulk::new(parts, times, rule, layout)
}

/// How the shear and the bulk modulus relax.
fn relaxations(material: &scene::Material) -> Relaxations {
    let pronys = [material.shear_series(), material.bulk_series()];
    let times = common_times(&[&pronys[0], &pronys[1]]);
    Relaxations { rule: memory(material), series: pronys.iter().map(|prony| series(prony, &times)).collect(), times }
}

/// The Prony series of the shear modulus and its relaxation times, s; no series for an elastic material.
fn prony(material: &scene::Material) -> (Option<Series>, Vec<f64>) {
    let prony = material.shear_series();
    let times = common_times(&[&prony]);
    (series(&prony, &times), times)
}

/// A series over a list of relaxation times, s; none where nothing relaxes.
fn series(prony: &Prony, times: &[f64]) -> Option<Series> {
    (!prony.arms.is_empty()).then(|| Series { long_term: prony.long_term(), weights: prony.weights_over(times) })
}

fn memory(material: &scene::Material) -> Memory {
    match material.memory {
        scene::Memory::Exponential => Memory::Exponential,
        scene::Memory::BackwardEuler => Memory::BackwardEuler,
    }
}

fn friction(friction: &scene::Friction) -> Friction {
    match *friction {
        scene::Friction::CoulombTanh { coefficient, regularisation } => {
            Friction::coulomb_tanh(coefficient, regularisation)
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
