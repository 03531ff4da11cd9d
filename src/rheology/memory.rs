//! The update of an arm over one step.
//!
//! Arm i carries the elongation z_i of its spring, dz_i/dt + z_i/tau_i = du/dt. Over a step of length dt
//!
//! ```text
//! z+ = decay z + gain (u+ - u),    x = dt/tau_i
//! exponential:     decay = e^-x,         gain = phi(x) = (1 - e^-x)/x    exact for u linear over the step
//! backward Euler:  decay = gain = 1/(1 + x)
//! ```
//!
//! Its dashpot moves at z/tau_i and dissipates |z|^2/tau_i, in units of the arm's stiffness; over the step
//!
//! ```text
//! a |z|^2 + 2 b z.du + c |du|^2,    du = u+ - u
//! exponential:     a = x phi(2x),   b = x phi(x)^2 / 2,   c = (x - 2 (1 - e^-x) + (1 - e^-2x)/2) / x^2
//! backward Euler:  a = b = c = x/(1 + x)^2,  that is x |z+|^2
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

/// What the dashpot dissipates over a step: held |z|^2 + 2 mixed z.du + fresh |du|^2, never below zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Losses {
    /// a
    pub held: f64,
    /// b
    pub mixed: f64,
    /// c
    pub fresh: f64,
}

impl Memory {
    /// The factors at x = dt/tau >= 0, to full precision at both ends.
    pub fn factors(self, x: f64) -> Factors {
        match self {
            Self::Exponential => Factors { decay: (-x).exp(), gain: if x == 0.0 { 1.0 } else { -(-x).exp_m1() / x } },
            Self::BackwardEuler => Factors { decay: 1.0 / (1.0 + x), gain: 1.0 / (1.0 + x) },
        }
    }

    /// The losses at x = dt/tau >= 0, to full precision at both ends.
    pub fn losses(self, x: f64) -> Losses {
        let gain = self.factors(x).gain;
        match self {
            Self::BackwardEuler => {
                let all = x * gain * gain;
                Losses { held: all, mixed: all, fresh: all }
            }
            Self::Exponential => {
                Losses { held: -0.5 * (-2.0 * x).exp_m1(), mixed: 0.5 * x * gain * gain, fresh: fresh_loss(x) }
            }
        }
    }
}

/// (x - 2 (1 - e^-x) + (1 - e^-2x)/2) / x^2 = x/3 - x^2/4 + ...
fn fresh_loss(x: f64) -> f64 {
    if x > 0.5 {
        return (x + 2.0 * (-x).exp_m1() - 0.5 * (-2.0 * x).exp_m1()) / x / x;
    }
    // The closed form cancels; of its power series, sum over n >= 3 of (2^(n-1) - 2) (-1)^(n+1) x^(n-2) / n!, 20 terms are
    // below round-off.
    let (mut sum, mut power, mut doubled) = (0.0, x / 6.0, 4.0);
    for n in 3..23 {
        sum += power * (doubled - 2.0);
        power *= -x / f64::from(n + 1);
        doubled *= 2.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The losses of the exponential update against the midpoint rule on |z(t)|^2/tau for u linear over the step, from
    /// short to long steps and across the change of formula; and both ends.
    #[test]
    fn losses_are_the_integral_over_the_step() {
        for x in [1e-3, 0.1, 0.499, 0.501, 2.0, 30.0_f64] {
            let losses = Memory::Exponential.losses(x);
            let count = 200_000;
            let (mut held, mut mixed, mut fresh) = (0.0, 0.0, 0.0);
            for i in 0..count {
                let y = x * (f64::from(i) + 0.5) / f64::from(count);
                let (old, new) = ((-y).exp(), -(-y).exp_m1() / x);
                held += old * old * x / f64::from(count);
                mixed += old * new * x / f64::from(count);
                fresh += new * new * x / f64::from(count);
            }
            for (computed, exact) in [(losses.held, held), (losses.mixed, mixed), (losses.fresh, fresh)] {
                assert!((computed / exact - 1.0).abs() < 1e-8, "{x}: {computed} {exact}");
            }
        }
        for rule in [Memory::Exponential, Memory::BackwardEuler] {
            let Losses { held, mixed, fresh } = rule.losses(0.0);
            assert_eq!((held, mixed, fresh), (0.0, 0.0, 0.0));
            for x in [1e-300, 1e-14, 1e-7, 0.5, 1e7, 1e14, 1e300] {
                let Losses { held, mixed, fresh } = rule.losses(x);
                assert!(held >= 0.0 && fresh >= 0.0 && held * fresh >= mixed * mixed * (1.0 - 1e-12), "{rule:?} {x}");
            }
        }
        let short = Memory::Exponential.losses(1e-9);
        assert!((short.fresh / (1e-9 / 3.0) - 1.0).abs() < 1e-8 && (short.mixed / 0.5e-9 - 1.0).abs() < 1e-8);
    }
}
