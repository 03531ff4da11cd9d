//! From what a file holds to a mesh: the cells, their regions.

use std::collections::{BTreeMap, HashMap, HashSet};

use nalgebra::{SVector, Vector3};

use super::boundary::{Outline, Sides};
use super::{Contents, Element, Flaw, MOST_CORNERS, Outcome, Role, called, line, surface};
use crate::mesh::{Cell, Face, Mesh};

/// What the physical groups of a file, by their names or numbers, are to the mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Roles {
    /// Physical curve, in space surface: the contact face.
    pub contact: String,
    /// Physical curves, or surfaces, without displacement.
    pub fixed: Vec<String>,
    /// Physical curves, straight along x or z, or surfaces across x, y or z, without displacement across them.
    pub roller: Vec<String>,
    /// Physical surfaces, or volumes, in the order of the materials that fill them; empty = one material for all cells.
    pub regions: Vec<String>,
}

/// The mesh of a file.
#[derive(Debug, Clone, PartialEq)]
pub enum Built {
    /// Of triangles and quadrilaterals.
    Plane(Mesh<2>),
    /// Of tetrahedra and hexahedra.
    Space(Mesh<3>),
}

/// The mesh of a file, in space where it has volumes, z upward. Of a plane file, x and y of one drawn at constant z, x and z of one drawn
/// at constant y become (x, z). Cells that run the wrong way are turned round, since Gmsh's entities may have either orientation.
///
/// # Errors
/// [`Flaw`] where a name is missing, a cell is degenerate or lies over its neighbour, the body is in pieces or the
/// contact face is not one line, or surface, with the body below it.
pub fn build(contents: &Contents, roles: &Roles) -> Outcome<Built> {
    if contents.elements.iter().all(|element| contents.groups[element.group].is_empty()) {
        return Err(Flaw::File(NO_GROUPS.to_owned()));
    }
    let (places, index, members) = cells(contents)?;
    match contents.dimension() {
        2 => {
            let kind = Parts { nodes: line::plane(&places)?, oriented: line::oriented, face: line::face };
            kind.mesh((contents, roles), &index, &members).map(Built::Plane)
        }
        _ => {
            let nodes = places.into_iter().map(Vector3::from).collect();
            let kind = Parts { nodes, oriented: surface::oriented, face: surface::face };
            kind.mesh((contents, roles), &index, &members).map(Built::Space)
        }
    }
}

/// The cell of an element, its nodes and where they are.
type Oriented<const D: usize> = fn(&Element, &[u32], &[SVector<f64, D>]) -> Outcome<Cell<D>>;

/// The nodes, and what is of their dimension alone.
struct Parts<const D: usize> {
    nodes: Vec<SVector<f64, D>>,
    oriented: Oriented<D>,
    /// Of the name of the contact.
    face: fn(&Outline<'_, D>, &str) -> Outcome<Face<D>>,
}

impl<const D: usize> Parts<D> {
    fn mesh(
        self,
        (contents, roles): (&Contents, &Roles),
        index: &HashMap<u64, u32>,
        members: &[Member],
    ) -> Outcome<Mesh<D>> {
        let nodes = self.nodes;
        let mut list = Vec::with_capacity(members.len());
        for (element, _) in members {
            let corners = element.nodes.map(|node| index.get(&node).copied().unwrap_or(u32::MAX));
            list.push((self.oriented)(element, &corners, &nodes)?);
        }
        let tags: Vec<u64> = members.iter().map(|(element, _)| element.tag).collect();
        let sides = Sides::new(&list, &tags)?;
        sides.one_piece(&list, &nodes)?;
        let regions = regions(contents, D, members, &roles.regions)?;
        let outline = Outline { contents, nodes: &nodes, index, cells: &list, sides: &sides };
        let face = (self.face)(&outline, &roles.contact)?;
        let held = outline.held(&roles.fixed, &roles.roller)?;
        if face.unknown.iter().all(|&node| held[node as usize] == [true; D]) {
            let at_fault = roles.fixed.len() - 1;
            let reason = "holds every node of the contact face; leave some of it free to be pressed in";
            return Err(Flaw::Unfit(Role::Fixed(at_fault), reason.to_owned()));
        }
        let unknown = (0..nodes.len() as u32).collect();
        Ok(Mesh { nodes, cells: list, regions, unknown, held, face })
    }
}

const NO_GROUPS: &str = "no element is in a physical group: give the geometry Physical Curves (in space, Surfaces) and mesh again; format 2.2 \
                         also loses all groups when everything is saved (-save_all, Mesh.SaveAll = 1): save without \
                         that, or as 4.1 (gmsh -format msh41)";

/// A cell and the groups it is in.
type Member<'a> = (&'a Element, Vec<i64>);
/// The nodes that cells use, their places in that list by their numbers in the file, and the cells.
type Members<'a> = (Vec<[f64; 3]>, HashMap<u64, u32>, Vec<Member<'a>>);

fn cells(contents: &Contents) -> Outcome<Members<'_>> {
    let mut members: Vec<Member> = Vec::new();
    let mut known: HashMap<[u64; MOST_CORNERS], usize> = HashMap::new();
    let dimension = contents.dimension();
    for element in contents.elements.iter().filter(|element| element.kind.dimension() == dimension) {
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
        let reason = "has no triangle or quadrilateral, tetrahedron or hexahedron: Gmsh saves them only as members of a \
                      physical surface or volume";
        return Err(Flaw::File(reason.to_owned()));
    }
    let places: HashMap<u64, [f64; 3]> = contents.nodes.iter().map(|node| (node.tag, node.place)).collect();
    let used: HashSet<u64> =
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
    Ok((list, index, members))
}

/// The region of each cell.
fn regions(contents: &Contents, dimension: usize, cells: &[Member], names: &[String]) -> Outcome<Vec<u16>> {
    if names.is_empty() {
        return Ok(vec![0; cells.len()]);
    }
    let role = |(i, name): (usize, &String)| contents.group(dimension, name, Role::Region(i));
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
                let group = contents.known(dimension).into_iter().find(|(tag, _)| groups.contains(tag));
                let none = if dimension == 2 { "no physical surface" } else { "no physical volume" };
                let whose = group.map_or(none.to_owned(), |(tag, name)| called(tag, name.as_deref()));
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
            _ => Err(Flaw::Unknown(role, dimension, known)),
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
