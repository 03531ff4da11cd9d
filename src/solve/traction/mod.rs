//! The contact face solved for its tractions.
//!
//! Behind the face stands a body that answers the tractions t = q - p n on the layer linearly, with the motion M = M_free + C t.
//! At each point, with the overlap o = M.n - c and the slip s = T (V dt - (M - M_old)) + e_n (crate::element::mpjr), any moduli
//! rho > 0 make of the laws a projection:
//!
//! ```text
//! p* = alpha/(alpha + rho_n) max(p + rho_n o, 0)                    where nothing wears or pulls; else see `worn`, crate::adhesion
//! q* = |q|(m) e,    m >= 0 where |q|(m) + rho_t m = |q + rho_t s|,    e along q + rho_t s
//! G  = t - t*
//! ```
//!
//! G is a traction, and zero exactly where the laws hold, whatever rho (Alart and Curnier, Comput. Methods Appl. Mech. Engrg. 92
//! (1991) 353, with the laws' own softness). No penetration, alpha = infinity, and Coulomb's law itself are ordinary values:
//! nothing stiff is left in G. Newton's method on it is `linear`.

mod adhesive;
mod behind;
mod bounded;
mod continuation;
mod dense;
mod fold;
mod fourier;
mod held;
mod krylov;
mod linear;
mod pointwise;
mod pressed;
mod search;
mod sites;
mod stable;
mod sweep;
mod worn;

use nalgebra::SVector;

use crate::adhesion;
use crate::element::mpjr::Relative;
use crate::friction::{Circumstances, Law, Met};
use crate::interface::State;
use crate::wear::Wear;

pub use adhesive::Damping;
use adhesive::bears;
pub use behind::Behind;
pub use bounded::pressures;
pub use continuation::start;
pub use dense::Factor;
pub use fold::jumped;
pub use fourier::Fourier;
pub use held::{Border, Held, Over, against, axis, column, down_to, in_plane, places, shift, steepening, touch, up};
pub use krylov::System;
pub use linear::{Linearised, product};
pub use pointwise::Pointwise;
pub use pressed::approach_under;
pub use search::{Along, Operator, Outcome, length, settle};
pub use sites::Sites;
pub use stable::is_stable;

/// A point of the contact during a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Site<const D: usize> {
    /// n
    pub normal: SVector<f64, D>,
    /// The length, or area, that it stands for.
    pub weight: f64,
    /// c n_z, m: o = M.n less this.
    pub clearance: f64,
    /// V dt + M_old + e_n, m: s = T of this less T M.
    pub drive: SVector<f64, D>,
    /// e_n, m
    pub elastic: SVector<f64, D>,
    /// What it has slid for good, m.
    pub slid: f64,
    /// Its temperature at the beginning of the step, K.
    pub temperature: f64,
    /// What the layer's answer to the point's own traction asks for.
    pub moduli: Moduli,
    /// What holds its overlap back while a jump is followed; none = nothing.
    pub damping: Option<Damping>,
    /// What the digits of o and of s are taken from, m.
    pub lengths: [f64; 2],
}

/// rho, Pa/m, for the normal and the tangential law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moduli {
    /// rho_n
    pub normal: f64,
    /// rho_t; none where the layer is held along the face, so that the slip is known and the law explicit.
    pub tangential: Option<f64>,
}

impl Moduli {
    /// With a tangential one of twice `fall`, Pa/m, at least: a law that falls no steeper meets a spring of that once.
    fn above(self, fall: f64) -> Self {
        Self { tangential: self.tangential.map(|rho| rho.max(2.0 * fall)), ..self }
    }

    /// With a normal one of twice the steepest fall of adhesion at least.
    fn above_adhesion(self, law: Option<&dyn adhesion::Law>) -> Self {
        Self { normal: law.map_or(self.normal, |law| self.normal.max(2.0 * law.steepest_fall())), ..self }
    }
}

/// The laws of a step.
#[derive(Debug, Clone, Copy)]
pub struct Laws<'a> {
    /// alpha, Pa/m; none = no penetration.
    pub penalty: Option<f64>,
    /// None = frictionless.
    pub friction: Option<&'a dyn Law>,
    /// None = nothing wears.
    pub wear: Option<Wear>,
    /// None = nothing pulls.
    pub adhesion: Option<&'a dyn adhesion::Law>,
    /// The length of the step, s.
    pub dt: f64,
    /// See [`Circumstances::resolution`], m: 0 but where displacements are to say the same.
    pub resolution: f64,
    /// What holds the indenter.
    pub held: Held<'a>,
}

