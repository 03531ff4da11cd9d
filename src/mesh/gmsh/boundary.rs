//! The outline of a mesh: its edges, whether it is one piece, the contact face, and what is held.

use std::collections::HashMap;

use nalgebra::Vector2;

use super::{Contents, Element, Flaw, Kind, Outcome, Role};
use crate::mesh::{Axis, Cell, Face, Facet, Grid};

/// The edges of all cells: by their two nodes, the lower first, the cells on either side.
pub(super) struct Edges(HashMap<(u32, u32), Sides>);

/// The cell that runs along an edge from its lower node to its higher one, and the cell that runs back.
#[derive(Clone, Copy, Default)]
struct Sides {
    forth: Option<u32>,
    back: Option<u32>,
}

impl Edges {
    /// Refuses two cells on the same side of an edge; `tags` are the cells' numbers in the file.
    pub fn new(cells: &[Cell<2>], tags: &[u64]) -> Outcome<Self> {
        let mut known: HashMap<(u32, u32), Sides> = HashMap::new();
        for (i, cell) in cells.iter().enumerate() {
            for (a, b) in edges(cell) {
                let sides = known.entry((a.min(b), a.max(b))).or_default();
                let side = if a < b { &mut sides.forth } else { &mut sides.back };
                if let Some(other) = side.replace(i as u32) {
                    let (one, other) = (tags[other as usize], tags[i]);
                    let reason = format!("elements {one} and {other} overlap: they lie on the same side of an edge");
                    return Err(Flaw::File(reason));
                }
            }
        }
        Ok(Self(known))
    }

    /// Refuses a mesh of which a part shares no edge with the rest.
    pub fn one_piece(&self, cells: &[Cell<2>], nodes: &[Vector2<f64>]) -> Outcome<()> {
        let mut reached = vec![false; cells.len()];
        let mut next = vec![0];
        reached[0] = true;
        while let Some(cell) = next.pop() {
            for (a, b) in edges(&cells[cell]) {
                let sides = self.0.get(&(a.min(b), a.max(b))).copied().unwrap_or_default();
                for other in [sides.forth, sides.back].into_iter().flatten() {
                    if !std::mem::replace(&mut reached[other as usize], true) {
                        next.push(other as usize);
                    }
                }
            }
        }
        let Some(lost) = reached.iter().position(|reached| !reached) else { return Ok(()) };
        let [first, far] = [0, lost].map(|cell| {
            let corner = nodes[cells[cell].corners()[0] as usize];
            format!("({:.4e}, {:.4e})", corner.x, corner.y)
        });
        Err(Flaw::File(format!(
            "is in pieces: no cells lead from {first} to {far} m; let neighbouring surfaces share their curves \
             (Coherence or BooleanFragments in Gmsh)"
        )))
    }

    /// Whether an edge of the outline has its cell on the right, going from `a` to `b`; none inside or outside the mesh.
    fn cell_on_the_right(&self, a: u32, b: u32) -> Option<bool> {
        match self.0.get(&(a.min(b), a.max(b))) {
            // Cells run counter-clockwise: with the cell on the right, they run against the direction a to b.
            Some(Sides { forth: Some(_), back: None }) => Some(a > b),
            Some(Sides { forth: None, back: Some(_) }) => Some(a < b),
            _ => None,
        }
    }
}

/// The edges of a cell, each from one corner to the next.
fn edges(cell: &Cell<2>) -> impl Iterator<Item = (u32, u32)> {
    cell.sides().map(|side| (side[0], side[1]))
}

/// The outline, with the names that the file has for its parts.
pub(super) struct Outline<'a> {
    pub contents: &'a Contents,
    pub nodes: &'a [Vector2<f64>],
    pub index: &'a HashMap<u64, u32>,
    pub edges: &'a Edges,
}

/// A line element and its nodes.
struct Line {
    tag: u64,
    ends: [u32; 2],
}

