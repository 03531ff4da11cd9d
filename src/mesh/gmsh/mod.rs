//! Gmsh .msh files, versions 2.0 to 2.2 and 4.1, text or binary, as meshes.
//!
//! Gmsh reference manual, "MSH file format" (4.1) and "MSH file format version 2 (Legacy)" (2.2). What the file must
//! hold: first-order triangles and quadrilaterals in a plane, and physical curves of which one is the contact face; or, in space,
//! first-order tetrahedra and hexahedra, and physical surfaces. Files are read on one rank and parsed on all.

mod boundary;
mod build;
mod input;
mod line;
mod read;
mod surface;
mod v2;
mod v4;

#[cfg(test)]
mod tests;

use crate::element::{self, MOST_CORNERS};

pub use build::{Built, Roles, build};
pub use read::read;

/// What a file holds, as it stands there.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Contents {
    /// The nodes.
    nodes: Vec<Node>,
    /// Lines, triangles, quadrilaterals, tetrahedra and hexahedra.
    elements: Vec<Element>,
    /// The physical groups: dimension, number, name.
    names: Vec<(usize, i64, String)>,
    /// Lists of numbers of physical groups that elements refer to.
    groups: Vec<Vec<i64>>,
}

/// A node.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    /// Its number in the file.
    tag: u64,
    /// m
    place: [f64; 3],
}

/// An element.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Element {
    /// Its number in the file.
    tag: u64,
    kind: Kind,
    /// Numbers of its nodes; the first `kind.nodes()` count.
    nodes: [u64; MOST_CORNERS],
    /// Index into [`Contents::groups`].
    group: usize,
}

/// The elements that are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Line,
    Triangle,
    Quadrilateral,
    Tetrahedron,
    Hexahedron,
}

impl Kind {
    fn nodes(self) -> usize {
        match self {
            Self::Line => 2,
            Self::Triangle => 3,
            Self::Quadrilateral | Self::Tetrahedron => 4,
            Self::Hexahedron => 8,
        }
    }

    fn dimension(self) -> usize {
        match self {
            Self::Line => 1,
            Self::Triangle | Self::Quadrilateral => 2,
            Self::Tetrahedron | Self::Hexahedron => 3,
        }
    }

    /// What it is as a cell of its own dimension.
    fn cell(self) -> element::Kind {
        match self {
            Self::Line | Self::Quadrilateral | Self::Hexahedron => element::Kind::Multilinear,
            Self::Triangle | Self::Tetrahedron => element::Kind::Simplex,
        }
    }
}

impl Contents {
    /// 3 where there are volumes, else 2.
    fn dimension(&self) -> usize {
        self.elements.iter().map(|element| element.kind.dimension()).fold(2, usize::max)
    }
}

/// What is wrong with a file, or with what it is asked for.
#[derive(Debug, Clone, PartialEq)]
pub enum Flaw {
    /// In the file; the text says the line or the element.
    File(String),
    /// No physical group of this name and of this dimension; the numbers and names of those that the file has.
    Unknown(Role, usize, Vec<(i64, Option<String>)>),
    /// A physical group that cannot be what it is asked to be.
    Unfit(Role, String),
}

/// What a name was given for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The contact face.
    Contact,
    /// The i-th of the fixed curves or surfaces.
    Fixed(usize),
    /// The i-th of the rollers.
    Roller(usize),
    /// The i-th region.
    Region(usize),
}

/// A physical group for a message: `"contact" (3)`, or its number alone.
pub fn called(tag: i64, name: Option<&str>) -> String {
    name.map_or(tag.to_string(), |name| format!("{name:?} ({tag})"))
}

type Outcome<T> = std::result::Result<T, Flaw>;
