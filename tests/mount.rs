//! Springs, dashpots and masses between the indenter and what moves it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::program::{Outcome, Run};

/// An elastic layer of 1 m x 1 m under a flat indenter: G = 568.498 Pa, nu = 0.3. It gives way by N C_0 under a force, C_0 = H (1 - 2 nu)/
/// (2 G (1 - nu)), and by Q H/G along it.
const FLAT: &str = r#"
[layer]
width = 1.0
depth = 1.0
cells = [4, 4]
sides = "periodic"
[material]
shear_modulus = 568.498
poisson_ratio = 0.3
[indenter]
profile = "expression"
formula = "0*x"
[contact]
"#;

const G: f64 = 568.498;
const C0: f64 = 0.4 / (2.0 * G * 0.7);

/// The energies, but for the imbalance, and that.
fn ledger(run: &Outcome) -> (f64, f64) {
    let sum = ["stored", "viscoelastic_dissipation", "friction_dissipation", "penalty"]
        .map(|term| run.last(&format!("energy/{term}")));
    let mounts = ["mount_spring", "mount_dashpot", "kinetic"].map(|term| run.last(&format!("energy/{term}")));
    let work = run.last("energy/external_work");
    let left = work - sum.iter().chain(&mounts).sum::<f64>();
    assert!((left - run.last("energy/imbalance")).abs() < 1e-12 * work.abs());
    (work, left)
}

/// A spring in series with a layer under a flat punch: the far end goes down by D, of which the layer takes N C_0 and the spring (N - L)/k,
/// with L a dead load that acts from the first step on. The ledger closes but for that jump, because all is linear.
#[test]
fn a_spring_in_series_with_a_flat_punch() {
    let scene = FLAT.to_owned()
        + "[mount]\nnormal = { stiffness = 800.0, load = 0.1 }\n[[phase]]\nduration = 1.0\nsteps = 4\napproach = 1e-3\n";
    let run = Run::new(&scene).done();
    let (time, far) = (run.history("time"), run.history("mount_normal"));
    let (force, approach) = (run.history("normal_force"), run.history("approach"));
    assert_eq!((far[0], force[0], approach[0]), (0.0, 0.0, 0.0));
    for i in 1..time.len() {
        let exact = (800.0 * far[i] + 0.1) / (1.0 + 800.0 * C0);
        assert!((far[i] - 1e-3 * time[i]).abs() < 1e-18);
        assert!((force[i] / exact - 1.0).abs() < 1e-9 && (approach[i] / (exact * C0) - 1.0).abs() < 1e-9, "{i}");
    }
    let (work, left) = ledger(&run);
    // The dead load is there all through the first step, the contact over it by the mean of its ends.
    let jump = 0.5 * 0.1 * approach[1];
    assert!((left - jump).abs() < 1e-9 * work, "{left:e} {jump:e}");
}

/// A dashpot alone lowers the indenter by c (D_far' - D') = D/C_0: D = V tau (1 - exp(-t/tau)), tau = c C_0; by backward Euler of first
/// order in the step: 1.3e-2, 6.6e-3 of it at t = tau with 50, 100 steps over 2 tau (its own closed form, 1 - (1 + dt/tau)^-n).
#[test]
fn a_dashpot_is_of_first_order() {
    let tau = 200.0 * C0;
    let at_tau = |steps: u32| {
        let phase = format!("[[phase]]\nduration = {:?}\nsteps = {steps}\napproach = {:?}\n", 2.0 * tau, 2e-3 * tau);
        let scene = FLAT.to_owned() + "[mount]\nnormal = { damping = 200.0 }\n" + &phase;
        let run = Run::new(&scene).done();
        let euler = 1.0 - (1.0 + 2.0 / f64::from(steps)).powi(-(steps as i32) / 2);
        let found = run.at(tau, "approach") / (1e-3 * tau);
        assert!((found - euler).abs() < 1e-9, "{found} {euler}");
        found / (1.0 - (-1.0f64).exp()) - 1.0
    };
    let [coarse, fine] = [50, 100].map(at_tau);
    assert!((coarse / fine - 2.0).abs() < 0.05, "{coarse:e} {fine:e}");
}

