//! Heat: friction of a known traction warms half-spaces and layers, bands move over them, air warms what nothing touches.
//!
//! The shear of a stiff layer in full slip under a low `shear_limit` is that limit, and the flux the limit times the velocity. The
//! error is that of backward Euler's steps, of first order; steps go by whole cells.

use std::path::PathBuf;

use super::{Case, Row};
use crate::error::Result;
use crate::oracle::heat::{Band, Conductor};
use crate::oracle::prony::Relaxing;
use crate::scene::{self, Scene, Source};
use crate::solution::Solution;

const RUBBER: Conductor = Conductor { conductivity: 0.2, capacity: 2e6 };
/// W/m^2
const FLUX: f64 = 5e3;
/// K
const START: f64 = 293.0;

pub fn cases(quick: bool) -> Result<Vec<Case>> {
    let cells = if quick { 16 } else { 32 };
    let mut list = vec![half_space()?, in_air()?, half_plane(cells)?, flash(cells)?, gradient()?];
    if !quick {
        list.push(periodic_layer(cells)?);
    }
    Ok(list)
}

/// A periodic layer of this width and depth on so many cells, under an indenter at this approach, with phases to follow.
fn scene([width, depth]: [f64; 2], [nx, nz, grading]: [f64; 3], indenter: &str, rest: &str) -> Result<Scene> {
    let text = format!(
        "[layer]\nwidth = {width:?}\ndepth = {depth:?}\ncells = [{nx}, {nz}]\ngrading = {grading:?}\nsides = \"periodic\"\n\
         [material]\nyoung_modulus = 1e15\npoisson_ratio = 0.0\nconductivity = {:?}\nheat_capacity = {:?}\n\
         [indenter]\n{indenter}\n[contact]\n{rest}",
        RUBBER.conductivity, RUBBER.capacity
    );
    scene::read(&text, &Source { file: PathBuf::from("verify"), overrides: Vec::new() })
}

/// `[friction]` of a flux at a velocity, `[heat]`, and two phases: pressed, then slid.
fn slid(velocity: f64, [approach, distance]: [f64; 2], steps: usize) -> String {
    let limit = FLUX / velocity;
    format!(
        "[friction]\nlaw = \"coulomb\"\ncoefficient = 1.0\nshear_limit = {limit:?}\n[heat]\ninitial = {START:?}\nbase = {START:?}\n\
         [[phase]]\nduration = 1e-9\nsteps = 1\napproach = {approach:?}\n\
         [[phase]]\nvelocity = {velocity:?}\ndistance = {distance:?}\nsteps = {steps}\n"
    )
}

const FLAT: &str = "profile = \"expression\"\nformula = \"0*x\"";

fn case(
    name: String,
    source: &'static str,
    scenes: Vec<Scene>,
    compare: impl Fn(&[Solution]) -> Vec<Row> + 'static,
) -> Case {
    let subjects = scenes.into_iter().map(|scene| super::Subject::Scene(Box::new(scene), &[])).collect();
    Case { name, source, subjects, compare: Box::new(move |solutions| Ok(compare(solutions))) }
}

/// The rise of the temperature of the face at the end, between nodes, at `place`.
fn rise(solution: &Solution, place: f64) -> f64 {
    let (face, width) = (&solution.ends[1].temperature, 2.0 * solution.x[1] + solution.x[solution.x.len() - 2]);
    let at = place.rem_euclid(width) / solution.x[1];
    let (node, share) = (at.floor() as usize % face.len(), at - at.floor());
    face[node] * (1.0 - share) + face[(node + 1) % face.len()] * share - START
}

/// What entered less what is stored or went out, over what entered.
fn balance(solution: &Solution) -> Row {
    let heat = solution.last().heat.energy;
    let left =
        (heat.entered - heat.stored - heat.convected - heat.conducted) / heat.entered.abs().max(heat.convected.abs());
    Row::new("heat that is left over", [left, 0.0], 1e-11, "round-off")
}

/// What entered beside what friction dissipated: the same.
fn ledger(solution: &Solution) -> Row {
    let row = solution.last();
    Row::relative("heat, J/m", [row.heat.energy.entered, row.energy.friction_dissipation], 1e-12, "round-off")
}

fn half_space() -> Result<Case> {
    let made = |rows: f64, steps| scene([0.01, 3e-3], [4.0, rows, 1.0], FLAT, &slid(0.1, [1e-9, 0.1], steps));
    let scenes = vec![made(100.0, 100)?, made(200.0, 200)?];
    Ok(case("a half-space under a flux".into(), "closed form", scenes, |solutions| {
        let [coarse, fine] = [0, 1].map(|i| rise(&solutions[i], 0.0));
        let exact = RUBBER.half_space(FLUX, 1.0);
        let order = ((coarse - exact) / (fine - exact)).abs().log2();
        vec![
            Row::halved("T, K", [fine, coarse], exact),
            Row::new("order", [order, 1.0], 0.2, "not yet asymptotic"),
            balance(&solutions[1]),
            ledger(&solutions[1]),
        ]
    }))
}

