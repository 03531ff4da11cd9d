//! The laws of linear viscoelasticity against closed forms.
//!
//! ```text
//! M(t)  = M_inst [mu_0 + sum mu_i exp(-t/tau_i)]                       Eq. (8)
//! M*(w) = M_inst [mu_0 + sum mu_i i w tau_i/(1 + i w tau_i)]           Eq. (10)
//! s(t)  = integral from 0 to t of M(t - r) de(r)                       Boltzmann
//! ```
#![allow(clippy::unwrap_used)]

use mpjr::rheology::prony::common_times;
use mpjr::rheology::{Arm, Band, Fractional, Loading, Memory, Poisson, Prony, Ramp, Shift};
use nalgebra::Complex;

/// Table 1, three arms.
fn eva() -> Prony {
    Prony { arms: [(0.309, 0.102), (0.226, 0.545), (0.210, 4.104)].map(|(weight, time)| Arm { weight, time }).to_vec() }
}

fn close(computed: f64, exact: f64, tolerance: f64) {
    assert!((computed - exact).abs() <= tolerance * exact.abs().max(1e-300), "{computed} is not {exact}");
}

/// Five-point Gauss-Legendre over each of `panels` equal panels.
fn integral(f: impl Fn(f64) -> Complex<f64>, from: f64, to: f64, panels: usize) -> Complex<f64> {
    let points = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683, 0.478_628_670_499_366_5),
        (-0.538_469_310_105_683, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let half = (to - from) / (2 * panels) as f64;
    let panel = |i: usize| {
        let middle = from + (2 * i + 1) as f64 * half;
        points.iter().map(|(x, w)| f(middle + x * half) * *w).sum::<Complex<f64>>() * half
    };
    (0..panels).map(panel).sum()
}

/// M*(w) = i w integral of M(t) exp(-i w t) dt = mu_0 + i w integral of (M(t) - mu_0) exp(-i w t) dt, the second of
/// which converges.
#[test]
fn complex_modulus_is_the_fourier_transform_of_the_relaxation() {
    let prony = eva();
    for w in [1e-3, 0.1, 1.0, 7.3, 100.0] {
        let i_w = Complex::new(0.0, w);
        let transform = |t: f64| (prony.relaxation(t) - prony.long_term()) * (-i_w * t).exp();
        // Panels that resolve the fastest arm and the oscillation, to where the slowest arm is spent.
        let end = 40.0 * 4.104;
        let panels = (end * (w + 10.0)).ceil() as usize;
        let numerical = prony.long_term() + i_w * integral(transform, 0.0, end, panels);
        let exact = prony.complex_modulus(w);
        close(numerical.re, exact.re, 1e-12);
        close(numerical.im, exact.im, 1e-12);
    }
}

#[test]
fn complex_modulus_goes_from_long_term_to_instantaneous() {
    let prony = eva();
    close(prony.complex_modulus(0.0).re, prony.long_term(), 1e-15);
    close(prony.complex_modulus(1e-12).re, prony.long_term(), 1e-15);
    close(prony.complex_modulus(1e300).re, 1.0, 1e-15);
    assert_eq!(prony.complex_modulus(0.0).im, 0.0);
    assert!(prony.complex_modulus(1e300).im < 1e-200);
}

/// Times from 1e-12 s to 1e12 s in one series of fifty arms, weights down to 1e-12.
fn extreme() -> Prony {
    let times = Band::new(1e-12, 1e12).unwrap().samples(50);
    let weight = |i: usize| if i.is_multiple_of(3) { 1e-12 } else { 0.029 };
    Prony { arms: times.iter().enumerate().map(|(i, &time)| Arm { weight: weight(i), time }).collect() }
}

#[test]
fn fifty_arms_over_twenty_four_decades_relax_monotonically() {
    let prony = extreme();
    assert_eq!(prony.relaxation(0.0), prony.long_term() + prony.arms.iter().map(|arm| arm.weight).sum::<f64>());
    let mut last = f64::INFINITY;
    for t in Band::new(1e-26, 1e26).unwrap().samples(20_000) {
        let now = prony.relaxation(t);
        // Fifty sums of numbers below one carry a round-off of some 1e-15.
        assert!(now <= last + 1e-15 && now >= prony.long_term(), "{now} after {last} at {t} s");
        last = now;
    }
    close(last, prony.long_term(), 1e-14);
    let mut storage = 0.0;
    for w in Band::new(1e-26, 1e26).unwrap().samples(20_000) {
        let modulus = prony.complex_modulus(w);
        assert!(modulus.re >= storage - 1e-15 && modulus.im > 0.0 && modulus.re.is_finite() && modulus.im.is_finite());
        storage = modulus.re;
    }
    close(storage, 1.0, 1e-14);
}

