//! What a scene models and costs, and what a run did, in words.

use std::fmt::Write;
use std::time::Duration;

use crate::mesh::{Cell, Mesh};
use crate::output::{HistoryRow, Status};
use crate::petsc;
use crate::scene::{Friction, PoissonRule, Quadrature, Scene, Sides};
use crate::solve::Counts;

/// What is modelled and what is not: (modelled, not modelled).
pub fn modelled(scene: &Scene) -> (Vec<String>, Vec<String>) {
    let (mut yes, mut no) = (Vec::new(), Vec::new());
    for material in &scene.materials {
        let place = match (&material.region, scene.materials.len()) {
            (Some(region), _) => format!("{region}: "),
            (None, 1) => String::new(),
            (None, _) => material.thickness.map_or("below: ".to_owned(), |thickness| format!("{thickness} m: ")),
        };
        let arms = material.arms.len();
        match (arms, material.poisson_rule) {
            (0, _) => no.push(format!("{place}memory (linear elastic)")),
            (_, Some(PoissonRule::ConstantBulkModulus)) => {
                let text = "arm(s) of the shear modulus, constant bulk modulus";
                yes.push(format!("{place}viscoelastic memory: {arms} {text}"));
            }
            _ => yes.push(format!("{place}viscoelastic memory: {arms} arm(s), constant Poisson ratio")),
        }
    }
    match scene.friction {
        Some(Friction::CoulombTanh { coefficient, regularisation }) => {
            yes.push(format!("friction: f = {coefficient}, regularised by tanh over {regularisation} m/s"));
        }
        None => no.push("friction (symmetric solver)".to_owned()),
    }
    yes.push(format!(
        "contact: penalty {:.3e} Pa/m, {} quadrature",
        scene.contact.penalty,
        match scene.contact.quadrature {
            Quadrature::Nodal => "nodal",
            Quadrature::Gauss => "two-point Gauss",
        }
    ));
    if scene.output.bulk_at.is_empty() {
        no.push("stress recovery and bulk output".to_owned());
    } else {
        yes.push(format!("stress recovery and bulk output at {} moment(s)", scene.output.bulk_at.len()));
    }
    no.push("inertia, large strains, thermal effects".to_owned());
    (yes, no)
}

/// What `mpjr check` prints after the resolved scene; `mesh` where it comes from a file.
pub fn plan(scene: &Scene, mesh: Option<&Mesh>) -> String {
    let (yes, no) = modelled(scene);
    let unknowns = match (scene.layer(), mesh) {
        (Some(layer), _) => layer.unknowns(),
        (None, mesh) => mesh.map_or(0, Mesh::free_components),
    };
    let estimate = Estimate::of(scene, unknowns);
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "modelled:      {}", yes.join("\n               "));
    let _ = writeln!(text, "not modelled:  {}", no.join("\n               "));
    let _ = writeln!(text, "mesh:          {}, {unknowns} unknowns", extent(scene, mesh));
    let _ = writeln!(
        text,
        "loading:       {} phase(s), {} steps, {:.6} s",
        scene.phases.len(),
        scene.steps(),
        scene.duration()
    );
    let _ = writeln!(
        text,
        "strategy:      monolithic: all unknowns in one sparse system, factorised at each Newton iteration"
    );
    let _ = write!(
        text,
        "estimate:      {} per step, {} in all on one core; {:.1} GB of memory",
        seconds(estimate.step),
        seconds(estimate.step * scene.steps() as f64),
        estimate.memory / 1e9
    );
    text
}

