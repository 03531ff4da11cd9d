//! The interface half of the residual: nonlinear contact on the contact face.
//!
//! Every rank holds the whole face (it is one dimension smaller than the body) and evaluates all of it from the same
//! numbers, so every rank sees the same error and the same totals; each rank assembles only the rows that it owns.

mod augmentation;
mod exchange;
mod oscillation;
mod sites;
mod stations;

use nalgebra::{Matrix2, Vector2};

use crate::element::mpjr::{self, Motion, Quadrature, Resistance, Traction, Under};
use crate::error::Result;
use crate::friction::Friction;
use crate::loading::Placement;
use crate::mesh::Face;
use crate::profile::{Elevation, Profile};
use crate::snapshot::Snapshot;

use augmentation::{Augmentation, Multipliers};
use sites::Sites;

pub use exchange::Exchange;
pub use sites::Point;
pub use stations::Station;

/// Displacements and rates of the face's nodes, in the order of the face: x, z of each.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// m
    pub displacement: Vec<f64>,
    /// m/s
    pub rate: Vec<f64>,
}

/// The laws of the contact.
pub struct Laws {
    /// The rigid profile.
    pub profile: Box<dyn Profile>,
    /// Penalty alpha, Pa/m; with multipliers, that to begin with.
    pub penalty: f64,
    /// The tolerance of the augmented Lagrangian; none = penalty only.
    pub augmentation: Option<f64>,
    /// None = frictionless.
    pub friction: Option<Friction>,
}

/// The MPJR interface elements of a contact face.
pub struct Interface {
    face: Face,
    laws: Laws,
    /// Where the tractions act.
    acting: Sites,
    /// The nodes, where the fields are shown; none = where the tractions act.
    shown: Option<Sites>,
    augmentation: Option<Augmentation>,
    /// Evaluations of the tangential law in residuals and tangents.
    tangential_laws: usize,
}

/// The residual of the face, internal minus external, N/m, per node: (x, z).
pub type Residual = Vec<Vector2<f64>>;

/// The tangent of the face: the blocks of each node with itself and, under Gauss quadrature, along each edge.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tangent {
    /// One block per node, N/m per m.
    pub diagonal: Vec<Matrix2<f64>>,
    /// Per edge, the blocks (first, second end) and (second, first end); empty under nodal quadrature.
    pub coupling: Vec<[Matrix2<f64>; 2]>,
}

/// Integrals over the contact face.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Totals {
    /// integral of (p n_z - q t_z), N/m: the vertical force, compression positive; on a flat face, of p.
    pub normal_force: f64,
    /// integral of q t_x, N/m, on the layer, positive along +x. The horizontal part of the pressure on a curved face
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

/// Fields at the face's nodes, in the frames of the elements; at a node between elements of two directions, the mean.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fields {
    /// p, Pa, positive in compression.
    pub pressure: Vec<f64>,
    /// q, Pa, on the layer, positive along +x.
    pub shear: Vec<f64>,
    /// Corrected normal gap g*, m; negative = penetration.
    pub gap: Vec<f64>,
    /// w, m/s
    pub slip_rate: Vec<f64>,
    /// Slip while sticking, m.
    pub stuck: Vec<f64>,
}

impl Surface {
    /// At rest.
    pub fn at_rest(nodes: usize) -> Self {
        Self { displacement: vec![0.0; 2 * nodes], rate: vec![0.0; 2 * nodes] }
    }

    /// The motion interpolated between two nodes.
    fn at(&self, nodes: [usize; 2], shape: [f64; 2]) -> Under {
        let at = |values: &[f64], node: usize| Vector2::new(values[2 * node], values[2 * node + 1]);
        let mix = |values: &[f64]| at(values, nodes[0]) * shape[0] + at(values, nodes[1]) * shape[1];
        Under { displacement: mix(&self.displacement), rate: mix(&self.rate) }
    }
}

impl Interface {
    /// The interface elements of `face`.
    pub fn new(face: Face, laws: Laws, quadrature: Quadrature) -> Self {
        let acting = Sites::new(&face, quadrature);
        let shown = (quadrature != Quadrature::Nodal).then(|| Sites::new(&face, Quadrature::Nodal));
        let augment = |tolerance| Augmentation::new(tolerance, laws.penalty, acting.points.len());
        let augmentation = laws.augmentation.map(augment);
        Self { face, laws, acting, shown, augmentation, tangential_laws: 0 }
    }

