//! A scene as one of steady sliding: its layer, its indenter, and what its last phase holds.

use std::path::Path;
use std::rc::Rc;

use mpi::topology::SimpleCommunicator;
use nalgebra::Vector2;

use super::body::{self, Materials, Meshed};
use super::{Parts, course, friction, prepare, quadrature};
use crate::error::{Error, Result};
use crate::friction::Law;
use crate::interface::{Interface, Laws};
use crate::mesh::Source;
use crate::output::FacePlan;
use crate::profile::Surface;
use crate::scene::{Layer, Motion, Phase, Quadrature, Scene};
use crate::solve::{Relaxations, Solid, Travelling};
use crate::steady::Sliding;
use crate::steady::contact::Held;

/// The velocity of the indenter in the last phase of the scene in `file` along the [`heading`], m/s.
///
/// # Errors
/// [`Error::Scene`] where it has none.
pub fn last_velocity(scene: &Scene, file: &Path) -> Result<f64> {
    match last(scene)?.motion {
        Motion::Velocity(velocity) if scene.is_in_space() && velocity.amax() != 0.0 => Ok(velocity.norm()),
        Motion::Velocity(velocity) if velocity.x != 0.0 => Ok(velocity.x),
        _ => {
            let reason = "the last phase has none to slide at steadily; give it one, or --velocities";
            Err(Error::scene(file, format!("phase.{}.velocity", last(scene)?.name), reason))
        }
    }
}

/// Where the indenter of a scene slides, along x and y, of length 1: in the direction that is given, degrees from +x towards +y, or
/// else in that of the last phase, or along x.
///
/// # Errors
/// [`Error::Usage`] for a direction in the plane, or one that is no number.
pub fn heading(scene: &Scene, direction: Option<f64>) -> Result<Vector2<f64>> {
    match (direction, &last(scene)?.motion) {
        (Some(_), _) if !scene.is_in_space() => {
            Err(Error::Usage("--direction: is for scenes in space; in the plane the indenter slides along x".into()))
        }
        (Some(degrees), _) if !degrees.is_finite() => {
            Err(Error::Usage(format!("--direction: must be an angle in degrees, got {degrees}")))
        }
        (Some(degrees), _) => {
            // Quarters of a turn have components that are exactly nothing.
            let turned = |degrees: f64| match degrees.rem_euclid(360.0) {
                0.0 => 1.0,
                90.0 | 270.0 => 0.0,
                180.0 => -1.0,
                degrees => degrees.to_radians().cos(),
            };
            Ok(Vector2::new(turned(degrees), turned(degrees - 90.0)))
        }
        (None, Motion::Velocity(velocity)) if scene.is_in_space() && velocity.amax() != 0.0 => Ok(velocity.normalize()),
        (None, _) => Ok(Vector2::x()),
    }
}

fn last(scene: &Scene) -> Result<&Phase> {
    scene.phases.last().ok_or_else(|| Error::Internal("a scene without phases".into()))
}

