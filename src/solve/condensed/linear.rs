//! Newton's linear system of the condensed problem: what it is made of at a state, its product and its solution.

use std::cell::Cell;

use nalgebra::SVector;

use super::super::response::{Patch, Response};
use super::super::traction::{self, Behind, Border, Factor, Fourier, Linearised, Outcome, Pointwise, Sites, System};
use super::stage::Stage;
use super::{Condensed, LARGE_FACE, LARGE_PERIODIC_FACE, Way, tractions, unprepared, write};
use crate::error::{Error, Result};
use crate::friction::Law;
use crate::loading::DIRECTIONS;
use crate::parallel::Team;
use crate::petsc::{Step, Vector};

/// More applications of an old factor than this in one solve, and a new one is made.
const STALE_AFTER: usize = 10;

/// More unknowns than this, and a preconditioner is no dense factor of what the body does about: that of so many takes a second.
const MOST_NEARLY: usize = 2400;

/// To which share of its right side the first system of a step is solved, and any at most: most steps of Newton's method end at a kink of
/// the laws, and until the last ones half of the way is as good as all of it.
const FIRST: f64 = 0.5;
/// The first where points stick or slip as they did, which is linear.
const FIRST_AS_BEFORE: f64 = 0.05;
/// The same where a product costs next to nothing, and Newton's method need not wait for exact steps; a step from a guess that is a hundredth
/// off should end below its tolerance.
const SURE: f64 = 1e-7;
/// Of what is to be left of G at the end of a step, what a linear system may leave.
const ENOUGH: f64 = 0.1;
/// By which power of how much less G became the next system is solved better (Eisenstat and Walker, SIAM J. Sci. Comput. 17 (1996) 16, their
/// second choice), and above which share of its right side the one before keeps the next one from being worse.
const KEENNESS: f64 = 1.618;
const KEEN: f64 = 0.1;

/// Newton's linear system.
#[derive(Default)]
pub(super) struct Linear<const D: usize> {
    pub points: Vec<Linearised<D>>,
    /// Where the place of the indenter is unknown.
    pub border: Option<Border<D>>,
    pub factor: Option<Factor<D>>,
    pub pointwise: Option<Pointwise<D>>,
    /// Of a large periodic face, in place of all points and a factor.
    pub touching: Option<Touching<D>>,
    /// The step that the factor was made for, and the secant.
    pub made_for: Option<(Step, f64)>,
    /// Solves since the last tangent.
    pub used: usize,
}

/// The system of the points that are in contact, or were: of all others there is nothing to solve.
pub(super) struct Touching<const D: usize> {
    patch: Patch,
    points: Vec<Linearised<D>>,
    /// What is to be solved for.
    excess: Vec<f64>,
    /// Those of the whole system and those of the points.
    borders: Option<[Border<D>; 2]>,
    fourier: Fourier,
    /// Whether their friction answers to no motion.
    slides: bool,
}

impl<const D: usize, R: Response<D>> Condensed<D, R> {
    /// Makes the system that of the state that was tried last.
    pub(super) fn linearise(&mut self, step: Step) -> Result<()> {
        if self.way == Way::Pressures {
            return Ok(());
        }
        let stage = self.stage.as_ref().ok_or_else(unprepared)?;
        let Some(behind) = self.behind() else { return Ok(()) };
        if self.way == Way::Products {
            let points = stage.trial.linearised(&stage.sites);
            let border = self.with_laws(stage, |laws| Border::new(&stage.sites, (&stage.trial, &points), laws.held));
            self.linear = Linear { border, ..nearly(&behind, points) };
            return Ok(());
        }
        if let Some(touching) = self.touching(&behind, stage) {
            self.linear = Linear { touching: Some(touching), ..Linear::default() };
            return Ok(());
        }
        let points = stage.trial.linearised(&stage.sites);
        let border = self.with_laws(stage, |laws| Border::new(&stage.sites, (&stage.trial, &points), laws.held));
        let Linear { factor, made_for, used, .. } = &self.linear;
        let same = made_for.is_some_and(|(made, secant)| made.dt == step.dt && secant == behind.secant);
        if self.reuse && *used <= STALE_AFTER && same && factor.is_some() {
            (self.linear.points, self.linear.border, self.linear.used) = (points, border, 0);
            return Ok(());
        }
        // A singular system has no factor; the solve then says so by what it returns.
        let factor = Factor::new(points.clone(), &|j, rows| behind.influence(j, rows)).ok();
        let made_for = Some((step, behind.secant));
        self.linear = Linear { points, border, factor, made_for, ..Linear::default() };
        Ok(())
    }

