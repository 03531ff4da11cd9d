//! The energy that passes through the contact face.
//!
//! ```text
//! work of the indenter over a step:  N dD + (Q + integral of p dh/dx) ds, the forces as the mean of both ends
//! friction over a step:              integral of q w dt, with q as the mean of both ends and w that over the step
//! penalty:                           integral of 1/2 alpha g*^2 where g* < 0
//! ```

use super::{Interface, Surface, motion};
use crate::element::mpjr;
use crate::energy::FaceEnergy;
use crate::error::Result;
use crate::loading::Placement;
use crate::snapshot::Snapshot;

/// The energy that went through the face up to an accepted state, and what of that state the next step needs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Exchange {
    energy: FaceEnergy,
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
        Self { shear: vec![0.0; interface.points.len()], ..Self::default() }
    }

    /// What went through.
    pub fn energy(&self) -> FaceEnergy {
        self.energy
    }

    /// Takes the account to the end of an accepted step of length `dt`, s, where the face is as given.
    pub fn advance(&mut self, interface: &mut Interface, place: Placement, surface: &Surface, dt: f64) -> Result<()> {
        interface.place(place)?;
        let (mut normal, mut along) = (0.0, 0.0);
        let (law, penalty) = (interface.laws.friction.as_ref(), interface.laws.penalty);
        self.energy.penalty = 0.0;
        for ((point, elevation), before) in interface.points.iter().zip(&interface.elevations).zip(&mut self.shear) {
            let motion = motion(point, elevation, place, surface);
            let traction = mpjr::traction(motion, penalty, law);
            self.energy.friction += point.weight * 0.5 * (*before + traction.shear) * motion.slip_rate * dt;
            self.energy.penalty += point.weight * 0.5 * traction.pressure * traction.pressure / penalty;
            *before = traction.shear;
            let [down, tangential, hysteretic] = point.forces(&traction, elevation.slope);
            normal += down;
            along += tangential + hysteretic;
        }
        self.energy.work += 0.5 * (self.normal + normal) * (place.approach - self.place.approach)
            + 0.5 * (self.along + along) * (place.sliding - self.place.sliding);
        (self.normal, self.along, self.place) = (normal, along, place);
        Ok(())
    }

    /// Adds the account to a snapshot.
    pub fn save(&self, snapshot: &mut Snapshot) {
        let Self { energy: FaceEnergy { work, friction, penalty }, normal, along, .. } = self;
        snapshot.put("face-energy", vec![*work, *friction, *penalty, *normal, *along]);
        snapshot.put("face-shear", self.shear.clone());
    }

    /// Takes the account from a snapshot of a state where the indenter is at `place`.
    pub fn restore(&mut self, snapshot: &Snapshot, place: Placement) -> Result<()> {
        let [work, friction, penalty, normal, along] = snapshot.numbers("face-energy")?;
        self.energy = FaceEnergy { work, friction, penalty };
        (self.normal, self.along, self.place) = (normal, along, place);
        snapshot.fill("face-shear", &mut self.shear)
    }
}
