//! Friction laws: pressure and slip in, shear traction and its derivatives out, all of them scalars.
//!
//! A point slips by a vector s over a step: what it slips in the step, and before that what the law still holds elastically.
//! With m = |s| >= 0 a law gives |q|(m, p), which does not fall with m; the traction is q = |q| s/m, whatever the dimension. A
//! new law is a file with an `impl Law`.

mod coulomb;
mod coulomb_tanh;
mod elastic_slip;

pub use coulomb::Coulomb;
pub use coulomb_tanh::CoulombTanh;
pub use elastic_slip::ElasticSlip;

/// What a point answers in: its pressure and its step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circumstances {
    /// p >= 0, Pa.
    pub pressure: f64,
    /// The length of the step, s.
    pub dt: f64,
    /// Slips, m, that are too short to tell apart; 0 where the slip is known to all its digits.
    pub resolution: f64,
}

/// The shear traction and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shear {
    /// |q|, Pa.
    pub shear: f64,
    /// d|q|/dm at constant pressure, Pa/m, at least 0; infinite where the law lets nothing slip.
    pub by_slip: f64,
    /// d|q|/dp at constant slip.
    pub by_pressure: f64,
}

/// Where a law and a spring that pulls at the point come to rest: see [`Law::meet`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Met {
    /// m, m
    pub slip: f64,
    /// There.
    pub shear: Shear,
}

/// A friction law.
pub trait Law: std::fmt::Debug + Send + Sync {
    /// The coefficient of friction f, -: |q| <= f p.
    fn coefficient(&self) -> f64;

    /// |q| of a point that slips by `slip` = m >= 0, m.
    fn shear(&self, at: Circumstances, slip: f64) -> Shear;

    /// The m >= 0, m, over which |q| comes near f p: what a step has to tell apart.
    fn sharpness(&self, dt: f64) -> f64;

    /// Whether a point that slips by `slip` sticks.
    fn sticks(&self, at: Circumstances, slip: f64) -> bool;

    /// Whether part of the slip is elastic: it is stored instead of dissipated, and what the next step begins with.
    fn holds(&self) -> bool {
        false
    }

    /// How much of the slip m is elastic, m.
    fn elastic(&self, _slip: f64) -> f64 {
        0.0
    }

    /// The m >= 0 where |q|(m) + rho m = `reach` (Pa), for rho > 0, Pa/m: the only one, because |q| does not fall.
    ///
    /// By Newton's method from below, which does not overshoot where |q| is concave, kept between bounds.
    fn meet(&self, at: Circumstances, reach: f64, rho: f64) -> Met {
        const MOST: usize = 100;
        let bound = self.coefficient() * at.pressure;
        let steepest = self.shear(at, 0.0).by_slip;
        let mut slip = ((reach - bound) / rho).max(reach / (steepest + rho));
        let mut shear = self.shear(at, slip);
        for _ in 0..MOST {
            let more = (reach - shear.shear - rho * slip) / (shear.by_slip + rho);
            let next = (slip + more).max(0.0).min(reach / rho);
            // Newton's steps are upward until round-off turns them; a number that is none ends it, too.
            if next.partial_cmp(&slip) != Some(std::cmp::Ordering::Greater) {
                break;
            }
            slip = next;
            shear = self.shear(at, slip);
        }
        Met { slip, shear: Shear { shear: met(reach, bound, rho * slip, shear.shear), ..shear } }
    }
}

/// |q| to all digits: of reach - rho m none are left where the point slips, and of the law's own where it sticks.
fn met(reach: f64, bound: f64, spring: f64, law: f64) -> f64 {
    if reach > bound { law } else { (reach - spring).max(0.0).min(bound) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: Circumstances = Circumstances { pressure: 3.0, dt: 0.1, resolution: 0.0 };

    fn laws() -> [Box<dyn Law>; 3] {
        [
            Box::new(CoulombTanh { coefficient: 0.2, regularisation: 1e-6 }),
            Box::new(ElasticSlip { coefficient: 0.2, elastic_slip: 1e-7 }),
            Box::new(Coulomb { coefficient: 0.2 }),
        ]
    }

    /// |q| <= f p, does not fall, and is finite at any slip.
    #[test]
    fn bounded_by_coulomb_and_monotone() {
        for law in laws() {
            let mut last = 0.0;
            for slip in [0.0, 1e-300, 1e-9, 1e-7, 1e-3, 1.0, 1e9, f64::MAX] {
                let Shear { shear, by_slip, .. } = law.shear(AT, slip);
                assert!((last..=law.coefficient() * 3.0).contains(&shear) && by_slip >= 0.0, "{law:?} {slip}");
                last = shear;
            }
        }
    }

    /// The derivatives against central differences, sticking and slipping.
    #[test]
    fn derivatives_are_those_of_the_traction() {
        for law in laws() {
            for slip in [4e-8, 7e-8, 2e-7, 5e-7] {
                let at = |dp: f64, dm: f64| law.shear(Circumstances { pressure: 3.0 + dp, ..AT }, slip + dm).shear;
                let exact = law.shear(AT, slip);
                let by_pressure = (at(1e-3, 0.0) - at(-1e-3, 0.0)) / 2e-3;
                let by_slip = (at(0.0, 1e-12) - at(0.0, -1e-12)) / 2e-12;
                assert!((by_pressure - exact.by_pressure).abs() < 1e-9, "{law:?} {slip}");
                assert!((by_slip - exact.by_slip).abs() < 1e-3 * 6e6, "{law:?} {slip} {by_slip}");
            }
        }
    }

    /// Where law and spring meet: |q|(m) + rho m = S to round-off, for springs and pulls of any size.
    #[test]
    fn law_and_spring_meet() {
        for law in laws() {
            for rho in [1e-6, 1.0, 1e6, 1e12] {
                for reach in [0.0, 1e-12, 1e-3, 0.3, 0.6 - 1e-9, 0.6 + 1e-9, 2.0, 1e9] {
                    let Met { slip, shear } = law.meet(AT, reach, rho);
                    let left = shear.shear + rho * slip - reach;
                    assert!(slip >= 0.0 && left.abs() <= 4e-15 * reach, "{law:?} {rho:e} {reach:e}: {left:e}");
                    let again = law.shear(AT, slip).shear;
                    let digits = 1e-14 * reach / rho * law.shear(AT, slip).by_slip;
                    let exact = slip == 0.0 && law.shear(AT, 0.0).by_slip.is_infinite();
                    assert!(
                        exact || (again - shear.shear).abs() <= 1e-14 * reach.max(0.6) + digits,
                        "{law:?} {rho:e} {reach:e}"
                    );
                }
            }
        }
    }
}
