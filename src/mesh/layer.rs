//! The rectangular layer: 0 <= x <= width, -depth <= z <= 0, clamped below, contact face above.

use std::ops::Range;

use nalgebra::Vector2;

use super::{Cell, Edge, Face, Mesh};

/// A rectangular layer to be meshed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// m
    pub width: f64,
    /// m
    pub depth: f64,
    /// Cells along x and through the depth.
    pub cells: [usize; 2],
    /// Height of the lowest cell over that of the top one; heights grow geometrically.
    pub grading: f64,
    /// What holds the sides.
    pub sides: Sides,
}

/// What holds the sides of a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// Left and right are the same nodes.
    Periodic,
    /// No traction.
    Free,
    /// No displacement along x.
    Roller,
    /// No displacement.
    Fixed,
}

impl Layer {
    /// The mesh; nodes run column by column from left to right, downward in each.
    pub fn mesh(&self) -> Mesh {
        self.mesh_of_strata(&[])
    }

    /// The mesh of a layer of several materials: `thicknesses` of the strata, m, from the contact face down, without
    /// the last, which fills the rest. They are the regions 0, 1, ...; rows of nodes are moved onto their interfaces.
    pub fn mesh_of_strata(&self, thicknesses: &[f64]) -> Mesh {
        let [nx, nz] = self.cells;
        let rows = nz + 1;
        let (depths, interfaces) = self.depths(thicknesses);
        let region = |j: usize| interfaces.iter().filter(|&&row| row <= j).count() as u16;
        let x = |i: usize| self.width * i as f64 / nx as f64;
        let nodes = (0..=nx).flat_map(|i| depths.iter().map(move |&z| Vector2::new(x(i), -z))).collect();
        let at = |i: usize, j: usize| (i * rows + j) as u32;
        let cells = (0..nx)
            .flat_map(|i| (0..nz).map(move |j| [at(i, j + 1), at(i + 1, j + 1), at(i + 1, j), at(i, j)]))
            .map(Cell::Quadrilateral)
            .collect();

        let periodic = self.sides == Sides::Periodic;
        let columns = if periodic { nx } else { nx + 1 };
        let unknown = (0..=nx).flat_map(|i| (0..rows).map(move |j| at(i % columns, j))).collect();
        let held = (0..columns).flat_map(|i| (0..rows).map(move |j| self.held(i, j))).collect();

        let edge = |i: usize| Edge {
            ends: [i, (i + 1) % columns],
            start: x(i),
            length: x(i + 1) - x(i),
            tangent: Vector2::x(),
        };
        let face = Face {
            unknown: (0..columns).map(|i| at(i, 0)).collect(),
            x: (0..columns).map(x).collect(),
            recess: vec![0.0; columns],
            edges: (0..nx).map(edge).collect(),
        };
        Mesh { nodes, cells, regions: (0..nx * nz).map(|cell| region(cell % nz)).collect(), unknown, held, face }
    }

    /// Which components are held at column `i` and row `j` (from the top).
    fn held(&self, i: usize, j: usize) -> [bool; 2] {
        let side = i == 0 || i == self.cells[0];
        match self.sides {
            _ if j == self.cells[1] => [true, true],
            Sides::Roller if side => [true, false],
            Sides::Fixed if side => [true, true],
            _ => [false, false],
        }
    }

    /// Depth of each row of nodes below the contact face, from 0 to `depth`, m, and the rows at the interfaces.
    ///
    /// The row nearest to each interface, with a row of cells left for every stratum, is moved onto it, and the rows
    /// between are stretched.
    fn depths(&self, thicknesses: &[f64]) -> (Vec<f64>, Vec<usize>) {
        let graded = self.graded();
        let nz = self.cells[1];
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
        let nz = self.cells[1];
        let ratio = if nz > 1 { self.grading.powf(1.0 / (nz - 1) as f64) } else { 1.0 };
        let mut sums = vec![0.0];
        let mut height = 1.0;
        for _ in 0..nz {
            sums.push(sums[sums.len() - 1] + height);
            height *= ratio;
        }
        let total = sums[nz];
        sums.iter().map(|sum| self.depth * (sum / total)).collect()
    }
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

    fn layer(sides: Sides, grading: f64) -> Layer {
        Layer { width: 2.0, depth: 1.5, cells: [4, 3], grading, sides }
    }

    /// Cells are counter-clockwise and fill the rectangle; the ratio of lowest to top cell is the grading.
    #[test]
    fn cells_fill_the_rectangle() {
        let mesh = layer(Sides::Free, 8.0).mesh();
        let area = |cell: usize| {
            let c = mesh.points(mesh.cells[cell].four());
            (c[2] - c[0]).perp(&(c[3] - c[1])) / 2.0
        };
        assert!((0..12).all(|cell| area(cell) > 0.0));
        assert!(((0..12).map(area).sum::<f64>() - 3.0).abs() < 1e-14);
        assert!((area(2) / area(0) - 8.0).abs() < 1e-12);
    }

    /// Rows lie on the interfaces, each stratum has its cells, and an interface that is on a row already moves none.
    #[test]
    fn strata_have_whole_rows() {
        let layer = Layer { cells: [2, 6], ..layer(Sides::Free, 1.0) };
        let mesh = layer.mesh_of_strata(&[0.1, 0.9]);
        let depths: Vec<f64> = mesh.nodes[..7].iter().map(|node| -node.y).collect();
        assert!((depths[1] - 0.1).abs() < 1e-15 && (depths[4] - 1.0).abs() < 1e-15 && depths[6] == 1.5);
        assert!(depths.windows(2).all(|pair| pair[1] > pair[0]), "{depths:?}");
        assert_eq!(mesh.regions, [0, 1, 1, 1, 2, 2].repeat(2));
        assert_eq!(layer.mesh_of_strata(&[0.5]).nodes, layer.mesh().nodes);
        // Thin strata at the top and at the bottom still have a row each.
        for thicknesses in [[1e-3, 1e-3, 1e-3, 1e-3], [1.4, 0.01, 0.01, 0.01]] {
            let mesh = layer.mesh_of_strata(&thicknesses);
            assert!(mesh.nodes[..7].windows(2).all(|pair| pair[1].y < pair[0].y));
            assert_eq!((0..5).filter(|region| mesh.regions.contains(region)).count(), 5);
        }
    }

    /// A periodic face has one node per edge and wraps; a free one has one more and does not.
    #[test]
    fn sides_decide_the_unknowns() {
        let periodic = layer(Sides::Periodic, 1.0).mesh();
        assert_eq!((periodic.unknown_nodes(), periodic.face.unknown.len()), (16, 4));
        assert_eq!(periodic.face.edges[3].ends, [3, 0]);
        assert_eq!(periodic.unknown[16..20], periodic.unknown[0..4]);
        let roller = layer(Sides::Roller, 1.0).mesh();
        assert_eq!((roller.unknown_nodes(), roller.face.unknown.len()), (20, 5));
        assert_eq!(roller.held[0], [true, false]);
        assert_eq!(roller.held[3], [true, true]);
        assert_eq!(roller.held[4], [false, false]);
    }
}
