//! Where the laws of the contact are evaluated.

use std::rc::Rc;

use nalgebra::{SVector, Vector2};

use crate::element::mpjr::Quadrature;
use crate::error::Result;
use crate::loading::Placement;
use crate::mesh::{Axis, Face, Grid};
use crate::parallel::Team;
use crate::profile::{Height, Surface};

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
    /// The grid that the points make, if they do; of a parted face that of all points.
    grid: Option<Grid>,
    /// The ranks that share them.
    team: Rc<Team>,
    flat: bool,
    /// Of the profile over each point, with the indenter where it was placed last.
    heights: Vec<Height>,
    /// The sliding that `heights` hold for, m.
    placed: Option<Vector2<f64>>,
}

impl<const D: usize> Point<D> {
    /// Where it is along the face, m.
    pub fn along(&self) -> Vector2<f64> {
        Vector2::from_fn(|axis, _| if axis + 1 < D { self.place[axis] } else { 0.0 })
    }
}

impl<const D: usize> Points<D> {
    /// The points of a quadrature on a face.
    pub fn new(face: &Face<D>, quadrature: Quadrature) -> Self {
        match quadrature {
            Quadrature::Nodal => Self::nodes(face),
            Quadrature::Gauss => Self::of_facets(face),
        }
    }

    /// Nodal quadrature: what each facet gives its corners; the normal of a node is the mean of its facets', by what they give it.
    fn nodes(face: &Face<D>) -> Self {
        let mut areas = vec![(SVector::<f64, D>::zeros(), 0.0); face.count()];
        for facet in &face.facets {
            for (&node, point) in facet.nodes.iter().zip(facet.at_nodes()) {
                areas[node].0 += point.area;
                areas[node].1 += point.area.norm();
            }
        }
        let point = |(place, (area, weight)): (&SVector<f64, D>, (SVector<f64, D>, f64))| {
            // Straight up to the last bit on a flat face.
            let leans = area.iter().take(D - 1).any(|component| *component != 0.0);
            let normal =
                if leans { area.normalize() } else { SVector::from_fn(|i, _| f64::from(u8::from(i + 1 == D))) };
            Point { place: *place, normal, weight }
        };
        let all: Vec<_> = face.places.iter().zip(areas).map(point).collect();
        let (shares, starts) = ((0..all.len()).map(|node| (node, 1.0)).collect(), (0..=all.len()).collect());
        Self::of((all, shares, starts), face.grid.clone())
    }

    /// Gauss points of each facet.
    fn of_facets(face: &Face<D>) -> Self {
        let (mut all, mut shares, mut starts) = (Vec::new(), Vec::new(), vec![0]);
        for facet in &face.facets {
            for point in facet.at_gauss_points() {
                let place = facet.corners.iter().zip(&point.shape).map(|(corner, share)| corner * *share).sum();
                let weight = point.area.norm();
                all.push(Point { place, normal: point.area / weight, weight });
                shares.extend(facet.nodes.iter().copied().zip(point.shape));
                starts.push(shares.len());
            }
        }
        // In the plane they come in order of x, too.
        let axes = |grid: &Grid| {
            let places = all.iter().map(|point: &Point<D>| point.place[0]).collect();
            vec![Axis { places, period: grid.axes[0].period }]
        };
        let grid = face.grid.as_ref().filter(|_| D == 2).map(|grid| Grid { axes: axes(grid) });
        Self::of((all, shares, starts), grid)
    }

    fn of((all, shares, starts): (Vec<Point<D>>, Vec<(usize, f64)>, Vec<usize>), grid: Option<Grid>) -> Self {
        let flat = all.iter().all(|point| point.normal[D - 1] == 1.0);
        Self { all, shares, starts, grid, team: Team::alone(), flat, heights: Vec::new(), placed: None }
    }

    /// Those of this rank, where nodes are points that make a grid.
    pub fn among(self, team: Rc<Team>) -> Self {
        let all = self.all[team.nodes(self.all.len())].to_vec();
        let (shares, starts) = ((0..all.len()).map(|node| (node, 1.0)).collect(), (0..=all.len()).collect());
        Self { all, shares, starts, team, heights: Vec::new(), placed: None, ..self }
    }

    /// The ranks that share them.
    pub fn team(&self) -> &Rc<Team> {
        &self.team
    }

    /// How many there are on all ranks.
    pub fn everywhere(&self) -> usize {
        self.team.count(self.all.len())
    }

    /// Evaluates the profile at the points, once per place of the indenter. Collective.
    ///
    /// # Errors
    /// A domain error where the profile is not known.
    pub fn place(&mut self, profile: &dyn Surface, placement: Placement) -> Result<()> {
        if self.placed == Some(placement.sliding) {
            return Ok(());
        }
        self.placed = None;
        self.heights = self.team.agree(self.heights_at(profile, placement.sliding))?;
        self.placed = Some(placement.sliding);
        Ok(())
    }

