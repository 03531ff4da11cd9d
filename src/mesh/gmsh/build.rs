//! From what a file holds to a mesh: the plane, the cells, their regions.

use std::collections::{BTreeMap, HashMap};

use nalgebra::Vector2;

use super::boundary::{Edges, Outline};
use super::{Contents, Element, Flaw, Kind, Outcome, Role, called};
use crate::element;
use crate::mesh::{Cell, Mesh};

/// What the physical groups of a file, by their names or numbers, are to the mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Roles {
    /// Physical curve: the contact face.
    pub contact: String,
    /// Physical curves without displacement.
    pub fixed: Vec<String>,
    /// Physical curves, straight along x or z, without displacement across them.
    pub roller: Vec<String>,
    /// Physical surfaces in the order of the materials that fill them; empty = one material for all cells.
    pub regions: Vec<String>,
}

/// The mesh of a file. The file's plane becomes (x, z): x and y of a file drawn at constant z, x and z of one drawn at
/// constant y. Cells that run clockwise are turned round, since Gmsh's surfaces may have either orientation.
///
/// # Errors
/// [`Flaw`] where a name is missing, a cell is degenerate or lies over its neighbour, the body is in pieces or the
/// contact face is not one line with the body below it.
pub fn build(contents: &Contents, roles: &Roles) -> Outcome<Mesh<2>> {
    if contents.elements.iter().all(|element| contents.groups[element.group].is_empty()) {
        return Err(Flaw::File(NO_GROUPS.to_owned()));
    }
    let (nodes, index, cells) = cells(contents)?;
    let mut list = Vec::with_capacity(cells.len());
    for (element, _) in &cells {
        list.push(oriented(element, &index, &nodes)?);
    }
    let tags: Vec<u64> = cells.iter().map(|(element, _)| element.tag).collect();
    let edges = Edges::new(&list, &tags)?;
    edges.one_piece(&list, &nodes)?;
    let regions = regions(contents, &cells, &roles.regions)?;
    let outline = Outline { contents, nodes: &nodes, index: &index, edges: &edges };
    let face = outline.face(&roles.contact)?;
    let held = outline.held(&roles.fixed, &roles.roller)?;
    if face.unknown.iter().all(|&node| held[node as usize] == [true; 2]) {
        let at_fault = roles.fixed.len() - 1;
        let reason = "holds every node of the contact face; leave some of it free to be pressed in";
        return Err(Flaw::Unfit(Role::Fixed(at_fault), reason.to_owned()));
    }
    let unknown = (0..nodes.len() as u32).collect();
    Ok(Mesh { nodes, cells: list, regions, unknown, held, face })
}

const NO_GROUPS: &str = "no element is in a physical group: give the geometry Physical Curves and mesh again; format 2.2 \
                         also loses all groups when everything is saved (-save_all, Mesh.SaveAll = 1): save without \
                         that, or as 4.1 (gmsh -format msh41)";

/// A cell and the groups it is in.
type Member<'a> = (&'a Element, Vec<i64>);
/// The nodes that cells use, their places in that list by their numbers in the file, and the cells.
type Parts<'a> = (Vec<Vector2<f64>>, HashMap<u64, u32>, Vec<Member<'a>>);

fn cells(contents: &Contents) -> Outcome<Parts<'_>> {
    let mut members: Vec<Member> = Vec::new();
    let mut known: HashMap<[u64; 4], usize> = HashMap::new();
    for element in contents.elements.iter().filter(|element| element.kind != Kind::Line) {
        let mut key = element.nodes;
        key.sort_unstable();
        let groups = &contents.groups[element.group];
        match known.get(&key) {
            // Version 2.2 writes an element once for each group it is in.
            Some(&first) => members[first].1.extend(groups),
            None => {
                known.insert(key, members.len());
                members.push((element, groups.clone()));
            }
        }
    }
    if members.is_empty() {
        let reason = "has no triangle or quadrilateral: Gmsh saves surfaces only as members of a physical surface";
        return Err(Flaw::File(reason.to_owned()));
    }
    let places: HashMap<u64, [f64; 3]> = contents.nodes.iter().map(|node| (node.tag, node.place)).collect();
    let used: std::collections::HashSet<u64> =
        members.iter().flat_map(|(element, _)| &element.nodes[..element.kind.nodes()]).copied().collect();
    for (element, _) in &members {
        if let Some(node) = element.nodes[..element.kind.nodes()].iter().find(|node| !places.contains_key(node)) {
            return Err(Flaw::File(format!("element {} has node {node}, which is not among the $Nodes", element.tag)));
        }
    }
    let mut index = HashMap::new();
    let mut list = Vec::with_capacity(used.len());
    for node in contents.nodes.iter().filter(|node| used.contains(&node.tag)) {
        if index.insert(node.tag, list.len() as u32).is_some() {
            return Err(Flaw::File(format!("node {} is there twice", node.tag)));
        }
        list.push(node.place);
    }
    Ok((plane(&list)?, index, members))
}

