//! The nonlinear half of the identification: moduli and times together, by Levenberg and Marquardt.
//!
//! The unknowns are logarithms of the moduli, so that they stay positive whatever the step, and angles of the times:
//! ln time = middle + half sin(angle) stays in a band. Beyond a decade past the data a time means nothing, and the
//! modulus that belongs to it has no bound.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra_lm::{DMatrix, DVector, Dyn, storage::Owned};

use super::{Residuals, Samples, Stop};
use crate::rheology::Band;

/// The relative change of the residual norm or of the unknowns below which the iteration ends.
const TOLERANCE: f64 = 1e-15;

/// A series in absolute moduli: M(t) = spring + sum modulus_i exp(-t/time_i).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Moduli {
    /// The long-term modulus; none = it is zero by construction, not an unknown.
    pub spring: Option<f64>,
    /// Modulus and relaxation time of each arm.
    pub arms: Vec<(f64, f64)>,
}

impl Moduli {
    /// M(0).
    pub fn instantaneous(&self) -> f64 {
        self.spring.unwrap_or(0.0) + self.arms.iter().map(|arm| arm.0).sum::<f64>()
    }

    /// The relaxation times.
    pub fn times(&self) -> Vec<f64> {
        self.arms.iter().map(|arm| arm.1).collect()
    }

    /// The largest share that the spring and each arm have of what the series gives at any of the data.
    pub fn shares(&self, samples: &Samples) -> Vec<f64> {
        let whole = self.predict(samples);
        let share = |modulus: f64, unit: Vec<f64>| {
            unit.iter().zip(&whole).map(|(unit, whole)| modulus * unit / floor(*whole)).fold(0.0, f64::max)
        };
        let spring = share(self.spring.unwrap_or(0.0), samples.spring());
        std::iter::once(spring)
            .chain(self.arms.iter().map(|&(modulus, time)| share(modulus, samples.arm(time))))
            .collect()
    }

    /// What the series gives where the data are.
    pub fn predict(&self, samples: &Samples) -> Vec<f64> {
        let spring = self.spring.unwrap_or(0.0);
        let mut values: Vec<f64> = samples.spring().iter().map(|unit| spring * unit).collect();
        for &(modulus, time) in &self.arms {
            for (value, unit) in values.iter_mut().zip(samples.arm(time)) {
                *value += modulus * unit;
            }
        }
        values
    }

    /// The derivative of the residuals with respect to \[ln spring\], the ln moduli and the ln times, by columns.
    pub fn jacobian(&self, samples: &Samples, residuals: Residuals) -> Vec<Vec<f64>> {
        let row_scale: Vec<f64> = match residuals {
            Residuals::Linear => vec![1.0; samples.values.len()],
            Residuals::Relative => self.predict(samples).iter().map(|value| 1.0 / floor(*value)).collect(),
        };
        let column = |modulus: f64, unit: Vec<f64>| -> Vec<f64> {
            unit.iter().zip(&row_scale).map(|(unit, scale)| modulus * unit * scale).collect()
        };
        let spring = self.spring.map(|spring| column(spring, samples.spring()));
        let moduli = self.arms.iter().map(|&(modulus, time)| column(modulus, samples.arm(time)));
        let times = self.arms.iter().map(|&(modulus, time)| column(modulus, samples.arm_slope(time)));
        spring.into_iter().chain(moduli).chain(times).collect()
    }

    /// Model minus data, or ln(model/data).
    pub fn residuals(&self, samples: &Samples, residuals: Residuals) -> Vec<f64> {
        let pairs = self.predict(samples).into_iter().zip(&samples.values);
        match residuals {
            Residuals::Linear => pairs.map(|(model, value)| model - value).collect(),
            Residuals::Relative => pairs.map(|(model, value)| (floor(model) / value).ln()).collect(),
        }
    }

    /// The sum of the squared residuals.
    pub fn cost(&self, samples: &Samples, residuals: Residuals) -> f64 {
        self.residuals(samples, residuals).iter().map(|r| r * r).sum()
    }

    /// The unknowns: \[ln spring\], ln moduli, angles of the times.
    fn unknowns(&self, bounds: Bounds) -> DVector<f64> {
        let moduli = self.arms.iter().map(|arm| arm.0.ln());
        let times = self.arms.iter().map(|arm| bounds.angle(arm.1));
        let all: Vec<f64> = self.spring.map(f64::ln).into_iter().chain(moduli).chain(times).collect();
        DVector::from_vec(all)
    }

