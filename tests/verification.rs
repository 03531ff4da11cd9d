//! The whole program against solutions found in other ways: the numbers of an independent code (Fourier space, 512
//! nodes), the oracle (Fourier space and closed forms, nothing shared with the finite elements), Westergaard.
//!
//! Layer of 1 m by 1 m unless said otherwise, wavelength 1 m, g_0 = 5e-4 m, one arm (0.579, 0.817 s), approach 2 g_0.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::program::{Outcome, Run};
use mpjr::oracle::line_contact::{Westergaard, plane_strain_modulus};
use mpjr::oracle::steady::{Load, Sliding, Steady};
use mpjr::oracle::{Harmonic, Layer, PoissonRule, Solid};

const SLIDING: &str = include_str!("scenes/sliding.toml");
const PRESSING: &str = include_str!("scenes/pressing.toml");

/// Cells along each side at which the tables are met.
const CELLS: usize = 128;
const SURFACE: Harmonic = Harmonic { amplitude: 5e-4, wavelength: 1.0 };
const APPROACH: f64 = 1e-3;
const PENALTY: f64 = 1e6;

fn square(scene: &str, cells: usize) -> Run {
    Run::new(scene).set(format!("layer.cells=[{cells},{cells}]"))
}

fn off(found: f64, exact: f64) -> f64 {
    found / exact - 1.0
}

/// N_z at the end of indentation, N_z half way through the slide, Q_x at its end; `refine` times the steps.
fn transient(cells: usize, penalty: f64, memory: &str, refine: usize) -> [f64; 3] {
    let outcome = square(SLIDING, cells)
        .set(format!("contact.penalty={penalty:e}"))
        .set(format!("material.memory=\"{memory}\""))
        .set(format!("phase.indent.steps={}", 50 * refine))
        .set(format!("phase.slide.steps={}", 100 * refine))
        .set("output.interface_every=0")
        .done();
    let force = |time, column| outcome.at(time, column);
    [force(10.0, "normal_force"), force(15.0, "normal_force"), force(20.0, "tangential_force")]
}

/// The independent code's transient over a periodic layer, nu = 0, within 0.1 %. The fourth row's first number is printed
/// there as 0.33682; the oracle gives 0.33668 (src/oracle/transient_tests.rs), and so do the finite elements: both memories
/// converge to it as the steps shrink.
#[test]
fn transient_table() {
    for (penalty, memory, refine, expected) in [
        (1e6, "backward_euler", 1, [0.33654, 0.32214, 0.063960]),
        (1e6, "exponential", 1, [0.33668, 0.32177, 0.063932]),
        (1e6, "exponential", 4, [0.33668, 0.32176, 0.063930]),
        (1e8, "backward_euler", 1, [0.33681, 0.32241, 0.064010]),
    ] {
        let found = transient(CELLS, penalty, memory, refine);
        let apart = [0, 1, 2].map(|i| off(found[i], expected[i]));
        println!("{penalty:e} {memory} x{refine}: {found:.6?} off by {apart:.6?}");
        assert!(apart.iter().all(|e| e.abs() < 1e-3), "{penalty:e} {memory} x{refine}: {found:?}");
    }
}

/// The first row of the exponential memory is approached as the cells shrink: with 32, 64 and 128 cells each of the
/// three numbers comes within the bounds given, which fall by more than two each time.
#[test]
fn transient_table_is_approached() {
    let expected = [0.33668, 0.32177, 0.063932];
    for (cells, largest) in [(32, 3e-3), (64, 1e-3), (128, 4e-4)] {
        let found = transient(cells, PENALTY, "exponential", 1);
        let apart = [0, 1, 2].map(|i| off(found[i], expected[i]));
        println!("{cells} cells: {found:.6?} off by {apart:.6?}");
        assert!(apart.iter().all(|e| e.abs() < largest), "{cells} cells: {apart:?}");
    }
}

fn solid(rule: PoissonRule) -> Solid {
    Solid { shear: 568.498, poisson: 0.3, rule, arms: vec![(0.579, 0.817)] }
}

