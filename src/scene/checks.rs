//! What the parts of a scene have to do with one another: physics and size, not format. Each check is visible whole;
//! each error is the key and the reason.

use std::collections::HashSet;
use std::path::Path;

use super::keys::tables::{COMPRESSIVE, IN_PLANE, IN_SPACE};
use super::{
    Arm, Body, Bond, Extend, Friction, Heat, Indenter, Layer, Material, Memory, MeshFile, Motion, Phase, Quadrature,
    Scene, Sides, Span, Stepping, Strategy, WearLaw, Wearing, When, keys,
};
use crate::error::{Error, Result};

/// The key and what is wrong with it.
type Check = std::result::Result<(), (String, String)>;

/// Everything that takes more than one table to see.
pub(super) fn all(scene: &Scene, file: &Path) -> Result<()> {
    let layer = |check: &dyn Fn(&Layer) -> Check| scene.layer().map_or(Ok(()), check);
    materials(&scene.materials)
        .and_then(|()| layer(&|layer| size(layer, scene.solver.strategy)))
        .and_then(|()| layer(&|layer| strata(layer, &scene.materials)))
        .and_then(|()| in_space(scene))
        .and_then(|()| layer(&|layer| period(layer, &scene.indenter)))
        .and_then(|()| times(&scene.phases))
        .and_then(|()| adaptive(scene))
        .and_then(|()| exact_laws(scene))
        .and_then(|()| load(scene))
        .and_then(|()| pull(scene))
        .and_then(|()| wear(scene))
        .and_then(|()| adhesion(scene))
        .and_then(|()| heat(scene))
        .and_then(|()| scene.phases.iter().try_for_each(|phase| approach(phase, scene)))
        .and_then(|()| moments(&scene.output.bulk_at, &scene.phases))
        .map_err(|(key, reason)| Error::scene(file, key, reason))
}

/// G = E / (2 (1 + nu)), Pa.
pub(super) fn shear_from_young(young: f64, poisson_ratio: f64) -> f64 {
    young / (2.0 * (1.0 + poisson_ratio))
}

/// The arms take at most the whole modulus; taking all of it makes a Maxwell fluid.
pub(super) fn weights(arms: &[Arm]) -> std::result::Result<(), String> {
    let sum: f64 = arms.iter().map(|arm| arm.weight).sum();
    match sum <= 1.0 + 1e-12 {
        true => Ok(()),
        false => Err(format!("the weights must sum to at most 1, got {}", short(sum))),
    }
}

/// The path of a key of a material.
fn material_key(materials: &[Material], index: usize, key: &str) -> String {
    match (&materials[index].region, materials.len()) {
        (Some(region), _) => format!("material.{region}.{key}"),
        (None, 1) => format!("material.{key}"),
        (None, _) => format!("material.{index}.{key}"),
    }
}

/// A modulus from Young's can leave the range of numbers where that did not; memory is updated in one way.
fn materials(materials: &[Material]) -> Check {
    let with_arms = || materials.iter().enumerate().filter(|(_, material)| !material.is_elastic());
    let path = |index: usize, key: &str| material_key(materials, index, key);
    for (index, Material { shear_modulus, .. }) in materials.iter().enumerate() {
        if !(shear_modulus.is_finite() && *shear_modulus > 0.0) {
            let reason = format!("gives a shear modulus of {shear_modulus:?} Pa; give another");
            return fail(&path(index, "young_modulus"), reason);
        }
    }
    match with_arms().find(|(_, other)| with_arms().next().is_some_and(|(_, first)| first.memory != other.memory)) {
        Some((index, _)) => fail(&path(index, "memory"), "must be the same in all materials with arms"),
        None => Ok(()),
    }
}

/// The strata leave room for the last one, and there is a row of cells for each.
fn strata(layer: &Layer, materials: &[Material]) -> Check {
    let above: f64 = materials.iter().filter_map(|material| material.thickness).sum();
    if above >= layer.depth {
        let reason = format!(
            "the strata above the last are {} m thick, which leaves it nothing of the layer's depth ({:?} m)",
            short(above),
            layer.depth
        );
        return fail(&format!("material.{}.thickness", materials.len() - 2), reason);
    }
    if layer.rows < materials.len() {
        let reason =
            format!("{} rows of cells for {} strata; give at least one row for each", layer.rows, materials.len());
        return fail("layer.cells", reason);
    }
    Ok(())
}

