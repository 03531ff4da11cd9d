//! The update of an arm over one step.
//!
//! Arm i carries the elongation z_i of its spring, dz_i/dt + z_i/tau_i = du/dt. Over a step of length dt
//!
//! ```text
//! z+ = decay z + gain (u+ - u),    x = dt/tau_i
//! exponential:     decay = e^-x,         gain = phi(x) = (1 - e^-x)/x    exact for u linear over the step
//! backward Euler:  decay = gain = 1/(1 + x)
//! ```

/// The time integration of an arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Memory {
    /// Exact for a displacement that is linear over the step; second order in dt.
    Exponential,
    /// First order in dt.
    BackwardEuler,
}

/// The two numbers of z+ = decay z + gain (u+ - u).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Factors {
    /// What is left of the old elongation, in `[0, 1]`.
    pub decay: f64,
    /// What the new displacement adds, in `[0, 1]`.
    pub gain: f64,
}

impl Memory {
    /// The factors at x = dt/tau >= 0, to full precision at both ends.
    pub fn factors(self, x: f64) -> Factors {
        match self {
            Self::Exponential => Factors { decay: (-x).exp(), gain: if x == 0.0 { 1.0 } else { -(-x).exp_m1() / x } },
            Self::BackwardEuler => Factors { decay: 1.0 / (1.0 + x), gain: 1.0 / (1.0 + x) },
        }
    }
}
