//! Forces and mounts that hold the indenter, with all unknowns at once: its place is one of them.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::loads::PHASES;
use common::program::{Outcome, Run};
use common::scene::{TWO_ARMS, Text, layer, regularised};

/// A layer of two arms under a wave, with laws that are regularised.
static LAYER: Text = Text::new(|| {
    let indenter = "[indenter]\nprofile = \"expression\"\nformula = \"1e-3+5e-4*(1-cos(2*pi*x))\"\n";
    let laws = regularised("1e6", "0.2");
    [&layer("1.0", "1.0", "[32, 16]"), TWO_ARMS, indenter, &laws, "[solver]\ntolerance = 1e-11\n"].concat()
});

/// Masses on springs and dashpots, lowered, slid and turned round.
const MOUNTS: &str = r#"
[mount]
normal = { stiffness = 400.0, damping = 20.0, mass = 5.0, load = 0.1 }
tangential = { stiffness = 50.0, damping = 2.0, mass = 0.5 }
[[phase]]
name = "lower"
duration = 1.0
steps = 10
approach = 2.5e-3
[[phase]]
name = "slide"
velocity = 0.02
duration = 2.0
steps = 20
[[phase]]
name = "back"
velocity = -0.05
duration = 1.0
steps = 10
"#;

/// A sphere on a box whose sides are free one way, by a mass on springs.
const SPACE: &str = r#"
[layer]
width = [0.02, 0.02]
depth = 0.008
cells = [8, 8, 4]
sides = ["periodic", "free"]
[material]
shear_modulus = 1e6
poisson_ratio = 0.4
arms = [ { weight = 0.4, time = 0.01 }, { weight = 0.3, time = 0.1 } ]
poisson_rule = "constant_bulk_modulus"
[indenter]
profile = "sphere"
radius = 0.01
centre = [0.0103, 0.0098]
[contact]
penalty = 1e10
[friction]
law = "coulomb_elastic_slip"
coefficient = 0.5
elastic_slip = 1e-4
[mount]
normal = { stiffness = 4000.0, damping = 2.0, mass = 0.05, load = 0.1 }
tangential = { stiffness = 500.0, damping = 0.2, mass = 0.005 }
[solver]
tolerance = 1e-11
[[phase]]
name = "press"
duration = 0.5
steps = 6
approach = 2e-4
[[phase]]
name = "drag"
velocity = [0.02, 0.01]
distance = 0.004
steps = 8
"#;

const ELASTIC_SLIP: &str = "friction={ law = \"coulomb_elastic_slip\", coefficient = 0.3, elastic_slip = 1e-5 }";
const BULK: &str = "material.poisson_rule=constant_bulk_modulus";

/// Every column of the history of two runs, to `within` of its largest value; energies of the work.
fn assert_alike(one: &Outcome, other: &Outcome, within: f64, what: &str) {
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let compare = |column: &str, size: Option<f64>| {
        let (Ok(a), Ok(b)) = (one.results().history(column), other.results().history(column)) else { return };
        let apart = a.iter().zip(&b).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        let size = size.unwrap_or_else(|| largest(&b));
        assert!(a.len() == b.len() && apart <= within * size, "{what}: {column}: {:.1e}", apart / size);
    };
    for column in ["approach", "sliding", "normal_force", "tangential_force", "hysteretic_force"] {
        compare(column, None);
    }
    let work = largest(&other.history("energy/external_work"));
    let kept = ["external_work", "stored", "viscoelastic_dissipation", "friction_dissipation", "penalty", "imbalance"];
    for term in kept.into_iter().chain(["mount_spring", "mount_dashpot", "kinetic"]) {
        compare(&format!("energy/{term}"), Some(work));
    }
}

