//! A start for Newton's method where the laws are too stiff for it: nonlinear block Gauss-Seidel on the tractions.
//!
//! With the body condensed onto the face, the motion at a point of the contact is what it would be without the traction
//! there, m0, plus what that traction does, D (q, -p) with a block D of 2 x 2. Point after point the laws are met exactly
//! by their own traction while the others stay (Jourdan, Alart and Jean, Comput. Methods Appl. Mech. Engrg. 155 (1998)
//! 31-47): however stiff the laws are, each is one equation with one root, which bisection finds. It converges
//! by a factor a sweep. Between the sweeps Newton's method is tried on the same equations, and what still does not settle,
//! as two stiff Gauss points to an edge do not, is approached from inside (interior.rs).

mod interior;
mod newton;
mod station;

use nalgebra::{Matrix2, Vector2};

use super::condensed::{Compliance, LARGE_FACE};
use crate::error::Result;
use crate::friction::Friction;
use crate::interface::Station;
use station::Local;

/// Sweeps between two attempts of Newton's method.
const SWEEPS: usize = 20;
/// Rounds of sweeps and Newton's method before the tractions are approached from inside, and after it.
const FIRST_ROUNDS: usize = 5;
const MORE_ROUNDS: usize = 20;
/// Rounds of sweeps alone at most, and products of a compliance and a force in all: it is a start only.
const MOST_ROUNDS: usize = 100;
const MOST_PRODUCTS: usize = 500_000_000;
/// Visits of each point at the end, to bring its displacement to its traction.
const ADJUSTMENTS: usize = 30;
/// The square of what is left, over that of the tractions, with which they have settled.
const SETTLED: f64 = 1e-24;
/// The same for those that do not settle soon: round-off may not let them come closer.
const ENOUGH: f64 = 1e-20;

/// A start.
pub struct Start {
    /// x, z of each node of the face, m.
    pub displacements: Vec<f64>,
    /// On the layer, x, z of each node of the face, N/m.
    pub forces: Vec<f64>,
}

/// The state that the contact at `stations` leaves of the `free` displacements of the face, x, z of each node, m, before a
/// body of the compliance C/c. It need not have settled.
pub fn start(stations: Vec<Station>, law: Option<Friction>, behind: Behind<'_>, free: Vec<f64>) -> Result<Start> {
    let rounds = (MOST_PRODUCTS / (free.len() * free.len() * SWEEPS)).clamp(1, MOST_ROUNDS);
    let mut tractions = Tractions::new(stations, law, behind, free);
    if tractions.approach(rounds.min(FIRST_ROUNDS), SETTLED)? {
        return Ok(tractions.into_start());
    }
    if 2 * tractions.stations.len() <= LARGE_FACE {
        tractions.approach_from_inside()?;
        tractions.refine()?;
    }
    if !tractions.approach(rounds.min(MORE_ROUNDS), ENOUGH)? {
        // Strong friction may have several answers, or none near; then sweeps alone come from no traction to the least.
        tractions.set(vec![Vector2::zeros(); tractions.values.len()]);
        (0..rounds * SWEEPS).find(|_| tractions.sweep() <= SETTLED);
    }
    Ok(tractions.into_start())
}

/// What stands behind the face, of the compliance C/c: C and c.
pub type Behind<'a> = (&'a Compliance, f64);

/// Tractions on their way to meeting the laws, and the face under them.
struct Tractions<'a> {
    stations: Vec<Station>,
    law: Option<Friction>,
    behind: Behind<'a>,
    /// D of each point with itself.
    own: Vec<Matrix2<f64>>,
    /// The face without contact, m.
    free: Vec<f64>,
    places: Vec<usize>,
    /// (q, p) of each point, Pa.
    values: Vec<Vector2<f64>>,
    /// The face under them, m.
    u: Vec<f64>,
}

/// (q, -p): the traction on the layer in (t, n).
fn on_layer(traction: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(traction.x, -traction.y)
}

impl<'a> Tractions<'a> {
    /// None yet.
    fn new(stations: Vec<Station>, law: Option<Friction>, behind: Behind<'a>, free: Vec<f64>) -> Self {
        Self {
            own: stations.iter().map(|station| station.influence(station, behind)).collect(),
            places: (0..free.len()).collect(),
            values: vec![Vector2::zeros(); stations.len()],
            u: free.clone(),
            stations,
            law,
            behind,
            free,
        }
    }

