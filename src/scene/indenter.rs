//! The indenter of a scene.

use serde::Serialize;

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
    /// h = the value of a formula of x, m. Not looked into here.
    Expression {
        /// As typed.
        formula: String,
    },
    /// h = the elevations of a file, linear between its points. Not opened here.
    Sampled {
        /// As typed: relative to the directory of the scene file, unless absolute.
        file: String,
        /// What is beyond the ends.
        extend: Extend,
        /// m, > 0, only with [`Extend::Periodic`]; none = the one that the points have by themselves.
        #[serde(skip_serializing_if = "Option::is_none")]
        period: Option<f64>,
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

/// What a sampled profile is beyond its ends.
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
