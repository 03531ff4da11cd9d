//! The energy that passes through the contact face.
//!
//! With the tractions of a point as the mean of both ends of a step, dD, dh and V dt what the indenter does in it:
//!
//! ```text
//! work of the indenter:  integral of p (n_z (dD - dh) + dg) + q.V dt, dg the change of the gap where there is one
//! a mount's far end:     its force times what that moves, instead of the part of the indenter that it holds
//! friction:              integral of q.d, d the slip that dissipates; at least 0
//! penalty:               integral of 1/2 p o, and what elastic slip has stored
//! wear:                  integral of p dh_w
//! adhesion:              integral of its potential; the work of the indenter is then without dg
//! jumps:                 integral of p do less what that adds to the potential and the penalty: 0 along the law, for short steps
//! ```
//!
//! What an indenter wears at the points of the face is put down at nodes of its own, so that the profile over a point is then another by
//! a little: that counts as wear of the next step.
//!
//! dh, the change of the profile over the point, rather than its slope: it serves kinks and long steps. No law lets q work against
//! the slip that it ends. Where the old q does, by more than the new one works along it, q has turned within the step, and their
//! mean says nothing of when: then friction takes nothing. So what it takes never falls.

use nalgebra::SVector;

use super::{Interface, State};
use crate::adhesion;
use crate::energy::{FaceEnergy, MountEnergy};
use crate::error::Result;
use crate::friction::Law;
use crate::loading::{DIRECTIONS, Mount, Placement, Way};
use crate::parallel::Team;
use crate::snapshot::Snapshot;

/// What friction does at a point over a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rub<const D: usize> {
    /// The mean shear, Pa.
    pub shear: SVector<f64, D>,
    /// What of the slip went into what is elastic, m, and what is for good.
    pub stored: SVector<f64, D>,
    /// See `stored`.
    pub lost: SVector<f64, D>,
    /// What it dissipates, J/m^2; at least 0.
    pub taken: f64,
}

impl<const D: usize> Rub<D> {
    /// Between the states of a point at both ends of a step.
    pub fn new(law: Option<&dyn Law>, before: &State<D>, after: &State<D>) -> Self {
        let shear = 0.5 * (before.shear + after.shear);
        let held = |state: &State<D>| law.map_or(SVector::zeros(), |law| state.elastic(law));
        let stored = held(after) - held(before);
        let lost = after.slip - stored;
        Self { shear, stored, lost, taken: shear.dot(&lost).max(0.0) }
    }
}

/// The energy that went through the face up to an accepted state, and what of that state the next step needs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Exchange {
    energy: FaceEnergy,
    /// Stored by elastic slip since t = 0, J/m.
    elastic: f64,
    /// h over each point, with what the last step has worn off the indenter there, m.
    heights: Vec<f64>,
}

impl Exchange {
    /// Of a face at rest, with the indenter where it begins.
    pub fn new<const D: usize>(interface: &mut Interface<D>) -> Result<Self> {
        interface.place(Placement::default())?;
        Ok(Self { heights: heights(interface), ..Self::default() })
    }

    /// What went through.
    pub fn energy(&self) -> FaceEnergy {
        self.energy
    }

    /// Takes the account to the end of a step that is about to be committed. Collective.
    pub fn advance<const D: usize>(
        &mut self,
        interface: &mut Interface<D>,
        (place, mounts): (Placement, &[Option<Mount>; DIRECTIONS]),
        states: &[State<D>],
    ) -> Result<()> {
        let settled = self.settle(interface)?;
        interface.place(place)?;
        let dt = place.dt;
        let way = place.way();
        let (mut penalty, mut work, mut shears, mut pressing) = (0.0, 0.0, SVector::<f64, D>::zeros(), 0.0);
        let team = interface.team().clone();
        let [mut elastic, mut friction, mut wear] = team.so_far([self.elastic, self.energy.friction, self.energy.wear]);
        let mut heights = heights(interface);
        for (i, (before, after)) in interface.states().iter().zip(states).enumerate() {
            let point = &interface.points().all()[i];
            let opened = before.overlap.min(0.0) - after.overlap.min(0.0);
            let approached = point.normal[D - 1] * (place.approach_rate * dt - (heights[i] - self.heights[i]));
            let pressure = 0.5 * (before.pressure + after.pressure);
            let closed = match interface.adhesion() {
                None => approached + opened,
                Some(law) => {
                    let [stored, jumped] = attracted(law, before, after);
                    self.energy.adhesion += point.weight * stored;
                    self.energy.jumps += point.weight * jumped;
                    approached
                }
            };
            // What friction is not let give back, the indenter is not let take.
            let Rub { shear, stored, lost, taken } = Rub::new(interface.friction(), before, after);
            elastic += point.weight * shear.dot(&stored);
            friction += point.weight * taken;
            work += point.weight * (pressure * closed + shear.dot(&(way - lost)) + taken);
            pressing += point.weight * (pressure * point.normal[D - 1] - shear[D - 1]);
            shears += shear * point.weight;
            penalty += point.weight * pressed(interface.adhesion(), after);
            let worn = after.worn - before.worn;
            wear += point.weight * pressure * worn;
            if let Some(settled) = &settled {
                wear += point.weight * pressure * settled[i];
                heights[i] += worn;
            }
        }
        let across = if D > 2 { shears[1] } else { 0.0 };
        let [elastic, friction, wear, penalty, work, pressing, across] =
            team.sum([elastic, friction, wear, penalty, work, pressing, across]);
        (self.elastic, self.energy.friction, self.energy.wear) = (elastic, friction, wear);
        let normal = pressing * place.approach_rate * dt;
        // What the profile's slope meets goes with the first direction along the face: that of a plane, or of both mounts in space.
        let across = across * place.sliding_rate.y * dt;
        self.supply(interface.placement().ways(&place), mounts, [normal, work - normal - across, across]);
        self.heights = heights;
        self.energy.penalty = penalty + self.elastic;
        Ok(())
    }

