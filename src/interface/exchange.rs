//! The energy that passes through the contact face.
//!
//! With the tractions of a point as the mean of both ends of a step, dD, dh and V dt what the indenter does in it:
//!
//! ```text
//! work of the indenter:  integral of p (n_z (dD - dh) + dg) + q.V dt, dg the change of the gap where there is one
//! friction:              integral of q.d, d the slip that dissipates; at least 0
//! penalty:               integral of 1/2 p o, and what elastic slip has stored
//! ```
//!
//! dh, the change of the profile over the point, rather than its slope: it serves kinks and long steps. No law lets q work against
//! the slip that it ends. Where the old q does, by more than the new one works along it, q has turned within the step, and their
//! mean says nothing of when: then friction takes nothing. So what it takes never falls.

use nalgebra::SVector;

use super::{Interface, State};
use crate::energy::FaceEnergy;
use crate::error::Result;
use crate::loading::Placement;
use crate::snapshot::Snapshot;

/// The energy that went through the face up to an accepted state, and what of that state the next step needs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Exchange {
    energy: FaceEnergy,
    /// Stored by elastic slip since t = 0, J/m.
    elastic: f64,
    /// h over each point, m.
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

    /// Takes the account to the end of a step that is about to be committed.
    pub fn advance<const D: usize>(
        &mut self,
        interface: &mut Interface<D>,
        place: Placement,
        states: &[State<D>],
    ) -> Result<()> {
        interface.place(place)?;
        let dt = place.dt;
        let way = place.way();
        let mut penalty = 0.0;
        let heights = heights(interface);
        for (i, (before, after)) in interface.states().iter().zip(states).enumerate() {
            let point = &interface.points().all()[i];
            let opened = before.overlap.min(0.0) - after.overlap.min(0.0);
            let closed = point.normal[D - 1] * (place.approach_rate * dt - (heights[i] - self.heights[i])) + opened;
            let (pressure, shear) = (0.5 * (before.pressure + after.pressure), 0.5 * (before.shear + after.shear));
            let held = |state: &State<D>| interface.friction().map_or(SVector::zeros(), |law| state.elastic(law));
            let stored = held(after) - held(before);
            self.elastic += point.weight * shear.dot(&stored);
            let lost = after.slip - stored;
            // What friction is not let give back, the indenter is not let take.
            let taken = shear.dot(&lost).max(0.0);
            self.energy.friction += point.weight * taken;
            self.energy.work += point.weight * (pressure * closed + shear.dot(&(way - lost)) + taken);
            penalty += 0.5 * point.weight * after.pressure * after.overlap;
        }
        self.heights = heights;
        self.energy.penalty = penalty + self.elastic;
        Ok(())
    }

    /// Adds the account to a snapshot.
    pub fn save(&self, snapshot: &mut Snapshot) {
        let Self { energy: FaceEnergy { work, friction, penalty }, elastic, .. } = self;
        snapshot.put("face-energy", vec![*work, *friction, *penalty, *elastic]);
        snapshot.put("face-heights", self.heights.clone());
    }

    /// Takes the account from a snapshot.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let [work, friction, penalty, elastic] = snapshot.numbers("face-energy")?;
        self.energy = FaceEnergy { work, friction, penalty };
        self.elastic = elastic;
        snapshot.fill("face-heights", &mut self.heights)
    }
}

/// h over each point where the indenter was placed last, m.
fn heights<const D: usize>(interface: &Interface<D>) -> Vec<f64> {
    interface.points().heights().iter().map(|height| height.height).collect()
}
