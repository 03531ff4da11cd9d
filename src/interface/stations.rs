//! The points of the contact in a step, for a solver that meets the laws point by point.

use super::sites::Point;
use super::{Interface, Surface};
use crate::element::mpjr::{Frame, Motion, Resistance};
use crate::error::Result;
use crate::friction::Slip;
use crate::loading::Placement;

/// A point of the contact during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// The nodes that share it.
    pub nodes: [usize; 2],
    /// Their shares.
    pub shape: [f64; 2],
    /// m
    pub weight: f64,
    /// Rows t, n.
    pub frame: Frame,
    /// Over the undeformed face, along n, m.
    pub clearance: f64,
    /// The displacement along t at the accepted state, m.
    pub before: f64,
    /// With the layer at rest in this step.
    pub slip: Slip,
    /// Of the normal law.
    pub resistance: Resistance,
}

impl Interface {
    /// The points of the contact in a step to `placement` from the accepted state `surface`.
    pub fn stations(&mut self, placement: Placement, surface: &Surface) -> Result<Vec<Station>> {
        self.attempt(placement)?;
        let at_rest = Surface { displacement: surface.displacement.clone(), rate: vec![0.0; surface.rate.len()] };
        let penalty = self.penalty();
        let multipliers = self.augmentation.as_ref().map(|augmentation| &augmentation.multipliers().pressure);
        let station = |(i, (point, motion)): (usize, (&Point, Motion))| Station {
            nodes: point.nodes,
            shape: point.shape,
            weight: point.weight,
            frame: point.frame,
            clearance: motion.clearance,
            before: (point.frame * surface.at(point.nodes, point.shape).displacement).x,
            slip: motion.slip,
            resistance: Resistance { penalty, multiplier: multipliers.map_or(0.0, |all| all[i]) },
        };
        Ok(self.acting.motions(placement, &at_rest).enumerate().map(station).collect())
    }
}