    /// The system of the points in contact of a large periodic face; none of any other. Collective.
    fn touching(&self, behind: &Behind<'_, D>, stage: &Stage<D>) -> Option<Touching<D>> {
        let points = self.face.interface.points();
        let (transform, _) = behind.compliance.waves()?;
        if points.share_nodes() || D * points.everywhere() <= LARGE_PERIODIC_FACE {
            return None;
        }
        let Stage { sites, trial, .. } = stage;
        let patch = transform.patch(trial.answers.iter().map(|(i, _)| *i).collect());
        let before = if self.goes_on_as_before(stage) { Some(self.face.interface.states()) } else { None };
        let answers: Vec<_> = self.with_laws(stage, |laws| {
            let of = |(i, answer): &(usize, traction::Answer<D>)| match before {
                Some(states) => {
                    let at = (&trial.tractions[*i], &trial.motions[*i]);
                    (*i, sites[*i].answer_as_before(at, laws, (&states[*i], *answer)))
                }
                None => (*i, *answer),
            };
            trial.answers.iter().map(of).collect()
        });
        let excess = answers.iter().flat_map(|(_, answer)| answer.excess.iter().copied().collect::<Vec<_>>()).collect();
        let points: Vec<_> = answers.iter().map(|(i, answer)| Linearised::new(&sites[*i], answer)).collect();
        let borders = self.with_laws(stage, |laws| match laws.held.is_empty() {
            true => None,
            false => Border::new(sites, (trial, &trial.linearised(sites)), laws.held),
        });
        let borders = borders.map(|border| [border.of_some(patch.nodes()), border]);
        let weight = sites.first().map_or(0.0, |site| site.weight);
        let fourier = Fourier::new(behind.compliance, behind.secant, &points, weight)?;
        let slides = |point: &Linearised<D>| !point.active || (point.grip == [0.0; 2] && point.wearing == [0.0; 2]);
        let slides = transform.team().all_say(points.iter().all(slides));
        Some(Touching { patch, points, excess, borders, fourier, slides })
    }

    /// Whether the first linear system of a step is that of the points which stuck or slipped before: where friction has one solution,
    /// within a phase, unless tractions are carried along with the indenter.
    fn goes_on_as_before(&self, stage: &Stage<D>) -> bool {
        let interface = &self.face.interface;
        let alike = |law: &dyn Law| !law.strength().varies();
        stage.newton == 0
            && interface.friction().is_some_and(alike)
            && interface.wear().is_none()
            && interface.adhesion().is_none()
            && !interface.points().is_carried(stage.placement.sliding_rate * stage.step.dt)
            && self.face.goes_on_from(stage.step).is_ok_and(|last| last.is_some())
    }

    /// product = J v
    pub(super) fn product(&mut self, v: &Vector, product: &mut Vector) -> Result<()> {
        if self.way == Way::Pressures {
            let reason =
                "contact without friction is solved by conjugate gradients of its own here: leave -ksp_type out";
            return Err(Error::Usage(reason.into()));
        }
        let (Some(behind), Some(stage)) = (self.behind(), self.stage.as_ref()) else {
            product.view_mut()?;
            return Ok(());
        };
        let dt = tractions::<D>(v, self.accepted.len())?;
        let (mut values, border) = match &self.linear.touching {
            Some(touching) => {
                let (mut values, moved) = (dt.clone(), behind.moves(&dt)?);
                for (point, &node) in touching.points.iter().zip(touching.patch.nodes()) {
                    values[node] = point.product(&dt[node], &moved[node]);
                }
                (values, touching.borders.as_ref().map(|[_, border]| border))
            }
            None => {
                let moved = behind.moves_roughly(&dt)?;
                (traction::product(&self.linear.points, &dt, &moved), self.linear.border.as_ref())
            }
        };
        let mut last = self.last(v)?;
        if let Some(border) = border {
            last = border.product(&stage.sites, (&dt, last), &mut values);
        }
        write(product, values.into_iter())?;
        self.write_last(last, product)
    }

    /// x = J^-1 b, or nearly so.
    pub(super) fn solution(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        if self.way == Way::Pressures {
            return self.pressed(x);
        }
        if self.linear.touching.is_some() {
            return self.solution_where_it_touches(b, x);
        }
        self.linear.used += 1;
        let (right, mut last) = (tractions::<D>(b, self.accepted.len())?, self.last(b)?);
        let inverse = |right: &[SVector<f64, D>]| match (&self.linear, self.behind()) {
            (Linear { pointwise: Some(pointwise), points, .. }, _) => Ok(pointwise.solve(points, right)),
            (Linear { factor: Some(factor), points, .. }, Some(behind)) => factor.solve(right, |t| match self.way {
                Way::Products => Ok(behind.nearly_moved(t, &active(points))),
                Way::Newton | Way::Pressures => behind.moves(t),
            }),
            _ => Ok(vec![SVector::repeat(f64::NAN); right.len()]),
        };
        let solution = match (&self.linear.border, &self.stage) {
            (Some(border), Some(stage)) => {
                let solved = border.solve(&stage.sites, (&right, last), inverse)?;
                let (solution, gone) = solved.unwrap_or_else(|| (right, Self::down_to_touch(stage, border)));
                last = gone;
                solution
            }
            _ => inverse(&right)?,
        };
        write(x, solution.into_iter())?;
        self.write_last(last, x)
    }

