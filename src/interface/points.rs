//! Where the laws of the contact are evaluated.

use nalgebra::SVector;

use crate::element::mpjr::Quadrature;
use crate::error::Result;
use crate::loading::Placement;
use crate::mesh::Face;
use crate::profile::{Elevation, Profile};

/// A point of the face where the laws are evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point<const D: usize> {
    /// Where it is, m; upward from the highest node of the face.
    pub place: SVector<f64, D>,
    /// The unit normal out of the body.
    pub normal: SVector<f64, D>,
    /// The length, or area, of the face that it stands for, m^(D - 1).
    pub weight: f64,
}

/// The points, their nodes, and the profile over them.
pub struct Points<const D: usize> {
    all: Vec<Point<D>>,
    /// Of point i, `shares[starts[i]..starts[i + 1]]`: nodes and what part of it each carries, which sum to 1.
    shares: Vec<(usize, f64)>,
    starts: Vec<usize>,
    /// The points on either side, where points are nodes; none at the ends.
    beside: Vec<[Option<usize>; 2]>,
    /// After which the face repeats, m; none = it ends.
    period: Option<f64>,
    /// Of the profile over each point, with the indenter where it was placed last.
    elevations: Vec<Elevation>,
    /// The sliding that `elevations` hold for, m.
    placed: Option<f64>,
}

impl Points<2> {
    /// The points of a quadrature on a face.
    pub fn new(face: &Face, quadrature: Quadrature) -> Self {
        match quadrature {
            Quadrature::Nodal => Self::lumped(face),
            Quadrature::Gauss => Self::of_edges(face),
        }
    }

    /// A field of the points carried along the face by `way`, m, between points by linear interpolation; none where that is
    /// less than the distance of two points. Off the ends of an open face there is nothing.
    pub fn carried(&self, field: &[SVector<f64, 2>], way: f64) -> Option<Vec<SVector<f64, 2>>> {
        let x = |i: usize| self.all[i].place.x;
        let count = field.len();
        if count < 2 || way.abs() * (count - 1) as f64 <= (x(count - 1) - x(0)).abs() {
            return None;
        }
        let period = self.period.unwrap_or(f64::INFINITY);
        let value = |at: f64| {
            let at = if period.is_finite() { x(0) + (at - x(0)).rem_euclid(period) } else { at };
            let right = self.all.partition_point(|point| point.place.x <= at);
            match (right.checked_sub(1), right < count) {
                (Some(left), true) => {
                    let share = (at - x(left)) / (x(right) - x(left));
                    field[left] * (1.0 - share) + field[right] * share
                }
                (Some(left), false) if period.is_finite() => {
                    let share = (at - x(left)) / (x(0) + period - x(left));
                    field[left] * (1.0 - share) + field[0] * share
                }
                (Some(left), false) if at == x(left) => field[left],
                _ => SVector::zeros(),
            }
        };
        Some((0..count).map(|i| value(x(i) - way)).collect())
    }

    /// Two points to an edge.
    fn of_edges(face: &Face) -> Self {
        let (mut all, mut shares) = (Vec::new(), Vec::new());
        for edge in &face.edges {
            for point in Quadrature::Gauss.points(edge.length) {
                let recess = point.shape[0] * face.recess[edge.ends[0]] + point.shape[1] * face.recess[edge.ends[1]];
                let x = edge.start + point.shape[1] * edge.length * edge.tangent.x;
                let normal = SVector::from([-edge.tangent.y, edge.tangent.x]);
                all.push(Point { place: SVector::from([x, -recess]), normal, weight: point.weight });
                shares.extend(edge.ends.into_iter().zip(point.shape));
            }
        }
        let (starts, beside) = ((0..=all.len()).map(|i| 2 * i).collect(), vec![[None; 2]; all.len()]);
        Self { all, shares, starts, beside, period: period(face), elevations: Vec::new(), placed: None }
    }

    /// Nodal quadrature: half of each edge at either end; the normal of a node is the mean of its edges', by their lengths.
    fn lumped(face: &Face) -> Self {
        let nodes = face.x.len();
        let mut all: Vec<Point<2>> = (0..nodes)
            .map(|node| {
                let place = SVector::from([face.x[node], -face.recess[node]]);
                Point { place, normal: SVector::zeros(), weight: 0.0 }
            })
            .collect();
        let mut beside = vec![[None; 2]; nodes];
        for edge in &face.edges {
            for (&node, half) in edge.ends.iter().zip(Quadrature::Nodal.points(edge.length)) {
                all[node].weight += half.weight;
                all[node].normal += SVector::from([-edge.tangent.y, edge.tangent.x]) * half.weight;
            }
            let [left, right] = edge.ends;
            (beside[left][1], beside[right][0]) = (Some(right), Some(left));
        }
        for point in &mut all {
            // Straight up to the last bit on a flat face.
            let [x, z] = [point.normal.x, point.normal.y];
            point.normal = if x == 0.0 { SVector::from([0.0, z.signum()]) } else { point.normal.normalize() };
        }
        let (shares, starts) = ((0..nodes).map(|node| (node, 1.0)).collect(), (0..=nodes).collect());
        Self { all, shares, starts, beside, period: period(face), elevations: Vec::new(), placed: None }
    }

    /// Evaluates the profile at the points, once per place of the indenter.
    ///
    /// # Errors
    /// A domain error where the profile is not known.
    pub fn place(&mut self, profile: &dyn Profile, placement: Placement) -> Result<()> {
        if self.placed == Some(placement.sliding) {
            return Ok(());
        }
        self.placed = None;
        self.elevations.clear();
        for point in &self.all {
            self.elevations.push(profile.at(point.place.x - placement.sliding)?);
        }
        self.placed = Some(placement.sliding);
        Ok(())
    }
}

impl<const D: usize> Points<D> {
    /// All of them.
    pub fn all(&self) -> &[Point<D>] {
        &self.all
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// Whether points are not nodes.
    pub fn share_nodes(&self) -> bool {
        self.shares.len() > self.all.len()
    }

    /// The nodes of a point, and their shares.
    pub fn shares(&self, i: usize) -> &[(usize, f64)] {
        &self.shares[self.starts[i]..self.starts[i + 1]]
    }

    /// What a nodal field, `D` numbers to a node, is at a point.
    pub fn at(&self, i: usize, field: &[f64]) -> SVector<f64, D> {
        let node =
            |&(node, share): &(usize, f64)| SVector::<f64, D>::from_column_slice(&field[D * node..][..D]) * share;
        match self.shares(i) {
            // To the last bit.
            [(only, _)] => node(&(*only, 1.0)),
            several => several.iter().map(node).sum(),
        }
    }

    /// The points on either side of one in the sense of x; none at the ends, and none where points are not nodes.
    pub fn beside(&self, i: usize) -> [Option<usize>; 2] {
        self.beside[i]
    }

    /// The profile over each point, where the indenter was placed last.
    pub fn elevations(&self) -> &[Elevation] {
        &self.elevations
    }
}

/// After which a face repeats, m; none where it has ends.
fn period(face: &Face) -> Option<f64> {
    let last = face.edges.last()?;
    (last.ends[1] == face.edges[0].ends[0]).then(|| last.start + last.length - face.edges[0].start)
}
