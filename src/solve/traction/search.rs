//! How far to go along a Newton step, and the whole of Newton's method for those who need no SNES.

use nalgebra::{SVector, Vector2};

use super::dense::{Factor, Influence};
use super::held::{Border, Held, Over, against, steepening, up};
use super::linear::Linearised;
use super::{Answer, Laws, Site, Sites};
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
    /// The profile there; none where the sliding is given, so that it is as it was.
    pub over: Vec<Over>,
    /// R of each direction over the root of the area: beside G in the norm.
    pub unbalance: [f64; DIRECTIONS],
    /// Of each point that is in contact or bears a traction, in their order: few of all points. All others are open and stay so.
    pub answers: Vec<(usize, Answer<D>)>,
    /// Over all points.
    sums: Sums,
    /// What round-off leaves of the equations of the indenter.
    noise: f64,
}

/// Over all points, of all ranks.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Sums {
    /// The integrals of G^2, of t^2 and of the square of what round-off leaves of G.
    excess: f64,
    tractions: f64,
    noise: f64,
    /// How many are in contact.
    touching: f64,
}

impl Sums {
    /// With a point more.
    fn add<const D: usize>(&mut self, site: &Site<D>, t: &SVector<f64, D>, answer: &Answer<D>) {
        self.excess += site.weight * answer.excess.norm_squared();
        self.tractions += site.weight * t.norm_squared();
        self.noise += site.weight * answer.noise;
        self.touching += f64::from(u8::from(answer.touches()));
    }

    /// Over those of all, and the sums of the forces. Collective.
    fn everywhere<const D: usize>(self, sites: &Sites<D>, [a, b, c]: [f64; DIRECTIONS]) -> (Self, [f64; DIRECTIONS]) {
        let Self { excess, tractions, noise, touching } = self;
        let [excess, tractions, noise, touching, a, b, c] =
            sites.team().sum([excess, tractions, noise, touching, a, b, c]);
        (Self { excess, tractions, noise, touching }, [a, b, c])
    }
}

/// What a Newton step takes off: dt, what that moves (C dt, with what the indenter goes back), and what that goes back, m.
pub type Along<'a, const D: usize> = (&'a [SVector<f64, D>], &'a [SVector<f64, D>], SVector<f64, D>);

impl<const D: usize> Outcome<D> {
    /// Asks the laws; `motions` are those under the profile as it was placed. Collective.
    pub fn new(
        sites: &Sites<D>,
        tractions: Vec<SVector<f64, D>>,
        (mut motions, shift): (Vec<SVector<f64, D>>, SVector<f64, D>),
        laws: Laws<'_>,
    ) -> Self {
        let over = laws.held.over(&shift);
        for ((site, over), motion) in
            sites.iter().zip(&over).zip(&mut motions).filter(|((_, over), _)| over.rise != 0.0)
        {
            *motion -= site.normal * (site.normal.dot(&up()) * over.rise);
        }
        let (mut sums, mut answers) = (Sums::default(), Vec::new());
        for (i, ((site, t), motion)) in sites.iter().zip(&tractions).zip(&motions).enumerate() {
            if site.stays_open(t, motion, laws) {
                sums.noise += site.weight * site.open_noise();
                continue;
            }
            let answer = site.answer(t, motion, laws);
            sums.add(site, t, &answer);
            answers.push((i, answer));
        }
        let (sums, met) = sums.everywhere(sites, laws.held.forces(sites, (&tractions, &over)));
        let unbalance = laws.held.unbalance(met, &shift).map(|unbalance| unbalance / sites.area().sqrt());
        Self { tractions, motions, shift, over, unbalance, answers, sums, noise: laws.held.noise(sites) }
    }

    /// The motions under the profile as it was placed.
    fn under_placed(&self, sites: &Sites<D>) -> Vec<SVector<f64, D>> {
        if self.over.is_empty() {
            return self.motions.clone();
        }
        let lowered = |((site, over), motion): ((&Site<D>, &Over), &SVector<f64, D>)| {
            motion + site.normal * (site.normal.dot(&up()) * over.rise)
        };
        sites.iter().zip(&self.over).zip(&self.motions).map(lowered).collect()
    }

    /// What of the motion of a point is the indenter's going on, m.
    pub fn against(&self, site: &Site<D>, i: usize) -> SVector<f64, D> {
        let rise = self.over.get(i).map_or(0.0, |over| over.rise);
        against(site, &self.shift) - site.normal * (site.normal.dot(&up()) * rise)
    }

