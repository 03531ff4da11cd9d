//! Meshes in space: cells with a volume above zero, and a contact face that is one surface.

use std::collections::{HashMap, HashSet};

use nalgebra::{SVector, Vector3};

use super::boundary::{Outline, written};
use super::{Element, Flaw, Outcome, Role};
use crate::element;
use crate::mesh::{Axis, Cell, Face, Facet, Grid};

/// How far beside a line of a grid nodes may lie, and what of a normal must point upward, over the extent and the length.
const TINY: f64 = 1e-9;

/// The cell with its corners so that its volume is above zero; its Jacobian must have one sign at all corners, by more than round-off.
pub(super) fn oriented(element: &Element, list: &[u32], nodes: &[Vector3<f64>]) -> Outcome<Cell<3>> {
    let kind = element.kind.cell();
    let cell = Cell::new(kind, list);
    let at = |corner: usize| nodes[cell.corners()[corner] as usize];
    // Of the edges from a corner, right-handed in the reference cell; over their lengths.
    let volume = |[corner, a, b, c]: [usize; 4]| {
        let [a, b, c] = [a, b, c].map(|to| at(to) - at(corner));
        a.cross(&b).dot(&c) / (a.norm() * b.norm() * c.norm())
    };
    let (volumes, mirrored): (Vec<f64>, &[usize]) = match kind {
        element::Kind::Simplex => (vec![volume([0, 1, 2, 3])], &[1, 0, 2, 3]),
        element::Kind::Multilinear => {
            let lower = (0..4).map(|i| volume([i, (i + 1) % 4, (i + 3) % 4, i + 4]));
            let upper = (0..4).map(|i| volume([i + 4, (i + 3) % 4 + 4, (i + 1) % 4 + 4, i]));
            (lower.chain(upper).collect(), &[4, 5, 6, 7, 0, 1, 2, 3])
        }
    };
    match (volumes.iter().all(|&volume| volume > 1e-8), volumes.iter().all(|&volume| volume < -1e-8)) {
        (true, _) => Ok(cell),
        (_, true) => Ok(Cell::new(kind, &mirrored.iter().map(|&corner| cell.corners()[corner]).collect::<Vec<_>>())),
        _ => {
            let corners = cell.corners().len();
            let centre = (0..corners).map(at).sum::<Vector3<f64>>() / corners as f64;
            let reason = format!(
                "element {} at {} m is degenerate or folded: its volume must have one sign at all corners",
                element.tag,
                written(&centre)
            );
            Err(Flaw::File(reason))
        }
    }
}

/// The contact face: one surface that looks upward everywhere, with the body below it.
pub(super) fn face(outline: &Outline<'_, 3>, name: &str) -> Outcome<Face<3>> {
    let unfit = |reason: String| Flaw::Unfit(Role::Contact, reason);
    let at = |node: u32| outline.nodes[node as usize];
    let parts = outline.parts(name, Role::Contact)?;
    if let Some(node) = torn(&parts) {
        let place = written(&at(node));
        return Err(unfit(format!("is not one connected surface: it breaks or branches at {place} m")));
    }
    let mut unknown: Vec<u32> = parts.iter().flatten().copied().collect();
    unknown.sort_unstable();
    unknown.dedup();
    let grid = grid(&unknown, outline.nodes, &parts).map(|(ordered, grid)| {
        unknown = ordered;
        grid
    });
    let places: HashMap<u32, usize> = unknown.iter().enumerate().map(|(place, node)| (*node, place)).collect();
    let top = unknown.iter().map(|&node| at(node).z).fold(f64::NEG_INFINITY, f64::max);
    let place = |node: u32| Vector3::new(at(node).x, at(node).y, -(top - at(node).z));
    let mut facets = Vec::with_capacity(parts.len());
    for part in &parts {
        let facet = Facet::<3> {
            nodes: part.iter().map(|node| places[node]).collect(),
            corners: part.iter().map(|&node| place(node)).collect(),
        };
        let upright = |area: &SVector<f64, 3>| area.z <= TINY * area.norm();
        if let Some(corner) = facet.at_nodes().iter().position(|point| upright(&point.area)) {
            let reason = format!(
                "stands upright or has the body above it at {} m; the body must lie below",
                written(&at(part[corner]))
            );
            return Err(unfit(reason));
        }
        facets.push(facet);
    }
    let points = unknown.iter().map(|&node| place(node)).collect();
    Ok(Face::new(unknown, points, facets, grid))
}

/// A node where facets are more than two to an edge, or lead to no others; none where they are one surface.
fn torn(parts: &[Vec<u32>]) -> Option<u32> {
    let edges = |part: usize| {
        let nodes = &parts[part];
        (0..nodes.len()).map(move |i| (nodes[i], nodes[(i + 1) % nodes.len()]))
    };
    // All run counter-clockwise, so that neighbours run along their edge in opposite senses.
    let mut owners: HashMap<(u32, u32), usize> = HashMap::new();
    for part in 0..parts.len() {
        for edge in edges(part) {
            if owners.insert(edge, part).is_some() {
                return Some(edge.0);
            }
        }
    }
    let mut reached = vec![false; parts.len()];
    reached[0] = true;
    let mut next = vec![0];
    while let Some(part) = next.pop() {
        for (a, b) in edges(part) {
            if let Some(&other) = owners.get(&(b, a))
                && !std::mem::replace(&mut reached[other], true)
            {
                next.push(other);
            }
        }
    }
    reached.iter().position(|reached| !reached).map(|lost| parts[lost][0])
}

/// The nodes in the order of the grid that they make, and that grid; none where they do not stand at all combinations of places
/// along x and y, with a quadrilateral between each four.
fn grid(face: &[u32], nodes: &[Vector3<f64>], parts: &[Vec<u32>]) -> Option<(Vec<u32>, Grid)> {
    let extent = |axis: usize| {
        let of = |node: &u32| nodes[*node as usize][axis];
        face.iter().map(of).fold(f64::NEG_INFINITY, f64::max) - face.iter().map(of).fold(f64::INFINITY, f64::min)
    };
    let near = TINY * extent(0).max(extent(1));
    let places = |axis: usize| {
        let mut all: Vec<f64> = face.iter().map(|&node| nodes[node as usize][axis]).collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|next, kept| *next - *kept <= near);
        all
    };
    let (x, y) = (places(0), places(1));
    let quadrilaterals = parts.iter().filter(|part| part.len() == 4).count();
    if face.len() != x.len() * y.len() || quadrilaterals != parts.len() || parts.len() != (x.len() - 1) * (y.len() - 1)
    {
        return None;
    }
    let index = |places: &[f64], at: f64| places.partition_point(|place| *place < at - near);
    let mut ordered: Vec<(usize, u32)> = (face.iter())
        .map(|&node| (index(&x, nodes[node as usize].x) * y.len() + index(&y, nodes[node as usize].y), node))
        .collect();
    ordered.sort_unstable();
    let distinct: HashSet<usize> = ordered.iter().map(|(place, _)| *place).collect();
    let axes = [x, y].map(|places| Axis { places, period: None }).to_vec();
    (distinct.len() == face.len()).then(|| (ordered.into_iter().map(|(_, node)| node).collect(), Grid { axes }))
}