/// Pressed by 0.5 N/m and pulled along by a spring of 5 N/m per m.
fn slider(law: &str, mount: &str, (duration, steps): (f64, u32), velocity: f64) -> String {
    format!(
        "{FLAT}[friction]\n{law}\n[mount]\ntangential = {mount}\n[[phase]]\nname = \"load\"\nduration = 1e-3\nsteps = 1\nnormal_force = 0.5\n\
         [[phase]]\nname = \"pull\"\nduration = {duration:?}\nsteps = {steps}\nvelocity = {velocity:?}\n"
    )
}

/// Before it slips the force rises at k V, 1/k = 1/k_t + H/(G L), in a spring and a layer in series, up to f N; then it stays there.
#[test]
fn a_spring_pulls_up_to_friction() {
    let run =
        Run::new(&slider("law = \"coulomb\"\ncoefficient = 0.3", "{ stiffness = 5.0 }", (10.0, 40), 0.005)).done();
    let k = 1.0 / (1.0 / 5.0 + 1.0 / G);
    let (time, force, sliding) = (run.history("time"), run.history("tangential_force"), run.history("sliding"));
    for i in 2..time.len() {
        let pulled = 0.005 * (time[i] - 1e-3);
        let exact = (k * pulled).min(0.15);
        assert!((force[i] - exact).abs() < 1e-9, "{} s: {} {exact}", time[i], force[i]);
        assert!((sliding[i] - (pulled - force[i] / 5.0)).abs() < 1e-12);
    }
    let (work, left) = ledger(&run);
    println!("{work:e} {left:e}");
    assert!(left.abs() < 1e-3 * work, "{left:e} of {work:e}");
}

/// F = N f(w): f = 0.2 + 0.4 exp(-w/0.01) + 2 w.
const RISING: &str = "law = \"coulomb\"\ncoefficient = \"0.2 + 0.4*exp(-v/0.01) + 2*v\"";

/// The times, s, at which a column turns down from a peak, with its values there; and its least value after the first of them.
fn peaks(time: &[f64], values: &[f64]) -> (Vec<(f64, f64)>, f64) {
    let peaks: Vec<(f64, f64)> = (1..values.len() - 1)
        .filter(|&i| values[i] > values[i - 1] && values[i] > values[i + 1] && values[i] > 0.2)
        .map(|i| (time[i], values[i]))
        .collect();
    let first = peaks.first().map_or(f64::INFINITY, |peak| peak.0);
    let least = time.iter().zip(values).filter(|(t, _)| **t > first).map(|(_, v)| *v).fold(f64::INFINITY, f64::min);
    (peaks, least)
}

/// Stick-slip of a massless slider on a spring: the force rises at k V to N f(0) = 0.3 and falls on the rising branch of f to its least,
/// N [f_d + eta v_s (1 + ln((f_s - f_d)/(eta v_s)))] = 0.139957, again and again: 6.458 s of stick, 0.353 s of slip. The period is off by a
/// few steps of 0.01 s, the least by what the slowest slip makes of one.
#[test]
fn a_massless_slider_sticks_and_slips() {
    let run = Run::new(&slider(RISING, "{ stiffness = 5.0 }", (40.0, 4000), 0.005)).done();
    let (peaks, least) = peaks(&run.history("time"), &run.history("tangential_force"));
    println!("{peaks:?} {least}");
    assert!(peaks.len() >= 3, "{peaks:?}");
    for pair in peaks.windows(2) {
        assert!((pair[1].1 - 0.3).abs() < 1e-3, "{pair:?}");
        assert!((pair[1].0 - pair[0].0 - 6.811).abs() < 0.05, "{pair:?}");
    }
    assert!((least - 0.139957).abs() < 2e-3, "{least}");
}