/// What the laws make of a traction and a motion at one point, with derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer<const D: usize> {
    /// p*, Pa.
    pub pressure: f64,
    /// q*, Pa.
    pub shear: SVector<f64, D>,
    /// G = t - t*, Pa.
    pub excess: SVector<f64, D>,
    /// Whether its pressure is one of the unknowns: where nothing pulls, whether p + rho_n o > 0, the point in contact.
    pub active: bool,
    /// The gap, m; 0 where it is closed, or the point is not active.
    pub gap: f64,
    /// theta = alpha/(alpha + rho_n), less where it wears, and 1 - theta to all its digits.
    pub stiff: f64,
    /// See `stiff`.
    pub soft: f64,
    /// K/(K + rho_t) along e and across it, K the slope of |q| and its secant, and 1 less each.
    pub grip: [f64; 2],
    /// See `grip`.
    pub slack: [f64; 2],
    /// e, of no length where nothing pulls.
    pub direction: SVector<f64, D>,
    /// d|q|/dp
    pub drag: f64,
    /// s as the law leaves it: m e, m.
    pub slip: SVector<f64, D>,
    /// Whether it sticks.
    pub sticks: bool,
    /// What the step wears, m.
    pub worn: f64,
    /// How the pressure goes with the shear, -, and with the slip, Pa/m, through what wears: see `worn`.
    pub wearing: [f64; 2],
    /// The square of what round-off leaves of G, Pa^2.
    pub noise: f64,
}

impl<const D: usize> Site<D> {
    /// Overlap and slip under a motion M.
    pub fn relative(&self, motion: &SVector<f64, D>) -> Relative<D> {
        let past = self.drive - motion;
        let slip = past - self.normal * self.normal.dot(&past);
        Relative { overlap: self.normal.dot(motion) - self.clearance, slip, normal: self.normal }
    }

    /// What the laws make of a traction and a motion.
    pub fn answer(&self, traction: &SVector<f64, D>, motion: &SVector<f64, D>, laws: Laws<'_>) -> Answer<D> {
        let Relative { overlap, slip, normal } = self.relative(motion);
        let rho = self.moduli.normal;
        let pressure = -normal.dot(traction);
        let shear = traction + normal * pressure;
        let trial = pressure + rho * overlap;
        let mut answer = Answer::open(*traction, slip);
        answer.noise = (f64::EPSILON * (pressure.abs() + rho * self.lengths[0])).powi(2);
        if let Some(law) = laws.adhesion {
            self.adhere((law, trial, overlap), (pressure, shear, slip), laws, &mut answer);
            return answer;
        }
        if trial <= 0.0 {
            return answer;
        }
        (answer.active, (answer.stiff, answer.soft)) = (true, softened(laws.penalty, rho));
        let mut pressed = answer.stiff * trial;
        if let Some(wear) = laws.wear {
            pressed = self.wear((trial, (shear, slip), laws), wear, &mut answer);
        }
        let mut closed = SVector::zeros();
        if let Some(law) = laws.friction {
            let at = self.circumstances(pressed, laws);
            closed = self.meet(law, at, (shear, slip), &mut answer);
        }
        (answer.pressure, answer.shear) = (pressed, closed);
        answer.excess = (shear - closed) - normal * (pressure - pressed);
        answer
    }

    /// Whether a point that bears nothing does not come into contact: then its answer is that of an open one.
    fn stays_open(&self, traction: &SVector<f64, D>, motion: &SVector<f64, D>, laws: Laws<'_>) -> bool {
        let closes = || self.normal.dot(motion) - self.clearance > 0.0;
        laws.adhesion.is_none() && traction.iter().all(|t| *t == 0.0) && !closes()
    }

    /// The square of what round-off leaves of G of such a point, Pa^2.
    fn open_noise(&self) -> f64 {
        (f64::EPSILON * self.moduli.normal * self.lengths[0]).powi(2)
    }

