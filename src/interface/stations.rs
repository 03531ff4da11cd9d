//! The points of the contact in a step, for a solver that meets the laws point by point.

use super::sites::Point;
use super::{Interface, Surface};
use crate::element::mpjr::{Motion, Resistance};
use crate::error::Result;
use crate::loading::Placement;

/// A point of the contact during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// Where it is.
    pub point: Point,
    /// With the layer where it was at the accepted state, and at rest.
    pub motion: Motion,
    /// The displacement along t at the accepted state, m.
    pub before: f64,
    /// Of the normal law.
    pub resistance: Resistance,
}

impl Interface {
    /// The points of the contact in a step to `placement` from the accepted state `surface`.
    pub fn stations(&mut self, placement: Placement, surface: &Surface) -> Result<Vec<Station>> {
        self.attempt(placement)?;
        let at_rest = Surface { displacement: surface.displacement.clone(), rate: vec![0.0; surface.rate.len()] };
        let station = |((point, motion), resistance): ((&Point, Motion), Resistance)| {
            let before = (point.frame * surface.at(point.nodes, point.shape).displacement).x;
            Station { point: *point, motion, before, resistance }
        };
        Ok(self.acting.motions(placement, &at_rest).zip(self.resistances()).map(station).collect())
    }
}
