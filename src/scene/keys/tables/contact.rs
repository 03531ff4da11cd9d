//! What happens where both touch: non-penetration, friction, wear, adhesion and heat.

use Bound::At;

use super::{LENGTH, TOLERANCE, choice, number, table, words};
use crate::friction::KINDS;
use crate::scene::adhesion::{NONE as NO_BOND, SHEAR_STRENGTH};
use crate::scene::heat::INSULATED;
use crate::scene::keys::kind::{Decision, Key, Keys, Kind};
use crate::scene::keys::quantity::{Bound, Quantity};
use crate::scene::{AdhesionLaw, Quadrature, WearLaw, Wearing};

pub(crate) const QUADRATURES: [(&str, Quadrature); 2] = [("nodal", Quadrature::Nodal), ("gauss", Quadrature::Gauss)];

pub(super) static CONTACT: Keys = table(
    "How non-penetration is enforced; with nothing in it there is none at all.",
    &[
        number("penalty", Quantity::positive("a positive stiffness in Pa/m")).about("p = -penalty * gap where gap < 0"),
        number("tolerance", TOLERANCE).about("instead of penalty: the share by which it may soften the body"),
        choice("quadrature", &words(&QUADRATURES)).default("\"nodal\""),
        choice("method", &["penalty", "augmented"]).about("augmented: no penetration, whatever stands beside it"),
        number("augmentation_tolerance", TOLERANCE).about("decides nothing any more"),
    ],
);

pub(super) static FRICTION: Keys = Keys {
    about: "Coulomb's law, itself or regularised. Without this table the contact is frictionless.",
    keys: &FRICTION_KEYS,
    decides: Some(Decision {
        by: "law",
        always: &["coefficient", "shear_limit", "tables", "checksums"],
        of: &SOFTNESSES,
    }),
};

/// Of each law, by its word, the key of what it is softened by.
const SOFTNESSES: [(&str, &[&str]); KINDS.len()] = {
    let mut all: [(&str, &[&str]); KINDS.len()] = [("", &[]); KINDS.len()];
    let mut i = 0;
    while i < KINDS.len() {
        all[i].0 = KINDS[i].name;
        if let Some(softness) = &KINDS[i].softness {
            all[i].1 = std::slice::from_ref(&softness.key);
        }
        i += 1;
    }
    all
};

const OF_ANY_LAW: [Key; 5] = [
    choice("law", &words(&SOFTNESSES)).required(),
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
];

const SOFT: usize = {
    let (mut soft, mut i) = (0, 0);
    while i < KINDS.len() {
        soft += KINDS[i].softness.is_some() as usize;
        i += 1;
    }
    soft
};

/// The keys of any law, and what each is softened by.
const FRICTION_KEYS: [Key; OF_ANY_LAW.len() + SOFT] = {
    let mut keys = [OF_ANY_LAW[0]; OF_ANY_LAW.len() + SOFT];
    let (mut count, mut i) = (0, 0);
    while count < OF_ANY_LAW.len() {
        keys[count] = OF_ANY_LAW[count];
        count += 1;
    }
    while i < KINDS.len() {
        if let Some(softness) = &KINDS[i].softness {
            keys[count] = number(softness.key, Quantity::positive(softness.what)).required();
            count += 1;
        }
        i += 1;
    }
    keys
};

pub(crate) const WEARING: [(&str, Wearing); 2] = [("body", Wearing::Body), ("indenter", Wearing::Indenter)];
pub(crate) const WEAR_LAWS: [(&str, WearLaw); 2] = [("archard", WearLaw::Archard), ("energy", WearLaw::Energy)];

pub(super) static WEAR: Keys = table(
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

pub(super) static ADHESION: Keys = table(
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

const KELVIN: Quantity = Quantity::within("a temperature in K, at least 0", At(0.0), Bound::None);

pub(super) static HEAT: Keys = table(
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
