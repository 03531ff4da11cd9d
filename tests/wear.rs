//! Wear of the body and of the indenter: closed forms, what is kept, orders in the step, steps far beyond what an explicit rule bears.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::f64::consts::{PI, TAU};

use common::program::{Outcome, Run};

/// An elastic layer of 1 m x 1 m, G = 568.498 Pa, nu = 0.3, under an indenter that slides.
fn scene(cells: &str, indenter: &str, rest: &str, phases: &str) -> String {
    format!(
        "[layer]\nwidth = 1.0\ndepth = 1.0\ncells = {cells}\nsides = \"periodic\"\n[material]\nshear_modulus = 568.498\n\
         poisson_ratio = 0.3\n[indenter]\n{indenter}\n[contact]\n[solver]\ntolerance = 1e-12\n{rest}\n{phases}"
    )
}

const G: f64 = 568.498;
/// H (1 - 2 nu)/(2 G (1 - nu)), of the mean pressure.
const C0: f64 = 0.4 / (2.0 * G * 0.7);
const FLAT: &str = "profile = \"expression\"\nformula = \"0*x\"";
const COULOMB: &str = "[friction]\nlaw = \"coulomb\"\ncoefficient = 0.3";
const PARTS: [&str; 2] = ["body", "indenter"];

fn wear(of: &str, law: &str, coefficient: f64) -> String {
    format!("[wear]\nof = \"{of}\"\nlaw = \"{law}\"\ncoefficient = {coefficient:?}\n")
}

fn phase(held: &str, velocity: f64, (duration, steps): (f64, u32)) -> String {
    format!("[[phase]]\nduration = {duration:?}\nsteps = {steps}\n{held}\nvelocity = {velocity:?}\n")
}

/// The rows of a field of the interface.
fn rows(run: &Outcome, name: &str) -> Vec<Vec<f64>> {
    let field = run.results().interface(name).unwrap();
    (0..field.rows).map(|row| field.row(row).to_vec()).collect()
}

fn spread(values: &[f64]) -> f64 {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
    high - low
}

/// The amplitude of the first wave of a field.
fn first_wave(field: &[f64]) -> f64 {
    let n = field.len() as f64;
    let part = |of: fn(f64) -> f64| field.iter().zip(0..).map(|(v, i)| v * of(TAU * f64::from(i) / n)).sum::<f64>() / n;
    2.0 * part(f64::cos).hypot(part(f64::sin))
}

/// A flat indenter under N = 0.5 N/m that slides V t = 2 m, k = 2e-4 1/Pa: Archard's depth is k N V t/L = 2.0e-4 m, that by the energy
/// k f N times the slip, which is less than the way by f N H/G, the shear of the layer.
#[test]
fn a_conforming_contact() {
    for (of, law) in PARTS.into_iter().flat_map(|of| [(of, "archard"), (of, "energy")]) {
        let phases = phase("normal_force = 0.5", 0.0, (1e-3, 1)) + &phase("", 0.1, (20.0, 20));
        let friction = if law == "energy" { COULOMB } else { "" };
        let run =
            Run::new(&scene("[4, 4]", FLAT, &(friction.to_owned() + "\n" + &wear(of, law, 2e-4)), &phases)).done();
        let exact = match law {
            "archard" => 2.0e-4,
            _ => 2e-4 * 0.15 * (2.0 - 0.15 / G),
        };
        let depth = rows(&run, "worn_depth").pop().unwrap();
        println!("{of} {law}: {depth:?} {exact:e}");
        assert!(depth.iter().all(|depth| (depth / exact - 1.0).abs() < 1e-9));
        assert!((run.last("worn_volume") / exact - 1.0).abs() < 1e-9);
        // The indenter follows what wears.
        let approach = run.history("approach");
        assert!(((approach[21] - approach[1]) / exact - 1.0).abs() < 1e-9);
        // p dh_w, all of it supplied by the force; the ledger closes.
        assert!((run.last("energy/wear") / (0.5 * exact) - 1.0).abs() < 1e-9);
        let (work, left) = (run.last("energy/external_work"), run.last("energy/imbalance"));
        assert!(left.abs() < 1e-9 * work, "{left:e} of {work:e}");
    }
}

