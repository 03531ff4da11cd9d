//! Whether there is contact, on the body, on enough nodes, and as stiff as it should be.

use std::f64::consts::PI;

use super::{Before, Warning, above, cells, phase};
use crate::composition::PressedEnd;
use crate::oracle::layer::Layer;
use crate::oracle::solid::Moduli;
use crate::scene::Material;

/// Nodes in contact, estimated: with fewer N comes in jumps.
pub const FEWEST_NODES: f64 = 3.0;
/// The share of the compliance, to a wave as long as the contact, that the penalty may add.
pub const MOST_PENALTY: f64 = 0.05;

/// The indenter stays above the face throughout; a force, or adhesion, brings it there.
pub fn never_touches(before: &Before<'_>) -> Option<Warning> {
    let deepest = before.encounters.deepest();
    if deepest.overlap > 0.0 || before.scene.is_loaded() || before.scene.adhesion.is_some() {
        return None;
    }
    let text = format!(
        "the indenter never touches: it stays {:.3e} m above the face where it comes closest; approach by more than {:.4e} m, \
         or lower the profile",
        -deepest.overlap, before.encounters.low
    );
    Some(Warning::new(phase(before.scene, deepest.phase, "approach"), text))
}

/// The lowest point of the indenter is beyond a free end of the face.
pub fn leaves_the_body(before: &Before<'_>) -> Option<Warning> {
    let (met, x) = before.encounters.list.iter().find_map(|met| Some((met, met.beyond?)))?;
    let text = format!(
        "the indenter leaves the body: its lowest point is beyond the end of the face at x = {x:?} m; move it, slide less, or \
         give a wider body"
    );
    Some(Warning::new(phase(before.scene, met.phase, "distance"), text))
}

/// Fewer than [`FEWEST_NODES`] at the deepest moment.
pub fn few_nodes(before: &Before<'_>) -> Option<Warning> {
    let (deepest, face) = (before.encounters.deepest(), before.outline.face);
    let [_, nodes] = deepest.contact();
    // A face that is in contact as a whole may have as few as it likes.
    if deepest.overlap <= 0.0 || deepest.whole || !above(FEWEST_NODES, nodes) {
        return None;
    }
    let wanted = match nodes {
        0.0 => "more".to_owned(),
        nodes => format!("about {:.0}", (2.0 * FEWEST_NODES / nodes * face.edges as f64).ceil()),
    };
    let text = format!(
        "about {nodes:.1} nodes of the face in contact at the deepest approach, fewer than {FEWEST_NODES}: N comes in jumps; \
         give {wanted} cells along the face (there are {})",
        face.edges
    );
    Some(Warning::new(cells(before.scene), text))
}

/// What cannot give way is pressed on.
pub fn pressed_end(before: &Before<'_>) -> Option<Warning> {
    let PressedEnd { place, time } = before.shape.pressed.as_ref()?;
    let text = format!(
        "from t = {time:.4e} s the indenter presses on the clamped end of the face at {place}, which cannot give way: N \
         grows with the penalty there; keep it off the ends"
    );
    Some(Warning::new("layer.sides", text))
}

/// More than [`MOST_PENALTY`]: 1/(penalty C_zz(k)), k = pi over the width of the contact, with the modulus that the
/// shortest step meets.
pub fn penalty(before: &Before<'_>) -> Option<Warning> {
    let Before { scene, outline, encounters, .. } = before;
    let penalty = scene.contact.stiffness().or(outline.penalty)?;
    let deepest = encounters.deepest();
    if deepest.overlap <= 0.0 {
        return None;
    }
    let [width, _] = deepest.contact();
    let width = width.max(2.0 * outline.face.cell());
    let share = 1.0 / (penalty * compliance(before, PI / width));
    if !above(share, MOST_PENALTY) {
        return None;
    }
    let text = format!(
        "the penalty of {penalty:.2e} Pa/m adds {share:.3} times the compliance of the body (more than {MOST_PENALTY}): the \
         indenter sinks in by about {:.0} % of its approach; give {:.0e} or more, tolerance = 0.01 instead, or neither",
        100.0 * share / (1.0 + share),
        penalty * share / (0.2 * MOST_PENALTY)
    );
    Some(Warning::new("contact.penalty", text))
}

/// C_zz, m/Pa, of the body to a wave of the wavenumber k, 1/m: of strata each as a bonded layer under what reaches it,
/// added up; of a mesh, the largest that its height of one of its materials would have.
fn compliance(before: &Before<'_>, k: f64) -> f64 {
    let step = crate::scene::shortest_step(&before.scene.phases);
    let of = |material: &Material, depth: f64| {
        let shear = material.shear_modulus * (material.shear_series().integral(step) / step);
        Layer { depth }.compliance(k, Moduli::elastic(shear, material.poisson_ratio)).zz.re
    };
    let (materials, height) = (&before.scene.materials, before.outline.height);
    if before.scene.layer().is_none() {
        return materials.iter().map(|material| of(material, height)).fold(0.0, f64::max);
    }
    let mut above = 0.0;
    let mut stratum = |material: &Material| {
        let thickness = material.thickness.unwrap_or(height - above);
        let part = of(material, thickness) * (-k * above).exp();
        above += thickness;
        part
    };
    materials.iter().map(&mut stratum).sum()
}
