//! The contact face: its points, the laws on them, and the accepted state of each.
//!
//! Two forms of the same laws stand on it. Where displacements are the unknowns they decide the tractions, by a penalty and a
//! regularised friction law: [`Interface::residual`]. Where tractions are, [`crate::solve`] meets the laws, exact ones too.
//! Either gives a [`State`] of each point, from which totals, fields and energy are had.
//!
//! Every rank holds the whole face (it is one dimension smaller than the body) and all its states.

mod displaced;
mod exchange;
mod oscillation;
mod points;
mod state;

use nalgebra::{SVector, Vector2};

use crate::element::mpjr::Quadrature;
use crate::error::{Error, Result};
use crate::friction::{Circumstances, Lasting, Law};
use crate::loading::Placement;
use crate::mesh::Face;
use crate::profile::Profile;
use crate::snapshot::Snapshot;

pub use displaced::{Residual, Surface, Tangent};
pub use exchange::Exchange;
pub use points::{Point, Points};
pub use state::State;

/// The laws of the contact.
pub struct Laws {
    /// The rigid profile.
    pub profile: Box<dyn Profile>,
    /// Penalty alpha, Pa/m; none = no penetration.
    pub penalty: Option<f64>,
    /// None = frictionless.
    pub friction: Option<Box<dyn Law>>,
}

/// The MPJR interface elements of a contact face.
pub struct Interface {
    face: Face,
    laws: Laws,
    points: Points<2>,
    /// The accepted state of each point, and where the indenter was.
    accepted: Vec<State<2>>,
    place: Placement,
    /// Evaluations of the tangential law while solving.
    tangential_laws: usize,
}

/// Integrals over the contact face.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Totals {
    /// integral of (p n_z - q_z), N/m: the vertical force, compression positive; on a flat face, of p.
    pub normal_force: f64,
    /// integral of q_x, N/m, on the layer, positive along +x. The horizontal part of the pressure on a curved face
    /// (-p n_x), like that on the profile's slope, is not in it.
    pub tangential_force: f64,
    /// integral of p dh/dx, N/m.
    pub hysteretic_force: f64,
    /// Share of the face with p > 0.
    pub contact_fraction: f64,
    /// Share of the contact that sticks; 0 without contact or friction.
    pub stick_fraction: f64,
    /// m
    pub max_penetration: f64,
    /// The largest slip of a sticking point while it was to stick, m: the error of the regularisation.
    pub stuck_slip: f64,
    /// How much the tractions oscillate from node to node; 1 = nothing but a checkerboard.
    pub traction_oscillation: f64,
}

/// Fields at the face's nodes. Under Gauss quadrature, the mean of the points that share a node, by their shares; the gap is
/// that of the deepest of them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fields {
    /// p, Pa, positive in compression.
    pub pressure: Vec<f64>,
    /// q, Pa, on the layer, positive in the sense of +x.
    pub shear: Vec<f64>,
    /// Corrected normal gap g*, m; negative = penetration.
    pub gap: Vec<f64>,
    /// w, m/s
    pub slip_rate: Vec<f64>,
}

impl Interface {
    /// The interface elements of `face`, at rest.
    pub fn new(face: Face, laws: Laws, quadrature: Quadrature) -> Self {
        let points = Points::new(&face, quadrature);
        let accepted = vec![State::default(); points.count()];
        Self { face, laws, points, accepted, place: Placement::default(), tangential_laws: 0 }
    }

    /// The face.
    pub fn face(&self) -> &Face {
        &self.face
    }

    /// Where the laws are evaluated.
    pub fn points(&self) -> &Points<2> {
        &self.points
    }

    /// The accepted state of each point.
    pub fn states(&self) -> &[State<2>] {
        &self.accepted
    }

    /// Where the indenter is at the accepted state.
    pub fn placement(&self) -> Placement {
        self.place
    }

    /// The friction law.
    pub fn friction(&self) -> Option<&dyn Law> {
        self.laws.friction.as_deref()
    }

    /// alpha, Pa/m; none = no penetration.
    pub fn penalty(&self) -> Option<f64> {
        self.laws.penalty
    }

    /// How often the tangential law was evaluated while solving.
    pub fn tangential_laws(&self) -> usize {
        self.tangential_laws
    }

    /// The tangential law is asked where there is pressure.
    pub fn count_laws(&mut self, in_contact: usize) {
        if self.laws.friction.is_some() {
            self.tangential_laws += in_contact;
        }
    }

    /// Brings the profile to where the indenter is.
    ///
    /// # Errors
    /// A domain error where the profile is not known.
    pub fn place(&mut self, placement: Placement) -> Result<()> {
        self.points.place(self.laws.profile.as_ref(), placement)
    }

    /// The vertical clearance over a point where the indenter was placed last, c, m.
    pub fn clearance(&self, i: usize, approach: f64) -> f64 {
        self.points.elevations()[i].height - approach - self.points.all()[i].place.y
    }

    /// Takes the accepted state to the end of a step.
    ///
    /// # Errors
    /// As for [`Self::place`]; where the coefficient of friction is none at a point in contact.
    pub fn commit(&mut self, placement: Placement, states: Vec<State<2>>) -> Result<()> {
        self.place(placement)?;
        self.check_friction(placement.dt, &states)?;
        (self.accepted, self.place) = (states, Placement { dt: 0.0, ..placement });
        Ok(())
    }

