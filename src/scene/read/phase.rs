//! The `[[phase]]` tables: the loading history.

use std::collections::HashMap;

use nalgebra::Vector2;
use toml::Value;

use super::{Preset, record};
use crate::error::Result;
use crate::scene::keys::Section;
use crate::scene::{Motion, Phase, Stepping};

/// All phases, in order; at least one. Those that say nothing of their steps have the tolerance of the preset.
pub(super) fn read_all(root: &Section, preset: Option<Preset>) -> Result<Vec<Phase>> {
    if root.table().get("phase").is_some_and(Value::is_table) {
        return Err(root.error("phase", ONE_TABLE));
    }
    let sections = root.sections("phase")?;
    if sections.is_empty() {
        let wrong = if root.has("phase") { "empty" } else { "missing" };
        return Err(root.error("phase", format!("{wrong}; give at least one [[phase]] table")));
    }
    let mut phases: Vec<Phase> = Vec::new();
    let mut taken = HashMap::new();
    for (index, section) in sections.into_iter().enumerate() {
        let name = name(&section, index, &mut taken)?;
        phases.push(phase(&section.called(format!("phase.{name}")), name, preset)?);
    }
    Ok(phases)
}

const ONE_TABLE: &str = "must be written [[phase]], in double brackets, also where there is one only";

/// The name of the phase at `index` when the file gives none.
pub(in crate::scene) fn default_name(index: usize) -> String {
    format!("phase-{}", index + 1)
}

/// `taken` are the names of the phases before, with their indices.
fn name(section: &Section, index: usize, taken: &mut HashMap<String, usize>) -> Result<String> {
    let name = section.optional_text("name")?.unwrap_or_else(|| default_name(index));
    if name.trim().is_empty() {
        return Err(section.error("name", "must be a name that is not empty"));
    }
    match taken.insert(name.clone(), index) {
        Some(first) => Err(section.error("name", format!("{name:?} is the name of phase {first} too; give another"))),
        None => Ok(name),
    }
}

fn phase(section: &Section, name: String, preset: Option<Preset>) -> Result<Phase> {
    section.later(&[("temperature", super::NO_TEMPERATURE)])?;
    section.only_known()?;
    let motion = motion(section)?;
    if section.has("approach") && section.has("normal_force") {
        return Err(section.error("normal_force", "give approach or normal_force, not both"));
    }
    Ok(Phase {
        name,
        duration: duration(section, &motion)?,
        stepping: stepping(section, preset)?,
        approach: section.optional_number("approach")?,
        normal_force: section.optional_number("normal_force")?,
        motion,
    })
}

fn stepping(section: &Section, preset: Option<Preset>) -> Result<Stepping> {
    let steps = section.optional_count("steps")?;
    let tolerance = section.optional_number("tolerance")?;
    match (steps, tolerance) {
        (Some(_), Some(_)) => Err(section.error("tolerance", "give steps or tolerance, not both")),
        (Some(steps), None) => Ok(Stepping::Steps(steps)),
        (None, Some(tolerance)) => Ok(Stepping::Tolerance(tolerance)),
        (None, None) => {
            let missing = || section.missing("steps", &format!("{}, or a tolerance", section.what("steps")));
            preset.map(|preset| Stepping::Tolerance(preset.steps)).ok_or_else(missing)
        }
    }
}

fn motion(section: &Section) -> Result<Motion> {
    if let Some(value) = section.table().get("motion").filter(|value| !value.is_table()) {
        return Err(section.must_be("motion", section.what("motion"), value));
    }
    if let Some(measured) = section.optional_section("motion")? {
        record::refuse_beside(section)?;
        return Ok(Motion::Measured(record::read(section, &measured)?));
    }
    let Some(tangential) = section.optional_section("tangential")? else {
        return Ok(Motion::Velocity(section.along_the_face("velocity")?.unwrap_or_default()));
    };
    if let Some(other) = ["velocity", "distance"].into_iter().find(|key| section.has(key)) {
        return Err(section.error(other, format!("give {other} or tangential, not both")));
    }
    tangential.only_known()?;
    let amplitude = tangential.along_the_face("amplitude")?;
    let amplitude = amplitude.ok_or_else(|| tangential.missing("amplitude", tangential.what("amplitude")))?;
    let phase: Vector2<f64> = tangential.along_the_face("phase")?.unwrap_or_default();
    Ok(Motion::Tangential { amplitude, cycles: tangential.number("cycles")?, phase })
}

/// The duration, given as itself or as the distance slid at the velocity of the phase.
fn duration(section: &Section, motion: &Motion) -> Result<f64> {
    if let Motion::Measured(record) = motion {
        return record::duration(section, record);
    }
    let duration = section.optional_number("duration")?;
    let distance = section.optional_number("distance")?;
    match (duration, distance, motion) {
        (Some(_), Some(_), _) => Err(section.error("distance", "give distance or duration, not both")),
        (Some(duration), None, _) => Ok(duration),
        (None, Some(distance), Motion::Velocity(velocity)) if *velocity != Vector2::zeros() => {
            Ok(distance / velocity.x.hypot(velocity.y))
        }
        (None, Some(_), _) => Err(section.error("distance", "needs a velocity other than 0, or give duration instead")),
        (None, None, _) => Err(section.missing("duration", "it in s, or velocity and distance")),
    }
}
