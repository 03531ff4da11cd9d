//! The contact face: its points, the laws on them, and the accepted state of each.
//!
//! Two forms of the same laws stand on it. Where displacements are the unknowns they decide the tractions, by a penalty and a
//! regularised friction law: [`Interface::residual`]. Where tractions are, [`crate::solve`] meets the laws, exact ones too.
//! Either gives a [`State`] of each point, from which totals, fields and energy are had.
//!
//! Every rank holds the whole face (it is one dimension smaller than the body) and all its states, unless the face is parted among the
//! ranks of a team: [`Interface::among`]. Then each has its own lines, and only totals are reduced.

mod displaced;
mod exchange;
mod oscillation;
mod points;
mod state;
mod worn;

use std::rc::Rc;

use nalgebra::{SVector, Vector2};

use crate::adhesion;
use crate::element::mpjr::Quadrature;
use crate::error::{Error, Result};
use crate::friction::{Circumstances, Lasting, Law};
use crate::loading::{DIRECTIONS, Placement};
use crate::mesh;
use crate::parallel::Team;
use crate::profile::{Height, Surface};
use crate::snapshot::Snapshot;
use crate::wear::{Wear, Worn};

pub use displaced::{Residual, Tangent, Trial};
pub use exchange::{Exchange, Rub};
pub use points::{Point, Points};
pub use state::State;
pub use worn::WornFields;

/// How many lines beyond its own a rank looks at for the oscillation of tractions.
const BEYOND: usize = 3;

/// The laws of the contact.
pub struct Laws {
    /// The rigid profile.
    pub profile: Box<dyn Surface>,
    /// Penalty alpha, Pa/m; none = no penetration.
    pub penalty: Option<f64>,
    /// None = frictionless.
    pub friction: Option<Box<dyn Law>>,
    /// None = nothing wears.
    pub wear: Option<Wear>,
    /// None = nothing pulls.
    pub adhesion: Option<Box<dyn adhesion::Law>>,
}

/// The MPJR interface elements of a contact face.
pub struct Interface<const D: usize> {
    face: mesh::Face<D>,
    /// Of a parted face with three lines more, which are another rank's.
    beyond: Option<mesh::Face<D>>,
    laws: Laws,
    points: Points<D>,
    /// See [`Self::pairs`].
    pairs: Vec<(usize, usize)>,
    /// The accepted state of each point, and where the indenter was.
    accepted: Vec<State<D>>,
    place: Placement,
    /// What has worn off the indenter, where it wears.
    worn: Option<Worn>,
    /// Evaluations of the tangential law while solving.
    tangential_laws: usize,
    /// Of each point, K; none where nobody tells.
    temperatures: Vec<f64>,
}

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

/// Fields at the face's nodes. Under Gauss quadrature, the mean of the points that share a node, by their shares; the gap is
/// that of the deepest of them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fields {
    /// p, Pa, positive in compression.
    pub pressure: Vec<f64>,
    /// q, Pa, on the layer, along the face in the senses of +x and +y.
    pub shear: Vec<Vector2<f64>>,
    /// Corrected normal gap g*, m; negative = penetration.
    pub gap: Vec<f64>,
    /// w, m/s
    pub slip_rate: Vec<Vector2<f64>>,
    /// Only where something wears.
    pub worn: Option<WornFields>,
}

/// What is asked of a contact face at its accepted state, whatever the dimension. Lists are of this rank's nodes.
pub trait Face {
    /// The ranks that share it.
    fn team(&self) -> &Team;
    /// Where the indenter is.
    fn placement(&self) -> Placement;
    /// The integrals over the whole face. Collective where it is parted.
    ///
    /// # Errors
    /// A domain error where the profile is not known.
    fn totals(&mut self) -> Result<Totals>;
    /// The fields after a step of length `dt`, s.
    fn fields(&self, dt: f64) -> Fields;
    /// What points have, each of it, at the nodes that share them.
    fn at_nodes(&self, of_points: &[f64]) -> Vec<f64>;
    /// What the nodes stand for of the face, and of that what is not in contact, m (m^2 in space).
    fn areas(&self) -> [Vec<f64>; 2];
}

impl<const D: usize> Face for Interface<D> {
    fn team(&self) -> &Team {
        Self::team(self)
    }

    fn placement(&self) -> Placement {
        self.place
    }

    fn totals(&mut self) -> Result<Totals> {
        Self::totals(self)
    }

    fn fields(&self, dt: f64) -> Fields {
        Self::fields(self, dt)
    }

    fn at_nodes(&self, of_points: &[f64]) -> Vec<f64> {
        let mut nodes = vec![0.0; self.face.count()];
        for (i, value) in of_points.iter().enumerate() {
            self.points.shares(i).iter().for_each(|&(node, share)| nodes[node] += share * value);
        }
        nodes
    }

    fn areas(&self) -> [Vec<f64>; 2] {
        let weights = || self.points.all().iter().map(|point| point.weight);
        let open = weights().zip(&self.accepted).map(|(weight, state)| if state.touches() { 0.0 } else { weight });
        [weights().collect::<Vec<_>>(), open.collect()].map(|areas| self.at_nodes(&areas))
    }
}

