//! A point that is pulled across its gap, by [`crate::adhesion`], and what holds it back while a jump is followed.
//!
//! Where attraction falls faster with the gap than the body is stiff, the face has several states, and no way from one to the other but a
//! jump. It goes downhill: o' eta = what is left of the laws, and an implicit step of that, from o_k over a time eta/kappa, is a law
//!
//! ```text
//! p = p(o) + kappa (o - o_k)
//! ```
//!
//! which for kappa above the steepest fall of attraction rises everywhere: such a face has one state. o_k is then that, and so forth
//! (the proximal point method: each step lowers the energy of body, attraction and indenter). At rest nothing is held back.
//!
//! With p~ = p(o*) of [`adhesion::meet`] at s + kappa o_k and rho + kappa,
//!
//! ```text
//! p* = p~ + kappa (o* - o_k),    1 - theta = (1 - theta~) rho/(rho + kappa)
//! ```

use nalgebra::SVector;

use super::{Answer, Laws, Site};
use crate::adhesion::{self, Met};
use crate::friction::{Bound, Circumstances, Law, Rebound};

/// What holds the overlap of a point back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping {
    /// kappa, Pa/m.
    pub stiffness: f64,
    /// o_k, m.
    pub overlap: f64,
}

impl<const D: usize> Site<D> {
    /// What the laws make of p + rho_n o = `trial` at a point that adheres; `answer` is that of no contact.
    pub(super) fn adhere(
        &self,
        (law, trial, overlap): (&dyn adhesion::Law, f64, f64),
        (pressure, shear, slip): (f64, SVector<f64, D>, SVector<f64, D>),
        laws: Laws<'_>,
        answer: &mut Answer<D>,
    ) {
        let rho = self.moduli.normal;
        let Damping { stiffness, overlap: held } = self.damping.unwrap_or(Damping { stiffness: 0.0, overlap });
        let met = adhesion::meet(law, laws.penalty, trial + stiffness * held, rho + stiffness);
        if self.damping.is_none() && -met.overlap >= law.reach() {
            return;
        }
        answer.active = true;
        answer.gap = (-met.overlap).max(0.0);
        let Met { pressure: borne, overlap, stiff, soft } = met;
        answer.pressure = borne + stiffness * (overlap - held);
        answer.soft = soft * (rho / (rho + stiffness));
        answer.stiff = stiff + soft * (stiffness / (rho + stiffness));
        let Some(friction) = laws.friction.filter(|friction| bears(*friction, borne)) else {
            answer.excess = shear - self.normal * (pressure - answer.pressure);
            return;
        };
        let at = self.circumstances(borne.max(0.0), laws);
        let pulls = answer.gap > 0.0;
        answer.shear = match pulls {
            true => self.meet(&across(friction, borne, law.strength()), at, (shear, slip), answer),
            false => self.meet(friction, at, (shear, slip), answer),
        };
        // Friction knows the law's pressure.
        answer.drag *= match self.damping {
            _ if borne < 0.0 && !pulls => 0.0,
            None => 1.0,
            Some(_) if answer.stiff == 0.0 => 0.0,
            Some(_) => stiff / answer.stiff,
        };
        answer.excess = (shear - answer.shear) - self.normal * (pressure - answer.pressure);
    }
}

/// Whether friction bears anything under a pressure: where it pulls, by the bond alone.
pub(super) fn bears(friction: &dyn Law, pressure: f64) -> bool {
    pressure > 0.0 || friction.strength().bond() > 0.0
}

/// What a bond bears across a gap under a pull `borne` < 0, Pa, of a law whose strength is sigma_0, Pa: what a closed gap bears times
/// sigma/sigma_0, so that a gap opens without a jump of the shear.
fn across(friction: &dyn Law, borne: f64, strength: f64) -> impl Law {
    let bound = move |at: Circumstances, slip: f64| {
        let Bound { value, .. } = friction.bound(at, slip);
        Bound { value: value * (-borne / strength), by_slip: 0.0, by_pressure: -value / strength }
    };
    Rebound { law: friction, bound }
}