impl Outline<'_> {
    /// The contact face: one line along which x grows, with the body below it.
    pub fn face(&self, name: &str) -> Outcome<Face<2>> {
        let unfit = |reason: String| Flaw::Unfit(Role::Contact, reason);
        let lines = self.lines(name, Role::Contact)?;
        let chain = chain(&lines).map_err(|node| {
            let place = self.nodes[node as usize];
            unfit(format!("is not one connected line: it breaks or branches at ({:.4e}, {:.4e}) m", place.x, place.y))
        })?;
        let mut chain = chain;
        if self.nodes[chain[0] as usize].x > self.nodes[chain[chain.len() - 1] as usize].x {
            chain.reverse();
        }
        let place = |i: usize| self.nodes[chain[i] as usize];
        for i in 0..chain.len() - 1 {
            let along = place(i + 1) - place(i);
            if along.x <= 1e-9 * along.norm() {
                let (x, z) = (place(i).x, place(i).y);
                return Err(unfit(format!(
                    "turns back or stands upright at ({x:.4e}, {z:.4e}) m; x must grow along it"
                )));
            }
            if self.edges.cell_on_the_right(chain[i], chain[i + 1]) != Some(true) {
                let (x, z) = (place(i).x, place(i).y);
                return Err(unfit(format!("has the body above it at ({x:.4e}, {z:.4e}) m; the body must lie below")));
            }
        }
        let top = (0..chain.len()).map(|i| place(i).y).fold(f64::NEG_INFINITY, f64::max);
        let places: Vec<Vector2<f64>> =
            (0..chain.len()).map(|i| Vector2::new(place(i).x, -(top - place(i).y))).collect();
        let edge = |(i, ends): (usize, &[Vector2<f64>])| Facet { nodes: vec![i, i + 1], corners: ends.to_vec() };
        let facets: Vec<_> = places.windows(2).enumerate().map(edge).collect();
        let grid = Grid { axes: vec![Axis { places: places.iter().map(|place| place.x).collect(), period: None }] };
        Ok(Face::new(chain, places, facets, Some(grid)))
    }

    /// The held components of every node.
    pub fn held(&self, fixed: &[String], roller: &[String]) -> Outcome<Vec<[bool; 2]>> {
        let mut held = vec![[false; 2]; self.nodes.len()];
        for (i, name) in fixed.iter().enumerate() {
            for node in self.lines(name, Role::Fixed(i))?.iter().flat_map(|line| line.ends) {
                held[node as usize] = [true; 2];
            }
        }
        for (i, name) in roller.iter().enumerate() {
            let lines = self.lines(name, Role::Roller(i))?;
            let across = |component: usize| {
                lines.iter().all(|line| {
                    let [a, b] = line.ends.map(|node| self.nodes[node as usize]);
                    (b - a)[component].abs() <= 1e-9 * (b - a).norm()
                })
            };
            let Some(component) = (0..2).find(|&component| across(component)) else {
                let reason = "must be straight, along x or along z, to be held across only";
                return Err(Flaw::Unfit(Role::Roller(i), reason.to_owned()));
            };
            for node in lines.iter().flat_map(|line| line.ends) {
                held[node as usize][component] = true;
            }
        }
        Ok(held)
    }

    /// The lines of a physical curve, each of them an edge of the outline.
    fn lines(&self, name: &str, role: Role) -> Outcome<Vec<Line>> {
        let tag = self.contents.group(1, name, role)?;
        let named =
            |element: &&Element| element.kind == Kind::Line && self.contents.groups[element.group].contains(&tag);
        let mut lines: Vec<Line> = Vec::new();
        for element in self.contents.elements.iter().filter(named) {
            let [a, b] = [0, 1].map(|i| self.index.get(&element.nodes[i]).copied());
            match (a, b) {
                (Some(a), Some(b)) if self.edges.cell_on_the_right(a, b).is_some() => {
                    lines.push(Line { tag: element.tag, ends: [a, b] });
                }
                _ => {
                    let reason = format!("its line element {} is no edge of the outline of the body", element.tag);
                    return Err(Flaw::Unfit(role, reason));
                }
            }
        }
        // A line may have been written once for each group that it is in.
        lines.sort_by_key(|line| (line.ends.iter().min().copied(), line.ends.iter().max().copied(), line.tag));
        lines.dedup_by_key(|line| (line.ends.iter().min().copied(), line.ends.iter().max().copied()));
        match lines.is_empty() {
            false => Ok(lines),
            true => Err(Flaw::Unfit(role, "has no line elements".to_owned())),
        }
    }
}

/// The nodes from one end of the lines to the other; the error is a node where they branch, break or close.
fn chain(lines: &[Line]) -> std::result::Result<Vec<u32>, u32> {
    let mut neighbours: HashMap<u32, Vec<u32>> = HashMap::new();
    for Line { ends: [a, b], .. } in lines {
        neighbours.entry(*a).or_default().push(*b);
        neighbours.entry(*b).or_default().push(*a);
    }
    let mut nodes: Vec<u32> = neighbours.keys().copied().collect();
    nodes.sort_unstable();
    if let Some(branch) = nodes.iter().find(|node| neighbours[node].len() > 2) {
        return Err(*branch);
    }
    let ends: Vec<u32> = nodes.iter().copied().filter(|node| neighbours[node].len() == 1).collect();
    let Some(&start) = ends.first() else { return Err(nodes[0]) };
    let mut chain = vec![start];
    let mut before = u32::MAX;
    while let Some(&next) = neighbours[&chain[chain.len() - 1]].iter().find(|&&next| next != before) {
        before = chain[chain.len() - 1];
        chain.push(next);
    }
    match chain.len() == lines.len() + 1 {
        true => Ok(chain),
        false => Err(ends.iter().copied().find(|end| !chain.contains(end)).unwrap_or(chain[chain.len() - 1])),
    }
}
