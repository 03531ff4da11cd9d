//! Coulomb's law itself.

use super::{Circumstances, Kind, Law, Share, Strength};

pub(super) const KIND: Kind = Kind {
    name: "coulomb",
    softness: None,
    make: |strength, _| Box::new(Coulomb { strength }),
    told: |_| "Coulomb's law itself".to_owned(),
};

/// |q| = B where the point slips; where it sticks, what it takes, up to B at no rate. Nothing is regularised: no creep, no
/// elastic slip.
#[derive(Debug, Clone)]
pub struct Coulomb {
    /// B
    pub strength: Strength,
}

impl Law for Coulomb {
    fn strength(&self) -> &Strength {
        &self.strength
    }

    /// At m = 0 the law says no more than |q| <= B; this is the least.
    fn share(&self, _at: Circumstances, slip: f64) -> Share {
        match slip > 0.0 {
            true => Share { value: 1.0, by_slip: 0.0 },
            false => Share { value: 0.0, by_slip: f64::INFINITY },
        }
    }

    fn sharpness(&self, _dt: f64) -> f64 {
        0.0
    }

    fn sticks(&self, _at: Circumstances, slip: f64) -> bool {
        slip == 0.0
    }
}
