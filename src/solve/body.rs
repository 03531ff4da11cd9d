//! The body as a distributed mesh: its stiffness, and its fields for output.

use mpi::topology::SimpleCommunicator;
use nalgebra::{SVector, Vector4};

use super::BulkFields;
use crate::bulk::Bulk;
use crate::element::plane::{Answer, Split};
use crate::element::{Quadrilateral, bbar, quad4, tri3};
use crate::error::Result;
use crate::mesh::{Cell, Mesh, Numbering};
use crate::petsc::{Gather, Matrix, Pattern, Vector};
use crate::snapshot::NaturalOrder;

/// Shear and bulk modulus, Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moduli {
    /// G
    pub shear: f64,
    /// K
    pub bulk: f64,
}

/// What a region of the mesh is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Instantaneous.
    pub moduli: Moduli,
    /// The part of the bulk that the shear modulus relaxes with.
    pub shear_part: usize,
    /// The part of the bulk that the bulk modulus relaxes with.
    pub bulk_part: usize,
}

impl Region {
    /// The moduli, each times the factor of its part.
    pub fn relaxed(&self, factors: &[f64]) -> Moduli {
        let Moduli { shear, bulk } = self.moduli;
        Moduli { shear: shear * factors[self.shear_part], bulk: bulk * factors[self.bulk_part] }
    }
}

/// A mesh and what it is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// The mesh.
    pub mesh: Mesh,
    /// What its quadrilaterals are.
    pub quadrilateral: Quadrilateral,
    /// What its regions are made of.
    pub regions: Vec<Region>,
}

impl Solid {
    /// What stands on the diagonal of held rows: a modulus, Pa.
    pub fn diagonal(&self) -> f64 {
        self.regions[0].moduli.shear
    }

    /// What a cell is made of.
    pub fn region(&self, cell: usize) -> Region {
        self.regions[usize::from(self.mesh.regions[cell])]
    }

    /// The split stiffness of a quadrilateral.
    pub fn quadrilateral(&self, corners: [u32; 4]) -> Split<8> {
        let points = self.mesh.points(corners);
        match self.quadrilateral {
            Quadrilateral::Plain => quad4::stiffness(&points),
            Quadrilateral::MeanDilatation => bbar::stiffness(&points),
        }
    }
}

/// A solid distributed over the ranks of a communicator.
pub struct Body {
    solid: Solid,
    numbering: Numbering,
    pattern: Pattern,
    comm: SimpleCommunicator,
    /// What output needs, made when first asked for.
    recovery: Option<Recovery>,
}

/// The cells around this rank's nodes, and the displacements of their corners.
struct Recovery {
    cells: Vec<usize>,
    /// Per cell, its corners' places in the gathered displacements (by node).
    places: Vec<Cell>,
    gather: Gather,
    gathered: usize,
}

impl Body {
    /// Distributes the solid.
    pub fn new(comm: SimpleCommunicator, solid: Solid) -> Result<Self> {
        let numbering = Numbering::new(&comm, &solid.mesh)?;
        let pattern = numbering.pattern(&solid.mesh);
        Ok(Self { solid, numbering, pattern, comm, recovery: None })
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.solid.mesh
    }

    /// The stiffness at the instantaneous moduli.
    pub fn elastic(&self) -> Result<Matrix> {
        let moduli: Vec<Moduli> = self.solid.regions.iter().map(|region| region.moduli).collect();
        self.stiffness(&moduli, self.solid.diagonal())
    }

    /// What it is made of.
    pub fn solid(&self) -> &Solid {
        &self.solid
    }

    /// The ranks that it is distributed over.
    pub fn comm(&self) -> &SimpleCommunicator {
        &self.comm
    }

    /// Who owns what.
    pub fn numbering(&self) -> &Numbering {
        &self.numbering
    }

    /// A zero vector of the unknowns.
    pub fn vector(&self) -> Result<Vector> {
        Vector::new(&self.comm, 2 * self.numbering.owned.len())
    }

