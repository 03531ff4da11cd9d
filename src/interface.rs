//! The interface half of the residual: nonlinear contact on the contact face.
//!
//! Every rank holds the whole face (it is one dimension smaller than the body) and evaluates all of it from the same
//! numbers, so every rank sees the same error and the same totals; each rank assembles only the rows that it owns.

mod oscillation;

use nalgebra::{Matrix2, Vector2};

use crate::element::mpjr::{self, Frame, Motion, Over, Quadrature, Traction, Under};
use crate::error::Result;
use crate::friction::Friction;
use crate::loading::Placement;
use crate::mesh::Face;
use crate::profile::{Elevation, Profile};

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
    /// Penalty alpha, Pa/m.
    pub penalty: f64,
    /// None = frictionless.
    pub friction: Option<Friction>,
}

/// The MPJR interface elements of a contact face.
pub struct Interface {
    face: Face,
    laws: Laws,
    points: Vec<Point>,
    nodal: bool,
    /// The indenter's place that `elevations` hold for.
    placed: Option<Placement>,
    elevations: Vec<Elevation>,
}

/// An integration point of the face.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Point {
    nodes: [usize; 2],
    shape: [f64; 2],
    /// m
    weight: f64,
    /// m
    x: f64,
    /// How far below the highest node of the face, m.
    recess: f64,
    frame: Frame,
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
        let points = match quadrature {
            Quadrature::Nodal => lumped_points(&face),
            Quadrature::Gauss => face
                .edges
                .iter()
                .flat_map(|edge| {
                    quadrature.points(edge.length).map(|point| Point {
                        nodes: edge.ends,
                        shape: point.shape,
                        weight: point.weight,
                        x: edge.start + point.shape[1] * edge.length * edge.tangent.x,
                        recess: point.shape[0] * face.recess[edge.ends[0]] + point.shape[1] * face.recess[edge.ends[1]],
                        frame: mpjr::frame(edge.tangent),
                    })
                })
                .collect(),
        };
        let elevations = Vec::with_capacity(points.len());
        Self { face, laws, points, nodal: quadrature == Quadrature::Nodal, placed: None, elevations }
    }

    /// The face.
    pub fn face(&self) -> &Face {
        &self.face
    }

    /// Whether a friction law is modelled.
    pub fn has_friction(&self) -> bool {
        self.laws.friction.is_some()
    }

    /// Whether friction still answers to the slip rate at this one, m/s.
    pub fn grips(&self, slip_rate: f64) -> bool {
        let answer = |law: &Friction, rate| law.shear(1.0, rate).by_rate;
        self.laws.friction.as_ref().is_some_and(|law| answer(law, slip_rate) > 1e-6 * answer(law, 0.0))
    }

    /// The largest share of the pressure that friction takes: f.
    pub fn largest_drag(&self) -> f64 {
        self.laws.friction.as_ref().map_or(0.0, |law| law.shear(1.0, f64::MAX).shear)
    }

    /// out = the residual with the indenter at `placement`.
    ///
    /// # Errors
    /// A domain error where the profile is not known.
    pub fn residual(&mut self, placement: Placement, surface: &Surface, out: &mut Residual) -> Result<()> {
        self.place(placement)?;
        out.clear();
        out.resize(self.face.x.len(), Vector2::zeros());
        for (point, elevation) in self.points.iter().zip(&self.elevations) {
            let force = self.traction(point, elevation, placement, surface).residual() * point.weight;
            let force = point.frame.tr_mul(&force);
            for (node, shape) in point.nodes.iter().zip(point.shape) {
                out[*node] += force * shape;
            }
        }
        Ok(())
    }

    /// out = d(residual)/du when the rates move with the displacements at `shift` = 1/dt, 1/s.
    ///
    /// # Errors
    /// As for [`Self::residual`].
    pub fn tangent(&mut self, placement: Placement, surface: &Surface, shift: f64, out: &mut Tangent) -> Result<()> {
        self.place(placement)?;
        out.diagonal.clear();
        out.diagonal.resize(self.face.x.len(), Matrix2::zeros());
        out.coupling.clear();
        if !self.nodal {
            out.coupling.resize(self.face.edges.len(), [Matrix2::zeros(); 2]);
        }
        for (i, (point, elevation)) in self.points.iter().zip(&self.elevations).enumerate() {
            let block = self.traction(point, elevation, placement, surface).tangent(shift) * point.weight;
            let block = point.frame.tr_mul(&block) * point.frame;
            let ([a, b], [na, nb]) = (point.nodes, point.shape);
            out.diagonal[a] += block * (na * na);
            if !self.nodal {
                out.diagonal[b] += block * (nb * nb);
                // Two points an edge.
                for coupling in &mut out.coupling[i / 2] {
                    *coupling += block * (na * nb);
                }
            }
        }
        Ok(())
    }

    /// The integrals over the face.
    ///
    /// # Errors
    /// As for [`Self::residual`].
    pub fn totals(&mut self, placement: Placement, surface: &Surface) -> Result<Totals> {
        self.place(placement)?;
        let mut totals = Totals::default();
        let (mut length, mut contact, mut stick) = (0.0, 0.0, 0.0);
        for (point, elevation) in self.points.iter().zip(&self.elevations) {
            let motion = motion(point, elevation, placement, surface);
            let traction = mpjr::traction(motion, self.laws.penalty, self.laws.friction.as_ref());
            let force = point.frame.tr_mul(&traction.residual());
            let dx = point.weight * point.frame[(0, 0)];
            totals.normal_force += point.weight * force.y;
            totals.tangential_force += dx * traction.shear;
            totals.hysteretic_force += dx * traction.pressure * elevation.slope;
            totals.max_penetration = totals.max_penetration.max(motion.normal - motion.clearance);
            length += point.weight;
            if traction.pressure > 0.0 {
                contact += point.weight;
                if self.laws.friction.as_ref().is_some_and(|law| law.sticks(motion.slip_rate)) {
                    stick += point.weight;
                }
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
    pub fn fields(&self, placement: Placement, surface: &Surface) -> Result<Fields> {
        let nodes = self.face.x.len();
        let zeros = || vec![0.0; nodes];
        let mut fields = Fields { pressure: zeros(), shear: zeros(), gap: zeros(), slip_rate: zeros() };
        let points = lumped_points(&self.face);
        let mut length = zeros();
        for point in &points {
            length[point.nodes[0]] += point.weight;
        }
        for point in &points {
            let node = point.nodes[0];
            let share = point.weight / length[node];
            let elevation = self.laws.profile.at(point.x - placement.sliding)?;
            let motion = motion(point, &elevation, placement, surface);
            let traction = mpjr::traction(motion, self.laws.penalty, self.laws.friction.as_ref());
            fields.pressure[node] += share * traction.pressure;
            fields.shear[node] += share * traction.shear;
            fields.gap[node] += share * (motion.clearance - motion.normal);
            fields.slip_rate[node] += share * motion.slip_rate;
        }
        Ok(fields)
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
        let sum: f64 = self.points.iter().zip(&self.elevations).map(square).sum();
        f64::EPSILON * self.laws.penalty * sum.sqrt()
    }

    /// Evaluates the profile at the points, once per place of the indenter.
    fn place(&mut self, placement: Placement) -> Result<()> {
        if self.placed.is_some_and(|placed| placed.sliding == placement.sliding) {
            return Ok(());
        }
        self.placed = None;
        self.elevations.clear();
        for point in &self.points {
            self.elevations.push(self.laws.profile.at(point.x - placement.sliding)?);
        }
        self.placed = Some(placement);
        Ok(())
    }

    fn traction(&self, point: &Point, elevation: &Elevation, placement: Placement, surface: &Surface) -> Traction {
        mpjr::traction(motion(point, elevation, placement, surface), self.laws.penalty, self.laws.friction.as_ref())
    }
}

/// The relative motion at a point of the face.
fn motion(point: &Point, elevation: &Elevation, placement: Placement, surface: &Surface) -> Motion {
    let over = Over {
        clearance: elevation.height - placement.approach + point.recess,
        velocity: Vector2::new(placement.sliding_rate, -placement.approach_rate),
    };
    Motion::new(&point.frame, over, surface.at(point.nodes, point.shape))
}

/// Nodal quadrature: half of each edge at either end; the two halves at a node are one point where the edges have one
/// direction.
fn lumped_points(face: &Face) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::with_capacity(face.x.len());
    // The first point of each node.
    let mut first = vec![usize::MAX; face.x.len()];
    for edge in &face.edges {
        let frame = mpjr::frame(edge.tangent);
        for (&node, half) in edge.ends.iter().zip(Quadrature::Nodal.points(edge.length)) {
            match points.get_mut(first[node]) {
                Some(point) if point.frame == frame => point.weight += half.weight,
                _ => {
                    first[node] = first[node].min(points.len());
                    let (x, recess) = (face.x[node], face.recess[node]);
                    points.push(Point {
                        nodes: [node, node],
                        shape: [1.0, 0.0],
                        weight: half.weight,
                        x,
                        recess,
                        frame,
                    });
                }
            }
        }
    }
    points
}

#[cfg(test)]
mod tests;
