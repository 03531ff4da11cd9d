//! Wear laws: pressure, shear and slip of a step in, worn depth and its derivatives out, all of them scalars.
//!
//! ```text
//! Archard:  dh_w/dt = k p |w|         h_w(t + dt) - h_w(t) = k p m          (Archard, J. Appl. Phys. 24 (1953) 981)
//! energy:   dh_w/dt = k q.w                                = k |q| m        (Fouvry, Kapsa, Vincent, Wear 200 (1996) 186)
//! ```
//!
//! with p, q and the slip m of the end of the step (backward Euler): the worn depth belongs to the gap that decides p. m is what
//! friction counts as slip for good ([`crate::friction::Law::lasting`]).

mod worn;

use crate::friction::{Lasting, Shear};

pub use worn::Worn;

/// How a point of the contact wears.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wear {
    /// What wears.
    pub of: Part,
    /// By which law.
    pub law: Law,
    /// k, 1/Pa.
    pub coefficient: f64,
}

/// What wears.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The face, point by point.
    Body,
    /// The profile, in its own frame.
    Indenter,
}

/// What the rate of wear goes with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// p |w|
    Archard,
    /// q.w
    Energy,
}

/// What a step wears, and the derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Depth {
    /// m
    pub value: f64,
    /// By the pressure at constant slip, m/Pa.
    pub by_pressure: f64,
    /// By the slip at constant pressure, -.
    pub by_slip: f64,
}

impl Wear {
    /// What a point wears that slips under a pressure, Pa, and a shear; without friction that is none.
    pub fn depth(&self, pressure: f64, shear: Shear, slip: Lasting) -> Depth {
        let k = self.coefficient;
        let Lasting { length, by_slip } = slip;
        match self.law {
            Law::Archard => {
                Depth { value: k * pressure * length, by_pressure: k * length, by_slip: k * pressure * by_slip }
            }
            Law::Energy => {
                // What lets nothing slip has a slope that is no number, and no slip.
                let steeper = if length > 0.0 { shear.by_slip * length } else { 0.0 };
                Depth {
                    value: k * shear.shear * length,
                    by_pressure: k * shear.by_pressure * length,
                    by_slip: k * (shear.shear * by_slip + steeper),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::{Circumstances, CoulombTanh, ElasticSlip, Strength};

    /// The derivatives against central differences, for both laws of wear, with a slope of friction and with an elastic slip.
    #[test]
    fn derivatives_are_those_of_the_depth() {
        let strength = || Strength::constant(0.3);
        let frictions: [Box<dyn crate::friction::Law>; 2] = [
            Box::new(CoulombTanh { strength: strength(), regularisation: 0.4 }),
            Box::new(ElasticSlip { strength: strength(), elastic_slip: 0.1 }),
        ];
        for friction in &frictions {
            for law in [Law::Archard, Law::Energy] {
                let wear = Wear { of: Part::Body, law, coefficient: 0.7 };
                let depth = |p: f64, m: f64| {
                    let at = Circumstances { pressure: p, dt: 0.5, resolution: 0.0, slid: 0.0, temperature: 0.0 };
                    wear.depth(p, friction.shear(at, m), friction.lasting(m))
                };
                for (p, m) in [(2.0, 0.05), (3.0, 0.2), (0.5, 0.7)] {
                    let (at, e) = (depth(p, m), 1e-6);
                    let by_pressure = (depth(p + e, m).value - depth(p - e, m).value) / (2.0 * e);
                    let by_slip = (depth(p, m + e).value - depth(p, m - e).value) / (2.0 * e);
                    assert!((at.by_pressure - by_pressure).abs() < 1e-9, "{law:?} {p} {m}");
                    assert!((at.by_slip - by_slip).abs() < 1e-8, "{law:?} {p} {m}: {} {by_slip}", at.by_slip);
                }
            }
        }
    }
}