    /// Where nothing touches: down to where something does.
    fn down_to_touch(stage: &Stage<D>, border: &Border<D>) -> [f64; DIRECTIONS] {
        let force = stage.placement.supports[0].map_or(0.0, |support| support.force);
        let down = traction::touch(&stage.sites, &stage.trial.motions, force);
        [-down * border.modulus, 0.0, 0.0]
    }

    /// The same by GMRES on the points in contact. What is not solved is not a number, and the step is cut.
    fn solution_where_it_touches(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        let reduction = self.reduction();
        let (Some(behind), Some(stage), Some(touching)) =
            (self.behind(), self.stage.as_ref(), self.linear.touching.as_ref())
        else {
            return Err(unprepared());
        };
        let Touching { patch, borders, .. } = touching;
        let border = borders.as_ref().map(|[border, _]| border);
        let common = if border.is_some() { DIRECTIONS } else { 0 };
        let (mut last, sites) = (self.last(b)?, &stage.sites);
        let mut right = touching.right(b, &stage.trial, sites.team())?;
        right.extend_from_slice(&last[..common]);
        let weight = sites.first().map_or(0.0, |site| site.weight);
        let loose = Cell::new(false);
        let mut room = Vec::new();
        let mut product = |w: &mut [f64]| touching.multiply((&behind, sites, border), weight, w);
        let mut precondition = |w: &mut [f64]| {
            loose.set(loose.get() || !touching.precondition((&behind, sites, border), w, &mut room)?);
            Ok(())
        };
        let team = sites.team();
        let mut system = System { team, common, product: &mut product, precondition: &mut precondition };
        let (mut solved, left) = system.solve(&right, reduction)?;
        last[..common].copy_from_slice(&solved[solved.len() - common..]);
        // A contact that may jump has no system worth solving where it does.
        if left > FIRST && self.face.interface.adhesion().is_none() {
            solved.fill(f64::NAN);
        }
        if let Some(border) = border.filter(|_| loose.get()) {
            (solved, last) = (right, Self::down_to_touch(stage, border));
        }
        solved.truncate(D * patch.nodes().len());
        {
            let mut x = x.view_mut()?;
            x.fill(0.0);
            for (node, solved) in patch.nodes().iter().zip(solved.chunks_exact(D)) {
                x[D * node..][..D].copy_from_slice(solved);
            }
        }
        self.write_last(last, x)
    }

    /// To which share of its right side the next system is to be solved.
    fn reduction(&mut self) -> f64 {
        let (small, allowed) = (D * self.face.interface.points().everywhere() <= LARGE_FACE, self.allowed());
        let goes_on = self.stage.as_ref().is_some_and(|stage| self.goes_on_as_before(stage));
        let Some(stage) = self.stage.as_mut() else { return SURE };
        let norm = stage.trial.norm();
        let keen = match stage.solved {
            _ if small => SURE,
            None if goes_on => FIRST_AS_BEFORE,
            None => FIRST,
            Some([before, share]) => {
                let kept = Some(share.powf(KEENNESS)).filter(|kept| *kept > KEEN).unwrap_or(0.0);
                (norm / before).powf(KEENNESS).max(kept).min(FIRST)
            }
        };
        stage.solved = Some([norm, keen]);
        keen.max((ENOUGH * allowed / norm).min(FIRST))
    }

    /// x = the tractions that were tried last less those of pressures that meet the laws.
    fn pressed(&self, x: &mut Vector) -> Result<()> {
        let Some((behind, stage)) = self.behind().zip(self.stage.as_ref()) else { return x.view_mut().map(|_| ()) };
        let (sites, trial) = (&stage.sites, &stage.trial);
        let told = (self.face.interface.penalty(), self.tolerance, self.scale);
        let pressures = traction::pressures(sites, trial, &behind, told)?;
        let away = trial.tractions.iter().zip(sites).zip(pressures).map(|((t, site), p)| t + site.normal * p);
        write(x, away)
    }
}

