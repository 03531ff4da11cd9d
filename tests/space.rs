//! Scenes in space: against the plane, against all unknowns at once, by symmetry, and by what depends on the path.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::compare::difference;
use common::program::{Outcome, Run, ends_with, program, solved};
use common::scene::{COSINE, DRAG, TWO_ARMS, Text, WAVE, coulomb, layer, paraboloid, regularised};

/// A cosine pressed beyond full contact of its middle, slid, and lifted again.
static SCENE: Text = Text::new(|| {
    let layer = layer("1.0", "0.7", "[20, 8]") + "grading = 2.0\n";
    let rest = "[solver]\ntolerance = 1e-12\n[output]\nbulk_at = [\"slide\"]\n";
    [&layer, TWO_ARMS, COSINE, &coulomb("0.3"), WAVE, rest].concat()
});

/// The same in space: of a width along y of 0.3 m.
const ACROSS: f64 = 0.3;
const IN_SPACE: [&str; 2] = ["layer.width=[1.0,0.3]", "layer.cells=[20,4,8]"];

/// A profile that does not depend on y gives the histories of the plane, times the width, to 1e-9: for every law, rule and
/// memory, exact laws and penalties, nodes and Gauss points, either strategy, sides of any kind along x and no traction on rollers
/// along y.
#[test]
fn a_profile_without_y_is_the_plane() {
    const TANH: &str = "friction={ law = \"coulomb_tanh\", coefficient = 0.3, regularisation = 1e-3 }";
    const ELASTIC: &str = "friction={ law = \"coulomb_elastic_slip\", coefficient = 0.3, elastic_slip = 1e-6 }";
    const PENALTY: &str = "contact.penalty=1e6";
    const BULK: &str = "material.poisson_rule=constant_bulk_modulus";
    const MONOLITHIC: &str = "solver.strategy=monolithic";
    const LOOSER: &str = "solver.tolerance=1e-11";
    let cases: [&[&str]; 12] = [
        &[],
        &["friction.coefficient=0.0"],
        &[BULK],
        &[BULK, "material.memory=backward_euler"],
        &["material.arms=[]"],
        &[PENALTY, TANH],
        &[PENALTY, ELASTIC, BULK],
        &[PENALTY, TANH, "contact.quadrature=gauss"],
        &["layer.sides=free"],
        &[BULK, "layer.sides=roller"],
        &[PENALTY, TANH, MONOLITHIC, LOOSER],
        &[PENALTY, TANH, MONOLITHIC, LOOSER, BULK, "contact.quadrature=gauss"],
    ];
    for case in cases {
        let plane = solved(&SCENE, case);
        let mut changes = [case, &IN_SPACE].concat();
        // Along y the body is held as the plane is.
        let sides = case.iter().find_map(|change| change.strip_prefix("layer.sides="));
        let both = sides.map(|sides| format!("layer.sides=[\"{sides}\",\"roller\"]"));
        changes.extend(both.as_deref());
        let space = solved(&SCENE, &changes);
        for column in ["normal_force", "tangential_force", "hysteretic_force", "contact_fraction", "stick_fraction"] {
            let width = if column.ends_with("force") { ACROSS } else { 1.0 };
            let flat: Vec<f64> = plane.history(column).iter().map(|value| value * width).collect();
            if flat.iter().any(|value| value.abs() > 1e-12) {
                let apart = difference(&flat, &space.history(column));
                assert!(apart < 1e-9, "{case:?} {column}: {apart:.1e}");
            }
            let across = space.results().history_along(column, 1).unwrap();
            let largest = flat.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            assert!(across.iter().all(|value| value.abs() <= 1e-9 * largest), "{case:?} {column} along y");
        }
        let stress = |outcome: &Outcome, component: usize, of: usize| -> f64 {
            let stress = outcome.results().bulk("stress").unwrap().values;
            stress.iter().skip(component).step_by(of).fold(0.0_f64, |most, value| most.max(value.abs()))
        };
        // xx, zz, yy, xz of the plane are the components 0, 2, 1, 5 of space.
        for (flat, solid) in [(0, 0), (1, 2), (2, 1), (3, 5)] {
            let apart = stress(&plane, flat, 4) / stress(&space, solid, 6) - 1.0;
            assert!(apart.abs() < 1e-8, "{case:?}, stress {flat}: {apart:.1e}");
        }
    }
}

/// A sphere pressed into a layer and dragged obliquely.
static SPHERE: Text = Text::new(|| {
    let (layer, paraboloid) = (layer("[1.0, 1.0]", "0.5", "[12, 12, 6]"), paraboloid("[0.5, 0.5]"));
    [&layer, TWO_ARMS, &paraboloid, &regularised("1e5", "0.3"), DRAG, "[solver]\ntolerance = 1e-11\n"].concat()
});

