//! Appendix A of the paper, figures A1 to A3: a cylinder pressed and moved to and fro, on a half disk that is fixed along
//! its arc, and on the half-plane that (A4) to (A6) are for.

use super::{Case, Row, Subject};
use crate::error::{Error, Result};
use crate::oracle::half_disk::{HalfDisk, Law};
use crate::oracle::line_contact::Oscillation;
use crate::scene::{self, Source};
use crate::solution::Solution;

const DISK_SCENE: (&str, &str) = ("appendix-a-bbar.toml", include_str!("../../runs/appendix-a-bbar.toml"));
const DISK_MESH: &[u8] = include_bytes!("../../meshes/half_disk.msh");
const PLANE_SCENE: (&str, &str) = ("appendix-a-half-plane.toml", include_str!("../../runs/appendix-a-half-plane.toml"));
const PLANE_MESH: &[u8] = include_bytes!("../../meshes/half_plane.msh");

/// Of the scenes; the radius is where displacements are zero.
const DISK: HalfDisk = HalfDisk { modulus: 814.7, poisson: 0.49, radius: 5.0, indenter: 1.0 };
const FRICTION: f64 = 0.2;
const APPROACH: f64 = 1e-3;

pub fn cases() -> Result<Vec<Case>> {
    let subject = |(file, text): (&str, &str), mesh| -> Result<Vec<Subject>> {
        let scene = scene::read(text, &Source { file: file.into(), overrides: Vec::new() })?;
        Ok(vec![Subject::Scene(Box::new(scene), mesh)])
    };
    Ok(vec![
        Case {
            name: "Appendix A, half disk, nu = 0.49, B-bar".into(),
            source: "the paper, (A4) to (A6), with the compliances of the disk",
            subjects: subject(DISK_SCENE, DISK_MESH)?,
            compare: Box::new(|solutions: &[Solution]| Ok(rows(&solutions[0]))),
        },
        Case {
            name: "Appendix A, half-plane, nu = 0.49, B-bar".into(),
            source: "the paper, (A4) to (A6), displacements beyond those of the face at x = 5 R",
            subjects: subject(PLANE_SCENE, PLANE_MESH)?,
            compare: Box::new(|solutions: &[Solution]| plane_rows(&solutions[0])),
        },
    ])
}

fn rows(solution: &Solution) -> Vec<Row> {
    let (normal, tangential) = (DISK.normal(), DISK.tangential());
    let force = normal.force(APPROACH);
    let plane = Law::half_plane(DISK).force(APPROACH);
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
        Row::relative(format!("N_z at full approach, N/m (a half-plane: {plane:.5})"), [held, force], 0.01, MESH_OF_26),
        Row::new("largest error of N_z(D), of N_z at the end", [rise, 0.0], 0.01, MESH_OF_26),
        Row::relative("Q_x at the first turn, N/m", [first, fresh.advance(FRICTION * APPROACH)], 0.02, MESH_OF_26),
        Row::new("largest error of Q_x over the cycle, of f N_z", [loop_error, 0.0], 0.01, MESH_OF_26),
        Row::new("largest change of N_z over the cycle, of N_z", [drift, 0.0], BETA * FRICTION, "coupling: f beta"),
    ]
}

/// N_z and Q_x against (A4) to (A6) at what the cylinder moves beyond the face at x = 5 R. By then the face is linear in
/// the forces: what it moves along x there is a share of Q_x, taken from the end of the first motion.
fn plane_rows(solution: &Solution) -> Result<Vec<Row>> {
    let law = Law::half_plane(DISK);
    let end = |phase: usize| -> Result<_> {
        let missing = || Error::Internal("a phase without an end".into());
        Ok((solution.end_of(phase), solution.ends.get(phase).ok_or_else(missing)?))
    };
    let far = |values: &[f64]| at_both_sides(&solution.x, values, DISK.radius);
    let (pressed, frame) = end(0)?;
    let approach = pressed.approach + far(&frame.displacement_z);
    let force = law.force(approach);
    let (forth, frame) = end(1)?;
    let share = far(&frame.displacement_x) / forth.tangential_force;
    let mut contact = Oscillation::new(|d| law.force(d), law.displacement(force), FRICTION);
    let mut loop_error = 0.0f64;
    for row in solution.history.iter().filter(|row| row.phase > 0) {
        let exact = contact.advance(row.sliding - share * row.tangential_force);
        loop_error = loop_error.max((row.tangential_force - exact).abs() / (FRICTION * force));
    }
    Ok(vec![
        Row::relative("N_z by (A4) at D - u_z(5 R), N/m", [pressed.normal_force, force], 0.01, MESH_OF_26),
        Row::relative("Q_x at a shift of f D, N/m", [forth.tangential_force, FRICTION * force], 0.01, MESH_OF_26),
        Row::new("largest error of Q_x over the cycle, of f N_z", [loop_error, 0.0], 0.01, MESH_OF_26),
    ])
}

/// The mean of what a field of the face is at -x and x > 0, between nodes by straight lines in ln |x|, as a far field goes.
fn at_both_sides(nodes: &[f64], values: &[f64], x: f64) -> f64 {
    let side = |sign: f64| {
        let pairs = nodes.iter().zip(values).filter(|(node, _)| **node * sign > 0.0);
        let (mut below, mut above) = ((0.0, 0.0), (f64::INFINITY, 0.0));
        for (distance, value) in pairs.map(|(node, value)| (node.abs(), *value)) {
            if distance <= x && distance > below.0 {
                below = (distance, value);
            } else if distance > x && distance < above.0 {
                above = (distance, value);
            }
        }
        below.1 + (above.1 - below.1) * (x / below.0).ln() / (above.0 / below.0).ln()
    };
    0.5 * (side(-1.0) + side(1.0))
}

const MESH_OF_26: &str = "mesh: 26 cells in contact, 30 to the arc";
/// Dundurs' (1 - 2 nu)/(2 (1 - nu)).
const BETA: f64 = (1.0 - 2.0 * DISK.poisson) / (2.0 * (1.0 - DISK.poisson));
