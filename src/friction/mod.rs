//! Friction laws: pressure and slip in, shear traction and its derivatives out.

use nalgebra::Vector2;

mod coulomb_tanh;
mod elastic_slip;

pub use coulomb_tanh::CoulombTanh;
pub use elastic_slip::ElasticSlip;

/// A friction law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Friction {
    /// Regularised by the slip rate.
    CoulombTanh(CoulombTanh),
    /// Regularised by the slip.
    ElasticSlip(ElasticSlip),
}

/// How a point of the contact slips over a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Slip {
    /// Slip rate w of the indenter relative to the layer, m/s.
    pub rate: f64,
    /// The length of the step, over which the point slips by w dt, s; 0 where the step is over.
    pub dt: f64,
    /// What [`Shear::stuck`] was at the beginning of the step, m.
    pub stuck: f64,
    /// A regularisation sharper than this, m/s, is beyond the digits of the slip rate, and this takes its place.
    pub resolution: f64,
}

/// The shear traction, its derivatives, and what the law remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shear {
    /// q, Pa, on the layer.
    pub shear: f64,
    /// dq/dp at constant slip.
    pub by_pressure: f64,
    /// dq/dw at constant pressure, Pa s/m.
    pub by_rate: f64,
    /// By how much the point has slipped while it was to stick, m, of the sign of the slip: what the regularisation lets
    /// it do.
    pub stuck: f64,
    /// Whether it sticks.
    pub sticks: bool,
}

impl Friction {
    /// The coefficient of friction f, -.
    pub fn coefficient(&self) -> f64 {
        match self {
            Self::CoulombTanh(law) => law.coefficient,
            Self::ElasticSlip(law) => law.coefficient,
        }
    }

    /// The traction at pressure p >= 0, Pa.
    pub fn shear(&self, pressure: f64, slip: Slip) -> Shear {
        match self {
            Self::CoulombTanh(law) => law.shear(pressure, slip),
            Self::ElasticSlip(law) => law.shear(pressure, slip),
        }
    }

    /// The part of a step's slip, m, that is stored and not dissipated, of a point whose slip while sticking came to
    /// `stuck`.
    pub fn stored(&self, slip: Slip, stuck: f64) -> f64 {
        match self {
            Self::CoulombTanh(_) => 0.0,
            Self::ElasticSlip(_) => stuck - slip.stuck,
        }
    }

    /// The slip rate, m/s, at which a point of the contact may be expected to go on from an accepted state when the
    /// indenter's is `drive`; none where friction does not answer to it.
    pub fn expected(&self, slip: Slip, drive: f64) -> Option<f64> {
        match self {
            Self::CoulombTanh(law) => law.expected(slip, drive),
            Self::ElasticSlip(law) => law.expected(slip, drive),
        }
    }

    /// The slip rate, m/s, over which the traction turns from one way to the other in a step of `dt`, s.
    pub fn sharpness(&self, dt: f64) -> f64 {
        match self {
            Self::CoulombTanh(law) => law.regularisation,
            Self::ElasticSlip(law) => law.elastic_slip / dt,
        }
    }

    /// The law with a traction that turns over a slip rate of no less than `sharpness`, m/s, in a step of `dt`, s.
    pub fn softened(self, sharpness: f64, dt: f64) -> Self {
        match self {
            Self::CoulombTanh(law) => {
                Self::CoulombTanh(CoulombTanh { regularisation: law.regularisation.max(sharpness), ..law })
            }
            Self::ElasticSlip(law) => {
                Self::ElasticSlip(ElasticSlip { elastic_slip: law.elastic_slip.max(sharpness * dt), ..law })
            }
        }
    }

    /// The slip rate, m/s, at which the traction is q under the pressure p, given as (q, p), Pa; none where it slips.
    pub fn rate(&self, traction: Vector2<f64>, slip: Slip) -> Option<f64> {
        let share = traction.x / (self.coefficient() * traction.y);
        (share.abs() < 1.0 - 1e-9).then(|| match self {
            Self::CoulombTanh(law) => law.sharpness(slip) * share.atanh(),
            Self::ElasticSlip(law) => (share * law.elastic_slip - slip.stuck) / slip.dt,
        })
    }