    /// Refuses states under a coefficient of friction that is negative or not finite.
    fn check_friction(&self, dt: f64, states: &[State<2>]) -> Result<()> {
        let Some(law) = self.friction() else { return Ok(()) };
        let fault = |(before, state): (&State<2>, &State<2>)| {
            let at = Circumstances { pressure: state.pressure, dt, resolution: 0.0, slid: before.slid };
            law.strength().fault(at, Lasting { length: state.slid - before.slid, by_slip: 0.0 })
        };
        let mut touched = self.accepted.iter().zip(states).filter(|(_, state)| state.pressure > 0.0);
        touched.find_map(fault).map_or(Ok(()), |fault| Err(Error::Solver(fault)))
    }

    /// The integrals over the face at the accepted state.
    ///
    /// # Errors
    /// As for [`Self::place`].
    pub fn totals(&mut self) -> Result<Totals> {
        self.place(self.place)?;
        let mut totals = Totals::default();
        let (mut length, mut contact, mut stick) = (0.0, 0.0, 0.0);
        for (i, (point, state)) in self.points.all().iter().zip(&self.accepted).enumerate() {
            length += point.weight;
            totals.max_penetration = totals.max_penetration.max(state.overlap);
            if state.pressure <= 0.0 {
                continue;
            }
            contact += point.weight;
            totals.normal_force -= point.weight * state.on_layer(&point.normal).y;
            totals.tangential_force += point.weight * state.shear.x;
            totals.hysteretic_force += point.weight * point.normal.y * state.pressure * self.slope(i);
            if state.sticks {
                stick += point.weight;
                totals.stuck_slip = totals.stuck_slip.max(state.stuck.norm());
            }
        }
        totals.contact_fraction = contact / length;
        totals.stick_fraction = if contact > 0.0 { stick / contact } else { 0.0 };
        let Fields { pressure, shear, .. } = self.fields(1.0);
        let tractions: Vec<_> = shear.into_iter().zip(pressure).map(|(q, p)| Vector2::new(q, p)).collect();
        totals.traction_oscillation = oscillation::oscillation(&self.face.edges, &tractions);
        Ok(totals)
    }

    /// dh/dx over a point of the contact: at a kink of the profile that of the side which is in contact, of both their mean.
    fn slope(&self, i: usize) -> f64 {
        /// How far beside the point the sides are looked at, over what the point stands for.
        const BESIDE: f64 = 1e-6;
        /// Slopes that differ by less, over the larger, are one.
        const ALIKE: f64 = 1e-3;
        let (point, x) = (&self.points.all()[i], self.points.all()[i].place.x - self.place.sliding);
        let here = self.points.elevations()[i].slope;
        let side = |sign: f64| {
            self.laws.profile.at(x + sign * BESIDE * point.weight).map_or(here, |elevation| elevation.slope)
        };
        let (left, right) = (side(-1.0), side(1.0));
        if (right - left).abs() <= ALIKE * left.abs().max(right.abs()) {
            return here;
        }
        let touches = |other: Option<usize>| other.is_some_and(|other| self.accepted[other].pressure > 0.0);
        match self.points.beside(i).map(touches) {
            [true, false] => left,
            [false, true] => right,
            _ => 0.5 * (left + right),
        }
    }

    /// The fields at the accepted state after a step of length `dt`, s.
    pub fn fields(&self, dt: f64) -> Fields {
        let zeros = || vec![0.0; self.face.x.len()];
        let open = vec![f64::INFINITY; self.face.x.len()];
        let mut fields = Fields { pressure: zeros(), shear: zeros(), gap: open, slip_rate: zeros() };
        let mut length = zeros();
        for (i, point) in self.points.all().iter().enumerate() {
            self.points.shares(i).iter().for_each(|&(node, share)| length[node] += share * point.weight);
        }
        for (i, (point, state)) in self.points.all().iter().zip(&self.accepted).enumerate() {
            let along = along(&point.normal);
            for &(node, share) in self.points.shares(i) {
                let part = share * point.weight / length[node];
                fields.pressure[node] += part * state.pressure;
                fields.shear[node] += part * along.dot(&state.shear);
                fields.slip_rate[node] += part * along.dot(&state.slip) / dt;
                fields.gap[node] = fields.gap[node].min(-state.overlap);
            }
        }
        fields
    }

    /// Adds the accepted state to a snapshot.
    pub fn save(&self, snapshot: &mut Snapshot) {
        let mut list = Vec::with_capacity(State::<2>::NUMBERS * self.accepted.len());
        self.accepted.iter().for_each(|state| state.write(&mut list));
        snapshot.put("face-states", list);
        let Placement { approach, sliding, sliding_rate, approach_rate, .. } = self.place;
        snapshot.put("face", vec![approach, sliding, sliding_rate, approach_rate]);
    }

    /// Takes the accepted state from a snapshot.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let mut list = vec![0.0; State::<2>::NUMBERS * self.accepted.len()];
        snapshot.fill("face-states", &mut list)?;
        self.accepted = list.chunks_exact(State::<2>::NUMBERS).map(State::read).collect();
        let [approach, sliding, sliding_rate, approach_rate] = snapshot.numbers("face")?;
        self.place = Placement { approach, sliding, sliding_rate, approach_rate, ..Placement::default() };
        Ok(())
    }
}

/// The unit tangent of a plane face in the sense of +x.
fn along(normal: &SVector<f64, 2>) -> SVector<f64, 2> {
    SVector::from([normal.y, -normal.x])
}

#[cfg(test)]
mod tests;