/// What has a direction of its own is for space; of a mesh, its file says whether it is ([`directions`]).
fn in_space(scene: &Scene) -> Check {
    const REMEDY: &str = "give layer.width as an array of two, along x and along y";
    scene.layer().map_or(Ok(()), |layer| directions(scene, layer.spans.len() > 1, REMEDY))
}

/// Whether a mesh, in the plane or in space, goes with what the scene says.
pub(super) fn mesh(scene: &Scene, space: bool) -> Check {
    directions(scene, space, "give a mesh of tetrahedra or hexahedra")?;
    let Body::Mesh(MeshFile { element: Some(element), .. }) = &scene.body else { return Ok(()) };
    let (known, what) = match space {
        false => (IN_PLANE, "a mesh in the plane"),
        true => (IN_SPACE, "a mesh in space"),
    };
    match known.iter().any(|(_, other)| other == element) {
        true => Ok(()),
        false => fail("mesh.element", format!("must be {:?} or {:?} for {what}", known[0].0, known[1].0)),
    }
}

fn directions(scene: &Scene, space: bool, remedy: &str) -> Check {
    let for_space = format!("is for scenes in space: {remedy}");
    if scene.indenter.needs_space() && !space {
        return fail("indenter.profile", for_space);
    }
    for phase in &scene.phases {
        let (key, across) = match &phase.motion {
            Motion::Velocity(velocity) => ("velocity", velocity.y),
            Motion::Tangential { amplitude, .. } => ("tangential.amplitude", amplitude.y),
            Motion::Measured(record) => ("motion", record.sliding_y.iter().fold(0.0, |most: f64, y| most.max(y.abs()))),
        };
        if across != 0.0 && !space {
            return fail(&format!("phase.{}.{key}", phase.name), format!("a direction along y {for_space}"));
        }
    }
    Ok(())
}

/// PETSc counts unknowns and matrix entries, about 18 to a row, with 32 bits; of a layer in space that repeats in all directions it
/// sees the face alone.
fn size(layer: &Layer, strategy: Strategy) -> Check {
    const MOST: f64 = 1e8;
    let in_space = layer.spans.len() > 1;
    let face_alone = in_space && layer.is_periodic() && strategy != Strategy::Monolithic;
    let rows = (!face_alone).then_some(layer.rows);
    let counts: Vec<usize> = layer.spans.iter().map(|span| span.cells).chain(rows).collect();
    let components = layer.spans.len() as f64 + 1.0;
    let unknowns = counts.iter().map(|count| *count as f64 + 1.0).product::<f64>() * components;
    if unknowns > MOST {
        let counts = counts.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ");
        let reason = format!("{counts} cells make {unknowns:.2e} unknowns; at most {MOST:e} can be solved for");
        return fail("layer.cells", reason);
    }
    match layer.spans.iter().any(|span| matches!(span.sides, Sides::Periodic | Sides::Fixed) && span.cells < 2) {
        true => fail("layer.cells", "must have at least 2 cells along the face under periodic or fixed sides, got 1"),
        false => Ok(()),
    }
}

/// Under periodic sides the profile has the period of the layer. The harmonic, sampled and rough profiles must have it
/// by themselves (the sampled one as far as the scene says its period; that of a map is looked at with its file); any other is taken from its nearest image.
fn period(layer: &Layer, indenter: &Indenter) -> Check {
    const REPEATS: &str = "must be \"periodic\" under periodic sides, got \"error\"";
    let Span { width, sides, .. } = layer.spans[0];
    if let (Indenter::Waves { wavelength, .. }, Some(across)) = (indenter, layer.spans.get(1)) {
        for (span, wavelength) in [&layer.spans[0], across].into_iter().zip(wavelength.iter()) {
            if span.sides == Sides::Periodic {
                whole_periods(span.width, "wavelengths", *wavelength).or_else(|reason| fail("layer.width", reason))?;
            }
        }
    }
    if let (Indenter::Rough { period, .. }, Some(across)) = (indenter, layer.spans.get(1))
        && across.sides == Sides::Periodic
    {
        whole_periods(across.width, "periods of the profile", *period).or_else(|reason| fail("layer.width", reason))?;
    }
    if let Indenter::Map { extend: Extend::Error, .. } = indenter
        && layer.spans.iter().any(|span| span.sides == Sides::Periodic)
    {
        return fail("indenter.extend", REPEATS);
    }
    let (what, period) = match *indenter {
        _ if sides != Sides::Periodic => return Ok(()),
        Indenter::Harmonic { wavelength, .. } => ("wavelengths", wavelength),
        Indenter::Rough { period, .. } => ("periods of the profile", period),
        Indenter::Sampled { period: Some(period), .. } => ("periods of the profile", period),
        Indenter::Sampled { extend: Extend::Error, .. } => return fail("indenter.extend", REPEATS),
        _ => return Ok(()),
    };
    whole_periods(width, what, period).or_else(|reason| fail("layer.width", reason))
}

