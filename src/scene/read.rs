//! The keys of a scene: which there are, what each accepts, and what it becomes. What one key has to do with another
//! is in `checks`.

mod adhesion;
mod body;
mod friction;
mod heat;
mod indenter;
pub(super) mod material;
mod mount;
pub(super) mod phase;
pub(super) mod record;
mod wear;

use std::path::Path;

use toml::Table;

use super::keys::tables::{self, QUADRATURES, STRATEGIES};
use super::keys::{self, Section};
use super::{
    Body, Contact, Material, Output, Penalty, Phase, Quadrature, Scene, Solver, Strategy, When, checks, penalty_for,
    shortest_step,
};
use crate::error::Result;

/// Reads and checks a scene whose table holds all in full: what it takes from other files is there ([`super::include`]).
pub fn scene(table: &Table, file: &Path) -> Result<Scene> {
    let root = Section::root(file, table, &tables::SCENE);
    root.later(&[
        ("element", "give it in [layer] or [mesh]"),
        ("temperature", NO_TEMPERATURE),
        ("reference_temperature", NO_TEMPERATURE),
    ])?;
    root.only_known()?;
    let title = title(&root, file)?;
    let body = body::read(&root, file)?;
    // The history says over which times the materials must hold.
    let solver_section = root.optional_section("solver")?;
    let preset = solver_section.as_ref().map(preset).transpose()?.flatten();
    let phases = phase::read_all(&root, preset)?;
    let materials = body::materials(&root, &body, super::material::loading(&phases).as_ref())?;
    let every = super::kept::interface_every(&body, &phases);
    let mut scene = Scene {
        indenter: indenter::read(&root.section("indenter")?)?,
        contact: contact(&root.section("contact")?, &body, &materials, &phases)?,
        friction: root.optional_section("friction")?.as_ref().map(friction::read).transpose()?,
        heat: root.optional_section("heat")?.as_ref().map(heat::read).transpose()?,
        mount: root.optional_section("mount")?.as_ref().map(mount::read).transpose()?,
        wear: root.optional_section("wear")?.as_ref().map(wear::read).transpose()?,
        adhesion: root.optional_section("adhesion")?.as_ref().map(adhesion::read).transpose()?,
        phases,
        solver: solver(solver_section.as_ref(), preset)?,
        output: output(root.optional_section("output")?.as_ref(), every)?,
        title,
        body,
        materials,
    };
    checks::all(&scene, file)?;
    if !scene.is_coupled() {
        // At one temperature its law has done what it is for.
        scene.materials.iter_mut().for_each(|material| material.shift = None);
    }
    scene.clamp_moments();
    Ok(scene)
}

const NO_TEMPERATURE: &str = "give temperature in [material]: it is the same everywhere and at all times";

fn title(root: &Section, file: &Path) -> Result<String> {
    let stem = || file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(root.optional_text("title")?.unwrap_or_else(stem))
}

fn contact(section: &Section, body: &Body, materials: &[Material], phases: &[Phase]) -> Result<Contact> {
    section.only_known()?;
    let quadrature = section.optional_choice("quadrature", &QUADRATURES, &[])?.unwrap_or(Quadrature::Nodal);
    Ok(Contact { penalty: penalty(section, body, materials, phases)?, quadrature })
}

/// The penalty, given as itself or as the compliance that it may add; none where nothing is said, or "augmented".
fn penalty(section: &Section, body: &Body, materials: &[Material], phases: &[Phase]) -> Result<Option<Penalty>> {
    let augmented = section.optional_choice("method", &[("penalty", false), ("augmented", true)], &[])?;
    // Multipliers began with a penalty and ended at a tolerance, which decide nothing any more.
    let leftover = section.optional_number("augmentation_tolerance")?;
    if augmented != Some(true) && leftover.is_some() {
        return Err(section.error("augmentation_tolerance", "is for method = \"augmented\""));
    }
    let penalty = section.optional_number("penalty")?;
    let tolerance = section.optional_number("tolerance")?;
    match (penalty, tolerance) {
        (Some(_), Some(_)) => Err(section.error("tolerance", "give penalty or tolerance, not both")),
        _ if augmented == Some(true) => Ok(None),
        (Some(penalty), None) => Ok(Some(Penalty::Stiffness(penalty))),
        (None, Some(tolerance)) => {
            let Body::Layer(layer) = body else {
                return Ok(Some(Penalty::Tolerance(tolerance)));
            };
            match penalty_for(tolerance, layer, materials, shortest_step(phases)) {
                penalty if penalty.is_finite() && penalty > 0.0 => Ok(Some(Penalty::Stiffness(penalty))),
                penalty => {
                    Err(section.error("tolerance", format!("gives a penalty of {penalty:?} Pa/m; give another")))
                }
            }
        }
        (None, None) if augmented == Some(false) => Err(section.missing("penalty", "it in Pa/m, or tolerance")),
        (None, None) => Ok(None),
    }
}

/// What a scene leaves to a preset.
#[derive(Clone, Copy)]
struct Preset {
    /// The tolerance of phases that give neither steps nor a tolerance.
    steps: f64,
    /// The tolerance of Newton's method.
    newton: f64,
}

fn preset(solver: &Section) -> Result<Option<Preset>> {
    const PRESETS: [(&str, Preset); 3] = [
        ("fast", Preset { steps: 1e-2, newton: 1e-6 }),
        ("balanced", Preset { steps: 1e-3, newton: 1e-8 }),
        ("reference", Preset { steps: 1e-4, newton: 1e-10 }),
    ];
    solver.optional_choice("preset", &PRESETS, &[])
}

fn solver(section: Option<&Section>, preset: Option<Preset>) -> Result<Solver> {
    let default = Solver { strategy: Strategy::Auto, tolerance: preset.map_or(1e-8, |preset| preset.newton) };
    let Some(section) = section else { return Ok(default) };
    section.only_known()?;
    Ok(Solver {
        strategy: section.optional_choice("strategy", &STRATEGIES, &[])?.unwrap_or(default.strategy),
        tolerance: section.optional_number("tolerance")?.unwrap_or(default.tolerance),
    })
}

fn output(section: Option<&Section>, interface_every: usize) -> Result<Output> {
    let default = Output { interface_every, bulk_at: Vec::new(), checkpoint_every: 0, energy: true };
    let Some(section) = section else { return Ok(default) };
    section.only_known()?;
    let count = |key: &str| section.optional_count(key);
    Ok(Output {
        interface_every: count("interface_every")?.unwrap_or(default.interface_every),
        bulk_at: bulk_at(section)?,
        checkpoint_every: count("checkpoint_every")?.unwrap_or(default.checkpoint_every),
        energy: section.optional_flag("energy")?.unwrap_or(default.energy),
    })
}

fn bulk_at(section: &Section) -> Result<Vec<When>> {
    let moment = |(index, value): (usize, &toml::Value)| match (value.as_str(), keys::number(value)) {
        (Some(name), _) => Ok(When::PhaseEnd(name.to_owned())),
        (_, Some(time)) if time.is_finite() && time > 0.0 => Ok(When::Time(time)),
        _ => Err(section.must_be(&format!("bulk_at.{index}"), "the name of a phase or a positive time in s", value)),
    };
    section.values("bulk_at")?.iter().enumerate().map(moment).collect()
}