    /// The profile is another one.
    pub fn forget(&mut self) {
        self.placed = None;
    }

    /// The profile at the points with the indenter at `sliding`, m.
    ///
    /// # Errors
    /// As for [`Self::place`].
    pub fn heights_at(&self, profile: &dyn Surface, sliding: Vector2<f64>) -> Result<Vec<Height>> {
        self.all.iter().map(|point| profile.at(point.along() - sliding)).collect()
    }

    /// All of this rank.
    pub fn all(&self) -> &[Point<D>] {
        &self.all
    }

    /// How many there are on this rank.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// Whether all normals are straight up.
    pub fn are_flat(&self) -> bool {
        self.flat
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

    /// The points on either side of one along an axis of the face; none at the ends, and none where points are not nodes of a grid. Those
    /// of the lines before and after this rank's follow its own.
    pub fn beside(&self, i: usize, axis: usize) -> [Option<usize>; 2] {
        let Some(grid) = self.grid.as_ref().filter(|_| !self.share_nodes()) else { return [None; 2] };
        if axis > 0 || !self.team.is_parted() {
            return grid.beside(i, axis);
        }
        let (columns, count) = (grid.stride(0), self.all.len());
        let before = i.checked_sub(columns).unwrap_or(count + i);
        let after = if i + columns < count { i + columns } else { i + 2 * columns };
        [Some(before), Some(after)]
    }

    /// The profile over each point, where the indenter was placed last.
    pub fn heights(&self) -> &[Height] {
        &self.heights
    }

    /// A field of the points carried along the face by `way`, m, between points by linear interpolation; none where that is
    /// less than the distance of two points, or where they make no grid. Off the ends of an open face there is nothing. Collective.
    pub fn carried(&self, field: &[SVector<f64, D>], way: Vector2<f64>) -> Option<Vec<SVector<f64, D>>> {
        let axes = &self.grid.as_ref()?.axes;
        if !self.is_carried(way) {
            return None;
        }
        let mut carried = field.to_vec();
        for (axis, (line, way)) in axes.iter().zip(way.iter()).enumerate().filter(|(_, (_, way))| **way != 0.0) {
            carried = self.carried_along(&carried, axis, (line, *way));
        }
        Some(carried)
    }

    /// Whether a way is more than the distance of two points of a grid.
    pub fn is_carried(&self, way: Vector2<f64>) -> bool {
        let spacing = |axis: &Axis| match axis.places.as_slice() {
            [first, .., last] => (last - first) / (axis.places.len() - 1) as f64,
            _ => f64::INFINITY,
        };
        let axes = self.grid.iter().flat_map(|grid| &grid.axes);
        axes.zip(way.iter()).any(|(axis, way)| way.abs() > spacing(axis))
    }

    /// The same along one axis.
    fn carried_along(&self, field: &[SVector<f64, D>], axis: usize, (line, way): (&Axis, f64)) -> Vec<SVector<f64, D>> {
        let stride = self.grid.as_ref().map_or(1, |grid| grid.stride(axis));
        let sources: Vec<_> = line.places.iter().map(|place| line.between(place - way)).collect();
        if axis == 0 && self.team.is_parted() {
            return self.carried_across(field, &sources);
        }
        let from = |node: usize| {
            let at = node / stride % sources.len();
            let first = node - at * stride;
            let value = |(source, share): (usize, f64)| field[first + source * stride] * share;
            sources[at].map_or(SVector::zeros(), |sources| sources.into_iter().map(value).sum())
        };
        (0..field.len()).map(from).collect()
    }

    /// The same along the first axis, where the lines are parted: of each line those that it comes from, and their shares.
    fn carried_across(&self, field: &[SVector<f64, D>], sources: &[Option<[(usize, f64); 2]>]) -> Vec<SVector<f64, D>> {
        let of = |rank: usize| &sources[self.team.lines_of(rank)];
        let wanted = |rank: usize| of(rank).iter().flatten().flatten().map(|(line, _)| *line).collect();
        let flat: Vec<f64> = field.iter().flatten().copied().collect();
        let [_, rank] = self.team.ranks();
        let mine = of(rank);
        let each = flat.len() / mine.len();
        let fetched = self.team.fetched(&flat, wanted);
        let mut lines = fetched.chunks_exact(each);
        let mut carried = vec![SVector::zeros(); field.len()];
        for (target, sources) in carried.chunks_exact_mut(each / D).zip(mine) {
            for (_, share) in sources.iter().flatten() {
                let Some(line) = lines.next() else { break };
                for (target, value) in target.iter_mut().zip(line.chunks_exact(D)) {
                    *target += SVector::<f64, D>::from_column_slice(value) * *share;
                }
            }
        }
        carried
    }
}
