//! Coulomb's law regularised by the slip.

use super::{Shear, Slip};

/// Coulomb's law with an elastic part e of the slip, at most gamma either way:
///
/// ```text
/// q = f p e/gamma,    e = e_n + w dt returned to [-gamma, gamma];    |e| < gamma: sticks
/// ```
///
/// Rate-independent: return mapping (Simo and Hughes, Computational Inelasticity, 1.4; Wriggers, Computational Contact
/// Mechanics, 5.2) with the tangential stiffness f p/gamma. That it goes with the pressure, as in Abaqus, is a choice:
/// the slip that a sticking point is let do is then the same stated length all over the contact, up to its edges; with a
/// constant stiffness it would go with the pressure, which no scene knows beforehand. In exchange the traction of
/// a sticking point goes with its pressure until it slips back by what is too much, again gamma at most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticSlip {
    /// Coefficient of friction f, -.
    pub coefficient: f64,
    /// gamma, m.
    pub elastic_slip: f64,
}

impl ElasticSlip {
    /// `stuck` is e; the rest of the slip, w dt - (e - e_n), is what dissipates.
    pub(super) fn shear(&self, pressure: f64, Slip { rate, dt, stuck, .. }: Slip) -> Shear {
        let Self { coefficient, elastic_slip } = *self;
        let trial = stuck + rate * dt;
        let sticks = trial.abs() < elastic_slip;
        let stuck = trial.clamp(-elastic_slip, elastic_slip);
        let direction = stuck / elastic_slip;
        Shear {
            shear: coefficient * pressure * direction,
            by_pressure: coefficient * direction,
            by_rate: if sticks { coefficient * pressure / elastic_slip * dt } else { 0.0 },
            stuck,
            sticks,
        }
    }

    /// Which way a point slips; 0 where it sticks.
    pub(super) fn direction(&self, Slip { rate, dt, stuck, .. }: Slip) -> f64 {
        let trial = stuck + rate * dt;
        if trial.abs() < self.elastic_slip { 0.0 } else { trial.signum() }
    }

    /// What sticks goes on to, and so does what slips when the indenter turns back.
    pub(super) fn expected(&self, Slip { stuck, .. }: Slip, drive: f64) -> Option<f64> {
        (stuck.abs() < self.elastic_slip || stuck * drive < 0.0).then_some(0.0)
    }
}
