//! The tables of a scene and of a sweep, and what each of their keys takes: the reader, the schema and the messages have
//! it from here. A new key is one line.

mod body;
mod contact;
mod indenter;
mod loading;

use Bound::Beyond;

use super::kind::{Key, Keys, Kind};
use super::quantity::{Bound, Quantity};
use crate::scene::Strategy;

use body::{FILLING, LAYER, MESH};
use contact::{ADHESION, CONTACT, FRICTION, HEAT, WEAR};
use indenter::INDENTER;
use loading::{MOUNT, PHASE};

pub(crate) use body::{ELEMENTS, IN_PLANE, IN_SPACE, MATERIAL_FILE, MEMORIES, RULES, SIDES};
pub(crate) use contact::{ADHESION_LAWS, QUADRATURES, WEAR_LAWS, WEARING};
pub(crate) use indenter::{DETRENDS, DETRENDS_OF_MAPS, EXTENDS, SEAMS};

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
