//! Meshes: nodes, cells, what is held, and the contact face.
//!
//! Every rank holds the whole topology (a few tens of bytes per cell); matrices and vectors are distributed.

mod cell;
pub mod gmsh;
mod layer;
mod partition;

pub use cell::Cell;
pub use layer::{Layer, Sides};
pub use partition::Numbering;

use nalgebra::Vector2;

/// A mesh of quadrilaterals and triangles, and its contact face.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Undeformed coordinates x, z of the nodes, m; the contact face is at the top, z grows outward.
    pub nodes: Vec<Vector2<f64>>,
    /// The cells.
    pub cells: Vec<Cell>,
    /// Which material each cell is of, from 0.
    pub regions: Vec<u16>,
    /// The unknown that carries each node's displacement: its own, or that of the node it is a periodic image of.
    pub unknown: Vec<u32>,
    /// Which displacement components of each unknown are held at zero.
    pub held: Vec<[bool; 2]>,
    /// The contact face.
    pub face: Face,
}

/// The contact face: its nodes in order of x, and the edges between them. The body is below it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Face {
    /// The unknown of each face node.
    pub unknown: Vec<u32>,
    /// Undeformed x of each face node, m.
    pub x: Vec<f64>,
    /// How far each face node lies below the highest one, m; zero on a flat face.
    pub recess: Vec<f64>,
    /// The edges; on a periodic face the last one ends at the first node.
    pub edges: Vec<Edge>,
}

/// An edge of the contact face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// Indices into the face's nodes.
    pub ends: [usize; 2],
    /// x of the first end, m.
    pub start: f64,
    /// m
    pub length: f64,
    /// Unit vector from the first end to the second, in the sense of +x.
    pub tangent: Vector2<f64>,
}

impl Edge {
    /// Its two directions, as (row, column) of face nodes.
    pub fn directions(&self) -> [(usize, usize); 2] {
        let [a, b] = self.ends;
        [(a, b), (b, a)]
    }
}

impl Mesh {
    /// How many nodes carry unknowns; each has two.
    pub fn unknown_nodes(&self) -> usize {
        self.held.len()
    }

    /// The displacement components that nothing holds.
    pub fn free_components(&self) -> usize {
        self.held.iter().flatten().filter(|held| !**held).count()
    }

    /// The coordinates of a cell's corners, m.
    pub fn points<const N: usize>(&self, corners: [u32; N]) -> [Vector2<f64>; N] {
        corners.map(|node| self.nodes[node as usize])
    }

    /// A cell whose corners are the unknowns of its own.
    pub fn cell_unknowns(&self, cell: usize) -> Cell {
        self.cells[cell].map(|node| self.unknown[node as usize])
    }
}
