//! Relaxation and creep of a Prony solid in closed form.
//!
//! One modulus M (shear, or Young at a constant Poisson ratio): a strain history e(t), at rest before t = 0, gives
//! the stress M * de, with M(t) = M_inst [mu_0 + sum mu_i exp(-t/tau_i)] and mu_0 = 1 - sum mu_i.

use super::solid::Solid;
use crate::error::{Error, Result};

/// A relaxing modulus.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxing {
    /// M_inst, Pa.
    pub instantaneous: f64,
    /// (weight mu_i > 0, relaxation time tau_i > 0 in s); at most one arm per time.
    pub arms: Vec<(f64, f64)>,
}

/// The strain under a constant unit stress, J(t) = J_inf - sum J_j exp(-t/rho_j), 1/Pa.
#[derive(Debug, Clone, PartialEq)]
pub struct Creep {
    /// J_inf = 1/(mu_0 M_inst), 1/Pa.
    pub long_term: f64,
    /// (J_j in 1/Pa, retardation time rho_j in s), the longest first.
    pub modes: Vec<(f64, f64)>,
}

impl Creep {
    /// J(t), 1/Pa, t >= 0.
    pub fn at(&self, t: f64) -> f64 {
        self.long_term - self.modes.iter().map(|(weight, time)| weight * (-t / time).exp()).sum::<f64>()
    }
}

impl From<&Solid> for Relaxing {
    /// The shear modulus of a solid.
    fn from(solid: &Solid) -> Self {
        Self { instantaneous: solid.shear, arms: solid.arms.clone() }
    }
}

impl Relaxing {
    /// mu_0 = 1 - sum mu_i.
    pub fn long_term(&self) -> f64 {
        1.0 - self.arms.iter().map(|&(weight, _)| weight).sum::<f64>()
    }

    /// M(t), Pa: the stress at t >= 0 after a unit step of strain.
    pub fn step_strain(&self, t: f64) -> f64 {
        let arms = self.arms.iter().map(|(weight, time)| weight * (-t / time).exp());
        self.instantaneous * (self.long_term() + arms.sum::<f64>())
    }

    /// The stress (Pa s) at t under a strain that grows at unit rate from t = 0:
    /// M_inst [mu_0 t + sum mu_i tau_i (1 - exp(-t/tau_i))]; 0 before.
    pub fn ramp_strain(&self, t: f64) -> f64 {
        let t = t.max(0.0);
        let arms = self.arms.iter().map(|(weight, time)| -weight * time * (-t / time).exp_m1());
        self.instantaneous * (self.long_term() * t + arms.sum::<f64>())
    }

    /// The stress (Pa) at t under a strain that grows at `rate` (1/s) for `duration` (s) and is then held.
    pub fn ramp_and_hold(&self, rate: f64, duration: f64, t: f64) -> f64 {
        rate * (self.ramp_strain(t) - self.ramp_strain(t - duration))
    }

    /// The energies (J/m^3) at t under the same strain: in the springs, M_inst/2 [mu_0 e^2 + sum mu_i z_i^2], and lost in the
    /// dashpots since t = 0, M_inst sum mu_i/tau_i times the integral of z_i^2. The spring of an arm is elongated by
    /// z = rate tau (1 - exp(-t/tau)) while the strain grows, and by exp(-(t - duration)/tau) of what it was then on.
    pub fn ramp_and_hold_energy(&self, rate: f64, duration: f64, t: f64) -> [f64; 2] {
        let (grown, held) = (t.clamp(0.0, duration), (t - duration).max(0.0));
        let mut stored = self.long_term() * (rate * grown).powi(2);
        let mut lost = 0.0;
        for &(weight, time) in &self.arms {
            let end = -rate * time * (-grown / time).exp_m1();
            let growing = grown + 2.0 * time * (-grown / time).exp_m1() - 0.5 * time * (-2.0 * grown / time).exp_m1();
            stored += weight * (end * (-held / time).exp()).powi(2);
            lost += weight * (rate * rate * time * growing - 0.5 * end * end * (-2.0 * held / time).exp_m1());
        }
        [0.5 * self.instantaneous * stored, self.instantaneous * lost]
    }

    /// The creep compliance.
    ///
    /// With S(s) = s M(s) = M_inst [mu_0 + sum mu_i s tau_i/(1 + s tau_i)], J(s) = 1/(s S(s)): the retardation times
    /// are -1/s_j at the roots of S, one in each interval between neighbouring poles -1/tau_i and one between the
    /// last pole and 0, and J_j = 1/(M_inst |s_j| sum mu_i tau_i/(1 + s_j tau_i)^2). One arm: rho = tau/mu_0,
    /// J = (1/M_inst)[1/mu_0 - (1/mu_0 - 1) exp(-t mu_0/tau)].
    ///
    /// An error if mu_0 <= 0 (it flows) or two arms share their time.
    pub fn creep(&self) -> Result<Creep> {
        let rest = self.long_term();
        if rest <= 0.0 {
            return Err(Error::Domain("without a long-term modulus the creep has no bound".into()));
        }
        let mut arms = self.arms.clone();
        arms.sort_by(|a, b| b.1.total_cmp(&a.1));
        if arms.windows(2).any(|pair| pair[0].1 == pair[1].1) {
            return Err(Error::Domain("two arms have the same relaxation time: add their weights".into()));
        }
        // Rates r = -s: S falls from mu_0 at r = 0 to -infinity at 1/tau_1, and from +infinity to -infinity between
        // two poles.
        let stiffness =
            |r: f64| rest + arms.iter().map(|(weight, time)| -weight * r * time / (1.0 - r * time)).sum::<f64>();
        let mut below = 0.0;
        let modes = arms.iter().map(|&(_, time)| {
            let rate = falling_root(stiffness, below, 1.0 / time);
            below = 1.0 / time;
            let steepness: f64 = arms.iter().map(|(weight, time)| weight * time / (1.0 - rate * time).powi(2)).sum();
            (1.0 / (self.instantaneous * rate * steepness), 1.0 / rate)
        });
        let modes = modes.collect();
        Ok(Creep { long_term: 1.0 / (rest * self.instantaneous), modes })
    }
}

