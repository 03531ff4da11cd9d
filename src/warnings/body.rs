//! Whether the element, the strains and the numbers of the material are up to the scene.

use super::{Before, Warning, above, material, phase};
use crate::scene::{Body, Element, Material};

/// Poisson ratio above which bilinear quadrilaterals and triangles, hexahedra and tetrahedra lock.
pub const LARGEST_POISSON: f64 = 0.45;
/// The deepest overlap over the depth of the body: strains are of that order, and are taken to be small.
pub const DEEPEST: f64 = 0.1;
/// Pa: hardly any solid is softer, and rubbers and plastics typed in MPa are ...
pub const SOFTEST: f64 = 100.0;
/// ... but larger bodies, m, are taken to be dimensionless.
pub const UNIT_SIZE: f64 = 0.5;
/// G(0) over the modulus that the shortest step meets: beyond it half of the digits are lost.
pub const MOST_RELAXED: f64 = 1e8;

/// The Poisson ratio, at any time, above [`LARGEST_POISSON`].
pub fn locking(before: &Before<'_>) -> Option<Warning> {
    let (element, key) = match &before.scene.body {
        Body::Layer(layer) => (Some(layer.element), "layer.element"),
        Body::Mesh(mesh) => (mesh.element, "mesh.element"),
    };
    let [multilinear, simplices] = before.outline.cells;
    let plain = multilinear > 0 && !matches!(element, Some(Element::Quad4Bbar | Element::Hex8Bbar));
    let largest = before.scene.materials.iter().map(long_term_poisson).fold(f64::NEG_INFINITY, f64::max);
    if !above(largest, LARGEST_POISSON) || !(plain || simplices > 0) {
        return None;
    }
    let [cell, simplex, multilinear] = match before.outline.is_in_space() {
        false => ["q4", "triangles", "quadrilaterals"],
        true => ["h8", "tetrahedra", "hexahedra"],
    };
    let (what, key, remedy) = match plain {
        true => (cell, key, format!("element = \"{cell}_bbar\"")),
        false => (simplex, "mesh.file", format!("a mesh of {multilinear}, and element = \"{cell}_bbar\"")),
    };
    let text = format!(
        "{what} with a Poisson ratio of {largest:.8} (above {LARGEST_POISSON}) lock: the body is too stiff, by 30 % with 8 cells \
         to a wave at 0.49 and many times nearer to 0.5; use {remedy}"
    );
    Some(Warning::new(key, text))
}

/// The larger one of the ratios at t = 0 and when all arms have relaxed: nu = (3 K - 2 G) / (2 (3 K + G)).
fn long_term_poisson(material: &Material) -> f64 {
    let nu = material.poisson_ratio;
    let g = material.shear_series().long_term();
    let k = 2.0 * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)) * material.bulk_series().long_term();
    let relaxed = (3.0 * k - 2.0 * g) / (2.0 * (3.0 * k + g));
    // A fluid of both moduli has none.
    if relaxed.is_finite() { nu.max(relaxed) } else { nu }
}

/// The deepest overlap above [`DEEPEST`] of the depth.
pub fn large_strains(before: &Before<'_>) -> Option<Warning> {
    let (deepest, height) = (before.encounters.deepest(), before.outline.height);
    let share = deepest.overlap / height;
    if !above(share, DEEPEST) {
        return None;
    }
    let text = format!(
        "the indenter goes {:.3e} m into a body of {height:.3e} m, {share:.3} of it (more than {DEEPEST}): strains are of that \
         order and are taken to be small; approach less, or give a deeper body",
        deepest.overlap
    );
    Some(Warning::new(phase(before.scene, deepest.phase, "approach"), text))
}

/// Young's modulus below [`SOFTEST`] in a body smaller than [`UNIT_SIZE`].
pub fn modulus_unit(before: &Before<'_>) -> Option<Warning> {
    let young = |material: &Material| 2.0 * material.shear_modulus * (1.0 + material.poisson_ratio);
    let size = before.outline.height.max(before.outline.face.width());
    let soft = |(_, material): &(usize, &Material)| above(SOFTEST, young(material));
    let (index, soft) = before.scene.materials.iter().enumerate().find(soft).filter(|_| size < UNIT_SIZE)?;
    let text = format!(
        "Young's modulus is {:.4} Pa, below {SOFTEST} Pa, in a body of {size:.2e} m: it looks like MPa; give it in Pa",
        young(soft)
    );
    Some(Warning::new(material(before.scene, index, "shear_modulus"), text))
}

/// G(0) above [`MOST_RELAXED`] times what the shortest step meets.
pub fn digits(before: &Before<'_>) -> Option<Warning> {
    let step = crate::scene::shortest_step(&before.scene.phases);
    let ratio = |material: &Material| step / material.shear_series().integral(step);
    let stiff = |(_, material): &(usize, &Material)| above(ratio(material), MOST_RELAXED);
    let (index, stiff) = before.scene.materials.iter().enumerate().find(stiff)?;
    let text = format!(
        "the instantaneous modulus is {:.1e} times what the shortest step ({step:.2e} s) meets (more than {MOST_RELAXED:.0e}): \
         no digits carry both; leave out arms that relax within a step, with a modulus smaller by their weight",
        ratio(stiff)
    );
    Some(Warning::new(material(before.scene, index, "arms"), text))
}
