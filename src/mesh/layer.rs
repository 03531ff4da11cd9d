//! The layer: a rectangle or a box, clamped below, contact face above.

use std::ops::Range;

use nalgebra::SVector;

use super::{Axis, Cell, Face, Facet, Grid, Mesh};
use crate::element::Kind;

/// A layer to be meshed: -depth <= z <= 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Along x, and in space along y.
    pub spans: Vec<Span>,
    /// m
    pub depth: f64,
    /// Cells through the depth.
    pub rows: usize,
    /// Height of the lowest cell over that of the top one; heights grow geometrically.
    pub grading: f64,
    /// Thicknesses of the strata of several materials, m, from the contact face down, without the last, which fills the rest. They
    /// are the regions 0, 1, ...; rows of nodes are moved onto their interfaces.
    pub strata: Vec<f64>,
}

/// A layer in one direction along its face: from 0 to `width`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// m
    pub width: f64,
    /// How many.
    pub cells: usize,
    /// What holds the two sides.
    pub sides: Sides,
}

/// What holds two sides of a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// They are the same nodes.
    Periodic,
    /// No traction.
    Free,
    /// No displacement across them.
    Roller,
    /// No displacement.
    Fixed,
}

impl Span {
    /// Different nodes.
    fn count(&self) -> usize {
        self.cells + usize::from(self.sides != Sides::Periodic)
    }

    /// Where node `i` is, m.
    fn place(&self, i: usize) -> f64 {
        self.width * i as f64 / self.cells as f64
    }

    fn axis(&self) -> Axis {
        let period = (self.sides == Sides::Periodic).then_some(self.width);
        Axis { places: (0..self.count()).map(|i| self.place(i)).collect(), period }
    }
}

/// All combinations of indices below the counts, the last running fastest.
fn combinations(counts: &[usize]) -> impl Iterator<Item = Vec<usize>> {
    (0..counts.iter().product()).map(move |mut i: usize| {
        let mut indices = vec![0; counts.len()];
        for (index, count) in indices.iter_mut().zip(counts).rev() {
            (*index, i) = (i % count, i / count);
        }
        indices
    })
}

/// The place of a combination among those below the counts.
fn place(indices: &[usize], counts: &[usize]) -> usize {
    indices.iter().zip(counts).fold(0, |place, (index, count)| place * count + index)
}

impl Layer {
    /// Of one material in the plane, with cells of one height.
    pub fn in_plane([width, depth]: [f64; 2], [cells, rows]: [usize; 2], sides: Sides) -> Self {
        Self { spans: vec![Span { width, cells, sides }], depth, rows, grading: 1.0, strata: Vec::new() }
    }

    /// The mesh; nodes run column by column, y before x, downward in each.
    pub fn mesh<const D: usize>(&self) -> Mesh<D> {
        let (depths, interfaces) = self.depths();
        let region = |row: usize| interfaces.iter().filter(|&&interface| interface <= row).count() as u16;
        let ends: Vec<usize> = self.spans.iter().map(|span| span.cells + 1).collect();
        let counts: Vec<usize> = self.spans.iter().map(Span::count).collect();
        let rows = self.rows + 1;
        let at = |column: &[usize], row: usize| (place(column, &ends) * rows + row) as u32;
        let along = |column: &[usize], i: usize| self.spans[i].place(column[i]);
        let over =
            |column: &[usize], z: f64| SVector::<f64, D>::from_fn(|i, _| if i + 1 < D { along(column, i) } else { z });
        let nodes =
            combinations(&ends).flat_map(|column| depths.iter().map(move |z| over(&column, -z)).collect::<Vec<_>>());
        let own = |column: &[usize]| -> Vec<usize> { column.iter().zip(&counts).map(|(i, count)| i % count).collect() };
        let unknowns = |column: &[usize]| place(&own(column), &counts) * rows;
        let unknown = combinations(&ends).flat_map(|column| {
            let first = unknowns(&column);
            (first..first + rows).map(|unknown| unknown as u32)
        });
        let held =
            combinations(&counts).flat_map(|column| (0..rows).map(|row| self.held(&column, row)).collect::<Vec<_>>());

        let cells_along: Vec<usize> = self.spans.iter().map(|span| span.cells).collect();
        let cell = |column: &[usize], row: usize| {
            let around = corners(column);
            let lower = around.iter().map(|corner| at(corner, row + 1));
            let upper = around.iter().map(|corner| at(corner, row));
            // Counter-clockwise: in the plane the upper side is run through backward.
            let all: Vec<u32> = if D == 2 { lower.chain(upper.rev()).collect() } else { lower.chain(upper).collect() };
            Cell::new(Kind::Multilinear, &all)
        };
        let cells = combinations(&cells_along)
            .flat_map(|column| (0..self.rows).map(|row| cell(&column, row)).collect::<Vec<_>>());
        let columns: usize = cells_along.iter().product();
        Mesh {
            nodes: nodes.collect(),
            cells: cells.collect(),
            regions: (0..columns).flat_map(|_| (0..self.rows).map(region)).collect(),
            unknown: unknown.collect(),
            held: held.collect(),
            face: self.face(),
        }
    }

