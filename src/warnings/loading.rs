//! Whether friction and the steps are fine enough for the motions that they are to follow.

use nalgebra::Vector2;

use super::encounter::Encounter;
use super::{Before, Warning, above, phase};
use crate::loading::{Motion, Phase};
use crate::rheology::Prony;
use crate::scene::{Memory, Scene, Stepping};

/// The regularisation over the slowest motion that friction resists; the elastic slip over the shortest.
pub const MOST_REGULARISED: f64 = 0.01;
/// Steps to a cycle.
pub const FEWEST_STEPS_TO_A_CYCLE: f64 = 8.0;
/// An arm matters to a motion over a time t where it takes this share of the modulus, w 2x/(1 + x^2) with x = time/t.
pub const ARM_THAT_MATTERS: f64 = 0.02;
/// Steps to a motion, with the exponential memory: it is exact along the straight path over a step, whatever the arm is. With
/// fewer, N or Q are off by one per cent and more.
pub const FEWEST_STEPS_TO_A_MOTION: f64 = 4.0;

/// Its length, s; none where steps are chosen as the phase goes.
fn step(scene: &Scene, index: usize) -> Option<f64> {
    let phase = scene.phases.get(index)?;
    match phase.stepping {
        Stepping::Steps(steps) => Some(phase.duration / steps as f64),
        Stepping::Tolerance(_) => None,
    }
}

/// As [`Phase::turns`] has it.
type Turn = (f64, Vector2<f64>);

/// The speeds at which the indenter moves, m/s: towards the face, and along it, on average over a cycle.
fn speeds(phase: &Phase) -> [f64; 2] {
    let turns = phase.turns();
    let way = |part: fn(&Turn, &Turn) -> f64| turns.windows(2).map(|pair| part(&pair[0], &pair[1])).sum::<f64>();
    let along = match phase.motion {
        Motion::Velocity(velocity) => velocity.norm(),
        Motion::Sinusoid { amplitude, cycles, .. } => 4.0 * amplitude.norm() * cycles / phase.duration,
        Motion::Measured(_) => way(|one, other| (other.1 - one.1).norm()) / phase.duration,
    };
    let [from, to] = phase.approach;
    let towards = match phase.measured {
        Some(_) => way(|one, other| (other.0 - one.0).abs()),
        None => (to - from).abs(),
    };
    [towards / phase.duration, along]
}

/// Above [`MOST_REGULARISED`] of the slowest motion in contact.
pub fn regularisation(before: &Before<'_>) -> Option<Warning> {
    let friction = before.scene.friction.as_ref().filter(|friction| !friction.is_none())?;
    let regularisation = friction.law.rate()?;
    let named = |phase: &Phase| {
        let [towards, along] = speeds(phase);
        [(towards, "approach"), (along, "sliding")].map(|(speed, what)| (speed, what, phase.name.clone()))
    };
    let motions = before.encounters.moving().flat_map(|(_, phase, _)| named(phase)).filter(|(speed, ..)| *speed > 0.0);
    let (slowest, what, name) = motions.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let share = regularisation / slowest;
    if !above(share, MOST_REGULARISED) {
        return None;
    }
    let text = format!(
        "{regularisation:.3e} m/s is {share:.3} times the slowest motion that friction resists, the {what} of {name:?} at \
         {slowest:.3e} m/s (more than {MOST_REGULARISED}): what should stick creeps; give {:.1e} m/s or less, or law = \
         \"coulomb_elastic_slip\"",
        MOST_REGULARISED * slowest
    );
    Some(Warning::new("friction.regularisation", text))
}

/// Above [`MOST_REGULARISED`] of the shortest motion in contact, or of coefficient times overlap, which is about what an
/// approach or the onset of sliding displaces the face by.
pub fn elastic_slip(before: &Before<'_>) -> Option<Warning> {
    let friction = before.scene.friction.as_ref()?;
    let elastic_slip = friction.law.slip()?;
    // Of a formula nobody knows the coefficient beforehand.
    let coefficient = friction.coefficient().unwrap_or(1.0);
    let range = |phase: &Phase| {
        let [least, most] = phase.sliding_range(0);
        most - least
    };
    let slides = before.encounters.moving().map(|(_, phase, _)| range(phase)).filter(|range| *range > 0.0);
    let shortest = slides.fold(coefficient * before.encounters.deepest().overlap, f64::min);
    let share = elastic_slip / shortest;
    // Without friction or contact there is no motion that it resists.
    if shortest <= 0.0 || !above(share, MOST_REGULARISED) {
        return None;
    }
    let text = format!(
        "{elastic_slip:.3e} m is {share:.3} times the shortest motion that friction resists, {shortest:.3e} m (more than \
         {MOST_REGULARISED}): what should stick slips; give {:.1e} m or less",
        MOST_REGULARISED * shortest
    );
    Some(Warning::new("friction.elastic_slip", text))
}

