//! The indenter held by a force: one unknown and one equation more in Newton's system.
//!
//! Face and indenter know only how they move against each other, so that an indenter that comes down by dD is a body that rises by
//! it: with z upward, J z dD is what that does to G. The force is N = -integral of t.z, and so
//!
//! ```text
//! J dt + j dD = G,    j = J(dt = 0, C dt = z)
//! l(dt)       = N - F,    l(v) = -integral of v.z
//! dt = a - b dD,  a = J^-1 G,  b = J^-1 j,  dD = (l(a) - (N - F))/l(b)
//! ```
//!
//! dD stands in the system times a modulus kappa, and the equation over the area, so that both are pressures.

use nalgebra::SVector;

use super::linear::{Linearised, product};
use super::{Site, area, normal_force};
use crate::error::Result;

/// What the border of the system is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Border<const D: usize> {
    /// j/kappa
    column: Vec<SVector<f64, D>>,
    /// kappa, Pa/m
    pub modulus: f64,
}

/// Upward.
pub fn up<const D: usize>() -> SVector<f64, D> {
    SVector::from_fn(|i, _| f64::from(u8::from(i + 1 == D)))
}

/// kappa: the mean of the points' own moduli.
pub fn modulus<const D: usize>(sites: &[Site<D>]) -> f64 {
    sites.iter().map(|site| site.moduli.normal).sum::<f64>() / sites.len().max(1) as f64
}

impl<const D: usize> Border<D> {
    /// For the points of a step.
    pub fn new(sites: &[Site<D>], points: &[Linearised<D>]) -> Self {
        let modulus = modulus(sites);
        let still = vec![SVector::zeros(); points.len()];
        let risen = vec![up::<D>() / modulus; points.len()];
        Self { column: product(points, &still, &risen), modulus }
    }

    /// The product of the bordered system with (dt, kappa dD), of which `product` is J dt.
    pub fn product(
        &self,
        sites: &[Site<D>],
        (dt, lowered): (&[SVector<f64, D>], f64),
        product: &mut [SVector<f64, D>],
    ) -> f64 {
        product.iter_mut().zip(&self.column).for_each(|(product, column)| *product += column * lowered);
        normal_force(sites, dt) / area(sites)
    }

    /// (dt, kappa dD) of the bordered system, by what solves that without a border; none where nothing touches.
    pub fn solve(
        &self,
        sites: &[Site<D>],
        (right, force): (&[SVector<f64, D>], f64),
        inverse: impl Fn(&[SVector<f64, D>]) -> Result<Vec<SVector<f64, D>>>,
    ) -> Result<Option<(Vec<SVector<f64, D>>, f64)>> {
        let (mut a, b) = (inverse(right)?, inverse(&self.column)?);
        let whole = area(sites);
        let answer = normal_force(sites, &b) / whole;
        if answer == 0.0 {
            return Ok(None);
        }
        let lowered = (normal_force(sites, &a) / whole - force) / answer;
        a.iter_mut().zip(&b).for_each(|(a, b)| *a -= b * lowered);
        Ok(Some((a, lowered)))
    }
}

/// How far the indenter has to come down, m, to press on the first point with about what carries a force; `motions` are relative
/// to where it is.
pub fn touch<const D: usize>(sites: &[Site<D>], motions: &[SVector<f64, D>], force: f64) -> f64 {
    let gap = |(site, motion): (&Site<D>, &SVector<f64, D>)| {
        let upward = site.normal.dot(&up::<D>());
        let push = force / (site.weight * site.moduli.normal);
        (-site.relative(motion).overlap / upward, push)
    };
    let first = sites.iter().zip(motions).map(gap).min_by(|a, b| a.0.total_cmp(&b.0));
    first.map_or(0.0, |(gap, push)| gap + push)
}