/// Warm air over a face that nothing touches, until nothing changes.
fn in_air() -> Result<Case> {
    let heat = format!(
        "[heat]\ninitial = {START:?}\nbase = {START:?}\nconvection = {{ coefficient = 30.0, temperature = 298.0 }}\n"
    );
    let phases = "[[phase]]\nduration = 1e-9\nsteps = 1\napproach = -1e-6\n[[phase]]\nduration = 1e9\nsteps = 4\n";
    let scenes = vec![scene([0.01, 0.01], [8.0, 8.0, 2.0], FLAT, &(heat + phases))?];
    Ok(case("a layer in warm air".into(), "closed form", scenes, |solutions| {
        let found = [rise(&solutions[0], 0.0), RUBBER.steady_layer(0.01, 0.0, [30.0, 5.0])];
        vec![Row::new("T, K", found, 1e-6, "time: a millionth of the rise is left"), balance(&solutions[0])]
    }))
}

/// The band of these cases.
const BAND: Band = Band { flux: FLUX, half_width: 2e-3, velocity: 2e-3 };
/// Where its middle is before it slides, in widths of the band, less half a cell: between two nodes.
const FROM: f64 = 1.5;

/// Where the middle of a band of so many cells is before it slides, m.
fn middle(cells: usize) -> f64 {
    2.0 * BAND.half_width * (FROM + 0.5 / cells as f64)
}

/// A band of so many cells on a layer, slid by so many steps of a cell each; its flanks never touch.
fn banded([width, depth]: [f64; 2], cells: usize, [rows, grading]: [f64; 2], steps: usize) -> Result<Scene> {
    let (spacing, middle) = (2.0 * BAND.half_width / cells as f64, middle(cells));
    let flat = BAND.half_width - 0.25 * spacing;
    let away = format!("min(abs(x - {middle:?}), {width:?} - abs(x - {middle:?}))");
    let indenter = format!("profile = \"expression\"\nformula = \"1e3*max(0, {away} - {flat:?})\"");
    let slide = slid(BAND.velocity, [1e-9, steps as f64 * spacing], steps);
    scene([width, depth], [(width / spacing).round(), rows, grading], &indenter, &slide)
}

/// Rows at the two places of a band.
fn compared(solutions: &[Solution], exact: impl Fn(f64) -> f64) -> Vec<Row> {
    let at = |solution: &Solution, x: f64| {
        let cells = (2.0 * BAND.half_width / solution.x[1]).round() as usize;
        rise(solution, middle(cells) + solution.last().sliding + x)
    };
    let row = |place: f64| {
        let x = place * BAND.half_width;
        Row::halved(format!("T at x = {place} a, K"), [1, 0].map(|i: usize| at(&solutions[i], x)), exact(x))
    };
    let mut rows: Vec<Row> = [-0.5, 0.0].map(row).into();
    rows.extend([balance(&solutions[1]), ledger(&solutions[1])]);
    rows
}

fn half_plane(cells: usize) -> Result<Case> {
    // Before the band comes to its own trace, after twice its width.
    let made = |cells: usize| banded([0.024, 6e-3], cells, [60.0, 40.0], 3 * cells);
    let scenes = vec![made(cells / 2)?, made(cells)?];
    let exact = |x| RUBBER.jaeger(BAND, x);
    Ok(case(format!("a band on a half-plane, Pe = 20, {cells} cells"), "Jaeger", scenes, move |s| compared(s, exact)))
}

fn periodic_layer(cells: usize) -> Result<Case> {
    let size = [0.02, 0.001];
    let made = |cells: usize| banded(size, cells, [32.0, 6.0], 20 * cells);
    let scenes = vec![made(cells / 2)?, made(cells)?];
    let exact = move |x| RUBBER.periodic_layer(BAND, size, x);
    Ok(case(format!("a band round a layer, {cells} cells"), "Fourier series", scenes, move |s| compared(s, exact)))
}

