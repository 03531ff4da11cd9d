//! The body: a layer or a mesh, and its materials.

use Bound::{At, Beyond};

use super::{FROM_ONE, LENGTH, choice, number, one_or_two, table, words};
use crate::scene::keys::kind::{Key, Keys, Kind};
use crate::scene::keys::quantity::{Bound, Quantity};
use crate::scene::{Element, Memory, PoissonRule, Sides};

pub(crate) const SIDES: [(&str, Sides); 4] =
    [("periodic", Sides::Periodic), ("free", Sides::Free), ("roller", Sides::Roller), ("fixed", Sides::Fixed)];
pub(crate) const IN_PLANE: [(&str, Element); 2] = [("q4", Element::Quad4), ("q4_bbar", Element::Quad4Bbar)];
pub(crate) const IN_SPACE: [(&str, Element); 2] = [("h8", Element::Hex8), ("h8_bbar", Element::Hex8Bbar)];
/// Of a mesh, which is in the plane or in space by what its file holds.
pub(crate) const ELEMENTS: [(&str, Element); 4] = [IN_PLANE[0], IN_PLANE[1], IN_SPACE[0], IN_SPACE[1]];

pub(super) static LAYER: Keys = table(
    "A rectangular layer. Its lower face is clamped, its upper face is the contact face, x runs from 0 to width.",
    &[
        one_or_two("width", LENGTH)
            .required()
            .about("in space along x and y; with periodic sides, a whole number of the profile's periods"),
        number("depth", LENGTH).required(),
        Key::new(
            "cells",
            Kind::Cells(
                [
                    "two whole numbers, each at least 1: [along the face, through the depth]",
                    "three whole numbers, each at least 1: [along x, along y, through the depth]",
                ],
                FROM_ONE,
            ),
        )
        .required(),
        // Beyond these the cells at one face have no height to speak of.
        number("grading", Quantity::within("a ratio of cell heights from 1e-6 to 1e6", At(1e-6), At(1e6)))
            .default("1.0")
            .about("height of the lowest cell over that of the top cell; a geometric series"),
        Key::new("sides", Kind::ChoiceOrPair(&words(&SIDES))).required().about("roller: no normal displacement"),
        choice("element", &words(&ELEMENTS)).about("q4, or h8 in space; with _bbar for Poisson ratios near 1/2"),
    ],
);

const CURVES: &str = "an array of names or numbers of physical curves, in space of surfaces";

pub(super) static MESH: Keys = table(
    "A mesh from Gmsh, instead of [layer]: in the plane, or in space where it has tetrahedra or hexahedra.",
    &[
        Key::new("file", Kind::Text("the path of a Gmsh .msh file, relative to the scene")).required(),
        Key::new(
            "contact",
            Kind::Label("the name or number of the physical curve, in space surface, that is the contact face"),
        )
        .required(),
        Key::new("fixed", Kind::Labels(CURVES)).required().about("without displacement"),
        Key::new("roller", Kind::Labels(CURVES))
            .default("[]")
            .about("straight along x or z, in space plane across x, y or z, without displacement across"),
        choice("element", &words(&ELEMENTS))
            .about("q4, or h8 in space; with _bbar for Poisson ratios near 1/2; otherwise fully integrated"),
    ],
);

pub(crate) const RULES: [(&str, PoissonRule); 3] = [
    ("constant_ratio", PoissonRule::ConstantRatio),
    ("constant_bulk_modulus", PoissonRule::ConstantBulkModulus),
    ("bulk_arms", PoissonRule::BulkArms),
];
pub(crate) const MEMORIES: [(&str, Memory); 2] =
    [("exponential", Memory::Exponential), ("backward_euler", Memory::BackwardEuler)];

const MODULUS: Quantity = Quantity::positive("a positive modulus in Pa");
const ARMS: &str = "an array of tables { weight = ..., time = ... }";
const WEIGHT: Quantity =
    Quantity::within("a share of the instantaneous modulus, above 0 and at most 1", Beyond(0.0), At(1.0));
