//! A cell of a mesh.

/// The corners of a cell, counter-clockwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cell {
    /// Three corners.
    Triangle([u32; 3]),
    /// Four corners.
    Quadrilateral([u32; 4]),
}

impl Cell {
    /// Three or four corners.
    pub fn corners(&self) -> &[u32] {
        match self {
            Self::Triangle(corners) => corners,
            Self::Quadrilateral(corners) => corners,
        }
    }

    /// The cell with each corner replaced.
    pub fn map(self, to: impl FnMut(u32) -> u32) -> Self {
        match self {
            Self::Triangle(corners) => Self::Triangle(corners.map(to)),
            Self::Quadrilateral(corners) => Self::Quadrilateral(corners.map(to)),
        }
    }

    /// The edges, each from one corner to the next.
    pub fn edges(&self) -> impl Iterator<Item = (u32, u32)> {
        let corners = self.corners();
        (0..corners.len()).map(move |i| (corners[i], corners[(i + 1) % corners.len()]))
    }

    /// Four corners; a triangle repeats its last one, as the result file has it.
    pub fn four(self) -> [u32; 4] {
        match self {
            Self::Triangle([a, b, c]) => [a, b, c, c],
            Self::Quadrilateral(corners) => corners,
        }
    }
}