#[test]
fn factors_hold_from_1e_minus_14_to_1e14() {
    for x in Band::new(1e-14, 1e14).unwrap().samples(2801).into_iter().chain([0.0]) {
        for memory in [Memory::Exponential, Memory::BackwardEuler] {
            let factors = memory.factors(x);
            assert!((0.0..=1.0).contains(&factors.decay) && (0.0..=1.0).contains(&factors.gain), "{x}: {factors:?}");
            // Both ends to full precision: phi(x) = 1 - x/2 + x^2/6 - ... and 1/x.
            let gain = match memory {
                Memory::Exponential if x < 1e-4 => 1.0 - x / 2.0 + x * x / 6.0,
                Memory::Exponential if x > 40.0 => 1.0 / x,
                Memory::Exponential => (1.0 - (-x).exp()) / x,
                Memory::BackwardEuler => 1.0 / (1.0 + x),
            };
            close(factors.gain, gain, 1e-11);
        }
    }
    close(Memory::Exponential.factors(1e-14).gain, 1.0 - 0.5e-14, 1e-16);
    close(Memory::Exponential.factors(1e14).gain, 1e-14, 1e-16);
}

/// Stress of the series under a strain history u(t) sampled at `steps` equal steps up to `end`, by the arm update.
fn stress(prony: &Prony, memory: Memory, u: impl Fn(f64) -> f64, end: f64, steps: usize) -> f64 {
    let dt = end / steps as f64;
    let mut z = vec![u(0.0); prony.arms.len()];
    for n in 0..steps {
        let increment = u((n + 1) as f64 * dt) - u(n as f64 * dt);
        for (z, arm) in z.iter_mut().zip(&prony.arms) {
            let factors = memory.factors(dt / arm.time);
            *z = factors.decay * *z + factors.gain * increment;
        }
    }
    prony.long_term() * u(end) + prony.arms.iter().zip(&z).map(|(arm, z)| arm.weight * z).sum::<f64>()
}

/// The observed order of convergence between `steps` and twice as many.
fn order(prony: &Prony, memory: Memory, u: impl Fn(f64) -> f64 + Copy, (end, exact): (f64, f64), steps: usize) -> f64 {
    let error = |steps| (stress(prony, memory, u, end, steps) - exact).abs();
    (error(steps) / error(2 * steps)).log2()
}

/// A jump of the strain at t = 0 is held: s(t) = M(t). The exponential update has no error at all.
#[test]
fn step_relaxes_as_the_series() {
    let (prony, end) = (eva(), 1.7);
    let exact = prony.relaxation(end);
    let step = |_: f64| 1.0;
    close(stress(&prony, Memory::Exponential, step, end, 100), exact, 1e-14);
    let first = order(&prony, Memory::BackwardEuler, step, (end, exact), 4000);
    assert!((first - 1.0).abs() < 0.01, "order {first}");
}

/// u = t: s(t) = mu_0 t + sum mu_i tau_i (1 - exp(-t/tau_i)). The exponential update is exact, at any step.
#[test]
fn ramp_is_exact_with_the_exponential_update() {
    let (prony, end) = (eva(), 1.7);
    let arms = prony.arms.iter().map(|arm| -arm.weight * arm.time * (-end / arm.time).exp_m1());
    let exact = prony.long_term() * end + arms.sum::<f64>();
    let ramp = |t: f64| t;
    for steps in [1, 7, 1000] {
        close(stress(&prony, Memory::Exponential, ramp, end, steps), exact, 1e-13);
    }
    let first = order(&prony, Memory::BackwardEuler, ramp, (end, exact), 4000);
    assert!((first - 1.0).abs() < 0.01, "order {first}");
}