/// A parabola that slides fast, Pe = 1000: the flux that the run has itself, and the temperature that this gives.
fn flash(cells: usize) -> Result<Case> {
    const VELOCITY: f64 = 0.2;
    let made = |cells: usize| {
        let spacing = 2e-3 / cells as f64;
        let indenter = "profile = \"parabola\"\nradius = 1.0\ncentre = 5e-3";
        let friction = "[friction]\nlaw = \"coulomb\"\ncoefficient = 1e-6\n";
        let heat = format!("[heat]\ninitial = {START:?}\nbase = {START:?}\nshare = 0.5\n");
        let slide = format!(
            "velocity = {VELOCITY:?}\ndistance = {:?}\nsteps = {}\n",
            5.0 * spacing * cells as f64 / 2.0,
            5 * cells / 2
        );
        let phases = format!("[[phase]]\nduration = 1e-9\nsteps = 1\napproach = 5e-7\n[[phase]]\n{slide}");
        scene([0.02, 5e-3], [0.02 / spacing, 90.0, 400.0], indenter, &format!("{friction}{heat}{phases}"))
    };
    let hottest = |solution: &Solution| {
        let end = &solution.ends[1];
        let computed = end.temperature.iter().copied().fold(0.0, f64::max) - START;
        // Straight between nodes; the leading edge is where it begins.
        let spacing = solution.x[1];
        let flux = |x: f64| {
            let (node, share) = ((x / spacing).floor(), x / spacing - (x / spacing).floor());
            let at = |node: f64| end.heat_flux.get(node as usize).copied().unwrap_or(0.0);
            at(node) * (1.0 - share) + at(node + 1.0) * share
        };
        let edge = end.heat_flux.iter().rposition(|q| *q > 0.0).map_or(0.0, |node| spacing * (node as f64 + 1.0));
        let at = |x: &f64| RUBBER.flash(flux, VELOCITY, [*x, edge]);
        [computed, solution.x.iter().map(at).fold(0.0, f64::max)]
    };
    let scenes = vec![made(cells / 2)?, made(cells)?];
    Ok(case(
        format!("flash temperature of a parabola, Pe = 1000, {cells} cells"),
        "quadrature",
        scenes,
        move |solutions| {
            let [[coarse, coarse_exact], [fine, exact]] = [hottest(&solutions[0]), hottest(&solutions[1])];
            // Each by its own flux.
            vec![Row::halved("highest T, K", [fine, coarse * exact / coarse_exact], exact), balance(&solutions[1])]
        },
    ))
}

/// A layer from 293 K at its base to 303 K at its face, whose arm has the time of each depth, under a flat indenter that 0.5 N/m press
/// down within 10 ms: D = (N/L) times the integral of J(t/a_T(z)) over the depth, J the creep of the modulus across a bonded layer.
fn gradient() -> Result<Case> {
    const RISE: f64 = 10.0;
    let [shear, ratio, weight, tau] = [568.498, 0.3, 0.579, 0.817];
    let [c1, c2, ramp, held, force] = [17.44, 51.6, 0.01, 2.0, 0.5];
    let made = |rows: usize| {
        let text = format!(
            "[layer]\nwidth = 1.0\ndepth = 1.0\ncells = [2, {rows}]\nsides = \"periodic\"\n[material]\nshear_modulus = {shear}\n\
             poisson_ratio = {ratio}\narms = [{{ weight = {weight}, time = {tau} }}]\npoisson_rule = \"constant_ratio\"\n\
             conductivity = 100.0\nheat_capacity = 2e6\nshift = \"wlf\"\nc1 = {c1}\nc2 = {c2}\nreference_temperature = {START:?}\n\
             temperature = {START:?}\n[indenter]\n{FLAT}\n[contact]\n[heat]\ninitial = {START:?}\nbase = {START:?}\ncoupled = true\n\
             convection = {{ coefficient = 1e9, temperature = {:?} }}\n[[phase]]\nduration = 2e5\nsteps = 16\napproach = -1e-9\n\
             [[phase]]\nduration = {ramp}\nsteps = 4\nnormal_force = {force}\n[[phase]]\nduration = {held:?}\nsteps = 100\n",
            START + RISE
        );
        scene::read(&text, &Source { file: PathBuf::from("verify"), overrides: Vec::new() })
    };
    let solid =
        Relaxing { instantaneous: 2.0 * shear * (1.0 - ratio) / (1.0 - 2.0 * ratio), arms: vec![(weight, tau)] };
    let creep = solid.creep()?;
    // The mean over the ramp, at a depth.
    let at = |share: f64| {
        let factor = 10f64.powf(-c1 * RISE * share / (c2 + RISE * share));
        let times = (0..8).map(|i| held + ramp * (f64::from(i) + 0.5) / 8.0);
        times.map(|t| creep.at(t / factor)).sum::<f64>() / 8.0
    };
    let exact = force * (0..4000).map(|i| at((f64::from(i) + 0.5) / 4000.0)).sum::<f64>() / 4000.0;
    let scenes = vec![made(8)?, made(16)?];
    Ok(case("arms in a gradient of temperature, WLF".into(), "quadrature", scenes, move |solutions| {
        let [coarse, fine] = [0, 1].map(|i| solutions[i].last().approach);
        vec![Row::refined("D, m", [fine, coarse], exact), Row::order("order", [fine, coarse], exact)]
    }))
}
