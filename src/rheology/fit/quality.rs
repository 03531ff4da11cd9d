//! How far to trust an identified series: covariance, condition, and the band where it follows the data.

use std::fmt;

use nalgebra::{DMatrix, DVector};

use super::nonlinear::Moduli;
use super::{Fit, Residuals, Samples};
use crate::rheology::Band;

/// The condition of the Jacobian beyond which single arms mean nothing, though their sum may still fit.
pub const ILL_CONDITIONED: f64 = 1e6;

/// What the data say of each unknown, to first order: the covariance s^2 (J'J)^-1 of the logarithms of moduli and
/// times, with s^2 = cost/(values - unknowns). It takes the residuals for independent noise; where they are the
/// systematic misfit of too short a series, it only ranks the unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// The condition number of the Jacobian with columns of unit length; infinite if two unknowns do the same.
    pub condition: f64,
    /// Standard errors; none if there are no more values than unknowns, or the Jacobian is singular.
    pub standard_errors: Option<StandardErrors>,
}

/// One standard deviation of what a [`Fit`] gives.
#[derive(Debug, Clone, PartialEq)]
pub struct StandardErrors {
    /// Of M(0), relative to it.
    pub instantaneous: f64,
    /// Of each weight, absolute.
    pub weights: Vec<f64>,
    /// Of each time, relative to it.
    pub times: Vec<f64>,
}

/// Why the data do not determine a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Undetermined {
    /// Two unknowns do the same: the Jacobian is singular.
    Singular,
    /// The time of this arm, counted from 0, may as well be ten times as long or as short.
    Time(usize),
    /// M(0) may as well be twice as large or nothing; or, with as many unknowns as values, it is more than ten times
    /// what was measured.
    Instantaneous,
}

impl fmt::Display for Undetermined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Singular => f.write_str("two of the unknowns do the same"),
            Self::Time(arm) => write!(f, "they say of the time of arm {} not even the decade", arm + 1),
            Self::Instantaneous => f.write_str("they say nothing of the instantaneous modulus"),
        }
    }
}

/// The first reason why the data do not determine `fit`, if there is one. A standard error is the measure: surplus arms,
/// and arms that run off to where there are no data, have times of which nothing is known.
pub fn undetermined(samples: &Samples, fit: &Fit) -> Option<Undetermined> {
    let largest = samples.values.iter().copied().fold(0.0, f64::max);
    match &fit.uncertainty.standard_errors {
        Some(errors) if errors.instantaneous > 1.0 => Some(Undetermined::Instantaneous),
        Some(errors) => errors.times.iter().position(|error| *error > std::f64::consts::LN_10).map(Undetermined::Time),
        None if fit.uncertainty.condition >= 1.0 / f64::EPSILON => Some(Undetermined::Singular),
        None => (fit.instantaneous > 10.0 * largest).then_some(Undetermined::Instantaneous),
    }
}

/// The uncertainty of `moduli` as the least-squares answer to `samples`.
pub(super) fn uncertainty(moduli: &Moduli, samples: &Samples, residuals: Residuals) -> Uncertainty {
    let columns: Vec<DVector<f64>> = moduli.jacobian(samples, residuals).into_iter().map(DVector::from_vec).collect();
    let norms: Vec<f64> = columns.iter().map(DVector::norm).collect();
    if columns.is_empty() || norms.iter().any(|norm| *norm == 0.0 || !norm.is_finite()) {
        return Uncertainty { condition: f64::INFINITY, standard_errors: None };
    }
    let unit: Vec<_> = columns.iter().zip(&norms).map(|(column, norm)| column / *norm).collect();
    let matrix = DMatrix::from_columns(&unit);
    let (rows, unknowns) = matrix.shape();
    let svd = if rows > unknowns { matrix.qr().r() } else { matrix }.svd(false, true);
    let condition = svd.singular_values.max() / svd.singular_values.min();
    let (Some(v_t), true) = (&svd.v_t, rows > unknowns && condition < 1.0 / f64::EPSILON) else {
        return Uncertainty { condition, standard_errors: None };
    };
    let variance = moduli.cost(samples, residuals) / (rows - unknowns) as f64;
    // A linear form d of the unknowns has the variance s^2 |S^-1 V' N^-1 d|^2.
    let error = |form: &dyn Fn(usize) -> f64| {
        let scaled = DVector::from_fn(unknowns, |j, _| form(j) / norms[j]);
        (v_t * scaled).component_div(&svd.singular_values).norm() * variance.sqrt()
    };
    let first = usize::from(moduli.spring.is_some());
    let n = moduli.arms.len();
    let total = moduli.instantaneous();
    let weights: Vec<f64> =
        moduli.spring.into_iter().chain(moduli.arms.iter().map(|arm| arm.0)).map(|modulus| modulus / total).collect();
    let weight_of = |j: usize| weights.get(j).copied().unwrap_or(0.0);
    // weight_i = M_i / sum M: its derivative with respect to ln M_j is weight_i (delta_ij - weight_j).
    let weight_error = |i: usize| error(&|j| weights[i] * (f64::from(u8::from(i == j)) - weight_of(j)));
    Uncertainty {
        condition,
        standard_errors: Some(StandardErrors {
            instantaneous: error(&weight_of),
            weights: (first..first + n).map(weight_error).collect(),
            times: (first + n..first + 2 * n).map(|i| error(&|j| f64::from(u8::from(i == j)))).collect(),
        }),
    }
}