/// Without a branch that rises again there is nothing stable after the peak: the run ends there with code 3, says why and what to add, and keeps
/// what was before.
#[test]
fn a_jump_that_nothing_resolves_is_refused() {
    let weakening = "law = \"coulomb\"\ncoefficient = \"0.2 + 0.4*exp(-v/0.01)\"";
    let run = Run::new(&slider(weakening, "{ stiffness = 5.0 }", (40.0, 4000), 0.005)).run();
    assert_eq!(run.code, 3, "{}", run.stdout);
    run.assert_single_message("give mount.tangential a mass");
    let reached = run.last("tangential_force");
    assert!((reached - 0.3).abs() < 1e-3, "{reached}");
}

/// A mass on a spring under static and kinetic friction, pulled slowly: it is let go at f_s N and caught half a period of the mass on the spring
/// later, with a drop of the mount's force by 2 (f_s - f_k) N = 0.2 N/m (by 5e-5 more at this velocity, from the amplitude
/// sqrt((f_s - f_k)^2 N^2 + (k V/w)^2) of the motion at w = sqrt(k_t/m)) and a slip time of pi sqrt(m/k_t) = 0.1405 s. Backward Euler damps the event:
/// of first order in the step; what the kinetic energy loses stands in the imbalance.
#[test]
fn a_mass_overshoots() {
    let law = "law = \"coulomb\"\ncoefficient = \"0.4 + 0.2*exp(-v/1e-4)\"";
    let exact = 2.0 * f64::hypot(0.1, 0.05 * (0.01f64 / 5.0).sqrt());
    let event = |steps: u32| {
        let run = Run::new(&slider(law, "{ stiffness = 5.0, mass = 0.01 }", (6.6, steps), 0.01)).done();
        let (time, far, sliding) = (run.history("time"), run.history("mount_tangential"), run.history("sliding"));
        let force: Vec<f64> = far.iter().zip(&sliding).map(|(far, near)| 5.0 * (far - near)).collect();
        let top = (0..force.len()).max_by(|a, b| force[*a].total_cmp(&force[*b])).unwrap();
        let bottom = (top..force.len()).min_by(|a, b| force[*a].total_cmp(&force[*b])).unwrap();
        let (work, left) = ledger(&run);
        println!("{steps}: {} {} of {work}", force[top] - force[bottom], left);
        assert!(left > 0.0);
        [force[top] - force[bottom] - exact, time[bottom] - time[top] - std::f64::consts::PI * (0.01f64 / 5.0).sqrt()]
    };
    let found = [3300, 6600, 13200].map(event);
    println!("{found:?}");
    let order = ((found[0][0] - found[1][0]) / (found[1][0] - found[2][0])).log2();
    assert!((order - 1.0).abs() < 0.2, "{order} {found:?}");
    assert!(found[2][0].abs() < 0.03 * exact && found[2][1].abs() < 0.01, "{found:?}");
}

