//! The bulk half of the residual: a linear operator with memory.
//!
//! The internal force is a sum over parts (modulus times stiffness, each with its own Prony series):
//!
//! ```text
//! f = sum_p K_p y_p,     y_p = mu_0p u + sum_i mu_ip z_i+
//! z_i+ = decay_i z_i + gain_i dt du/dt              (du/dt = (u+ - u)/dt over the step)
//! ```
//!
//! The bulk is linear, so the arms' elongations z_i are nodal fields and no quadrature point has a history. At a given
//! dt the tangent is the constant matrix sum_p c_p K_p, c_p = mu_0p + sum_i mu_ip gain_i. An elastic bulk has no z.

use crate::error::Result;
use crate::petsc::{Matrix, Step, Vector};
use crate::rheology::{Factors, Memory};

/// A stiffness with its modulus, and the share of each arm in its relaxation.
pub struct Part {
    /// Pa times the unit-modulus stiffness.
    pub stiffness: Matrix,
    /// How it relaxes; none = elastic.
    pub series: Option<Series>,
}

/// A Prony series over the bulk's list of arms.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// mu_0
    pub long_term: f64,
    /// mu_i for each arm of the bulk; zero where this part has none.
    pub weights: Vec<f64>,
}

/// The linear viscoelastic body. Without arms it keeps no vector of its own but the one it works in.
pub struct Bulk {
    parts: Vec<Part>,
    memory: Option<State>,
    work: Vector,
}

/// The arms at the last accepted step.
struct State {
    rule: Memory,
    times: Vec<f64>,
    elongations: Vec<Vector>,
    previous: Vector,
    /// For the step length of the last request: factors of the arms and, per part, sum_i mu_i decay_i z_i.
    carried: Option<Carried>,
    effective: Vector,
}

struct Carried {
    /// Not a number when the arms have moved on since.
    dt: f64,
    factors: Vec<Factors>,
    history: Vec<Option<Vector>>,
}

impl Bulk {
    /// A body at rest. `times` are the relaxation times of the arms, s, that the parts' series refer to.
    pub fn new(parts: Vec<Part>, times: Vec<f64>, rule: Memory, layout: &Vector) -> Result<Self> {
        let memory = if times.is_empty() {
            None
        } else {
            let elongations = times.iter().map(|_| layout.like()).collect::<Result<_>>()?;
            let (previous, effective) = (layout.like()?, layout.like()?);
            Some(State { rule, times, elongations, previous, carried: None, effective })
        };
        Ok(Self { parts, memory, work: layout.like()? })
    }

    /// How many nodal fields carry memory.
    pub fn memory_vectors(&self) -> usize {
        self.memory.as_ref().map_or(0, |state| state.elongations.len())
    }

    /// c_p at step length `dt`, per part: the factor of K_p in the tangent.
    pub fn secants(&self, dt: f64) -> Vec<f64> {
        let factors = self.memory.as_ref().map(State::factors_at(dt)).unwrap_or_default();
        self.parts.iter().map(|part| part.series.as_ref().map_or(1.0, |series| series.secant(&factors))).collect()
    }

    /// f = internal force at the trial state, N/m.
    pub fn force(&mut self, step: Step, u: &Vector, rate: &Vector, f: &mut Vector) -> Result<()> {
        f.set(0.0)?;
        self.for_each_effective(step, u, rate, |part, y, work| {
            part.stiffness.multiply(y, work)?;
            f.add(1.0, work)
        })
    }

    /// A matrix for [`Self::tangent`] to fill.
    pub fn new_tangent(&self) -> Result<Matrix> {
        self.parts[0].stiffness.duplicate()
    }

    /// tangent = sum_p c_p K_p at step length `dt`.
    pub fn tangent(&self, dt: f64, tangent: &mut Matrix) -> Result<()> {
        for (i, (part, c)) in self.parts.iter().zip(self.secants(dt)).enumerate() {
            if i == 0 {
                tangent.copy_from(&part.stiffness)?;
                tangent.scale(c)?;
            } else {
                tangent.add(c, &part.stiffness)?;
            }
        }
        Ok(())
    }