    /// The slip rate, m/s, that a Newton step had better take a point to which it takes from one slip to another; none
    /// where that is good enough.
    ///
    /// Where a point slips the law does not answer to its motion, and Newton's method sends it to slip the other way,
    /// then back again, and so on for ever. On its way it must have stuck.
    pub fn limited(&self, from: Slip, to: Slip) -> Option<f64> {
        let [way, other, rest] = match self {
            Self::CoulombTanh(law) => [law.direction(from), law.direction(to), 0.0],
            Self::ElasticSlip(law) => [law.direction(from), law.direction(to), -to.stuck / to.dt],
        };
        (way * other < 0.0).then_some(rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laws() -> [Friction; 2] {
        let tanh = CoulombTanh { coefficient: 0.2, regularisation: 1e-6 };
        let elastic = ElasticSlip { coefficient: 0.2, elastic_slip: 1e-7 };
        [Friction::CoulombTanh(tanh), Friction::ElasticSlip(elastic)]
    }

    /// |q| <= f p, q odd in the slip, and finite at any slip rate.
    #[test]
    fn bounded_by_coulomb_and_odd() {
        for law in laws() {
            for rate in [0.0, 1e-300, 1e-9, 1e-6, 1e-3, 1.0, 1e9, f64::MAX] {
                let at = |rate, stuck| law.shear(3.0, Slip { rate, dt: 0.1, stuck, resolution: 0.0 });
                let (plus, minus) = (at(rate, 3e-8), at(-rate, -3e-8));
                assert!(plus.shear.abs() <= law.coefficient() * 3.0 && plus.shear == -minus.shear);
                assert!(plus.by_rate >= 0.0 && plus.by_rate.is_finite() && plus.by_rate == minus.by_rate);
                assert_eq!((plus.stuck, plus.sticks), (-minus.stuck, minus.sticks));
            }
        }
    }

    /// The derivatives against central differences, sticking and slipping, forward and back.
    #[test]
    fn derivatives_are_those_of_the_traction() {
        for law in laws() {
            for (rate, stuck) in [(0.0, 0.0), (4e-7, 3e-8), (-4e-7, 9e-8), (2e-6, 9e-8), (-5e-6, 1e-7), (3e-8, -1e-7)] {
                let at = |dp: f64, dw: f64| {
                    law.shear(3.0 + dp, Slip { rate: rate + dw, dt: 0.1, stuck, resolution: 0.0 }).shear
                };
                let exact = law.shear(3.0, Slip { rate, dt: 0.1, stuck, resolution: 0.0 });
                let by_pressure = (at(1e-3, 0.0) - at(-1e-3, 0.0)) / 2e-3;
                let by_rate = (at(0.0, 1e-11) - at(0.0, -1e-11)) / 2e-11;
                assert!((by_pressure - exact.by_pressure).abs() < 1e-9, "{law:?} {rate} {stuck}");
                assert!((by_rate / 6e5 - exact.by_rate / 6e5).abs() < 1e-4, "{law:?} {rate} {stuck} {by_rate}");
            }
        }
    }

    /// A step that is over gives the traction that it ended with.
    #[test]
    fn a_step_that_is_over_keeps_its_traction() {
        for law in laws() {
            for (rate, stuck) in [(4e-7, 3e-8), (-4e-7, 9e-8), (2e-6, 9e-8), (-5e-6, 1e-7)] {
                let end = law.shear(3.0, Slip { rate, dt: 0.1, stuck, resolution: 0.0 });
                let after = law.shear(3.0, Slip { rate, dt: 0.0, stuck: end.stuck, resolution: 0.0 });
                assert_eq!((after.shear, after.stuck, after.sticks), (end.shear, end.stuck, end.sticks));
            }
        }
    }
}