/// The steady sliding of the scene in `file` along a heading, under what its last phase holds, on every rank of `comm`. Collective.
///
/// # Errors
/// [`Error::Scene`] where there is none: the face does not repeat, the friction remembers, the layer relaxes to nothing.
pub fn steady(comm: &SimpleCommunicator, scene: &Scene, file: &Path, heading: Vector2<f64>) -> Result<Sliding> {
    let refused = |key: &str, reason: &str| Error::scene(file, key, format!("mpjr steady {reason}"));
    if scene.layer().is_none() {
        return Err(refused("mesh", "takes a [layer] with periodic sides; steady sliding never ends on a mesh"));
    }
    if !scene.layer().is_some_and(Layer::is_periodic) {
        return Err(refused(
            "layer.sides",
            "takes \"periodic\" sides: elsewhere the indenter comes to an end of the face",
        ));
    }
    if scene.contact.quadrature == Quadrature::Gauss {
        return Err(refused("contact.quadrature", "has a pressure for each node: take \"nodal\""));
    }
    if let Some(fluid) = scene.materials.iter().position(|material| {
        [material.shear_series(), material.bulk_series()].iter().any(|series| series.long_term() <= 0.0)
    }) {
        let arms = if scene.materials.len() == 1 { "material.arms".into() } else { format!("material.{fluid}.arms") };
        return Err(refused(
            &arms,
            "needs weights that sum to less than 1: what relaxes to nothing carries no mean pressure",
        ));
    }
    if scene.mount.is_some() {
        return Err(refused("mount", "holds an approach or a force, and nothing between: take the table out"));
    }
    if scene.adhesion.is_some() {
        return Err(refused("adhesion", "is not solved for steady sliding; run its transient, or take the table out"));
    }
    if scene.wear.is_some() {
        return Err(refused("wear", "has no steady state: what wears goes on changing; take the table out"));
    }
    if scene.heat.is_some() {
        return Err(refused("heat", "has no temperatures; take the table out"));
    }
    let held = held(scene, file)?;
    let Parts { mesh, shape } = prepare(comm, scene, file)?;
    let friction = scene.friction.as_ref().map(|law| friction(law, None)).transpose()?;
    if friction.as_ref().is_some_and(|law| law.strength().remembers()) {
        return Err(refused(
            "friction.coefficient",
            "takes no s: what a point has slid grows for ever, and nothing is steady",
        ));
    }
    let face = mesh.face();
    let held_along = (held, heading);
    let sliding = match mesh {
        Meshed::Plane(source) => sliding(scene, (source, shape.surface), friction, (held_along, face))?,
        Meshed::Space(source) => sliding(scene, (source, shape.surface), friction, (held_along, face))?,
    };
    match held {
        Held::Approach(approach) if approach <= sliding.lowest() => {
            let reason =
                format!("reaches the layer above {:e} m; the last phase is at {approach:e} m", sliding.lowest());
            Err(refused(&format!("phase.{}.approach", last(scene)?.name), &reason))
        }
        _ => Ok(sliding),
    }
}

/// The layer and the indenter in D dimensions.
fn sliding<const D: usize>(
    scene: &Scene,
    (source, surface): (Source<D>, Rc<dyn Surface>),
    friction: Option<Box<dyn Law>>,
    (held, face): ((Held, Vector2<f64>), FacePlan),
) -> Result<Sliding> {
    let (penalty, profile) = (body::penalty(scene, &source), Box::new(surface));
    let laws = Laws { profile, penalty, friction, wear: None, adhesion: None };
    let interface = Interface::new(source.face(), laws, quadrature(scene.contact.quadrature));
    let mut spacing = [1.0; 2];
    let spans = scene.layer().map_or(&[][..], |layer| &layer.spans);
    spacing.iter_mut().zip(spans).for_each(|(spacing, span)| *spacing = span.cell());
    let Materials { regions, times, series, memory: rule } = Materials::new(scene);
    let solid = Solid { source, dilatation: body::dilatation(scene), regions };
    let layer = Travelling::new(&solid, &Relaxations { times, rule, series }, spacing)?
        .ok_or_else(|| Error::Internal("a periodic layer without columns".into()))?;
    Sliding::new((layer, interface), held, face)
}

/// What the last phase holds.
fn held(scene: &Scene, file: &Path) -> Result<Held> {
    let Some(phase) = course(scene).pop() else { return Err(Error::Internal("a scene without phases".into())) };
    match phase.force {
        None => Ok(Held::Approach(phase.approach[1])),
        Some([_, force]) if force > 0.0 => Ok(Held::Force(force)),
        Some(_) => {
            let reason = "mpjr steady: nothing slides without a force; give one above 0, or an approach";
            Err(Error::scene(file, format!("phase.{}.normal_force", phase.name), reason))
        }
    }
}