/// A flat indenter whose approach is held: N = N_0 exp(-k V t/C), C = C_0 + 1/alpha, by backward Euler N_0 (1 + k V dt/C)^-n, of first order
/// in the step; in space the same for each m^2.
#[test]
fn a_held_approach_is_worn_off() {
    let (k, v, t) = (2e-4, 0.1, 25.0);
    for (of, penalty, space) in
        [("body", None, false), ("indenter", None, false), ("body", Some(1e4), false), ("indenter", Some(1e4), true)]
    {
        let c = C0 + penalty.map_or(0.0, |alpha: f64| 1.0 / alpha);
        let error = |steps: u32| {
            let phases = phase("approach = 1e-3", 0.0, (1.0, 1)) + &phase("", v, (t, steps));
            let mut run = Run::new(&scene("[4, 4]", FLAT, &wear(of, "archard", k), &phases));
            if let Some(penalty) = penalty {
                run = run.set(format!("contact.penalty={penalty:?}"));
            }
            if space {
                run = run
                    .set("layer.width=[1.0,0.5]")
                    .set("layer.cells=[4,2,4]")
                    .set("phase.phase-2.velocity=[0.06,0.08]");
            }
            let run = run.done();
            let force = run.history("normal_force");
            let ratio = force[force.len() - 1] / force[1];
            let euler = (1.0 + k * v * t / f64::from(steps) / c).powi(-(steps as i32));
            assert!((force[1] * c / (1e-3 * if space { 0.5 } else { 1.0 }) - 1.0).abs() < 1e-9);
            assert!((ratio / euler - 1.0).abs() < 1e-9, "{of} {ratio} {euler}");
            ratio / (-k * v * t / c).exp() - 1.0
        };
        let [coarse, fine] = [25, 50].map(error);
        println!("{of} {penalty:?}: {coarse:e} {fine:e}");
        assert!((coarse / fine - 2.0).abs() < 0.05, "{coarse:e} {fine:e}");
    }
}

/// Under a wave in full contact that slides by whole cells in a step, the first wave of the profile decays by 1 + k V S dt a step, S the
/// pressure over the height, and N stays in step with the mean: a wave of 5e-7 m strains the face by 1e-6, so that
/// |w| = V to that.
#[test]
fn a_wave_of_the_indenter_decays() {
    let (k, v, dt) = (2e-4, 0.125, 0.25);
    let indenter = "profile = \"harmonic\"\namplitude = 5e-7\nwavelength = 1.0";
    let phases = phase("normal_force = 0.006", 0.0, (1.0, 1)) + &phase("", v, (40.0 * dt, 40));
    let run = Run::new(&scene("[32, 32]", indenter, &wear("indenter", "archard", k), &phases)).done();
    assert_eq!(run.last("contact_fraction"), 1.0);
    let (pressure, profile) = (rows(&run, "pressure"), rows(&run, "worn_profile"));
    let stiffness = first_wave(&pressure[0]) / 5e-7;
    for (n, profile) in profile.iter().enumerate() {
        let exact = 5e-7 * (1.0 + k * v * stiffness * dt).powi(-(n as i32));
        assert!((first_wave(profile) / exact - 1.0).abs() < 1e-5, "{n}: {:e} {exact:e}", first_wave(profile));
    }
    // The deep layer's stiffness, pi E*/L, within what 32 cells are off.
    assert!((stiffness / (PI * 2.0 * G / 0.7) - 1.0).abs() < 0.02, "{stiffness}");
    assert!((run.last("worn_volume") / (k * 0.006 * v * 10.0) - 1.0).abs() < 1e-5);
}

