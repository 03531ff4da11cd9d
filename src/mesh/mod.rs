//! Meshes: nodes, cells, what is held, and the contact face.
//!
//! Every rank holds the whole topology (a few tens of bytes per cell); matrices and vectors are distributed.

mod cell;
mod face;
pub mod gmsh;
mod layer;
mod partition;

pub use cell::Cell;
pub use face::{Axis, Face, Facet, FacetPoint, Grid, apart};
pub use layer::{Layer, Sides, Span, graded};
pub use partition::Numbering;

use nalgebra::SVector;

/// A mesh in the plane (x, z) or in space (x, y, z), and its contact face.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh<const D: usize> {
    /// Undeformed coordinates of the nodes, m; the contact face is at the top, z, the last, grows outward.
    pub nodes: Vec<SVector<f64, D>>,
    /// The cells.
    pub cells: Vec<Cell<D>>,
    /// Which material each cell is of, from 0.
    pub regions: Vec<u16>,
    /// The unknown that carries each node's displacement: its own, or that of the node it is a periodic image of.
    pub unknown: Vec<u32>,
    /// Which displacement components of each unknown are held at zero.
    pub held: Vec<[bool; D]>,
    /// The contact face.
    pub face: Face<D>,
}

/// What a mesh is had from; a layer's is made when it is asked for, since its face alone is often enough.
#[derive(Debug, Clone, PartialEq)]
pub enum Source<const D: usize> {
    /// It is there.
    Mesh(Mesh<D>),
    /// To be made.
    Layer(Layer),
}

impl<const D: usize> Source<D> {
    /// The mesh.
    pub fn mesh(&self) -> Mesh<D> {
        match self {
            Self::Mesh(mesh) => mesh.clone(),
            Self::Layer(layer) => layer.mesh(),
        }
    }

    /// Its contact face.
    pub fn face(&self) -> Face<D> {
        match self {
            Self::Mesh(mesh) => mesh.face.clone(),
            Self::Layer(layer) => layer.face(),
        }
    }

    /// From the lowest node to the highest of the contact face, m.
    pub fn height(&self) -> f64 {
        match self {
            Self::Mesh(mesh) => mesh.height(),
            Self::Layer(layer) => layer.depth,
        }
    }
}

impl<const D: usize> Mesh<D> {
    /// How many nodes carry unknowns; each has one for each direction.
    pub fn unknown_nodes(&self) -> usize {
        self.held.len()
    }

    /// The displacement components that nothing holds.
    pub fn free_components(&self) -> usize {
        self.held.iter().flatten().filter(|held| !**held).count()
    }

    /// The coordinates of a cell's corners, m.
    pub fn places(&self, cell: &Cell<D>) -> Vec<SVector<f64, D>> {
        cell.corners().iter().map(|&node| self.nodes[node as usize]).collect()
    }

    /// A cell whose corners are the unknowns of its own.
    pub fn cell_unknowns(&self, cell: usize) -> Cell<D> {
        self.cells[cell].map(|node| self.unknown[node as usize])
    }

    /// From the lowest node to the highest of the contact face, m.
    pub fn height(&self) -> f64 {
        let z = |node: &SVector<f64, D>| node[D - 1];
        let low = self.nodes.iter().map(z).fold(f64::INFINITY, f64::min);
        let face = self.face.unknown.iter().map(|&node| z(&self.nodes[node as usize]));
        face.fold(f64::NEG_INFINITY, f64::max) - low
    }
}
