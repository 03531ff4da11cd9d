//! The laws at a point.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use super::*;
use crate::expression::Expression;

const AT: Circumstances = Circumstances { pressure: 3.0, dt: 0.1, resolution: 0.0, slid: 0.0, temperature: 0.0 };

fn laws() -> [Box<dyn Law>; 3] {
    [
        Box::new(CoulombTanh { strength: Strength::constant(0.2), regularisation: 1e-6 }),
        Box::new(ElasticSlip { strength: Strength::constant(0.2), elastic_slip: 1e-7 }),
        Box::new(Coulomb { strength: Strength::constant(0.2) }),
    ]
}

/// |q| <= f p, does not fall, and is finite at any slip.
#[test]
fn bounded_by_coulomb_and_monotone() {
    for law in laws() {
        let mut last = 0.0;
        for slip in [0.0, 1e-300, 1e-9, 1e-7, 1e-3, 1.0, 1e9, f64::MAX] {
            let Shear { shear, by_slip, .. } = law.shear(AT, slip);
            assert!((last..=0.2 * 3.0).contains(&shear) && by_slip >= 0.0, "{law:?} {slip}");
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

/// Coefficients of rate, pressure and slid distance, with and without a limit.
fn of_formulas() -> Vec<Box<dyn Law>> {
    let strength = |formula: &str, limit| {
        let expression = Expression::parse(formula, &VARIABLES).unwrap();
        Strength::new(Coefficient::Formula(Arc::new(expression)), limit)
    };
    let all = |formula: &str, limit| -> [Box<dyn Law>; 3] {
        [
            Box::new(CoulombTanh { strength: strength(formula, limit), regularisation: 1e-6 }),
            Box::new(ElasticSlip { strength: strength(formula, limit), elastic_slip: 1e-7 }),
            Box::new(Coulomb { strength: strength(formula, limit) }),
        ]
    };
    let weakening = "0.1 + 0.2*exp(-v/3e-6) + 0.1*exp(-s/2e-7)";
    [all(weakening, None), all("0.3*(p/0.1)^-0.25 + 0.01*ln(1 + v/1e-7)", None), all(weakening, Some(0.7))]
        .into_iter()
        .flatten()
        .collect()
}

/// The derivatives of such laws against central differences, sticking and slipping, below and above the limit.
#[test]
fn derivatives_go_through_the_coefficient() {
    for law in of_formulas() {
        for slip in [4e-8, 7e-8, 2e-7, 5e-7] {
            let at =
                |dp: f64, dm: f64| law.shear(Circumstances { pressure: 3.0 + dp, slid: 1e-7, ..AT }, slip + dm).shear;
            let exact = law.shear(Circumstances { slid: 1e-7, ..AT }, slip);
            let by_pressure = (at(1e-4, 0.0) - at(-1e-4, 0.0)) / 2e-4;
            let by_slip = (at(0.0, 1e-12) - at(0.0, -1e-12)) / 2e-12;
            assert!((by_pressure - exact.by_pressure).abs() < 1e-8, "{law:?} {slip} {by_pressure}");
            assert!((by_slip - exact.by_slip).abs() < 1e-6 * 1e7, "{law:?} {slip} {by_slip} {exact:?}");
        }
    }
}

/// With a spring that rises twice as steeply as friction falls they meet at one point, to round-off; a law that lets nothing slip
/// sticks up to what it bears at no rate.
#[test]
fn a_law_that_weakens_meets_a_stiff_spring_once() {
    for law in of_formulas() {
        let at = Circumstances { slid: 1e-7, ..AT };
        let rho = (2.0 * law.strength().steepest_fall(at)).max(1.0);
        let mut last = -1.0;
        for i in 0..200 {
            let reach = 0.02 * f64::from(i);
            let Met { slip, shear } = law.meet(at, reach, rho);
            let left = shear.shear + rho * slip - reach;
            assert!(slip >= last && left.abs() <= 1e-14 * reach.max(1.0), "{law:?} {reach}: {slip:e} {left:e}");
            last = slip;
        }
        let still = law.bound(at, 0.0).value;
        let sticks = |reach: f64| law.meet(at, reach, rho).slip == 0.0;
        let exact = law.sharpness(AT.dt) == 0.0;
        assert!(!exact || sticks(still) && !sticks(still * (1.0 + 1e-12)), "{law:?}");
    }
}

/// Where it is negative or no number a formula says so; a constant never does.
#[test]
fn a_coefficient_that_is_none_is_told() {
    let formula = Expression::parse("0.1 - v", &VARIABLES).unwrap();
    let strength = Strength::new(Coefficient::Formula(Arc::new(formula)), None);
    let slipped = |length| Lasting { length, by_slip: 1.0 };
    assert_eq!(strength.fault(AT, slipped(0.005)), None);
    let fault = strength.fault(AT, slipped(0.05)).unwrap();
    assert!(fault.starts_with("friction.coefficient is -0.400000 at v = 5.000000e-1 m/s, p = 3.0"), "{fault}");
    assert_eq!(strength.at(AT, slipped(0.05)).value, 0.0);
    assert_eq!(Strength::constant(0.2).fault(AT, slipped(1.0)), None);
}