    /// The contact face of the mesh.
    pub fn face<const D: usize>(&self) -> Face<D> {
        let counts: Vec<usize> = self.spans.iter().map(Span::count).collect();
        let cells: Vec<usize> = self.spans.iter().map(|span| span.cells).collect();
        let over = |column: &[usize]| {
            SVector::<f64, D>::from_fn(|i, _| if i + 1 < D { self.spans[i].place(column[i]) } else { 0.0 })
        };
        let node = |column: &Vec<usize>| {
            let own: Vec<usize> = column.iter().zip(&counts).map(|(i, count)| i % count).collect();
            place(&own, &counts)
        };
        let facet = |column: Vec<usize>| {
            let around = corners(&column);
            Facet {
                nodes: around.iter().map(node).collect(),
                corners: around.iter().map(|corner| over(corner)).collect(),
            }
        };
        let columns: usize = counts.iter().product();
        Face::new(
            (0..columns).map(|column| (column * (self.rows + 1)) as u32).collect(),
            combinations(&counts).map(|column| over(&column)).collect(),
            combinations(&cells).map(facet),
            Some(Grid { axes: self.spans.iter().map(Span::axis).collect() }),
        )
    }

    /// One column of its cells, as a layer of its own.
    pub fn column(&self) -> Self {
        let one = |span: &Span| Span { width: span.width / span.cells as f64, cells: 1, sides: Sides::Free };
        Self { spans: self.spans.iter().map(one).collect(), ..self.clone() }
    }

    /// How many columns there are along each direction of the face, where it repeats in all of them.
    pub fn periodic_counts(&self) -> Option<Vec<usize>> {
        let periodic = self.spans.iter().all(|span| span.sides == Sides::Periodic);
        periodic.then(|| self.spans.iter().map(|span| span.cells).collect())
    }

    /// Which components are held in a column, at `row` from the top.
    fn held<const D: usize>(&self, column: &[usize], row: usize) -> [bool; D] {
        let mut held = [row == self.rows; D];
        for (axis, (span, &i)) in self.spans.iter().zip(column).enumerate() {
            match span.sides {
                _ if i != 0 && i != span.cells => {}
                Sides::Periodic | Sides::Free => {}
                Sides::Roller => held[axis] = true,
                Sides::Fixed => held = [true; D],
            }
        }
        held
    }

    /// Depth of each row of nodes below the contact face, from 0 to `depth`, m, and the rows at the interfaces.
    ///
    /// The row nearest to each interface, with a row of cells left for every stratum, is moved onto it, and the rows
    /// between are stretched.
    fn depths(&self) -> (Vec<f64>, Vec<usize>) {
        let thicknesses = &self.strata;
        let graded = self.graded();
        let nz = self.rows;
        let mut depths = graded.clone();
        let mut rows: Vec<usize> = Vec::new();
        let mut interface = 0.0;
        // The last row that has its place, before and after.
        let (mut row, mut place) = (0, 0.0);
        for (i, thickness) in thicknesses.iter().enumerate() {
            interface += thickness;
            let last = nz.saturating_sub(thicknesses.len() - i).max(row + 1).min(nz);
            let nearest = graded.partition_point(|&depth| depth < interface);
            let below = nearest > 0 && interface - graded[nearest - 1] <= graded[nearest.min(nz)] - interface;
            let target = (nearest - usize::from(below)).clamp(row + 1, last);
            stretch(&mut depths, &graded, row..target, [place, interface]);
            (row, place) = (target, interface);
            rows.push(target);
        }
        if !thicknesses.is_empty() {
            stretch(&mut depths, &graded, row..nz, [place, self.depth]);
        }
        (depths, rows)
    }

    /// The depths without regard to strata, m.
    fn graded(&self) -> Vec<f64> {
        graded(self.depth, self.rows, self.grading)
    }
}

/// The depths, m, of so many rows of cells, the lowest of them `grading` times as high as the highest; from the face down.
pub fn graded(depth: f64, rows: usize, grading: f64) -> Vec<f64> {
    let ratio = if rows > 1 { grading.powf(1.0 / (rows - 1) as f64) } else { 1.0 };
    let mut sums = vec![0.0];
    let mut height = 1.0;
    for _ in 0..rows {
        sums.push(sums[sums.len() - 1] + height);
        height *= ratio;
    }
    let total = sums[rows];
    sums.iter().map(|sum| depth * (sum / total)).collect()
}

/// The columns around a cell: from left to right, or counter-clockwise.
fn corners(column: &[usize]) -> Vec<Vec<usize>> {
    let around: &[[usize; 2]] = if column.len() == 1 { &[[0, 0], [1, 0]] } else { &[[0, 0], [1, 0], [1, 1], [0, 1]] };
    around.iter().map(|more| column.iter().zip(more).map(|(i, more)| i + more).collect()).collect()
}