impl<const D: usize> Interface<D> {
    /// The interface elements of `face`, at rest.
    pub fn new(face: mesh::Face<D>, laws: Laws, quadrature: Quadrature) -> Self {
        let points = Points::new(&face, quadrature);
        let pairs = if points.share_nodes() { face.pairs() } else { Vec::new() };
        let accepted = vec![State::default(); points.count()];
        let worn = laws.worn(face.grid.as_ref());
        let (place, temperatures) = (Placement::default(), Vec::new());
        Self { face, beyond: None, laws, points, pairs, accepted, place, worn, tangential_laws: 0, temperatures }
    }

    /// What this rank has of it among the ranks of a team; of a face at rest whose points are the nodes of a periodic grid.
    pub fn among(self, team: &Rc<Team>) -> Self {
        let Some(lines) = team.lines() else { return self };
        let points = self.points.among(team.clone());
        let face = self.face.of_lines(lines.clone());
        let beyond = Some(self.face.of_lines(lines.start..lines.end + BEYOND));
        let accepted = vec![State::default(); points.count()];
        Self { face, beyond, points, accepted, ..self }
    }

    /// The ranks that share the face.
    pub fn team(&self) -> &Rc<Team> {
        self.points.team()
    }

    /// How many nodes it has on all ranks.
    pub fn nodes_everywhere(&self) -> usize {
        self.team().count(self.face.count())
    }

    /// The face, of this rank.
    pub fn face(&self) -> &mesh::Face<D> {
        &self.face
    }

    /// The pairs of nodes that share a point, both ways round, in order; none where points are nodes.
    pub fn pairs(&self) -> &[(usize, usize)] {
        &self.pairs
    }

    /// Where the laws are evaluated.
    pub fn points(&self) -> &Points<D> {
        &self.points
    }

    /// The accepted state of each point.
    pub fn states(&self) -> &[State<D>] {
        &self.accepted
    }

    /// Where the indenter is at the accepted state.
    pub fn placement(&self) -> Placement {
        self.place
    }

    /// Tells the laws the temperatures of all nodes, K.
    pub fn warm(&mut self, nodes: &[f64]) {
        let nodes = self.team().own(nodes);
        let at = |i: usize| self.points.shares(i).iter().map(|(node, share)| share * nodes[*node]).sum();
        self.temperatures = (0..self.points.count()).map(at).collect();
    }

    /// The temperature of a point that its laws know, K.
    pub fn temperature(&self, i: usize) -> f64 {
        self.temperatures.get(i).copied().unwrap_or(0.0)
    }

    /// The friction law.
    pub fn friction(&self) -> Option<&dyn Law> {
        self.laws.friction.as_deref()
    }

    /// alpha, Pa/m; none = no penetration.
    pub fn penalty(&self) -> Option<f64> {
        self.laws.penalty
    }

    /// The law of adhesion.
    pub fn adhesion(&self) -> Option<&dyn adhesion::Law> {
        self.laws.adhesion.as_deref()
    }

    /// Tells each point of a face at rest its gap under an indenter at no approach, m, which adhesion has to know.
    ///
    /// # Errors
    /// As for [`Self::place`].
    pub fn measure_gaps(&mut self) -> Result<()> {
        self.place(Placement::default())?;
        for i in 0..self.points.count() {
            self.accepted[i].overlap = (-self.clearance(i, 0.0) * self.points.all()[i].normal[D - 1]).min(0.0);
        }
        Ok(())
    }

    /// Whether the laws ask for no motion along the face: without friction and wear on a flat one.
    pub fn is_normal_alone(&self) -> bool {
        let slips = self.laws.friction.is_some() || self.laws.wear.is_some();
        !slips && self.points.are_flat()
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
        self.points.place(&self.laws.surface(self.worn.as_ref()), placement)
    }

    /// The profile over each point with the indenter at another place, `sliding`, m.
    ///
    /// # Errors
    /// As for [`Self::place`].
    pub fn heights_at(&self, sliding: Vector2<f64>) -> Result<Vec<Height>> {
        self.points.heights_at(&self.laws.surface(self.worn.as_ref()), sliding)
    }