/// u = sin(w t): z = x/(1+x^2) [cos(w t) + x sin(w t) - exp(-t/tau)] with x = w tau, transient included.
#[test]
fn sinusoid_converges_with_orders_two_and_one() {
    let (prony, end, w) = (eva(), 1.7, 3.0f64);
    let arm = |arm: &Arm| {
        let x = w * arm.time;
        arm.weight * x / (1.0 + x * x) * ((w * end).cos() + x * (w * end).sin() - (-end / arm.time).exp())
    };
    let exact = prony.long_term() * (w * end).sin() + prony.arms.iter().map(arm).sum::<f64>();
    let sine = |t: f64| (w * t).sin();
    let second = order(&prony, Memory::Exponential, sine, (end, exact), 400);
    let first = order(&prony, Memory::BackwardEuler, sine, (end, exact), 4000);
    assert!((second - 2.0).abs() < 0.01, "order {second}");
    assert!((first - 1.0).abs() < 0.01, "order {first}");
    close(stress(&prony, Memory::Exponential, sine, end, 400), exact, 1e-4);
}

/// The steady amplitude and phase of a driven arm are those of Eq. (10), and a cycle dissipates pi M'' per unit strain.
#[test]
fn a_cycle_dissipates_pi_times_the_loss_modulus() {
    let (prony, w, per_cycle) = (eva(), 2.0f64, 2000);
    let dt = std::f64::consts::TAU / w / f64::from(per_cycle);
    let mut z = vec![0.0; 3];
    let (mut work, mut last) = (0.0, 0.0);
    for n in 0..30 * per_cycle {
        let (before, after) = ((w * f64::from(n) * dt).sin(), (w * f64::from(n + 1) * dt).sin());
        for (z, arm) in z.iter_mut().zip(&prony.arms) {
            let factors = Memory::Exponential.factors(dt / arm.time);
            *z = factors.decay * *z + factors.gain * (after - before);
        }
        let now = prony.long_term() * after + prony.arms.iter().zip(&z).map(|(arm, z)| arm.weight * z).sum::<f64>();
        if n >= 29 * per_cycle {
            work += 0.5 * (now + last) * (after - before);
        }
        last = now;
    }
    close(work, std::f64::consts::PI * prony.complex_modulus(w).im, 1e-5);
}