    /// The face.
    pub fn face(&self) -> &Face {
        &self.face
    }

    /// The friction law.
    pub fn friction(&self) -> Option<&Friction> {
        self.laws.friction.as_ref()
    }

    /// How often residuals and tangents evaluated the tangential law.
    pub fn tangential_laws(&self) -> usize {
        self.tangential_laws
    }

    /// Whether steps may have to be solved again: see [`Self::augment`].
    pub fn is_augmented(&self) -> bool {
        self.augmentation.is_some()
    }

    /// out = the residual with the indenter at `placement`.
    ///
    /// # Errors
    /// A domain error where the profile is not known.
    pub fn residual(&mut self, placement: Placement, surface: &Surface, out: &mut Residual) -> Result<()> {
        self.attempt(placement)?;
        out.clear();
        out.resize(self.face.x.len(), Vector2::zeros());
        let mut in_contact = 0;
        for Answer { point, traction, .. } in self.answers(&self.acting, placement, surface) {
            in_contact += usize::from(traction.pressure > 0.0);
            let force = point.frame.tr_mul(&(traction.residual() * point.weight));
            for (node, shape) in point.nodes.iter().zip(point.shape) {
                out[*node] += force * shape;
            }
        }
        self.count_laws(in_contact);
        Ok(())
    }

    /// out = d(residual)/du when the rates move with the displacements at `shift` = 1/dt, 1/s.
    ///
    /// # Errors
    /// As for [`Self::residual`].
    pub fn tangent(&mut self, placement: Placement, surface: &Surface, shift: f64, out: &mut Tangent) -> Result<()> {
        self.attempt(placement)?;
        out.diagonal.clear();
        out.diagonal.resize(self.face.x.len(), Matrix2::zeros());
        out.coupling.clear();
        let nodal = self.shown.is_none();
        if !nodal {
            out.coupling.resize(self.face.edges.len(), [Matrix2::zeros(); 2]);
        }
        let mut in_contact = 0;
        for (i, Answer { point, traction, .. }) in self.answers(&self.acting, placement, surface).enumerate() {
            in_contact += usize::from(traction.pressure > 0.0);
            let block = point.frame.tr_mul(&(traction.tangent(shift) * point.weight)) * point.frame;
            let ([a, b], [na, nb]) = (point.nodes, point.shape);
            out.diagonal[a] += block * (na * na);
            if !nodal {
                out.diagonal[b] += block * (nb * nb);
                // Two points an edge.
                for coupling in &mut out.coupling[i / 2] {
                    *coupling += block * (na * nb);
                }
            }
        }
        self.count_laws(in_contact);
        Ok(())
    }

    /// The integrals over the face.
    ///
    /// # Errors
    /// As for [`Self::residual`].
    pub fn totals(&mut self, placement: Placement, surface: &Surface) -> Result<Totals> {
        self.attempt(placement)?;
        let mut totals = Totals::default();
        let (mut length, mut contact, mut stick) = (0.0, 0.0, 0.0);
        for Answer { point, elevation, motion, traction } in self.answers(&self.acting, placement, surface) {
            let [normal, tangential, hysteretic] = point.forces(&traction, elevation.slope);
            totals.normal_force += normal;
            totals.tangential_force += tangential;
            totals.hysteretic_force += hysteretic;
            totals.max_penetration = totals.max_penetration.max(motion.penetration());
            length += point.weight;
            if traction.pressure > 0.0 {
                contact += point.weight;
            }
            if traction.shear.sticks {
                stick += point.weight;
                totals.stuck_slip = totals.stuck_slip.max(traction.shear.stuck.abs());
            }
        }
        totals.contact_fraction = contact / length;
        totals.stick_fraction = if contact > 0.0 { stick / contact } else { 0.0 };
        let Fields { pressure, shear, .. } = self.fields(placement, surface)?;
        let tractions: Vec<_> = shear.into_iter().zip(pressure).map(|(q, p)| Vector2::new(q, p)).collect();
        totals.traction_oscillation = oscillation::oscillation(&self.face.edges, &tractions);
        Ok(totals)
    }