    /// The profile over the points with the indenter further along than `sliding`, m, by what it is asked with; not a number where it is
    /// not known.
    pub fn profile_beyond(&self, sliding: Vector2<f64>) -> impl Fn(Vector2<f64>) -> Vec<Height> + '_ {
        let unknown = Height { height: f64::NAN, gradient: Vector2::zeros() };
        move |further| self.heights_at(sliding + further).unwrap_or_else(|_| vec![unknown; self.points.count()])
    }

    /// The vertical clearance over a point where the indenter was placed last, c, m.
    pub fn clearance(&self, i: usize, approach: f64) -> f64 {
        self.points.heights()[i].height - approach - self.points.all()[i].place[D - 1]
    }

    /// Takes the accepted state to the end of a step. Collective.
    ///
    /// # Errors
    /// As for [`Self::place`]; where the coefficient of friction is none at a point in contact.
    pub fn commit(&mut self, placement: Placement, states: Vec<State<D>>) -> Result<()> {
        self.place(placement)?;
        self.team().agree(self.check_friction(placement.dt, &states))?;
        self.wear_off(placement, &states);
        (self.accepted, self.place) = (states, Placement { dt: 0.0, supports: [None; DIRECTIONS], ..placement });
        Ok(())
    }

    /// Refuses states under a coefficient of friction that is negative or not finite.
    fn check_friction(&self, dt: f64, states: &[State<D>]) -> Result<()> {
        let Some(law) = self.friction() else { return Ok(()) };
        let fault = |(i, (before, state)): (usize, (&State<D>, &State<D>))| {
            let (pressure, slid, temperature) = (state.pressure, before.slid, self.temperature(i));
            let at = Circumstances { pressure, dt, resolution: 0.0, slid, temperature };
            law.strength().fault(at, Lasting { length: state.slid - before.slid, by_slip: 0.0 })
        };
        let ends = self.accepted.iter().zip(states).enumerate();
        let mut touched = ends.filter(|(_, (_, state))| state.pressure > 0.0);
        touched.find_map(fault).map_or(Ok(()), |fault| Err(Error::Solver(fault)))
    }

    /// The integrals over the face at the accepted state. Collective.
    ///
    /// # Errors
    /// As for [`Self::place`].
    pub fn totals(&mut self) -> Result<Totals> {
        self.place(self.place)?;
        let Fields { pressure, shear, .. } = self.fields(1.0);
        let traction =
            |(q, p): (Vector2<f64>, f64)| SVector::<f64, D>::from_fn(|i, _| if i + 1 < D { q[i] } else { p });
        let tractions: Vec<_> = shear.into_iter().zip(pressure).map(traction).collect();
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
    fn gradient(&self, i: usize, touches: &dyn Fn(usize) -> bool) -> Vector2<f64> {
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

    /// The fields at the accepted state after a step of length `dt`, s.
    pub fn fields(&self, dt: f64) -> Fields {
        let nodes = self.face.count();
        let (none, open) = (vec![Vector2::zeros(); nodes], vec![f64::INFINITY; nodes]);
        let mut fields = Fields {
            pressure: vec![0.0; nodes],
            shear: none.clone(),
            gap: open,
            slip_rate: none,
            worn: self.worn_fields(),
        };
        let weights: Vec<f64> = self.points.all().iter().map(|point| point.weight).collect();
        let length = self.at_nodes(&weights);
        for (i, (point, state)) in self.points.all().iter().zip(&self.accepted).enumerate() {
            for &(node, share) in self.points.shares(i) {
                let part = share * point.weight / length[node];
                fields.pressure[node] += part * state.pressure;
                fields.shear[node] += laid_flat(&state.shear, &point.normal) * part;
                fields.slip_rate[node] += laid_flat(&state.slip, &point.normal) * (part / dt);
                fields.gap[node] = fields.gap[node].min(-state.overlap);
            }
        }
        fields
    }

    /// Adds the accepted state to a snapshot. Collective.
    pub fn save(&self, snapshot: &mut Snapshot) {
        let mut list = Vec::with_capacity(State::<D>::NUMBERS * self.accepted.len());
        self.accepted.iter().for_each(|state| state.write(&mut list));
        snapshot.put("face-states", self.team().collected(list));
        let Placement { approach, sliding, sliding_rate, approach_rate, far, .. } = self.place;
        snapshot.put("face", vec![approach, sliding.x, sliding.y, sliding_rate.x, sliding_rate.y, approach_rate]);
        snapshot.put("mounts", far.to_vec());
        self.save_worn(snapshot);
    }

    /// Takes the accepted state from a snapshot.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let mut list = vec![0.0; State::<D>::NUMBERS * self.accepted.len()];
        snapshot.fill_own("face-states", self.team(), &mut list)?;
        self.accepted = list.chunks_exact(State::<D>::NUMBERS).map(State::read).collect();
        let [approach, x, y, v_x, v_y, approach_rate] = snapshot.numbers("face")?;
        let (sliding, sliding_rate) = (Vector2::new(x, y), Vector2::new(v_x, v_y));
        let far = snapshot.numbers("mounts")?;
        self.place = Placement { approach, sliding, sliding_rate, approach_rate, far, ..Placement::default() };
        self.restore_worn(snapshot)
    }
}

/// x and y of a vector.
fn along_the_plane<const D: usize>(vector: &SVector<f64, D>) -> Vector2<f64> {
    Vector2::from_fn(|axis, _| if axis + 1 < D { vector[axis] } else { 0.0 })
}

/// x and y of a tangential vector once its face is turned from its normal to lie flat, by the least rotation.
fn laid_flat<const D: usize>(vector: &SVector<f64, D>, normal: &SVector<f64, D>) -> Vector2<f64> {
    let rise = vector[D - 1] / (1.0 + normal[D - 1]);
    along_the_plane(&(vector - normal * rise))
}

#[cfg(test)]
mod tests;
