//! A start for Newton's method where it finds no way from where the contact was.
//!
//! Two Gauss points to an edge are twice as many as its nodes, so that there are tractions which together do nothing; a penalty
//! alone decides between them, and the stiffer it is, the less. Newton's method from where the contact was then finds no way
//! to which of the points carry; nor does it, now and then, to which of the nodes slip which way. It does from softer laws, whose answer is never far from that of laws a little stiffer: so they are
//! met one after the other (continuation; Allgower and Georg, Numerical Continuation Methods, 1990). Before and after that, all
//! points meet the laws one by one for a while ([`super::sweep`]), which takes Newton's method out of a circle among a few states.

use nalgebra::SVector;

use super::fold::branches;
use super::search::{Operator, Outcome, settle};
use super::sweep::sweep;
use super::{Laws, Sites};
use crate::error::Result;
use crate::friction::{Circumstances, ElasticSlip, Lasting, Law, Share, Strength};

/// Iterations from where the contact was, before laws are softened, and of each softer law.
const DIRECT: usize = 20;
const EACH: usize = 12;
/// The softest penalty and friction's sharpness, beside the body's own; and how much stiffer the next are.
const SOFTEST: f64 = 1e-1;
const STIFFER: f64 = 10.0;
const MOST_STAGES: i32 = 20;
/// Beyond this nothing is left to be softened of laws that are exact.
const NEARLY_EXACT: f64 = 1e9;

/// How often it begins anew, the second time from softer laws, else from where points met the laws one by one; and how many sweeps
/// over them that takes.
const ROUNDS: usize = 4;
const SWEEPS: usize = 50;

/// Tractions near where the laws hold, from others.
pub fn start<const D: usize>(
    sites: &Sites<D>,
    from: Outcome<D>,
    laws: Laws<'_>,
    operator: Operator<'_, D>,
    tolerance: f64,
) -> Result<Outcome<D>> {
    if let Some(found) = branches(sites, &from, laws, operator, tolerance)? {
        return Ok(found);
    }
    let direct = settle(sites, from.clone(), laws, operator, DIRECT)?;
    let largest = from.size();
    let holds = |at: &Outcome<D>| at.norm() <= (tolerance * at.size().max(largest)).max(at.noise());
    if holds(&direct) {
        return Ok(direct);
    }
    let mut best = direct;
    let mut at = best.clone();
    for round in 0..ROUNDS {
        at = match round {
            1 => from_softer_laws(sites, from.clone(), laws, operator)?,
            _ => settle(sites, sweep(sites, at, laws, operator.0, SWEEPS), laws, operator, EACH)?,
        };
        if at.norm() < best.norm() {
            best = at.clone();
        }
        if holds(&best) {
            break;
        }
    }
    Ok(best)
}

/// Through softer laws, met one after the other.
fn from_softer_laws<const D: usize>(
    sites: &Sites<D>,
    mut at: Outcome<D>,
    laws: Laws<'_>,
    operator: Operator<'_, D>,
) -> Result<Outcome<D>> {
    let rho = sites.iter().fold(0.0, |most: f64, site| most.max(site.moduli.normal));
    let slip = sites.iter().map(|site| site.relative(&SVector::zeros()).slip.norm()).fold(0.0, f64::max);
    for stage in 0..MOST_STAGES {
        let stiffness = SOFTEST * STIFFER.powi(stage);
        let soft = stiffness * rho;
        let penalty = laws.penalty.map_or(soft, |penalty| penalty.min(soft));
        let softened = laws.friction.map(|law| softer(law, laws.dt, (slip, stiffness)));
        let softer = Laws { penalty: Some(penalty), friction: softened.as_deref(), ..laws };
        let answered = at.under(sites, softer);
        at = settle(sites, answered, softer, operator, EACH)?;
        let sharp = laws.friction.is_none_or(|law| law.sharpness(laws.dt) * stiffness >= slip);
        if laws.penalty == Some(penalty) && sharp || stiffness > NEARLY_EXACT {
            break;
        }
    }
    settle(sites, at.under(sites, laws), laws, operator, EACH)
}

/// The law with a shear that turns over a slip no shorter than `slip`, m, over a stiffness.
fn softer(law: &dyn Law, dt: f64, (slip, stiffness): (f64, f64)) -> Box<dyn Law + '_> {
    match law.sharpness(dt) {
        0.0 => Box::new(ElasticSlip { strength: law.strength().clone(), elastic_slip: slip / stiffness }),
        sharpness => Box::new(Softened { law, share: (sharpness * stiffness / slip).min(1.0) }),
    }
}

/// A law whose shear turns over a slip that is longer by 1/share.
#[derive(Debug)]
struct Softened<'a> {
    law: &'a dyn Law,
    share: f64,
}

impl Law for Softened<'_> {
    fn strength(&self) -> &Strength {
        self.law.strength()
    }

    fn share(&self, at: Circumstances, slip: f64) -> Share {
        let Share { value, by_slip } = self.law.share(at, slip * self.share);
        Share { value, by_slip: by_slip * self.share }
    }

    fn lasting(&self, slip: f64) -> Lasting {
        self.law.lasting(slip)
    }

    fn sharpness(&self, dt: f64) -> f64 {
        self.law.sharpness(dt) / self.share
    }

    fn sticks(&self, at: Circumstances, slip: f64) -> bool {
        self.law.sticks(at, slip * self.share)
    }
}
