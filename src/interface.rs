//! The interface half of the residual: nonlinear contact on the contact face.
//!
//! Every rank holds the whole face (it is one dimension smaller than the body) and evaluates all of it from the same
//! numbers, so every rank sees the same error and the same totals; each rank assembles only the rows that it owns.

mod oscillation;

use nalgebra::{Matrix2, Vector2};

use crate::element::mpjr::{self, Motion, Quadrature, Traction};
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
    /// Evaluations of the tangential law in residuals and tangents.
    tangential_laws: usize,
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
    /// integral of p, N/m, compression positive.
    pub normal_force: f64,
    /// integral of q, N/m, on the layer, positive along +x.
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

/// Fields at the face's nodes.
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

    /// The motion interpolated between two nodes: (u_x, u_z, du_x/dt).
    fn at(&self, nodes: [usize; 2], shape: [f64; 2]) -> (f64, f64, f64) {
        let mix = |values: &[f64], component: usize| {
            shape[0] * values[2 * nodes[0] + component] + shape[1] * values[2 * nodes[1] + component]
        };
        (mix(&self.displacement, 0), mix(&self.displacement, 1), mix(&self.rate, 0))
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
                        x: edge.start + point.shape[1] * edge.length,
                    })
                })
                .collect(),
        };
        let elevations = Vec::with_capacity(points.len());
        Self {
            face,
            laws,
            points,
            nodal: quadrature == Quadrature::Nodal,
            placed: None,
            elevations,
            tangential_laws: 0,
        }
    }

    /// The face.
    pub fn face(&self) -> &Face {
        &self.face
    }

    /// Whether a friction law is modelled.
    pub fn has_friction(&self) -> bool {
        self.laws.friction.is_some()
    }

    /// How often residuals and tangents evaluated the tangential law.
    pub fn tangential_laws(&self) -> usize {
        self.tangential_laws
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
        let mut in_contact = 0;
        for (point, elevation) in self.points.iter().zip(&self.elevations) {
            let traction = self.traction(point, elevation, placement, surface);
            in_contact += usize::from(traction.pressure > 0.0);
            let force = traction.residual() * point.weight;
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
        self.place(placement)?;
        out.diagonal.clear();
        out.diagonal.resize(self.face.x.len(), Matrix2::zeros());
        out.coupling.clear();
        if !self.nodal {
            out.coupling.resize(self.face.edges.len(), [Matrix2::zeros(); 2]);
        }
        let mut in_contact = 0;
        for (i, (point, elevation)) in self.points.iter().zip(&self.elevations).enumerate() {
            let traction = self.traction(point, elevation, placement, surface);
            in_contact += usize::from(traction.pressure > 0.0);
            let block = traction.tangent(shift) * point.weight;
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
        self.count_laws(in_contact);
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
        let mut tractions = Vec::with_capacity(self.face.x.len());
        for (point, elevation) in self.points.iter().zip(&self.elevations) {
            let motion = motion(point, elevation, placement, surface);
            let traction = mpjr::traction(motion, self.laws.penalty, self.laws.friction.as_ref());
            tractions.push(Vector2::new(traction.shear, traction.pressure));
            totals.normal_force += point.weight * traction.pressure;
            totals.tangential_force += point.weight * traction.shear;
            totals.hysteretic_force += point.weight * traction.pressure * elevation.slope;
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
        if !self.nodal {
            let Fields { pressure, shear, .. } = self.fields(placement, surface)?;
            tractions = shear.into_iter().zip(pressure).map(|(q, p)| Vector2::new(q, p)).collect();
        }
        totals.traction_oscillation = oscillation::oscillation(&self.face.edges, &tractions);
        Ok(totals)
    }

    /// The laws evaluated at the face's nodes.
    ///
    /// # Errors
    /// As for [`Self::residual`].
    pub fn fields(&self, placement: Placement, surface: &Surface) -> Result<Fields> {
        let mut fields = Fields::default();
        for (node, &x) in self.face.x.iter().enumerate() {
            let point = Point { nodes: [node, node], shape: [1.0, 0.0], weight: 1.0, x };
            let elevation = self.laws.profile.at(x - placement.sliding)?;
            let motion = motion(&point, &elevation, placement, surface);
            let traction = mpjr::traction(motion, self.laws.penalty, self.laws.friction.as_ref());
            fields.pressure.push(traction.pressure);
            fields.shear.push(traction.shear);
            fields.gap.push(motion.clearance - motion.normal);
            fields.slip_rate.push(motion.slip_rate);
        }
        Ok(fields)
    }

    /// The residual norm that round-off in the gap alone can leave, N/m: eps alpha times the lengths whose difference
    /// is the gap.
    pub fn noise(&self, placement: Placement, surface: &Surface) -> f64 {
        let square = |(point, elevation): (&Point, &Elevation)| {
            let (_, uz, _) = surface.at(point.nodes, point.shape);
            let length =
                uz.abs().max(placement.approach.abs()).max(elevation.height.min(2.0 * placement.approach.abs()));
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

    /// The tangential law is asked where there is pressure.
    fn count_laws(&mut self, in_contact: usize) {
        if self.has_friction() {
            self.tangential_laws += in_contact;
        }
    }

    fn traction(&self, point: &Point, elevation: &Elevation, placement: Placement, surface: &Surface) -> Traction {
        mpjr::traction(motion(point, elevation, placement, surface), self.laws.penalty, self.laws.friction.as_ref())
    }
}

/// The relative motion at a point of the flat face: t = x, n = z.
fn motion(point: &Point, elevation: &Elevation, placement: Placement, surface: &Surface) -> Motion {
    let (_, normal, rate) = surface.at(point.nodes, point.shape);
    Motion { clearance: elevation.height - placement.approach, normal, slip_rate: placement.sliding_rate - rate }
}

/// Nodal quadrature: one point per node with half of each adjoining edge.
fn lumped_points(face: &Face) -> Vec<Point> {
    let mut points: Vec<Point> = (0..face.x.len())
        .map(|node| Point { nodes: [node, node], shape: [1.0, 0.0], weight: 0.0, x: face.x[node] })
        .collect();
    for edge in &face.edges {
        for (end, point) in edge.ends.iter().zip(Quadrature::Nodal.points(edge.length)) {
            points[*end].weight += point.weight;
        }
    }
    points
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::mesh::{Layer, Sides};
    use crate::profile::Harmonic;

    fn interface(quadrature: Quadrature, sides: Sides) -> Interface {
        let layer = Layer { width: 1.0, depth: 1.0, cells: [8, 1], grading: 1.0, sides };
        let profile = Box::new(Harmonic { amplitude: 0.01, wavelength: 1.0 });
        let friction = Some(Friction::coulomb_tanh(0.3, 0.02));
        Interface::new(layer.mesh().face, Laws { profile, penalty: 50.0, friction }, quadrature)
    }

    fn placement() -> Placement {
        Placement { approach: 0.012, sliding: 0.13, sliding_rate: 0.05 }
    }

    /// A wavy surface whose rates follow its displacements at `shift`.
    fn surface(nodes: usize, shift: f64, perturb: (usize, f64)) -> Surface {
        let mut displacement: Vec<f64> = (0..2 * nodes).map(|i| 1e-3 * (1.7 * i as f64).sin()).collect();
        displacement[perturb.0] += perturb.1;
        let rate = displacement.iter().map(|u| shift * u).collect();
        Surface { displacement, rate }
    }

    /// The whole face's tangent against central differences, for both rules, on open and closed faces.
    #[test]
    fn tangent_is_the_derivative_of_the_residual() {
        for (quadrature, sides) in
            [(Quadrature::Nodal, Sides::Free), (Quadrature::Gauss, Sides::Free), (Quadrature::Gauss, Sides::Periodic)]
        {
            let mut interface = interface(quadrature, sides);
            let (nodes, shift, step) = (interface.face.x.len(), 10.0, 1e-7);
            let mut tangent = Tangent::default();
            interface.tangent(placement(), &surface(nodes, shift, (0, 0.0)), shift, &mut tangent).unwrap();
            let mut dense = nalgebra::DMatrix::<f64>::zeros(2 * nodes, 2 * nodes);
            for (node, block) in tangent.diagonal.iter().enumerate() {
                dense.view_mut((2 * node, 2 * node), (2, 2)).copy_from(block);
            }
            for (edge, [forward, backward]) in interface.face.edges.clone().iter().zip(&tangent.coupling) {
                let [a, b] = edge.ends;
                dense.view_mut((2 * a, 2 * b), (2, 2)).copy_from(forward);
                dense.view_mut((2 * b, 2 * a), (2, 2)).copy_from(backward);
            }
            for column in 0..2 * nodes {
                let mut at = |h: f64| {
                    let mut out = Residual::new();
                    interface.residual(placement(), &surface(nodes, shift, (column, h)), &mut out).unwrap();
                    out
                };
                let (plus, minus) = (at(step), at(-step));
                for row in 0..2 * nodes {
                    let numeric = (plus[row / 2][row % 2] - minus[row / 2][row % 2]) / (2.0 * step);
                    assert!((numeric - dense[(row, column)]).abs() < 1e-6, "{row} {column}");
                }
            }
        }
    }

    /// Both rules give the exact force of a linear pressure over the face in full contact.
    #[test]
    fn totals_integrate_the_tractions() {
        for quadrature in [Quadrature::Nodal, Quadrature::Gauss] {
            let mut interface = interface(quadrature, Sides::Periodic);
            let place = Placement { approach: 0.1, sliding: 0.0, sliding_rate: 1e3 };
            let totals = interface.totals(place, &Surface::at_rest(8)).unwrap();
            // p = alpha (D - g0 (1 - cos)), whose mean is alpha (D - g0).
            assert!((totals.normal_force - 50.0 * 0.09).abs() < 1e-13);
            assert!((totals.tangential_force - 0.3 * 50.0 * 0.09).abs() < 1e-13);
            assert_eq!((totals.contact_fraction, totals.stick_fraction), (1.0, 0.0));
        }
    }
}