/// Fewer than [`FEWEST_STEPS_TO_A_CYCLE`].
pub fn cycles(before: &Before<'_>) -> Option<Warning> {
    let found = before.encounters.course.iter().enumerate().find_map(|(index, phase)| {
        let Motion::Sinusoid { cycles, amplitude, .. } = phase.motion else { return None };
        let steps = phase.duration / step(before.scene, index)? / cycles;
        (amplitude.amax() != 0.0 && above(FEWEST_STEPS_TO_A_CYCLE, steps)).then_some((index, steps, cycles))
    });
    let (index, steps, cycles) = found?;
    let text = format!(
        "{steps:.2} steps to a cycle, fewer than {FEWEST_STEPS_TO_A_CYCLE}: the motion is lost between them; give steps = {:.0} \
         or more, or a tolerance",
        (5.0 * FEWEST_STEPS_TO_A_CYCLE * cycles).ceil()
    );
    Some(Warning::new(phase(before.scene, index, "steps"), text))
}

/// A step longer than an arm that matters to the motion it is part of, see [`ARM_THAT_MATTERS`]; with the exponential memory,
/// where it is also longer than the path of the motion is straight.
pub fn arms(before: &Before<'_>) -> Option<Warning> {
    let exact = before.scene.materials.iter().all(|material| material.memory == Memory::Exponential);
    let worst = before.encounters.moving().filter_map(|(index, phase, met)| {
        let step = step(before.scene, index)?;
        motions(phase, met).into_iter().find_map(|(motion, straight)| {
            let arm = shortest_arm(before.scene, motion)?;
            let longest = if exact { arm.max(straight) } else { arm };
            above(step, longest).then_some((index, step, arm, motion))
        })
    });
    let (index, step, arm, motion) = worst.max_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2)))?;
    let text = format!(
        "steps of {step:.3e} s are {:.1} times the arm of {arm:.3e} s, which matters to a motion over {motion:.2e} s: its \
         relaxation is not resolved; give steps = {:.0} or more, or a tolerance",
        step / arm,
        (2.0 * before.scene.phases[index].duration / arm).ceil()
    );
    Some(Warning::new(phase(before.scene, index, "steps"), text))
}

/// How long what a point of the face feels takes to change, s, and for how long the path is straight: an approach, which is
/// so throughout; the passage of the contact or a quarter of a cycle, a part of it.
fn motions(phase: &Phase, met: &Encounter) -> Vec<(f64, f64)> {
    let [towards, _] = speeds(phase);
    let mut list = Vec::new();
    if towards > 0.0 {
        list.push((phase.duration, phase.duration));
    }
    list.extend(passage(phase, met).map(|passage| (passage, passage / FEWEST_STEPS_TO_A_MOTION)));
    list
}

/// How long the contact takes to pass a point of the face, s, where it slides; of cycles, a quarter of one.
pub fn passage(phase: &Phase, met: &Encounter) -> Option<f64> {
    let [_, along] = speeds(phase);
    (along > 0.0).then(|| match phase.motion {
        Motion::Velocity(_) | Motion::Measured(_) => (met.contact()[0] / along).min(phase.duration),
        Motion::Sinusoid { cycles, .. } => phase.duration / (4.0 * cycles).max(1.0),
    })
}

/// The shortest arm that matters to a motion over the time `motion`, s.
fn shortest_arm(scene: &Scene, motion: f64) -> Option<f64> {
    let matters = |series: &Prony| {
        let mut rest = series.long_term();
        let mut arms = series.arms.clone();
        arms.sort_by(|a, b| b.time.total_cmp(&a.time));
        let mut shortest: Option<f64> = None;
        for arm in arms {
            rest += arm.weight;
            let x = arm.time / motion;
            if arm.weight / rest * 2.0 / (x + 1.0 / x) >= ARM_THAT_MATTERS {
                shortest = Some(arm.time);
            }
        }
        shortest
    };
    let series = scene.materials.iter().flat_map(|material| [material.shear_series(), material.bulk_series()]);
    series.filter_map(|series| matters(&series)).min_by(f64::total_cmp)
}
