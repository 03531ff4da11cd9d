//! How far a force presses the indenter into a body at rest, about: the scale of adaptive steps.

use nalgebra::SVector;

use super::{Behind, up};
use crate::error::Result;

/// Iterations at most; a dozen is usual.
const MOST: usize = 200;
/// The change of the approach in an iteration, over the approach, at which it is known well enough for a scale.
const ENOUGH: f64 = 1e-3;

/// The approach, m, under `force`, N/m or N, without friction, of an indenter that is placed at no approach over a face at rest. Collective.
///
/// Conjugate gradients for the pressures, kept at no tension and at the force (Polonsky and Keer, Wear 231 (1999) 206):
/// gap = clearance + d(p) + p/alpha - D n_z.
pub fn approach_under<const D: usize>(behind: &Behind<'_, D>, force: f64) -> Result<f64> {
    let (points, team) = (behind.interface.points().all(), behind.interface.team());
    let upward: Vec<f64> = points.iter().map(|point| point.normal.dot(&up::<D>())).collect();
    let weight: Vec<f64> = points.iter().map(|point| point.weight).collect();
    let softness = behind.interface.penalty().map_or(0.0, |alpha| 1.0 / alpha);
    let clearance: Vec<f64> =
        upward.iter().enumerate().map(|(i, upward)| behind.interface.clearance(i, 0.0) * upward).collect();
    let indentation = |p: &[f64]| -> Result<Vec<f64>> {
        let tractions: Vec<SVector<f64, D>> = points.iter().zip(p).map(|(point, p)| -point.normal * *p).collect();
        let moves = behind.moves(&tractions)?;
        Ok(moves.iter().zip(points).zip(p).map(|((u, point), p)| softness * p - point.normal.dot(u)).collect())
    };
    // Less the part that the approach makes good, over the points in contact.
    let levelled = |list: &mut [f64], p: &[f64]| {
        let touching = || (0..p.len()).filter(|&i| p[i] > 0.0);
        let sum = |value: &dyn Fn(usize) -> f64| touching().map(|i| weight[i] * value(i)).sum::<f64>();
        let [above, over] = team.sum([sum(&|i| list[i] * upward[i]), sum(&|i| upward[i] * upward[i])]);
        let level = above / over;
        list.iter_mut().zip(&upward).for_each(|(value, upward)| *value -= level * upward);
        level
    };
    let at_force = |p: &mut [f64]| {
        let carried: f64 = p.iter().zip(&weight).zip(&upward).map(|((p, w), upward)| p * w * upward).sum();
        let [carried] = team.sum([carried]);
        p.iter_mut().for_each(|p| *p *= force / carried);
    };
    let mut p = vec![1.0; points.len()];
    at_force(&mut p);
    let (mut along, mut before, mut approach) = (vec![0.0; p.len()], f64::INFINITY, f64::INFINITY);
    for _ in 0..MOST {
        let mut gap: Vec<f64> = indentation(&p)?.iter().zip(&clearance).map(|(d, c)| d + c).collect();
        let level = levelled(&mut gap, &p);
        let touches: Vec<bool> = p.iter().map(|p| *p > 0.0).collect();
        let dot = |a: &[f64], b: &[f64]| -> f64 {
            let [sum] = team.sum([(0..a.len()).filter(|&i| touches[i]).map(|i| weight[i] * a[i] * b[i]).sum()]);
            sum
        };
        let size = dot(&gap, &gap);
        let enough = (level - approach).abs() <= ENOUGH * level.abs();
        approach = level;
        if enough || size == 0.0 {
            break;
        }
        let share = size / before;
        for ((along, gap), touches) in along.iter_mut().zip(&gap).zip(&touches) {
            *along = if *touches { gap + share * *along } else { 0.0 };
        }
        let mut answer = indentation(&along)?;
        levelled(&mut answer, &p);
        let length = dot(&gap, &along) / dot(&answer, &along);
        before = size;
        let mut anew = false;
        for (((p, along), gap), touches) in p.iter_mut().zip(&along).zip(&gap).zip(&touches) {
            if *touches {
                *p = (*p - length * along).max(0.0);
            } else if *gap < 0.0 {
                (*p, anew) = (-length * gap, true);
            }
        }
        if team.any(anew) {
            before = f64::INFINITY;
        }
        at_force(&mut p);
    }
    Ok(approach)
}