    /// The laws evaluated at the face's nodes.
    ///
    /// # Errors
    /// As for [`Self::residual`].
    pub fn fields(&mut self, placement: Placement, surface: &Surface) -> Result<Fields> {
        self.place_shown(placement)?;
        let sites = self.shown.as_ref().unwrap_or(&self.acting);
        let zeros = || vec![0.0; self.face.x.len()];
        let mut fields = Fields { pressure: zeros(), shear: zeros(), gap: zeros(), slip_rate: zeros(), stuck: zeros() };
        let mut length = zeros();
        for point in &sites.points {
            length[point.nodes[0]] += point.weight;
        }
        for Answer { point, motion, traction, .. } in self.answers(sites, placement, surface) {
            let node = point.nodes[0];
            let share = point.weight / length[node];
            fields.pressure[node] += share * traction.pressure;
            fields.shear[node] += share * traction.shear.shear;
            fields.gap[node] -= share * motion.penetration();
            fields.slip_rate[node] += share * motion.slip.rate;
            fields.stuck[node] += share * traction.shear.stuck;
        }
        Ok(fields)
    }

    /// What to add to the displacements of nodes, m, that a Newton step takes from one surface to another: see
    /// [`Friction::limited`].
    ///
    /// # Errors
    /// As for [`Self::residual`].
    pub fn limit(&mut self, placement: Placement, [from, to]: [&Surface; 2]) -> Result<Vec<(usize, Vector2<f64>)>> {
        let Some(law) = self.laws.friction else { return Ok(Vec::new()) };
        self.place_shown(placement)?;
        let sites = self.shown.as_ref().unwrap_or(&self.acting);
        let pairs = self.answers(sites, placement, from).zip(sites.motions(placement, to));
        let limited = |(Answer { point, motion, traction, .. }, (_, to)): (Answer<'_>, (_, Motion))| {
            let rate = law.limited(motion.slip, to.slip).filter(|_| traction.pressure > 0.0)?;
            let tangent = point.frame.row(0).transpose();
            Some((point.nodes[0], tangent * ((to.slip.rate - rate) * placement.dt)))
        };
        Ok(pairs.filter_map(limited).collect())
    }