/// The exact steady state at the penalty of the scene.
fn sliding(velocity: f64, rule: PoissonRule) -> Sliding {
    let layer = Layer { depth: 1.0 };
    Sliding { layer, solid: solid(rule), width: 1.0, velocity, friction: 0.2, softness: 1.0 / PENALTY }
}

fn steady(velocity: f64, rule: PoissonRule) -> Steady {
    sliding(velocity, rule).solve(512, |x| SURFACE.at(x), Load::Approach(APPROACH)).unwrap()
}

/// Pressed in 10 s, then slid for `seconds` at two steps per cell; (N_z, integral of p h') over the last cell passed.
fn slid(cells: usize, velocity: f64, rule: &str, seconds: f64) -> [f64; 2] {
    slide(square(SLIDING, cells).set(format!("material.poisson_rule=\"{rule}\"")), (cells, 2), velocity, seconds)
}

/// The same of any scene with a face of `cells`, at `steps` per cell.
fn slide(scene: Run, (cells, steps): (usize, usize), velocity: f64, seconds: f64) -> [f64; 2] {
    let passed = (seconds * velocity * cells as f64).ceil();
    let outcome = scene
        .set("material.poisson_ratio=0.3")
        .set(format!("friction.regularisation={}", 0.01 * velocity))
        .set("phase.indent.steps=20")
        .set(format!("phase.slide.velocity={velocity}"))
        .set(format!("phase.slide.distance={}", passed / cells as f64))
        .set(format!("phase.slide.steps={}", steps * passed as usize))
        .set("output.interface_every=0")
        .done();
    mean_of_last(&outcome, steps)
}

/// The means of N_z and of the hysteretic force over the last rows.
fn mean_of_last(outcome: &Outcome, rows: usize) -> [f64; 2] {
    ["normal_force", "hysteretic_force"]
        .map(|column| outcome.history(column).iter().rev().take(rows).sum::<f64>() / rows as f64)
}

/// The independent code's fully slipping steady state, at 128 x 128 cells: N_z and the hysteretic coefficient within
/// 0.5 % of the table, which holds for a rigid contact (measured with 1e6 Pa/m: -0.13 %, -0.41 %), and much closer to the oracle at
/// this penalty (measured: N_z within 5e-6, the coefficient within 2.4e-4).
#[test]
fn steady_sliding_table() {
    for (velocity, normal, ratio, seconds) in [(2.154e-2, 0.49754, 2.195e-4, 30.0), (0.1, 0.53513, 6.839e-4, 20.0)] {
        let [n, p] = slid(CELLS, velocity, "constant_ratio", seconds);
        let exact = steady(velocity, PoissonRule::ConstantRatio);
        let apart =
            [off(n, normal), off(p / n, ratio), off(n, exact.normal), off(p / n, exact.hysteretic / exact.normal)];
        println!("v = {velocity}: N {n:.6}, ratio {:.4e}, off by {apart:.6?}", p / n);
        assert!(apart.iter().all(|e| e.abs() < 5e-3), "v = {velocity}: {apart:?}");
        assert!(apart[2].abs() < 5e-5 && apart[3].abs() < 1e-3, "v = {velocity}: {apart:?}");
    }
}

