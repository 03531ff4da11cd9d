//! The penalty that keeps a tolerance.
//!
//! A penalty alpha in series with the body adds 1/alpha to the normal compliance C_zz(k) of the surface to every wave
//! of pressure, exactly. The stiffer the body is to a wave, the more that matters; a layer with the instantaneous
//! modulus G is stiffest either to the shortest wave that the mesh resolves, k = pi / dx (two cells), where it is a
//! half-plane,
//!
//!   C_zz(k) = (1 - nu) / (G k),
//!
//! or to no wave at all, the mean pressure, to which it gives as confined compression does,
//!
//!   C_zz(0) = depth (1 - 2 nu) / (2 G (1 - nu)),
//!
//! and which is the smaller one for a nearly incompressible layer. Relaxation only makes the body softer. Of several
//! strata, the shortest wave meets those that begin within its length of the face, and counts as if the stiffest of them
//! were all there is; the mean pressure meets all of them in series.

use super::{Layer, Material};

/// The penalty, Pa/m, that adds the relative compliance `tolerance` to the wave that the layer is stiffest to, and
/// less to every other: 1 / (tolerance C_zz). `materials` are its strata, top down.
pub fn penalty_for(tolerance: f64, layer: &Layer, materials: &[Material]) -> f64 {
    1.0 / (tolerance * smallest_compliance(layer, materials))
}

/// The relative compliance that a penalty, Pa/m, adds to the wave that the layer is stiffest to.
pub fn added_compliance(penalty: f64, layer: &Layer, materials: &[Material]) -> f64 {
    1.0 / (penalty * smallest_compliance(layer, materials))
}

/// m/Pa
fn smallest_compliance(layer: &Layer, materials: &[Material]) -> f64 {
    let cell = layer.width / layer.cells[0] as f64;
    let (mut shortest, mut mean, mut above) = (f64::INFINITY, 0.0, 0.0);
    for material in materials {
        let (g, nu) = (material.shear_modulus, material.poisson_ratio);
        if above < 2.0 * cell {
            shortest = shortest.min((1.0 - nu) * cell / (std::f64::consts::PI * g));
        }
        let thickness = material.thickness.unwrap_or(layer.depth - above);
        mean += thickness * (1.0 - 2.0 * nu) / (2.0 * g * (1.0 - nu));
        above += thickness;
    }
    shortest.min(mean)
}