    /// By how much the profile over each point is higher than what was worn off there says, m; none where it stays as it is.
    fn settle<const D: usize>(&mut self, interface: &mut Interface<D>) -> Result<Option<Vec<f64>>> {
        if !interface.reshapes() {
            return Ok(None);
        }
        interface.place(interface.placement())?;
        let now = heights(interface);
        let higher = now.iter().zip(&self.heights).map(|(now, before)| now - before).collect();
        self.heights = now;
        Ok(Some(higher))
    }

    /// Adds the work of a step in each direction: of the indenter, or of what moves its mount.
    fn supply(&mut self, ways: [Way; DIRECTIONS], mounts: &[Option<Mount>; DIRECTIONS], works: [f64; DIRECTIONS]) {
        let held = &mut self.energy.mounts;
        (held.spring, held.kinetic) = (0.0, 0.0);
        for ((way, mount), work) in ways.iter().zip(mounts).zip(works) {
            let Some(mount) = mount else {
                self.energy.work += work;
                continue;
            };
            let turnover = mount.turnover(way);
            self.energy.work += turnover.supplied;
            held.spring += turnover.stored;
            held.dashpot += turnover.dissipated;
            held.kinetic += turnover.kinetic;
        }
    }

    /// Adds the account to a snapshot.
    pub fn save(&self, team: &Team, snapshot: &mut Snapshot) {
        let Self { energy, elastic, .. } = self;
        let FaceEnergy { work, friction, penalty, wear, adhesion, jumps, mounts } = energy;
        let MountEnergy { spring, dashpot, kinetic } = mounts;
        let energies = [work, friction, penalty, elastic, spring, dashpot, kinetic, wear, adhesion, jumps];
        snapshot.put("face-energy", energies.map(|energy| *energy).to_vec());
        snapshot.put("face-heights", team.collected(self.heights.clone()));
    }

    /// Takes the account from a snapshot.
    pub fn restore(&mut self, team: &Team, snapshot: &Snapshot) -> Result<()> {
        let [work, friction, penalty, elastic, spring, dashpot, kinetic, wear, adhesion, jumps] =
            snapshot.numbers("face-energy")?;
        let mounts = MountEnergy { spring, dashpot, kinetic };
        self.energy = FaceEnergy { work, friction, penalty, wear, adhesion, jumps, mounts };
        self.elastic = elastic;
        snapshot.fill_own("face-heights", team, &mut self.heights)
    }
}

/// What the penalty stores at a point, J/m^2.
fn pressed<const D: usize>(law: Option<&dyn adhesion::Law>, state: &State<D>) -> f64 {
    match law {
        None => 0.5 * state.pressure * state.overlap,
        Some(law) => 0.5 * (state.pressure + law.strength()) * state.overlap.max(0.0),
    }
}

/// What the attraction at a point stores in a step, and what it does beyond that and the penalty, J/m^2.
fn attracted<const D: usize>(law: &dyn adhesion::Law, before: &State<D>, after: &State<D>) -> [f64; 2] {
    let stored = law.potential(after.overlap) - law.potential(before.overlap);
    let pressure = 0.5 * (before.pressure + after.pressure);
    let penalty = pressed(Some(law), after) - pressed(Some(law), before);
    [stored, pressure * (after.overlap - before.overlap) - stored - penalty]
}

/// h over each point where the indenter was placed last, m.
fn heights<const D: usize>(interface: &Interface<D>) -> Vec<f64> {
    interface.points().heights().iter().map(|height| height.height).collect()
}