    /// The same of a point in contact if it sticks where it stuck `before`, and slips the way it slipped: what is linear then. Where
    /// there is no friction, or the body is held along the face, that is what the laws make of it.
    pub fn answer_as_before(
        &self,
        (traction, motion): (&SVector<f64, D>, &SVector<f64, D>),
        laws: Laws<'_>,
        (before, answer): (&State<D>, Answer<D>),
    ) -> Answer<D> {
        let (Some(law), Some(rho)) = (laws.friction, self.moduli.tangential) else { return answer };
        let sheared = before.shear.norm();
        if !answer.active || before.pressure <= 0.0 || sheared == 0.0 {
            return answer;
        }
        let at = self.circumstances(answer.pressure, laws);
        let shear = traction + self.normal * -self.normal.dot(traction);
        let pull = shear + self.relative(motion).slip * rho;
        let share = |slope: f64| match slope.is_infinite() {
            true => [1.0, 0.0],
            false => [slope / (slope + rho), rho / (slope + rho)],
        };
        let (met, grip, slack, drag) = if before.sticks {
            let [grip, slack] = share(law.shear(at, 0.0).by_slip);
            (pull * grip, [grip; 2], [slack; 2], 0.0)
        } else {
            let Met { shear, .. } = law.meet(at, pull.norm().max(2.0 * law.bound(at, 0.0).value), rho);
            let [grip, slack] = share(shear.by_slip);
            (before.shear * (shear.shear / sheared), [grip, 0.0], [slack, 1.0], shear.by_pressure)
        };
        let excess = answer.excess + answer.shear - met;
        Answer { excess, shear: met, grip, slack, drag, direction: before.shear / sheared, ..answer }
    }

    /// p* of a point that wears, and what is known of it.
    fn wear(
        &self,
        (trial, (shear, slip), laws): (f64, (SVector<f64, D>, SVector<f64, D>), Laws<'_>),
        wear: Wear,
        answer: &mut Answer<D>,
    ) -> f64 {
        let length = slip.norm();
        let reach = self.moduli.tangential.map_or(0.0, |rho| (shear + slip * rho).norm());
        let met = worn::meet((self, laws), trial, (length, reach), wear);
        (answer.stiff, answer.soft) = (met.stiff, met.soft);
        (answer.worn, answer.wearing) = (met.depth, met.coupling);
        if laws.friction.is_none() && length > 0.0 {
            answer.direction = slip / length;
        }
        met.pressure
    }

    /// In which its friction answers.
    pub fn circumstances(&self, pressure: f64, laws: Laws<'_>) -> Circumstances {
        let (slid, temperature) = (self.slid, self.temperature);
        Circumstances { pressure, dt: laws.dt, resolution: laws.resolution, slid, temperature }
    }

    /// q*, and what is known of it.
    fn meet(
        &self,
        law: &dyn Law,
        at: Circumstances,
        (shear, slip): (SVector<f64, D>, SVector<f64, D>),
        answer: &mut Answer<D>,
    ) -> SVector<f64, D> {
        let Some(rho) = self.moduli.tangential else { return held(law, at, (shear, slip), answer) };
        let pull = shear + slip * rho;
        let reach = pull.norm();
        answer.direction = if reach > 0.0 { pull / reach } else { SVector::zeros() };
        let Met { slip, shear } = law.meet(at, reach, rho);
        let secant = if slip > 0.0 { shear.shear / slip } else { shear.by_slip };
        for (i, slope) in [shear.by_slip, secant].into_iter().enumerate() {
            let [grip, slack] = match slope / (slope + rho) {
                _ if slope.is_infinite() => [1.0, 0.0],
                // Beside 1 that is nothing, and the shear is known without the others.
                grip if grip.abs() < 0.25 * f64::EPSILON => [0.0, 1.0],
                grip => [grip, rho / (slope + rho)],
            };
            (answer.grip[i], answer.slack[i]) = (grip, slack);
        }
        answer.drag = shear.by_pressure;
        answer.slip = answer.direction * slip;
        answer.sticks = law.sticks(at, slip);
        answer.noise += (f64::EPSILON * (reach + answer.grip[0].abs() * rho * self.lengths[1])).powi(2);
        answer.direction * shear.shear
    }
}

/// Where the layer is held along the face its motion answers to no traction: the law says q of the slip that there is. At no
/// slip, Coulomb's law itself takes any q that it allows.
fn held<const D: usize>(
    law: &dyn Law,
    at: Circumstances,
    (shear, slip): (SVector<f64, D>, SVector<f64, D>),
    answer: &mut Answer<D>,
) -> SVector<f64, D> {
    let length = slip.norm();
    let bound = law.bound(at, 0.0).value;
    let any = length == 0.0 && law.shear(at, 0.0).by_slip.is_infinite();
    let met = law.shear(at, length);
    answer.slip = slip;
    answer.sticks = law.sticks(at, length);
    let by = if any { shear } else { slip };
    let size = by.norm();
    answer.direction = if size > 0.0 { by / size } else { SVector::zeros() };
    answer.drag = if any { 0.0 } else { met.by_pressure };
    if any { answer.direction * size.min(bound) } else { answer.direction * met.shear }
}

/// alpha/(alpha + rho) and rho/(alpha + rho).
fn softened(penalty: Option<f64>, rho: f64) -> (f64, f64) {
    match penalty {
        Some(alpha) => (alpha / (alpha + rho), rho / (alpha + rho)),
        None => (1.0, 0.0),
    }
}

impl<const D: usize> Answer<D> {
    /// Out of contact: t* = 0.
    fn open(traction: SVector<f64, D>, slip: SVector<f64, D>) -> Self {
        Self {
            pressure: 0.0,
            shear: SVector::zeros(),
            excess: traction,
            active: false,
            gap: 0.0,
            stiff: 0.0,
            soft: 1.0,
            grip: [0.0; 2],
            slack: [1.0; 2],
            direction: SVector::zeros(),
            drag: 0.0,
            slip,
            sticks: false,
            worn: 0.0,
            wearing: [0.0; 2],
            noise: 0.0,
        }
    }

