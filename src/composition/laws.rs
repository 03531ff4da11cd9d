//! The laws and the mounts that a scene asks for.

use std::sync::Arc;

use super::body::Materials;
use crate::adhesion::{self, Bilinear, Dugdale, Exponential};
use crate::element::mpjr::Quadrature;
use crate::error::{Error, Result};
use crate::friction::{Coefficient, Law, Strength};
use crate::loading::{DIRECTIONS, Mount};
use crate::scene::{self, Scene};
use crate::solve::{Convection, Heat, Medium};
use crate::wear::{self, Wear};

/// What is asked of the heat. Materials without numbers for it were refused.
pub(super) fn heat_of(scene: &Scene, heat: &scene::Heat, materials: &Materials) -> Heat {
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

pub(super) fn friction(friction: &scene::Friction, bond: Option<scene::Bond>) -> Result<Box<dyn Law>> {
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
    let scene::Law { kind, softness } = friction.law;
    Ok((kind.make)(strength, softness))
}

pub(super) fn adhering(adhesion: scene::Adhesion) -> Box<dyn adhesion::Law> {
    let scene::Adhesion { law, work, range, .. } = adhesion;
    match law {
        scene::AdhesionLaw::Exponential => Box::new(Exponential { work, range }),
        scene::AdhesionLaw::Bilinear => Box::new(Bilinear { work, range }),
        scene::AdhesionLaw::Dugdale => Box::new(Dugdale { work, range }),
    }
}

pub(super) fn wearing(wear: scene::Wear) -> Wear {
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
pub(super) fn mounts<const D: usize>(scene: &Scene) -> [Option<Mount>; DIRECTIONS] {
    let mount = |end: scene::MountEnd| {
        let scene::MountEnd { stiffness, damping, mass, load } = end;
        Mount { stiffness, damping, mass, load: load.unwrap_or(0.0) }
    };
    let [normal, tangential] = scene.mount.map_or([None; 2], |mount| mount.directions()).map(|end| end.map(mount));
    [normal, tangential, tangential.filter(|_| D > 2)]
}

pub(super) fn quadrature(quadrature: scene::Quadrature) -> Quadrature {
    match quadrature {
        scene::Quadrature::Nodal => Quadrature::Nodal,
        scene::Quadrature::Gauss => Quadrature::Gauss,
    }
}