/// Places the rows of the range, its end included, between the two depths of `to` as they stand in `graded`.
fn stretch(depths: &mut [f64], graded: &[f64], range: Range<usize>, to: [f64; 2]) {
    let (from, till) = (graded[range.start], graded[range.end]);
    for row in range.start..=range.end {
        depths[row] = to[0] + (to[1] - to[0]) * ((graded[row] - from) / (till - from));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::solid::{Dilatation, Placed};

    fn layer(sides: Sides, grading: f64) -> Layer {
        Layer { spans: vec![Span { width: 2.0, cells: 4, sides }], depth: 1.5, rows: 3, grading, strata: vec![] }
    }

    /// Cells are counter-clockwise and fill the rectangle; the ratio of lowest to top cell is the grading.
    #[test]
    fn cells_fill_the_rectangle() {
        let mesh = layer(Sides::Free, 8.0).mesh::<2>();
        let area = |cell: usize| volume(&mesh, cell);
        assert!((0..12).all(|cell| area(cell) > 0.0));
        assert!(((0..12).map(area).sum::<f64>() - 3.0).abs() < 1e-14);
        assert!((area(2) / area(0) - 8.0).abs() < 1e-12);
    }

    /// Rows lie on the interfaces, each stratum has its cells, and an interface that is on a row already moves none.
    #[test]
    fn strata_have_whole_rows() {
        let free = layer(Sides::Free, 1.0);
        let layer = |strata: &[f64]| Layer {
            spans: vec![Span { cells: 2, ..free.spans[0] }],
            rows: 6,
            strata: strata.to_vec(),
            ..free.clone()
        };
        let mesh = layer(&[0.1, 0.9]).mesh::<2>();
        let depths: Vec<f64> = mesh.nodes[..7].iter().map(|node| -node.y).collect();
        assert!((depths[1] - 0.1).abs() < 1e-15 && (depths[4] - 1.0).abs() < 1e-15 && depths[6] == 1.5);
        assert!(depths.windows(2).all(|pair| pair[1] > pair[0]), "{depths:?}");
        assert_eq!(mesh.regions, [0, 1, 1, 1, 2, 2].repeat(2));
        assert_eq!(layer(&[0.5]).mesh::<2>().nodes, layer(&[]).mesh::<2>().nodes);
        // Thin strata at the top and at the bottom still have a row each.
        for thicknesses in [[1e-3, 1e-3, 1e-3, 1e-3], [1.4, 0.01, 0.01, 0.01]] {
            let mesh = layer(&thicknesses).mesh::<2>();
            assert!(mesh.nodes[..7].windows(2).all(|pair| pair[1].y < pair[0].y));
            assert_eq!((0..5).filter(|region| mesh.regions.contains(region)).count(), 5);
        }
    }

    /// A periodic face has one node per edge and wraps; a free one has one more and does not.
    #[test]
    fn sides_decide_the_unknowns() {
        let periodic = layer(Sides::Periodic, 1.0).mesh::<2>();
        assert_eq!((periodic.unknown_nodes(), periodic.face.count()), (16, 4));
        assert_eq!(periodic.face.facets[3].nodes, [3, 0]);
        assert_eq!(periodic.unknown[16..20], periodic.unknown[0..4]);
        let roller = layer(Sides::Roller, 1.0).mesh::<2>();
        assert_eq!((roller.unknown_nodes(), roller.face.unknown.len()), (20, 5));
        assert_eq!(roller.held[0], [true, false]);
        assert_eq!(roller.held[3], [true, true]);
        assert_eq!(roller.held[4], [false, false]);
    }

    fn volume<const D: usize>(mesh: &Mesh<D>, cell: usize) -> f64 {
        let (cell, dilatation) = (&mesh.cells[cell], Dilatation::Pointwise);
        Placed { shape: cell.shape(), corners: &mesh.places(cell), dilatation }.volume()
    }

    /// In space: hexahedra that fill the box, a face whose last axis runs fastest and wraps, facets that look up, sides that hold
    /// what they are to hold.
    #[test]
    fn a_box_is_filled() {
        let x = Span { width: 2.0, cells: 3, sides: Sides::Periodic };
        let y = Span { width: 1.0, cells: 2, sides: Sides::Roller };
        let mesh = Layer { spans: vec![x, y], depth: 0.5, rows: 2, grading: 2.0, strata: vec![] }.mesh::<3>();
        let volumes: Vec<f64> = (0..12).map(|cell| volume(&mesh, cell)).collect();
        assert!(volumes.iter().all(|volume| *volume > 0.0) && (volumes.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        assert_eq!((mesh.unknown_nodes(), mesh.face.count(), mesh.face.facets.len()), (27, 9, 6));
        assert_eq!(mesh.face.places[1], SVector::from([0.0, 0.5, 0.0]));
        assert_eq!(mesh.face.facets[5].nodes, [7, 1, 2, 8]);
        let up: SVector<f64, 3> =
            mesh.face.facets.iter().flat_map(|facet| facet.at_nodes()).map(|point| point.area).sum();
        assert!((up - SVector::from([0.0, 0.0, 2.0])).norm() < 1e-15);
        assert_eq!((mesh.held[0], mesh.held[3]), ([false, true, false], [false; 3]));
        assert_eq!(mesh.held[2], [true; 3]);
    }
}
