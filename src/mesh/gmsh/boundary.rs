//! The outline of a mesh: the sides of its cells, whether it is one piece, and what is held.

use std::collections::HashMap;

use nalgebra::SVector;

use super::{Contents, Element, Flaw, Outcome, Role};
use crate::mesh::Cell;

/// The most nodes of a side.
const MOST: usize = 4;

/// The sides of all cells, edges in the plane and facets in space: by their nodes in ascending order, the cells on either
/// side.
pub(super) struct Sides(HashMap<[u32; MOST], Beside>);

/// A cell, and which of its sides it is.
type Owner = (u32, u8);

/// The cell that runs round a side one way, and the cell that runs back.
#[derive(Clone, Copy, Default)]
struct Beside {
    forth: Option<Owner>,
    back: Option<Owner>,
}

impl Sides {
    /// Refuses two cells on the same side of an edge or facet; `tags` are the cells' numbers in the file.
    pub fn new<const D: usize>(cells: &[Cell<D>], tags: &[u64]) -> Outcome<Self> {
        let mut known: HashMap<[u32; MOST], Beside> = HashMap::new();
        for (i, cell) in cells.iter().enumerate() {
            for (which, side) in cell.sides().enumerate() {
                let beside = known.entry(key(&side)).or_default();
                let place = if runs_forth(&side) { &mut beside.forth } else { &mut beside.back };
                if let Some((other, _)) = place.replace((i as u32, which as u8)) {
                    let (one, other) = (tags[other as usize], tags[i]);
                    let side = if D == 2 { "an edge" } else { "a facet" };
                    let reason = format!("elements {one} and {other} overlap: they lie on the same side of {side}");
                    return Err(Flaw::File(reason));
                }
            }
        }
        Ok(Self(known))
    }

    /// Refuses a mesh of which a part shares no side with the rest.
    pub fn one_piece<const D: usize>(&self, cells: &[Cell<D>], nodes: &[SVector<f64, D>]) -> Outcome<()> {
        let mut reached = vec![false; cells.len()];
        let mut next = vec![0];
        reached[0] = true;
        while let Some(cell) = next.pop() {
            for side in cells[cell].sides() {
                let Beside { forth, back } = self.0.get(&key(&side)).copied().unwrap_or_default();
                for (other, _) in [forth, back].into_iter().flatten() {
                    if !std::mem::replace(&mut reached[other as usize], true) {
                        next.push(other as usize);
                    }
                }
            }
        }
        let Some(lost) = reached.iter().position(|reached| !reached) else { return Ok(()) };
        let [first, far] = [0, lost].map(|cell| written(&nodes[cells[cell].corners()[0] as usize]));
        let (parts, shared) = if D == 2 { ("surfaces", "curves") } else { ("volumes", "surfaces") };
        Err(Flaw::File(format!(
            "is in pieces: no cells lead from {first} to {far} m; let neighbouring {parts} share their {shared} \
             (Coherence or BooleanFragments in Gmsh)"
        )))
    }

    /// A side of the outline with these nodes, in the order in which its one cell has them: counter-clockwise as seen from
    /// outside, in the plane with the cell on the left. None inside or outside the mesh.
    fn outer<const D: usize>(&self, nodes: &[u32], cells: &[Cell<D>]) -> Option<Vec<u32>> {
        match self.0.get(&key(nodes))? {
            Beside { forth: Some((cell, side)), back: None } | Beside { forth: None, back: Some((cell, side)) } => {
                cells[*cell as usize].sides().nth(usize::from(*side))
            }
            _ => None,
        }
    }
}

/// The nodes of a side in ascending order.
fn key(side: &[u32]) -> [u32; MOST] {
    let mut key = [u32::MAX; MOST];
    key.iter_mut().zip(side).for_each(|(to, node)| *to = *node);
    key.sort_unstable();
    key
}