    /// Takes the arms to the end of an accepted step: the only place that changes them.
    pub fn commit(&mut self, step: Step, u: &Vector) -> Result<()> {
        let Some(state) = &mut self.memory else { return Ok(()) };
        let factors = State::factors_at(step.dt)(state);
        self.work.copy_from(u)?;
        self.work.add(-1.0, &state.previous)?;
        for (elongation, factor) in state.elongations.iter_mut().zip(&factors) {
            elongation.combine(factor.gain, &self.work, factor.decay)?;
        }
        state.previous.copy_from(u)?;
        if let Some(carried) = &mut state.carried {
            carried.dt = f64::NAN;
        }
        Ok(())
    }

    /// Gives each part's effective displacement y_p = mu_0 u + sum mu_i z_i at the accepted state `u`, m.
    pub fn effective(&mut self, u: &Vector, mut take: impl FnMut(&Vector) -> Result<()>) -> Result<()> {
        for part in &self.parts {
            match (&part.series, &mut self.memory) {
                (Some(series), Some(state)) => {
                    state.effective.copy_from(u)?;
                    state.effective.scale(series.long_term)?;
                    for (weight, elongation) in series.weights.iter().zip(&state.elongations) {
                        if *weight != 0.0 {
                            state.effective.add(*weight, elongation)?;
                        }
                    }
                    take(&state.effective)?;
                }
                _ => take(u)?,
            }
        }
        Ok(())
    }

    /// Calls `apply(part, y_p, work vector)` for each part at a trial state.
    fn for_each_effective(
        &mut self,
        step: Step,
        u: &Vector,
        rate: &Vector,
        mut apply: impl FnMut(&Part, &Vector, &mut Vector) -> Result<()>,
    ) -> Result<()> {
        if let Some(state) = &mut self.memory {
            state.carry(step.dt, &self.parts)?;
        }
        for (p, part) in self.parts.iter().enumerate() {
            match (&part.series, &mut self.memory) {
                (Some(series), Some(State { carried: Some(carried), effective, .. })) => {
                    if let Some(history) = &carried.history[p] {
                        effective.copy_from(history)?;
                    }
                    effective.add(series.long_term, u)?;
                    effective.add(series.gain(&carried.factors) * step.dt, rate)?;
                    apply(part, effective, &mut self.work)?;
                }
                _ => apply(part, u, &mut self.work)?,
            }
        }
        Ok(())
    }
}

impl Series {
    /// sum_i mu_i gain_i
    fn gain(&self, factors: &[Factors]) -> f64 {
        self.weights.iter().zip(factors).map(|(weight, factor)| weight * factor.gain).sum()
    }

    /// mu_0 + sum_i mu_i gain_i
    fn secant(&self, factors: &[Factors]) -> f64 {
        self.long_term + self.gain(factors)
    }
}

impl State {
    fn factors_at(dt: f64) -> impl Fn(&Self) -> Vec<Factors> {
        move |state| state.times.iter().map(|time| state.rule.factors(dt / time)).collect()
    }

    /// Makes `carried` hold for `dt`.
    fn carry(&mut self, dt: f64, parts: &[Part]) -> Result<()> {
        if self.carried.as_ref().is_some_and(|carried| carried.dt == dt) {
            return Ok(());
        }
        let factors = Self::factors_at(dt)(self);
        let mut history = match self.carried.take() {
            Some(carried) => carried.history,
            None => Vec::new(),
        };
        history.resize_with(parts.len(), || None);
        for (part, place) in parts.iter().zip(&mut history) {
            let Some(series) = &part.series else { continue };
            let vector = match place {
                Some(vector) => vector,
                None => place.insert(self.effective.like()?),
            };
            vector.set(0.0)?;
            for ((weight, factor), elongation) in series.weights.iter().zip(&factors).zip(&self.elongations) {
                if *weight != 0.0 {
                    vector.add(weight * factor.decay, elongation)?;
                }
            }
        }
        self.carried = Some(Carried { dt, factors, history });
        Ok(())
    }
}
