//! The integrals over a contact face at its accepted state.

use nalgebra::{SVector, Vector2};

use super::fields::along_the_plane;
use super::{BEYOND, Interface, oscillation};
use crate::error::Result;
use crate::profile::Surface;

/// Integrals over the contact face.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Totals {
    /// integral of (p n_z - q_z), N/m (N in space): the vertical force, compression positive; on a flat face, of p.
    pub normal_force: f64,
    /// integral of q along x and y, N/m or N, on the layer, positive along +x and +y. The horizontal part of the pressure on a
    /// curved face (-p n_x), like that on the profile's slope, is not in it.
    pub tangential_force: Vector2<f64>,
    /// integral of p dh/dx and p dh/dy, N/m or N.
    pub hysteretic_force: Vector2<f64>,
    /// Share of the face whose gap is closed.
    pub contact_fraction: f64,
    /// Share of the contact that sticks; 0 without contact or friction.
    pub stick_fraction: f64,
    /// m
    pub max_penetration: f64,
    /// The largest slip of a sticking point while it was to stick, m: the error of the regularisation.
    pub stuck_slip: f64,
    /// How much the tractions oscillate from node to node; 1 = nothing but a checkerboard.
    pub traction_oscillation: f64,
    /// integral of the worn depth, m^2 (m^3 in space).
    pub worn_volume: f64,
}

impl<const D: usize> Interface<D> {
    /// The integrals over the face at the accepted state. Collective.
    ///
    /// # Errors
    /// As for [`Self::place`].
    pub fn totals(&mut self) -> Result<Totals> {
        self.place(self.place)?;
        let tractions = self.tractions();
        let around = self.around(&tractions);
        let beside = |other: usize| match other.checked_sub(self.accepted.len()) {
            None => self.accepted[other].pressure > 0.0,
            Some(other) => around[other][D - 1] > 0.0,
        };
        let mut totals = Totals::default();
        let (mut length, mut contact, mut stick) = (0.0, 0.0, 0.0);
        for (i, (point, state)) in self.points.all().iter().zip(&self.accepted).enumerate() {
            length += point.weight;
            totals.max_penetration = totals.max_penetration.max(state.overlap);
            if state.pressure == 0.0 {
                continue;
            }
            contact += if state.touches() { point.weight } else { 0.0 };
            totals.normal_force -= point.weight * state.on_layer(&point.normal)[D - 1];
            totals.tangential_force += along_the_plane(&state.shear) * point.weight;
            totals.hysteretic_force +=
                self.gradient(i, &beside) * (point.weight * point.normal[D - 1] * state.pressure);
            if state.sticks && state.touches() {
                stick += point.weight;
                totals.stuck_slip = totals.stuck_slip.max(state.stuck.norm());
            }
        }
        let (team, q, hysteretic) = (self.team(), totals.tangential_force, totals.hysteretic_force);
        let mine = [totals.normal_force, q.x, q.y, hysteretic.x, hysteretic.y, length, contact, stick];
        let [normal_force, q_x, q_y, hysteretic_x, hysteretic_y, length, contact, stick] = team.sum(mine);
        let [max_penetration, stuck_slip] = team.most([totals.max_penetration, totals.stuck_slip]);
        Ok(Totals {
            normal_force,
            tangential_force: Vector2::new(q_x, q_y),
            hysteretic_force: Vector2::new(hysteretic_x, hysteretic_y),
            contact_fraction: contact / length,
            stick_fraction: if contact > 0.0 { stick / contact } else { 0.0 },
            max_penetration,
            stuck_slip,
            worn_volume: self.worn_volume(),
            traction_oscillation: self.oscillation(tractions, &around),
        })
    }

    /// The tractions of the line before this rank's, and of those after it; nothing where the face is not parted. Collective.
    fn around(&self, tractions: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        let team = self.team();
        if !team.is_parted() {
            return Vec::new();
        }
        let lines = team.lines_of(team.ranks()[0] - 1).end;
        let wanted = |rank: usize| {
            let std::ops::Range { start, end } = team.lines_of(rank);
            std::iter::once(start + lines - 1).chain(end..end + BEYOND).map(|line| line % lines).collect()
        };
        let flat: Vec<f64> = tractions.iter().flatten().copied().collect();
        team.fetched(&flat, wanted).chunks_exact(D).map(SVector::from_column_slice).collect()
    }

    /// See [`Totals::traction_oscillation`]. Collective.
    fn oscillation(&self, mut tractions: Vec<SVector<f64, D>>, around: &[SVector<f64, D>]) -> f64 {
        let count = tractions.len();
        let Some(beyond) = &self.beyond else {
            return oscillation::oscillation((&self.face, count), &tractions, self.team());
        };
        // But for the line before.
        tractions.extend_from_slice(&around[around.len() / (1 + BEYOND)..]);
        oscillation::oscillation((beyond, count), &tractions, self.team())
    }

    /// The gradient of h over a point of the contact: at a kink of the profile that of the side which is in contact, of both their
    /// mean. `touches` says whether another point is in contact.
    pub(super) fn gradient(&self, i: usize, touches: &dyn Fn(usize) -> bool) -> Vector2<f64> {
        /// How far beside the point the sides are looked at, over the size of what it stands for.
        const BESIDE: f64 = 1e-6;
        /// Slopes that differ by less, over the larger, are one.
        const ALIKE: f64 = 1e-3;
        let point = &self.points.all()[i];
        let (place, size) = (point.along() - self.place.sliding, point.weight.powf(1.0 / (D - 1) as f64));
        let here = self.points.heights()[i].gradient;
        let touches = |other: Option<usize>| other.is_some_and(touches);
        let along = |axis: usize| {
            let side = |steps: f64| {
                let beside = place + Vector2::ith(axis, steps * BESIDE * size);
                self.laws.surface(self.worn.as_ref()).at(beside).map_or(here[axis], |height| height.gradient[axis])
            };
            let (left, right) = (side(-1.0), side(1.0));
            let jump = (right - left).abs();
            // A slope that only passes through zero jumps twice as far over twice the distance.
            if jump <= ALIKE * left.abs().max(right.abs()) || (side(2.0) - side(-2.0)).abs() > 1.5 * jump {
                return here[axis];
            }
            match self.points.beside(i, axis).map(touches) {
                [true, false] => left,
                [false, true] => right,
                _ => 0.5 * (left + right),
            }
        };
        Vector2::from_fn(|axis, _| if axis + 1 < D { along(axis) } else { 0.0 })
    }
}
