//! Coulomb's law regularised by the slip rate.

use super::{Circumstances, Kind, Law, Share, Softness, Strength};

pub(super) const KIND: Kind = Kind {
    name: "coulomb_tanh",
    softness: Some(Softness { key: "regularisation", what: "a positive slip rate in m/s", is_rate: true }),
    make: |strength, regularisation| Box::new(CoulombTanh { strength, regularisation }),
    told: |regularisation| format!("regularised by tanh over {regularisation} m/s"),
};

/// |q| = B tanh(m/(eps dt)), Bonari and Paggi (2020), Eq. (4): sticks by creeping at a slip rate below eps.
#[derive(Debug, Clone)]
pub struct CoulombTanh {
    /// B
    pub strength: Strength,
    /// Slip rate eps over which the direction turns, m/s.
    pub regularisation: f64,
}

impl CoulombTanh {
    /// eps dt, as far as it can be resolved, m.
    fn length(&self, at: Circumstances) -> f64 {
        (self.regularisation * at.dt).max(at.resolution)
    }
}

impl Law for CoulombTanh {
    fn strength(&self) -> &Strength {
        &self.strength
    }

    fn share(&self, at: Circumstances, slip: f64) -> Share {
        let length = self.length(at);
        let x = slip / length;
        // sech without the cancellation of 1 - tanh^2 and without overflow.
        let sech = if x > 350.0 { 0.0 } else { 1.0 / x.cosh() };
        Share { value: x.tanh(), by_slip: sech * sech / length }
    }

    fn sharpness(&self, dt: f64) -> f64 {
        self.regularisation * dt
    }

    /// Where the slip rate is below eps, that is |q| < tanh(1) B = 0.76 B; it creeps meanwhile.
    fn sticks(&self, at: Circumstances, slip: f64) -> bool {
        slip / self.length(at) < 1.0
    }
}
