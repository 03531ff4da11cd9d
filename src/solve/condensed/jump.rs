//! The way from one state of a face that adheres to another, where Newton's method finds none.
//!
//! What is left of the laws, were the contact let go, moves it downhill to a state that stays: that way is gone in implicit steps, of
//! which each is a problem with one answer ([`Damping`]), longer and longer ones, until what holds the face back bears next to nothing
//! of its tractions. Then Newton's method ends it without that.

use nalgebra::SVector;

use super::super::response::Response;
use super::super::traction::{Along, Behind, Damping, Outcome, Site, is_stable, length};
use super::{Condensed, Stage, unprepared};
use crate::error::{Error, Result};
use crate::petsc::Vector;

/// Newton steps from where the face was before a jump is followed; and those which are to end it.
const PATIENCE: usize = 12;
const LAST: usize = 12;
/// kappa to begin with, over the steepest fall of the attraction.
const OVER: f64 = 1.5;
/// What is left of G at which a step on the way is done, over the tractions; and Newton steps of each at most.
const ENOUGH: f64 = 1e-4;
const EACH: usize = 12;
/// What holds the face back at which it has arrived, over the tractions.
const ARRIVED: f64 = 1e-3;
/// That of the next time, over it, where it had not.
const SOONER: f64 = 0.1;
/// By how much steps grow that took few Newton steps, and what few are.
const LONGER: f64 = 1.6;
const FEW: usize = 4;

/// A jump on its way.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Jump<const D: usize> {
    /// kappa, Pa/m.
    stiffness: f64,
    /// Whether nothing holds the face back at present.
    free: bool,
    /// The state that the present step on the way goes from.
    from: Outcome<D>,
    /// Newton steps since then.
    taken: usize,
    /// What holds the face back at which it is let go, over the tractions.
    arrived: f64,
}

impl<const D: usize> Jump<D> {
    /// Whether what is met now is met without anything that holds the face back.
    pub fn is_free(&self) -> bool {
        self.free
    }
}

/// The norm of what holds the points back, Pa m^((D-1)/2).
fn held<const D: usize>(sites: &[Site<D>], at: &Outcome<D>) -> f64 {
    let force = |(site, motion): (&Site<D>, &SVector<f64, D>)| {
        let held = |damping: Damping| damping.stiffness * (site.relative(motion).overlap - damping.overlap);
        site.weight * site.damping.map_or(0.0, held).powi(2)
    };
    sites.iter().zip(&at.motions).map(force).sum::<f64>().sqrt()
}

impl<const D: usize, R: Response<D>> Condensed<D, R> {
    /// Whether the next state is to be one on the way of a jump: Newton's method has had its time, knows no way, has ended where nothing
    /// stays, or has lost the contact that a force presses on.
    pub(super) fn jumps(&self, stage: &Stage<D>, decrement: &Vector) -> Result<bool> {
        if self.face.interface.adhesion().is_none() || stage.sites.is_empty() {
            return Ok(false);
        }
        let forced = stage.placement.supports[0].is_some_and(|support| support.is_force());
        let lost = forced && stage.newton > 1 && stage.trial.in_contact() == 0;
        let astray = stage.newton >= PATIENCE || !decrement.view()?.iter().all(|value| value.is_finite());
        Ok(stage.jump.is_some() || stage.falls || astray || lost)
    }

    /// Whether Newton's method has ended at a state that does not stay, of which the stage takes note; where a jump has ended is where it
    /// stays.
    pub(super) fn falls(&mut self) -> bool {
        let falls = |(stage, behind): (&Stage<D>, Behind<'_, D>)| {
            let influence = |j: usize, rows: &[usize]| behind.influence(j, rows);
            stage.jump.is_none()
                && !self.rests(stage, &stage.trial)
                && !self.with_laws(stage, |laws| is_stable(&stage.sites, &stage.trial, laws, &influence))
        };
        let adheres = self.face.interface.adhesion().is_some();
        let falls = adheres && self.stage.as_ref().zip(self.behind()).is_some_and(falls);
        if let Some(stage) = self.stage.as_mut() {
            stage.falls = falls;
        }
        falls
    }