    /// Of an open point that bears nothing.
    pub fn none(site: &Site<D>, motion: &SVector<f64, D>) -> Self {
        Self::open(SVector::zeros(), site.relative(motion).slip)
    }

    /// The motion from which the laws make, by displacements, the traction that they have met, to all its digits, m; only in
    /// contact.
    pub fn motion(&self, site: &Site<D>, penalty: f64) -> SVector<f64, D> {
        let past = site.drive - self.slip;
        past + site.normal * (site.clearance + self.pressure / penalty - site.normal.dot(&past))
    }

    /// Whether its gap is closed.
    pub fn touches(&self) -> bool {
        self.active && self.gap == 0.0
    }

    /// o as the laws leave it, m; only of an active point.
    fn overlap(&self, laws: Laws<'_>) -> f64 {
        let more = laws.adhesion.map_or(0.0, adhesion::Law::strength);
        if self.gap > 0.0 { -self.gap } else { laws.penalty.map_or(0.0, |alpha| (self.pressure + more) / alpha) }
    }

    /// t* = q* - p* n, Pa.
    pub fn met(&self, site: &Site<D>) -> SVector<f64, D> {
        self.shear - site.normal * self.pressure
    }

    /// The point as the laws leave it, t* and what goes with it, after a step from `before`; in a gap, under a motion.
    pub fn state(&self, site: &Site<D>, motion: &SVector<f64, D>, laws: Laws<'_>, before: &State<D>) -> State<D> {
        let Relative { overlap, .. } = site.relative(motion);
        let of_step = self.slip - site.elastic;
        if !self.active {
            let State { slid, worn, .. } = *before;
            return State { overlap: overlap.min(0.0), slip: of_step, slid, worn, ..State::default() };
        }
        let slides = laws.friction.filter(|_| self.touches());
        let holds = laws.friction.filter(|law| bears(*law, self.pressure));
        State {
            worn: before.worn + self.worn,
            slid: before.slid + slides.map_or(0.0, |law| law.lasting(self.slip.norm()).length),
            pressure: self.pressure,
            shear: self.shear,
            overlap: self.overlap(laws),
            slip: of_step,
            stuck: holds.map_or(SVector::zeros(), |law| before.stuck_after(law, self.sticks, (self.slip, of_step))),
            sticks: self.sticks,
        }
    }
}
