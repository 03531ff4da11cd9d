//! A normalised Prony series: the relaxation of one modulus as a sum of decaying exponentials.

use std::collections::HashMap;

use nalgebra::Complex;

/// One Maxwell arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arm {
    /// Share of the instantaneous modulus, mu_i > 0.
    pub weight: f64,
    /// Relaxation time tau_i, s, > 0.
    pub time: f64,
}

/// The relaxation times of several series, each once, ascending, s.
pub fn common_times(series: &[&Prony]) -> Vec<f64> {
    let mut times: Vec<f64> = series.iter().flat_map(|series| &series.arms).map(|arm| arm.time).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// M(t)/M_inst = mu_0 + sum_i mu_i exp(-t/tau_i) with mu_0 = 1 - sum_i mu_i; Bonari and Paggi (2020), Eq. (8).
///
/// The paper's G-infinity is the *instantaneous* modulus M_inst = M(0); the long-term one is mu_0 M_inst.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Prony {
    /// The Maxwell arms; none = linear elastic.
    pub arms: Vec<Arm>,
}

impl Prony {
    /// mu_0 = 1 - sum mu_i, never below zero (weights that sum to 1 may exceed it by round-off).
    pub fn long_term(&self) -> f64 {
        (1.0 - self.arms.iter().map(|arm| arm.weight).sum::<f64>()).max(0.0)
    }

    /// The weights over a list of times that several series share: zero where this one has no arm. Arms of one time
    /// are added.
    pub fn weights_over(&self, times: &[f64]) -> Vec<f64> {
        let mut at: HashMap<u64, f64> = HashMap::new();
        for arm in &self.arms {
            *at.entry(arm.time.to_bits()).or_default() += arm.weight;
        }
        times.iter().map(|time| at.get(&time.to_bits()).copied().unwrap_or(0.0)).collect()
    }

    /// M(t)/M_inst at t >= 0 s.
    pub fn relaxation(&self, t: f64) -> f64 {
        self.long_term() + self.arms.iter().map(|arm| arm.weight * (-t / arm.time).exp()).sum::<f64>()
    }

    /// The integral of M/M_inst from 0 to t >= 0, s: mu_0 t + sum_i mu_i tau_i (1 - exp(-t/tau_i)).
    pub fn integral(&self, t: f64) -> f64 {
        self.long_term() * t - self.arms.iter().map(|arm| arm.weight * arm.time * (-t / arm.time).exp_m1()).sum::<f64>()
    }

    /// M*(w)/M_inst = mu_0 + sum mu_i i w tau_i / (1 + i w tau_i), w in rad/s; Eq. (10).
    pub fn complex_modulus(&self, w: f64) -> Complex<f64> {
        let arm = |arm: &Arm| {
            let x = w * arm.time;
            // x^2/(1+x^2) and x/(1+x^2) without overflow at large x.
            let loss = 1.0 / (x + 1.0 / x);
            if x == 0.0 { Complex::new(0.0, 0.0) } else { arm.weight * Complex::new(x * loss, loss) }
        };
        self.long_term() + self.arms.iter().map(arm).sum::<Complex<f64>>()
    }
}
