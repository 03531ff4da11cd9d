//! What tractions and stresses are divided by.

use super::Run;
use crate::plot::numbers::short;
use crate::scene::Friction;

/// A modulus, or 1 Pa.
pub struct Unit {
    /// Pa
    pub value: f64,
    /// Its symbol; empty for 1 Pa.
    symbol: &'static str,
    /// What it is.
    note: String,
}

impl Unit {
    /// E_f,0 of the power law that the material stands for; else its instantaneous Young's modulus; with several
    /// materials no modulus is that of the body.
    pub fn of(run: &Run) -> Self {
        match (run.law, run.scene.materials.as_slice()) {
            (Some(law), _) => {
                let note = format!("E_{{f,0}} = {} Pa, of the power law", short(law.modulus, 5));
                Self { value: law.modulus, symbol: "E_{f,0}", note }
            }
            (None, [material]) => {
                let value = 2.0 * material.shear_modulus * (1.0 + material.poisson_ratio);
                let note = format!("E(0) = {} Pa, instantaneous Young's modulus", short(value, 5));
                Self { value, symbol: "E(0)", note }
            }
            _ => Self { value: 1.0, symbol: "", note: String::new() },
        }
    }

    /// The label of a quantity in this unit: `p/E_{f,0}`, or `p, Pa`.
    pub fn over(&self, quantity: &str) -> String {
        if self.symbol.is_empty() { format!("{quantity}, Pa") } else { format!("{quantity}/{}", self.symbol) }
    }

    /// The label of a traction over the coefficient of friction too.
    pub fn over_friction(&self, quantity: &str) -> String {
        let symbol = self.symbol;
        if symbol.is_empty() { format!("{quantity}/f, Pa") } else { format!("{quantity}/(f {symbol})") }
    }

    /// What the symbols of a figure are: the modulus, the coefficient of friction, the velocity of sliding.
    pub fn note(&self, run: &Run) -> String {
        let friction =
            run.scene.friction.as_ref().and_then(Friction::coefficient).map(|f| format!("f = {}", short(f, 4)));
        let velocity = run.velocity().map(|v| format!("v = {} m/s", short(v, 4)));
        let parts = [self.note.clone()].into_iter().chain(friction).chain(velocity);
        parts.filter(|part| !part.is_empty()).collect::<Vec<_>>().join("; ")
    }
}