/// The mesh in words.
fn extent(scene: &Scene, mesh: Option<&Mesh>) -> String {
    if let Some(layer) = scene.layer() {
        let sides = match layer.sides {
            Sides::Periodic => "periodic",
            Sides::Free => "free",
            Sides::Roller => "roller",
            Sides::Fixed => "fixed",
        };
        return format!("{} x {} cells, {sides} sides", layer.cells[0], layer.cells[1]);
    }
    let Some(mesh) = mesh else { return String::new() };
    let triangles = mesh.cells.iter().filter(|cell| matches!(cell, Cell::Triangle(_))).count();
    let quadrilaterals = mesh.cells.len() - triangles;
    let lock = match triangles > 0 && scene.materials.iter().any(|material| material.poisson_ratio > 0.45) {
        true => " (they lock near a Poisson ratio of 0.5)",
        false => "",
    };
    let from = mesh.face.x.first().copied().unwrap_or(0.0);
    let to = mesh.face.x.last().copied().unwrap_or(0.0);
    format!(
        "{quadrilaterals} quadrilaterals, {triangles} triangles{lock}, contact face of {} edges from x = {from:.6} to \
         {to:.6} m",
        mesh.face.edges.len()
    )
}

/// What a run did.
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// MPI ranks.
    pub ranks: i32,
    /// Up to the first step.
    pub setup: Duration,
    /// From start to end.
    pub total: Duration,
    /// Steps, iterations and their times.
    pub counts: Counts,
}

/// What `mpjr run` prints at the end; `last` is the last row of the history.
pub fn outcome(scene: &Scene, outcome: &Outcome, last: &HistoryRow) -> String {
    let Outcome { status, ranks, setup, total, counts } = outcome;
    let (yes, no) = modelled(scene);
    let blas = match petsc::blas_library() {
        "reference" => "reference BLAS (install libopenblas0-pthread: 2 to 5 times faster)",
        name => name,
    };
    let linear = counts.total.saturating_sub(counts.assembly + counts.output);
    let duration = |time: &Duration| seconds(time.as_secs_f64());
    let pieces = match counts.pieces {
        0 => String::new(),
        pieces => format!(", {pieces} of them pieces of steps that were cut"),
    };
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{:<15}{} at t = {:.6} s", "status:", status.as_str(), last.time);
    let _ = writeln!(text, "{:<15}{}", "modelled:", yes.join("; "));
    let _ = writeln!(text, "{:<15}{}", "not modelled:", no.join("; "));
    let _ = writeln!(
        text,
        "{:<15}N = {:.6e}  Q = {:.6e}  hysteretic = {:.6e} N/m",
        "final forces:", last.normal_force, last.tangential_force, last.hysteretic_force
    );
    let _ = writeln!(
        text,
        "{:<15}{:.4} of the face, {:.4} of it sticking; largest penetration {:.3e} m",
        "final contact:", last.contact_fraction, last.stick_fraction, last.max_penetration
    );
    let _ = writeln!(text, "{:<15}{} steps, {} Newton iterations{pieces}", "work:", counts.steps, counts.newton);
    let _ = writeln!(
        text,
        "{:<15}{} on {ranks} rank(s): set-up {}, assembly {}, linear solver {}, output {}; {blas}; peak {:.2} GB a rank",
        "time:",
        duration(total),
        duration(setup),
        duration(&counts.assembly),
        duration(&linear),
        duration(&counts.output),
        petsc::peak_memory() as f64 / 1e9
    );
    text
}

/// A rough cost, from measured factorisation times of 2-D meshes: within a factor of three on a recent core.
struct Estimate {
    /// s per step.
    step: f64,
    /// bytes
    memory: f64,
}

impl Estimate {
    fn of(scene: &Scene, unknowns: usize) -> Self {
        let unknowns = unknowns as f64;
        // Nested dissection in the plane: n^1.5 operations, n log n entries. Half for a symmetric factorisation.
        let symmetry = if scene.friction.is_some() { 1.0 } else { 0.6 };
        let newton = 3.5;
        let factorisation = 1.3e-8 * unknowns.powf(1.5) * symmetry;
        let assembly = 1.0e-6 * unknowns;
        let entries = 5.0 * unknowns * unknowns.max(2.0).log2() * symmetry;
        let matrices = 3.0 * 18.0 * 12.0 * unknowns;
        Self { step: newton * (factorisation + assembly), memory: 5e7 + 8.0 * entries + matrices }
    }
}

/// A duration for people.
pub fn seconds(s: f64) -> String {
    match s {
        s if s < 1e-3 => format!("{:.0} us", s * 1e6),
        s if s < 1.0 => format!("{:.0} ms", s * 1e3),
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}
