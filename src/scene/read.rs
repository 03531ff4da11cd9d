//! The keys of a scene: which there are, what each accepts, and what it becomes. What one key has to do with another
//! is in `checks`.

mod body;
pub(super) mod phase;

use std::path::Path;

use toml::Table;

use super::keys::{self, Quantity, Section};
use super::{
    Arm, Body, Contact, Friction, Indenter, Material, Memory, Output, PoissonRule, Quadrature, Scene, Solver, Source,
    Strategy, When, checks, overrides,
};
use crate::error::{Error, Result};

/// Reads and checks a scene.
///
/// `text` is the content of `source.file`; nothing else is opened, so that every rank can read what rank 0 broadcast.
/// The first thing that is wrong is the error.
pub fn read(text: &str, source: &Source) -> Result<Scene> {
    let mut table = parse(text, &source.file)?;
    overrides::apply(&mut table, &source.overrides, &source.file)?;
    from_table(&table, &source.file).map_err(|error| overrides::blame(error, &source.overrides))
}

/// The TOML of a file, not yet looked into.
pub fn parse(text: &str, file: &Path) -> Result<Table> {
    text.parse::<Table>().map_err(|error| {
        let reason = error.message().replace('\n', "; ");
        let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        Error::scene(file, "", format!("line {line}, column {column}: not TOML: {reason}"))
    })
}

/// Reads and checks a scene whose TOML has been parsed, and perhaps changed by [`super::set`].
pub fn from_table(table: &Table, file: &Path) -> Result<Scene> {
    let root = Section::root(file, table);
    root.later(&[
        ("element", "give it in [layer] or [mesh]"),
        ("temperature", NO_TEMPERATURE),
        ("reference_temperature", NO_TEMPERATURE),
    ])?;
    root.only(&["title", "layer", "mesh", "material", "indenter", "contact", "friction", "phase", "solver", "output"])?;
    let title = title(&root, file)?;
    let body = body::read(&root, file)?;
    let mut scene = Scene {
        title,
        materials: materials(&root, &body)?,
        body,
        indenter: indenter(&root.section("indenter")?)?,
        contact: contact(&root.section("contact")?)?,
        friction: root.optional_section("friction")?.as_ref().map(friction).transpose()?,
        phases: phase::read_all(&root)?,
        solver: solver(root.optional_section("solver")?.as_ref())?,
        output: output(root.optional_section("output")?.as_ref())?,
    };
    checks::all(&scene, file)?;
    scene.clamp_moments();
    Ok(scene)
}

const NO_TEMPERATURE: &str = "remove it: the temperature stays the one of the material's data";

fn title(root: &Section, file: &Path) -> Result<String> {
    let stem = || file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(root.optional_text("title", "a text on one line")?.unwrap_or_else(stem))
}

/// Whole numbers from 1.
const COUNT: std::ops::RangeInclusive<usize> = 1..=usize::MAX;

/// `[material]`, or one `[[material]]` for each stratum of a layer or region of a mesh.
fn materials(root: &Section, body: &Body) -> Result<Vec<Material>> {
    let mut list: Vec<Material> = Vec::new();
    let Ok(sections) = root.sections("material", "") else {
        return Ok(vec![material(&root.section("material")?, body, true)?]);
    };
    let count = sections.len();
    for (index, section) in sections.into_iter().enumerate() {
        let last = index + 1 == count;
        let region = section.optional_text("region", REGION)?;
        let known = list.iter().position(|other| region.is_some() && other.region == region);
        if let Some(first) = known {
            return Err(section.error("region", format!("is the region of material {first} too; give another")));
        }
        let material = match &region {
            Some(name) => material(&section.clone().called(format!("material.{name}")), body, last)?,
            None => material(&section, body, last)?,
        };
        if matches!(body, Body::Mesh(_)) && region.is_none() && count > 1 {
            return Err(section.missing("region", REGION));
        }
        list.push(material);
    }
    if list.is_empty() { Err(root.missing("material", "the [material] table")) } else { Ok(list) }
}

const REGION: &str = "the name of the physical surface that it fills";

/// The thickness of a stratum, m: of all but the lowest.
fn thickness(section: &Section, body: &Body, last: bool) -> Result<Option<f64>> {
    const THICKNESS: Quantity = Quantity::positive("a positive thickness in m, from the contact face down");

    match body {
        Body::Mesh(_) if section.has("thickness") => {
            Err(section.error("thickness", "is for the strata of a [layer]; give region, a physical surface"))
        }
        Body::Layer(_) if section.has("region") => {
            Err(section.error("region", "is for a [mesh]; give thickness, that of a stratum of the layer"))
        }
        Body::Layer(_) if last && section.has("thickness") => {
            Err(section.error("thickness", "remove it: the last material fills the rest of the layer"))
        }
        Body::Layer(_) if !last => section.number("thickness", THICKNESS).map(Some),
        _ => Ok(None),
    }
}

