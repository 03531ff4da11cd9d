//! What a scene models and costs, and what a run did, in words.

use std::fmt::Write;
use std::time::Duration;

use super::case::Done;
use super::material;
use crate::composition::{self, Estimate, Form, Outline, Stretch};
use crate::energy::{Energy, MountEnergy};
use crate::output::Status;
use crate::petsc;
use crate::scene::{
    Adhesion, AdhesionLaw, Bond, Coefficient, Friction, Heat, Penalty, PoissonRule, Quadrature, Scene, Sides, Span,
    Strategy, Wear, WearLaw, Wearing, added_compliance, shortest_step,
};
use crate::solve::{Counts, Means, Work};

/// What is modelled and what is not: (modelled, not modelled).
pub fn modelled(scene: &Scene) -> (Vec<String>, Vec<String>) {
    let (mut yes, mut no) = (Vec::new(), Vec::new());
    for (place, material) in material::placed(scene) {
        let arms = material.arms.len();
        match (arms, material.poisson_rule) {
            (_, Some(PoissonRule::BulkArms)) => {
                let bulk = material.bulk_arms.len();
                let text = format!("{arms} arm(s) of the shear modulus, {bulk} of the bulk modulus");
                yes.push(format!("{place}viscoelastic memory: {text}"));
            }
            (0, _) => no.push(format!("{place}memory (linear elastic)")),
            (_, Some(PoissonRule::ConstantBulkModulus)) => {
                let text = "arm(s) of the shear modulus, constant bulk modulus";
                yes.push(format!("{place}viscoelastic memory: {arms} {text}"));
            }
            _ => yes.push(format!("{place}viscoelastic memory: {arms} arm(s), constant Poisson ratio")),
        }
    }
    match &scene.friction {
        Some(friction) => yes.push(friction_law(friction)),
        None => no.push("friction (symmetric solver)".to_owned()),
    }
    match &scene.heat {
        Some(heat) => yes.push(heat_in_words(heat)),
        None => no.push("heat".to_owned()),
    }
    if let Some(mount) = &scene.mount {
        let names = ["normal", "tangential"].into_iter().zip(mount.directions());
        let names: Vec<&str> = names.filter_map(|(name, end)| end.map(|_| name)).collect();
        yes.push(format!("mount: {}", names.join(" and ")));
    }
    match &scene.wear {
        Some(wear) => yes.push(wear_law(wear)),
        None => no.push("wear".to_owned()),
    }
    match &scene.adhesion {
        Some(adhesion) => yes.push(adhesion_law(adhesion)),
        None => no.push("adhesion".to_owned()),
    }
    yes.push(format!(
        "contact: {}, {} quadrature",
        normal_law(scene),
        match scene.contact.quadrature {
            Quadrature::Nodal => "nodal",
            Quadrature::Gauss => "two-point Gauss",
        }
    ));
    let balance = if scene.output.energy { &mut yes } else { &mut no };
    balance.push("energy balance".to_owned());
    if scene.output.bulk_at.is_empty() {
        no.push("stress recovery and bulk output".to_owned());
    } else {
        yes.push(format!("stress recovery and bulk output at {} moment(s)", scene.output.bulk_at.len()));
    }
    no.push("inertia, large strains".to_owned());
    (yes, no)
}

/// What heats the body, and where the heat goes.
fn heat_in_words(heat: &Heat) -> String {
    let arms = if heat.arms { " and what the arms dissipate" } else { "" };
    let base = heat.base.temperature().map_or("insulated".to_owned(), |kelvin| format!("at {kelvin} K"));
    let air = heat.convection.map_or("insulated beside the contact".to_owned(), |air| {
        format!("{} W/m^2/K to air at {} K beside the contact", air.coefficient, air.temperature)
    });
    let ways = if heat.coupled { "whose temperature shifts the times of the arms" } else { "one way" };
    format!(
        "heat, {ways}: {} of what friction dissipates{arms}; from {} K, base {base}, face {air}",
        heat.share, heat.initial
    )
}

/// The coefficient of friction, and how it turns.
fn friction_law(friction: &Friction) -> String {
    let coefficient = match &friction.coefficient {
        Coefficient::Number(number) => number.to_string(),
        Coefficient::Formula(formula) => formula.clone(),
    };
    let limit = friction.shear_limit.map_or(String::new(), |limit| format!(", at most {limit} Pa"));
    let turns = (friction.law.kind.told)(friction.law.softness);
    format!("friction: f = {coefficient}{limit}, {turns}")
}