/// Both strategies solve the same equations: forces, energies and fields agree to 1e-8, for both rules, on
/// periodic and on free sides, at nodes and at Gauss points.
#[test]
fn condensed_is_the_same_discrete_solution_in_space() {
    let cases: [&[&str]; 5] = [
        &[],
        &["material.poisson_rule=constant_bulk_modulus"],
        &["layer.sides=free"],
        &["layer.sides=[\"fixed\",\"periodic\"]", "material.poisson_rule=constant_bulk_modulus"],
        &["contact.quadrature=gauss", "layer.sides=roller"],
    ];
    for case in cases {
        let face = solved(&SPHERE, case);
        for ranks in [1, 3] {
            let run = Run::new(&SPHERE).set("solver.strategy=monolithic").ranks(ranks);
            let whole = case.iter().fold(run, |run, change| run.set(*change)).done();
            for column in ["normal_force", "tangential_force", "hysteretic_force", "energy/stored"] {
                let apart = difference(&whole.history(column), &face.history(column));
                assert!(apart < 1e-8, "{case:?} on {ranks}, {column}: {apart:.1e}");
            }
            let [a, b] = [&whole, &face].map(|run| run.results().history_along("tangential_force", 1).unwrap());
            assert!(difference(&a, &b) < 1e-8, "{case:?} on {ranks}");
            for field in ["pressure", "shear", "displacement"] {
                let [a, b] = [&whole, &face].map(|run| run.results().interface(field).unwrap().values);
                assert!(difference(&a, &b) < 1e-8, "{case:?} on {ranks}, {field}: {:.1e}", difference(&a, &b));
            }
        }
    }
}

/// A body whose factor no machine has the memory for, some 500 n^(4/3) bytes for 7 million unknowns, is refused by `check` and `run` before
/// any is taken, with the remedy.
#[test]
fn bodies_beyond_the_memory_are_refused() {
    for command in ["check", "run"] {
        let run = Run::new(&SPHERE);
        let large = ["--set", "layer.sides=free", "--set", "layer.cells=[200,200,60]"];
        let mut program = program(1);
        program.current_dir(run.directory()).args([command, "scene.toml"]).args(large);
        let message = ends_with(&mut program, 2);
        assert!(message.contains("layer.cells: needs about "), "{command}: {message}");
        assert!(message.contains("or sides that are periodic along x and y"), "{command}: {message}");
    }
}

/// What is done along y instead of x does along y what it did along x: exact laws, to 1e-9.
#[test]
fn x_and_y_are_alike() {
    let exact = ["contact={}", "friction={ law = \"coulomb\", coefficient = 0.3 }", "solver.tolerance=1e-12"];
    let along = |direction: &str| {
        let velocity = format!("phase.drag.velocity={direction}");
        solved(&SPHERE, &[&exact[..], &[&velocity]].concat())
    };
    let (x, y) = (along("[0.1,0.0]"), along("[0.0,0.1]"));
    assert!(difference(&x.history("normal_force"), &y.history("normal_force")) < 1e-9);
    for column in ["tangential_force", "hysteretic_force"] {
        let [a, b] = [(&x, 0), (&y, 1)].map(|(run, direction)| run.results().history_along(column, direction).unwrap());
        assert!(difference(&a, &b) < 1e-9, "{column}");
        let [a, b] = [(&x, 1), (&y, 0)].map(|(run, direction)| run.results().history_along(column, direction).unwrap());
        let largest = x.history(column).iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        assert!(a.iter().chain(&b).all(|value| value.abs() < 1e-9 * largest), "{column} across");
    }
}

/// Where a stiff wave is in full contact and slides obliquely, the shear on the layer is along the velocity, coefficient times the
/// load, to 1e-4: friction is a vector, not two laws. What is left is the layer's own motion, of the order of its strain.
#[test]
fn friction_is_along_the_slip() {
    let changes = [
        "contact={}",
        "friction={ law = \"coulomb\", coefficient = 0.3 }",
        "indenter={ profile = \"waves\", amplitude = [1e-6, 2e-6], wavelength = 1.0 }",
        "phase.press.approach=1e-3",
        "phase.drag.steps=20",
    ];
    let run = solved(&SPHERE, &changes);
    let [x, y] = [0, 1].map(|direction| run.results().history_along("tangential_force", direction).unwrap());
    let ([x, y], n) = ([x, y].map(|q| *q.last().unwrap()), run.last("normal_force"));
    assert_eq!(run.last("contact_fraction"), 1.0);
    assert!((y / x - 0.5).abs() < 1e-4, "{}", y / x);
    assert!((x.hypot(y) / (0.3 * n) - 1.0).abs() < 1e-4, "{}", x.hypot(y) / (0.3 * n));
}