/// One material; `last` if none follows.
fn material(section: &Section, body: &Body, last: bool) -> Result<Material> {
    const RATIO: Quantity = Quantity {
        what: "a ratio above -1 and below 0.5 (0.5 is incompressible; come near it with, say, 0.499)",
        accepts: |ratio| ratio > -1.0 && ratio < 0.5,
    };
    const RULES: [(&str, PoissonRule); 2] =
        [("constant_ratio", PoissonRule::ConstantRatio), ("constant_bulk_modulus", PoissonRule::ConstantBulkModulus)];
    const MEMORIES: [(&str, Memory); 2] =
        [("exponential", Memory::Exponential), ("backward_euler", Memory::BackwardEuler)];

    section.later(&[
        ("file", "write its table in the scene"),
        ("fractional", "give shear_modulus and arms, a Prony series of the power law"),
        ("bulk_arms", "choose a poisson_rule"),
        ("temperature", NO_TEMPERATURE),
        ("reference_temperature", NO_TEMPERATURE),
        ("wlf", NO_TEMPERATURE),
        ("arrhenius", NO_TEMPERATURE),
    ])?;
    section.only(&[
        "shear_modulus",
        "young_modulus",
        "poisson_ratio",
        "arms",
        "poisson_rule",
        "memory",
        "region",
        "thickness",
    ])?;
    let thickness = thickness(section, body, last)?;
    let poisson_ratio = section.number("poisson_ratio", RATIO)?;
    let arms = arms(section)?;
    let poisson_rule = section.optional_choice("poisson_rule", &RULES, &["bulk_arms"])?;
    if !arms.is_empty() && poisson_rule.is_none() {
        let reason = "missing, and required with arms: give \"constant_ratio\" (the bulk modulus relaxes with the \
                      shear modulus) or \"constant_bulk_modulus\" (it stays)";
        return Err(section.error("poisson_rule", reason));
    }
    Ok(Material {
        region: section.optional_text("region", REGION)?,
        thickness,
        shear_modulus: shear_modulus(section, poisson_ratio)?,
        poisson_ratio,
        arms,
        poisson_rule,
        memory: section.optional_choice("memory", &MEMORIES, &[])?.unwrap_or(Memory::Exponential),
    })
}

/// The instantaneous shear modulus, given as itself or as Young's modulus.
fn shear_modulus(section: &Section, poisson_ratio: f64) -> Result<f64> {
    const MODULUS: Quantity = Quantity::positive("a positive modulus in Pa");

    let shear = section.optional_number("shear_modulus", MODULUS)?;
    let young = section.optional_number("young_modulus", MODULUS)?;
    match (shear, young) {
        (Some(_), Some(_)) => Err(section.error("young_modulus", "give shear_modulus or young_modulus, not both")),
        (Some(shear), None) => Ok(shear),
        (None, Some(young)) => Ok(checks::shear_from_young(young, poisson_ratio)),
        (None, None) => Err(section.missing("shear_modulus", "it, or young_modulus, in Pa")),
    }
}

fn arms(section: &Section) -> Result<Vec<Arm>> {
    const WEIGHT: Quantity = Quantity {
        what: "a share of the instantaneous modulus, above 0 and at most 1",
        accepts: |weight| weight > 0.0 && weight <= 1.0,
    };
    const TIME: Quantity = Quantity::positive("a positive relaxation time in s");

    let arm = |section: &Section| {
        section.only(&["weight", "time"])?;
        Ok(Arm { weight: section.number("weight", WEIGHT)?, time: section.number("time", TIME)? })
    };
    let sections = section.sections("arms", "an array of tables { weight = ..., time = ... }")?;
    let arms: Vec<Arm> = sections.iter().map(arm).collect::<Result<_>>()?;
    checks::weights(&arms).map_err(|reason| section.error("arms", reason))?;
    Ok(arms)
}

fn indenter(section: &Section) -> Result<Indenter> {
    #[derive(Clone, Copy)]
    enum Profile {
        Harmonic,
        Parabola,
        Circle,
        Wedge,
    }
    const PROFILES: [(&str, Profile); 4] = [
        ("harmonic", Profile::Harmonic),
        ("parabola", Profile::Parabola),
        ("circle", Profile::Circle),
        ("wedge", Profile::Wedge),
    ];
    const LATER: [&str; 3] = ["expression", "sampled", "rough"];
    const LENGTH: Quantity = Quantity::positive("a positive length in m");
    const POSITION: Quantity = Quantity::any("a position in m");
    const SLOPE: Quantity = Quantity::positive("a positive slope");

    // The profile decides which keys there are; where it is absent, perhaps it is misspelt.
    if !section.has("profile") {
        section.only(&["profile", "amplitude", "wavelength", "radius", "centre", "slope"])?;
    }
    match section.choice("profile", &PROFILES, &LATER)? {
        Profile::Harmonic => {
            section.only(&["profile", "amplitude", "wavelength"])?;
            let amplitude = section.number("amplitude", LENGTH)?;
            Ok(Indenter::Harmonic { amplitude, wavelength: section.number("wavelength", LENGTH)? })
        }
        Profile::Parabola => {
            section.only(&["profile", "radius", "centre"])?;
            let radius = section.number("radius", LENGTH)?;
            Ok(Indenter::Parabola { radius, centre: section.number("centre", POSITION)? })
        }
        Profile::Circle => {
            section.only(&["profile", "radius", "centre"])?;
            let radius = section.number("radius", LENGTH)?;
            Ok(Indenter::Circle { radius, centre: section.number("centre", POSITION)? })
        }
        Profile::Wedge => {
            section.only(&["profile", "slope", "centre"])?;
            let slope = section.number("slope", SLOPE)?;
            Ok(Indenter::Wedge { slope, centre: section.number("centre", POSITION)? })
        }
    }
}