/// The independent code's whole table of fully slipping steady states, which is that of a rigid contact, without a penalty and with
/// Coulomb's law itself, at 128 nodes along the face (128 rows, the top one four times as fine as the lowest): N_z within 2e-4
/// and the hysteretic coefficient within 2e-3 (measured: 5e-5, and 1.9e-3, -1.8e-3, -5e-5, 2e-4, -9e-4 from slow to fast; rows
/// of equal height leave 3.5e-3 at 1 m/s, where the coefficient is what two hundred times as large ones leave of each other, and 64, 128
/// and 256 nodes -1.6e-2, 2e-4, -1e-4).
///
/// Slow sliding is that over the relaxed elastic layer. At infinite speed the arms feel the mean alone: the indenter jumps by 79 of 128
/// nodes a step, first in steps of 0.01 s for twenty relaxation times, then too fast for anything to relax, over all nodes once.
#[test]
fn rigid_steady_sliding_table() {
    let scene = || {
        ["contact.penalty=", "friction.law=coulomb", "friction.regularisation=", "material.poisson_ratio=0.3"]
            .into_iter()
            .chain(["layer.cells=[128,128]", "layer.grading=4.0", "phase.indent.steps=20", "output.interface_every=0"])
            .fold(Run::new(SLIDING), |run, change| run.set(change))
    };
    let slide = |velocity: f64, distance: f64, steps: usize| {
        let set = [format!("velocity={velocity:e}"), format!("distance={distance:e}"), format!("steps={steps}")];
        set.into_iter().fold(scene(), |run, set| run.set(format!("phase.slide.{set}")))
    };
    let relaxed = format!("material.shear_modulus={}", 568.498 * (1.0 - 0.579));
    let jump = 79.0 / 128.0;
    let fast = format!(
        "phase=[{{duration=10.0,steps=20,approach=1e-3}},{{velocity={:e},duration=16.0,steps=1600}},\
         {{velocity={:e},duration=1.28e-4,steps=128}}]",
        jump / 1e-2,
        jump / 1e-6
    );
    for (name, run, rows, [normal, ratio]) in [
        ("0", slide(1.0, 1.0, 128).set("material.arms=[]").set(relaxed), 1, [0.49498, -1.138e-4]),
        ("2.154e-2", slide(2.154e-2, 0.5, 64), 1, [0.49754, 2.195e-4]),
        ("0.1", slide(0.1, 2.0, 256), 1, [0.53513, 6.839e-4]),
        ("1", slide(1.0, 16.0, 2048), 1, [0.59554, 0.583e-4]),
        ("infinity", scene().set(fast), 128, [0.59715, -1.017e-4]),
    ] {
        let [n, p] = mean_of_last(&run.done(), rows);
        let apart = [off(n, normal), off(p / n, ratio)];
        println!("v -> {name} m/s: N {n:.6}, ratio {:.4e}, off by {:.1e} {:.1e}", p / n, apart[0], apart[1]);
        assert!(apart[0].abs() < 2e-4 && apart[1].abs() < 2e-3, "v -> {name} m/s: {apart:?}");
    }
}

/// Fast sliding with a penalty of 1e8 Pa/m. Toward the limit of infinite speed, which the oracle meets (src/oracle/steady.rs), the
/// coefficient comes as 1/v: at 10 m/s it is 16 % off the limit's -1.017e-4, and the program is held to the oracle there (measured:
/// -0.9 %, -1.7 % with half the cells); N_z is within 0.5 % of the limit (measured: -0.05 %).
#[test]
fn fast_sliding() {
    let scene = Run::new(SLIDING).set("layer.cells=[128,32]").set("layer.grading=8.0").set("contact.penalty=1e8");
    let [n, p] = slide(scene, (128, 1), 10.0, 8.0);
    let exact = Sliding { softness: 1e-8, ..sliding(10.0, PoissonRule::ConstantRatio) };
    let exact = exact.solve(512, |x| SURFACE.at(x), Load::Approach(APPROACH)).unwrap();
    let ratio = exact.hysteretic / exact.normal;
    println!("v = 10 m/s: N {n:.6} ({:.6}), ratio {:.4e} ({ratio:.4e})", exact.normal, p / n);
    assert!(off(n, 0.59715).abs() < 5e-3 && off(p / n, ratio).abs() < 1e-2, "{n} {}", p / n);
}

/// The same at a constant bulk modulus, at 64 x 64 cells: 0.884 N/m in the table.
#[test]
fn steady_sliding_at_constant_bulk_modulus() {
    let [n, p] = slid(64, 0.1, "constant_bulk_modulus", 20.0);
    let exact = steady(0.1, PoissonRule::ConstantBulkModulus);
    let apart = [off(n, 0.884), off(n, exact.normal), off(p / n, exact.hysteretic / exact.normal)];
    println!("N {n:.6}, ratio {:.4e}, off by {apart:.6?}", p / n);
    assert!(apart.iter().all(|e| e.abs() < 5e-3), "{apart:?}");
}

