//! The contact face of a mesh: nodes, facets, and the grid that they may make.

use nalgebra::SVector;

/// The contact face. The body is below it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Face<const D: usize> {
    /// The unknown of each node.
    pub unknown: Vec<u32>,
    /// Where each node is, m; upward from the highest one, so that a flat face is at 0.
    pub places: Vec<SVector<f64, D>>,
    /// The facets between them.
    pub facets: Vec<Facet<D>>,
    /// The grid that the nodes make: always in the plane, where they come in order of x.
    pub grid: Option<Grid>,
}

/// An edge of a plane contact face, a triangle or a quadrilateral of one in space.
#[derive(Debug, Clone, PartialEq)]
pub struct Facet<const D: usize> {
    /// Indices into the face's nodes: in the sense of +x, or counter-clockwise as seen from above.
    pub nodes: Vec<usize>,
    /// Where they are, m: of a facet across a periodic side, beyond it.
    pub corners: Vec<SVector<f64, D>>,
}

/// A point of a facet where something is integrated.
#[derive(Debug, Clone, PartialEq)]
pub struct FacetPoint<const D: usize> {
    /// The shape functions of the nodes.
    pub shape: Vec<f64>,
    /// The normal out of the body, as long as what the point weighs, m^(D - 1).
    pub area: SVector<f64, D>,
}

/// Nodes at all combinations of places along axes; the last axis runs fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Along x, and in space along y.
    pub axes: Vec<Axis>,
}

/// The places of a grid along one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Ascending, m.
    pub places: Vec<f64>,
    /// After which they repeat, m; none = they end.
    pub period: Option<f64>,
}

impl<const D: usize> Face<D> {
    /// The face whose facets are given, with the grid that its nodes make.
    pub fn new(
        unknown: Vec<u32>,
        places: Vec<SVector<f64, D>>,
        facets: impl IntoIterator<Item = Facet<D>>,
        grid: Option<Grid>,
    ) -> Self {
        Self { unknown, places, facets: facets.into_iter().collect(), grid }
    }

    /// How many nodes it has.
    pub fn count(&self) -> usize {
        self.unknown.len()
    }

    /// The nodes of some of the lines of a face whose nodes make a grid, without facets: lines that come round a periodic axis stand beyond
    /// its end.
    pub fn of_lines(&self, lines: impl Iterator<Item = usize>) -> Self {
        let Some(Grid { axes }) = &self.grid else { return self.clone() };
        let columns: usize = axes[1..].iter().map(|axis| axis.places.len()).product();
        let count = axes[0].places.len();
        let mut part = Self { grid: Some(Grid { axes: axes.clone() }), ..Self::default() };
        let mut along = Axis { places: Vec::new(), period: None };
        for line in lines {
            let beyond = (line / count) as f64 * axes[0].period.unwrap_or(0.0);
            along.places.push(axes[0].places[line % count] + beyond);
            let nodes = line % count * columns..(line % count + 1) * columns;
            part.unknown.extend_from_slice(&self.unknown[nodes.clone()]);
            part.places.extend(self.places[nodes].iter().map(|place| {
                let mut place = *place;
                place[0] += beyond;
                place
            }));
        }
        if let Some(grid) = &mut part.grid {
            grid.axes[0] = along;
        }
        part
    }

