//! From the scene's body and materials to a mesh, its regions and the parts of the bulk.

use std::path::Path;

use mpi::topology::SimpleCommunicator;
use nalgebra::Vector2;

use crate::bulk::{Bulk, Part, Series};
use crate::element::Quadrilateral;
use crate::error::{Error, Result};
use crate::mesh::gmsh::{self, Flaw, Role, Roles};
use crate::mesh::{Layer, Mesh, Sides};
use crate::parallel::agree;
use crate::petsc::Vector;
use crate::rheology::{Arm, Memory, Prony};
use crate::scene::{self, MeshFile, Scene};
use crate::solve::{Body, Moduli, Region};

/// The mesh of the scene at `file`, on every rank. A .msh file is read by rank 0 only. Collective.
pub fn mesh(comm: &SimpleCommunicator, scene: &Scene, file: &Path) -> Result<Mesh> {
    match &scene.body {
        scene::Body::Layer(layer) => Ok(layer_mesh(layer, scene)),
        scene::Body::Mesh(mesh) => {
            use mpi::traits::Communicator;
            let mine = if comm.rank() == 0 { bytes(mesh) } else { Ok(Vec::new()) };
            let mut bytes = agree(comm, mine)?;
            crate::parallel::broadcast(comm, 0, &mut bytes);
            file_mesh(&bytes, mesh, scene, file)
        }
    }
}

/// The mesh of the scene at `file`, without MPI.
pub fn mesh_alone(scene: &Scene, file: &Path) -> Result<Mesh> {
    match &scene.body {
        scene::Body::Layer(layer) => Ok(layer_mesh(layer, scene)),
        scene::Body::Mesh(mesh) => file_mesh(&bytes(mesh)?, mesh, scene, file),
    }
}

fn bytes(mesh: &MeshFile) -> Result<Vec<u8>> {
    std::fs::read(&mesh.file).map_err(|error| Error::file(&mesh.file, format!("cannot be read: {error}")))
}

fn layer_mesh(layer: &scene::Layer, scene: &Scene) -> Mesh {
    let sides = match layer.sides {
        scene::Sides::Periodic => Sides::Periodic,
        scene::Sides::Free => Sides::Free,
        scene::Sides::Roller => Sides::Roller,
        scene::Sides::Fixed => Sides::Fixed,
    };
    let thicknesses: Vec<f64> = scene.materials.iter().filter_map(|material| material.thickness).collect();
    let layer = Layer { width: layer.width, depth: layer.depth, cells: layer.cells, grading: layer.grading, sides };
    layer.mesh_of_strata(&thicknesses)
}

/// The mesh of a .msh file; what is wrong with it is an error of the scene, at the key that asks for it.
fn file_mesh(bytes: &[u8], mesh: &MeshFile, scene: &Scene, file: &Path) -> Result<Mesh> {
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
    Ok(built)
}

/// The message for a name that the file does not have.
fn unknown(file: &str, role: Role, roles: &Roles, known: &[String]) -> String {
    let (kind, name) = match role {
        Role::Contact => ("curve", &roles.contact),
        Role::Fixed(i) => ("curve", &roles.fixed[i]),
        Role::Roller(i) => ("curve", &roles.roller[i]),
        Role::Region(i) => ("surface", &roles.regions[i]),
    };
    let names: Vec<&str> = known.iter().map(String::as_str).collect();
    let advice = match names.is_empty() {
        true => format!(
            "it names none: give the geometry a Physical {} and mesh again",
            if kind == "curve" { "Curve" } else { "Surface" }
        ),
        false => scene::advice(name, &names, "it has"),
    };
    format!("{file} has no physical {kind} {name:?}; {advice}")
}

/// The indenter does not pass the lowest point of the body.
fn depth_allows(mesh: &Mesh, scene: &Scene, file: &Path) -> Result<()> {
    let range = |list: &mut dyn Iterator<Item = &Vector2<f64>>| {
        list.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), node| (low.min(node.y), high.max(node.y)))
    };
    let (low, _) = range(&mut mesh.nodes.iter());
    let (_, top) = range(&mut mesh.face.unknown.iter().map(|&node| &mesh.nodes[node as usize]));
    let depth = top - low;
    match scene.phases.iter().find(|phase| phase.approach.is_some_and(|approach| approach >= depth)) {
        Some(phase) => Err(Error::scene(
            file,
            format!("phase.{}.approach", phase.name),
            format!("must be less than the height of the body below its contact face ({depth:.6e} m)"),
        )),
        None => Ok(()),
    }
}

/// What the scene's quadrilaterals are.
pub fn quadrilateral(scene: &Scene) -> Quadrilateral {
    let element = match &scene.body {
        scene::Body::Layer(layer) => layer.element,
        scene::Body::Mesh(mesh) => mesh.element,
    };
    match element {
        scene::Element::Quad4 => Quadrilateral::Plain,
        scene::Element::Quad4Bbar => Quadrilateral::MeanDilatation,
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
        let mut times: Vec<f64> = Vec::new();
        for arm in scene.materials.iter().flat_map(|material| &material.arms) {
            if !times.contains(&arm.time) {
                times.push(arm.time);
            }
        }
        let mut series: Vec<Option<Series>> = Vec::new();
        let mut part = |wanted: Option<Series>| {
            series.iter().position(|known| *known == wanted).unwrap_or_else(|| {
                series.push(wanted);
                series.len() - 1
            })
        };
        let region = |material: &scene::Material| {
            let shear_part = part(relaxation(material, &times));
            let constant_bulk = material.poisson_rule == Some(scene::PoissonRule::ConstantBulkModulus);
            let bulk_part = if constant_bulk { part(None) } else { shear_part };
            Region { moduli: moduli(material), shear_part, bulk_part }
        };
        let regions = scene.materials.iter().map(region).collect();
        let memory = scene.materials.iter().find(|material| !material.arms.is_empty()).map(|material| material.memory);
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
    pub fn bulk(&self, body: &Body, layout: &Vector) -> Result<Bulk> {
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

/// The relaxation of the shear modulus over the common list of times; none = elastic.
fn relaxation(material: &scene::Material, times: &[f64]) -> Option<Series> {
    let arms: Vec<Arm> = material.arms.iter().map(|a| Arm { weight: a.weight, time: a.time }).collect();
    let weight = |time: &f64| arms.iter().filter(|arm| arm.time == *time).map(|arm| arm.weight).sum();
    let weights = times.iter().map(weight).collect();
    (!arms.is_empty()).then(|| Series { long_term: Prony { arms }.long_term(), weights })
}
