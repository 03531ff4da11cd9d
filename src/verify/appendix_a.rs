//! Appendix A of the paper, figures A1 to A3: a cylinder on a half disk, pressed and moved to and fro.

use super::{Case, Row, Subject};
use crate::error::Result;
use crate::oracle::half_disk::HalfDisk;
use crate::oracle::line_contact::Oscillation;
use crate::scene::{self, Source};
use crate::solution::Solution;

const SCENE: &str = include_str!("../../runs/appendix-a-bbar.toml");
const MESH: &[u8] = include_bytes!("../../meshes/half_disk.msh");

/// Of the scene.
const DISK: HalfDisk = HalfDisk { modulus: 814.7, poisson: 0.49, radius: 5.0, indenter: 1.0 };
const FRICTION: f64 = 0.2;
const APPROACH: f64 = 1e-3;

pub fn cases() -> Result<Vec<Case>> {
    let scene = scene::read(SCENE, &Source { file: "appendix-a-bbar.toml".into(), overrides: Vec::new() })?;
    Ok(vec![Case {
        name: "Appendix A, half disk, nu = 0.49, B-bar".into(),
        source: "the paper, (A4) to (A6), with the compliances of the disk",
        subjects: vec![Subject::Scene(Box::new(scene), MESH)],
        compare: Box::new(|solutions: &[Solution]| Ok(rows(&solutions[0]))),
    }])
}

fn rows(solution: &Solution) -> Vec<Row> {
    let (normal, tangential) = (DISK.normal(), DISK.tangential());
    let force = normal.force(APPROACH);
    let sway = tangential.displacement(force);
    let mut contact = Oscillation::new(|d| tangential.force(d), sway, FRICTION);
    let (mut rise, mut loop_error, mut drift) = (0.0f64, 0.0f64, 0.0f64);
    let held = solution.end_of(0).normal_force;
    for row in &solution.history {
        if row.phase == 0 {
            rise = rise.max((row.normal_force - normal.force(row.approach)).abs() / force);
        } else {
            let exact = contact.advance(row.sliding);
            loop_error = loop_error.max((row.tangential_force - exact).abs() / (FRICTION * force));
            drift = drift.max((row.normal_force / held - 1.0).abs());
        }
    }
    let first = solution.history.iter().map(|row| row.tangential_force).fold(0.0, f64::max);
    let mut fresh = Oscillation::new(|d| tangential.force(d), sway, FRICTION);
    vec![
        Row::relative("N_z at full approach, N/m", [held, force], 0.01, MESH_OF_26),
        Row::new("largest error of N_z(D), of N_z at the end", [rise, 0.0], 0.01, MESH_OF_26),
        Row::relative("Q_x at the first turn, N/m", [first, fresh.advance(FRICTION * APPROACH)], 0.02, MESH_OF_26),
        Row::new("largest error of Q_x over the cycle, of f N_z", [loop_error, 0.0], 0.01, MESH_OF_26),
        Row::new("largest change of N_z over the cycle, of N_z", [drift, 0.0], BETA * FRICTION, "coupling: f beta"),
    ]
}

const MESH_OF_26: &str = "mesh: 26 cells in contact, 30 to the arc";
/// Dundurs' (1 - 2 nu)/(2 (1 - nu)).
const BETA: f64 = (1.0 - 2.0 * DISK.poisson) / (2.0 * (1.0 - DISK.poisson));
