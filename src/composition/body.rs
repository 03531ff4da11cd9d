//! From the scene's body and materials to a mesh, its regions and the parts of the bulk.

use std::collections::BTreeSet;
use std::path::Path;

use mpi::topology::SimpleCommunicator;

use crate::bulk::{Bulk, Part, Series};
use crate::element::Kind;
use crate::element::solid::Dilatation;
use crate::error::{Error, Result};
use crate::input;
use crate::mesh::gmsh::{self, Flaw, Role, Roles, called};
use crate::mesh::{Face, Grid, Layer, Mesh, Sides, Source, Span};
use crate::output::{BulkPlan, FacePlan};
use crate::parallel::agree;
use crate::petsc::Vector;
use crate::rheology::Memory;
use crate::rheology::prony::{Prony, common_times};
use crate::scene::{self, MeshFile, Phase, Scene};
use crate::solve::{Body, Moduli, Region};

/// The mesh of the scene at `file`, on every rank. A .msh file is read by rank 0 only. Collective.
pub fn mesh(comm: &SimpleCommunicator, scene: &Scene, file: &Path) -> Result<Meshed> {
    match &scene.body {
        scene::Body::Layer(layer) => Ok(Meshed::of_layer(layered(layer, scene))),
        scene::Body::Mesh(mesh) => {
            use mpi::traits::Communicator;
            let mine = if comm.rank() == 0 { bytes(mesh) } else { Ok(Vec::new()) };
            let mut bytes = agree(comm, mine)?;
            crate::parallel::broadcast(comm, 0, &mut bytes);
            file_mesh(&bytes, mesh, scene, file).map(Meshed::in_plane)
        }
    }
}

/// A body's mesh, or what it is had from.
#[derive(Debug, Clone, PartialEq)]
pub enum Meshed {
    /// Of x and z.
    Plane(Source<2>),
    /// Of x, y and z.
    Space(Source<3>),
}

impl Meshed {
    fn of_layer(layer: Layer) -> Self {
        if layer.spans.len() == 1 { Self::Plane(Source::Layer(layer)) } else { Self::Space(Source::Layer(layer)) }
    }

    fn in_plane(mesh: Mesh<2>) -> Self {
        Self::Plane(Source::Mesh(mesh))
    }

    /// The nodes of its contact face, for output.
    pub fn face(&self) -> FacePlan {
        match self {
            Self::Plane(source) => face_plan(&source.face()),
            Self::Space(source) => face_plan(&source.face()),
        }
    }

    /// Its nodes and cells, for so many frames of output.
    pub fn bulk(&self, frames: usize) -> BulkPlan {
        match self {
            Self::Plane(source) => bulk_plan(&source.mesh(), frames),
            Self::Space(source) => bulk_plan(&source.mesh(), frames),
        }
    }
}

fn face_plan<const D: usize>(face: &Face<D>) -> FacePlan {
    FacePlan {
        in_space: D == 3,
        coordinates: face.places.iter().flat_map(|place| place.iter().take(D - 1)).copied().collect(),
        grid: face.grid.as_ref().filter(|_| D == 3).map_or_else(Vec::new, Grid::counts),
    }
}

fn bulk_plan<const D: usize>(mesh: &Mesh<D>, frames: usize) -> BulkPlan {
    BulkPlan {
        frames,
        axes: D,
        coordinates: mesh.nodes.iter().flatten().copied().collect(),
        corners: 1 << D,
        cells: mesh.cells.iter().flat_map(|cell| cell.as_multilinear()).map(i64::from).collect(),
    }
}

/// What a scene's body is, as far as it is known without a solver. A layer's mesh is not made for it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outline {
    /// Its contact face, along x.
    pub face: Stretch,
    /// In space, along y.
    pub across: Option<Stretch>,
    /// The displacements to be solved for.
    pub unknowns: usize,
    /// Quadrilaterals (in space hexahedra) and triangles.
    pub cells: [usize; 2],
    /// Of the contact, Pa/m, where the mesh decides it.
    pub penalty: Option<f64>,
    /// From the lowest point to the highest of the contact face, m.
    pub height: f64,
    /// Of the nodes of a mesh's face, x and the depth below the highest one, m; none for a layer, whose face is flat and
    /// evenly divided.
    pub nodes: Vec<[f64; 2]>,
}

