//! Laws of adhesion by themselves: what they integrate to, where they begin, how they answer.

use super::*;

const WORK: f64 = 0.05;
const RANGE: f64 = 2e-3;

fn laws() -> [Box<dyn Law>; 3] {
    [
        Box::new(Exponential { work: WORK, range: RANGE }),
        Box::new(Bilinear { work: WORK, range: RANGE }),
        Box::new(Dugdale { work: WORK, range: RANGE }),
    ]
}

/// The integral of sigma over all gaps is the work of adhesion, by the trapezoidal rule on 360,000 intervals, to 1e-8 of it; so is
/// `spent` on the way, and `by_gap` is the slope of sigma.
#[test]
fn what_is_spent_is_the_integral_of_the_pull() {
    for law in laws() {
        let count = 360_000;
        let step = law.reach() / f64::from(count);
        let mut sum = 0.0;
        for i in 0..count {
            let gap = f64::from(i) * step;
            let [here, next] = [gap, gap + step].map(|gap| law.at(gap));
            sum += 0.5 * step * (here.value + next.value);
            assert!((next.spent - sum).abs() < 2e-8 * WORK, "{law:?} at {gap}: {} for {sum}", next.spent);
            assert!(next.value <= here.value, "{law:?} rises at {gap}");
            let slope = (next.value - here.value) / step;
            // What round-off leaves of the difference.
            let none = 1e-9 * law.steepest_fall();
            let between = slope >= here.by_gap.min(next.by_gap) - none && slope <= here.by_gap.max(next.by_gap) + none;
            assert!(between && -slope <= law.steepest_fall() + none, "{law:?} at {gap}: {slope}");
        }
        assert!((sum - WORK).abs() < 2e-8 * WORK, "{law:?}: {sum}");
    }
}

/// sigma_0 is that of closed gaps: w/range, 2 w/range and w/range; the potential has the pressure as its slope across o = 0, with
/// 1/2 alpha o^2 of a penalty to 1e-7 of sigma_0.
#[test]
fn attraction_goes_on_into_repulsion() {
    let strengths = [WORK / RANGE, 2.0 * WORK / RANGE, WORK / RANGE];
    for (law, strength) in laws().iter().zip(strengths) {
        assert_eq!(law.strength(), strength);
        assert_eq!(law.at(0.0).value, strength);
        let alpha = 3.0 * law.steepest_fall();
        let energy = |o: f64| law.potential(o) + 0.5 * alpha * o.max(0.0).powi(2);
        for o in [-1.1 * RANGE, -0.5 * RANGE, -1e-3 * RANGE, 1e-3 * RANGE, RANGE] {
            let e = 1e-6 * RANGE;
            let p = (energy(o + e) - energy(o - e)) / (2.0 * e);
            let told = if o < 0.0 { -law.at(-o).value } else { alpha * o - strength };
            assert!((p - told).abs() < 1e-7 * strength, "{law:?} at {o}: {p} for {told}");
        }
    }
}

/// Of each s there is one answer, on the line p + rho o = s and on the law's curve, both to 1e-12; it moves without jumps, and theta
/// is its slope, with 1 - theta beside it.
#[test]
fn each_trial_has_one_answer_on_the_curve() {
    for law in laws() {
        for (penalty, over) in [(None, 2.0), (None, 1.1), (Some(4.0), 2.0), (Some(1e6), 30.0)] {
            let rho = over * law.steepest_fall();
            let penalty = penalty.map(|share: f64| share * law.steepest_fall());
            let size = law.strength() + rho * law.reach();
            let mut before: Option<Met> = None;
            let step = 1e-4 * size;
            for i in -12_000..4000 {
                let s = f64::from(i) * step;
                let met = meet(law.as_ref(), penalty, s, rho);
                assert!((met.pressure + rho * met.overlap - s).abs() < 1e-12 * size, "{law:?} {penalty:?} {s}");
                let told = match (met.overlap, penalty) {
                    (o, _) if o < 0.0 => -law.at(-o).value,
                    (o, Some(alpha)) => alpha * o - law.strength(),
                    (_, None) => met.pressure.max(-law.strength()),
                };
                assert!((met.pressure - told).abs() < 1e-12 * size, "{law:?} {penalty:?} {s}");
                assert!((met.stiff + met.soft - 1.0).abs() < 1e-12 * met.soft.max(1.0));
                if let Some(before) = before.replace(met) {
                    let rise = (met.pressure - before.pressure) / step;
                    let [least, most] = [met.stiff.min(before.stiff), met.stiff.max(before.stiff)];
                    let within = |value: f64| value > least - 1e-2 && value < most + 1e-2;
                    assert!(within(rise), "{law:?} {penalty:?} at {s}: {rise} {least} {most}");
                    assert!(met.overlap >= before.overlap - 1e-15, "{law:?} {penalty:?} at {s}");
                }
            }
        }
    }
}
