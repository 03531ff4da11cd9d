//! The condensed strategy gives the history of the monolithic one (they solve the same discrete equations) to
//! 1e-8 relative: for every material rule, side condition, memory, quadrature and friction law.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::compare::difference;
use common::program::{Outcome, Run};
use common::scene::{COSINE, TWO_ARMS, Text, WAVE, layer, regularised};

/// A layer pressed beyond full contact of its middle, slid, and lifted again.
static SCENE: Text = Text::new(|| {
    let layer = layer("1.0", "0.7", "[20, 12]") + "grading = 2.0\n";
    let phases = WAVE.replace("distance = 0.4\nsteps = 6", "distance = 0.5\nsteps = 10");
    let rest = "[solver]\ntolerance = 1e-11\n[output]\nbulk_at = [\"indent\", 2.345]\n";
    [&layer, TWO_ARMS, COSINE, &regularised("1e6", "0.3"), &phases, rest].concat()
});

#[test]
fn condensed_is_the_same_discrete_solution() {
    let mut cases = Vec::new();
    for sides in ["periodic", "free", "roller", "fixed"] {
        for rule in ["constant_ratio", "constant_bulk_modulus"] {
            cases.push(vec![format!("layer.sides={sides}"), format!("material.poisson_rule={rule}")]);
        }
    }
    // So large a face that its linear systems are solved by iteration. Round-off keeps all unknowns at once from less.
    cases.push(vec!["layer.cells=[640,4]".to_owned(), "solver.tolerance=1e-10".to_owned()]);
    for change in ["material.memory=backward_euler", "contact.quadrature=gauss", "material.arms=[]", "friction=none"] {
        for rule in ["constant_ratio", "constant_bulk_modulus"] {
            cases.push(vec![change.to_owned(), format!("material.poisson_rule={rule}"), "layer.sides=free".into()]);
        }
    }
    for rule in ["constant_ratio", "constant_bulk_modulus"] {
        let rule = format!("material.poisson_rule={rule}");
        let friction = "friction={ law = \"coulomb_elastic_slip\", coefficient = 0.3, elastic_slip = 1e-6 }".to_owned();
        cases.push(vec![friction.clone(), rule.clone()]);
        cases.push(vec![friction, rule, "contact.penalty=1e11".into()]);
    }
    let arms = "material.bulk_arms=[{ weight = 0.2, time = 0.05 }, { weight = 0.3, time = 2.0 }]";
    cases.push(vec!["material.poisson_rule=bulk_arms".into(), arms.into()]);
    for case in cases {
        // A table cannot be taken out by --set; a coefficient of zero is the frictionless law.
        let case: Vec<String> =
            case.iter().map(|change| change.replace("friction=none", "friction.coefficient=0.0")).collect();
        let solved = ["monolithic", "condensed"].map(|strategy| {
            let run = Run::new(&SCENE).set(format!("solver.strategy={strategy}"));
            case.iter().fold(run, |run, change| run.set(change)).done()
        });
        let [whole, face] = solved.each_ref().map(Outcome::results);
        for column in ["normal_force", "tangential_force", "hysteretic_force", "contact_fraction", "stick_fraction"] {
            let (a, b) = (whole.history(column).unwrap(), face.history(column).unwrap());
            if a.iter().any(|x| x.abs() > 1e-12) {
                assert!(difference(&a, &b) < 1e-8, "{case:?} {column}: {:.1e}", difference(&a, &b));
            }
        }
        let work = whole.history("energy/external_work").unwrap();
        for term in
            ["external_work", "stored", "viscoelastic_dissipation", "friction_dissipation", "penalty", "imbalance"]
        {
            let [a, b] = [&whole, &face].map(|results| results.history(&format!("energy/{term}")).unwrap());
            let apart = a.iter().zip(&b).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
            let largest = work.iter().fold(0.0_f64, |most, work| most.max(work.abs()));
            assert!(apart < 1e-8 * largest, "{case:?} {term}: {:.1e}", apart / largest);
        }
        for field in ["pressure", "displacement_x", "displacement_z"] {
            let (a, b) = (whole.interface(field).unwrap(), face.interface(field).unwrap());
            assert!(difference(&a.values, &b.values) < 1e-8, "{case:?} {field}");
        }
        for field in ["displacement", "stress"] {
            let (a, b) = (whole.bulk(field).unwrap(), face.bulk(field).unwrap());
            assert!(difference(&a.values, &b.values) < 1e-8, "{case:?} {field}");
        }
    }
}
