//! The arms of the bulk: nodal fields that carry its memory.

use super::springs::{Products, Springs};
use crate::error::Result;
use crate::petsc::{Step, Vector};
use crate::rheology::{Factors, Memory};
use crate::snapshot::{NaturalOrder, Snapshot};

/// A Prony series over a list of arms.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// mu_0
    pub long_term: f64,
    /// mu_i for each arm; zero for one that the series does not have.
    pub weights: Vec<f64>,
}

/// The elongations z_i of the arms' springs at the last accepted step.
pub struct Arms {
    rule: Memory,
    times: Vec<f64>,
    elongations: Vec<Vector>,
    previous: Vector,
    work: Vector,
    effective: Vector,
    carried: Carried,
}

/// What the arms bring into a step of one length: made once per step and length.
struct Carried {
    /// Not a number when the arms have moved on since.
    dt: f64,
    factors: Vec<Factors>,
    /// Per series, sum_i mu_i decay_i z_i, and whether it holds for `dt`.
    history: Vec<(Vector, bool)>,
}

impl Series {
    /// sum_i mu_i gain_i
    pub fn gain(&self, factors: &[Factors]) -> f64 {
        self.weights.iter().zip(factors).map(|(weight, factor)| weight * factor.gain).sum()
    }

    /// c = mu_0 + sum_i mu_i gain_i: what a displacement of this step answers with.
    pub fn secant(&self, factors: &[Factors]) -> f64 {
        self.long_term + self.gain(factors)
    }
}

impl Arms {
    /// Arms at rest with the given relaxation times, s.
    pub fn new(times: Vec<f64>, rule: Memory, layout: &Vector) -> Result<Self> {
        Ok(Self {
            elongations: times.iter().map(|_| layout.like()).collect::<Result<_>>()?,
            previous: layout.like()?,
            work: layout.like()?,
            effective: layout.like()?,
            carried: Carried { dt: f64::NAN, factors: Vec::new(), history: Vec::new() },
            rule,
            times,
        })
    }

    /// The same arms, at rest.
    pub fn at_rest(&self, layout: &Vector) -> Result<Self> {
        Self::new(self.times.clone(), self.rule, layout)
    }

    /// The u of the last accepted step.
    pub fn last(&self) -> &Vector {
        &self.previous
    }

    /// How many fields carry memory.
    pub fn len(&self) -> usize {
        self.elongations.len()
    }

    /// Whether nothing is remembered.
    pub fn is_empty(&self) -> bool {
        self.elongations.is_empty()
    }

    /// The factors of the arms over a step of length `dt`, s.
    pub fn factors(&self, dt: f64) -> Vec<Factors> {
        self.times.iter().map(|time| self.rule.factors(dt / time)).collect()
    }

    /// Takes the springs of a part to the end of a step that ends at `u`, before [`Self::commit`]; `v` = K (u+ - u). Gives
    /// what the dashpots took, J/m.
    pub fn spend(&mut self, series: &Series, step: Step, u: &Vector, v: &Vector, springs: &mut Springs) -> Result<f64> {
        let change = self.change(u)?.dot(v)?;
        let on = |(weight, elongation): (&f64, &Vector)| if *weight == 0.0 { Ok(0.0) } else { elongation.dot(v) };
        let products = Products {
            sum: change + 2.0 * self.previous.dot(v)?,
            change,
            arms: series.weights.iter().zip(&self.elongations).map(on).collect::<Result<_>>()?,
        };
        let of_step = |time: &f64| (self.rule.factors(step.dt / time), self.rule.losses(step.dt / time));
        Ok(springs.advance(series, &products, &self.times.iter().map(of_step).collect::<Vec<_>>()))
    }

    /// u+ - u for a step that ends at `u`.
    pub fn change(&mut self, u: &Vector) -> Result<&Vector> {
        self.work.copy_from(u)?;
        self.work.add(-1.0, &self.previous)?;
        Ok(&self.work)
    }