/// Eq. (11) with c = 814.7, a = 0.226 at 1 s: 814.7/Gamma(0.774); Gamma(0.774) = 1.190 184 8 by its recurrence and
/// Stirling's series.
#[test]
fn power_law_and_its_complex_modulus_belong_together() {
    let law = Fractional::new(814.7, 0.226).unwrap();
    let stirling = |x: f64| {
        let series = 1.0 / (12.0 * x) - 1.0 / (360.0 * x.powi(3)) + 1.0 / (1260.0 * x.powi(5));
        ((x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series).exp()
    };
    let gamma = stirling(10.774) / (0..10).map(|i| 0.774 + f64::from(i)).product::<f64>();
    close(law.relaxation(1.0), 814.7 / gamma, 1e-10);
    close(law.relaxation(100.0) / law.relaxation(1.0), 100f64.powf(-0.226), 1e-14);
    // i w times the Laplace transform of t^-a/Gamma(1-a) is (i w)^a.
    let modulus = law.complex_modulus(3.0);
    let exact = Complex::new(0.0f64, 3.0).powf(0.226) * 814.7;
    close(modulus.re, exact.re, 1e-14);
    close(modulus.im, exact.im, 1e-14);
    close(modulus.im / modulus.re, (std::f64::consts::FRAC_PI_2 * 0.226).tan(), 1e-14);
    for (modulus, order) in [(0.0, 0.2), (1.0, 0.0), (1.0, 1.0), (f64::NAN, 0.2), (1.0, f64::NAN)] {
        assert!(Fractional::new(modulus, order).is_err());
    }
}

/// The arms that hold the power law within 1 % over four decades: 5, wherever the decades lie, and 4 do not.
#[test]
fn five_arms_are_within_one_percent_over_four_decades() {
    let law = Fractional::new(814.7, 0.226).unwrap();
    for band in [Band::new(1e-2, 1e2).unwrap(), Band::new(1e-9, 1e-5).unwrap()] {
        let errors: Vec<f64> = (1..=8).map(|arms| law.approximate(band, arms).unwrap().max_error).collect();
        assert!(errors[3] > 0.01 && errors[4] < 0.006, "{errors:?}");
        assert!(errors.windows(2).all(|pair| pair[1] < pair[0]), "{errors:?}");
    }
}

#[test]
fn the_approximation_holds_for_any_order_and_band() {
    for order in [0.01, 0.226, 0.5, 0.9, 0.99] {
        for (from, to, arms) in [(1e-3, 1e3, 8), (1e-6, 1e6, 16), (1.0, 2.0, 2), (1e-12, 1e-2, 14)] {
            let law = Fractional::new(1e6, order).unwrap();
            let approximation = law.approximate(Band::new(from, to).unwrap(), arms).unwrap();
            assert!(approximation.max_error < 0.1, "order {order}, {from} s to {to} s: {}", approximation.max_error);
            assert!(approximation.series.arms.iter().all(|arm| arm.weight > 0.0 && arm.time > 0.0));
            assert!(approximation.series.arms.iter().map(|arm| arm.weight).sum::<f64>() <= 1.0);
        }
    }
}

/// WLF with Ferry's universal constants: a_T = 1 at the reference, 10^(17.44 * 10/(51.6 - 10)) ten kelvin below it.
#[test]
fn wlf_and_arrhenius_shift_the_times_alone() {
    let wlf = Shift::Wlf { reference: 200.0, c1: 17.44, c2: 51.6 };
    close(wlf.factor(200.0).unwrap(), 1.0, 1e-15);
    close(wlf.factor(190.0).unwrap(), 10f64.powf(174.4 / 41.6), 1e-12);
    assert!(wlf.factor(148.0).is_err() && wlf.factor(-1.0).is_err() && wlf.factor(f64::NAN).is_err());
    let arrhenius = Shift::Arrhenius { reference: 300.0, activation_energy: 8.314_462_618_153_24 * 3000.0 };
    close(arrhenius.factor(300.0).unwrap(), 1.0, 1e-15);
    close(arrhenius.factor(250.0).unwrap(), 2f64.exp(), 1e-12);
    assert!(arrhenius.factor(350.0).unwrap() < 1.0);
    // At another temperature the same moduli, at other times and frequencies.
    let (prony, factor) = (eva(), arrhenius.factor(250.0).unwrap());
    let cold = prony.with_times_scaled(factor);
    close(cold.relaxation(0.7 * factor), prony.relaxation(0.7), 1e-14);
    close(cold.complex_modulus(0.7 / factor).im, prony.complex_modulus(0.7).im, 1e-13);
    assert_eq!(cold.long_term(), prony.long_term());
}

fn prony(arms: &[(f64, f64)]) -> Prony {
    Prony { arms: arms.iter().map(|&(weight, time)| Arm { weight, time }).collect() }
}

/// nu = (3 K - 2 G)/(6 K + 2 G): constant where K relaxes with G, towards 1/2 where it stays, down where only K relaxes.
#[test]
fn poisson_ratio_of_relaxing_moduli() {
    let poisson = |shear: Prony, bulk: Prony| Poisson { instantaneous: 0.3, shear, bulk };
    let constant = poisson(eva(), eva());
    let stays = poisson(eva(), Prony::default());
    let bulk = poisson(Prony::default(), prony(&[(0.5, 2.0)]));
    for t in [0.0, 0.1, 3.0, 1e9, f64::INFINITY] {
        close(constant.at(t), 0.3, 1e-15);
        // K/G = 2.6/1.2 where nu = 0.3.
        let quotient = |k: f64, g: f64| 2.6 / 1.2 * k / g;
        let nu = |q: f64| (3.0 * q - 2.0) / (6.0 * q + 2.0);
        close(stays.at(t), nu(quotient(1.0, eva().relaxation(t))), 1e-14);
        close(bulk.at(t), nu(quotient(0.5 + 0.5 * (-t / 2.0).exp(), 1.0)), 1e-14);
    }
    assert!(stays.at(1.0) > 0.3 && bulk.at(1.0) < 0.3);
    let band = Band::new(1e-3, 1e3).unwrap();
    assert_eq!((constant.leaves(band), stays.leaves(band), bulk.leaves(band)), (None, None, None));
}

/// Moduli that relax to nothing: 1/2 where G is gone first, -1 where K is, and the ratio of the slowest arms else.
#[test]
fn poisson_ratio_of_what_flows() {
    let poisson = |shear: &[(f64, f64)], bulk: &[(f64, f64)]| Poisson {
        instantaneous: 0.25,
        shear: prony(shear),
        bulk: prony(bulk),
    };
    let band = Band::new(1e-3, 100.0).unwrap();
    let liquid = poisson(&[(1.0, 0.1)], &[]);
    close(liquid.at(f64::INFINITY), 0.5, 1e-15);
    assert!(liquid.leaves(band).is_some_and(|(t, nu)| t > 1.0 && nu > 0.5 - 1e-12));
    assert!(liquid.leaves(Band::new(1e-3, 1.0).unwrap()).is_none());
    let foam = poisson(&[(0.5, 1.0)], &[(1.0, 0.1)]);
    close(foam.at(f64::INFINITY), -1.0, 1e-15);
    assert!(foam.leaves(band).is_some_and(|(t, nu)| t > 1.0 && nu < -1.0 + 1e-12));
    // K/G = 5/3 at first, and 5/3 of 0.4/0.8 in the end, long after both are below the smallest number.
    let both = poisson(&[(0.2, 0.1), (0.8, 2.0)], &[(0.6, 0.3), (0.4, 2.0)]);
    for t in [1e4, 1e300, f64::INFINITY] {
        let quotient = 5.0 / 3.0 * 0.5;
        close(both.at(t), (3.0 * quotient - 2.0) / (6.0 * quotient + 2.0), 1e-13);
    }
    assert!(both.leaves(Band::new(1e-3, 1e6).unwrap()).is_none());
}

#[test]
fn series_over_common_times() {
    let (one, other) = (prony(&[(0.3, 2.0), (0.1, 0.5), (0.2, 2.0)]), prony(&[(0.4, 1.0), (0.1, 2.0)]));
    let times = common_times(&[&one, &other]);
    assert_eq!(times, [0.5, 1.0, 2.0]);
    assert_eq!(one.weights_over(&times), [0.1, 0.0, 0.5]);
    assert_eq!(other.weights_over(&times), [0.0, 0.4, 0.1]);
}

/// A ramp of 10 s in 50 steps, held to 100 s. A series that follows E(t) from the first step on, of eight arms, misses
/// 8 % of the force at that step, because a ramp asks for what was before. With one arm for that the force at every step
/// is within what is said, and that below 0.5 % by default, for any order.
#[test]
fn a_series_holds_the_forces_of_ramps_from_the_first_step_on() {
    let loading = Loading {
        band: Band::new(0.2, 100.0).unwrap(),
        directions: vec![vec![Ramp { from: 0.0, to: 10.0, rate: 1.0 }]],
        moments: (1..=500).map(|step| 0.2 * f64::from(step)).collect(),
    };
    // The force of the power law: r c [t^(1-a) - (t - 10)^(1-a)]/Gamma(2 - a).
    let largest = |order: f64, integral: &dyn Fn(f64) -> f64| {
        let exact = |t: f64| 814.7 * t.max(0.0).powf(1.0 - order) / libm::tgamma(2.0 - order);
        let error = |&t: &f64| {
            let held = (t - 10.0).max(0.0);
            ((integral(t) - integral(held)) / (exact(t) - exact(held)) - 1.0).abs()
        };
        loading.moments.iter().map(error).fold(0.0, f64::max)
    };
    let law = Fractional::new(814.7, 0.226).unwrap();
    let before = law.approximate(loading.band, 8).unwrap();
    let missed = largest(0.226, &|t| before.instantaneous * before.series.integral(t));
    assert!((0.07..0.09).contains(&missed) && before.max_error < 1e-4, "{missed} {}", before.max_error);
    for order in [0.05, 0.226, 0.5, 0.8, 0.95] {
        let law = Fractional::new(814.7, order).unwrap();
        for found in [law.under(&loading, 8).unwrap(), law.within(5e-3, &loading, 20).unwrap()] {
            let error = largest(order, &|t| found.instantaneous * found.series.integral(t));
            println!("order {order}: {} arms, {error:.2e}, stated {:.2e}", found.series.arms.len(), found.max_error);
            assert!((error - found.max_error).abs() < 1e-9 && error < 5e-3, "order {order}: {error}");
        }
    }
}
