//! The energy that passes through the contact face.
//!
//! ```text
//! work of the indenter over a step:  N dD + (Q + integral of p dh/dx) ds, the forces as the mean of both ends
//! friction over a step:            integral of q times the slip that dissipates, with q as the mean of both ends
//! penalty:                           integral of 1/2 p times the penetration, and what elastic slip has stored
//! ```

use super::{Answer, Interface, Surface};
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
    /// N, N/m
    normal: f64,
    /// Q + integral of p dh/dx, N/m
    along: f64,
    /// Where the indenter is.
    place: Placement,
    /// q at the integration points, Pa.
    shear: Vec<f64>,
}

impl Exchange {
    /// Of a face at rest.
    pub fn new(interface: &Interface) -> Self {
        Self { shear: vec![0.0; interface.acting.points.len()], ..Self::default() }
    }

    /// What went through.
    pub fn energy(&self) -> FaceEnergy {
        self.energy
    }

    /// Takes the account to the end of a step that is about to be committed, where the face is as given.
    pub fn advance(&mut self, interface: &mut Interface, place: Placement, surface: &Surface) -> Result<()> {
        interface.attempt(place)?;
        let (mut normal, mut along, mut penalty) = (0.0, 0.0, 0.0);
        let law = interface.friction();
        for (answer, before) in interface.answers(&interface.acting, place, surface).zip(&mut self.shear) {
            let Answer { point, elevation, motion, traction } = answer;
            let stored = law.map_or(0.0, |law| law.stored(motion.slip, traction.shear.stuck));
            let mean = point.weight * 0.5 * (*before + traction.shear.shear);
            self.energy.friction += mean * (motion.slip.rate * place.dt - stored);
            self.elastic += mean * stored;
            penalty += point.weight * 0.5 * traction.pressure * motion.penetration();
            *before = traction.shear.shear;
            let [down, tangential, hysteretic] = point.forces(&traction, elevation.slope);
            normal += down;
            along += tangential + hysteretic;
        }
        self.energy.penalty = penalty + self.elastic;
        self.energy.work += 0.5 * (self.normal + normal) * (place.approach - self.place.approach)
            + 0.5 * (self.along + along) * (place.sliding - self.place.sliding);
        (self.normal, self.along, self.place) = (normal, along, place);
        Ok(())
    }

    /// Adds the account to a snapshot.
    pub fn save(&self, snapshot: &mut Snapshot) {
        let Self { energy: FaceEnergy { work, friction, penalty }, elastic, normal, along, .. } = self;
        snapshot.put("face-energy", vec![*work, *friction, *penalty, *elastic, *normal, *along]);
        snapshot.put("face-shear", self.shear.clone());
    }

    /// Takes the account from a snapshot of a state where the indenter is at `place`.
    pub fn restore(&mut self, snapshot: &Snapshot, place: Placement) -> Result<()> {
        let [work, friction, penalty, elastic, normal, along] = snapshot.numbers("face-energy")?;
        self.energy = FaceEnergy { work, friction, penalty };
        (self.elastic, self.normal, self.along, self.place) = (elastic, normal, along, place);
        snapshot.fill("face-shear", &mut self.shear)
    }
}