/// What wears, and by which law.
fn wear_law(&Wear { of, law, coefficient }: &Wear) -> String {
    let of = match of {
        Wearing::Body => "body",
        Wearing::Indenter => "indenter",
    };
    let law = match law {
        WearLaw::Archard => "p |w| (Archard)",
        WearLaw::Energy => "q.w (energy)",
    };
    format!("wear of the {of}: rate = {coefficient:e} 1/Pa {law}, implicit")
}

/// How the surfaces pull, and what a closed gap bears.
fn adhesion_law(&Adhesion { law, work, range, friction }: &Adhesion) -> String {
    let law = match law {
        AdhesionLaw::Exponential => "exponential",
        AdhesionLaw::Bilinear => "bilinear",
        AdhesionLaw::Dugdale => "Dugdale",
    };
    let bond = match friction {
        Bond::None => "no friction in tension".to_owned(),
        Bond::ShearStrength(strength) => format!("a closed gap bears a shear of {strength:e} Pa besides"),
    };
    format!("adhesion: {law}, {work:e} J/m^2 over a range of {range:e} m; contact by gap; {bond}")
}

/// The penalty, and how much it softens a layer.
fn normal_law(scene: &Scene) -> String {
    match (scene.contact.penalty, scene.layer()) {
        (None, _) => "no penetration".into(),
        (Some(Penalty::Stiffness(stiffness)), Some(layer)) => {
            let added = added_compliance(stiffness, layer, &scene.materials, shortest_step(&scene.phases));
            format!(
                "penalty of {stiffness:.3e} Pa/m ({added:.2e} of the compliance to the wave the layer is stiffest to)"
            )
        }
        (Some(Penalty::Stiffness(stiffness)), None) => format!("penalty of {stiffness:.3e} Pa/m"),
        (Some(Penalty::Tolerance(tolerance)), _) => format!("penalty that softens the body by {tolerance} at most"),
    }
}

/// What `mpjr check` prints after the resolved scene.
pub fn plan(scene: &Scene, outline: &Outline) -> String {
    let (yes, no) = modelled(scene);
    let estimate = Estimate::of(scene, outline);
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "modelled:      {}", yes.join("\n               "));
    let _ = writeln!(text, "not modelled:  {}", no.join("\n               "));
    text += &material::lines(scene);
    let _ = writeln!(text, "mesh:          {}, {} unknowns", extent(scene, outline), outline.unknowns);
    if let Some(penalty) = outline.penalty {
        let _ = writeln!(text, "penalty:       {penalty:.3e} Pa/m");
    }
    let _ = writeln!(
        text,
        "loading:       {} phase(s), {}{} steps, {:.6} s",
        scene.phases.len(),
        if scene.is_adaptive() { "adaptive, about " } else { "" },
        scene.steps(),
        scene.duration()
    );
    let _ = writeln!(text, "strategy:      {}", strategy(scene, outline.unknowns));
    text += &body(scene, outline);
    text += &results(scene);
    let _ = write!(
        text,
        "estimate:      {} per step, {} in all on one core; {:.1} GB of memory",
        seconds(estimate.step),
        seconds(estimate.step * scene.steps() as f64),
        estimate.memory / 1e9
    );
    text
}

/// By what the body is solved for, and why; nothing where there is nothing to choose.
fn body(scene: &Scene, outline: &Outline) -> String {
    let Some(chosen) = composition::means(scene, outline) else { return String::new() };
    let needs = |means| bytes(Estimate::by(scene, outline, means).memory);
    let name = |means| match means {
        Means::Dense => "dense matrix of the face",
        Means::Factor => "sparse factor",
        Means::Multigrid => "multigrid",
    };
    let of_face = composition::form(scene) != Form::Monolithic;
    let others: Vec<_> = [Means::Dense, Means::Factor, Means::Multigrid]
        .into_iter()
        .filter(|means| *means != chosen.means && (of_face || *means != Means::Dense))
        .map(|means| format!("{} with a {}", needs(means), name(means)).replace("a multigrid", "multigrid"))
        .collect();
    format!(
        "body:          {}{}, {} of memory ({})\n",
        name(chosen.means),
        if chosen.asked { " (-body_pc_type)" } else { "" },
        needs(chosen.means),
        others.join(", ")
    )
}

/// How large the result file becomes, and what is left out of it unasked.
fn results(scene: &Scene) -> String {
    let Some([interface, all]) = scene.result_bytes() else { return String::new() };
    let fewer = match scene.keeps_fewer_unasked() {
        true => format!(
            "\n{:15}one interface profile in {} steps, as all would take {}; output.interface_every says otherwise",
            "",
            scene.output.interface_every,
            bytes(interface * scene.output.interface_every as f64)
        ),
        false => String::new(),
    };
    format!("results:       {} before compression, {} of it interface profiles{fewer}\n", bytes(all), bytes(interface))
}

