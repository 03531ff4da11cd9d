//! The rectangular layer: 0 <= x <= width, -depth <= z <= 0, clamped below, contact face above.

use nalgebra::Vector2;

use super::{Edge, Face, Mesh};

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
        let [nx, nz] = self.cells;
        let rows = nz + 1;
        let depths = self.depths();
        let x = |i: usize| self.width * i as f64 / nx as f64;
        let nodes = (0..=nx).flat_map(|i| depths.iter().map(move |&z| Vector2::new(x(i), -z))).collect();
        let at = |i: usize, j: usize| (i * rows + j) as u32;
        let cells = (0..nx)
            .flat_map(|i| (0..nz).map(move |j| [at(i, j + 1), at(i + 1, j + 1), at(i + 1, j), at(i, j)]))
            .collect();

        let periodic = self.sides == Sides::Periodic;
        let columns = if periodic { nx } else { nx + 1 };
        let unknown = (0..=nx).flat_map(|i| (0..rows).map(move |j| at(i % columns, j))).collect();
        let held = (0..columns).flat_map(|i| (0..rows).map(move |j| self.held(i, j))).collect();

        let edge = |i: usize| Edge { ends: [i, (i + 1) % columns], start: x(i), length: x(i + 1) - x(i) };
        let face = Face {
            unknown: (0..columns).map(|i| at(i, 0)).collect(),
            x: (0..columns).map(x).collect(),
            edges: (0..nx).map(edge).collect(),
        };
        Mesh { nodes, cells, unknown, held, face }
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

    /// Depth of each row of nodes below the contact face, from 0 to `depth`, m.
    fn depths(&self) -> Vec<f64> {
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
            let c = mesh.corners(cell);
            (c[2] - c[0]).perp(&(c[3] - c[1])) / 2.0
        };
        assert!((0..12).all(|cell| area(cell) > 0.0));
        assert!(((0..12).map(area).sum::<f64>() - 3.0).abs() < 1e-14);
        assert!((area(2) / area(0) - 8.0).abs() < 1e-12);
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
