//! The indenter of a scene.

use nalgebra::Vector2;
use serde::Serialize;

use super::resolved::{one_or_both, optional_one_or_both, optional_pair, pair};

use crate::table::Choice;

/// The rigid profile h(x), m; it moves as h(x - s(t)). Where the approach reaches h, contact begins.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "profile", rename_all = "lowercase")]
pub enum Indenter {
    /// h = amplitude (1 - cos(2 pi x / wavelength)); both > 0.
    Harmonic {
        /// m
        amplitude: f64,
        /// m
        wavelength: f64,
    },
    /// h = (x - centre)^2 / (2 radius); radius > 0.
    Parabola {
        /// m
        radius: f64,
        /// m
        centre: f64,
    },
    /// The exact arc of a circle; radius > 0.
    Circle {
        /// m
        radius: f64,
        /// m
        centre: f64,
    },
    /// h = slope |x - centre|; slope > 0.
    Wedge {
        /// -
        slope: f64,
        /// m
        centre: f64,
    },
    /// In space: h = (x - xc)^2/(2 Rx) + (y - yc)^2/(2 Ry); radii > 0.
    Paraboloid {
        /// m
        #[serde(serialize_with = "one_or_both")]
        radius: Vector2<f64>,
        /// m
        #[serde(serialize_with = "pair")]
        centre: Vector2<f64>,
    },
    /// In space: the exact lower half of a sphere; radius > 0.
    Sphere {
        /// m
        radius: f64,
        /// m
        #[serde(serialize_with = "pair")]
        centre: Vector2<f64>,
    },
    /// In space: h = slope r; slope > 0.
    Cone {
        /// -
        slope: f64,
        /// m
        #[serde(serialize_with = "pair")]
        centre: Vector2<f64>,
    },
    /// In space: h = ax (1 - cos(2 pi x / lx)) + ay (1 - cos(2 pi y / ly)); all > 0.
    Waves {
        /// m
        #[serde(serialize_with = "one_or_both")]
        amplitude: Vector2<f64>,
        /// m
        #[serde(serialize_with = "one_or_both")]
        wavelength: Vector2<f64>,
    },
    /// h = the value of a formula of x, and in space of y, m. Not looked into here.
    Expression {
        /// As typed.
        formula: String,
    },
    /// h = the elevations of a file, linear between its points. Not opened here.
    Sampled {
        /// As typed: relative to the directory of the scene file, unless absolute.
        file: String,
        /// What its columns are and what is done to them.
        #[serde(flatten)]
        reading: Reading,
        /// What is beyond the ends.
        extend: Extend,
        /// m, > 0, only with [`Extend::Periodic`]; none = the one that the points have by themselves.
        #[serde(skip_serializing_if = "Option::is_none")]
        period: Option<f64>,
    },
    /// In space: h = the heights of a file over a grid, bilinear between them. Not opened here.
    Map {
        /// As typed: relative to the directory of the scene file, unless absolute. Its ending is a known one.
        file: String,
        /// Of an HDF5 file, the path of the dataset in it.
        #[serde(skip_serializing_if = "Option::is_none")]
        dataset: Option<String>,
        /// From point to point along x and y, m, > 0; just where the file does not say it.
        #[serde(serialize_with = "optional_one_or_both", skip_serializing_if = "Option::is_none")]
        spacing: Option<Vector2<f64>>,
        /// Where its first point is, m; none = what the file says, else 0.
        #[serde(serialize_with = "optional_pair", skip_serializing_if = "Option::is_none")]
        origin: Option<Vector2<f64>>,
        /// What is done to the heights; it has no columns.
        #[serde(flatten)]
        reading: Reading,
        /// What is beyond the edges.
        extend: Extend,
        /// m, > 0, only with [`Extend::Periodic`]; none = those that the points have by themselves.
        #[serde(serialize_with = "optional_one_or_both", skip_serializing_if = "Option::is_none")]
        period: Option<Vector2<f64>>,
    },
    /// Self-affine: random phases, amplitudes ~ n^-(hurst + 1/2).
    Rough {
        /// In (0, 1].
        hurst: f64,
        /// How steep or high it is over a period.
        #[serde(flatten)]
        rms: Rms,
        /// Shortest wavelength, m, > 0.
        shortest: f64,
        /// Longest wavelength, m, >= shortest.
        longest: f64,
        /// m, >= longest; what the profile repeats after. At least one wave of it is between shortest and longest.
        period: f64,
        /// The same seed makes the same profile.
        seed: u64,
    },
}

impl Indenter {
    /// Whether it is for scenes in space alone.
    pub fn needs_space(&self) -> bool {
        matches!(
            self,
            Self::Paraboloid { .. } | Self::Sphere { .. } | Self::Cone { .. } | Self::Waves { .. } | Self::Map { .. }
        )
    }
}

/// From the numbers of a file to the elevation of the indenter's lower surface above its datum, in this order.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Reading {
    /// x and elevation; none = the file has no others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub columns: Option<[Choice; 2]>,
    /// The unit of x, by its name; none = what the file says, else m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x_unit: Option<&'static str>,
    /// The unit of the elevation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z_unit: Option<&'static str>,
    /// Whether the file's elevations point out of the indenter: its peaks are to touch first.
    pub invert: bool,
    /// What is taken off.
    pub detrend: Detrend,
    /// m, added to h at the end.
    pub offset: f64,
    /// How the ends of a period meet.
    pub seam: Seam,
}

/// What is taken off measured elevations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Detrend {
    /// Nothing.
    #[default]
    None,
    /// Their mean.
    Mean,
    /// The straight line of least squares through the points.
    Line,
    /// Of a map, the plane of least squares.
    Plane,
}

/// How the ends of a period meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Seam {
    /// As they are.
    #[default]
    None,
    /// Both go over into the mean of the two.
    Blend,
}

/// What a measured profile is beyond its ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Extend {
    /// The same again.
    Periodic,
    /// Not known: a scene that reaches there is refused.
    Error,
}

/// A root mean square, > 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Rms {
    /// Of dh/dx.
    RmsSlope(f64),
    /// Of h about its mean, m.
    RmsHeight(f64),
}