/// A wave along y that slides along x is the same to the body and to the indenter; both wear to an even pressure, by 1 + k V S dt a step.
#[test]
fn body_and_indenter_wear_alike_along_a_ridge() {
    let (k, v, dt) = (2e-4, 0.3, 0.25);
    let indenter = "profile = \"expression\"\nformula = \"5e-6*(1-cos(2*pi*y))\"";
    let phases = phase("normal_force = 0.06", 0.0, (1.0, 1)) + &phase("", v, (40.0 * dt, 40));
    let space = |of: &str| {
        let text = scene("[4, 32, 8]", indenter, &wear(of, "archard", k), &phases)
            .replace("width = 1.0", "width = [0.25, 1.0]");
        Run::new(&text).done()
    };
    let [body, indenter] = PARTS.map(space);
    let [a, b] = [&body, &indenter].map(|run| rows(run, "pressure"));
    for (a, b) in a.iter().zip(&b) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9 * a.abs()));
    }
    let worn = [&body, &indenter].map(|run| rows(run, "worn_depth").pop().unwrap());
    assert!(worn[0].iter().zip(&worn[1]).all(|(a, b)| (a / b - 1.0).abs() < 1e-9));
    let along_y = |row: &[f64]| first_wave(&row[..32]);
    // What the press wears, while the face slips across, is off by then.
    let pressed = rows(&body, "worn_depth").swap_remove(0);
    let left: Vec<f64> = (0..32).map(|i| 5e-6 * (1.0 - (TAU * i as f64 / 32.0).cos()) + pressed[i]).collect();
    let stiffness = along_y(&a[0]) / first_wave(&left);
    let exact = (1.0 + k * v * stiffness * dt).powi(-40);
    assert!((along_y(&a[40]) / along_y(&a[0]) / exact - 1.0).abs() < 1e-9);
}

/// Steps 77 times as long as an explicit rule bears, 2/(k V S) with S of the shortest wave: by whole spacings the pressure under a rough
/// indenter evens out to round-off, by 3.37 of them to what the profile between its nodes leaves, 4e-3 of what it was; the ledger closes to
/// round-off while all is in contact.
#[test]
fn long_steps_are_stable() {
    let (k, dt, n) = (2e-2, 0.625, 64.0);
    let indenter =
        "profile = \"rough\"\nhurst = 0.8\nrms_height = 1e-5\nshortest = 0.05\nlongest = 0.5\nperiod = 1.0\nseed = 3";
    for (spacings, left) in [(3.0, 1e-12), (3.37, 1e-2)] {
        let v = spacings / n / dt;
        let shortest = 2.0 * G / 0.7 * PI * n / 2.0;
        assert!(k * v * shortest * dt / 2.0 > 76.0);
        let phases = phase("normal_force = 0.1", 0.0, (1.0, 1)) + &phase("", v, (30.0 * dt, 30));
        let run = Run::new(&scene("[64, 16]", indenter, &wear("indenter", "archard", k), &phases)).done();
        let spreads: Vec<f64> = rows(&run, "pressure").iter().map(|row| spread(row)).collect();
        println!("{spacings}: {spreads:?}");
        assert!(spreads.windows(2).take(3).all(|two| two[1] < 0.3 * two[0]));
        assert!(spreads[16..].iter().all(|spread| *spread < left * spreads[0]));
        let imbalance = run.history("energy/imbalance");
        assert_eq!(run.history("contact_fraction")[2..], [1.0; 30]);
        assert!(
            imbalance[2..].iter().all(|left| (left - imbalance[2]).abs() < 1e-12 * run.last("energy/external_work"))
        );
    }
}

