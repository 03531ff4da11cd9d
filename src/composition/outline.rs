//! What a scene's body is, as far as it is known without a solver.

use std::path::Path;

use nalgebra::Vector2;

use super::body::{Meshed, bytes, file_mesh, mesh_penalty};
use crate::element::Kind;
use crate::error::Result;
use crate::mesh::{Mesh, Source};
use crate::profile::Surface;
use crate::scene::{self, Scene};

/// What a scene's body is. A layer's mesh is not made for it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outline {
    /// Its contact face, along x.
    pub face: Stretch,
    /// In space, along y.
    pub across: Option<Stretch>,
    /// How many nodes the face has.
    pub face_nodes: usize,
    /// How many facets: edges in the plane.
    pub facets: usize,
    /// The displacements to be solved for.
    pub unknowns: usize,
    /// Quadrilaterals (in space hexahedra) and triangles (in space tetrahedra).
    pub cells: [usize; 2],
    /// Of the contact, Pa/m, where the mesh decides it.
    pub penalty: Option<f64>,
    /// From the lowest point to the highest of the contact face, m.
    pub height: f64,
    /// Of the nodes of a plane mesh's face, x and the depth below the highest one, m; none for a layer, whose face is flat and
    /// evenly divided.
    pub nodes: Vec<[f64; 2]>,
    /// Of a mesh in space, the edges of the facets.
    pub relief: Vec<[Spot; 2]>,
    /// Of a mesh in space, the nodes of the face that are held along z.
    pub clamped: Vec<Spot>,
}

/// A place on the face of a mesh in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// x and y, m
    pub at: Vector2<f64>,
    /// How far below the highest node of the face it is, m.
    pub recess: f64,
}

/// The contact face in one direction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stretch {
    /// m
    pub from: f64,
    /// m
    pub to: f64,
    /// How many edges it has; of a mesh in space, about so many.
    pub edges: usize,
    /// Whether its ends are the same node.
    pub periodic: bool,
    /// How far each end is below the highest node, m, where it is clamped; none where it can move.
    pub clamped: [Option<f64>; 2],
}

/// What the body of the scene at `file` is; a .msh file is read by this process.
pub fn outline(scene: &Scene, file: &Path) -> Result<Outline> {
    match &scene.body {
        scene::Body::Layer(layer) => Ok(Outline::of_layer(layer)),
        scene::Body::Mesh(mesh) => Ok(Outline::of(scene, &file_mesh(&bytes(mesh)?, mesh, scene, file)?)),
    }
}

impl Outline {
    /// What the scene's body is, whose mesh is `mesh`.
    pub fn of(scene: &Scene, meshed: &Meshed) -> Self {
        match (scene.layer(), meshed) {
            (Some(layer), _) => Self::of_layer(layer),
            (None, Meshed::Plane(Source::Mesh(mesh))) => Self::of_plane(scene, mesh),
            (None, Meshed::Space(Source::Mesh(mesh))) => Self::of_solid(scene, mesh),
            // A layer is a scene's own.
            (None, _) => Self::default(),
        }
    }

    /// Whether it is in space.
    pub fn is_in_space(&self) -> bool {
        self.across.is_some()
    }

    fn of_layer(layer: &scene::Layer) -> Self {
        Self {
            face: Stretch::of_span(&layer.spans[0]),
            across: layer.spans.get(1).map(Stretch::of_span),
            face_nodes: layer.face_nodes(),
            facets: layer.spans.iter().map(|span| span.cells).product(),
            unknowns: layer.unknowns(),
            cells: [layer.cells(), 0],
            height: layer.depth,
            ..Self::default()
        }
    }

    /// What is the same in the plane and in space.
    fn of_mesh<const D: usize>(scene: &Scene, mesh: &Mesh<D>) -> Self {
        let simplices = mesh.cells.iter().filter(|cell| cell.kind == Kind::Simplex).count();
        Self {
            face_nodes: mesh.face.count(),
            facets: mesh.face.facets.len(),
            unknowns: mesh.free_components(),
            cells: [mesh.cells.len() - simplices, simplices],
            penalty: mesh_penalty(scene, mesh).filter(|_| scene.contact.stiffness().is_none()),
            height: mesh.height(),
            ..Self::default()
        }
    }

    fn of_plane(scene: &Scene, mesh: &Mesh<2>) -> Self {
        let nodes = mesh.face.places.iter().map(|place| [place.x, -place.y]).collect();
        Self { face: Stretch::of_mesh(mesh), nodes, ..Self::of_mesh(scene, mesh) }
    }