/// Whether a periodic layer `width` m wide holds a whole number of `period`s, m, which messages call `what`.
///
/// # Errors
/// The reason why not, to stand after the key of the width or of the period.
pub fn whole_periods(width: f64, what: &str, period: f64) -> std::result::Result<(), String> {
    let count = width / period;
    if count.round() >= 1.0 && (count - count.round()).abs() <= 1e-9 * count.round() {
        return Ok(());
    }
    let nearest: Vec<String> = [count.floor(), count.ceil()]
        .into_iter()
        .filter(|count| *count >= 1.0)
        .map(|count| format!("{} m", short(count * period)))
        .collect();
    Err(format!(
        "must be a whole number of {what} ({period:?} m) under periodic sides, got {width:?} m; nearest: {}",
        nearest.join(" or ")
    ))
}

/// Every step moves the clock, the clock stays a number, and PETSc can count the steps.
fn times(phases: &[Phase]) -> Check {
    const MOST: usize = 2_000_000_000;
    let mut start = 0.0;
    let mut before = 0;
    for phase in phases {
        let steps = phase.expected_steps();
        let (end, step) = (start + phase.duration, phase.duration / steps as f64);
        let key = format!("phase.{}.duration", phase.name);
        if !(phase.duration > 0.0 && end.is_finite()) {
            return fail(&key, format!("must be a positive time in s that can be counted, got {:?}", phase.duration));
        }
        if steps > MOST - before {
            let reason = format!("the history can have at most {MOST} steps in all");
            return fail(&format!("phase.{}.steps", phase.name), reason);
        }
        // Far from the round-off of the clock, so that the step itself keeps some digits.
        if step <= 1e-12 * end {
            let reason =
                format!("its steps of {step:.1e} s are lost in the {end:.1e} s since the start; take longer ones");
            return fail(&key, reason);
        }
        start = end;
        before += steps;
    }
    Ok(())
}

/// Adaptive steps see what is not straight in the path of the face, for which the exponential memory is exact; the error
/// of backward Euler's memory they would not see where the face is held and the stress relaxes.
fn adaptive(scene: &Scene) -> Check {
    let adaptive = |phase: &&Phase| matches!(phase.stepping, Stepping::Tolerance(_));
    let Some(phase) = scene.phases.iter().find(adaptive) else { return Ok(()) };
    let key = format!("phase.{}.tolerance", phase.name);
    let first_order = |material: &Material| !material.is_elastic() && material.memory == Memory::BackwardEuler;
    if scene.materials.iter().any(first_order) {
        return fail(&key, "needs memory = \"exponential\" in the material; or give steps");
    }
    Ok(())
}

/// Every material says how it conducts and holds heat; a coefficient of friction knows the temperature where there is one.
fn heat(scene: &Scene) -> Check {
    let Some(heat) = &scene.heat else {
        return match scene.friction.as_ref().is_some_and(Friction::knows_temperature) {
            true => fail("friction.coefficient", "knows no T without a [heat] table; give one, or leave T out"),
            false => Ok(()),
        };
    };
    for (index, Material { conductivity, heat_capacity, .. }) in scene.materials.iter().enumerate() {
        for (key, value, unit) in [("conductivity", conductivity, "W/m/K"), ("heat_capacity", heat_capacity, "J/m^3/K")]
        {
            if value.is_none() {
                let reason = format!("missing, and required by [heat]: give it in {unit}");
                return fail(&material_key(&scene.materials, index, key), reason);
            }
        }
    }
    if heat.arms && scene.materials.iter().all(Material::is_elastic) {
        return fail("heat.arms", "is true, and no material has arms; leave it out");
    }
    if heat.coupled { coupled(scene, heat) } else { Ok(()) }
}

