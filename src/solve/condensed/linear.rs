//! Newton's linear system of the condensed problem: what it is made of at a state, its product and its solution.

use nalgebra::SVector;

use super::super::response::Response;
use super::super::traction::{self, Border, Factor, Fourier, Linearised};
use super::{Condensed, LARGE_PERIODIC_FACE, tractions, unprepared, write};
use crate::error::Result;
use crate::petsc::{Step, Vector};

/// More applications of an old factor than this in one solve, and a new one is made.
const STALE_AFTER: usize = 10;

/// Newton's linear system.
#[derive(Default)]
pub(super) struct Linear<const D: usize> {
    pub points: Vec<Linearised<D>>,
    /// Where the place of the indenter is unknown.
    pub border: Option<Border<D>>,
    pub factor: Option<Factor<D>>,
    pub fourier: Option<Fourier<D>>,
    /// The step that the factor was made for, and the secant.
    pub made_for: Option<(Step, f64)>,
    /// Solves since the last tangent.
    pub used: usize,
}

impl<const D: usize, R: Response<D>> Condensed<D, R> {
    /// Makes the system that of the state that was tried last.
    pub(super) fn linearise(&mut self, step: Step) -> Result<()> {
        let stage = self.stage.as_ref().ok_or_else(unprepared)?;
        let points = stage.trial.linearised(&stage.sites);
        let Some(behind) = self.behind() else { return Ok(()) };
        let border = self.with_laws(stage, |laws| Border::new(&stage.sites, (&stage.trial, &points), laws.held));
        let Linear { factor, made_for, used, .. } = &self.linear;
        let points_are_nodes = !self.face.interface.points().share_nodes();
        let fourier = match points_are_nodes && D * points.len() > LARGE_PERIODIC_FACE {
            true => Fourier::new(
                behind.compliance,
                behind.secant,
                &points,
                stage.sites.first().map_or(0.0, |site| site.weight),
            ),
            false => None,
        };
        if fourier.is_some() {
            self.linear = Linear { points, border, fourier, ..Linear::default() };
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
        self.linear = Linear { points, border, factor, fourier: None, made_for, used: 0 };
        Ok(())
    }

    /// product = J v
    pub(super) fn product(&mut self, v: &Vector, product: &mut Vector) -> Result<()> {
        let (Some(behind), Some(stage)) = (self.behind(), self.stage.as_ref()) else {
            product.view_mut()?;
            return Ok(());
        };
        let dt = tractions::<D>(v)?;
        let mut values = traction::product(&self.linear.points, &dt, &behind.moves(&dt)?);
        let mut last = self.last(v)?;
        if let Some(border) = &self.linear.border {
            last = border.product(&stage.sites, (&dt, last), &mut values);
        }
        write(product, values.into_iter())?;
        self.write_last(last, product)
    }

    /// x = J^-1 b, or nearly so.
    pub(super) fn solution(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        self.linear.used += 1;
        let (right, mut last) = (tractions::<D>(b)?, self.last(b)?);
        let inverse = |right: &[SVector<f64, D>]| match (&self.linear, self.behind()) {
            (Linear { fourier: Some(fourier), points, .. }, Some(_)) => fourier.solve(points, right),
            (Linear { factor: Some(factor), .. }, Some(behind)) => factor.solve(right, |t| behind.moves(t)),
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
}
