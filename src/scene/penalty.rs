//! The penalty that keeps a tolerance.
//!
//! A penalty alpha in series with the body adds 1/alpha to the normal compliance C_zz(k) of the surface to every wave
//! of pressure, exactly. The stiffer the body is to a wave, the more that matters; a layer with the modulus G is
//! stiffest either to the shortest wave that the mesh resolves, k = pi / dx (two cells), where it is a
//! half-plane,
//!
//!   C_zz(k) = (1 - nu) / (G k),
//!
//! or to no wave at all, the mean pressure, to which it gives as confined compression does,
//!
//!   C_zz(0) = depth (1 - 2 nu) / (2 G (1 - nu)),
//!
//! and which is the smaller one for a nearly incompressible layer. Relaxation makes the body softer: the moduli
//! are the means over the shortest step, with which it answers what comes in it; no step meets stiffer ones. Of several
//! strata, the shortest wave meets those that begin within its length of the face, and counts as if the stiffest of them
//! were all there is; the mean pressure meets all of them in series. A mesh counts as a layer of its height, of the
//! stiffest material that has a part of the face, with the shortest edge of the face for its cells.

use super::{Layer, Material, Phase};

/// The penalty, Pa/m, that adds the relative compliance `tolerance` to the wave that the layer is stiffest to, and
/// less to every other: 1 / (tolerance C_zz). `materials` are its strata, top down, `after` so many s.
pub fn penalty_for(tolerance: f64, layer: &Layer, materials: &[Material], after: f64) -> f64 {
    1.0 / (tolerance * compliance_of_layer(layer, materials, after))
}

/// The shortest step of a history, s; of an adaptive phase, as long as they are expected to be.
pub fn shortest_step(phases: &[Phase]) -> f64 {
    phases.iter().map(|phase| phase.duration / phase.expected_steps() as f64).fold(f64::INFINITY, f64::min)
}

/// The same for a mesh: the shortest `edge` of its face and its `height` below that, m, and the materials of the face.
pub fn penalty_on_mesh(tolerance: f64, [edge, height]: [f64; 2], materials: &[&Material], after: f64) -> f64 {
    let compliance = |material: &&Material| smallest_compliance(edge, &[(height, material)], after);
    1.0 / (tolerance * materials.iter().map(compliance).fold(f64::INFINITY, f64::min))
}

/// The relative compliance that a penalty, Pa/m, adds to the wave that the layer is stiffest to.
pub fn added_compliance(penalty: f64, layer: &Layer, materials: &[Material], after: f64) -> f64 {
    1.0 / (penalty * compliance_of_layer(layer, materials, after))
}

/// m/Pa
fn compliance_of_layer(layer: &Layer, materials: &[Material], after: f64) -> f64 {
    let above: f64 = materials.iter().filter_map(|material| material.thickness).sum();
    let thickness = |material: &Material| material.thickness.unwrap_or(layer.depth - above);
    let strata: Vec<_> = materials.iter().map(|material| (thickness(material), material)).collect();
    smallest_compliance(layer.cell(), &strata, after)
}

/// m/Pa, of strata (thickness in m, material) from the face down, in cells of a length, m.
fn smallest_compliance(cell: f64, strata: &[(f64, &Material)], after: f64) -> f64 {
    let (mut shortest, mut mean, mut above) = (f64::INFINITY, 0.0, 0.0);
    for (thickness, material) in strata {
        let g = material.shear_modulus * (material.shear_series().integral(after) / after);
        let nu = material.poisson().at(after);
        if above < 2.0 * cell {
            shortest = shortest.min((1.0 - nu) * cell / (std::f64::consts::PI * g));
        }
        mean += thickness * (1.0 - 2.0 * nu) / (2.0 * g * (1.0 - nu));
        above += thickness;
    }
    shortest.min(mean)
}