/// Of the two ways to run round a side, the one in which its lowest node comes before the lower one of its neighbours.
fn runs_forth(side: &[u32]) -> bool {
    let count = side.len();
    let lowest = (0..count).min_by_key(|&i| side[i]).unwrap_or(0);
    match count {
        2 => lowest == 0,
        _ => side[(lowest + 1) % count] < side[(lowest + count - 1) % count],
    }
}

/// A place, for a message.
pub(super) fn written<const D: usize>(place: &SVector<f64, D>) -> String {
    let coordinates: Vec<String> = place.iter().map(|coordinate| format!("{coordinate:.4e}")).collect();
    format!("({})", coordinates.join(", "))
}

/// The outline, with the names that the file has for its parts.
pub(super) struct Outline<'a, const D: usize> {
    pub contents: &'a Contents,
    pub nodes: &'a [SVector<f64, D>],
    pub index: &'a HashMap<u64, u32>,
    pub cells: &'a [Cell<D>],
    pub sides: &'a Sides,
}

impl<const D: usize> Outline<'_, D> {
    /// The held components of every node.
    pub fn held(&self, fixed: &[String], roller: &[String]) -> Outcome<Vec<[bool; D]>> {
        let mut held = vec![[false; D]; self.nodes.len()];
        for (i, name) in fixed.iter().enumerate() {
            for node in self.parts(name, Role::Fixed(i))?.into_iter().flatten() {
                held[node as usize] = [true; D];
            }
        }
        for (i, name) in roller.iter().enumerate() {
            let parts = self.parts(name, Role::Roller(i))?;
            let Some(component) = (0..D).find(|&component| parts.iter().all(|part| self.is_across(part, component)))
            else {
                let reason = match D {
                    2 => "must be straight, along x or along z, to be held across only",
                    _ => "must be plane, across x, y or z, to be held across only",
                };
                return Err(Flaw::Unfit(Role::Roller(i), reason.to_owned()));
            };
            for node in parts.into_iter().flatten() {
                held[node as usize][component] = true;
            }
        }
        Ok(held)
    }

    /// Whether a component is the same all over a part of the outline.
    fn is_across(&self, part: &[u32], component: usize) -> bool {
        let first = self.nodes[part[0] as usize];
        part.iter().all(|&node| {
            let way = self.nodes[node as usize] - first;
            way[component].abs() <= 1e-9 * way.norm()
        })
    }

    /// The lines of a physical curve, in space the facets of a physical surface, each of them once and a side of the outline, with
    /// its nodes as [`Sides::outer`] has them.
    pub fn parts(&self, name: &str, role: Role) -> Outcome<Vec<Vec<u32>>> {
        let tag = self.contents.group(D - 1, name, role)?;
        let named = |element: &&Element| {
            element.kind.dimension() + 1 == D && self.contents.groups[element.group].contains(&tag)
        };
        let (kind, side) = if D == 2 { ("line", "edge") } else { ("surface", "facet") };
        let mut parts: Vec<([u32; MOST], u64, Vec<u32>)> = Vec::new();
        for element in self.contents.elements.iter().filter(named) {
            let nodes: Option<Vec<u32>> =
                element.nodes[..element.kind.nodes()].iter().map(|node| self.index.get(node).copied()).collect();
            match nodes.and_then(|nodes| self.sides.outer(&nodes, self.cells)) {
                Some(nodes) => parts.push((key(&nodes), element.tag, nodes)),
                None => {
                    let reason = format!("its {kind} element {} is no {side} of the outline of the body", element.tag);
                    return Err(Flaw::Unfit(role, reason));
                }
            }
        }
        // One may have been written once for each group that it is in.
        parts.sort_by_key(|(key, tag, _)| (*key, *tag));
        parts.dedup_by_key(|(key, ..)| *key);
        match parts.is_empty() {
            false => Ok(parts.into_iter().map(|(.., nodes)| nodes).collect()),
            true => Err(Flaw::Unfit(role, format!("has no {kind} elements"))),
        }
    }
}