    /// The series with these unknowns in place of its own. Far-off trial steps are held within what doubles can
    /// square; no minimum lies there.
    fn with_unknowns(&self, unknowns: &DVector<f64>, bounds: Bounds) -> Self {
        let value = |i: usize| unknowns[i].clamp(-300.0, 300.0).exp();
        let first = usize::from(self.spring.is_some());
        let n = self.arms.len();
        Self {
            spring: self.spring.map(|_| value(0)),
            arms: (0..n).map(|i| (value(first + i), bounds.time(unknowns[first + n + i]))).collect(),
        }
    }
}

/// The band that the times stay in, by its logarithm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    middle: f64,
    half: f64,
}

impl Bounds {
    /// Of a band.
    pub fn of(band: Band) -> Self {
        let (from, to) = (band.from.ln(), band.to.ln());
        Self { middle: 0.5 * (from + to), half: 0.5 * (to - from) }
    }

    fn time(self, angle: f64) -> f64 {
        (self.middle + self.half * angle.sin()).exp()
    }

    /// The angle of a time; of one outside the band that of a place close to its end, from which there is a way back.
    fn angle(self, time: f64) -> f64 {
        ((time.ln() - self.middle) / self.half).clamp(-0.999, 0.999).asin()
    }

    /// d ln time / d angle.
    fn slope(self, angle: f64) -> f64 {
        self.half * angle.cos()
    }
}

/// Away from zero, so that its logarithm and its inverse are finite.
fn floor(value: f64) -> f64 {
    value.max(1e-300)
}

/// What a minimisation found.
#[derive(Debug, Clone)]
pub(super) struct Minimum {
    /// The series.
    pub moduli: Moduli,
    /// The sum of its squared residuals.
    pub cost: f64,
    /// Why the iteration ended.
    pub stop: Stop,
    /// How often the residuals were evaluated.
    pub evaluations: usize,
}

struct Problem<'a> {
    samples: &'a Samples,
    residuals: Residuals,
    bounds: Bounds,
    unknowns: DVector<f64>,
    moduli: Moduli,
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, x: &DVector<f64>) {
        self.unknowns.copy_from(x);
        self.moduli = self.moduli.with_unknowns(x, self.bounds);
    }

    fn params(&self) -> DVector<f64> {
        self.unknowns.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(DVector::from_vec(self.moduli.residuals(self.samples, self.residuals)))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let mut columns = self.moduli.jacobian(self.samples, self.residuals);
        let first = columns.len() - self.moduli.arms.len();
        for (column, angle) in columns[first..].iter_mut().zip(self.unknowns.iter().skip(first)) {
            let slope = self.bounds.slope(*angle);
            column.iter_mut().for_each(|value| *value *= slope);
        }
        let rows = self.samples.values.len();
        Some(DMatrix::from_vec(rows, columns.len(), columns.concat()))
    }
}

/// The nearest local minimum, in rounds of some `evaluations` each and at most `rounds` of them. There must be at
/// least as many values as unknowns.
pub(super) fn minimise(
    samples: &Samples,
    residuals: Residuals,
    bounds: Bounds,
    start: Moduli,
    evaluations: usize,
    rounds: usize,
) -> Minimum {
    let mut best =
        Minimum { cost: start.cost(samples, residuals), moduli: start, stop: Stop::EvaluationLimit, evaluations: 0 };
    for _ in 0..rounds {
        let unknowns = best.moduli.unknowns(bounds);
        let solver = LevenbergMarquardt::new()
            .with_ftol(TOLERANCE)
            .with_xtol(TOLERANCE)
            .with_gtol(0.0)
            .with_patience(evaluations.div_ceil(unknowns.len() + 1));
        let problem = Problem { samples, residuals, bounds, unknowns, moduli: best.moduli.clone() };
        let (problem, report) = solver.minimize(problem);
        best.evaluations += report.number_of_evaluations;
        let cost = problem.moduli.cost(samples, residuals);
        let gain = 1.0 - cost / best.cost;
        if cost < best.cost {
            best.moduli = problem.moduli;
            best.cost = cost;
        }
        best.stop = match report.termination {
            TerminationReason::Converged { .. } | TerminationReason::ResidualsZero => Stop::RelativeChange,
            TerminationReason::LostPatience => Stop::EvaluationLimit,
            _ => Stop::Stagnation,
        };
        // A round that ended for another reason than its length may still gain when started afresh; one of full length
        // that hardly gains creeps along a valley without a floor.
        let least = if best.stop == Stop::EvaluationLimit { 1e-6 } else { TOLERANCE };
        if gain.is_nan() || gain <= least {
            break;
        }
    }
    best
}
