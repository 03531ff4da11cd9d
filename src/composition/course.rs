//! The loading history of a scene: its phases end to end, and their steps.

use std::collections::HashSet;

use nalgebra::Vector2;

use crate::error::Result;
use crate::interface::Interface;
use crate::loading::{self, Adaptive, Moment, Motion, Phase, Placement, Track};
use crate::scene::{self, Scene, Stepping, When};
use crate::solve::TransientProblem;

/// The gap to close before the indenter touches the face at rest, m; only for scenes with adaptive steps.
pub(super) fn clearance<const D: usize>(scene: &Scene, interface: &mut Interface<D>) -> Result<f64> {
    if !scene.is_adaptive() {
        return Ok(0.0);
    }
    interface.place(Placement::default())?;
    let points = interface.points().all().iter().enumerate();
    let gaps = points.map(|(i, point)| interface.clearance(i, 0.0) * point.normal[D - 1]);
    Ok(interface.team().least(gaps.fold(f64::INFINITY, f64::min)))
}

/// The greatest penetration of the undeformed face that a history asks for, m, by approaches, by forces or on a mount; only for scenes with adaptive
/// steps. The indenter touches after an approach by `clearance`, m.
pub(super) fn penetration(scene: &Scene, strategy: &mut dyn TransientProblem, clearance: f64) -> Result<f64> {
    let (force, place) = scene.mounted().unwrap_or((scene.greatest_force(), scene.deepest()));
    let pressed = match scene.is_adaptive() && force > 0.0 {
        true => Some(strategy.approach_under(force, scene.duration())?),
        false => None,
    };
    // A mount brings the indenter no deeper than its force presses it, nor than its far end goes.
    let reached = if scene.mounted().is_some() { f64::min } else { f64::max };
    let deepest = pressed.map_or(place, |pressed| reached(place, pressed)) - clearance;
    // What never touches, or just so, is given its way of getting there.
    Ok(if deepest > 0.0 { deepest } else { clearance.abs().max(1e-200) })
}

/// The phases end to end, each from where the one before left the indenter, without their steps.
pub fn course(scene: &Scene) -> Vec<Phase> {
    let (mut start, mut approach, mut sliding, mut held) = (0.0, 0.0, Vector2::zeros(), None);
    let mut list = Vec::with_capacity(scene.phases.len());
    for phase in &scene.phases {
        let pressed = phase.record().and_then(|record| track(record, &record.normal_force));
        let lowered = phase.record().and_then(|record| track(record, &record.approach));
        let end = |track: &Option<Track<f64>>, from: f64| track.as_ref().map(|track| track.at(from, phase.duration));
        let from = held.unwrap_or(0.0);
        let said = (phase.normal_force.or(end(&pressed, from)), phase.approach.or(end(&lowered, approach)));
        let force = match said {
            (Some(force), _) => Some([from, force]),
            (None, Some(_)) => None,
            (None, None) => held.map(|force| [force, force]),
        };
        // Nobody knows where a force leaves the indenter, nor with what force an approach does.
        let from_there = !list.is_empty() && (held.is_some() || force.is_some());
        held = force.map(|[_, force]| force);
        let to = said.1.unwrap_or(approach);
        let motion = match &phase.motion {
            scene::Motion::Velocity(velocity) => Motion::Velocity(*velocity),
            scene::Motion::Tangential { amplitude, cycles, phase } => {
                Motion::Sinusoid { amplitude: *amplitude, cycles: *cycles, phase: phase.map(f64::to_radians) }
            }
            scene::Motion::Measured(record) if record.slides() => Motion::Measured(Track::new(record.slid())),
            scene::Motion::Measured(_) => Motion::Velocity(Vector2::zeros()),
        };
        let phase = Phase {
            name: phase.name.clone(),
            start,
            duration: phase.duration,
            approach: [approach, to],
            force,
            measured: pressed.or(lowered),
            from_there,
            sliding,
            motion,
            steps: Vec::new(),
            adaptive: None,
        };
        (start, approach, sliding) = (phase.end(), to, phase.final_sliding());
        list.push(phase);
    }
    list
}

/// The path of a measured column; none where there is none.
fn track(record: &scene::Record, column: &[f64]) -> Option<Track<f64>> {
    (!column.is_empty()).then(|| Track::new(record.rows(column)))
}

/// The moments at which steps of a phase end, besides those of equal steps: where bulk fields are asked for, `bulk`, s, and in adaptive steps
/// the rows of what was measured.
fn moments(phase: &Phase, bulk: &[f64], adaptive: bool) -> Vec<Moment> {
    let rows = if adaptive { phase.rows() } else { Vec::new() };
    let rows = rows.into_iter().map(|row| Moment { time: phase.start + row, bulk_output: false });
    let mut all: Vec<Moment> = bulk.iter().map(|time| Moment { time: *time, bulk_output: true }).chain(rows).collect();
    all.sort_by(|one, other| one.time.total_cmp(&other.time));
    // Two moments this close are one.
    let near = 1e-9 * phase.duration;
    all.dedup_by(|next, kept| {
        let same = next.time - kept.time <= near;
        kept.bulk_output |= same && next.bulk_output;
        same
    });
    all
}

/// How fast a dead load sets the indenter moving, m/s: at once where nothing slows it down.
fn dropping(scene: &Scene) -> f64 {
    let end = scene.mount.and_then(|mount| mount.normal).unwrap_or_default();
    match end.load.unwrap_or(0.0) {
        load if load > 0.0 && end.mass == 0.0 => load / end.damping,
        _ => 0.0,
    }
}

/// The phases with their steps; a step ends at every moment that bulk output asks for. Tolerances are shares of a penetration `scale`, m.
pub fn phases(scene: &Scene, scale: f64) -> Vec<Phase> {
    let greatest = scene.greatest_force();
    let mut rates = (0.0, Vector2::zeros());
    let at = &scene.output.bulk_at;
    let moment = |when: &When| if let When::Time(t) = when { Some(*t) } else { None };
    let mut bulk: Vec<f64> = at.iter().filter_map(moment).collect();
    let ends: HashSet<&str> = at.iter().filter_map(When::phase_end).collect();
    bulk.sort_by(f64::total_cmp);
    let mut list = course(scene);
    for (phase, said) in list.iter_mut().zip(&scene.phases) {
        let (count, tolerance) = match said.stepping {
            Stepping::Steps(steps) => (steps, None),
            Stepping::Tolerance(tolerance) => (1, Some(tolerance)),
        };
        let moments = moments(phase, &bulk, tolerance.is_some());
        phase.steps = loading::targets(phase.start, phase.duration, count, &moments);
        if let Some(last) = phase.steps.last_mut() {
            last.bulk_output |= ends.contains(phase.name.as_str());
        }
        let after = phase.rates(phase.start);
        // A force that rises presses the indenter in at about this rate.
        let pressed = phase.force.map_or(0.0, |[from, to]| (to - from).abs() / greatest * scale / phase.duration);
        let pressed = if greatest > 0.0 { pressed } else { 0.0 };
        let pressed = if phase.start == 0.0 { pressed + dropping(scene) } else { pressed };
        let jump = (after.0 - rates.0).abs() + (after.1 - rates.1).norm() + pressed;
        phase.adaptive = tolerance.map(|tolerance| Adaptive::new(phase, tolerance * scale, jump));
        rates = phase.rates(phase.end());
    }
    list
}