fn contact(section: &Section) -> Result<Contact> {
    const PENALTY: Quantity = Quantity::positive("a positive stiffness in Pa/m");
    const QUADRATURES: [(&str, Quadrature); 2] = [("nodal", Quadrature::Nodal), ("gauss", Quadrature::Gauss)];

    section.later(&[("tolerance", "give penalty"), ("method", "remove it: contact is enforced by penalty")])?;
    section.only(&["penalty", "quadrature"])?;
    Ok(Contact {
        penalty: section.number("penalty", PENALTY)?,
        quadrature: section.optional_choice("quadrature", &QUADRATURES, &[])?.unwrap_or(Quadrature::Nodal),
    })
}

fn friction(section: &Section) -> Result<Friction> {
    const COEFFICIENT: Quantity = Quantity { what: "a friction coefficient, at least 0", accepts: |f| f >= 0.0 };
    const REGULARISATION: Quantity = Quantity::positive("a positive slip rate in m/s");

    const KEYS: [&str; 3] = ["law", "coefficient", "regularisation"];

    // The law decides which keys there are; where it is absent, perhaps it is misspelt.
    if !section.has("law") {
        section.only(&KEYS)?;
    }
    section.choice("law", &[("coulomb_tanh", ())], &["coulomb_elastic_slip"])?;
    section.only(&KEYS)?;
    Ok(Friction::CoulombTanh {
        coefficient: section.number("coefficient", COEFFICIENT)?,
        regularisation: section.number("regularisation", REGULARISATION)?,
    })
}

fn solver(section: Option<&Section>) -> Result<Solver> {
    const TOLERANCE: Quantity =
        Quantity { what: "a relative tolerance above 0 and below 1", accepts: |value| value > 0.0 && value < 1.0 };
    const STRATEGIES: [(&str, Strategy); 3] =
        [("auto", Strategy::Auto), ("monolithic", Strategy::Monolithic), ("condensed", Strategy::Condensed)];

    let default = Solver { strategy: Strategy::Auto, tolerance: 1e-8 };
    let Some(section) = section else { return Ok(default) };
    section.later(&[("preset", "give tolerance")])?;
    section.only(&["strategy", "tolerance"])?;
    Ok(Solver {
        strategy: section.optional_choice("strategy", &STRATEGIES, &[])?.unwrap_or(default.strategy),
        tolerance: section.optional_number("tolerance", TOLERANCE)?.unwrap_or(default.tolerance),
    })
}

fn output(section: Option<&Section>) -> Result<Output> {
    const STEPS: &str = "a whole number of steps, at least 0";

    let default = Output { interface_every: 1, bulk_at: Vec::new() };
    let Some(section) = section else { return Ok(default) };
    section.only(&["interface_every", "bulk_at", "checkpoint_every"])?;
    if section.optional_count("checkpoint_every", STEPS, 0..=usize::MAX)?.is_some_and(|steps| steps > 0) {
        return Err(section.error("checkpoint_every", "checkpoints are not supported by this version; give 0"));
    }
    let interface_every = section.optional_count("interface_every", STEPS, 0..=usize::MAX)?;
    Ok(Output { interface_every: interface_every.unwrap_or(default.interface_every), bulk_at: bulk_at(section)? })
}

fn bulk_at(section: &Section) -> Result<Vec<When>> {
    const WHAT: &str = "names of phases and times in s";

    let moment = |(index, value): (usize, &toml::Value)| match (value.as_str(), keys::number(value)) {
        (Some(name), _) => Ok(When::PhaseEnd(name.to_owned())),
        (_, Some(time)) if time.is_finite() && time > 0.0 => Ok(When::Time(time)),
        _ => Err(section.must_be(&format!("bulk_at.{index}"), "the name of a phase or a positive time in s", value)),
    };
    section.values("bulk_at", &format!("an array of {WHAT}"))?.iter().enumerate().map(moment).collect()
}