/// Steady sliding at 0.1 m/s as the cells shrink with the steps. Measured against the oracle at 16, 32, 64, 128 cells:
/// N_z 2.7e-4, 6.0e-5, 6e-6, -5e-6 (second order, until the steps of half a cell show); hysteretic force 1.4e-3, 1.3e-3,
/// 5.6e-4, 2.2e-4 (uneven, as it hangs on where the edges of the contact lie between nodes).
#[test]
fn steady_sliding_converges() {
    let exact = steady(0.1, PoissonRule::ConstantRatio);
    let errors = [16, 32, 64, 128].map(|cells| {
        let [n, p] = slid(cells, 0.1, "constant_ratio", 20.0);
        [off(n, exact.normal), off(p, exact.hysteretic)].map(f64::abs)
    });
    println!("{errors:.6?}");
    let rate = |i: usize, fine: usize| (errors[0][i] / errors[fine][i]).log2() / fine as f64;
    assert!(rate(0, 1) > 1.7, "N_z from 16 to 32 cells: {errors:?}");
    assert!(errors[2][0] < 3e-5 && errors[3][0] < 3e-5, "N_z: {errors:?}");
    assert!(rate(1, 3) > 0.7 && errors[3][1] < 5e-4, "hysteretic force: {errors:?}");
}

/// Westergaard: no friction, elastic, three wavelengths deep. N_z for the approach from the oracle; contact width and
/// pressure for N_z from the closed form: the width to two cells, which are counted by nodes, the pressure in the mean
/// square, to first order in h because of the vertical slope at the edges.
#[test]
fn westergaard() {
    let young = 2.0 * 568.498 * 1.3;
    let wavy = Westergaard { modulus: plane_strain_modulus(young, 0.3), amplitude: 5e-4, wavelength: 1.0 };
    let elastic = Solid { arms: Vec::new(), ..solid(PoissonRule::ConstantRatio) };
    let deep = Sliding {
        layer: Layer { depth: 3.0 },
        solid: elastic,
        friction: 0.0,
        softness: 1e-8,
        ..sliding(0.0, PoissonRule::ConstantRatio)
    };
    let exact = deep.solve(512, |x| SURFACE.at(x), Load::Approach(1.5e-3)).unwrap();
    for (cells, largest) in [(32, 6e-2), (64, 3e-2), (128, 1.5e-2)] {
        let outcome = Run::new(PRESSING)
            .set("layer.depth=3.0")
            .set(format!("layer.cells=[{cells},{cells}]"))
            .set("layer.grading=8.0")
            .set("phase.indent.approach=1.5e-3")
            .set("contact.penalty=1e8")
            .done();
        let n = outcome.last("normal_force");
        let a = wavy.half_width(n);
        let width = outcome.last("contact_fraction");
        let field = outcome.results().interface("pressure").unwrap();
        let pressure = field.row(field.rows - 1);
        let (mut square, mut norm) = (0.0, 0.0);
        for (i, p) in pressure.iter().enumerate() {
            let x = i as f64 / cells as f64;
            let exact = wavy.pressure(n, if x > 0.5 { x - 1.0 } else { x });
            square += (p - exact).powi(2);
            norm += exact * exact;
        }
        let (apart, peak) = ((square / norm).sqrt(), off(pressure[0], wavy.pressure(n, 0.0)));
        println!(
            "{cells}: N off by {:.1e}; width {width} of {:.5}; pressure {apart:.2e}; peak {peak:.2e}",
            off(n, exact.normal),
            2.0 * a
        );
        assert!(off(n, exact.normal).abs() < 1e-4, "{cells}: N {n} instead of {}", exact.normal);
        assert!((width - 2.0 * a).abs() < 2.0 / cells as f64, "{cells}: {width} instead of {}", 2.0 * a);
        assert!(apart < largest && peak.abs() < 3e-3, "{cells}: pressure off by {apart:e}, peak by {peak:e}");
    }
}

