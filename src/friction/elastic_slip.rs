//! Coulomb's law regularised by the slip.

use super::{Circumstances, Kind, Lasting, Law, Share, Softness, Strength};

pub(super) const KIND: Kind = Kind {
    name: "coulomb_elastic_slip",
    softness: Some(Softness { key: "elastic_slip", what: "a positive length in m", is_rate: false }),
    make: |strength, elastic_slip| Box::new(ElasticSlip { strength, elastic_slip }),
    told: |elastic_slip| format!("sticking up to an elastic slip of {elastic_slip} m"),
};

/// Coulomb's law with an elastic part e of the slip, at most gamma long:
///
/// ```text
/// |q| = B min(m/gamma, 1),    m = |e_n + slip of the step|,    e = its direction times min(m, gamma);    m < gamma: sticks
/// ```
///
/// Rate-independent: return mapping (Simo and Hughes, Computational Inelasticity, 1.4; Wriggers, Computational Contact
/// Mechanics, 5.2) with the tangential stiffness B/gamma. That it goes with the pressure, as in Abaqus, is a choice:
/// the slip that a sticking point is let do is then the same stated length all over the contact, up to its edges; with a
/// constant stiffness it would go with the pressure, which no scene knows beforehand. In exchange the traction of
/// a sticking point goes with its pressure until it slips back by what is too much, again gamma at most.
#[derive(Debug, Clone)]
pub struct ElasticSlip {
    /// B
    pub strength: Strength,
    /// gamma, m.
    pub elastic_slip: f64,
}

impl Law for ElasticSlip {
    fn strength(&self) -> &Strength {
        &self.strength
    }

    fn share(&self, at: Circumstances, slip: f64) -> Share {
        match self.sticks(at, slip) {
            true => Share { value: slip / self.elastic_slip, by_slip: 1.0 / self.elastic_slip },
            false => Share { value: 1.0, by_slip: 0.0 },
        }
    }

    fn sharpness(&self, _dt: f64) -> f64 {
        self.elastic_slip
    }

    fn sticks(&self, _at: Circumstances, slip: f64) -> bool {
        slip < self.elastic_slip
    }

    fn holds(&self) -> bool {
        true
    }

    fn elastic(&self, slip: f64) -> f64 {
        slip.min(self.elastic_slip)
    }

    /// What is not elastic.
    fn lasting(&self, slip: f64) -> Lasting {
        let length = slip - self.elastic_slip;
        match length > 0.0 {
            true => Lasting { length, by_slip: 1.0 },
            false => Lasting { length: 0.0, by_slip: 0.0 },
        }
    }
}
