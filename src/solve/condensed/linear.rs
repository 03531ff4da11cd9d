//! Newton's linear system of the condensed problem: what it is made of at a state, its product and its solution.

use nalgebra::SVector;

use super::super::response::Response;
use super::super::traction::{self, Behind, Border, Factor, Fourier, Linearised, Pointwise};
use super::{Condensed, LARGE_PERIODIC_FACE, Way, tractions, unprepared, write};
use crate::error::{Error, Result};
use crate::petsc::{Step, Vector};

/// More applications of an old factor than this in one solve, and a new one is made.
const STALE_AFTER: usize = 10;

/// More unknowns than this, and a preconditioner is no dense factor of what the body does about: that of so many takes a second.
const MOST_NEARLY: usize = 2400;

/// Newton's linear system.
#[derive(Default)]
pub(super) struct Linear<const D: usize> {
    pub points: Vec<Linearised<D>>,
    /// Where the place of the indenter is unknown.
    pub border: Option<Border<D>>,
    pub factor: Option<Factor<D>>,
    pub fourier: Option<Fourier>,
    pub pointwise: Option<Pointwise<D>>,
    /// The step that the factor was made for, and the secant.
    pub made_for: Option<(Step, f64)>,
    /// Solves since the last tangent.
    pub used: usize,
    /// For what passes through transforms, kept from one product to the next.
    pub room: Vec<f64>,
}

impl<const D: usize, R: Response<D>> Condensed<D, R> {
    /// Makes the system that of the state that was tried last.
    pub(super) fn linearise(&mut self, step: Step) -> Result<()> {
        if self.way == Way::Pressures {
            return Ok(());
        }
        let stage = self.stage.as_ref().ok_or_else(unprepared)?;
        let points = stage.trial.linearised(&stage.sites);
        let Some(behind) = self.behind() else { return Ok(()) };
        let border = self.with_laws(stage, |laws| Border::new(&stage.sites, (&stage.trial, &points), laws.held));
        if self.way == Way::Products {
            self.linear = Linear { border, ..nearly(&behind, points) };
            return Ok(());
        }
        let Linear { factor, made_for, used, .. } = &self.linear;
        let points_are_nodes = !self.face.interface.points().share_nodes();
        let everywhere = self.face.interface.points().everywhere();
        let fourier = match points_are_nodes && D * everywhere > LARGE_PERIODIC_FACE {
            true => Fourier::new(
                behind.compliance,
                behind.secant,
                &points,
                stage.sites.first().map_or(0.0, |site| site.weight),
            ),
            false => None,
        };
        if fourier.is_some() {
            let room = std::mem::take(&mut self.linear.room);
            self.linear = Linear { points, border, fourier, room, ..Linear::default() };
            return Ok(());
        }
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

    /// product = J v
    pub(super) fn product(&mut self, v: &Vector, product: &mut Vector) -> Result<()> {
        if self.way == Way::Pressures {
            let reason =
                "contact without friction is solved by conjugate gradients of its own here: leave -ksp_type out";
            return Err(Error::Usage(reason.into()));
        }
        if self.linear.fourier.is_some() && self.linear.border.is_none() {
            return self.product_by_transforms(v, product);
        }
        let (Some(behind), Some(stage)) = (self.behind(), self.stage.as_ref()) else {
            product.view_mut()?;
            return Ok(());
        };
        let dt = tractions::<D>(v)?;
        let mut values = traction::product(&self.linear.points, &dt, &behind.moves_roughly(&dt)?);
        let mut last = self.last(v)?;
        if let Some(border) = &self.linear.border {
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
        self.linear.used += 1;
        if self.linear.fourier.is_some() && self.linear.border.is_none() {
            return self.solution_by_transforms(b, x);
        }
        let (right, mut last) = (tractions::<D>(b)?, self.last(b)?);
        let inverse = |right: &[SVector<f64, D>]| match (&self.linear, self.behind()) {
            (Linear { fourier: Some(fourier), points, .. }, Some(behind)) => {
                let mut solved: Vec<f64> = right.iter().flatten().copied().collect();
                fourier.solve(behind.compliance, points, &mut solved, &mut Vec::new())?;
                Ok(solved.chunks_exact(D).map(SVector::from_column_slice).collect())
            }
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
                let (solution, gone) = solved.unwrap_or_else(|| {
                    // Nothing touches: down to where something does.
                    let force = stage.placement.supports[0].map_or(0.0, |support| support.force);
                    let down = traction::touch(&stage.sites, &stage.trial.motions, force);
                    (right, [-down * border.modulus, 0.0, 0.0])
                });
                last = gone;
                solution
            }
            _ => inverse(&right)?,
        };
        write(x, solution.into_iter())?;
        self.write_last(last, x)
    }

    /// The same of a large periodic face, its nodes the points, under an indenter whose place is given: in as few passes as there are.
    fn product_by_transforms(&mut self, v: &Vector, product: &mut Vector) -> Result<()> {
        let mut room = std::mem::take(&mut self.linear.room);
        let (Some(behind), Some(stage)) = (self.behind(), self.stage.as_ref()) else { return Err(unprepared()) };
        let v = v.view()?;
        let per_traction = stage.sites.first().map_or(0.0, |site| site.weight) / behind.secant;
        room.clear();
        room.extend(v.iter().map(|t| t * per_traction));
        behind.compliance.displace(&mut room, if behind.is_normal_alone() { D - 1..D } else { 0..D })?;
        let moved = room.chunks_exact(D).map(SVector::from_column_slice);
        let of = |((point, dt), moved): ((&Linearised<D>, _), _)| point.product(&dt, &moved);
        let products =
            self.linear.points.iter().zip(v.chunks_exact(D).map(SVector::from_column_slice)).zip(moved).map(of);
        write(product, products)?;
        self.linear.room = room;
        Ok(())
    }

    /// See [`Self::product_by_transforms`].
    fn solution_by_transforms(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        let mut room = std::mem::take(&mut self.linear.room);
        let (Some(behind), Some(fourier)) = (self.behind(), &self.linear.fourier) else { return Err(unprepared()) };
        let mut solved = x.view_mut()?;
        solved.copy_from_slice(&b.view()?);
        fourier.solve(behind.compliance, &self.linear.points, &mut solved, &mut room)?;
        drop(solved);
        self.linear.room = room;
        Ok(())
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
