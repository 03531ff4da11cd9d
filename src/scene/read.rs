//! The keys of a scene: which there are, what each accepts, and what it becomes. What one key has to do with another
//! is in `checks`.

pub(super) mod phase;

use std::path::Path;

use toml::Table;

use super::keys::{self, Quantity, Section};
use super::{
    Arm, Contact, Friction, Indenter, Layer, Material, Memory, Output, PoissonRule, Quadrature, Scene, Sides, Solver,
    Source, Strategy, When, checks, overrides,
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
        ("mesh", "use [layer]"),
        ("element", "remove it: the element is the 4-node quadrilateral"),
        ("temperature", NO_TEMPERATURE),
        ("reference_temperature", NO_TEMPERATURE),
    ])?;
    root.only(&["title", "layer", "material", "indenter", "contact", "friction", "phase", "solver", "output"])?;
    let mut scene = Scene {
        title: title(&root, file)?,
        layer: layer(&root.section("layer")?)?,
        material: material(&root)?,
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

fn layer(section: &Section) -> Result<Layer> {
    const LENGTH: Quantity = Quantity::positive("a positive length in m");
    // Beyond these the cells at one face have no height to speak of.
    const GRADING: Quantity =
        Quantity { what: "a ratio of cell heights from 1e-6 to 1e6", accepts: |ratio| (1e-6..=1e6).contains(&ratio) };
    const SIDES: [(&str, Sides); 4] =
        [("periodic", Sides::Periodic), ("free", Sides::Free), ("roller", Sides::Roller), ("fixed", Sides::Fixed)];

    section.later(&[("element", "remove it: the element is the 4-node quadrilateral")])?;
    section.only(&["width", "depth", "cells", "grading", "sides"])?;
    Ok(Layer {
        width: section.number("width", LENGTH)?,
        depth: section.number("depth", LENGTH)?,
        cells: section.pair(
            "cells",
            "two whole numbers, each at least 1: [along the face, through the depth]",
            COUNT,
        )?,
        grading: section.optional_number("grading", GRADING)?.unwrap_or(1.0),
        sides: section.choice("sides", &SIDES, &[])?,
    })
}

/// Whole numbers from 1.
const COUNT: std::ops::RangeInclusive<usize> = 1..=usize::MAX;

fn material(root: &Section) -> Result<Material> {
    const RATIO: Quantity = Quantity {
        what: "a ratio above -1 and below 0.5 (0.5 is incompressible; come near it with, say, 0.499)",
        accepts: |ratio| ratio > -1.0 && ratio < 0.5,
    };
    const RULES: [(&str, PoissonRule); 2] =
        [("constant_ratio", PoissonRule::ConstantRatio), ("constant_bulk_modulus", PoissonRule::ConstantBulkModulus)];
    const MEMORIES: [(&str, Memory); 2] =
        [("exponential", Memory::Exponential), ("backward_euler", Memory::BackwardEuler)];

    if root.values("material", "").is_ok_and(|regions| !regions.is_empty()) {
        let reason = "several materials are not supported by this version; give one [material] table";
        return Err(root.error("material", reason));
    }
    let section = root.section("material")?;
    section.later(&[
        ("file", "write its table in the scene"),
        ("fractional", "give shear_modulus and arms, a Prony series of the power law"),
        ("bulk_arms", "choose a poisson_rule"),
        ("temperature", NO_TEMPERATURE),
        ("reference_temperature", NO_TEMPERATURE),
        ("wlf", NO_TEMPERATURE),
        ("arrhenius", NO_TEMPERATURE),
    ])?;
    section.only(&["shear_modulus", "young_modulus", "poisson_ratio", "arms", "poisson_rule", "memory"])?;
    let poisson_ratio = section.number("poisson_ratio", RATIO)?;
    let arms = arms(&section)?;
    let poisson_rule = section.optional_choice("poisson_rule", &RULES, &["bulk_arms"])?;
    if !arms.is_empty() && poisson_rule.is_none() {
        let reason = "missing, and required with arms: give \"constant_ratio\" (the bulk modulus relaxes with the \
                      shear modulus) or \"constant_bulk_modulus\" (it stays)";
        return Err(section.error("poisson_rule", reason));
    }
    Ok(Material {
        shear_modulus: shear_modulus(&section, poisson_ratio)?,
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
    const STRATEGIES: [(&str, Strategy); 2] = [("auto", Strategy::Auto), ("monolithic", Strategy::Monolithic)];

    let default = Solver { strategy: Strategy::Auto, tolerance: 1e-8 };
    let Some(section) = section else { return Ok(default) };
    section.later(&[("preset", "give tolerance")])?;
    section.only(&["strategy", "tolerance"])?;
    Ok(Solver {
        strategy: section.optional_choice("strategy", &STRATEGIES, &["condensed"])?.unwrap_or(default.strategy),
        tolerance: section.optional_number("tolerance", TOLERANCE)?.unwrap_or(default.tolerance),
    })
}

fn output(section: Option<&Section>) -> Result<Output> {
    const STEPS: &str = "a whole number of steps, at least 0";

    let default = Output { interface_every: 1, bulk_at: Vec::new(), checkpoint_every: 0 };
    let Some(section) = section else { return Ok(default) };
    section.only(&["interface_every", "bulk_at", "checkpoint_every"])?;
    let count = |key: &str| section.optional_count(key, STEPS, 0..=usize::MAX);
    Ok(Output {
        interface_every: count("interface_every")?.unwrap_or(default.interface_every),
        bulk_at: bulk_at(section)?,
        checkpoint_every: count("checkpoint_every")?.unwrap_or(default.checkpoint_every),
    })
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
