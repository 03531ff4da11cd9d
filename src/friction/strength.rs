//! How much shear a point bears: the coefficient of friction, a number or a formula, and a limit.

use std::sync::Arc;

use super::Circumstances;
use crate::expression::{Dual, Expression};

/// |q| <= B = min(f p + bond, limit), with the coefficient that belongs to the end of the step.
#[derive(Debug, Clone)]
pub struct Strength {
    coefficient: Coefficient,
    /// Pa; infinite = none.
    limit: f64,
    /// What a closed gap bears without pressure, Pa.
    bond: f64,
}

/// The coefficient of friction f, -.
#[derive(Debug, Clone)]
pub enum Coefficient {
    /// At least 0.
    Constant(f64),
    /// Of the [`VARIABLES`].
    Formula(Arc<Expression>),
}

/// The variables of a coefficient: slip rate, m/s; pressure, Pa; slid distance, m; temperature of the face at the beginning of the
/// step, K.
pub const VARIABLES: [&str; 4] = ["v", "p", "s", "T"];
/// The place of the temperature among them.
pub const TEMPERATURE: usize = 3;

/// B and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// Pa
    pub value: f64,
    /// dB/dm at constant pressure, Pa/m.
    pub by_slip: f64,
    /// dB/dp at constant slip.
    pub by_pressure: f64,
}

/// What a point slips for good over a step, m, and the derivative of that by its slip m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lasting {
    /// m
    pub length: f64,
    /// -
    pub by_slip: f64,
}

impl Strength {
    /// Coulomb's.
    pub fn constant(coefficient: f64) -> Self {
        Self { coefficient: Coefficient::Constant(coefficient), limit: f64::INFINITY, bond: 0.0 }
    }

    /// With a limit, Pa, if there is one.
    pub fn new(coefficient: Coefficient, limit: Option<f64>) -> Self {
        Self { coefficient, limit: limit.unwrap_or(f64::INFINITY), bond: 0.0 }
    }

    /// That bears `bond`, Pa, besides, where the gap is closed, whatever the pressure.
    pub fn bonded(self, bond: f64) -> Self {
        Self { bond, ..self }
    }

    /// What a closed gap bears without pressure, Pa.
    pub fn bond(&self) -> f64 {
        self.bond
    }

    /// Whether B changes with what a point has slid.
    pub fn remembers(&self) -> bool {
        matches!(&self.coefficient, Coefficient::Formula(formula) if formula.has(2))
    }

    /// Whether B changes with the slip.
    pub fn varies(&self) -> bool {
        match &self.coefficient {
            Coefficient::Constant(_) => false,
            Coefficient::Formula(formula) => formula.has(0) || formula.has(2),
        }
    }

    /// Whether B changes with the temperature.
    pub fn knows_temperature(&self) -> bool {
        matches!(&self.coefficient, Coefficient::Formula(formula) if formula.has(TEMPERATURE))
    }

    /// B of a point that slips. Where a formula is negative or not finite there is no friction; see [`Self::fault`].
    pub fn at(&self, at: Circumstances, slip: Lasting) -> Bound {
        let [f, by_slip, by_pressure] = match &self.coefficient {
            Coefficient::Constant(f) => [*f, 0.0, 0.0],
            Coefficient::Formula(formula) => {
                let along = formula.at(&along(at, slip));
                let across = if formula.has(1) { formula.at(&across(at, slip)).slope } else { 0.0 };
                let finite = |slope: f64| if slope.is_finite() { slope } else { 0.0 };
                match along.value >= 0.0 && along.value.is_finite() {
                    true => [along.value, finite(along.slope), finite(across)],
                    false => [0.0; 3],
                }
            }
        };
        let pressure = at.pressure;
        let value = f * pressure + self.bond;
        match value > self.limit {
            true => Bound { value: self.limit, by_slip: 0.0, by_pressure: 0.0 },
            false => Bound { value, by_slip: by_slip * pressure, by_pressure: f + by_pressure * pressure },
        }
    }

    /// How steeply B falls with the slip at most, Pa/m, at a pressure and after a slid distance, as far as samples of the rate
    /// tell; 0 where it does not.
    pub fn steepest_fall(&self, at: Circumstances) -> f64 {
        let falls = self.samples(at).map(|(_, f)| -f.slope).filter(|fall| fall.is_finite());
        at.pressure * falls.fold(0.0, f64::max)
    }

    /// The rate at which f is least, m/s, as far as samples tell; 0 where it does not change.
    pub fn weakest(&self, at: Circumstances) -> f64 {
        let known = self.samples(at).filter(|(_, f)| f.value >= 0.0);
        known.min_by(|(_, f), (_, g)| f.value.total_cmp(&g.value)).map_or(0.0, |(rate, _)| rate)
    }

    /// f along the slip at rest and at rates over many decades; none where it does not change with the slip.
    fn samples(&self, at: Circumstances) -> impl Iterator<Item = (f64, Dual)> {
        /// Decades of the rate, m/s, and samples in each.
        const DECADES: [i32; 2] = [-12, 3];
        const SAMPLES: i32 = 8;
        let formula = match &self.coefficient {
            Coefficient::Formula(formula) if self.varies() => Some(formula),
            _ => None,
        };
        let rates = || {
            let powers = DECADES[0] * SAMPLES..=DECADES[1] * SAMPLES;
            std::iter::once(0.0).chain(powers.map(|i| 10f64.powf(f64::from(i) / f64::from(SAMPLES))))
        };
        let slip = move |rate: f64| Lasting { length: rate * at.dt, by_slip: 1.0 };
        let of = move |formula: &Arc<Expression>, rate: f64| (rate, formula.at(&along(at, slip(rate))));
        formula.into_iter().flat_map(move |formula| rates().map(move |rate| of(formula, rate)))
    }

    /// What is wrong with the coefficient of a point that slips; none where it is a finite number, at least 0.
    pub fn fault(&self, at: Circumstances, slip: Lasting) -> Option<String> {
        let Coefficient::Formula(formula) = &self.coefficient else { return None };
        let variables = along(at, slip);
        let value = formula.at(&variables).value;
        let [v, p, s, temperature] = variables.map(|variable| variable.value);
        let warm = if self.knows_temperature() { format!(", T = {temperature:.6e} K") } else { String::new() };
        (!(value >= 0.0 && value.is_finite())).then(|| {
            format!("friction.coefficient is {value:.6} at v = {v:.6e} m/s, p = {p:.6e} Pa, s = {s:.6e} m{warm}, which the contact met: it must be a finite number, at least 0")
        })
    }
}

/// The variables, with their slopes along the slip.
fn along(at: Circumstances, Lasting { length, by_slip }: Lasting) -> [Dual; 4] {
    let rate = Dual { value: length / at.dt, slope: by_slip / at.dt };
    let slid = Dual { value: at.slid + length, slope: by_slip };
    [rate, Dual::constant(at.pressure), slid, Dual::constant(at.temperature)]
}

/// The variables, with their slopes along the pressure.
fn across(at: Circumstances, slip: Lasting) -> [Dual; 4] {
    let [v, p, s, temperature] = along(at, slip).map(|variable| variable.value);
    [Dual::constant(v), Dual::variable(p), Dual::constant(s), Dual::constant(temperature)]
}