/// The root of a falling function in the open interval (low, high), by bisection to neighbouring numbers.
fn falling_root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod tests {
    use super::*;

    fn solid(arms: &[(f64, f64)]) -> Relaxing {
        Relaxing { instantaneous: 7.0, arms: arms.to_vec() }
    }

    #[test]
    fn one_arm_creep() {
        let creep = solid(&[(0.6, 2.0)]).creep().unwrap();
        for t in [0.0f64, 0.3, 5.0, 100.0] {
            let exact = (1.0 / 0.4 - (1.0 / 0.4 - 1.0) * (-t * 0.4 / 2.0).exp()) / 7.0;
            assert!((creep.at(t) / exact - 1.0).abs() < 1e-13);
        }
    }

    /// What is stored and lost at the end of a ramp is the work of the stress, by Simpson's rule; the hold does none.
    #[test]
    fn the_energy_of_a_ramp_is_its_work() {
        let (material, rate, duration) = (solid(&[(0.2, 0.1), (0.3, 5.0), (0.25, 0.7)]), 0.3, 2.0);
        let pieces = 1000;
        let stress = |i: usize| material.ramp_and_hold(rate, duration, duration * i as f64 / pieces as f64);
        let weight = |i: usize| if i == 0 || i == pieces { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
        let sum: f64 = (0..=pieces).map(|i| weight(i) * stress(i)).sum();
        let work = sum * rate * duration / (3.0 * pieces as f64);
        for t in [duration, duration + 0.4, duration + 50.0] {
            let [stored, lost] = material.ramp_and_hold_energy(rate, duration, t);
            assert!(((stored + lost) / work - 1.0).abs() < 1e-9, "{stored} {lost} {work}");
        }
        let relaxed = 0.5 * 7.0 * 0.25 * (rate * duration).powi(2);
        assert!((material.ramp_and_hold_energy(rate, duration, 500.0)[0] / relaxed - 1.0).abs() < 1e-12);
    }

    /// Relaxation and creep undo each other: the convolution integral of M(t - s) dJ(s) + M(t) J(0) is 1 at every t.
    #[test]
    fn creep_inverts_relaxation() {
        for arms in [vec![], vec![(0.2, 0.01), (0.3, 5.0), (0.25, 0.7)]] {
            let material = solid(&arms);
            let creep = material.creep().unwrap();
            assert!((creep.at(0.0) * 7.0 - 1.0).abs() < 1e-13);
            assert_eq!(creep.modes.len(), arms.len());
            let convolved = |t: f64| {
                // dJ = J_j/rho_j e^{-s/rho_j} ds, each product of exponentials integrated exactly.
                let product = |rho: f64, tau: f64| {
                    let rate = 1.0 / rho - 1.0 / tau;
                    ((-t / tau).exp() - (-t / rho).exp()) / rate
                };
                let mode = |&(j, rho): &(f64, f64)| {
                    let rest = material.long_term() * -(-t / rho).exp_m1() * rho;
                    let arms: f64 = arms.iter().map(|&(weight, tau)| weight * product(rho, tau)).sum();
                    7.0 * j / rho * (rest + arms)
                };
                material.step_strain(t) * creep.at(0.0) + creep.modes.iter().map(mode).sum::<f64>()
            };
            for t in [0.0, 0.005, 0.4, 3.0, 50.0] {
                assert!((convolved(t) - 1.0).abs() < 1e-12, "{t}: {}", convolved(t));
            }
        }
    }

    #[test]
    fn ramps() {
        let material = solid(&[(0.2, 0.01), (0.3, 5.0)]);
        let (t, e) = (1.7, 1e-5);
        let rate = (material.ramp_strain(t + e) - material.ramp_strain(t - e)) / (2.0 * e);
        assert!((rate / material.step_strain(t) - 1.0).abs() < 1e-8);
        assert_eq!(material.ramp_strain(-1.0), 0.0);
        // A ramp of no duration is a step.
        assert!((material.ramp_and_hold(1e6, 1e-6, t) / material.step_strain(t) - 1.0).abs() < 1e-6);
        assert!((material.ramp_and_hold(2.0, 3.0, 1e3) / (2.0 * 3.0 * 7.0 * 0.5) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn refuses_what_has_no_answer() {
        assert!(solid(&[(1.0, 2.0)]).creep().is_err());
        assert!(solid(&[(0.1, 2.0), (0.2, 2.0)]).creep().is_err());
    }
}
