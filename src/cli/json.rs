//! Summaries as JSON objects, SI throughout.

use std::path::Path;

use serde_json::{Value, json};

use super::case::{Done, extra};
use super::summary::Outcome;
use crate::composition::{Estimate, Outline};
use crate::output::is_vector;
use crate::petsc;
use crate::scene::Scene;
use crate::warnings::Warning;

/// What a run did, with its results at `out`: the last row of the history under its names there.
pub fn outcome(scene: &Scene, done: &Done, out: &Path) -> Value {
    let Done { outcome: Outcome { status, ranks, unknowns, setup, total, counts }, last, warnings, result, in_space } =
        done;
    json!({
        "title": scene.title,
        "status": status.as_str(),
        "error": result.as_ref().err().map(ToString::to_string),
        "results": out.display().to_string(),
        "warnings": warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "last": last.values(extra(scene))
            .map(|(name, numbers)| (name.to_owned(), number(*in_space, name, numbers)))
            .collect::<serde_json::Map<_, Value>>(),
        "steps": counts.steps,
        "pieces": counts.pieces,
        "rejected": counts.rejected,
        "newton_iterations": counts.newton,
        "transforms": counts.work.transforms,
        "ranks": ranks,
        "unknowns": unknowns,
        "wall_seconds": total.as_secs_f64(),
        "setup_seconds": setup.as_secs_f64(),
        "peak_memory_bytes": petsc::peak_memory(),
    })
}

/// A number, or in space the components of a vector.
fn number(in_space: bool, name: &str, [x, y]: [f64; 2]) -> Value {
    if in_space && is_vector(name) { json!([x, y]) } else { x.into() }
}

/// What a run would do.
pub fn plan(scene: &Scene, outline: &Outline, warnings: &[Warning]) -> Value {
    let estimate = Estimate::of(scene, outline);
    json!({
        "title": scene.title,
        "warnings": warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "unknowns": outline.unknowns,
        "steps": scene.steps(),
        "duration": scene.duration(),
        "seconds_per_step": estimate.step,
        "seconds": estimate.step * scene.steps() as f64,
        "memory_bytes": estimate.memory,
        "result_bytes": scene.result_bytes().map(|[_, all]| all),
        "penalty": scene.contact.stiffness().or(outline.penalty),
    })
}
