//! The composition root: the one place that matches on what a scene asks for and builds the parts for it.

mod body;

use std::path::Path;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use crate::element::mpjr::Quadrature;
use crate::error::Result;
use crate::friction::Friction;
use crate::interface::{Interface, Laws};
use crate::loading::{self, Motion, Phase};
use crate::mesh::Mesh;
use crate::petsc::{Matrix, Settings, Vector};
use crate::profile::{Circle, Harmonic, Parabola, Profile, Repeated, Wedge};
use crate::scene::{self, Scene, When};
use crate::solve::{Body, Limits, Monolithic, TransientProblem};

pub use body::mesh_alone;

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
    /// How TS and SNES are set.
    pub settings: Settings,
    /// The body's mesh, for output.
    pub mesh: Mesh,
}

/// Builds what `scene`, read from `file`, asks for, distributed over `comm`.
pub fn build(comm: &SimpleCommunicator, scene: &Scene, file: &Path) -> Result<Problem> {
    let mesh = body::mesh(comm, scene, file)?;
    let face = mesh.face.clone();
    let solid = body::Solid::new(scene);
    let body = Body::new(comm.duplicate(), mesh.clone(), body::quadrilateral(scene), solid.regions.clone())?;
    let u = body.vector()?;
    let bulk = solid.bulk(&body, &u)?;
    let laws = Laws {
        profile: profile(scene),
        penalty: scene.contact.penalty,
        friction: scene.friction.as_ref().map(friction),
    };
    let symmetric = laws.friction.is_none();
    let interface = Interface::new(face, laws, quadrature(scene.contact.quadrature));
    let mut tangent = bulk.new_tangent()?;
    tangent.set_near_null_space(&mut body.coordinates()?)?;
    if symmetric {
        tangent.declare_positive_definite()?;
    }
    let limits = Limits::default();
    let settings = Settings { symmetric, max_newton: limits.max_newton, max_cuts: limits.max_cuts };
    let strategy = Box::new(Monolithic::new(bulk, body, interface, &u, scene.solver.tolerance)?);
    Ok(Problem { strategy, tangent, u, phases: phases(scene), settings, mesh })
}

/// Under periodic sides every profile repeats with the layer's period.
fn profile(scene: &Scene) -> Box<dyn Profile> {
    let period = scene.period();
    fn repeat<P: Profile + 'static>(profile: P, centre: f64, period: Option<f64>) -> Box<dyn Profile> {
        match period {
            Some(period) => Box::new(Repeated { profile, centre, period }),
            None => Box::new(profile),
        }
    }
    match scene.indenter {
        scene::Indenter::Harmonic { amplitude, wavelength } => Box::new(Harmonic { amplitude, wavelength }),
        scene::Indenter::Parabola { radius, centre } => repeat(Parabola { radius, centre }, centre, period),
        scene::Indenter::Circle { radius, centre } => repeat(Circle { radius, centre }, centre, period),
        scene::Indenter::Wedge { slope, centre } => repeat(Wedge { slope, centre }, centre, period),
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