/// Arms that follow the temperature begin at the initial one, by a law, on the face.
fn coupled(scene: &Scene, heat: &Heat) -> Check {
    let follows = |material: &Material| material.shift.is_some() && !material.is_elastic();
    if !scene.materials.iter().any(follows) {
        let reason =
            "is true, and no material with arms says by which law their times go with the temperature; give it shift";
        return fail("heat.coupled", reason);
    }
    if scene.solver.strategy == Strategy::Monolithic {
        let reason = "with heat.coupled = true must be \"condensed\" or \"auto\": all arms of the monolithic strategy have one temperature";
        return fail("solver.strategy", reason);
    }
    for (index, material) in scene.materials.iter().enumerate() {
        if let Some(shift) = material.shift.filter(|shift| shift.law().reference() != heat.initial) {
            let (key, at) = (material_key(&scene.materials, index, "temperature"), shift.law().reference());
            return fail(
                &key,
                format!("is {at} K; with heat.coupled = true it must be heat.initial, {} K", heat.initial),
            );
        }
    }
    Ok(())
}

/// Not both a force and a mount hold the indenter along the approach.
fn load(scene: &Scene) -> Check {
    match scene.phases.iter().find(|phase| phase.says_force()) {
        Some(phase) if scene.mount.is_some_and(|mount| mount.normal.is_some()) => {
            fail(&force_key(phase), "cannot stand beside mount.normal, whose load is the force; leave one of them out")
        }
        _ => Ok(()),
    }
}

/// The key by which a phase says its force.
fn force_key(phase: &Phase) -> String {
    format!("phase.{}.{}", phase.name, if phase.record().is_some() { "motion" } else { "normal_force" })
}

/// Only what adheres can be pulled.
fn pull(scene: &Scene) -> Check {
    let pulls = |phase: &&Phase| phase.normal_force.is_some_and(|force| force < 0.0);
    match scene.phases.iter().find(pulls).filter(|_| scene.adhesion.is_none()) {
        Some(phase) => {
            let got = phase.normal_force.unwrap_or_default();
            fail(&force_key(phase), format!("must be {COMPRESSIVE}, got {got:?}; a pull needs [adhesion]"))
        }
        None => Ok(()),
    }
}

/// A point adheres at a node, by the tractions there; what a closed gap bears is part of friction.
fn adhesion(scene: &Scene) -> Check {
    let Some(adhesion) = &scene.adhesion else { return Ok(()) };
    if scene.solver.strategy == Strategy::Monolithic {
        return fail("adhesion", "is not solved by the strategy \"monolithic\"; use \"condensed\"");
    }
    if scene.contact.quadrature == Quadrature::Gauss {
        return fail("adhesion", "is not solved with \"gauss\" quadrature; use \"nodal\"");
    }
    if scene.wear.is_some() {
        return fail("adhesion", "is not solved beside [wear] yet; leave one of them out");
    }
    let strength = 2.0 * adhesion.work / adhesion.range;
    if !(strength.is_finite() && (strength / adhesion.range).is_finite() && strength > 0.0) {
        return fail("adhesion.range", "gives with adhesion.work a traction that is no number; give another");
    }
    match adhesion.friction {
        Bond::ShearStrength(_) if scene.friction.is_none() => {
            let reason = "shear_strength is part of friction: give [friction] (coefficient = 0 leaves nothing else), or \"none\"";
            fail("adhesion.friction", reason)
        }
        _ => Ok(()),
    }
}