/// The path matters: once the slide turns from x to y, in partial slip Q_x falls from what it was while Q_y rises, and |Q| stays
/// below coefficient times the load. Directions treated apart would leave Q_x where it was.
#[test]
fn sliding_that_turns_a_corner() {
    let turn = r#"
[[phase]]
name = "turn"
velocity = [0.0, 0.02]
distance = 0.012
steps = 12
"#;
    let scene = SPHERE.replace("[solver]", &format!("{turn}[solver]"));
    let slow = ["contact={}", "friction={ law = \"coulomb\", coefficient = 0.3 }", "material.arms=[]"];
    let path = ["phase.drag.velocity=[0.02,0.0]", "phase.drag.distance=0.012", "phase.drag.steps=12"];
    let run = solved(&scene, &[&slow[..], &path].concat());
    let [x, y] = [0, 1].map(|direction| run.results().history_along("tangential_force", direction).unwrap());
    let (n, corner) = (run.history("normal_force"), 4 + 12);
    assert!(y[corner].abs() < 1e-6 * x[corner]);
    for row in corner + 1..x.len() {
        assert!(x[row] < x[row - 1] && y[row] > y[row - 1], "{row}: {} {}", x[row], y[row]);
        assert!(x[row].hypot(y[row]) <= 0.3 * n[row] * (1.0 + 1e-9));
    }
    assert!(x[x.len() - 1] < 0.8 * x[corner] && y[y.len() - 1] > 0.5 * x[corner]);
}

/// The same numbers on one rank and three, under a rough surface, too, which is made from a seed.
#[test]
fn ranks_agree_in_space() {
    let rough = "indenter={ profile = \"rough\", hurst = 0.8, rms_slope = 0.05, shortest = 0.2, longest = 0.5, period = 1.0, seed = 3 }";
    for changes in [&["solver.tolerance=1e-12"][..], &[rough, "contact={}", "solver.tolerance=1e-12"]] {
        let [one, three] = [1, 3]
            .map(|ranks| changes.iter().fold(Run::new(&SPHERE).ranks(ranks), |run, change| run.set(*change)).done());
        for column in ["normal_force", "tangential_force", "energy/imbalance"] {
            assert_eq!(one.history(column), three.history(column), "{column}");
        }
        let partial = one.last("contact_fraction");
        assert!(partial > 0.0 && partial < 1.0);
    }
}

/// Without friction the pressures of a large periodic face are found by conjugate gradients, with a coefficient of 0 by Newton's method:
/// to a tolerance of 1e-12 both are the same to 1e-10, of a rough profile that is pressed, slid and lifted, without penetration and with a
/// penalty, whatever the memory, in space and in the plane; and at the default tolerance a step takes three runs of them at most, each
/// counted as a step of Newton's method.
#[test]
fn pressures_alone_are_what_newton_finds() {
    const SPACE: [&str; 2] = ["layer.width=[1.0,1.0]", "layer.cells=[24,24,6]"];
    const ROUGH: &str =
        "indenter={ profile = \"rough\", hurst = 0.8, rms_slope = 2e-3, shortest = 0.25, longest = 1.0, seed = 3 }";
    const BULK: &str = "material.poisson_rule=constant_bulk_modulus";
    const PENALTY: &str = "contact.penalty=1e6";
    let cases: [&[&str]; 4] = [
        &[SPACE[0], SPACE[1], ROUGH],
        &[SPACE[0], SPACE[1], ROUGH, PENALTY],
        &[SPACE[0], SPACE[1], ROUGH, BULK],
        &["layer.cells=[640,4]", ROUGH],
    ];
    let text =
        SCENE.replace("[friction]\nlaw = \"coulomb\"\ncoefficient = 0.3\n", "").replace("bulk_at = [\"slide\"]", "");
    let newton = SCENE.replace("coefficient = 0.3", "coefficient = 0.0").replace("bulk_at = [\"slide\"]", "");
    for case in cases {
        let (alone, newton) = (solved(&text, case), solved(&newton, case));
        for name in ["normal_force", "contact_fraction", "energy/stored"] {
            let (a, b) = (alone.history(name), newton.history(name));
            assert!(difference(&a, &b) < 1e-10, "{case:?} {name}: {}", difference(&a, &b));
        }
        let counted = solved(&text, &[case, &["solver.tolerance=1e-8"]].concat()).history("newton_iterations");
        assert!(counted.iter().all(|count| *count <= 3.0), "{case:?}: {counted:?}");
    }
}
