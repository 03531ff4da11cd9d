//! What moves the indenter: its mount, and the phases of the history.

use Bound::At;

use super::{COMPRESSIVE, FROM_ONE, TOLERANCE, number, one_or_two, table};
use crate::scene::keys::kind::{Key, Keys, Kind};
use crate::scene::keys::quantity::{Bound, Quantity};

pub(super) static MOUNT: Keys = table(
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

pub(super) static PHASE: Keys = table(
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