    /// The same under other laws.
    pub fn under(self, sites: &Sites<D>, laws: Laws<'_>) -> Self {
        let motions = self.under_placed(sites);
        Self::new(sites, self.tractions, (motions, self.shift), laws)
    }

    /// So much less of a step.
    pub fn taken(
        &self,
        sites: &Sites<D>,
        (decrement, moved, gone): Along<'_, D>,
        (lambda, laws): (f64, Laws<'_>),
    ) -> Self {
        let less = |mut values: Vec<SVector<f64, D>>, by: &[SVector<f64, D>]| {
            values.iter_mut().zip(by).for_each(|(value, by)| *value -= by * lambda);
            values
        };
        let motions = (less(self.under_placed(sites), moved), self.shift - gone * lambda);
        Self::new(sites, less(self.tractions.clone(), decrement), motions, laws)
    }

    /// How the forces along the face change with the slopes of the profile as the indenter goes on in a direction, N/m per m. Collective.
    pub fn steepening(&self, sites: &Sites<D>, held: Held<'_>, direction: usize) -> Vector2<f64> {
        let pressing = |(site, traction): (&Site<D>, &SVector<f64, D>)| {
            -site.weight * site.normal.dot(traction) * site.normal.dot(&up())
        };
        let pressing: Vec<f64> = sites.iter().zip(&self.tractions).map(pressing).collect();
        let size = sites.area() / sites.everywhere().max(1.0);
        let mine = steepening(held, (&self.shift, direction), (&pressing, size));
        sites.team().sum([mine.x, mine.y]).into()
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
            sums: Sums::default(),
            noise: 0.0,
        }
    }

    /// The norm of G over the face, Pa m^((D-1)/2).
    pub fn norm(&self) -> f64 {
        let held: f64 = self.unbalance.iter().map(|unbalance| unbalance * unbalance).sum();
        (self.sums.excess + held).sqrt()
    }

    /// That of t.
    pub fn size(&self) -> f64 {
        self.sums.tractions.sqrt()
    }

    /// What round-off leaves of G, in the same norm.
    pub fn noise(&self) -> f64 {
        4.0 * (self.sums.noise + self.noise * self.noise).sqrt()
    }

    /// The derivatives at each point.
    pub fn linearised(&self, sites: &Sites<D>) -> Vec<Linearised<D>> {
        let open = Answer::open(SVector::zeros(), SVector::zeros());
        let mut all: Vec<_> = sites.iter().map(|site| Linearised::new(site, &open)).collect();
        self.answers.iter().for_each(|(i, answer)| all[*i] = Linearised::new(&sites[*i], answer));
        all
    }

    /// G of each point, Pa.
    pub fn excess(&self) -> Vec<SVector<f64, D>> {
        let mut all = vec![SVector::zeros(); self.tractions.len()];
        self.answers.iter().for_each(|(i, answer)| all[*i] = answer.excess);
        all
    }

    /// t* of each point, Pa.
    pub fn met(&self, sites: &Sites<D>) -> Vec<SVector<f64, D>> {
        let mut all = vec![SVector::zeros(); self.tractions.len()];
        self.answers.iter().for_each(|(i, answer)| all[*i] = answer.met(&sites[*i]));
        all
    }

    /// R of each direction over the area.
    pub fn unbalanced(&self, sites: &Sites<D>) -> [f64; DIRECTIONS] {
        self.unbalance.map(|unbalance| unbalance / sites.area().sqrt())
    }

    /// How many points are in contact.
    pub fn in_contact(&self) -> usize {
        self.sums.touching as usize
    }
}

/// The face at t - lambda dt with the longest lambda of 1, 1/2, ... that leaves less of G, or else that which leaves the least;
/// and lambda. What a step moves is known, so that no length costs a product.
pub fn length<const D: usize>(
    sites: &Sites<D>,
    from: &Outcome<D>,
    along: Along<'_, D>,
    laws: Laws<'_>,
) -> (Outcome<D>, f64) {
    let before = from.norm();
    let at = |lambda: f64| from.taken(sites, along, (lambda, laws));
    let mut best: Option<(Outcome<D>, f64, f64)> = None;
    let mut lambda = 1.0;
    for _ in 0..=MOST_HALVINGS {
        let outcome = at(lambda);
        let norm = outcome.norm();
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
    sites: &Sites<D>,
    mut at: Outcome<D>,
    laws: Laws<'_>,
    (influence, moves): Operator<'_, D>,
    most: usize,
) -> Result<Outcome<D>> {
    for _ in 0..most {
        if at.norm() <= at.noise() {
            break;
        }
        let Ok(factor) = Factor::new(at.linearised(sites), influence) else { break };
        let excess = at.excess();
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