    /// The next state on the way of a jump, which begins at the accepted tractions.
    pub(super) fn jump(&mut self, decrement: &Vector) -> Result<Outcome<D>> {
        let mut stage = self.stage.take().ok_or_else(unprepared)?;
        let next = match (self.behind(), self.face.interface.adhesion()) {
            (Some(behind), Some(law)) if stage.jump.is_none() => {
                let accepted = self.accepted.clone();
                let motions = behind.motions(&self.displaced(&accepted)?.0, &accepted);
                let none = SVector::zeros();
                let from = self.with_laws(&stage, |laws| Outcome::new(&stage.sites, accepted, (motions, none), laws));
                let stiffness = OVER * law.steepest_fall();
                self.hold(&mut stage, Jump { stiffness, free: false, from, taken: 0, arrived: ARRIVED })
            }
            (Some(behind), Some(law)) => {
                let (taken, moved, gone) = self.along(&behind, &stage.sites, decrement)?;
                let next = self.go_on(&mut stage, (&taken, &moved, gone));
                flown(&stage, &next, law.reach())?;
                next
            }
            _ => stage.trial.clone(),
        };
        self.stage = Some(stage);
        Ok(next)
    }

    /// Holds the points back from where a step on the way begins, or lets them go from there.
    fn hold(&self, stage: &mut Stage<D>, jump: Jump<D>) -> Outcome<D> {
        for (site, motion) in stage.sites.each().zip(&jump.from.motions) {
            let overlap = site.relative(motion).overlap;
            site.damping = (!jump.free).then_some(Damping { stiffness: jump.stiffness, overlap });
        }
        let from = self.with_laws(stage, |laws| jump.from.clone().under(&stage.sites, laws));
        stage.jump = Some(jump);
        from
    }

    /// A Newton step on the way, and the next step of that where one is done.
    fn go_on(&self, stage: &mut Stage<D>, along: Along<'_, D>) -> Outcome<D> {
        let to = self.with_laws(stage, |laws| length(&stage.sites, &stage.trial, along, laws).0);
        let Some(mut jump) = stage.jump.take() else { return to };
        jump.taken += 1;
        let size = to.size().max(self.scale);
        let done = to.norm() <= (ENOUGH * size).max(to.noise());
        let taken = jump.taken;
        let next = match jump.free {
            // It was not there yet: on from where it was let go.
            true if taken >= LAST => Jump { free: false, arrived: SOONER * jump.arrived, taken: 0, ..jump },
            false if done => {
                let stiffness = if taken <= FEW { jump.stiffness / LONGER } else { jump.stiffness };
                let free = held(&stage.sites, &to) <= jump.arrived * size;
                Jump { stiffness, free, from: to.clone(), taken: 0, ..jump }
            }
            false if taken >= EACH => Jump { stiffness: jump.stiffness * LONGER * LONGER, taken: 0, ..jump },
            _ => {
                stage.jump = Some(jump);
                return to;
            }
        };
        self.hold(stage, next)
    }
}

/// Refuses a face from which a force pulls the indenter off for good.
fn flown<const D: usize>(stage: &Stage<D>, at: &Outcome<D>, reach: f64) -> Result<()> {
    let pull = stage.placement.supports[0].filter(|support| support.is_force() && support.force <= 0.0);
    let gone = |(site, motion): (&Site<D>, &SVector<f64, D>)| -site.relative(motion).overlap >= reach;
    match pull.filter(|_| stage.sites.iter().zip(&at.motions).all(gone)) {
        Some(support) => Err(Error::Solver(format!(
            "a normal force of {:.6e} N/m pulls the indenter off at t = {:.6e} s: the adhesion bears less, and nothing else holds \
             it; pull less, or by an approach or a mount",
            support.force, stage.step.t
        ))),
        None => Ok(()),
    }
}