/// Small departures from steady sliding under a law that falls with the rate, f' = -0.5 s/m, grow with the positive root of
/// c_t C N f' x^2 + [N f' (1 + k_t C) + c_t] x + k_t = 0, C = H/(G L): 19.8 and, with a dashpot, 24.6 per second; under one that rises they decay, by
/// -19.8 (without a dashpot the only root, -k_t/(N f' (1 + k_t C))). Backward Euler makes of the root the growth 1/(1 - x dt) of a step, exactly;
/// of the time step itself it is of first order.
#[test]
fn departures_from_steady_sliding_grow_as_they_should() {
    let compliance = 1.0 / G;
    for (slope, damping, kick) in [(-0.5, 0.0, 1e-7), (-0.5, 0.05, 1e-7), (0.5, 0.0, 1e-5)] {
        let law =
            format!("law = \"coulomb\"\ncoefficient = \"0.275 + step(s, 0.02)*({slope:?}*(v - 0.05) + {kick:?})\"");
        let mount = format!("{{ stiffness = 5.0, damping = {damping:?} }}");
        let run = Run::new(&slider(&law, &mount, (1.15, 1150), 0.05)).set("solver.tolerance=1e-14").done();
        let (time, sliding) = (run.history("time"), run.history("sliding"));
        let force = run.history("tangential_force");
        // From when the law changes: the slider is let go at 0.55 s, and has slid 0.02 m at 0.95 s.
        let begin = (1..force.len()).find(|&i| time[i] > 0.6 && (force[i] - force[i - 1]).abs() > 1e-9).unwrap();
        let departure: Vec<f64> = sliding.windows(2).map(|pair| pair[1] - pair[0] - 0.05e-3).collect();
        let (n, factor) = (begin + 60, |i: usize| departure[i + 1] / departure[i]);
        let growth = (factor(n) - 1.0) / (factor(n) * 1e-3);
        let stiffness = 0.5 * slope;
        let [a, b] = [damping * compliance * stiffness, stiffness * (1.0 + 5.0 * compliance) + damping];
        let root = if a == 0.0 { -5.0 / b } else { (-b - (b * b - 20.0 * a).sqrt()) / (2.0 * a) };
        println!("{slope} {damping}: {growth} {root}");
        assert!((growth / root - 1.0).abs() < 1e-3, "{slope} {damping}: {growth} {root}");
    }
}

/// Under a law that falls with the slid distance, N |df/ds| = 1 N/m per m, sliding is unstable where spring and layer together are softer than
/// that: 1/k = 1/k_t + H/(G L).
#[test]
fn a_law_of_the_distance_is_unstable_below_its_slope() {
    let law = "law = \"coulomb\"\ncoefficient = \"0.3 - 2*min(s, 0.05)\"";
    for (stiffness, code) in [(1.02, 0), (0.98, 3)] {
        let spring = 1.0 / (1.0 / stiffness - 1.0 / G);
        let run = Run::new(&slider(law, &format!("{{ stiffness = {spring:?} }}"), (32.0, 3200), 0.005)).run();
        assert_eq!(run.code, code, "{stiffness}: {}", run.stderr);
    }
}

/// The greatest error of the approach over the greatest approach, by chosen steps, and how many there are.
fn chosen(scene: &str, tolerance: f64, ranks: usize, exact: impl Fn(f64) -> f64) -> (f64, Outcome) {
    let run = Run::new(scene).set(format!("phase.0.tolerance={tolerance:?}")).ranks(ranks).done();
    let rows = run.history("time").into_iter().zip(run.history("approach")).skip(1);
    let (mut apart, mut most) = (0.0_f64, 0.0_f64);
    for (time, approach) in rows {
        apart = apart.max((approach - exact(time)).abs());
        most = most.max(exact(time).abs());
    }
    (apart / most, run)
}

/// Chosen steps follow a mass on a spring and a dashpot over a flat punch, m x'' + c x' + (k + 1/C_0) x = L + k V t + c V from rest, in closed
/// form. They hold the local error of backward Euler, of second order in the step, so that the global one falls with the root of the
/// tolerance: by 3.16 for each tenth of it. One to three ranks choose the same.
#[test]
fn chosen_steps_follow_a_mass() {
    let [mass, damping, stiffness, load, speed] = [0.5, 40.0, 800.0, 0.1, 1e-3_f64];
    let scene = format!(
        "{FLAT}[mount]\nnormal = {{ stiffness = {stiffness:?}, damping = {damping:?}, mass = {mass:?}, load = {load:?} }}\n\
         [[phase]]\nduration = 0.5\ntolerance = 1e-3\napproach = {:?}\n",
        0.5 * speed
    );
    let total = stiffness + 1.0 / C0;
    let rate = stiffness * speed / total;
    let start = (load + damping * (speed - rate)) / total;
    let decay = damping / (2.0 * mass);
    let angular = (total / mass - decay * decay).sqrt();
    let exact = |t: f64| {
        let swing = (angular * t).cos() * start + (angular * t).sin() * (rate + decay * start) / angular;
        start + rate * t - (-decay * t).exp() * swing
    };
    let found = [1e-3, 1e-4, 1e-5].map(|tolerance| chosen(&scene, tolerance, 1, exact));
    let errors = found.each_ref().map(|(error, run)| (*error, run.history("time").len()));
    println!("{errors:?}");
    for pair in errors.windows(2) {
        let ratio = pair[0].0 / pair[1].0;
        assert!((2.5..4.0).contains(&ratio), "{errors:?}");
    }
    let (together, _) = chosen(&scene, 1e-4, 3, exact);
    assert!((together / found[1].0 - 1.0).abs() < 1e-6, "{together} {errors:?}");
}