    /// The order of the mesh, for vectors of the unknowns.
    pub fn natural_order(&self, layout: &Vector) -> Result<NaturalOrder> {
        let global: Vec<i32> = self.numbering.global.iter().flat_map(|&node| [2 * node, 2 * node + 1]).collect();
        NaturalOrder::new(&self.comm, layout, &global, 2 * self.numbering.owned.start)
    }

    /// G K_dev + K K_vol with the moduli of each region, and `diagonal` for the held unknowns.
    ///
    /// A region of zero moduli has its zeros in the matrix, so that all matrices of a body have one pattern.
    pub fn stiffness(&self, moduli: &[Moduli], diagonal: f64) -> Result<Matrix> {
        let mut matrix = Matrix::new(&self.comm, &self.pattern)?;
        for &cell in &self.numbering.cells {
            let Moduli { shear, bulk } = moduli[usize::from(self.solid.mesh.regions[cell])];
            let global = |node: u32| self.numbering.global[self.mesh().unknown[node as usize] as usize];
            // Column-major and symmetric, so row-major too.
            match self.solid.mesh.cells[cell] {
                Cell::Triangle(corners) => {
                    let stiffness = tri3::stiffness(&self.solid.mesh.points(corners)).with(shear, bulk);
                    matrix.add_blocks(&corners.map(global), stiffness.as_slice())?;
                }
                Cell::Quadrilateral(corners) => {
                    let stiffness = self.solid.quadrilateral(corners).with(shear, bulk);
                    matrix.add_blocks(&corners.map(global), stiffness.as_slice())?;
                }
            }
        }
        matrix.assemble()?;
        matrix.fix(&self.held(), diagonal)?;
        Ok(matrix)
    }

    /// The rigid-body modes' coordinates: x, z of each of this rank's nodes.
    pub fn coordinates(&self) -> Result<Vector> {
        let mut place = vec![0; self.solid.mesh.unknown_nodes()];
        for (node, &unknown) in self.solid.mesh.unknown.iter().enumerate().rev() {
            place[unknown as usize] = node;
        }
        let mut vector = self.vector()?;
        for (entry, &unknown) in vector.view_mut()?.chunks_exact_mut(2).zip(&self.numbering.unknowns) {
            entry.copy_from_slice(self.solid.mesh.nodes[place[unknown as usize]].as_slice());
        }
        Ok(vector)
    }

    /// The values of `y` at the corners of the cells around this rank's nodes, for [`Self::fields`].
    pub fn around(&mut self, y: &Vector) -> Result<Vec<f64>> {
        let recovery = self.recovery(y)?;
        let mut values = vec![0.0; recovery.gathered];
        recovery.gather.gather(y, &mut values)?;
        Ok(values)
    }

    fn recovery(&mut self, layout: &Vector) -> Result<&mut Recovery> {
        match &mut self.recovery {
            Some(recovery) => Ok(recovery),
            place => Ok(place.insert(Recovery::new(&self.solid.mesh, &self.numbering, layout)?)),
        }
    }

    /// [`Self::fields`] at the accepted state `u` of a bulk with memory.
    pub fn fields_with_memory(&mut self, bulk: &mut Bulk, u: &Vector) -> Result<BulkFields> {
        let mut effective = Vec::new();
        bulk.effective(u, |y| {
            effective.push(self.around(y)?);
            Ok(())
        })?;
        self.fields(u, &effective)
    }

