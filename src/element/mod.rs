//! Element kernels: numbers in, small matrices out; the same lines in the plane and in space.
//!
//! A kind of cell is a [`Shape`]: one file, and one line in [`Kind::shape`].

pub mod conduction;
pub mod mpjr;
mod multilinear;
mod simplex;
pub mod solid;

use nalgebra::SVector;

pub use multilinear::Multilinear;
pub use simplex::Simplex;

/// The most corners that a cell has.
pub const MOST_CORNERS: usize = 8;

/// Derivatives of the shape functions of a cell, of which as many count as it has corners.
pub type Gradients<const D: usize> = [SVector<f64, D>; MOST_CORNERS];

/// The shape functions of a cell, of which as many count as it has corners.
pub type Values = [f64; MOST_CORNERS];

/// A point of the reference cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<const D: usize> {
    /// Reference coordinates.
    pub at: SVector<f64, D>,
    /// What it weighs in an integral over the reference cell.
    pub weight: f64,
}

/// A cell in D dimensions, as its shape functions in a reference cell.
pub trait Shape<const D: usize>: Sync {
    /// How many corners it has.
    fn corners(&self) -> usize;
    /// The points at which it is integrated.
    fn samples(&self) -> Vec<Sample<D>>;
    /// N_a at a point of the reference cell.
    fn values(&self, at: &SVector<f64, D>) -> Values;
    /// dN_a/dxi at a point of the reference cell.
    fn slopes(&self, at: &SVector<f64, D>) -> Gradients<D>;
    /// What each of the points of [`Self::samples`] counts for at a corner, for a field that is known there.
    fn at_corner(&self, corner: usize) -> Vec<f64>;
    /// The corners of each side.
    fn sides(&self) -> &'static [&'static [usize]];
}

/// The kinds of cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A triangle or a tetrahedron.
    Simplex,
    /// A quadrilateral or a hexahedron.
    Multilinear,
}

impl Kind {
    /// What it is.
    pub fn shape<const D: usize>(self) -> &'static dyn Shape<D> {
        match self {
            Self::Simplex => &Simplex,
            Self::Multilinear => &Multilinear,
        }
    }
}
