//! The work-precision diagram: error against seconds, a curve for each ladder.

use super::Climbed;
use super::advice::Advice;
use crate::plot::{Axis, Curve, Figure, PALETTE, REFERENCE, Stroke};

/// Error against time, for each ladder over the scene as it is, and what is advised.
pub fn work_precision(title: &str, climbed: &[Climbed], advised: &[Option<Advice>]) -> Figure {
    let strokes = [Stroke::Solid, Stroke::Dashed, Stroke::Dotted];
    let curve = |(i, ladder): (usize, &Climbed)| {
        // The last of several alternatives has no error beside the others.
        let told = ladder.rungs.iter().filter(|rung| rung.error > 0.0);
        let points = told.filter_map(|rung| Some((rung.run.as_ref()?.seconds, rung.error)));
        Curve {
            label: ladder.ladder.name.clone(),
            points: points.collect(),
            colour: PALETTE[i % PALETTE.len()],
            stroke: strokes[i / PALETTE.len() % strokes.len()],
        }
    };
    let rings =
        |(i, ladder): (usize, &Climbed)| Curve { label: String::new(), stroke: Stroke::Points, ..curve((i, ladder)) };
    let points = advised.iter().flatten().map(|advice| (advice.seconds, advice.error)).collect();
    let label = "advised, all settings together".to_owned();
    let advice = Curve { label, points, colour: REFERENCE, stroke: Stroke::Points };
    let lines = climbed.iter().enumerate().map(curve);
    Figure::new(
        title,
        Axis::log("time of the run, s"),
        Axis::log("error of the forces, relative"),
        lines.chain(climbed.iter().enumerate().map(rings)).chain([advice]).collect(),
    )
}