    /// Whether a step that was solved must be solved again, with other multipliers; they are then what it begins with.
    ///
    /// # Errors
    /// As for [`Self::residual`]; a solver error where that does not come to an end.
    pub fn augment(&mut self, placement: Placement, surface: &Surface) -> Result<bool> {
        self.attempt(placement)?;
        if !self.is_augmented() {
            return Ok(false);
        }
        let mut deepest = 0.0_f64;
        let pressure = |Answer { motion, traction, .. }: Answer<'_>| {
            if traction.pressure > 0.0 {
                deepest = deepest.max(motion.normal.abs());
            }
            traction.pressure
        };
        let pressure: Vec<f64> = self.answers(&self.acting, placement, surface).map(pressure).collect();
        self.augmentation.as_mut().map_or(Ok(false), |augmentation| augmentation.update(&pressure, deepest))
    }

    /// Takes multipliers and the memory of friction to the end of an accepted step.
    ///
    /// # Errors
    /// As for [`Self::residual`].
    pub fn commit(&mut self, placement: Placement, surface: &Surface) -> Result<()> {
        self.place_shown(placement)?;
        if let Some(augmentation) = &mut self.augmentation {
            augmentation.commit();
        }
        if self.laws.friction.is_none() {
            return Ok(());
        }
        let stuck = |answer: Answer<'_>| answer.traction.shear.stuck;
        let acting: Vec<f64> = self.answers(&self.acting, placement, surface).map(stuck).collect();
        if let Some(mut shown) = self.shown.take() {
            shown.stuck = self.answers(&shown, placement, surface).map(stuck).collect();
            self.shown = Some(shown);
        }
        self.acting.stuck = acting;
        Ok(())
    }

    /// Adds the accepted multipliers and the memory of friction to a snapshot.
    pub fn save(&self, snapshot: &mut Snapshot) {
        if let Some(augmentation) = &self.augmentation {
            let Multipliers { pressure, penalty } = augmentation.accepted();
            snapshot.put("multipliers", pressure.clone());
            snapshot.put("multipliers-penalty", vec![*penalty]);
        }
        if self.laws.friction.is_some() {
            snapshot.put("face-stuck", self.acting.stuck.clone());
            if let Some(shown) = &self.shown {
                snapshot.put("node-stuck", shown.stuck.clone());
            }
        }
    }

    /// Takes the accepted multipliers and the memory of friction from a snapshot.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        if let Some(augmentation) = &mut self.augmentation {
            let [penalty] = snapshot.numbers("multipliers-penalty")?;
            let mut pressure = vec![0.0; self.acting.points.len()];
            snapshot.fill("multipliers", &mut pressure)?;
            augmentation.restore(Multipliers { pressure, penalty });
        }
        if self.laws.friction.is_some() {
            snapshot.fill("face-stuck", &mut self.acting.stuck)?;
            if let Some(shown) = &mut self.shown {
                snapshot.fill("node-stuck", &mut shown.stuck)?;
            }
        }
        Ok(())
    }

    /// The residual norm that round-off in the gap alone can leave, N/m: eps alpha times the lengths whose difference
    /// is the gap.
    pub fn noise(&self, placement: Placement, surface: &Surface) -> f64 {
        let square = |(point, elevation): (&Point, &Elevation)| {
            let motion = (point.frame * surface.at(point.nodes, point.shape).displacement).y.abs();
            let height = elevation.height + point.recess;
            let length = motion.max(placement.approach.abs()).max(height.min(2.0 * placement.approach.abs()));
            (point.weight * length).powi(2)
        };
        let sum: f64 = self.acting.points.iter().zip(&self.acting.elevations).map(square).sum();
        let normal = f64::EPSILON * self.penalty() * sum.sqrt();
        let Placement { approach, sliding_rate, dt, .. } = placement;
        if self.laws.friction.is_none() || dt == 0.0 {
            return normal;
        }
        let shear = |answer: Answer<'_>| {
            let moved = (answer.point.frame * surface.at(answer.point.nodes, answer.point.shape).displacement).x.abs();
            let rate = moved.max(approach.abs()) / dt + sliding_rate.abs();
            (answer.point.weight * answer.traction.shear.by_rate * rate).powi(2)
        };
        let sum: f64 = self.answers(&self.acting, placement, surface).map(shear).sum();
        normal.hypot(f64::EPSILON * sum.sqrt())
    }

    /// The largest stiffness of a point, N/m per m.
    pub fn stiffest(&self) -> f64 {
        self.penalty() * self.acting.points.iter().fold(0.0, |most: f64, point| most.max(point.weight))
    }

    /// alpha, Pa/m
    fn penalty(&self) -> f64 {
        self.augmentation.as_ref().map_or(self.laws.penalty, |augmentation| augmentation.multipliers().penalty)
    }

    /// What each point resists penetration with, in order.
    fn resistances(&self) -> impl Iterator<Item = Resistance> {
        let penalty = self.penalty();
        let multipliers = self.augmentation.as_ref().map(|augmentation| &augmentation.multipliers().pressure);
        (0..).map(move |i: usize| Resistance { penalty, multiplier: multipliers.map_or(0.0, |all| all[i]) })
    }

    /// Brings the profile and the multipliers to a state that is to be evaluated.
    fn attempt(&mut self, placement: Placement) -> Result<()> {
        if let Some(augmentation) = &mut self.augmentation {
            augmentation.attempt(placement);
        }
        self.acting.place(self.laws.profile.as_ref(), placement)
    }

    /// The same where the fields are shown.
    fn place_shown(&mut self, placement: Placement) -> Result<()> {
        self.attempt(placement)?;
        self.shown.as_mut().map_or(Ok(()), |shown| shown.place(self.laws.profile.as_ref(), placement))
    }

    /// The laws evaluated at each of the sites, which have been placed.
    fn answers<'a>(
        &'a self,
        sites: &'a Sites,
        placement: Placement,
        surface: &'a Surface,
    ) -> impl Iterator<Item = Answer<'a>> {
        let motions = sites.motions(placement, surface).zip(&sites.elevations).zip(self.resistances());
        motions.map(move |(((point, motion), elevation), resistance)| {
            let traction = mpjr::traction(motion, resistance, self.laws.friction.as_ref());
            Answer { point, elevation, motion, traction }
        })
    }

    /// The tangential law is asked where there is pressure.
    fn count_laws(&mut self, in_contact: usize) {
        if self.laws.friction.is_some() {
            self.tangential_laws += in_contact;
        }
    }
}

/// The laws at one point.
struct Answer<'a> {
    point: &'a Point,
    elevation: &'a Elevation,
    motion: Motion,
    traction: Traction,
}

#[cfg(test)]
mod tests;
