//! Full contact of a sliding harmonic profile, for which there is a closed form.

use std::f64::consts::TAU;

use mpi::topology::SimpleCommunicator;
use mpjr::oracle::steady::{Load, Sliding};
use mpjr::oracle::{Harmonic, Layer, PoissonRule, Solid};
use nalgebra::Complex;

const AMPLITUDE: f64 = 1e-3;
const APPROACH: f64 = 2e-2;
const FRICTION: f64 = 0.3;
const CELLS: usize = 64;
const PENALTY: f64 = 1e7;

/// A layer of 1 m by 1 m in full contact, which slips everywhere by 0.37 m a step of `step` relaxation times.
fn scene(velocity: f64, step: f64, quadrature: &str) -> String {
    let dt = 0.37 / velocity;
    format!(
        "[layer]\nwidth = 1.0\ndepth = 1.0\ncells = [{CELLS}, {CELLS}]\nsides = \"periodic\"\n\
         [material]\nshear_modulus = 1.0\npoisson_ratio = 0.3\npoisson_rule = \"constant_bulk_modulus\"\n\
         arms = [{{ weight = 0.6, time = {:e} }}]\n\
         [indenter]\nprofile = \"harmonic\"\namplitude = {AMPLITUDE}\nwavelength = 1.0\n\
         [contact]\npenalty = {PENALTY}\nquadrature = \"{quadrature}\"\n\
         [friction]\nlaw = \"coulomb_tanh\"\ncoefficient = {FRICTION}\nregularisation = {:e}\n\
         [[phase]]\nduration = {dt:e}\nsteps = 1\napproach = {APPROACH}\n\
         [[phase]]\nduration = {:e}\nsteps = 3\nvelocity = {velocity:e}\n",
        dt / step,
        1e-9 * velocity,
        3.0 * dt
    )
}

/// At 1e-9 and 1e6 m/s, in steps of 1e-14 and 1e14 relaxation times, the layer is that of the instantaneous or of the long-term
/// moduli: N, Q, the hysteretic force and amplitude and phase of the pressure are those of sliding in full contact
/// (`mpjr::oracle::steady`). N and Q depend on the mean alone, which the mesh has exactly; one wave over 64 cells is off
/// by a part of (2 pi/64)^2/12 = 8e-4, and the hysteretic force by that over the phase, here 0.05 to 0.1.
pub fn full_contact(world: &SimpleCommunicator, _: &std::path::Path) {
    let solid = Solid { shear: 1.0, poisson: 0.3, rule: PoissonRule::ConstantBulkModulus, arms: vec![(0.6, 1.0)] };
    for (velocity, step, quadrature) in [
        (1e-9, 1e-14, "nodal"),
        (1e-9, 1e14, "nodal"),
        (1e6, 1e-14, "nodal"),
        (1e6, 1e14, "nodal"),
        (1e6, 1e-14, "gauss"),
        (1e-9, 1e14, "gauss"),
    ] {
        let moduli = solid.moduli(if step < 1.0 { f64::INFINITY } else { 0.0 });
        let (shear, poisson) = (moduli.shear.re, moduli.poisson.re);
        let sliding = Sliding {
            layer: Layer { depth: 1.0 },
            solid: Solid { shear, poisson, rule: PoissonRule::ConstantRatio, arms: Vec::new() },
            width: 1.0,
            velocity,
            friction: FRICTION,
            softness: 1.0 / PENALTY,
        };
        let profile = Harmonic { amplitude: AMPLITUDE, wavelength: 1.0 };
        let exact = sliding.full_contact(profile, Load::Approach(APPROACH)).unwrap();
        let solution = super::solve(world, &scene(velocity, step, quadrature)).unwrap();
        let last = solution.last();
        // The wave of the pressure, against the place of the indenter.
        let pressure = &solution.ends[1].pressure;
        let terms =
            pressure.iter().zip(&solution.x).map(|(p, x)| p * Complex::from_polar(1.0, -TAU * (x - last.sliding)));
        let wave = terms.sum::<Complex<f64>>() * (2.0 / CELLS as f64);
        let apart = wave / (AMPLITUDE / sliding.symbol(TAU));
        let of = |force: f64, exact: f64| force / exact - 1.0;
        let differences = [
            of(last.normal_force, exact.normal),
            of(last.tangential_force, exact.tangential),
            of(last.hysteretic_force, exact.hysteretic),
            apart.norm() - 1.0,
            apart.arg(),
        ];
        println!("v = {velocity:e} m/s, dt/tau = {step:e}, {quadrature}: {differences:?}");
        // Between Gauss points the nodes are not where the indenter is, and a law evaluated there says little.
        let bounds = match quadrature {
            "gauss" => [1e-6, 1e-6, 2e-2, f64::INFINITY, f64::INFINITY],
            _ => [1e-9, 1e-9, 2e-2, 1e-3, 1e-3],
        };
        assert!(differences.iter().zip(bounds).all(|(difference, bound)| difference.abs() < bound), "{differences:?}");
    }
}