/// A rough indenter in partial contact with friction, a viscoelastic layer, steps by 0.7 spacings: the volume is k times the integral of
/// p |w| over face and time to round-off, of the body and of the indenter; by the energy k times that of q.w. Three ranks do what one
/// does, to the last bit.
#[test]
fn volume_is_what_was_worn() {
    let indenter =
        "profile = \"rough\"\nhurst = 0.8\nrms_height = 1e-4\nshortest = 0.1\nlongest = 0.5\nperiod = 1.0\nseed = 5";
    let phases = phase("approach = 2e-4", 0.0, (1.0, 4)) + &phase("", 0.05, (0.7 * 12.0 / 64.0 / 0.05, 12));
    for (of, law) in PARTS.into_iter().flat_map(|of| [(of, "archard"), (of, "energy")]) {
        let text = scene("[64, 16]", indenter, &(COULOMB.to_owned() + "\n" + &wear(of, law, 5e-3)), &phases);
        let run = || {
            Run::new(&text).set("material={shear_modulus=568.498,poisson_ratio=0.3,arms=[{weight=0.5,time=0.3}],poisson_rule=\"constant_ratio\"}")
        };
        let one = run().done();
        let (time, volume) = (one.history("time"), one.history("worn_volume"));
        let [p, q, w] = ["pressure", "shear", "slip_rate"].map(|name| rows(&one, name));
        let mut exact = 0.0;
        for step in 0..p.len() {
            let dt = time[step + 1] - time[step];
            let traction = if law == "archard" { &p } else { &q };
            let rate: f64 = traction[step].iter().zip(&w[step]).map(|(p, w)| p.abs() * w.abs()).sum();
            exact += 5e-3 * rate / 64.0 * dt;
            assert!(
                (volume[step + 1] - exact).abs() <= 1e-12 * exact,
                "{of} {law} {step}: {:e} {exact:e}",
                volume[step + 1]
            );
        }
        assert!(exact > 0.0 && one.last("contact_fraction") < 1.0);
        let (work, left, worn) =
            (one.last("energy/external_work"), one.last("energy/imbalance"), one.last("energy/wear"));
        println!("{of} {law}: volume {exact:e}, wear {worn:e}, imbalance {left:e} of {work:e}");
        assert!(worn > 0.0 && left.abs() < 0.05 * worn && left.abs() < 1e-3 * work);
        let three = run().ranks(3).done();
        for column in ["normal_force", "hysteretic_force", "worn_volume", "energy/wear"] {
            assert_eq!(one.history(column), three.history(column), "{column}");
        }
        assert_eq!(rows(&one, "worn_depth"), rows(&three, "worn_depth"));
    }
}

/// A profile that does not depend on y wears in space as in the plane, to 1e-9; and is made of what its own figures say: the worn profile is
/// the profile and what is off it.
#[test]
fn a_profile_without_y_wears_as_in_the_plane() {
    let indenter = "profile = \"harmonic\"\namplitude = 5e-4\nwavelength = 1.0";
    let phases = phase("approach = 4e-4", 0.0, (1.0, 3)) + &phase("", 0.1, (1.7, 8));
    for (of, law) in [("body", "archard"), ("indenter", "energy"), ("indenter", "archard")] {
        let text = scene("[20, 6]", indenter, &(COULOMB.to_owned() + "\n" + &wear(of, law, 2e-2)), &phases);
        let plane = Run::new(&text).done();
        let space = Run::new(&text).set("layer.width=[1.0,0.3]").set("layer.cells=[20,4,6]").done();
        for column in ["normal_force", "tangential_force", "hysteretic_force", "worn_volume", "energy/wear"] {
            let (a, b) = (plane.history(column), space.history(column));
            let largest = a.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
            assert!(largest > 0.0, "{column}");
            for (a, b) in a.iter().zip(&b) {
                assert!((a * 0.3 - b).abs() < 1e-9 * 0.3 * largest, "{of} {law} {column}: {a:e} {b:e}");
            }
        }
        if of == "indenter" {
            let (depth, profile) =
                (rows(&plane, "worn_depth").pop().unwrap(), rows(&plane, "worn_profile").pop().unwrap());
            for (i, (depth, profile)) in depth.iter().zip(&profile).enumerate() {
                assert!((profile - depth - 5e-4 * (1.0 - (TAU * i as f64 / 20.0).cos())).abs() < 1e-18);
            }
            assert!(depth.iter().any(|depth| *depth > 0.0));
        }
    }
}