/// A point wears at a node, by the tractions there; an indenter on the even nodes of a layer.
fn wear(scene: &Scene) -> Check {
    let Some(wear) = &scene.wear else { return Ok(()) };
    if scene.solver.strategy == Strategy::Monolithic {
        return fail("wear", "is not solved by the strategy \"monolithic\"; use \"condensed\"");
    }
    if scene.contact.quadrature == Quadrature::Gauss {
        return fail("wear", "is not solved with \"gauss\" quadrature; use \"nodal\"");
    }
    if wear.law == WearLaw::Energy && scene.friction.is_none() {
        return fail("wear.law", "\"energy\" goes with what friction dissipates: give [friction], or use \"archard\"");
    }
    if wear.of == Wearing::Indenter && scene.layer().is_none() {
        return fail("wear.of", "\"indenter\" takes the flat face of a [layer]; on a [mesh] use \"body\"");
    }
    Ok(())
}

/// Contact without penetration and Coulomb's law itself are met by tractions at nodes; where displacements decide them, or
/// two points to an edge share its motion, they need numbers.
fn exact_laws(scene: &Scene) -> Check {
    let gauss = scene.contact.quadrature == Quadrature::Gauss;
    let monolithic = scene.solver.strategy == Strategy::Monolithic;
    let instead = match (gauss, monolithic) {
        (false, false) => return Ok(()),
        (true, _) => "or use \"nodal\" quadrature",
        (false, true) => "or use the strategy \"condensed\"",
    };
    if scene.contact.penalty.is_none() {
        let reason = format!(
            "is required {} (tolerance = 1e-3 leaves a thousandth of the body's own compliance); {instead}",
            if gauss { "by \"gauss\" quadrature" } else { "by the strategy \"monolithic\"" }
        );
        return fail("contact.penalty", reason);
    }
    match scene.friction.as_ref().map(|friction| friction.law) {
        Some(law) if law.is_exact() => {
            let laws = "\"coulomb_elastic_slip\" (an elastic_slip of 1e-3 times coefficient times approach leaves a thousandth) or \"coulomb_tanh\"";
            fail("friction.law", format!("must be {laws} here; {instead}"))
        }
        _ => Ok(()),
    }
}

/// The indenter neither passes the clamped face nor, as a circle, sinks in to its centre.
fn approach(phase: &Phase, scene: &Scene) -> Check {
    let deepest = phase.approaches().into_iter().max_by(|(_, one), (_, other)| one.total_cmp(other));
    let Some((_, approach)) = deepest else { return Ok(()) };
    let key = phase.approach_key();
    if let Some(Layer { depth, .. }) = scene.layer()
        && approach >= *depth
    {
        return fail(&key, format!("must be less than the depth of the layer ({depth:?} m), got {approach:?}"));
    }
    match scene.indenter {
        Indenter::Circle { radius, .. } | Indenter::Sphere { radius, .. } if approach >= radius => {
            let what = if scene.indenter.needs_space() { "sphere" } else { "circle" };
            fail(&key, format!("must be less than the radius of the {what} ({radius:?} m), got {approach:?}"))
        }
        _ => Ok(()),
    }
}

const TWICE: &str = "is in the list already";

/// The moments are in the history, each once.
fn moments(moments: &[When], phases: &[Phase]) -> Check {
    let names: HashSet<&str> = phases.iter().map(|phase| phase.name.as_str()).collect();
    let mut before = HashSet::new();
    let end: f64 = phases.iter().map(|phase| phase.duration).sum();
    for (index, moment) in moments.iter().enumerate() {
        let key = format!("output.bulk_at.{index}");
        match moment {
            When::PhaseEnd(name) if !names.contains(name.as_str()) => {
                let names: Vec<&str> = phases.iter().map(|phase| phase.name.as_str()).collect();
                return fail(&key, format!("no phase {name:?}; {}", keys::advice(name, &names, "the phases are")));
            }
            // A sum of durations may fall short of what it means by round-off.
            When::Time(time) if *time > end * (1.0 + 1e-9) => {
                return fail(&key, format!("must be a time within the history, up to {end:?} s, got {time:?}"));
            }
            When::PhaseEnd(name) if !before.insert(Ok(name)) => return fail(&key, TWICE),
            When::Time(time) if !before.insert(Err(time.to_bits())) => return fail(&key, TWICE),
            _ => {}
        }
    }
    Ok(())
}

fn fail(key: &str, reason: impl Into<String>) -> Check {
    Err((key.to_owned(), reason.into()))
}

/// A number for a message, without the last digits that only round-off put there.
fn short(value: f64) -> String {
    format!("{:?}", format!("{value:.10e}").parse().unwrap_or(value))
}
