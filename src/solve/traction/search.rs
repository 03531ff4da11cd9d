//! How far to go along a Newton step, and the whole of Newton's method for those who need no SNES.

use nalgebra::{SVector, Vector2};

use super::dense::{Factor, Influence};
use super::held::{Border, Held, Over, against, steepening, up};
use super::linear::Linearised;
use super::{Answer, Laws, Site};
use crate::error::Result;
use crate::loading::DIRECTIONS;

/// Halvings of a Newton step at most.
const MOST_HALVINGS: usize = 12;
/// How much less than before is asked of a step, over its length.
const SUFFICIENT: f64 = 1e-4;

/// Tractions with their motion, and what the laws make of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome<const D: usize> {
    /// t, Pa.
    pub tractions: Vec<SVector<f64, D>>,
    /// M relative to the indenter where it was placed, m.
    pub motions: Vec<SVector<f64, D>>,
    /// How far the indenter has gone from there, m: part of each motion.
    pub shift: SVector<f64, D>,
    /// The profile there.
    pub over: Vec<Over>,
    /// R of each direction over the root of the area: beside G in the norm.
    pub unbalance: [f64; DIRECTIONS],
    /// Of each point.
    pub answers: Vec<Answer<D>>,
    /// What round-off leaves of the equations of the indenter.
    noise: f64,
}

/// What a Newton step takes off: dt, what that moves (C dt, with what the indenter goes back), and what that goes back, m.
pub type Along<'a, const D: usize> = (&'a [SVector<f64, D>], &'a [SVector<f64, D>], SVector<f64, D>);

impl<const D: usize> Outcome<D> {
    /// Asks the laws; `motions` are those under the profile as it was placed.
    pub fn new(
        sites: &[Site<D>],
        tractions: Vec<SVector<f64, D>>,
        (mut motions, shift): (Vec<SVector<f64, D>>, SVector<f64, D>),
        laws: Laws<'_>,
    ) -> Self {
        let over = laws.held.over(&shift, sites.len());
        for ((site, over), motion) in
            sites.iter().zip(&over).zip(&mut motions).filter(|((_, over), _)| over.rise != 0.0)
        {
            *motion -= site.normal * (site.normal.dot(&up()) * over.rise);
        }
        let unbalance = laws.held.unbalance(sites, (&tractions, &over), &shift);
        let unbalance = unbalance.map(|unbalance| unbalance / area(sites).sqrt());
        let answers =
            sites.iter().zip(&tractions).zip(&motions).map(|((site, t), m)| site.answer(t, m, laws)).collect();
        Self { tractions, motions, shift, over, unbalance, answers, noise: laws.held.noise(sites) }
    }

    /// The motions under the profile as it was placed.
    fn under_placed(&self, sites: &[Site<D>]) -> Vec<SVector<f64, D>> {
        let lowered = |((site, over), motion): ((&Site<D>, &Over), &SVector<f64, D>)| {
            motion + site.normal * (site.normal.dot(&up()) * over.rise)
        };
        sites.iter().zip(&self.over).zip(&self.motions).map(lowered).collect()
    }

    /// What of the motion of a point is the indenter's going on, m.
    pub fn against(&self, site: &Site<D>, i: usize) -> SVector<f64, D> {
        against(site, &self.shift) - site.normal * (site.normal.dot(&up()) * self.over[i].rise)
    }

    /// The same under other laws.
    pub fn under(self, sites: &[Site<D>], laws: Laws<'_>) -> Self {
        let motions = self.under_placed(sites);
        Self::new(sites, self.tractions, (motions, self.shift), laws)
    }

    /// So much less of a step.
    pub fn taken(
        &self,
        sites: &[Site<D>],
        (decrement, moved, gone): Along<'_, D>,
        (lambda, laws): (f64, Laws<'_>),
    ) -> Self {
        let less = |values: &[SVector<f64, D>], by: &[SVector<f64, D>]| {
            values.iter().zip(by).map(|(value, by)| value - by * lambda).collect::<Vec<_>>()
        };
        let motions = (less(&self.under_placed(sites), moved), self.shift - gone * lambda);
        Self::new(sites, less(&self.tractions, decrement), motions, laws)
    }

    /// How the forces along the face change with the slopes of the profile as the indenter goes on in a direction, N/m per m.
    pub fn steepening(&self, sites: &[Site<D>], held: Held<'_>, direction: usize) -> Vector2<f64> {
        let pressing = |(site, traction): (&Site<D>, &SVector<f64, D>)| {
            -site.weight * site.normal.dot(traction) * site.normal.dot(&up())
        };
        let pressing: Vec<f64> = sites.iter().zip(&self.tractions).map(pressing).collect();
        steepening(held, (&self.shift, direction), (&pressing, area(sites)))
    }

    /// Of no points.
    pub fn none() -> Self {
        Self {
            tractions: Vec::new(),
            motions: Vec::new(),
            shift: SVector::zeros(),
            over: Vec::new(),
            unbalance: [0.0; DIRECTIONS],
            answers: Vec::new(),
            noise: 0.0,
        }
    }

    /// The norm of G over the face, Pa m^((D-1)/2).
    pub fn norm(&self, sites: &[Site<D>]) -> f64 {
        let squares = sites.iter().zip(&self.answers).map(|(site, answer)| site.weight * answer.excess.norm_squared());
        let held: f64 = self.unbalance.iter().map(|unbalance| unbalance * unbalance).sum();
        (squares.sum::<f64>() + held).sqrt()
    }

    /// That of t.
    pub fn size(&self, sites: &[Site<D>]) -> f64 {
        let squares = sites.iter().zip(&self.tractions).map(|(site, t)| site.weight * t.norm_squared());
        squares.sum::<f64>().sqrt()
    }

    /// What round-off leaves of G, in the same norm.
    pub fn noise(&self, sites: &[Site<D>]) -> f64 {
        let squares = sites.iter().zip(&self.answers).map(|(site, answer)| site.weight * answer.noise);
        4.0 * (squares.sum::<f64>() + self.noise * self.noise).sqrt()
    }

    /// The derivatives at each point.
    pub fn linearised(&self, sites: &[Site<D>]) -> Vec<Linearised<D>> {
        sites.iter().zip(&self.answers).map(|(site, answer)| Linearised::new(site, answer)).collect()
    }

    /// t* of each point, Pa.
    pub fn met(&self, sites: &[Site<D>]) -> Vec<SVector<f64, D>> {
        sites.iter().zip(&self.answers).map(|(site, answer)| answer.met(site)).collect()
    }

    /// R of each direction over the area.
    pub fn unbalanced(&self, sites: &[Site<D>]) -> [f64; DIRECTIONS] {
        self.unbalance.map(|unbalance| unbalance / area(sites).sqrt())
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

/// Newton's method from given tractions to where the laws hold to round-off, or as near as `most` iterations come.
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
        let solve = |right: &[SVector<f64, D>]| factor.solve(right, moves);
        let (decrement, gone) = match Border::new(sites, (&at, factor.points()), laws.held) {
            None => (solve(&excess)?, SVector::zeros()),
            Some(border) => match border.solve(sites, (&excess, at.unbalanced(sites)), solve)? {
                Some((decrement, gone)) => (decrement, border.shift(gone)),
                None => break,
            },
        };
        if !decrement.iter().chain([&gone]).all(|d| d.iter().all(|value| value.is_finite())) {
            break;
        }
        let moved: Vec<_> =
            moves(&decrement)?.iter().zip(sites).map(|(moved, site)| moved + against(site, &gone)).collect();
        at = length(sites, &at, (&decrement, &moved, gone), laws).0;
    }
    Ok(at)
}
