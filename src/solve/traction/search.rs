//! How far to go along a Newton step, and the whole of Newton's method for those who need no SNES.

use nalgebra::SVector;

use super::dense::{Factor, Influence};
use super::linear::Linearised;
use super::load::up;
use super::{Answer, Laws, Site};
use crate::error::Result;

/// Halvings of a Newton step at most.
const MOST_HALVINGS: usize = 12;
/// How much less than before is asked of a step, over its length.
const SUFFICIENT: f64 = 1e-4;

/// Tractions with their motion, and what the laws make of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome<const D: usize> {
    /// t, Pa.
    pub tractions: Vec<SVector<f64, D>>,
    /// M relative to the indenter where it was thought to be, m.
    pub motions: Vec<SVector<f64, D>>,
    /// How far the indenter has come down from there, m: part of each motion.
    pub descent: f64,
    /// The force that is too much, over the root of the area: beside G in the norm.
    pub unbalance: f64,
    /// Of each point.
    pub answers: Vec<Answer<D>>,
}

/// What a Newton step takes off: dt, what that moves (C dt, with what the indenter is lowered by), and what it is lowered by, m.
pub type Along<'a, const D: usize> = (&'a [SVector<f64, D>], &'a [SVector<f64, D>], f64);

impl<const D: usize> Outcome<D> {
    /// Asks the laws.
    pub fn new(
        sites: &[Site<D>],
        tractions: Vec<SVector<f64, D>>,
        (motions, descent): (Vec<SVector<f64, D>>, f64),
        laws: Laws<'_>,
    ) -> Self {
        let unbalance = laws.load.map_or(0.0, |load| (normal_force(sites, &tractions) - load) / area(sites).sqrt());
        let answers =
            sites.iter().zip(&tractions).zip(&motions).map(|((site, t), m)| site.answer(t, m, laws)).collect();
        Self { tractions, motions, descent, unbalance, answers }
    }

    /// So much less of a step.
    pub fn taken(
        &self,
        sites: &[Site<D>],
        (decrement, moved, lowered): Along<'_, D>,
        (lambda, laws): (f64, Laws<'_>),
    ) -> Self {
        let less = |values: &[SVector<f64, D>], by: &[SVector<f64, D>]| {
            values.iter().zip(by).map(|(value, by)| value - by * lambda).collect::<Vec<_>>()
        };
        let motions = (less(&self.motions, moved), self.descent - lambda * lowered);
        Self::new(sites, less(&self.tractions, decrement), motions, laws)
    }

    /// Of no points.
    pub fn none() -> Self {
        Self { tractions: Vec::new(), motions: Vec::new(), descent: 0.0, unbalance: 0.0, answers: Vec::new() }
    }

    /// The norm of G over the face, Pa m^((D-1)/2).
    pub fn norm(&self, sites: &[Site<D>]) -> f64 {
        let squares = sites.iter().zip(&self.answers).map(|(site, answer)| site.weight * answer.excess.norm_squared());
        (squares.sum::<f64>() + self.unbalance * self.unbalance).sqrt()
    }

    /// That of t.
    pub fn size(&self, sites: &[Site<D>]) -> f64 {
        let squares = sites.iter().zip(&self.tractions).map(|(site, t)| site.weight * t.norm_squared());
        squares.sum::<f64>().sqrt()
    }

    /// What round-off leaves of G, in the same norm.
    pub fn noise(&self, sites: &[Site<D>]) -> f64 {
        let squares = sites.iter().zip(&self.answers).map(|(site, answer)| site.weight * answer.noise);
        4.0 * squares.sum::<f64>().sqrt()
    }

    /// The derivatives at each point.
    pub fn linearised(&self, sites: &[Site<D>]) -> Vec<Linearised<D>> {
        sites.iter().zip(&self.answers).map(|(site, answer)| Linearised::new(site, answer)).collect()
    }

    /// t* of each point, Pa.
    pub fn met(&self, sites: &[Site<D>]) -> Vec<SVector<f64, D>> {
        sites.iter().zip(&self.answers).map(|(site, answer)| answer.met(site)).collect()
    }

    /// How many points are in contact.
    pub fn in_contact(&self) -> usize {
        self.answers.iter().filter(|answer| answer.active).count()
    }
}

/// Length, or area, of the face.
pub fn area<const D: usize>(sites: &[Site<D>]) -> f64 {
    sites.iter().map(|site| site.weight).sum()
}

/// The force on the indenter, upward.
pub fn normal_force<const D: usize>(sites: &[Site<D>], tractions: &[SVector<f64, D>]) -> f64 {
    -sites.iter().zip(tractions).map(|(site, t)| site.weight * t.dot(&up())).sum::<f64>()
}

/// The face at t - lambda dt with the longest lambda of 1, 1/2, ... that leaves less of G, or else that which leaves the least;
/// and lambda. What a step moves is known, so that no length costs a product.
pub fn length<const D: usize>(
    sites: &[Site<D>],
    from: &Outcome<D>,
    along: Along<'_, D>,
    laws: Laws<'_>,
) -> (Outcome<D>, f64) {
    let before = from.norm(sites);
    let at = |lambda: f64| from.taken(sites, along, (lambda, laws));
    let mut best: Option<(Outcome<D>, f64, f64)> = None;
    let mut lambda = 1.0;
    for _ in 0..=MOST_HALVINGS {
        let outcome = at(lambda);
        let norm = outcome.norm(sites);
        if norm <= (1.0 - SUFFICIENT * lambda) * before {
            return (outcome, lambda);
        }
        if best.as_ref().is_none_or(|(_, _, least)| norm < *least) {
            best = Some((outcome, lambda, norm));
        }
        lambda *= 0.5;
    }
    best.map_or_else(|| (from.clone(), 0.0), |(outcome, lambda, _)| (outcome, lambda))
}

/// What a body does: its influence, and the motion of every point under tractions.
pub type Operator<'a, const D: usize> =
    (&'a Influence<'a, D>, &'a dyn Fn(&[SVector<f64, D>]) -> Result<Vec<SVector<f64, D>>>);

/// Newton's method under an indenter that stays, from given tractions to where the laws hold to round-off, or as near as `most` iterations come.
pub fn settle<const D: usize>(
    sites: &[Site<D>],
    mut at: Outcome<D>,
    laws: Laws<'_>,
    (influence, moves): Operator<'_, D>,
    most: usize,
) -> Result<Outcome<D>> {
    for _ in 0..most {
        if at.norm(sites) <= at.noise(sites) {
            break;
        }
        let Ok(factor) = Factor::new(at.linearised(sites), influence) else { break };
        let excess: Vec<_> = at.answers.iter().map(|answer| answer.excess).collect();
        let decrement = factor.solve(&excess, moves)?;
        if !decrement.iter().all(|d| d.iter().all(|value| value.is_finite())) {
            break;
        }
        let moved = moves(&decrement)?;
        at = length(sites, &at, (&decrement, &moved, 0.0), laws).0;
    }
    Ok(at)
}