/// Adaptive steps see what wear does to the path of the face: N = N_0 exp(-k V t/C) to 1.9e-2 with a tolerance of 1e-3 of the approach, 42
/// steps, and to 2.1e-3 with 1e-5, 254 steps.
#[test]
fn adaptive_steps() {
    let (k, v, t) = (2e-4, 0.1, 25.0);
    let error = |tolerance: &str| {
        let last = format!("[[phase]]\nduration = {t:?}\ntolerance = {tolerance}\nvelocity = {v:?}\n");
        let phases = phase("approach = 1e-3", 0.0, (1.0, 1)) + &last;
        let run = Run::new(&scene("[4, 4]", FLAT, &wear("body", "archard", k), &phases)).done();
        let (time, force) = (run.history("time"), run.history("normal_force"));
        let first = time.iter().position(|time| (time - 1.0).abs() < 1e-9).unwrap();
        println!("{tolerance}: {} steps", force.len());
        force[force.len() - 1] / force[first] / (-k * v * t / C0).exp() - 1.0
    };
    let [loose, tight] = [error("1e-3"), error("1e-5")];
    println!("{loose:e} {tight:e}");
    assert!(loose.abs() < 2.2e-2 && tight.abs() < 2.5e-3);
}

/// Held by a load and pulled by a spring, an indenter that wears slides on: the spring's force is f N and what the slope meets, the volume k N
/// times the way against the face.
#[test]
fn a_mounted_indenter_wears() {
    let mount = "[mount]\nnormal = { stiffness = 800.0, load = 0.3 }\ntangential = { stiffness = 50.0 }\n";
    let indenter = "profile = \"harmonic\"\namplitude = 2e-5\nwavelength = 1.0";
    let phases = phase("approach = 1e-4", 0.0, (1.0, 2)) + &phase("", 0.05, (4.0, 40));
    for of in PARTS {
        let run =
            Run::new(&scene("[32, 8]", indenter, &format!("{COULOMB}\n{mount}{}", wear(of, "archard", 1e-3)), &phases))
                .done();
        let [n, q, h, s] =
            ["normal_force", "tangential_force", "hysteretic_force", "sliding"].map(|name| run.history(name));
        let (volume, far) = (run.history("worn_volume"), run.history("mount_tangential"));
        let last = n.len() - 1;
        assert!((q[last] / (0.3 * n[last]) - 1.0).abs() < 1e-9);
        assert!((50.0 * (far[last] - s[last]) - q[last] - h[last]).abs() < 1e-8 * q[last]);
        // The face goes along by Q H/G.
        let way: f64 = (1..=last).map(|i| n[i] * (s[i] - s[i - 1] - (q[i] - q[i - 1]) / G)).sum();
        println!("{of}: {:e} {:e}", volume[last], 1e-3 * way);
        assert!((volume[last] / (1e-3 * way) - 1.0).abs() < 1e-4);
    }
}

/// A large periodic face without friction, which would else be solved for its pressures alone, wears as one with no friction to speak of: its
/// slip counts.
#[test]
fn a_large_face_without_friction_wears() {
    let indenter = "profile = \"waves\"\namplitude = 2e-5\nwavelength = 1.0";
    let phases = phase("approach = 5e-5", 0.0, (1.0, 1)) + &phase("", 0.1, (2.0, 4));
    let text = scene("[24, 24, 4]", indenter, &wear("indenter", "archard", 1e-2), &phases);
    let text = text.replace("width = 1.0", "width = [1.0, 1.0]").replace("1e-12", "1e-10");
    let [without, with] = [text.clone(), text + "\n[friction]\nlaw = \"coulomb\"\ncoefficient = 0.0\n"]
        .map(|text| Run::new(&text).done());
    for column in ["normal_force", "worn_volume", "hysteretic_force"] {
        let [a, b] = [&without, &with].map(|run| run.history(column));
        let largest = a.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
        assert!(
            largest > 0.0 && a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-8 * largest),
            "{column}: {a:?} {b:?}"
        );
    }
}