/// The system of these points with a preconditioner that asks for no product: by what the body does about.
fn nearly<const D: usize>(behind: &Behind<'_, D>, points: Vec<Linearised<D>>) -> Linear<D> {
    let factor = match Factor::order(&points) <= MOST_NEARLY {
        true => Factor::new(points.clone(), &|j, rows| behind.influence(j, rows)).ok(),
        false => None,
    };
    let pointwise = factor.is_none().then(|| Pointwise::new(&points, |i| behind.influence(i, &[i])[0]));
    Linear { points, factor, pointwise, ..Linear::default() }
}

/// Which points are in contact.
fn active<const D: usize>(points: &[Linearised<D>]) -> Vec<usize> {
    points.iter().enumerate().filter(|(_, point)| point.active).map(|(i, _)| i).collect()
}

/// What stands around the system of the points in contact: the body, all points and the borders of the system.
type Around<'a, const D: usize> = (&'a Behind<'a, D>, &'a Sites<D>, Option<&'a Border<D>>);

impl<const D: usize> Touching<D> {
    /// What of a right side is at its points; where that is G of a state, what it is to be solved for in place of it. Collective.
    fn right(&self, b: &Vector, trial: &Outcome<D>, team: &Team) -> Result<Vec<f64>> {
        let b = b.view()?;
        let of_state = trial.answers.iter().all(|(node, answer)| b[D * node..][..D] == *answer.excess.as_slice());
        if team.all_say(of_state) {
            return Ok(self.excess.clone());
        }
        Ok(self.patch.nodes().iter().flat_map(|node| b[D * node..][..D].to_vec()).collect())
    }

    /// The motion of all points under tractions that are nothing elsewhere, m.
    pub(super) fn moves(
        &self,
        behind: &Behind<'_, D>,
        sites: &Sites<D>,
        tractions: &[SVector<f64, D>],
    ) -> Result<Vec<SVector<f64, D>>> {
        let per_traction = sites.first().map_or(0.0, |site| site.weight) / behind.secant;
        let some: Vec<f64> =
            self.patch.nodes().iter().flat_map(|&node| (tractions[node] * per_traction).data.0[0]).collect();
        let mut all = vec![0.0; D * tractions.len()];
        let components = if behind.is_normal_alone() { D - 1..D } else { 0..D };
        behind.compliance.displace_from((&self.patch, &some), &mut all, components)?;
        Ok(vectors(&all))
    }

    /// w = J w; after the tractions stands how far the indenter goes on, where that is unknown.
    fn multiply(&self, (behind, sites, border): Around<'_, D>, weight: f64, w: &mut [f64]) -> Result<()> {
        let (all, last) = w.split_at_mut(D * self.points.len());
        let per_traction = weight / behind.secant;
        let mut moved: Vec<f64> = all.iter().map(|t| t * per_traction).collect();
        let components = if self.slides || behind.is_normal_alone() { D - 1..D } else { 0..D };
        behind.compliance.displace_patch(&self.patch, &mut moved, components)?;
        let dt: Vec<SVector<f64, D>> = vectors(all);
        let mut products: Vec<_> = self
            .points
            .iter()
            .zip(&dt)
            .zip(vectors(&moved))
            .map(|((point, dt), moved)| point.product(dt, &moved))
            .collect();
        if let (Some(border), Ok(gone)) = (border, <[f64; DIRECTIONS]>::try_from(&*last)) {
            last.copy_from_slice(&border.product(sites, (&dt, gone), &mut products));
        }
        all.chunks_exact_mut(D).zip(&products).for_each(|(to, product)| to.copy_from_slice(product.as_slice()));
        Ok(())
    }

    /// w = M^-1 w; whether there is one.
    fn precondition(&self, (behind, sites, border): Around<'_, D>, w: &mut [f64], room: &mut Vec<f64>) -> Result<bool> {
        let Some(waves) = behind.compliance.waves() else { return Err(unprepared()) };
        let some = (&self.patch, &self.points[..]);
        let (all, last) = w.split_at_mut(D * self.points.len());
        let (Some(border), Ok(gone)) = (border, <[f64; DIRECTIONS]>::try_from(&*last)) else {
            self.fourier.solve(waves, some, all, room)?;
            return Ok(true);
        };
        let inverse = |right: &[SVector<f64, D>]| {
            let mut solved: Vec<f64> = right.iter().flatten().copied().collect();
            self.fourier.solve(waves, some, &mut solved, &mut Vec::new())?;
            Ok(vectors(&solved))
        };
        let Some((solved, gone)) = border.solve(sites, (&vectors(all), gone), inverse)? else { return Ok(false) };
        all.chunks_exact_mut(D).zip(&solved).for_each(|(to, solved)| to.copy_from_slice(solved.as_slice()));
        last.copy_from_slice(&gone);
        Ok(true)
    }
}

/// Of components.
fn vectors<const D: usize>(list: &[f64]) -> Vec<SVector<f64, D>> {
    list.chunks_exact(D).map(SVector::from_column_slice).collect()
}