    /// Displacement and stress at this rank's nodes; stress is the mean of what the cells around a node say.
    /// `effective` holds what [`Self::around`] gave for each part's effective displacement.
    pub fn fields(&mut self, u: &Vector, effective: &[Vec<f64>]) -> Result<BulkFields> {
        self.recovery(u)?;
        let Some(recovery) = &self.recovery else { return Ok(BulkFields::default()) };
        let mut sums = vec![(Vector4::<f64>::zeros(), 0.0); self.numbering.owned.len()];
        for (&cell, places) in recovery.cells.iter().zip(&recovery.places) {
            let region = self.solid.region(cell);
            let answers = [(region.moduli.shear, region.shear_part), (region.moduli.bulk, region.bulk_part)]
                .map(|(modulus, part)| (modulus, effective[part].as_slice()));
            let stress = corner_stress(&self.solid, cell, places, answers);
            for (&unknown, stress) in self.solid.mesh.cell_unknowns(cell).corners().iter().zip(stress) {
                if let Some(local) = self.numbering.local(unknown) {
                    sums[local].0 += stress;
                    sums[local].1 += 1.0;
                }
            }
        }
        let values = u.view()?;
        let mut fields = BulkFields::default();
        for (node, &unknown) in self.solid.mesh.unknown.iter().enumerate() {
            if let Some(local) = self.numbering.local(unknown) {
                fields.nodes.push(node);
                fields.displacement.push([values[2 * local], values[2 * local + 1]]);
                fields.stress.push((sums[local].0 / sums[local].1).into());
            }
        }
        Ok(fields)
    }

    /// The held unknowns that this rank owns, as global row numbers.
    fn held(&self) -> Vec<i32> {
        let rows = |&unknown: &u32| {
            let (global, held) = (self.numbering.global[unknown as usize], self.solid.mesh.held[unknown as usize]);
            (0..2).filter(move |&component| held[component]).map(move |component| 2 * global + component as i32)
        };
        self.numbering.unknowns.iter().flat_map(rows).collect()
    }
}

/// Stress at the corners of a cell (those of a triangle first), Pa. `answers`: the shear and the bulk modulus, Pa, each
/// with the displacements that it answers to, of which the cell's are at `places`, node by node.
fn corner_stress(solid: &Solid, cell: usize, places: &Cell, answers: [(f64, &[f64]); 2]) -> [Vector4<f64>; 4] {
    let mesh = &solid.mesh;
    let entry = |values: &[f64], row: usize| values[2 * places.corners()[row / 2] as usize + row % 2];
    match mesh.cells[cell] {
        Cell::Triangle(corners) => {
            let [u, v] = answers.map(|(_, values)| SVector::from_fn(|row, _| entry(values, row)));
            let [shear, bulk] = [(answers[0].0, &u), (answers[1].0, &v)]
                .map(|(modulus, displacement)| Answer { modulus, displacement });
            [tri3::stress(&mesh.points(corners), shear, bulk); 4]
        }
        Cell::Quadrilateral(corners) => {
            let [u, v] = answers.map(|(_, values)| SVector::from_fn(|row, _| entry(values, row)));
            let [shear, bulk] = [(answers[0].0, &u), (answers[1].0, &v)]
                .map(|(modulus, displacement)| Answer { modulus, displacement });
            match solid.quadrilateral {
                Quadrilateral::Plain => quad4::corner_stress(&mesh.points(corners), shear, bulk),
                Quadrilateral::MeanDilatation => bbar::corner_stress(&mesh.points(corners), shear, bulk),
            }
        }
    }
}

impl Recovery {
    fn new(mesh: &Mesh, numbering: &Numbering, layout: &Vector) -> Result<Self> {
        let touches = |cell: &usize| mesh.cell_unknowns(*cell).corners().iter().any(|&u| numbering.local(u).is_some());
        let cells: Vec<usize> = (0..mesh.cells.len()).filter(touches).collect();
        let mut unknowns: Vec<u32> = cells.iter().flat_map(|&cell| mesh.cell_unknowns(cell).four()).collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        let mut place = vec![0; mesh.unknown_nodes()];
        for (i, &unknown) in unknowns.iter().enumerate() {
            place[unknown as usize] = i as u32;
        }
        let places = cells.iter().map(|&cell| mesh.cell_unknowns(cell).map(|u| place[u as usize])).collect();
        let indices: Vec<i32> = unknowns
            .iter()
            .map(|&unknown| numbering.global[unknown as usize])
            .flat_map(|node| [2 * node, 2 * node + 1])
            .collect();
        Ok(Self { cells, places, gathered: indices.len(), gather: Gather::new(layout, &indices)? })
    }
}