// Rates of smaller ones are no numbers.
const TIME: Quantity =
    Quantity::within("a positive relaxation time in s, at least 2.3e-308", At(f64::MIN_POSITIVE), Bound::None);
// What lies below was meant in degrees Celsius.
const TEMPERATURE: Quantity =
    Quantity::within("a temperature in K, from 100 to 3000 (20 degrees Celsius are 293.15 K)", At(100.0), At(3000.0));

/// The keys of a material that its file has, too.
macro_rules! material {
    ($($more:expr),*) => {
        &[
            number("shear_modulus", MODULUS).about("instantaneous, at t = 0; or young_modulus, or fractional"),
            number("young_modulus", MODULUS).about("instantaneous, at t = 0; instead of shear_modulus"),
            Key::new("fractional", Kind::Table(&FRACTIONAL)),
            number(
                "poisson_ratio",
                Quantity::within(
                    "a ratio above -1 and below 0.5 (0.5 is incompressible; come near it with, say, 0.499)",
                    Beyond(-1.0),
                    Beyond(0.5),
                ),
            )
            .about("instantaneous"),
            Key::new("arms", Kind::Tables(ARMS, &ARM)).default("[]").about("of the shear modulus; none: linear elastic"),
            choice("poisson_rule", &words(&RULES)).about("required with arms: how the bulk modulus goes with the shear modulus"),
            Key::new("bulk_arms", Kind::Tables(ARMS, &ARM)).about("of the bulk modulus, with the poisson_rule of that name"),
            choice("memory", &words(&MEMORIES)).default("\"exponential\"").about("second order in the step, or first"),
            choice("shift", &["wlf", "arrhenius"]).about("how relaxation times go with the temperature"),
            number("reference_temperature", TEMPERATURE).about("with shift: that of the arms"),
            number("temperature", TEMPERATURE).about("with shift: that of the run"),
            number("c1", Quantity::positive("a positive number")).about("of the WLF law"),
            number("c2", Quantity::positive("a positive difference of temperatures in K")).about("of the WLF law"),
            number("activation_energy", Quantity::positive("a positive energy in J/mol")).about("of the Arrhenius law"),
            number("conductivity", Quantity::positive("a positive conductivity in W/m/K")).about("of heat, for [heat]"),
            number("heat_capacity", Quantity::positive("a positive heat capacity per volume in J/m^3/K")).about("for [heat]"),
            Key::new("notes", Kind::Texts("an array of texts")).default("[]").about("copied to the results"),
            Key::new("file", Kind::Text("the path of a material file"))
                .about("a TOML file that holds one [material] table, relative to the scene"),
            $($more),*
        ]
    };
}

/// A file of a material.
pub(crate) static MATERIAL_FILE: Keys =
    table("A material file of mpjr: one [material] table.", &[Key::new("material", Kind::Table(&MATERIAL)).required()]);

static MATERIAL: Keys = table("A linear viscoelastic material.", material!());

pub(super) static FILLING: Keys = table(
    "A linear viscoelastic material; several for strata of a layer, from the face down, or for regions of a mesh.",
    material!(
        Key::new("region", Kind::Label("the name or number of the physical surface, in space volume, that it fills")),
        number("thickness", Quantity::positive("a positive thickness in m, from the contact face down"))
            .about("of a stratum, for all but the last")
    ),
);

static ARM: Keys =
    table("An arm of a Prony series.", &[number("weight", WEIGHT).required(), number("time", TIME).required()]);

static FRACTIONAL: Keys = table(
    "The power law E(t) = modulus t^-order / Gamma(1 - order), as a Prony series.",
    &[
        number("modulus", Quantity::positive("a positive modulus in Pa s^order")).required(),
        number("order", Quantity::within("an order above 0 and below 1", Beyond(0.0), Beyond(1.0))).required(),
        Key::new("arms", Kind::Count("a whole number of arms from 1 to 50", [1, 50]))
            .about("otherwise the fewest that do"),
    ],
);
