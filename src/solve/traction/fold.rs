//! Friction that weakens as a point slips: the face then has several states, and may have to jump from one to another.
//!
//! Newton's method goes on from where the tractions went, and so along a state as long as there is one. Where that ends, at a fold,
//! the face is tried as it would be if it stuck, and then as it would be if it slipped fast. A jump to fast slip is one of the
//! equations only where friction rises again there, or where the mount has a mass, which takes time for it; otherwise what
//! follows depends on nothing but the step, and it is refused.

use super::search::{Operator, Outcome, settle};
use super::{Answer, Laws, Sites};
use crate::error::Result;
use crate::friction::{Circumstances, Lasting, Rebound};

/// Newton iterations of each attempt.
const EACH: usize = 25;
/// A jump slips by more than so many times what was to be expected of a step, and leaves less than this share of the shear.
const FARTHER: f64 = 2.0;
const LEFT: f64 = 0.95;

/// A state near the given one by sticking, or else by slipping fast, where laws hold; none where neither does.
pub fn branches<const D: usize>(
    sites: &Sites<D>,
    from: &Outcome<D>,
    laws: Laws<'_>,
    operator: Operator<'_, D>,
    tolerance: f64,
) -> Result<Option<Outcome<D>>> {
    let Some(law) = laws.friction.filter(|law| law.strength().varies()) else { return Ok(None) };
    let pressure = from.answers.iter().map(|(_, answer)| answer.pressure).fold(0.0, f64::max);
    let slid = sites.iter().map(|site| site.slid).fold(0.0, f64::max);
    let temperature = sites.iter().map(|site| site.temperature).fold(0.0, f64::max);
    let at = Circumstances { pressure, dt: laws.dt, resolution: 0.0, slid, temperature };
    for rate in [0.0, law.strength().weakest(at)] {
        // The strength is that of the rate, m/s, whatever a point slips.
        let bound = |at: Circumstances, _| law.strength().at(at, Lasting { length: rate * at.dt, by_slip: 0.0 });
        let frozen = Rebound { law, bound };
        let first = from.clone().under(sites, Laws { friction: Some(&frozen), ..laws });
        let first = settle(sites, first, Laws { friction: Some(&frozen), ..laws }, operator, EACH)?;
        let found = settle(sites, first.under(sites, laws), laws, operator, EACH)?;
        let holds = found.norm() <= tolerance * found.size().max(from.size());
        if holds && (rate == 0.0 || stays(sites, &found, laws)) {
            return Ok(Some(found));
        }
    }
    Ok(None)
}

/// Whether a state that was met is one that the step jumped to and that nothing but the step decides. `usual` is what a point was
/// to slip in the step, m, `before` the shears that were accepted, Pa. Collective.
pub fn jumped<const D: usize>(
    sites: &Sites<D>,
    to: &Outcome<D>,
    laws: Laws<'_>,
    (usual, before): (f64, &[f64]),
) -> bool {
    let Some(law) = laws.friction.filter(|law| law.strength().varies()) else { return false };
    let (mut slipped, mut pressed, mut sheared, mut was) = (0.0, 0.0, 0.0, 0.0);
    was += sites.iter().zip(before).map(|(site, before)| site.weight * before).sum::<f64>();
    for (i, answer) in &to.answers {
        let site = &sites[*i];
        let pressure = site.weight * answer.pressure;
        slipped += pressure * law.lasting(answer.slip.norm()).length;
        pressed += pressure;
        sheared += site.weight * answer.shear.norm();
    }
    let [slipped, pressed, sheared, was] = sites.team().sum([slipped, pressed, sheared, was]);
    slipped > FARTHER * usual * pressed && sheared < LEFT * was && !stays(sites, to, laws)
}

/// Whether the face would stay in fast slip: friction rises again there, or a mass holds the indenter.
fn stays<const D: usize>(sites: &Sites<D>, at: &Outcome<D>, laws: Laws<'_>) -> bool {
    let Some(law) = laws.friction else { return true };
    let rise = |(i, answer): &(usize, Answer<D>)| {
        let site = &sites[*i];
        site.weight * law.bound(site.circumstances(answer.pressure, laws), answer.slip.norm()).by_slip
    };
    let inert = laws.held.supports[1..].iter().flatten().any(|support| support.inert);
    let slipping = at.answers.iter().filter(|(_, answer)| answer.active && !answer.sticks);
    let [risen] = sites.team().sum([slipping.map(rise).sum::<f64>()]);
    inert || risen > 0.0
}