/// A spring with a dead load over a layer of one arm, (k + 1/C_0) x = L + k V t + mu z/C_0, z' = (x - z)/tau: the load comes at once, in a
/// first step of 1e-10 of the time, from which there is no rate to go on with. Nothing but the memory has an error, of third order in the step
/// where the tolerance holds the second: the error falls with the tolerance. By both strategies.
#[test]
fn chosen_steps_follow_a_dead_load() {
    let [stiffness, load, speed, mu, tau] = [800.0, 0.1, 2e-4, 0.579, 0.817_f64];
    let relaxing =
        "poisson_ratio = 0.3\narms = [ { weight = 0.579, time = 0.817 } ]\npoisson_rule = \"constant_ratio\"";
    let scene = FLAT.replace("poisson_ratio = 0.3", relaxing)
        + "[mount]\nnormal = { stiffness = 800.0, load = 0.1 }\n[[phase]]\nduration = 5.0\ntolerance = 1e-3\napproach = 1e-3\n";
    let total = stiffness + 1.0 / C0;
    let (growth, decay) = (stiffness * speed / total / tau, (1.0 - mu / (C0 * total)) / tau);
    let (offset, slope) = ((load / total / tau - growth / decay) / decay, growth / decay);
    let exact = |t: f64| {
        let arm = offset + slope * t - offset * (-decay * t).exp();
        (load + stiffness * speed * t + mu * arm / C0) / total
    };
    let errors = [1e-3, 1e-4, 1e-5].map(|tolerance| chosen(&scene, tolerance, 1, exact).0);
    println!("{errors:?}");
    assert!((errors[0] / errors[2]).log10() > 1.6 && errors[2] < 2e-6, "{errors:?}");
    let stiff = scene.replace("[contact]", "[contact]\npenalty = 1e10\n[solver]\nstrategy = \"monolithic\"");
    let (error, _) = chosen(&stiff, 1e-5, 1, exact);
    assert!(error < 2e-6, "{error}");
}

/// Chosen steps go through the onset of sliding on a spring, under a force: where it slips, 0.15 N/m, and the sliding that spring and layer leave
/// are known at each time, so that only the step in which it begins has an error.
#[test]
fn chosen_steps_follow_a_slider() {
    let law = "law = \"coulomb\"\ncoefficient = 0.3";
    let scene = slider(law, "{ stiffness = 5.0 }", (10.0, 40), 0.005).replace("steps = 40", "tolerance = 1e-3");
    let run = Run::new(&scene).done();
    let k = 1.0 / (1.0 / 5.0 + 1.0 / G);
    let (time, force, sliding) = (run.history("time"), run.history("tangential_force"), run.history("sliding"));
    println!("{} steps", time.len());
    for i in 2..time.len() {
        let pulled = 0.005 * (time[i] - 1e-3);
        let exact = (k * pulled).min(0.15);
        assert!((force[i] - exact).abs() < 1e-9, "{} s: {} {exact}", time[i], force[i]);
        assert!((sliding[i] - (pulled - force[i] / 5.0)).abs() < 1e-12);
    }
}