/// Bytes for people.
fn bytes(count: f64) -> String {
    match count {
        count if count < 1e6 => format!("{:.0} kB", count / 1e3),
        count if count < 1e9 => format!("{:.0} MB", count / 1e6),
        count => format!("{:.1} GB", count / 1e9),
    }
}

/// The mesh in words.
fn extent(scene: &Scene, outline: &Outline) -> String {
    if let Some(layer) = scene.layer() {
        let sides = |span: &Span| match span.sides {
            Sides::Periodic => "periodic",
            Sides::Free => "free",
            Sides::Roller => "roller",
            Sides::Fixed => "fixed",
        };
        let cells = layer.spans.iter().map(|span| span.cells).chain([layer.rows]);
        let cells = cells.map(|count| count.to_string()).collect::<Vec<_>>().join(" x ");
        let mut kinds: Vec<&str> = layer.spans.iter().map(sides).collect();
        kinds.dedup();
        return format!("{cells} cells, {} sides", kinds.join(" and "));
    }
    let ([multilinear, simplices], facets) = (outline.cells, outline.facets);
    let range = |along: &Stretch| format!("{:.6} to {:.6} m", along.from, along.to);
    let (cells, face) = match &outline.across {
        None => (["quadrilaterals", "triangles"], format!("edges from x = {}", range(&outline.face))),
        Some(across) => {
            (["hexahedra", "tetrahedra"], format!("facets from x = {}, y = {}", range(&outline.face), range(across)))
        }
    };
    format!("{multilinear} {}, {simplices} {}; contact face of\n{:15}{facets} {face}", cells[0], cells[1], "")
}

/// What a run did.
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// MPI ranks.
    pub ranks: i32,
    /// Of the body; known on rank 0.
    pub unknowns: usize,
    /// Up to the first step.
    pub setup: Duration,
    /// From start to end.
    pub total: Duration,
    /// Steps, iterations and their times.
    pub counts: Counts,
}

/// What `mpjr run` prints at the end.
pub fn outcome(scene: &Scene, done: &Done) -> String {
    let Done { outcome: Outcome { status, ranks, unknowns, setup, total, counts }, last, warnings, in_space, .. } =
        done;
    let (yes, no) = modelled(scene);
    let blas = match petsc::blas_library() {
        "reference" => "the reference (OpenBLAS is faster: Debian's libopenblas0-pthread)",
        name => name,
    };
    let linear = counts.total.saturating_sub(counts.assembly + counts.output);
    let duration = |time: &Duration| seconds(time.as_secs_f64());
    let pieces = match counts.pieces {
        0 => String::new(),
        pieces => format!(", {pieces} of them pieces of steps that were cut"),
    };
    let rejected = match counts.rejected {
        0 => String::new(),
        rejected => format!(" ({rejected} attempts rejected)"),
    };
    let sparse = match counts.work {
        Work { factorisations: 0, transforms: 0, .. } => String::new(),
        Work { factorisations: 0, transforms, .. } => {
            format!(
                ", {:.0} Fourier transforms of one component a step",
                transforms as f64 / counts.steps.max(1) as f64
            )
        }
        Work { factorisations, solves, .. } => {
            format!("; {factorisations} sparse factorisation(s), {solves} solves with them")
        }
    };
    let along = |x: f64, y: f64| if *in_space { format!("({x:.6e}, {y:.6e})") } else { format!("{x:.6e}") };
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{:<15}{} at t = {:.6} s", "status:", status.as_str(), last.time);
    let _ = writeln!(text, "{:<15}{}", "warnings:", warnings.len());
    let _ = writeln!(text, "{:<15}{}", "modelled:", yes.join("\n               "));
    let _ = writeln!(text, "{:<15}{}", "not modelled:", no.join("\n               "));
    text += &material::lines(scene);
    let _ = writeln!(
        text,
        "{:<15}N = {:.6e}  Q = {}  hysteretic = {} {}",
        "final forces:",
        last.normal_force,
        along(last.tangential_force, last.across.tangential_force),
        along(last.hysteretic_force, last.across.hysteretic_force),
        if *in_space { "N" } else { "N/m" }
    );
    let _ = writeln!(
        text,
        "{:<15}{:.4} of the face, {:.4} of it sticking; penetration {:.1e} m, slip while sticking {:.1e} m",
        "final contact:", last.contact_fraction, last.stick_fraction, last.max_penetration, last.stuck_slip
    );
    if scene.output.energy {
        let _ = writeln!(text, "{:<15}{}", "energy:", balance(&last.energy, if *in_space { "J" } else { "J/m" }));
    }
    let work = format!("{} steps{rejected}{pieces}, {} Newton iterations{sparse}", counts.steps, counts.newton);
    let _ = writeln!(text, "{:<15}{work}", "work:");
    let _ = writeln!(
        text,
        "{:<15}{} on {ranks} rank(s): set-up {}, assembly {},\n{:<15}linear solver {}, output {}",
        "time:",
        duration(total),
        duration(setup),
        duration(&counts.assembly),
        "",
        duration(&linear),
        duration(&counts.output)
    );
    let shared = composition::shares_face(scene, *ranks as usize);
    if let Some(why) = alone(scene, *unknowns).filter(|_| *ranks > 1 && !shared) {
        let _ = writeln!(text, "{:15}one rank would take no longer: {why}", "");
    }
    let _ = writeln!(text, "{:<15}at most {:.2} GB a rank", "memory:", petsc::peak_memory() as f64 / 1e9);
    let _ = writeln!(text, "{:<15}{blas}", "BLAS:");
    text
}