    fn of_solid(scene: &Scene, mesh: &Mesh<3>) -> Self {
        let face = &mesh.face;
        let spot = |node: usize| {
            let place = face.places[node];
            Spot { at: place.xy(), recess: -place.z }
        };
        let edges = face.pairs_along_edges().into_iter().map(|(a, b)| [spot(a), spot(b)]);
        let clamped = (0..face.count()).filter(|&node| mesh.held[face.unknown[node] as usize][2]).map(spot);
        let area: f64 = face.facets.iter().flat_map(|facet| facet.at_nodes()).map(|point| point.area.z).sum();
        // Two triangles count as a quadrilateral.
        let squares: f64 = face.facets.iter().map(|facet| if facet.nodes.len() == 3 { 0.5 } else { 1.0 }).sum();
        let size = (area / squares).sqrt();
        let along = |axis: usize| {
            let of = |place: &nalgebra::Vector3<f64>| place[axis];
            let from = face.places.iter().map(of).fold(f64::INFINITY, f64::min);
            let to = face.places.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
            let edges = ((to - from) / size).round().max(1.0) as usize;
            Stretch { from, to, edges, periodic: false, clamped: [None; 2] }
        };
        Self {
            face: along(0),
            across: Some(along(1)),
            relief: edges.collect(),
            clamped: clamped.collect(),
            ..Self::of_mesh(scene, mesh)
        }
    }

    /// Where the profile is nearest to the face of a mesh in space, at a node; none for any other body.
    ///
    /// # Errors
    /// Where the profile is not known.
    pub fn nearest(&self, surface: &dyn Surface) -> Result<Option<Vector2<f64>>> {
        let mut nearest: Option<(f64, Vector2<f64>)> = None;
        for Spot { at, recess } in self.relief.iter().flatten() {
            let gap = surface.at(*at)?.height + recess;
            if nearest.is_none_or(|(least, _)| gap < least) {
                nearest = Some((gap, *at));
            }
        }
        Ok(nearest.map(|(_, at)| at))
    }

    /// Of a face that is not flat and evenly divided, x and the depth below its highest node, m, in order of x: in space where the
    /// profile is nearest to it, along x.
    pub fn section(&self, surface: &dyn Surface) -> Vec<[f64; 2]> {
        let Some(across) = self.across.filter(|_| !self.relief.is_empty()) else { return self.nodes.clone() };
        let middle = 0.5 * (across.from + across.to);
        let near = 1e-9 * self.face.width();
        let along = |y: f64| {
            let crossing = |[a, b]: &[Spot; 2]| -> Vec<[f64; 2]> {
                let (from, to) = (a.at.y - y, b.at.y - y);
                match from * to {
                    product if product > 0.0 => Vec::new(),
                    _ if from == to => vec![[a.at.x, a.recess], [b.at.x, b.recess]],
                    _ => {
                        let share = from / (from - to);
                        vec![[a.at.x + share * (b.at.x - a.at.x), a.recess + share * (b.recess - a.recess)]]
                    }
                }
            };
            let mut points: Vec<[f64; 2]> = self.relief.iter().flat_map(crossing).collect();
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            points.dedup_by(|next, kept| next[0] - kept[0] <= near);
            points
        };
        // At a tip of the face there is but one point.
        let nearest = self.nearest(surface).ok().flatten().map_or(middle, |at| at.y);
        [nearest, middle].into_iter().map(along).find(|points| points.len() > 1).unwrap_or_default()
    }
}

impl Stretch {
    fn of_mesh(mesh: &Mesh<2>) -> Self {
        let face = &mesh.face;
        let (edges, periodic) = (face.facets.len(), false);
        match face.places.as_slice() {
            [from, .., to] => {
                let clamped = [0, face.count() - 1]
                    .map(|end| (mesh.held[face.unknown[end] as usize] == [true; 2]).then_some(-face.places[end].y));
                Self { from: from.x, to: to.x, edges, periodic, clamped }
            }
            // No mesh has a face without an edge.
            _ => Self { from: 0.0, to: 0.0, edges, periodic, clamped: [None; 2] },
        }
    }

    fn of_span(&scene::Span { width, cells, sides }: &scene::Span) -> Self {
        let clamped = [(sides == scene::Sides::Fixed).then_some(0.0); 2];
        Self { from: 0.0, to: width, edges: cells, periodic: sides == scene::Sides::Periodic, clamped }
    }

    /// m
    pub fn width(&self) -> f64 {
        self.to - self.from
    }

    /// Its nodes where its edges are of one length, both ends among them, m.
    pub fn nodes(self) -> impl Iterator<Item = f64> {
        (0..=self.edges).map(move |i| self.from + self.width() * (i as f64 / self.edges as f64))
    }

    /// The mean length of an edge along x, m.
    pub fn cell(&self) -> f64 {
        self.width() / self.edges as f64
    }
}
