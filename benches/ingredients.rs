//! What each part of the model that a scene may opt into costs beside the bare elastic frictionless scene:
//! `cargo bench --bench ingredients [-- CELLS]`, one rank, 128 x 128 cells by default.
//!
//! Ratios of the time per step, under both strategies. Each row adds one ingredient to the bare scene.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::time::Instant;

use mpjr::petsc::Session;
use mpjr::scene::{self, Source};
use mpjr::solution;

/// A free-sided block pressed, and slid along.
const BARE: &str = r#"
[layer]
width = 1.0
depth = 0.5
cells = [CELLS, CELLS]
sides = "free"
[material]
shear_modulus = 500.0
poisson_ratio = 0.3
[indenter]
profile = "parabola"
radius = 4.0
centre = 0.4
[contact]
penalty = 1e6
[[phase]]
name = "press"
duration = 1.0
steps = 5
approach = 2e-3
[[phase]]
name = "slide"
velocity = 0.05
distance = 0.1
steps = 15
[friction]
[output]
energy = false
"#;

fn main() {
    let cells = std::env::args().find_map(|word| word.parse::<usize>().ok()).unwrap_or(128);
    let session = Session::start(&[]).unwrap();
    println!("{cells} x {cells} cells, free sides, one rank; times in s, ratios to the bare scene's step");
    println!(
        "{:>28} {:>10} {:>9} {:>7} {:>11} {:>9} {:>7}",
        "", "condensed", "step", "ratio", "monolithic", "step", "ratio"
    );
    let mut bare = [f64::NAN; 2];
    for (name, text) in rows() {
        print!("{name:>28}");
        for (strategy, bare) in ["condensed", "monolithic"].iter().zip(&mut bare) {
            if text.contains("coupled = true") && *strategy == "monolithic" {
                print!(" {:>10} {:>9} {:>7}", "-", "-", "-");
                continue;
            }
            let overrides = vec![format!("solver.strategy={strategy}")];
            let source = Source { file: "ingredients.toml".into(), overrides };
            let scene = scene::read(&text.replace("CELLS", &cells.to_string()), &source).unwrap();
            let begun = Instant::now();
            let counts = solution::solve(&session.world(), &scene).unwrap().counts;
            let set_up = (begun.elapsed() - counts.total).as_secs_f64();
            let step = counts.total.as_secs_f64() / counts.steps as f64;
            if bare.is_nan() {
                *bare = step;
            }
            print!(" {set_up:>10.2e} {step:>9.2e} {:>7.2}", step / *bare);
        }
        println!();
    }
}

/// Name and scene of each row, the bare one first.
fn rows() -> Vec<(String, String)> {
    let bare = BARE.replace("[friction]\n", "");
    let arms = |count: usize, rule: &str| {
        let arm =
            |i: usize| format!("{{ weight = {:?}, time = {:?} }}", 0.6 / count as f64, 0.02 * 2.0_f64.powi(i as i32));
        let list = (0..count).map(arm).collect::<Vec<_>>().join(", ");
        bare.replace("[indenter]", &format!("arms = [ {list} ]\npoisson_rule = \"{rule}\"\n[indenter]"))
    };
    let friction = "[friction]\nlaw = \"coulomb_tanh\"\ncoefficient = 0.3\nregularisation = 1e-3\n";
    let mut rows = vec![("elastic, frictionless".to_owned(), bare.clone())];
    for count in [1, 2, 3, 10] {
        rows.push((format!("arms: {count}"), arms(count, "constant_ratio")));
    }
    rows.push(("arms: 3, constant bulk".to_owned(), arms(3, "constant_bulk_modulus")));
    for coupled in [false, true] {
        let name = if coupled { "the same, coupled" } else { "arms: 3, heat" };
        let heat = format!(
            "conductivity = 0.2\nheat_capacity = 2.0\nshift = \"arrhenius\"\nactivation_energy = 8e4\nreference_temperature = 293.0\n\
             temperature = 293.0\n[heat]\ninitial = 293.0\nbase = 303.0\ncoupled = {coupled}\n[indenter]"
        );
        rows.push((name.to_owned(), arms(3, "constant_ratio").replace("[indenter]", &heat)));
    }
    rows.push(("friction".to_owned(), BARE.replace("[friction]\n", friction)));
    rows.push(("Gauss quadrature".to_owned(), bare.replace("penalty = 1e6", "penalty = 1e6\nquadrature = \"gauss\"")));
    rows.push(("energy".to_owned(), bare.replace("energy = false", "energy = true")));
    rows.push(("B-bar".to_owned(), bare.replace("sides = ", "element = \"q4_bbar\"\nsides = ")));
    rows.push((
        "bulk fields, 4 moments".to_owned(),
        bare.replace("[output]", "[output]\nbulk_at = [0.5, \"press\", 2.0, \"slide\"]"),
    ));
    rows
}
