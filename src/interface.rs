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
mod fields;
mod oscillation;
mod points;
mod state;
mod totals;
mod worn;

use std::rc::Rc;

use nalgebra::Vector2;

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
pub use fields::Fields;
pub use points::{Point, Points};
pub use state::State;
pub use totals::Totals;
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

#[cfg(test)]
mod tests;
