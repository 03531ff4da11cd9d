//! The bonded elastic layer at one wavenumber: full contact, and the symmetry and mirror images of solutions.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::setting::{Indenter, Phase, Setting, elastic, one_arm, tanh};
use super::{Case, Row};
use crate::oracle::PoissonRule;
use crate::solution::Solution;

pub fn cases(quick: bool) -> Vec<Case> {
    let grid: &[(f64, f64)] = if quick {
        &[(0.2, 0.45), (1.0, 0.3)]
    } else {
        &[(0.1, 0.0), (0.1, 0.3), (0.1, 0.45), (0.5, 0.0), (0.5, 0.45), (2.0, 0.0), (2.0, 0.3), (2.0, 0.45)]
    };
    let mut list: Vec<Case> = grid.iter().map(|&(depth, poisson)| compliance(depth, poisson)).collect();
    list.push(mirror(64));
    list
}

const FRICTION: f64 = 0.3;
const SMOOTH: &str = "solver: 1e-10, relative, and round-off";

/// A wave pressed until it touches everywhere and slid by one period, all slipping (q = f p).
///
/// The layer then answers each wave of traction by itself (see [`crate::oracle::layer`]): with the first Fourier
/// coefficients p_1, u_1 (tangential) and d_1 (inward) of the face's fields,
///
/// ```text
/// d_1/p_1 = C_zz - i f C_xz        u_1/p_1 = f C_xx + i C_xz
/// ```
///
/// and likewise for the means with the compliances at k = 0, which bilinear elements represent exactly.
fn compliance(depth: f64, poisson: f64) -> Case {
    let exact = move |setting: &Setting, k: f64| setting.layer().compliance(k, setting.moduli());
    let base =
        Setting { depth, friction: Some(tanh(FRICTION, 1e-3)), ..Setting::new(64, elastic(300.0, poisson), vec![]) };
    let [uniform, wave] = [0.0, TAU].map(|k| exact(&base, k).sliding(FRICTION).norm());
    // Twice what closes the gap in the troughs.
    let approach = 5e-4 * (1.0 + 2.0 * uniform / wave);
    let slide = Phase::slide(1.0, 1.0, 1, approach);
    // Half a hundred cells through a thin layer.
    let cells = [64, (64.0 * depth).max(48.0) as usize];
    let fine = Setting { cells, phases: vec![slide], ..base };
    let coarse = fine.halved();
    let setting = fine.clone();
    let compare = move |solutions: &[Solution]| {
        let [fine, coarse] = [0, 1].map(|i| measured(&solutions[i]));
        let (at_k, mean) = (exact(&setting, TAU), exact(&setting, 0.0));
        let contact = solutions[0].last().contact_fraction;
        Ok(vec![
            Row::new("contact fraction", [contact, 1.0], 0.0, "full contact is what the formulas are for"),
            Row::relative("C_zz at k = 0, m/Pa", [fine.mean_zz, mean.zz.re], 1e-7, SMOOTH),
            Row::relative("C_xx at k = 0, m/Pa", [fine.mean_xx, mean.xx.re], 1e-7, SMOOTH),
            Row::refined("C_zz at k = 2 pi/m, m/Pa", [fine.zz, coarse.zz], at_k.zz.re),
            Row::order("  its order of convergence", [fine.zz, coarse.zz], at_k.zz.re),
            Row::refined("C_xx at k = 2 pi/m, m/Pa", [fine.xx, coarse.xx], at_k.xx.re),
            Row::refined("C_xz at k = 2 pi/m, m/Pa", [fine.xz, coarse.xz], at_k.xz.re),
        ])
    };
    Case {
        name: format!("bonded layer, H = {depth} m, nu = {poisson}"),
        source: "plane strain layer on a rigid base, in closed form",
        subjects: vec![fine.into(), coarse.into()],
        compare: Box::new(compare),
    }
}

struct Measured {
    mean_zz: f64,
    mean_xx: f64,
    zz: f64,
    xx: f64,
    xz: f64,
}

fn measured(solution: &Solution) -> Measured {
    let end = &solution.ends[0];
    let coefficient = |field: &[f64], wave: f64| -> Complex<f64> {
        let terms = field.iter().zip(&solution.x).map(|(value, x)| Complex::from_polar(*value, -TAU * wave * x));
        terms.sum::<Complex<f64>>() / field.len() as f64
    };
    let inward: Vec<f64> = end.displacement_z.iter().map(|u| -u).collect();
    let [p, d, u] = [&end.pressure, &inward, &end.displacement_x].map(|field| coefficient(field, 1.0));
    let [p0, d0, u0] = [&end.pressure, &inward, &end.displacement_x].map(|field| coefficient(field, 0.0).re);
    let (normal, tangential) = (d / p, u / p);
    Measured {
        mean_zz: d0 / p0,
        mean_xx: u0 / (FRICTION * p0),
        zz: normal.re,
        xx: tangential.re / FRICTION,
        xz: tangential.im,
    }
}

/// Pressing a symmetric wave gives a symmetric answer, sliding to the left the mirror image of sliding to the right.
fn mirror(n: usize) -> Case {
    let solid = one_arm(0.3, PoissonRule::ConstantRatio);
    let [right, left] = [0.1, -0.1].map(|velocity| Setting {
        friction: Some(tanh(0.2, 1e-3)),
        indenter: Indenter::Wave(5e-4),
        ..Setting::new(n, solid.clone(), vec![Phase::press(10.0, 10, 1e-3), Phase::slide(velocity, 0.3, 20, 1e-3)])
    });
    let compare = move |solutions: &[Solution]| {
        let [right, left] = [&solutions[0], &solutions[1]];
        let pressed = &right.ends[0];
        let peak = pressed.pressure.iter().fold(0.0, |most: f64, p| most.max(*p));
        // Node 0 is under the summit.
        let image = |i: usize| (n - i) % n;
        let largest = |difference: &dyn Fn(usize) -> f64| (0..n).map(difference).fold(0.0, |m: f64, d| m.max(d.abs()));
        let odd = largest(&|i| pressed.pressure[i] - pressed.pressure[image(i)]) / peak;
        let even = largest(&|i| pressed.shear[i] + pressed.shear[image(i)]) / peak;
        let slid = largest(&|i| right.ends[1].pressure[i] - left.ends[1].pressure[image(i)]) / peak;
        let (r, l) = (right.last(), left.last());
        Ok(vec![
            Row::new("odd part of p after pressing, of its peak", [odd, 0.0], 1e-7, SMOOTH),
            Row::new("even part of q after pressing, of the peak", [even, 0.0], 1e-7, SMOOTH),
            Row::new("p slid right less mirrored p slid left", [slid, 0.0], 1e-7, SMOOTH),
            Row::relative(
                "Q_x slid right, and -Q_x slid left, N/m",
                [r.tangential_force, -l.tangential_force],
                1e-7,
                SMOOTH,
            ),
            Row::relative("hysteretic force, likewise, N/m", [r.hysteretic_force, -l.hysteretic_force], 1e-5, SMOOTH),
        ])
    };
    Case {
        name: "mirror images".into(),
        source: "symmetry",
        subjects: vec![right.into(), left.into()],
        compare: Box::new(compare),
    }
}
