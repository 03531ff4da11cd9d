//! The indenter: its profile.

use Bound::{At, Beyond};

use super::{ANY, LENGTH, POSITION, SLOPE, choice, number, one_or_two, words};
use crate::scene::keys::kind::{Decision, Key, Keys, Kind};
use crate::scene::keys::quantity::{Bound, Quantity};
use crate::scene::{Detrend, Extend, Seam};

pub(crate) const EXTENDS: [(&str, Extend); 2] = [("periodic", Extend::Periodic), ("error", Extend::Error)];
pub(crate) const DETRENDS: [(&str, Detrend); 3] =
    [("none", Detrend::None), ("mean", Detrend::Mean), ("line", Detrend::Line)];
pub(crate) const DETRENDS_OF_MAPS: [(&str, Detrend); 3] =
    [("none", Detrend::None), ("mean", Detrend::Mean), ("plane", Detrend::Plane)];
pub(crate) const SEAMS: [(&str, Seam); 2] = [("none", Seam::None), ("blend", Seam::Blend)];

pub(super) static INDENTER: Keys = Keys {
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
        always: &[],
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