/// Both strategies solve the same discrete equations: forces, mounts with masses, by both laws, rules, quadratures, side conditions, in the
/// plane and in space, gentle laws (met by Newton's method on displacements from where the face was) and stiff ones; on one rank and on
/// three. Histories and energies agree to 1e-8.
#[test]
fn both_strategies_hold_an_indenter_alike() {
    let gentle = ["contact.penalty=3e4", "friction.regularisation=1e-2"];
    let softer = ["contact.penalty=1e9", "friction.elastic_slip=1e-3"];
    // So large a face that no start is sought for.
    let few = ["phase.lower.steps=4", "phase.slide.steps=6", "phase.back.steps=4"];
    let large = [&["layer.cells=[640,4]", "solver.tolerance=1e-10", "contact.penalty=3e4"][..], &few].concat();
    // Deepest in the middle: not on a clamped end.
    let middle = "indenter.formula=1e-3+5e-4*(1+cos(2*pi*x))";
    let fixed = [ELASTIC_SLIP, BULK, "layer.sides=fixed", "material.memory=backward_euler", middle];
    let kinked = [ELASTIC_SLIP, "indenter.formula=1e-3+2e-3*abs(x-0.5)", "layer.sides=roller"];
    let cases: [(&str, &str, &[&str], bool); 8] = [
        (&LAYER, PHASES, &[], true),
        (&LAYER, PHASES, &kinked, false),
        (&LAYER, PHASES, &[BULK, "contact.quadrature=gauss", "contact.penalty=3e4"], false),
        (&LAYER, MOUNTS, &gentle, true),
        (&LAYER, MOUNTS, &fixed, false),
        (&LAYER, MOUNTS, &large, false),
        (SPACE, "", &[], true),
        (SPACE, "", &softer, false),
    ];
    for (scene, loading, sets, ranks) in cases {
        // At no force every place that is out of touch is a solution.
        let scene = format!("{scene}{loading}").replace("normal_force = 0.0", "normal_force = 0.02");
        let by = |strategy: &str, ranks: usize| {
            let run = Run::new(&scene).set(format!("solver.strategy={strategy}")).ranks(ranks);
            sets.iter().fold(run, |run, set| run.set(*set)).done()
        };
        let (whole, face) = (by("monolithic", 1), by("condensed", 1));
        assert_alike(&whole, &face, 1e-8, &format!("{sets:?}"));
        if ranks {
            assert_alike(&by("monolithic", 3), &whole, 1e-10, &format!("{sets:?} on three ranks"));
        }
    }
}

/// Newton's method on displacements and places together converges quadratically: from 1e-3 of the first residual on, each is at most 20 times the
/// square of the one before, over that, down to round-off, 1e-12. No step takes more than five iterations to 1e-11.
#[test]
fn places_converge_quadratically() {
    let scene = [&LAYER, MOUNTS].concat().replace("\"coulomb_tanh\"", "\"coulomb_elastic_slip\"");
    let run = Run::new(&scene.replace("regularisation = 1e-3", "elastic_slip = 1e-3"))
        .set("solver.strategy=monolithic")
        .set("contact.penalty=3e4")
        .petsc("-snes_monitor")
        .done();
    let norms = run.stdout.lines().filter_map(|line| {
        let (iteration, norm) = line.trim().split_once(" SNES Function norm ")?;
        Some((iteration.trim().parse::<usize>().ok()?, norm.trim().parse::<f64>().ok()?))
    });
    let (mut first, mut before, mut pairs, mut most) = (0.0, 0.0, 0, 0);
    for (iteration, norm) in norms {
        if iteration == 0 {
            first = norm;
        } else if before < 1e-3 * first {
            assert!(norm / first < 20.0 * (before / first).powi(2) + 1e-12, "{first:e} {before:e} {norm:e}");
            pairs += usize::from(before > 1e-6 * first);
        }
        (before, most) = (norm, most.max(iteration));
    }
    println!("{pairs} pairs, at most {most} iterations");
    assert!(pairs >= 5 && most <= 5, "{pairs} {most}");
}

/// The linear systems with places are the program's own: a preconditioner of PETSc's is refused, another Krylov method taken.
#[test]
fn a_preconditioner_of_petsc_is_refused() {
    let held = || Run::new(&[&*LAYER, MOUNTS].concat()).set("solver.strategy=monolithic");
    let outcome = held().petsc("-pc_type lu").run();
    assert_eq!(outcome.code, 2, "{}", outcome.stderr);
    outcome.assert_single_message("leave -pc_type out");
    held().petsc("-ksp_type gmres").done();
}
