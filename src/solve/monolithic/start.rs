//! Where Newton's method on displacements starts under laws that are too stiff for it, or under a force that presses on nothing yet: where
//! the laws hold on a face that is solved for its tractions.

use nalgebra::SVector;

use super::Monolithic;
use crate::error::Result;
use crate::loading::{DIRECTIONS, Support};
use crate::petsc::{Step, Vector};
use crate::solve::traction::{self, Behind, Held, Laws, Outcome};

/// A face at which the laws hold.
struct Settled {
    /// On its nodes, N/m.
    forces: Vec<f64>,
    /// Of them, m.
    displacements: Vec<f64>,
    /// How far the indenter has gone on in each direction, m.
    gone: [f64; DIRECTIONS],
}

impl<const D: usize> Monolithic<D> {
    /// Whether the laws are too stiff for Newton's method on displacements from where the face was: the penalty beside the body,
    /// or the way of the indenter in a step beside the slip over which friction turns.
    pub(super) fn is_stiff(&mut self, step: Step) -> Result<bool> {
        const PENALTY: f64 = 1e2;
        const TURNS: f64 = 5.0;
        let placement = self.face.placement(step)?;
        let moved = self.face.interface().placement().ways(&placement).map(|way| (way.far[1] - way.far[0]).abs());
        let way = placement.sliding_rate.norm().max(placement.approach_rate.abs()) * step.dt;
        let way = moved.into_iter().fold(way, f64::max);
        if self.face.interface().friction().is_some_and(|law| way > TURNS * law.sharpness(step.dt)) {
            return Ok(true);
        }
        let softest = self.softness(step.dt)?.into_iter().fold(0.0, f64::max);
        Ok(self.face.interface().stiffest() * softest > PENALTY)
    }

    /// Of each component of the face in a step of length `dt`, m per N/m: of a node with its neighbours held, which is less than the
    /// body's.
    pub(super) fn softness(&mut self, dt: f64) -> Result<Vec<f64>> {
        self.round_off.prepare(&mut self.bulk, dt)?;
        Ok(self.face.gather(&self.round_off.stiffness)?.into_iter().map(f64::recip).collect())
    }

    /// Whether a force presses on nothing where the face was.
    pub(super) fn falls(&mut self, step: Step, u: &Vector) -> Result<bool> {
        if !self.face.placement(step)?.supports[0].as_ref().is_some_and(Support::is_force) {
            return Ok(false);
        }
        self.face.try_state(step, u)?;
        Ok(self.face.answers()?.iter().all(|(_, traction)| traction.pressure <= 0.0))
    }

    /// Makes `u`, the accepted state, a start at which the tractions meet the laws.
    pub(super) fn start(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        let (mut load, mut change, mut accepted) = (u.like()?, u.like()?, u.like()?);
        accepted.copy_from(u)?;
        self.bulk.force(step, u, &change, &mut load)?;
        self.inverse.compliance(&self.bulk, step.dt, self.face.interface().face())?;
        self.inverse.solve_bulk(&load, &mut change)?;
        u.add(-1.0, &change)?;
        let free = self.face.gather(u)?;
        let Some(Settled { forces, displacements, gone }) = self.settle(step, free)? else { return Ok(()) };
        self.face.gone = gone;
        load.set(0.0)?;
        self.on_face(&forces, &mut load)?;
        self.inverse.solve_bulk(&load, &mut change)?;
        u.add(1.0, &change)?;
        // What round-off in the factor left.
        let (mut rate, mut force) = (u.like()?, u.like()?);
        rate.copy_from(u)?;
        rate.combine(-1.0 / step.dt, &accepted, 1.0 / step.dt)?;
        self.bulk.force(step, u, &rate, &mut force)?;
        load.add(-1.0, &force)?;
        self.inverse.solve_bulk(&load, &mut change)?;
        u.add(1.0, &change)?;
        self.started = true;
        self.on_face(&displacements, u)
    }

    /// The face where the laws hold, on every rank. Collective.
    fn settle(&mut self, step: Step, free: Vec<f64>) -> Result<Option<Settled>> {
        let placement = self.face.placement(step)?;
        self.face.accepted.interface.place(placement)?;
        let interface = self.face.interface();
        let Some((compliance, secant)) = self.inverse.compliance(&self.bulk, step.dt, interface.face())? else {
            return Ok(None);
        };
        let behind = Behind { interface, compliance, secant };
        let sites = behind.sites(&self.face.accepted, placement, &free);
        let resolution = placement.resolution * step.dt;
        let profile = interface.profile_beyond(placement.sliding);
        let laws = Laws {
            penalty: interface.penalty(),
            friction: interface.friction(),
            wear: None,
            adhesion: None,
            dt: step.dt,
            resolution,
            held: Held { supports: placement.supports, profile: Some(&profile) },
        };
        let normals = interface.points().all().iter().map(|point| point.normal);
        let tractions: Vec<SVector<f64, D>> =
            interface.states().iter().zip(normals).map(|(state, normal)| state.on_layer(&normal)).collect();
        let at_rest = behind.at_points(&free);
        let moved = |t: &[SVector<f64, D>]| -> Result<Vec<SVector<f64, D>>> {
            Ok(behind.moves(t)?.iter().zip(&at_rest).map(|(moved, free)| moved + free).collect())
        };
        let mut first = Outcome::new(&sites, tractions.clone(), (moved(&tractions)?, SVector::zeros()), laws);
        if let (0, Some(support)) = (first.in_contact(), placement.supports[0].filter(Support::is_force)) {
            let down = traction::axis(0) * traction::touch(&sites, &first.motions, support.force);
            let moves: Vec<_> = sites.iter().map(|site| traction::against(site, &-down)).collect();
            first = first.taken(&sites, (&vec![SVector::zeros(); sites.len()], &moves, -down), (1.0, laws));
        }
        let operator: traction::Operator<'_, D> = (&|j, rows| behind.influence(j, rows), &|t| behind.moves(t));
        // To the last digits: what displacements make of the tractions is more than they are off.
        let outcome = traction::start(&sites, first, laws, operator, f64::EPSILON)?;
        let (mut displacements, forces) = behind.displaced(&outcome.met(&sites), &free)?;
        if let Some(penalty) = interface.penalty() {
            for (i, answer) in outcome.answers.iter().filter(|(_, answer)| answer.active) {
                if let [(node, _)] = interface.points().shares(*i) {
                    let motion = answer.motion(&sites[*i], penalty) - outcome.against(&sites[*i], *i);
                    displacements[D * node..][..D].copy_from_slice(motion.as_slice());
                }
            }
        }
        let gone = std::array::from_fn(|direction| outcome.shift.dot(&traction::axis(direction)));
        Ok(Some(Settled { forces, displacements, gone }))
    }

    /// Sets the face's nodes in a vector of the body.
    fn on_face(&self, from: &[f64], to: &mut Vector) -> Result<()> {
        let mut values = to.view_mut()?;
        for (node, &(_, local)) in from.chunks_exact(D).zip(&self.rows) {
            if let Some(row) = local {
                values[row..][..D].copy_from_slice(node);
            }
        }
        Ok(())
    }
}