    /// The pairs of different nodes that share a facet, both ways round, in order.
    pub fn pairs(&self) -> Vec<(usize, usize)> {
        let of_facet = |facet: &Facet<D>| {
            let nodes = facet.nodes.clone();
            nodes.clone().into_iter().flat_map(move |a| nodes.clone().into_iter().map(move |b| (a, b)))
        };
        let mut pairs: Vec<_> = self.facets.iter().flat_map(of_facet).filter(|(a, b)| a != b).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// The pairs of neighbours round the facets of a face in space, each once, in order.
    pub fn pairs_along_edges(&self) -> Vec<(usize, usize)> {
        let of_facet = |facet: &Facet<D>| {
            let nodes = facet.nodes.clone();
            (0..nodes.len()).map(move |i| (nodes[i], nodes[(i + 1) % nodes.len()])).map(|(a, b)| (a.min(b), a.max(b)))
        };
        let mut pairs: Vec<_> = self.facets.iter().flat_map(of_facet).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// 1 or -1 of each node: on a grid other than its neighbours', on any other face than most of them.
    pub fn checkerboard(&self) -> Vec<f64> {
        let odd = |parity: usize| if parity.is_multiple_of(2) { 1.0 } else { -1.0 };
        if let Some(grid) = &self.grid {
            let counts = grid.counts();
            let parity = |node: usize| (0..counts.len()).map(|axis| node / grid.stride(axis) % counts[axis]).sum();
            return (0..self.count()).map(|node| odd(parity(node))).collect();
        }
        let (mut signs, mut around) = (vec![0.0; self.count()], vec![Vec::new(); self.count()]);
        self.pairs().into_iter().for_each(|(a, b)| around[a].push(b));
        for node in 0..signs.len() {
            let sum: f64 = around[node].iter().map(|&other| signs[other]).sum();
            signs[node] = if sum > 0.0 { -1.0 } else { 1.0 };
        }
        signs
    }

    /// The shortest distance of two nodes of a facet, m.
    pub fn shortest(&self) -> f64 {
        let sides = |facet: &Facet<D>| {
            let count = facet.corners.len();
            (0..count).map(|i| (facet.corners[(i + 1) % count] - facet.corners[i]).norm()).fold(f64::INFINITY, f64::min)
        };
        self.facets.iter().map(sides).fold(f64::INFINITY, f64::min)
    }
}

impl<const D: usize> Facet<D> {
    /// Its nodes, each with half, a third, or what the mapping gives it, of the facet.
    pub fn at_nodes(&self) -> Vec<FacetPoint<D>> {
        let count = self.corners.len();
        let at = |node: usize| {
            let shape = (0..count).map(|other| f64::from(u8::from(other == node))).collect();
            FacetPoint { shape, area: self.area(node) }
        };
        (0..count).map(at).collect()
    }

    /// Its Gauss points: two along an edge, three of a triangle, four of a quadrilateral. Exact for products of what is linear
    /// along flat facets.
    pub fn at_gauss_points(&self) -> Vec<FacetPoint<D>> {
        let (near, far) = (0.5 + 0.5 / 3.0_f64.sqrt(), 0.5 - 0.5 / 3.0_f64.sqrt());
        let count = self.corners.len();
        let at = |node: usize| {
            let round = |other: usize| (other + count - node) % count;
            let shape: Vec<f64> = match count {
                2 => (0..2).map(|other| [near, far][round(other)]).collect(),
                3 => (0..3).map(|other| [2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0][round(other)]).collect(),
                _ => (0..4).map(|other| [near * near, near * far, far * far, far * near][round(other)]).collect(),
            };
            // The area is linear over the facet.
            let area = shape.iter().enumerate().map(|(other, share)| self.area(other) * *share).sum();
            FacetPoint { shape, area }
        };
        (0..count).map(at).collect()
    }

    /// The normal at a corner, as long as what a corner stands for there, m^(D - 1).
    fn area(&self, corner: usize) -> SVector<f64, D> {
        let count = self.corners.len();
        let side = |to: usize| self.corners[to] - self.corners[corner];
        match (D, count) {
            // Half of an edge, turned upward.
            (2, _) => {
                let along = (self.corners[1] - self.corners[0]) * 0.5;
                SVector::from_fn(|i, _| if i == 0 { -along[1] } else { along[0] })
            }
            // A third of half of the parallelogram, or a quarter of it.
            (_, 3) => cross(&side((corner + 1) % 3), &side((corner + 2) % 3)) / 6.0,
            _ => cross(&side((corner + 1) % 4), &side((corner + 3) % 4)) / 4.0,
        }
    }
}

/// nalgebra's own is for three dimensions alone.
fn cross<const D: usize>(a: &SVector<f64, D>, b: &SVector<f64, D>) -> SVector<f64, D> {
    SVector::from_fn(|i, _| {
        let (j, k) = ((i + 1) % D, (i + 2) % D);
        a[j] * b[k] - a[k] * b[j]
    })
}

impl Grid {
    /// How many places there are along each axis.
    pub fn counts(&self) -> Vec<usize> {
        self.axes.iter().map(|axis| axis.places.len()).collect()
    }

    /// Whether it repeats along every axis.
    pub fn is_periodic(&self) -> bool {
        self.axes.iter().all(|axis| axis.period.is_some())
    }

    /// How far apart neighbours along an axis are in the order of nodes.
    pub fn stride(&self, axis: usize) -> usize {
        self.axes[axis + 1..].iter().map(|axis| axis.places.len()).product()
    }

    /// The nodes on either side of one along an axis; none at the ends.
    pub fn beside(&self, node: usize, axis: usize) -> [Option<usize>; 2] {
        let (stride, Axis { places, period }) = (self.stride(axis), &self.axes[axis]);
        let (count, at) = (places.len(), node / self.stride(axis) % places.len());
        let around = period.is_some();
        let before = if at > 0 { Some(node - stride) } else { around.then(|| node + (count - 1) * stride) };
        let after = if at + 1 < count { Some(node + stride) } else { around.then(|| node - (count - 1) * stride) };
        [before, after]
    }
}

/// The node that is as far from the first as node i is from node j, on a grid of so many places along each axis that repeats
/// along all of them.
pub fn apart(counts: &[usize], mut i: usize, mut j: usize) -> usize {
    let (mut node, mut stride) = (0, 1);
    for &count in counts.iter().rev() {
        node += stride * ((i % count + count - j % count) % count);
        (i, j, stride) = (i / count, j / count, stride * count);
    }
    node
}

impl Axis {
    /// The places beside one that lies between them, and the share of the second; none beyond the ends.
    pub fn between(&self, at: f64) -> Option<[(usize, f64); 2]> {
        let first = *self.places.first()?;
        let at = self.period.map_or(at, |period| first + (at - first).rem_euclid(period));
        let right = self.places.partition_point(|place| *place <= at);
        let left = right.checked_sub(1)?;
        let (next, to) = match (self.places.get(right), self.period) {
            (Some(place), _) => (right, *place),
            (None, Some(period)) => (0, first + period),
            (None, None) if at == self.places[left] => return Some([(left, 1.0), (left, 0.0)]),
            (None, None) => return None,
        };
        let share = (at - self.places[left]) / (to - self.places[left]);
        Some([(left, 1.0 - share), (next, share)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum<const D: usize>(
        points: &[FacetPoint<D>],
        of: impl Fn(&FacetPoint<D>) -> SVector<f64, D>,
    ) -> SVector<f64, D> {
        points.iter().map(of).sum()
    }

    /// Both rules give an edge, a triangle and a parallelogram their areas and normals, and integrate linear functions.
    #[test]
    fn points_integrate_linear_functions() {
        let edge = Facet { nodes: vec![0, 1], corners: vec![SVector::from([0.0, 0.0]), SVector::from([0.3, -0.4])] };
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.5, 1.0, 0.0], [0.5, 1.0, 0.0]].map(SVector::from);
        let quadrilateral = Facet { nodes: vec![0, 1, 2, 3], corners: corners.to_vec() };
        let triangle = Facet { nodes: vec![0, 1, 2], corners: corners[..3].to_vec() };
        for points in [edge.at_nodes(), edge.at_gauss_points()] {
            assert!((sum(&points, |point| point.area) - SVector::from([0.4, 0.3])).norm() < 1e-15);
            assert!((sum(&points, |point| point.area * point.shape[1]) - SVector::from([0.2, 0.15])).norm() < 1e-15);
        }
        for (facet, area) in [(&quadrilateral, 2.0), (&triangle, 1.0)] {
            for points in [facet.at_nodes(), facet.at_gauss_points()] {
                let up = SVector::from([0.0, 0.0, area]);
                assert!((sum(&points, |point| point.area) - up).norm() < 1e-14);
                let shared = up / facet.nodes.len() as f64;
                assert!((sum(&points, |point| point.area * point.shape[1]) - shared).norm() < 1e-14);
            }
        }
    }

    /// Neighbours wrap along periodic axes and end along others; places between are shared linearly.
    #[test]
    fn grids_know_their_neighbours() {
        let axis = |count: usize, period| Axis { places: (0..count).map(|i| i as f64).collect(), period };
        let grid = Grid { axes: vec![axis(3, Some(3.0)), axis(2, None)] };
        assert_eq!((grid.beside(0, 0), grid.beside(5, 0)), ([Some(4), Some(2)], [Some(3), Some(1)]));
        assert_eq!((grid.beside(4, 1), grid.beside(5, 1)), ([None, Some(5)], [Some(4), None]));
        // Over the ends of both axes: (0, 0) from (2, 1) as (1, 1) from (0, 0).
        assert_eq!((apart(&grid.counts(), 0, 5), apart(&grid.counts(), 4, 2)), (3, 2));
        assert_eq!(grid.axes[0].between(-0.75), Some([(2, 0.75), (0, 0.25)]));
        assert_eq!((grid.axes[1].between(1.0), grid.axes[1].between(1.5)), (Some([(1, 1.0), (1, 0.0)]), None));
    }
}