/// Where the series follows the data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trust {
    /// The lower end: a time, s, or an angular frequency, rad/s.
    pub from: f64,
    /// The upper end.
    pub to: f64,
    /// True if the series leaves the data below the band; false if the data end there.
    pub left_below: bool,
    /// The same above the band.
    pub left_above: bool,
}

/// The longest run of abscissae at which every deviation is within `limit`; none if there are no two in a row. Between
/// the ends it is the median of three neighbours that counts: one outlier is noise, not the series leaving the data.
pub fn trust(samples: &Samples, fit: &Fit, limit: f64) -> Option<Trust> {
    let points = samples.at.len();
    let smooth = |part: &[f64], i: usize| match (i.checked_sub(1), part.get(i + 1)) {
        (Some(before), Some(after)) => median(part[before], part[i], *after),
        _ => part[i],
    };
    let good =
        |i: usize| fit.deviation.chunks(points).map(|part| smooth(part, i)).all(|d| d.abs() <= limit || d.is_nan());
    // A row at t = 0 is as good as one at the first time after it: there are no decades down to zero.
    let first = samples.at.iter().copied().find(|at| *at > 0.0).unwrap_or(1.0);
    let length = |i: usize, j: usize| (samples.at[j].max(first) / samples.at[i].max(first)).ln();
    let mut best: Option<(usize, usize)> = None;
    let mut start = None;
    for i in 0..points {
        if !good(i) {
            start = None;
            continue;
        }
        let from = *start.get_or_insert(i);
        if from < i && best.is_none_or(|(a, b)| length(from, i) > length(a, b)) {
            best = Some((from, i));
        }
    }
    best.map(|(i, j)| Trust { from: samples.at[i], to: samples.at[j], left_below: i > 0, left_above: j + 1 < points })
}

fn median(a: f64, b: f64, c: f64) -> f64 {
    a.min(b).max(a.max(b).min(c))
}

/// The longest part of `within` in which `deviation` stays within `limit`, its ends to 1e-6 of themselves.
pub fn trust_of_law(deviation: impl Fn(f64) -> f64, within: Band, limit: f64) -> Option<Trust> {
    let good = |x: f64| deviation(x).abs() <= limit;
    let grid = within.samples((within.decades() * 100.0) as usize + 2);
    let mut best: Option<(usize, usize)> = None;
    let mut start = None;
    for (i, &x) in grid.iter().enumerate() {
        if !good(x) {
            start = None;
            continue;
        }
        let from = *start.get_or_insert(i);
        if from < i && best.is_none_or(|(a, b)| i - from > b - a) {
            best = Some((from, i));
        }
    }
    // Between the last good point and the first bad one.
    let edge = |mut inside: f64, mut outside: f64| {
        while (outside / inside).ln().abs() > 1e-6 {
            let middle = (inside * outside).sqrt();
            *if good(middle) { &mut inside } else { &mut outside } = middle;
        }
        inside
    };
    best.map(|(i, j)| {
        let (left_below, left_above) = (i > 0, j + 1 < grid.len());
        let from = if left_below { edge(grid[i], grid[i - 1]) } else { grid[i] };
        let to = if left_above { edge(grid[j], grid[j + 1]) } else { grid[j] };
        Trust { from, to, left_below, left_above }
    })
}
