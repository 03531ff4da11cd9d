//! From the scene's body and materials to a mesh, its regions and the parts of the bulk.

use std::collections::BTreeSet;
use std::path::Path;

use mpi::topology::SimpleCommunicator;

use crate::bulk::{Bulk, Part, Series};
use crate::element::Kind;
use crate::element::solid::Dilatation;
use crate::error::{Error, Result};
use crate::input;
use crate::mesh::gmsh::{self, Built, Flaw, Role, Roles, called};
use crate::mesh::{Cell, Face, Grid, Layer, Mesh, Sides, Source, Span};
use crate::output::{BulkPlan, FacePlan};
use crate::parallel::agree;
use crate::petsc::Vector;
use crate::rheology::Memory;
use crate::rheology::prony::{Prony, common_times};
use crate::scene::{self, MeshFile, Phase, Scene};
use crate::solve::{Body, Moduli, Region, Relaxations};

/// The mesh of the scene at `file`, on every rank. A .msh file is read by rank 0 only. Collective.
pub fn mesh(comm: &SimpleCommunicator, scene: &Scene, file: &Path) -> Result<Meshed> {
    match &scene.body {
        scene::Body::Layer(layer) => Ok(Meshed::of_layer(layered(layer, scene))),
        scene::Body::Mesh(mesh) => {
            use mpi::traits::Communicator;
            let mine = if comm.rank() == 0 { bytes(mesh) } else { Ok(Vec::new()) };
            let mut bytes = agree(comm, mine)?;
            crate::parallel::broadcast(comm, 0, &mut bytes);
            file_mesh(&bytes, mesh, scene, file)
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

    /// Whether it is in space.
    pub fn is_in_space(&self) -> bool {
        matches!(self, Self::Space(_))
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
    // Tetrahedra as such; triangles are quadrilaterals with a corner twice.
    let simplices = D == 3 && mesh.cells.iter().all(|cell| cell.kind == Kind::Simplex);
    let corners = if simplices { D + 1 } else { 1 << D };
    let of = |cell: &Cell<D>| if simplices { cell.corners().to_vec() } else { cell.as_multilinear() };
    let cells = mesh.cells.iter().flat_map(of).map(i64::from);
    BulkPlan {
        frames,
        axes: D,
        coordinates: mesh.nodes.iter().flatten().copied().collect(),
        corners,
        cells: cells.collect(),
    }
}

/// The mesh of the scene, of a .msh file with these bytes where the scene wants one.
pub fn mesh_of(bytes: &[u8], scene: &Scene) -> Result<Meshed> {
    match &scene.body {
        scene::Body::Layer(layer) => Ok(Meshed::of_layer(layered(layer, scene))),
        scene::Body::Mesh(mesh) => file_mesh(bytes, mesh, scene, &mesh.file),
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
pub(super) fn file_mesh(bytes: &[u8], mesh: &MeshFile, scene: &Scene, file: &Path) -> Result<Meshed> {
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
            Flaw::Unknown(role, dimension, known) => (role, unknown(&name, (role, dimension), &roles, &known)),
        };
        let key = match role {
            Role::Contact => "mesh.contact".to_owned(),
            Role::Fixed(i) => format!("mesh.fixed.{i}"),
            Role::Roller(i) => format!("mesh.roller.{i}"),
            Role::Region(i) => format!("material.{}.region", roles.regions[i]),
        };
        Error::scene(file, key, reason)
    })?;
    let in_space = matches!(built, Built::Space(_));
    scene.allows_mesh(in_space).map_err(|(key, reason)| Error::scene(file, key, reason))?;
    match built {
        Built::Plane(mesh) => fits(&mesh, scene, file).map(|()| Meshed::Plane(Source::Mesh(mesh))),
        Built::Space(mesh) => fits(&mesh, scene, file).map(|()| Meshed::Space(Source::Mesh(mesh))),
    }
}

/// Whether approach and penalty go with a mesh.
fn fits<const D: usize>(mesh: &Mesh<D>, scene: &Scene, file: &Path) -> Result<()> {
    depth_allows(mesh, scene, file)?;
    match mesh_penalty(scene, mesh) {
        None => Ok(()),
        Some(penalty) if penalty.is_finite() && penalty > 0.0 => Ok(()),
        Some(penalty) => {
            let reason = format!("gives a penalty of {penalty:?} Pa/m; give another");
            Err(Error::scene(file, "contact.tolerance", reason))
        }
    }
}

/// The message for a group that the file does not have.
fn unknown(file: &str, (role, dimension): (Role, usize), roles: &Roles, known: &[(i64, Option<String>)]) -> String {
    const LISTED: usize = 12;
    let name = match role {
        Role::Contact => &roles.contact,
        Role::Fixed(i) => &roles.fixed[i],
        Role::Roller(i) => &roles.roller[i],
        Role::Region(i) => &roles.regions[i],
    };
    let [kind, command] = match dimension {
        1 => ["curve", "Curve"],
        2 => ["surface", "Surface"],
        _ => ["volume", "Volume"],
    };
    let names: Vec<&str> = known.iter().filter_map(|(_, name)| name.as_deref()).collect();
    let mut list: Vec<String> = known.iter().take(LISTED).map(|(tag, name)| called(*tag, name.as_deref())).collect();
    list.extend((known.len() > LISTED).then(|| format!("{} more", known.len() - LISTED)));
    let advice = match (list.is_empty(), scene::nearest(name, &names)) {
        (true, _) => format!("it has none: give the geometry a Physical {command} and mesh again"),
        (_, Some(near)) => format!("did you mean {near:?}? It has {}", list.join(", ")),
        _ => format!("it has {}", list.join(", ")),
    };
    format!("{file} has no physical {kind} {name:?}; {advice}")
}

/// The indenter does not pass the lowest point of the body.
fn depth_allows<const D: usize>(mesh: &Mesh<D>, scene: &Scene, file: &Path) -> Result<()> {
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

pub(super) fn mesh_penalty<const D: usize>(scene: &Scene, mesh: &Mesh<D>) -> Option<f64> {
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
        scene::Body::Layer(layer) => Some(layer.element),
        scene::Body::Mesh(mesh) => mesh.element,
    };
    match element {
        Some(scene::Element::Quad4Bbar | scene::Element::Hex8Bbar) => Dilatation::Mean,
        Some(scene::Element::Quad4 | scene::Element::Hex8) | None => Dilatation::Pointwise,
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

    /// How the parts of the bulk relax.
    pub fn relaxations(&self) -> Relaxations {
        Relaxations { times: self.times.clone(), rule: self.memory, series: self.series.clone() }
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