    /// The layer at a point without the traction there.
    fn local(&self, i: usize) -> Local {
        let own = self.own[i];
        Local { without: self.stations[i].motion(&self.u) - own * on_layer(self.values[i]), own }
    }

    /// Meets the laws point after point; the change of the tractions over their size, squared.
    fn sweep(&mut self) -> f64 {
        let (mut change, mut size) = (0.0, 0.0);
        for i in 0..self.stations.len() {
            let station = self.stations[i];
            let new = station.tractions(&self.local(i), self.law.as_ref());
            let more = new - self.values[i];
            self.values[i] = new;
            size += new.norm_squared();
            if more != Vector2::zeros() {
                change += more.norm_squared();
                self.load(station, more);
            }
        }
        if change > 0.0 { change / size } else { 0.0 }
    }

    /// u += what a traction at a point does.
    fn load(&mut self, station: Station, traction: Vector2<f64>) {
        let (compliance, secant) = self.behind;
        let force = station.point.frame.tr_mul(&on_layer(traction)) * (station.point.weight / secant);
        for (node, share) in station.shares() {
            compliance.add_column(2 * node, share * force.x, &self.places, &mut self.u);
            compliance.add_column(2 * node + 1, share * force.y, &self.places, &mut self.u);
        }
    }

    /// Takes other tractions.
    fn set(&mut self, values: Vec<Vector2<f64>>) {
        self.u.clone_from(&self.free);
        self.values = values;
        for i in 0..self.stations.len() {
            if self.values[i] != Vector2::zeros() {
                self.load(self.stations[i], self.values[i]);
            }
        }
    }

    /// What they do to the nodes, N/m.
    fn forces(&self) -> Vec<f64> {
        let mut forces = vec![0.0; self.u.len()];
        for (station, traction) in self.stations.iter().zip(&self.values) {
            let force = station.point.frame.tr_mul(&on_layer(*traction)) * station.point.weight;
            for (node, share) in station.shares() {
                forces[2 * node] += share * force.x;
                forces[2 * node + 1] += share * force.y;
            }
        }
        forces
    }

    /// The state under the tractions.
    fn into_start(self) -> Start {
        Start { forces: self.forces(), displacements: self.displacements() }
    }

    /// The face under the tractions.
    ///
    /// What a stiff law makes of the last digits of a displacement is noise; so the points are brought to where the laws
    /// make of it the traction that it comes from, one after the other, by moving their nodes as little as does it
    /// (Kaczmarz).
    fn displacements(mut self) -> Vec<f64> {
        for _ in 0..ADJUSTMENTS {
            for (station, traction) in self.stations.iter().zip(&self.values).filter(|(_, traction)| traction.y > 0.0) {
                let motion = station.motion(&self.u);
                let mut to = motion;
                to.y = station.motion.clearance
                    + (traction.y - station.resistance.multiplier) / station.resistance.penalty;
                if let Some(rate) = self.law.and_then(|law| law.rate(*traction, station.motion.slip)) {
                    to.x = station.before + (station.motion.slip.rate - rate) * station.motion.slip.dt;
                }
                let squares: f64 = station.shares().map(|(_, share)| share * share).sum();
                let correction = station.point.frame.tr_mul(&(to - motion)) / squares;
                for (node, share) in station.shares() {
                    self.u[2 * node] += share * correction.x;
                    self.u[2 * node + 1] += share * correction.y;
                }
            }
        }
        self.u
    }

    /// Sweeps, with Newton's method between, so many times or until the tractions have settled to `enough`; whether they
    /// have.
    fn approach(&mut self, rounds: usize, enough: f64) -> Result<bool> {
        for _ in 0..rounds {
            for _ in 0..SWEEPS {
                if self.sweep() <= enough {
                    return Ok(true);
                }
            }
            self.refine()?;
        }
        Ok(self.sweep() <= enough)
    }

    /// The fastest that a point goes, of the indenter over the layer or of the layer without contact, m/s.
    fn fastest(&self) -> f64 {
        let rate = |station: &Station| {
            let slip = station.motion.slip;
            slip.rate.abs().max((station.motion(&self.free).x - station.before).abs() / slip.dt)
        };
        self.stations.iter().map(rate).fold(0.0, f64::max)
    }
}