/// Without sliding a symmetric scene has a symmetric answer: p(-x) = p(x), q(-x) = -q(x), Q_x = 0 and no hysteretic force,
/// all to round-off, with friction and memory.
#[test]
fn symmetric_scenes() {
    let centred = SLIDING
        .replace(
            "profile = \"harmonic\"\namplitude = 5e-4\nwavelength = 1.0",
            "profile = \"circle\"\nradius = 2.0\ncentre = 0.5",
        )
        .replace("sides = \"periodic\"", "sides = \"free\"");
    for (scene, rule) in [(SLIDING, "constant_ratio"), (&centred, "constant_bulk_modulus")] {
        let outcome = square(&scene.replace("velocity = 0.1\ndistance = 1.0", "duration = 1.0"), 24)
            .set("material.poisson_ratio=0.3")
            .set(format!("material.poisson_rule=\"{rule}\""))
            .set("phase.slide.steps=4")
            .done();
        let largest = outcome.history("normal_force").into_iter().fold(0.0, f64::max);
        for column in ["tangential_force", "hysteretic_force"] {
            let worst = outcome.history(column).iter().fold(0.0f64, |most, q| most.max(q.abs()));
            println!("{column} {:e}", worst / largest);
            assert!(worst < 1e-12 * largest, "{column}: {worst:e}");
        }
        for (name, sign) in [("pressure", 1.0), ("shear", -1.0), ("displacement_x", -1.0), ("displacement_z", 1.0)] {
            let field = outcome.results().interface(name).unwrap();
            let row = field.row(field.rows - 1);
            let n = row.len();
            // A periodic face has one node less: node 0 is its own image.
            let image = |i: usize| if n == 24 { (n - i) % n } else { n - 1 - i };
            // Tractions beside the pressure, displacements beside the approach.
            let largest = if name.starts_with("disp") { APPROACH } else { outcome.last("normal_force") };
            let worst = (0..n).fold(0.0f64, |most, i| most.max((row[i] - sign * row[image(i)]).abs()));
            println!("{name} {:e}", worst / largest);
            assert!(worst < 1e-11 * largest, "{name}: {worst:e} of {largest:e}");
        }
    }
}

/// Full contact: with D so large that the whole face touches, |integral of p h'| = (1/2) L k g_0^2 |Im 1/lambda(k)|,
/// lambda = C_zz + i f C_xz + 1/alpha (a bonded elastic layer in Fourier space), and N_z = (D - g_0)/lambda(0).
#[test]
fn full_contact() {
    let deep = 8e-3;
    let errors = [16, 32, 64].map(|cells| {
        let passed = 2 * cells;
        let outcome = square(SLIDING, cells)
            .set("material.poisson_ratio=0.3")
            .set(format!("phase.indent.approach={deep}"))
            .set("phase.slide.distance=2.0")
            .set(format!("phase.slide.steps={}", 2 * passed))
            .done();
        let exact = sliding(0.1, PoissonRule::ConstantRatio).full_contact(SURFACE, Load::Approach(deep)).unwrap();
        assert_eq!(outcome.last("contact_fraction"), 1.0);
        let [n, p] = mean_of_last(&outcome, 2);
        [off(n, exact.normal), off(p, exact.hysteretic)].map(f64::abs)
    });
    // The mean load is exact but for the solver's tolerance and what has not relaxed yet; measured 1e-7, and for the
    // hysteretic force 2.1e-3, 1.4e-4, 4e-5.
    println!("{errors:.7?}");
    assert!(errors.iter().all(|error| error[0] < 1e-5), "{errors:?}");
    assert!(errors[0][1] < 5e-3 && errors[1][1] < 5e-4 && errors[2][1] < 1e-4, "{errors:?}");
}