/// The energy balance as a sum.
fn balance(energy: &Energy, unit: &str) -> String {
    let Energy {
        external_work,
        stored,
        viscoelastic_dissipation,
        friction_dissipation,
        penalty,
        wear,
        adhesion,
        jumps,
        mounts,
        imbalance,
    } = energy;
    let worn = if *wear == 0.0 { String::new() } else { format!(" + wear {wear:.3e}") };
    let pulled = match (*adhesion, *jumps) {
        (0.0, 0.0) => String::new(),
        _ => format!(" + adhesion {adhesion:.3e} + jumps {jumps:.3e}"),
    };
    let MountEnergy { spring, dashpot, kinetic } = mounts;
    let held = match *mounts == MountEnergy::default() {
        true => String::new(),
        false => format!(" + mounts {:.3e}", spring + dashpot + kinetic),
    };
    format!(
        "work {external_work:.3e} = stored {stored:.3e} + arms {viscoelastic_dissipation:.3e} + friction \
         {friction_dissipation:.3e}\n{:15}+ penalty {penalty:.3e}{worn}{pulled}{held} + imbalance {imbalance:.3e} {unit}",
        ""
    )
}

/// How the scene is solved, and why.
fn strategy(scene: &Scene, unknowns: usize) -> String {
    let asked = if scene.solver.strategy == Strategy::Auto { "auto picked " } else { "" };
    let by_wave = scene.period().is_some();
    let lines = match composition::form(scene) {
        Form::Monolithic => vec![
            "monolithic: all unknowns in one sparse system; the bulk is factorised once per step length, and Newton",
            "solves with it and with the compliance of the nodes that came into contact so far",
        ],
        Form::FaceMemory => {
            let mut lines = vec![
                "condensed: all moduli keep their ratios, so that the interior follows the contact",
                "face; Newton runs on the nodes in contact",
            ];
            if by_wave {
                lines.push(
                    "periodic layer: the face's compliance is had wavenumber by wavenumber, without a sparse matrix",
                );
            }
            lines
        }
        Form::Coupled => vec![
            "condensed: the arms follow the temperature of their cells; one assembly and one",
            "factorisation per step (by the first rank alone), Newton on the nodes in contact",
        ],
        Form::BulkMemory if by_wave => vec![
            "condensed: not all moduli relax alike, so that the interior has a memory of its own;",
            "periodic layer: it is solved for wavenumber by wavenumber, once per step, without a sparse matrix;",
            "Newton runs on the nodes in contact",
        ],
        Form::BulkMemory => vec![
            "condensed: not all moduli relax alike, so that the interior has a memory of its own; one",
            "factorisation per step length, two interior solves per step, Newton on the nodes in contact",
        ],
    };
    let mut lines = lines;
    let ranks = match composition::shares_face(scene, 2) {
        true => Some("the ranks share its nodes and its waves".to_owned()),
        false => alone(scene, unknowns).map(|why| format!("one MPI rank: {why}")),
    };
    lines.extend(ranks.as_deref());
    format!("{asked}{}", lines.join(&format!("\n{:15}", "")))
}

/// Why more ranks than one bring nothing; none where they share the interior: for a sparse system, or for the output.
fn alone(scene: &Scene, unknowns: usize) -> Option<&'static str> {
    /// In the plane two ranks take 1.2 times as long as one at 33,000 unknowns, 0.7 to 0.8 times as long from 130,000 to 520,000.
    const FEW: usize = 100_000;
    let by_wave = scene.period().is_some() && scene.output.bulk_at.is_empty();
    match composition::form(scene) {
        Form::Monolithic if !scene.is_in_space() && unknowns < FEW => {
            Some("with so few unknowns several ranks wait for each other longer than they work")
        }
        Form::Monolithic => None,
        Form::Coupled => Some("the first rank assembles and factorises the body alone"),
        _ => by_wave.then_some("without a sparse matrix, ranks have nothing to share"),
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
