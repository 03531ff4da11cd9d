//! Coulomb's law itself.

use super::{Circumstances, Law, Met, Shear};

/// |q| = f p where the point slips; where it sticks, what it takes, up to that. Nothing is regularised: no creep, no elastic
/// slip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb {
    /// Coefficient of friction f, -.
    pub coefficient: f64,
}

impl Law for Coulomb {
    fn coefficient(&self) -> f64 {
        self.coefficient
    }

    /// At m = 0 the law says no more than |q| <= f p; this is the least.
    fn shear(&self, Circumstances { pressure, .. }: Circumstances, slip: f64) -> Shear {
        match slip > 0.0 {
            true => Shear { shear: self.coefficient * pressure, by_slip: 0.0, by_pressure: self.coefficient },
            false => Shear { shear: 0.0, by_slip: f64::INFINITY, by_pressure: 0.0 },
        }
    }

    fn sharpness(&self, _dt: f64) -> f64 {
        0.0
    }

    fn sticks(&self, _at: Circumstances, slip: f64) -> bool {
        slip == 0.0
    }

    /// A projection: sticks where the reach is within f p.
    fn meet(&self, at: Circumstances, reach: f64, rho: f64) -> Met {
        let bound = self.coefficient * at.pressure;
        if reach <= bound {
            return Met { slip: 0.0, shear: Shear { shear: reach, ..self.shear(at, 0.0) } };
        }
        let slip = (reach - bound) / rho;
        Met { slip, shear: self.shear(at, slip) }
    }
}
