//! The tables of a scene and of a sweep, and what each of their keys takes: the reader, the schema and the messages have
//! it from here. A new key is one line.

use Bound::{At, Beyond};

use super::kind::{Decision, Key, Keys, Kind};
use super::quantity::{Bound, Quantity};
use crate::scene::adhesion::{NONE as NO_BOND, SHEAR_STRENGTH};
use crate::scene::heat::INSULATED;
use crate::scene::{
    AdhesionLaw, Detrend, Element, Extend, Memory, PoissonRule, Quadrature, Seam, Sides, Strategy, WearLaw, Wearing,
};

const fn table(about: &'static str, keys: &'static [Key]) -> Keys {
    Keys { about, keys, decides: None }
}

const fn number(name: &'static str, quantity: Quantity) -> Key {
    Key::new(name, Kind::Number(quantity))
}

const fn one_or_two(name: &'static str, quantity: Quantity) -> Key {
    Key::new(name, Kind::OneOrTwo(quantity))
}

const fn choice(name: &'static str, words: &'static [&'static str]) -> Key {
    Key::new(name, Kind::Choice(words))
}

/// The words of a list of words and what they stand for.
const fn words<T: Copy, const N: usize>(list: &[(&'static str, T); N]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut at = 0;
    while at < N {
        words[at] = list[at].0;
        at += 1;
    }
    words
}

const ANY: [usize; 2] = [0, usize::MAX];
const FROM_ONE: [usize; 2] = [1, usize::MAX];
const LENGTH: Quantity = Quantity::positive("a positive length in m");
const POSITION: Quantity = Quantity::any("a position in m");
const SLOPE: Quantity = Quantity::positive("a positive slope");
const TOLERANCE: Quantity = Quantity::within("a relative tolerance above 0 and below 1", Beyond(0.0), Beyond(1.0));

/// Of a normal force, unless there is adhesion.
pub(crate) const COMPRESSIVE: &str = "a compressive force in N/m, at least 0";

/// A scene.
pub(crate) static SCENE: Keys = table(
    "A scene of mpjr: a rigid indenter, the body that it is pressed into, and the loading history. SI units.",
    &[
        Key::new("title", Kind::Text("a text on one line"))
            .about("copied to the results; otherwise the stem of the file"),
        Key::new("layer", Kind::Table(&LAYER)),
        Key::new("mesh", Kind::Table(&MESH)),
        Key::new("material", Kind::OneOrTables(&FILLING)).required(),
        Key::new("indenter", Kind::Table(&INDENTER)).required(),
        Key::new("contact", Kind::Table(&CONTACT)).required(),
        Key::new("friction", Kind::Table(&FRICTION)),
        Key::new("heat", Kind::Table(&HEAT)),
        Key::new("mount", Kind::Table(&MOUNT)),
        Key::new("wear", Kind::Table(&WEAR)),
        Key::new("adhesion", Kind::Table(&ADHESION)),
        Key::new("phase", Kind::Tables("an array of tables, [[phase]]", &PHASE)).required(),
        Key::new("solver", Kind::Table(&SOLVER)),
        Key::new("output", Kind::Table(&OUTPUT)),
    ],
);

pub(crate) const SIDES: [(&str, Sides); 4] =
    [("periodic", Sides::Periodic), ("free", Sides::Free), ("roller", Sides::Roller), ("fixed", Sides::Fixed)];
pub(crate) const IN_PLANE: [(&str, Element); 2] = [("q4", Element::Quad4), ("q4_bbar", Element::Quad4Bbar)];
pub(crate) const IN_SPACE: [(&str, Element); 2] = [("h8", Element::Hex8), ("h8_bbar", Element::Hex8Bbar)];
/// Of a mesh, which is in the plane or in space by what its file holds.
pub(crate) const ELEMENTS: [(&str, Element); 4] = [IN_PLANE[0], IN_PLANE[1], IN_SPACE[0], IN_SPACE[1]];

static LAYER: Keys = table(
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

static MESH: Keys = table(
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

static FILLING: Keys = table(
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

pub(crate) const EXTENDS: [(&str, Extend); 2] = [("periodic", Extend::Periodic), ("error", Extend::Error)];
pub(crate) const DETRENDS: [(&str, Detrend); 3] =
    [("none", Detrend::None), ("mean", Detrend::Mean), ("line", Detrend::Line)];
pub(crate) const DETRENDS_OF_MAPS: [(&str, Detrend); 3] =
    [("none", Detrend::None), ("mean", Detrend::Mean), ("plane", Detrend::Plane)];
pub(crate) const SEAMS: [(&str, Seam); 2] = [("none", Seam::None), ("blend", Seam::Blend)];

static INDENTER: Keys = Keys {
    about: "The rigid profile h(x), in m: where it is lowest it touches first. It moves as h(x - s(t)).",
    keys: &[
        choice(
            "profile",
            &[
                "harmonic",
                "parabola",
                "circle",
                "wedge",
                "expression",
                "sampled",
                "rough",
                "paraboloid",
                "sphere",
                "cone",
                "waves",
                "map",
            ],
        )
        .required(),
        one_or_two("amplitude", LENGTH).required().about("h = amplitude (1 - cos(2 pi x / wavelength))"),
        one_or_two("wavelength", LENGTH).required(),
        one_or_two("radius", LENGTH).required(),
        one_or_two("centre", POSITION).required(),
        number("slope", SLOPE).required().about("h = slope |x - centre|"),
        Key::new(
            "formula",
            Kind::Text("a formula of x (in space of x and y) on one line, such as \"5e-4*(1-cos(2*pi*x))\""),
        )
        .required(),
        Key::new("file", Kind::Text("the name of a file of elevations")).required().about("relative to the scene"),
        Key::new("dataset", Kind::Text("the path of a dataset in the HDF5 file")).about("of a map in an .h5 file"),
        one_or_two("spacing", LENGTH).about("from point to point of a map, where its file does not say it"),
        one_or_two("origin", POSITION).about("where the first point of a map is; otherwise what its file says, or 0"),
        Key::new(
            "columns",
            Kind::Columns("two columns, x and elevation, by their numbers from 1 or their titles, such as [1, 3]"),
        )
        .about("otherwise the only two"),
        Key::new("unit", Kind::LengthUnit).about("of both columns; otherwise that of the titles, or m"),
        Key::new("x_unit", Kind::LengthUnit),
        Key::new("z_unit", Kind::LengthUnit),
        Key::new("invert", Kind::Flag).default("false").about("h = -z, for a surface that was measured from above"),
        choice("detrend", &["none", "mean", "line", "plane"]).default("\"none\"").about("what is taken off"),
        number("offset", POSITION).default("0.0").about("added to h"),
        choice("seam", &words(&SEAMS)).default("\"none\"").about("how the ends meet where the profile repeats"),
        choice("extend", &words(&EXTENDS)).required().about("beyond the ends"),
        one_or_two("period", LENGTH),
        number("hurst", Quantity::within("a Hurst exponent above 0 and at most 1", Beyond(0.0), At(1.0))).required(),
        number("rms_slope", SLOPE).about("or rms_height"),
        number("rms_height", LENGTH).about("or rms_slope"),
        number("shortest", LENGTH).required().about("wavelength"),
        number("longest", LENGTH).required().about("wavelength"),
        Key::new("seed", Kind::Count("a whole number, at least 0", ANY)).required(),
    ],
    decides: Some(Decision {
        by: "profile",
        of: &[
            ("harmonic", &["amplitude", "wavelength"]),
            ("parabola", &["radius", "centre"]),
            ("circle", &["radius", "centre"]),
            ("wedge", &["slope", "centre"]),
            ("expression", &["formula"]),
            (
                "sampled",
                &[
                    "file", "columns", "unit", "x_unit", "z_unit", "invert", "detrend", "offset", "seam", "extend",
                    "period",
                ],
            ),
            ("paraboloid", &["radius", "centre"]),
            ("sphere", &["radius", "centre"]),
            ("cone", &["slope", "centre"]),
            ("waves", &["amplitude", "wavelength"]),
            (
                "map",
                &[
                    "file", "dataset", "spacing", "origin", "unit", "x_unit", "z_unit", "invert", "detrend", "offset",
                    "seam", "extend", "period",
                ],
            ),
            ("rough", &["hurst", "rms_slope", "rms_height", "shortest", "longest", "period", "seed"]),
        ],
    }),
};

pub(crate) const QUADRATURES: [(&str, Quadrature); 2] = [("nodal", Quadrature::Nodal), ("gauss", Quadrature::Gauss)];

static CONTACT: Keys = table(
    "How non-penetration is enforced; with nothing in it there is none at all.",
    &[
        number("penalty", Quantity::positive("a positive stiffness in Pa/m")).about("p = -penalty * gap where gap < 0"),
        number("tolerance", TOLERANCE).about("instead of penalty: the share by which it may soften the body"),
        choice("quadrature", &words(&QUADRATURES)).default("\"nodal\""),
        choice("method", &["penalty", "augmented"]).about("augmented: no penetration, whatever stands beside it"),
        number("augmentation_tolerance", TOLERANCE).about("decides nothing any more"),
    ],
);

static FRICTION: Keys = Keys {
    about: "Coulomb's law, itself or regularised. Without this table the contact is frictionless.",
    keys: &[
        choice("law", &["coulomb", "coulomb_tanh", "coulomb_elastic_slip"]).required(),
        Key::new(
            "coefficient",
            Kind::NumberOrFormula(Quantity::within("a friction coefficient, at least 0", At(0.0), Bound::None)),
        )
        .required()
        .about("or a formula of v, p and s, such as \"0.1 + 0.2*exp(-v/1e-3)\""),
        number("shear_limit", Quantity::positive("a positive shear traction in Pa"))
            .about("which the shear does not exceed"),
        Key::new("tables", Kind::Curves("an array of points [x, y]")).about("that the formula names, instead of files"),
        Key::new("checksums", Kind::Texts("an array of texts")).about("of the files, put there where they are read"),
        number("regularisation", Quantity::positive("a positive slip rate in m/s")).required(),
        number("elastic_slip", Quantity::positive("a positive length in m")).required(),
    ],
    decides: Some(Decision {
        by: "law",
        of: &[
            ("coulomb", &["coefficient", "shear_limit", "tables", "checksums"]),
            ("coulomb_tanh", &["coefficient", "shear_limit", "tables", "checksums", "regularisation"]),
            ("coulomb_elastic_slip", &["coefficient", "shear_limit", "tables", "checksums", "elastic_slip"]),
        ],
    }),
};

const KELVIN: Quantity = Quantity::within("a temperature in K, at least 0", At(0.0), Bound::None);

static HEAT: Keys = table(
    "The temperature of the body, which what is dissipated heats. Without this table it is not modelled.",
    &[
        number("initial", KELVIN).required().about("of all of it"),
        Key::new("base", Kind::NumberOrWord(KELVIN, INSULATED, "a temperature in K, at least 0, or \"insulated\""))
            .required()
            .about("of the lower face, of a mesh of what is fixed"),
        Key::new("convection", Kind::Table(&CONVECTION)),
        number("share", Quantity::within("a share from 0 to 1", At(0.0), At(1.0)))
            .default("1.0")
            .about("of the heat of friction that enters the body"),
        Key::new("arms", Kind::Flag).default("false").about("whether what the arms dissipate heats, too"),
        Key::new("coupled", Kind::Flag)
            .default("false")
            .about("whether the temperature of a cell shifts the times of its arms"),
    ],
);

static CONVECTION: Keys = table(
    "To the air beside the contact; without this table the face is insulated there.",
    &[
        number(
            "coefficient",
            Quantity::within("a heat transfer coefficient in W/m^2/K, at least 0", At(0.0), Bound::None),
        )
        .required(),
        number("temperature", KELVIN).required().about("of the air"),
    ],
);

static MOUNT: Keys = table(
    "How the indenter is held: approach and velocity move the far ends. Without this table it is moved itself.",
    &[Key::new("normal", Kind::Table(&NORMAL_MOUNT)), Key::new("tangential", Kind::Table(&TANGENTIAL_MOUNT))],
);

const STIFFNESS: Key =
    number("stiffness", Quantity::within("a stiffness in N/m per m, at least 0", At(0.0), Bound::None)).default("0.0");
const DAMPING: Key =
    number("damping", Quantity::within("a damping in N s/m per m, at least 0", At(0.0), Bound::None)).default("0.0");
const MASS: Key =
    number("mass", Quantity::within("a mass in kg per m, at least 0", At(0.0), Bound::None)).default("0.0");

static NORMAL_MOUNT: Keys = table(
    "A spring and a dashpot beside each other, a mass, and a dead load.",
    &[
        STIFFNESS,
        DAMPING,
        MASS,
        number("load", Quantity::within("a dead load in N/m, at least 0", At(0.0), Bound::None))
            .about("from the first step on"),
    ],
);

static TANGENTIAL_MOUNT: Keys =
    table("A spring and a dashpot beside each other, and a mass.", &[STIFFNESS, DAMPING, MASS]);

pub(crate) const WEARING: [(&str, Wearing); 2] = [("body", Wearing::Body), ("indenter", Wearing::Indenter)];
pub(crate) const WEAR_LAWS: [(&str, WearLaw); 2] = [("archard", WearLaw::Archard), ("energy", WearLaw::Energy)];

static WEAR: Keys = table(
    "How the contact wears. Without this table nothing does.",
    &[
        choice("of", &words(&WEARING)).required().about("what wears"),
        choice("law", &words(&WEAR_LAWS))
            .required()
            .about("archard: rate = coefficient p |w|; energy: coefficient q.w"),
        number("coefficient", Quantity::positive("a positive coefficient in 1/Pa")).required(),
    ],
);

pub(crate) const ADHESION_LAWS: [(&str, AdhesionLaw); 3] =
    [("exponential", AdhesionLaw::Exponential), ("bilinear", AdhesionLaw::Bilinear), ("dugdale", AdhesionLaw::Dugdale)];

static ADHESION: Keys = table(
    "What the surfaces pull each other with across a gap. Without this table nothing does.",
    &[
        choice("law", &words(&ADHESION_LAWS)).required().about("how the pull falls with the gap"),
        number("work", Quantity::positive("a positive work of adhesion in J/m^2")).required(),
        number("range", LENGTH).required().about("over which the pull falls"),
        Key::new(
            "friction",
            Kind::WordOrTable(NO_BOND, &BOND, "\"none\", or a table such as { shear_strength = 1e4 } (Pa)"),
        )
        .default("\"none\"")
        .about("what a closed gap bears along the face without pressure"),
    ],
);

static BOND: Keys = table(
    "What a closed gap bears along the face besides coefficient x p.",
    &[number(SHEAR_STRENGTH, Quantity::positive("a positive shear strength in Pa")).required()],
);

static PHASE: Keys = table(
    "A phase of the loading history, from where the one before left the indenter.",
    &[
        Key::new("name", Kind::Text("a name on one line")).about("otherwise phase-1, ..."),
        number("duration", Quantity::positive("a positive duration in s")).about("or velocity and distance"),
        Key::new("steps", Kind::Count("a whole number of steps, at least 1", FROM_ONE))
            .about("equal ones; or tolerance"),
        number("tolerance", TOLERANCE).about("instead of steps: that of adaptive ones"),
        number("approach", Quantity::any("a normal approach in m")).about("at the end of the phase, linear in time"),
        number("normal_force", Quantity::any(COMPRESSIVE)).about(
            "instead of approach: at the end of the phase, linear in time; below 0, a pull, only with [adhesion]",
        ),
        one_or_two("velocity", Quantity::any("a velocity in m/s")).default("0.0").about("of the indenter along +x"),
        number("distance", Quantity::positive("a positive distance in m")).about("instead of duration"),
        Key::new("tangential", Kind::Table(&TANGENTIAL)),
        Key::new("motion", Kind::FileOrTable("the name of a file of measured motion, relative to the scene", &RECORD))
            .about("instead of approach or normal_force, and velocity"),
    ],
);

static RECORD: Keys = table(
    "The columns of a file of measured motion, as a resolved scene has them.",
    &[
        Key::new("file", Kind::Text("the name of the file")),
        Key::new("checksum", Kind::Text("the checksum of its bytes")).about("put there where the file is read"),
        Key::new("time", Kind::Numbers("an array of times in s")).about("since the phase began"),
        Key::new("approach", Kind::Numbers("an array of approaches in m")),
        Key::new("normal_force", Kind::Numbers("an array of forces in N/m")),
        Key::new("sliding_x", Kind::Numbers("an array of displacements in m")),
        Key::new("sliding_y", Kind::Numbers("an array of displacements in m")),
    ],
);

static TANGENTIAL: Keys = table(
    "The displacement amplitude sin(2 pi cycles t / duration), instead of a velocity.",
    &[
        one_or_two("amplitude", Quantity::any("a length in m")).required(),
        number("cycles", Quantity::positive("a positive number of cycles")).required(),
        one_or_two("phase", Quantity::any("an angle in degrees")).default("0.0").about("where the motion begins"),
    ],
);

pub(crate) const STRATEGIES: [(&str, Strategy); 3] =
    [("auto", Strategy::Auto), ("monolithic", Strategy::Monolithic), ("condensed", Strategy::Condensed)];

static SOLVER: Keys = table(
    "How the scene is solved.",
    &[
        choice("strategy", &words(&STRATEGIES)).default("\"auto\""),
        number("tolerance", TOLERANCE).default("1e-8").about("relative, on the residual"),
        choice("preset", &["fast", "balanced", "reference"]).about("for phases that say neither steps nor tolerance"),
    ],
);

const STEPS: &str = "a whole number of steps, at least 0";

static OUTPUT: Keys = table(
    "What is written.",
    &[
        Key::new("interface_every", Kind::Count(STEPS, ANY))
            .default("1")
            .about("between stored interface profiles; 0: only at the ends of phases; more by default where all take over 1 GB"),
        Key::new("bulk_at", Kind::Moments("an array of names of phases and times in s"))
            .default("[]")
            .about("bulk fields at the ends of these phases and at these times"),
        Key::new("checkpoint_every", Kind::Count(STEPS, ANY)).default("0").about("0: only when a signal stops the run"),
        Key::new("energy", Kind::Flag).default("true").about("whether the energy balance is kept"),
    ],
);

/// A sweep.
pub(crate) static SWEEP: Keys = table(
    "A sweep of mpjr: a scene, and keys of it that vary.",
    &[
        Key::new("scene", Kind::Text("the name of a scene file")).required(),
        Key::new("vary", Kind::Vary).required().about("paths of keys with arrays of values; all combinations"),
        Key::new("follow", Kind::Follow).about("paths of keys with formulas of others"),
    ],
);

/// Of a table whose keys are paths of a scene.
pub(crate) static NONE: Keys = table("", &[]);