    /// y = mu_0 u + sum mu_i (decay_i z_i + gain_i dt rate) at a trial state, m. `index` numbers the series.
    pub fn trial(
        &mut self,
        (index, series): (usize, &Series),
        step: Step,
        u: &Vector,
        rate: &Vector,
    ) -> Result<&Vector> {
        self.carry(index, series, step.dt)?;
        self.effective.copy_from(&self.carried.history[index].0)?;
        self.effective.add(series.long_term, u)?;
        self.effective.add(series.gain(&self.carried.factors) * step.dt, rate)?;
        Ok(&self.effective)
    }

    /// The u at the end of a step that gives this y: the inverse of [`Self::trial`].
    pub fn answering(&mut self, series: &Series, step: Step, y: &Vector) -> Result<&Vector> {
        self.carry(0, series, step.dt)?;
        let factors = &self.carried.factors;
        let (gain, secant) = (series.gain(factors), series.secant(factors));
        self.effective.copy_from(y)?;
        self.effective.add(-1.0, &self.carried.history[0].0)?;
        self.effective.add(gain, &self.previous)?;
        self.effective.scale(1.0 / secant)?;
        Ok(&self.effective)
    }

    /// y = mu_0 u + sum mu_i z_i at the accepted state `u`, m.
    pub fn accepted(&mut self, series: &Series, u: &Vector) -> Result<&Vector> {
        self.effective.copy_from(u)?;
        self.effective.scale(series.long_term)?;
        for (weight, elongation) in series.weights.iter().zip(&self.elongations) {
            if *weight != 0.0 {
                self.effective.add(*weight, elongation)?;
            }
        }
        Ok(&self.effective)
    }

    /// Takes the arms to the end of an accepted step: the only place that changes them.
    pub fn commit(&mut self, step: Step, u: &Vector) -> Result<()> {
        let factors = self.factors(step.dt);
        self.change(u)?;
        for (elongation, factor) in self.elongations.iter_mut().zip(&factors) {
            elongation.combine(factor.gain, &self.work, factor.decay)?;
        }
        self.previous.copy_from(u)?;
        self.carried.dt = f64::NAN;
        Ok(())
    }

    /// Adds the elongations to a snapshot, under `name`.
    pub fn save(&self, name: &str, order: &mut NaturalOrder, snapshot: &mut Snapshot) -> Result<()> {
        let mut arms = self.elongations.iter().enumerate();
        arms.try_for_each(|(index, elongation)| order.save(format!("{name}-{index}"), elongation, snapshot))
    }

    /// Takes the elongations at the accepted state `u` from a snapshot.
    pub fn restore(&mut self, name: &str, order: &NaturalOrder, snapshot: &Snapshot, u: &Vector) -> Result<()> {
        for (index, elongation) in self.elongations.iter_mut().enumerate() {
            order.restore(&format!("{name}-{index}"), elongation, snapshot)?;
        }
        self.previous.copy_from(u)?;
        self.carried.dt = f64::NAN;
        Ok(())
    }

    /// Makes `carried` hold for `dt` and the series.
    fn carry(&mut self, index: usize, series: &Series, dt: f64) -> Result<()> {
        if self.carried.dt != dt {
            self.carried.factors = self.factors(dt);
            self.carried.dt = dt;
            self.carried.history.iter_mut().for_each(|(_, holds)| *holds = false);
        }
        while self.carried.history.len() <= index {
            self.carried.history.push((self.effective.like()?, false));
        }
        let Carried { factors, history, .. } = &mut self.carried;
        let (sum, holds) = &mut history[index];
        if *holds {
            return Ok(());
        }
        sum.set(0.0)?;
        for ((weight, factor), elongation) in series.weights.iter().zip(factors).zip(&self.elongations) {
            if *weight != 0.0 {
                sum.add(*weight * factor.decay, elongation)?;
            }
        }
        *holds = true;
        Ok(())
    }
}