/// The contact face in one direction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stretch {
    /// m
    pub from: f64,
    /// m
    pub to: f64,
    /// How many edges it has.
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
        scene::Body::Mesh(mesh) => Ok(Outline::of_mesh(scene, &file_mesh(&bytes(mesh)?, mesh, scene, file)?)),
    }
}

impl Outline {
    /// What the scene's body is, whose mesh is `mesh`.
    pub fn of(scene: &Scene, meshed: &Meshed) -> Self {
        match (scene.layer(), meshed) {
            (Some(layer), _) => Self::of_layer(layer),
            (None, Meshed::Plane(source)) => Self::of_mesh(scene, &source.mesh()),
            (None, Meshed::Space(_)) => Self::default(),
        }
    }

    fn of_layer(layer: &scene::Layer) -> Self {
        Self {
            face: Stretch::of_span(&layer.spans[0]),
            across: layer.spans.get(1).map(Stretch::of_span),
            unknowns: layer.unknowns(),
            cells: [layer.cells(), 0],
            penalty: None,
            height: layer.depth,
            nodes: Vec::new(),
        }
    }

    fn of_mesh(scene: &Scene, mesh: &Mesh<2>) -> Self {
        let triangles = mesh.cells.iter().filter(|cell| cell.kind == Kind::Simplex).count();
        let face = &mesh.face;
        Self {
            face: Stretch::of_mesh(mesh),
            across: None,
            unknowns: mesh.free_components(),
            cells: [mesh.cells.len() - triangles, triangles],
            penalty: mesh_penalty(scene, mesh).filter(|_| scene.contact.stiffness().is_none()),
            height: mesh.height(),
            nodes: face.places.iter().map(|place| [place.x, -place.y]).collect(),
        }
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

/// The mesh of the scene, of a .msh file with these bytes where the scene wants one.
pub fn mesh_of(bytes: &[u8], scene: &Scene) -> Result<Meshed> {
    match &scene.body {
        scene::Body::Layer(layer) => Ok(Meshed::of_layer(layered(layer, scene))),
        scene::Body::Mesh(mesh) => file_mesh(bytes, mesh, scene, &mesh.file).map(Meshed::in_plane),
    }
}

/// The content of the .msh file.
pub(super) fn bytes(mesh: &MeshFile) -> Result<Vec<u8>> {
    input::bytes(&mesh.file)
}

impl From<scene::Sides> for Sides {
    fn from(sides: scene::Sides) -> Self {
        match sides {
            scene::Sides::Periodic => Self::Periodic,
            scene::Sides::Free => Self::Free,
            scene::Sides::Roller => Self::Roller,
            scene::Sides::Fixed => Self::Fixed,
        }
    }
}

fn layered(layer: &scene::Layer, scene: &Scene) -> Layer {
    Layer {
        spans: layer
            .spans
            .iter()
            .map(|&scene::Span { width, cells, sides }| Span { width, cells, sides: sides.into() })
            .collect(),
        depth: layer.depth,
        rows: layer.rows,
        grading: layer.grading,
        strata: scene.materials.iter().filter_map(|material| material.thickness).collect(),
    }
}

/// The mesh of a .msh file; what is wrong with it is an error of the scene, at the key that asks for it.
fn file_mesh(bytes: &[u8], mesh: &MeshFile, scene: &Scene, file: &Path) -> Result<Mesh<2>> {
    let name = mesh.file.file_name().unwrap_or_default().to_string_lossy();
    let roles = Roles {
        contact: mesh.contact.clone(),
        fixed: mesh.fixed.clone(),
        roller: mesh.roller.clone(),
        regions: scene.materials.iter().filter_map(|material| material.region.clone()).collect(),
    };
    let built = gmsh::read(bytes).and_then(|contents| gmsh::build(&contents, &roles)).map_err(|flaw| {
        let (role, reason) = match flaw {
            Flaw::File(reason) => return Error::scene(file, "mesh.file", format!("{name}: {reason}")),
            Flaw::Unfit(role, reason) => (role, reason),
            Flaw::Unknown(role, known) => (role, unknown(&name, role, &roles, &known)),
        };
        let key = match role {
            Role::Contact => "mesh.contact".to_owned(),
            Role::Fixed(i) => format!("mesh.fixed.{i}"),
            Role::Roller(i) => format!("mesh.roller.{i}"),
            Role::Region(i) => format!("material.{}.region", roles.regions[i]),
        };
        Error::scene(file, key, reason)
    })?;
    depth_allows(&built, scene, file)?;
    match mesh_penalty(scene, &built) {
        None => {}
        Some(penalty) if penalty.is_finite() && penalty > 0.0 => {}
        Some(penalty) => {
            let reason = format!("gives a penalty of {penalty:?} Pa/m; give another");
            return Err(Error::scene(file, "contact.tolerance", reason));
        }
    }
    Ok(built)
}

/// The message for a group that the file does not have.
fn unknown(file: &str, role: Role, roles: &Roles, known: &[(i64, Option<String>)]) -> String {
    const LISTED: usize = 12;
    let (kind, name) = match role {
        Role::Contact => ("curve", &roles.contact),
        Role::Fixed(i) => ("curve", &roles.fixed[i]),
        Role::Roller(i) => ("curve", &roles.roller[i]),
        Role::Region(i) => ("surface", &roles.regions[i]),
    };
    let names: Vec<&str> = known.iter().filter_map(|(_, name)| name.as_deref()).collect();
    let mut list: Vec<String> = known.iter().take(LISTED).map(|(tag, name)| called(*tag, name.as_deref())).collect();
    list.extend((known.len() > LISTED).then(|| format!("{} more", known.len() - LISTED)));
    let advice = match (list.is_empty(), scene::nearest(name, &names)) {
        (true, _) => format!(
            "it has none: give the geometry a Physical {} and mesh again",
            if kind == "curve" { "Curve" } else { "Surface" }
        ),
        (_, Some(near)) => format!("did you mean {near:?}? It has {}", list.join(", ")),
        _ => format!("it has {}", list.join(", ")),
    };
    format!("{file} has no physical {kind} {name:?}; {advice}")
}

/// The indenter does not pass the lowest point of the body.
fn depth_allows(mesh: &Mesh<2>, scene: &Scene, file: &Path) -> Result<()> {
    let height = mesh.height();
    let passes = |phase: &&Phase| phase.approaches().iter().any(|(_, approach)| *approach >= height);
    match scene.phases.iter().find(passes) {
        Some(phase) => Err(Error::scene(
            file,
            phase.approach_key(),
            format!("must be less than the height of the body below its contact face ({height:.6e} m)"),
        )),
        None => Ok(()),
    }
}

/// The stiffness of the contact, Pa/m, from the mesh of the scene where it says a tolerance; none = no penetration.
pub fn penalty<const D: usize>(scene: &Scene, source: &Source<D>) -> Option<f64> {
    match source {
        Source::Mesh(mesh) => mesh_penalty(scene, mesh),
        // That of a layer is known by now.
        Source::Layer(_) => scene.contact.stiffness(),
    }
}

fn mesh_penalty<const D: usize>(scene: &Scene, mesh: &Mesh<D>) -> Option<f64> {
    let tolerance = match scene.contact.penalty? {
        scene::Penalty::Stiffness(stiffness) => return Some(stiffness),
        scene::Penalty::Tolerance(tolerance) => tolerance,
    };
    let edge = mesh.face.shortest();
    let mut at_face = vec![false; mesh.unknown_nodes()];
    mesh.face.unknown.iter().for_each(|&node| at_face[node as usize] = true);
    let touches = |cell: usize| mesh.cell_unknowns(cell).corners().iter().any(|&node| at_face[node as usize]);
    let regions: BTreeSet<u16> = (0..mesh.cells.len()).filter(|&cell| touches(cell)).map(|c| mesh.regions[c]).collect();
    let materials: Vec<_> = regions.iter().map(|&region| &scene.materials[usize::from(region)]).collect();
    Some(scene::penalty_on_mesh(tolerance, [edge, mesh.height()], &materials, scene::shortest_step(&scene.phases)))
}

/// How the scene's cells take their dilatation.
pub fn dilatation(scene: &Scene) -> Dilatation {
    let element = match &scene.body {
        scene::Body::Layer(layer) => layer.element,
        scene::Body::Mesh(mesh) => mesh.element,
    };
    match element {
        scene::Element::Quad4 | scene::Element::Hex8 => Dilatation::Pointwise,
        scene::Element::Quad4Bbar | scene::Element::Hex8Bbar => Dilatation::Mean,
    }
}

/// The materials as the bulk sees them: one part for each way of relaxing, whatever modulus and region relax so.
#[derive(Debug, Clone, PartialEq)]
pub struct Materials {
    /// What each region is made of.
    pub regions: Vec<Region>,
    /// The relaxation times of all arms, s.
    pub times: Vec<f64>,
    /// How each part relaxes; none = elastic.
    pub series: Vec<Option<Series>>,
    /// How the arms are updated.
    pub memory: Memory,
}

impl Materials {
    /// Of the scene's materials.
    pub fn new(scene: &Scene) -> Self {
        let all: Vec<Prony> =
            scene.materials.iter().flat_map(|material| [material.shear_series(), material.bulk_series()]).collect();
        let times = common_times(&all.iter().collect::<Vec<_>>());
        let mut series: Vec<Option<Series>> = Vec::new();
        let mut part = |wanted: Option<Series>| {
            series.iter().position(|known| *known == wanted).unwrap_or_else(|| {
                series.push(wanted);
                series.len() - 1
            })
        };
        let region = |material: &scene::Material| Region {
            moduli: moduli(material),
            shear_part: part(series_over(&material.shear_series(), &times)),
            bulk_part: part(series_over(&material.bulk_series(), &times)),
        };
        let regions = scene.materials.iter().map(region).collect();
        let memory = scene.materials.iter().find(|material| !material.is_elastic()).map(|material| material.memory);
        let memory = match memory {
            Some(scene::Memory::BackwardEuler) => Memory::BackwardEuler,
            _ => Memory::Exponential,
        };
        Self { regions, times, series, memory }
    }

    /// Whether all moduli of all regions relax in one way, so that the interior follows the face for all time.
    pub fn relax_alike(&self) -> bool {
        self.series.len() == 1
    }

    /// The body at rest. The first part carries the diagonal of the held unknowns.
    pub fn bulk<const D: usize>(&self, body: &Body<D>, layout: &Vector) -> Result<Bulk> {
        let part = |(p, series): (usize, &Option<Series>)| {
            let share = |region: &Region| Moduli {
                shear: if region.shear_part == p { region.moduli.shear } else { 0.0 },
                bulk: if region.bulk_part == p { region.moduli.bulk } else { 0.0 },
            };
            let moduli: Vec<Moduli> = self.regions.iter().map(share).collect();
            let diagonal = if p == 0 { self.regions[0].moduli.shear } else { 0.0 };
            Ok(Part { stiffness: body.stiffness(&moduli, diagonal)?, series: series.clone() })
        };
        let parts = self.series.iter().enumerate().map(part).collect::<Result<_>>()?;
        Bulk::new(parts, self.times.clone(), self.memory, layout)
    }
}

/// K = 2 G (1 + nu) / (3 (1 - 2 nu)), instantaneous.
fn moduli(material: &scene::Material) -> Moduli {
    let (g, nu) = (material.shear_modulus, material.poisson_ratio);
    Moduli { shear: g, bulk: 2.0 * g * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)) }
}

/// A series over a list of relaxation times, s; none where nothing relaxes.
fn series_over(prony: &Prony, times: &[f64]) -> Option<Series> {
    (!prony.arms.is_empty()).then(|| Series { long_term: prony.long_term(), weights: prony.weights_over(times) })
}
