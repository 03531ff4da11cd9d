//! A cell of a mesh.

use crate::element::{Kind, MOST_CORNERS, Shape};

/// A kind of cell and its corners, in the order of its [`Shape`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cell<const D: usize> {
    /// What it is.
    pub kind: Kind,
    /// Of which as many count as it has corners.
    nodes: [u32; MOST_CORNERS],
}

impl<const D: usize> Cell<D> {
    /// Of its corners, as many as the kind has.
    pub fn new(kind: Kind, corners: &[u32]) -> Self {
        let mut nodes = [0; MOST_CORNERS];
        nodes.iter_mut().zip(corners).for_each(|(node, corner)| *node = *corner);
        Self { kind, nodes }
    }

    /// Its shape functions.
    pub fn shape(&self) -> &'static dyn Shape<D> {
        self.kind.shape()
    }

    /// Its corners.
    pub fn corners(&self) -> &[u32] {
        &self.nodes[..self.shape().corners()]
    }

    /// The cell with each corner replaced.
    pub fn map(mut self, mut to: impl FnMut(u32) -> u32) -> Self {
        let corners = self.shape().corners();
        self.nodes[..corners].iter_mut().for_each(|node| *node = to(*node));
        self
    }

    /// The corners of each side.
    pub fn sides(&self) -> impl Iterator<Item = Vec<u32>> {
        self.shape().sides().iter().map(|side| side.iter().map(|&corner| self.nodes[corner]).collect())
    }

    /// As many corners as a quadrilateral, or a hexahedron, has; simplices repeat theirs, as the result file has those that
    /// are not all tetrahedra.
    pub fn as_multilinear(&self) -> Vec<u32> {
        let n = &self.nodes;
        match (self.kind, D) {
            (Kind::Simplex, 2) => vec![n[0], n[1], n[2], n[2]],
            (Kind::Simplex, _) => vec![n[0], n[1], n[2], n[2], n[3], n[3], n[3], n[3]],
            (Kind::Multilinear, _) => self.corners().to_vec(),
        }
    }
}
