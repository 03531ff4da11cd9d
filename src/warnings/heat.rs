//! Whether cells are fine enough for the heat, and whether the law of the times knows the temperatures.

use super::loading::passage;
use super::{After, Before, Warning, above, cells, material};
use crate::mesh::graded;
use crate::rheology::Shift;
use crate::scene::{Body, Scene, Shifting};

/// The height of the cells at the face over the depth that heat enters while the contact passes.
pub const COARSEST_HEAT: f64 = 1.0;
/// K above its pole, reference - c2, where the WLF law is in use: from about the glass transition to 150 K above it (Ferry, ch. 11,
/// has 100 K).
pub const WLF_RANGE: [f64; 2] = [50.0, 200.0];

/// Cells at the face higher than [`COARSEST_HEAT`] times sqrt(D t), t the time that the contact takes to pass a point of the face.
pub fn skin(before: &Before<'_>) -> Option<Warning> {
    let scene = before.scene;
    let heat = scene.heat?;
    let rubbed = scene.friction.is_some() && heat.share > 0.0;
    let height = match &scene.body {
        Body::Layer(layer) => graded(layer.depth, layer.rows, layer.grading)[1],
        Body::Mesh(_) => before.outline.face.cell(),
    };
    let spreads = |index: usize| Some(scene.materials[index].conductivity? / scene.materials[index].heat_capacity?);
    let count = if scene.layer().is_some() { 1 } else { scene.materials.len() };
    let diffusivity = (0..count).filter_map(spreads).reduce(f64::min)?;
    let skins = before.encounters.moving().filter_map(|(index, phase, met)| {
        let passage = passage(phase, met).filter(|_| rubbed)?;
        Some((index, (diffusivity * passage).sqrt(), passage))
    });
    let (index, skin, passage) = skins.min_by(|a, b| a.1.total_cmp(&b.1))?;
    if !above(height, COARSEST_HEAT * skin) {
        return None;
    }
    let text = format!(
        "cells at the face are {height:.2e} m high, and while the contact passes, in {passage:.2e} s in phase {}, heat enters {skin:.2e} m \
         (less than {COARSEST_HEAT} cells): the face gets hotter than it can show; take more cells through the depth, or grade them",
        scene.phases[index].name
    );
    Some(Warning::new(cells(scene), text))
}

/// A temperature that is told, outside [`WLF_RANGE`].
pub fn told(before: &Before<'_>) -> Option<Warning> {
    let heat = before.scene.heat.filter(|heat| heat.coupled)?;
    let air = heat.convection.filter(|air| air.coefficient > 0.0).map(|air| air.temperature);
    let all = [Some(heat.initial), heat.base.temperature(), air];
    all.into_iter().flatten().find_map(|temperature| beyond(before.scene, temperature, "reaches"))
}

/// The hottest of the run, outside [`WLF_RANGE`], where what was told is not.
pub fn reached(after: &After<'_>) -> Option<Warning> {
    after.scene.heat.filter(|heat| heat.coupled)?;
    let hottest = after.history.iter().max_by(|a, b| a.heat.highest.total_cmp(&b.heat.highest))?;
    beyond(after.scene, hottest.heat.highest, "gets to")
}

/// A temperature that the law of a material is not in use at.
fn beyond(scene: &Scene, temperature: f64, verb: &str) -> Option<Warning> {
    let [least, most] = WLF_RANGE;
    let over = |(index, shift): (usize, Shift)| match shift {
        Shift::Wlf { reference, c2, .. } => Some((index, temperature - (reference - c2))),
        Shift::Arrhenius { .. } => None,
    };
    let laws = scene.materials.iter().enumerate().filter_map(|(i, m)| m.shift.map(Shifting::law).map(|law| (i, law)));
    let (index, over) = laws.filter_map(over).find(|&(_, over)| above(least, over) || above(over, most))?;
    let text = format!(
        "the body {verb} {temperature:.1} K, {over:.1} K above the pole of the WLF law; it is known from about {least} K above it, the glass \
         transition, to {most} K: times are extrapolated there, and held within 12 decades; give arrhenius, or c1 and c2 measured there"
    );
    Some(Warning::new(material(scene, index, "shift"), text))
}
