//! Where the laws are evaluated, and what is remembered there.

use nalgebra::Vector2;

use super::Surface;
use crate::element::mpjr::{self, Frame, Motion, Over, Quadrature, Traction};
use crate::error::Result;
use crate::loading::Placement;
use crate::mesh::Face;
use crate::profile::{Elevation, Profile};

/// A point of the face where the laws are evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// The nodes that share it.
    pub nodes: [usize; 2],
    /// Their shares.
    pub shape: [f64; 2],
    /// m
    pub weight: f64,
    /// m
    pub x: f64,
    /// How far below the highest node of the face, m.
    pub recess: f64,
    /// Rows t, n.
    pub frame: Frame,
}

impl Point {
    /// What it adds to N, Q and integral of p dh/dx, N/m: what the indenter works with as it moves down, and along.
    pub fn forces(&self, traction: &Traction, slope: f64) -> [f64; 3] {
        let force = self.frame.tr_mul(&traction.residual());
        let dx = self.weight * self.frame[(0, 0)];
        [self.weight * force.y, dx * traction.shear.shear, dx * traction.pressure * slope]
    }
}

/// Points with the profile over them and the memory of friction.
pub struct Sites {
    pub points: Vec<Point>,
    /// Of the profile over each point, with the indenter where it was placed last.
    pub elevations: Vec<Elevation>,
    /// The sliding that `elevations` hold for, m.
    placed: Option<f64>,
    /// [`crate::friction::Shear::stuck`] of each point at the accepted state, m.
    pub stuck: Vec<f64>,
}

impl Sites {
    /// The points of a quadrature, which have not slipped.
    pub fn new(face: &Face, quadrature: Quadrature) -> Self {
        let points = match quadrature {
            Quadrature::Nodal => lumped_points(face),
            Quadrature::Gauss => edge_points(face, quadrature),
        };
        Self { elevations: Vec::with_capacity(points.len()), placed: None, stuck: vec![0.0; points.len()], points }
    }

    /// Evaluates the profile at the points, once per place of the indenter.
    pub fn place(&mut self, profile: &dyn Profile, placement: Placement) -> Result<()> {
        if self.placed == Some(placement.sliding) {
            return Ok(());
        }
        self.placed = None;
        self.elevations.clear();
        for point in &self.points {
            self.elevations.push(profile.at(point.x - placement.sliding)?);
        }
        self.placed = Some(placement.sliding);
        Ok(())
    }

    /// The relative motion at each point, in order.
    pub fn motions(&self, placement: Placement, surface: &Surface) -> impl Iterator<Item = (&Point, Motion)> {
        let velocity = Vector2::new(placement.sliding_rate, -placement.approach_rate);
        self.points.iter().zip(&self.elevations).zip(&self.stuck).map(move |((point, elevation), &stuck)| {
            let clearance = elevation.height - placement.approach + point.recess;
            let over = Over { clearance, velocity, dt: placement.dt, resolution: placement.resolution };
            let under = surface.at(point.nodes, point.shape);
            (point, Motion::new(&point.frame, over, under, stuck))
        })
    }
}

/// Two points to an edge.
fn edge_points(face: &Face, quadrature: Quadrature) -> Vec<Point> {
    let points = face.edges.iter().flat_map(|edge| {
        quadrature.points(edge.length).map(|point| Point {
            nodes: edge.ends,
            shape: point.shape,
            weight: point.weight,
            x: edge.start + point.shape[1] * edge.length * edge.tangent.x,
            recess: point.shape[0] * face.recess[edge.ends[0]] + point.shape[1] * face.recess[edge.ends[1]],
            frame: mpjr::frame(edge.tangent),
        })
    });
    points.collect()
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
