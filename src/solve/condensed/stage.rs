//! The step that is being solved, from its first residual until it is accepted.

use nalgebra::SVector;

use super::Condensed;
use super::jump::Jump;
use crate::error::Result;
use crate::friction::Law;
use crate::interface::State;
use crate::loading::Placement;
use crate::petsc::Step;
use crate::solve::response::Response;
use crate::solve::traction::{self, Answer, Held, Laws, Outcome, Site, Sites};

/// The points of the contact in one step.
pub(super) struct Stage<const D: usize> {
    pub step: Step,
    pub placement: Placement,
    /// Whether nothing has to move: under an indenter that does not, the accepted tractions leave all where it was, to the last digit,
    /// and friction does not creep.
    pub still: bool,
    /// On the ranks that have points.
    pub sites: Sites<D>,
    /// The last state that was tried.
    pub trial: Outcome<D>,
    /// The norm of G at the first.
    pub first: Option<f64>,
    /// Newton steps so far.
    pub newton: usize,
    /// The norm of G at the last linear system, and the share of its right side that it was solved to.
    pub solved: Option<[f64; 2]>,
    /// The jump that is followed, where something adheres.
    pub jump: Option<Jump<D>>,
    /// Whether Newton's method has ended at a state that does not stay.
    pub falls: bool,
    /// What a point is to slip, m, if it goes on as it did and follows what moves the indenter.
    pub usual: f64,
}

impl<const D: usize, R: Response<D>> Condensed<D, R> {
    /// Makes the stage that of `step`.
    pub(super) fn enter(&mut self, step: Step) -> Result<()> {
        if self.stage.as_ref().is_some_and(|stage| stage.step == step) {
            return Ok(());
        }
        self.response.prepare(step)?;
        let placement = self.face.placement(step)?;
        self.face.interface.place(placement)?;
        self.response.free(step, &mut self.free)?;
        let (trial, usual) = (Outcome::none(), self.usual_slip(&placement));
        let sites = match self.behind() {
            Some(behind) => behind.sites(&self.face, placement, &self.free.view()?),
            None => Sites::none(),
        };
        let still = placement.is_still()
            && self.face.interface.friction().is_none_or(Law::rests)
            && self.team().all_say(self.displaced(&self.accepted)?.0 == self.face.displacement());
        self.stage = Some(Stage {
            step,
            placement,
            still,
            sites,
            trial,
            first: None,
            newton: 0,
            solved: None,
            jump: None,
            falls: false,
            usual,
        });
        Ok(())
    }

    /// See [`Stage::usual`].
    pub(super) fn usual_slip(&self, to: &Placement) -> f64 {
        let moved: f64 =
            self.face.interface.placement().ways(to).iter().map(|way| (way.far[1] - way.far[0]).abs()).sum();
        let (mut slipped, mut pressed) = (0.0, 0.0);
        for (point, state) in self.face.interface.points().all().iter().zip(self.face.interface.states()) {
            slipped += point.weight * state.pressure * state.slip.norm();
            pressed += point.weight * state.pressure;
        }
        let [slipped, pressed] = self.team().sum([slipped, pressed]);
        let mean = if pressed > 0.0 { slipped / pressed } else { 0.0 };
        moved + mean * to.dt / self.face.last_step()
    }

    /// Whether the state that was tried last, which meets the laws, is one that nothing but the step decides.
    pub(super) fn jumped(&self, stage: &Stage<D>) -> bool {
        let before: Vec<f64> = self.face.interface.states().iter().map(|state| state.shear.norm()).collect();
        self.with_laws(stage, |laws| traction::jumped(&stage.sites, &stage.trial, laws, (stage.usual, &before)))
    }

    /// Calls with the laws of a step.
    pub(super) fn with_laws<T>(&self, stage: &Stage<D>, call: impl FnOnce(Laws<'_>) -> T) -> T {
        let interface = &self.face.interface;
        let profile = interface.profile_beyond(stage.placement.sliding);
        call(Laws {
            penalty: interface.penalty(),
            friction: interface.friction(),
            wear: interface.wear(),
            adhesion: interface.adhesion(),
            dt: stage.step.dt,
            resolution: 0.0,
            held: Held { supports: stage.placement.supports, profile: Some(&profile) },
        })
    }

    /// The tractions at the end of a step, and the points.
    ///
    /// Where nothing moved there was nothing for the laws to do, and what is in contact rests, to the last digit: the laws would take
    /// every digit that round-off puts beyond f p and give none back.
    pub(super) fn ends(&self, stage: &Stage<D>, outcome: &Outcome<D>) -> (Vec<SVector<f64, D>>, Vec<State<D>>) {
        let rests = self.rests(stage, outcome);
        let met = if rests { outcome.tractions.clone() } else { outcome.met(&stage.sites) };
        let ends = stage.sites.iter().zip(&outcome.motions).zip(self.face.interface.states()).enumerate();
        let mut answers = outcome.answers.iter().peekable();
        let states = self.with_laws(stage, |laws| {
            let state =
                |(i, ((site, motion), before)): (usize, ((&Site<D>, &SVector<f64, D>), &State<D>))| match answers
                    .next_if(|(point, _)| *point == i)
                {
                    Some((_, answer)) if answer.active && rests => before.at_rest(),
                    Some((_, answer)) => answer.state(site, motion, laws, before),
                    None => Answer::none(site, motion).state(site, motion, laws, before),
                };
            ends.map(state).collect()
        });
        (met, states)
    }

    /// Whether nothing moves in the step. Collective.
    pub(super) fn rests(&self, stage: &Stage<D>, outcome: &Outcome<D>) -> bool {
        stage.still && self.team().all_say(outcome.tractions == self.accepted)
    }
}