/// The coordinates in the plane that the nodes lie in.
fn plane(places: &[[f64; 3]]) -> Outcome<Vec<Vector2<f64>>> {
    let extent = |i: usize| {
        let of = |place: &[f64; 3]| place[i];
        let low = places.iter().map(of).fold(f64::INFINITY, f64::min);
        places.iter().map(of).fold(f64::NEG_INFINITY, f64::max) - low
    };
    let [x, y, z] = [0, 1, 2].map(extent);
    let flat = 1e-9 * x.max(y).max(z);
    let up = match (y <= flat, z <= flat) {
        (_, true) => 1,
        (true, false) => 2,
        _ => return Err(Flaw::File("is not plane: its nodes must share one z, or one y".to_owned())),
    };
    Ok(places.iter().map(|place| Vector2::new(place[0], place[up])).collect())
}

/// The cell counter-clockwise; each corner must turn the same way by more than round-off.
fn oriented(element: &Element, index: &HashMap<u64, u32>, nodes: &[Vector2<f64>]) -> Outcome<Cell<2>> {
    let list = element.nodes.map(|node| index.get(&node).copied().unwrap_or(u32::MAX));
    let kind = match element.kind {
        Kind::Quadrilateral => element::Kind::Multilinear,
        _ => element::Kind::Simplex,
    };
    let cell = Cell::new(kind, &list);
    let corners: Vec<Vector2<f64>> = cell.corners().iter().map(|&node| nodes[node as usize]).collect();
    let n = corners.len();
    let turn = |i: usize| {
        let (back, forth) = (corners[i] - corners[(i + n - 1) % n], corners[(i + 1) % n] - corners[i]);
        back.perp(&forth) / (back.norm() * forth.norm())
    };
    let turns: Vec<f64> = (0..n).map(turn).collect();
    match (turns.iter().all(|&turn| turn > 1e-8), turns.iter().all(|&turn| turn < -1e-8)) {
        (true, _) => Ok(cell),
        (_, true) => {
            let mut backward = cell.corners().to_vec();
            backward[1..].reverse();
            Ok(Cell::new(kind, &backward))
        }
        _ => {
            let centre = corners.iter().sum::<Vector2<f64>>() / n as f64;
            let reason = format!(
                "element {} at ({:.4e}, {:.4e}) m is degenerate or folded: its corners must turn one way",
                element.tag, centre.x, centre.y
            );
            Err(Flaw::File(reason))
        }
    }
}

/// The region of each cell.
fn regions(contents: &Contents, cells: &[Member], names: &[String]) -> Outcome<Vec<u16>> {
    if names.is_empty() {
        return Ok(vec![0; cells.len()]);
    }
    let role = |(i, name): (usize, &String)| contents.group(2, name, Role::Region(i));
    let tags: Vec<i64> = names.iter().enumerate().map(role).collect::<Outcome<_>>()?;
    let region = |(element, groups): &Member| {
        let mut found = (0..tags.len()).filter(|&region| groups.contains(&tags[region]));
        match (found.next(), found.next()) {
            (Some(region), None) => Ok(region as u16),
            (Some(one), Some(other)) => Err(Flaw::Unfit(
                Role::Region(other),
                format!("element {} is in {:?} and in {:?}; make them disjoint", element.tag, names[one], names[other]),
            )),
            (None, _) => {
                let group = contents.known(2).into_iter().find(|(tag, _)| groups.contains(tag));
                let whose = group.map_or("no physical surface".to_owned(), |(tag, name)| called(tag, name.as_deref()));
                let reason = format!("element {} is in {whose}, which no material fills", element.tag);
                Err(Flaw::Unfit(Role::Region(0), reason))
            }
        }
    };
    cells.iter().map(region).collect()
}

impl Contents {
    /// The number of the physical group of this name, or else of the one that the name is the number of.
    pub(super) fn group(&self, dimension: usize, name: &str, role: Role) -> Outcome<i64> {
        let named = self.names.iter().find(|(other, _, known)| *other == dimension && known == name);
        if let Some((_, tag, _)) = named {
            return Ok(*tag);
        }
        let known = self.known(dimension);
        match name.parse() {
            Ok(tag) if known.iter().any(|(other, _)| *other == tag) => Ok(tag),
            _ => Err(Flaw::Unknown(role, known)),
        }
    }

    /// The physical groups of a dimension, in order of their numbers, with their names where they have such.
    fn known(&self, dimension: usize) -> Vec<(i64, Option<String>)> {
        let mut known: BTreeMap<i64, Option<String>> = BTreeMap::new();
        for element in self.elements.iter().filter(|element| element.kind.dimension() == dimension) {
            known.extend(self.groups[element.group].iter().map(|&tag| (tag, None)));
        }
        let of_dimension = self.names.iter().filter(|(other, _, _)| *other == dimension);
        known.extend(of_dimension.map(|(_, tag, name)| (*tag, Some(name.clone()))));
        known.into_iter().collect()
    }
}
