//! The body as a distributed mesh: its stiffness, and its fields for output.

use mpi::topology::SimpleCommunicator;
use nalgebra::{SVector, Vector4};

use super::BulkFields;
use crate::element::quad4::{self, Answer};
use crate::error::Result;
use crate::mesh::{Mesh, Numbering};
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

impl Moduli {
    /// The stiffness of an element of these moduli.
    pub fn stiffness(&self, split: &quad4::Split) -> quad4::Stiffness {
        split.deviatoric * self.shear + split.volumetric * self.bulk
    }
}

/// A mesh distributed over the ranks of a communicator, of one material.
pub struct Body {
    mesh: Mesh,
    numbering: Numbering,
    pattern: Pattern,
    comm: SimpleCommunicator,
    /// Instantaneous.
    moduli: Moduli,
    /// What output needs, made when first asked for.
    recovery: Option<Recovery>,
}

/// The cells around this rank's nodes, and the displacements of their corners.
struct Recovery {
    cells: Vec<usize>,
    /// Per cell, its corners' places in the gathered displacements (by node).
    corners: Vec<[usize; 4]>,
    gather: Gather,
    gathered: usize,
}

impl Body {
    /// Distributes the mesh.
    pub fn new(comm: SimpleCommunicator, mesh: Mesh, moduli: Moduli) -> Result<Self> {
        let numbering = Numbering::new(&comm, &mesh)?;
        let pattern = numbering.pattern(&mesh);
        Ok(Self { mesh, numbering, pattern, comm, moduli, recovery: None })
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
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

    /// G K_dev + K K_vol, with `diagonal` for the held unknowns.
    pub fn stiffness(&self, moduli: Moduli, diagonal: f64) -> Result<Matrix> {
        let mut matrix = Matrix::new(&self.comm, &self.pattern)?;
        for &cell in &self.numbering.cells {
            let stiffness = moduli.stiffness(&quad4::stiffness(&self.mesh.corners(cell)));
            let nodes = self.mesh.cell_unknowns(cell).map(|unknown| self.numbering.global[unknown as usize]);
            // Column-major and symmetric, so row-major too.
            matrix.add_blocks(&nodes, stiffness.as_slice())?;
        }
        matrix.assemble()?;
        matrix.fix(&self.held(), diagonal)?;
        Ok(matrix)
    }

    /// The rigid-body modes' coordinates: x, z of each of this rank's nodes.
    pub fn coordinates(&self) -> Result<Vector> {
        let mut place = vec![0; self.mesh.unknown_nodes()];
        for (node, &unknown) in self.mesh.unknown.iter().enumerate().rev() {
            place[unknown as usize] = node;
        }
        let mut vector = self.vector()?;
        for (entry, &unknown) in vector.view_mut()?.chunks_exact_mut(2).zip(&self.numbering.unknowns) {
            entry.copy_from_slice(self.mesh.nodes[place[unknown as usize]].as_slice());
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
            place => Ok(place.insert(Recovery::new(&self.mesh, &self.numbering, layout)?)),
        }
    }

    /// Displacement and stress at this rank's nodes; stress is the mean of what the cells around a node say.
    /// `effective` holds what [`Self::around`] gave for each part's effective displacement.
    pub fn fields(&mut self, u: &Vector, effective: &[Vec<f64>]) -> Result<BulkFields> {
        self.recovery(u)?;
        let Some(recovery) = &self.recovery else { return Ok(BulkFields::default()) };
        // One part answers to both moduli, or the first to shear and the second to bulk.
        let (shear, dilatation) = (&effective[0], &effective[effective.len() - 1]);
        let mut sums = vec![(Vector4::<f64>::zeros(), 0.0); self.numbering.owned.len()];
        for (&cell, places) in recovery.cells.iter().zip(&recovery.corners) {
            let at = |values: &[f64]| SVector::from_fn(|row, _| values[2 * places[row / 2] + row % 2]);
            let (u_shear, u_bulk) = (at(shear), at(dilatation));
            let stress = quad4::corner_stress(
                &self.mesh.corners(cell),
                Answer { modulus: self.moduli.shear, displacement: &u_shear },
                Answer { modulus: self.moduli.bulk, displacement: &u_bulk },
            );
            for (unknown, stress) in self.mesh.cell_unknowns(cell).into_iter().zip(stress) {
                if let Some(local) = self.numbering.local(unknown) {
                    sums[local].0 += stress;
                    sums[local].1 += 1.0;
                }
            }
        }
        let values = u.view()?;
        let mut fields = BulkFields::default();
        for (node, &unknown) in self.mesh.unknown.iter().enumerate() {
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
            let (global, held) = (self.numbering.global[unknown as usize], self.mesh.held[unknown as usize]);
            (0..2).filter(move |&component| held[component]).map(move |component| 2 * global + component as i32)
        };
        self.numbering.unknowns.iter().flat_map(rows).collect()
    }
}

impl Recovery {
    fn new(mesh: &Mesh, numbering: &Numbering, layout: &Vector) -> Result<Self> {
        let touches = |cell: &usize| mesh.cell_unknowns(*cell).iter().any(|&u| numbering.local(u).is_some());
        let cells: Vec<usize> = (0..mesh.cells.len()).filter(touches).collect();
        let mut unknowns: Vec<u32> = cells.iter().flat_map(|&cell| mesh.cell_unknowns(cell)).collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        let mut place = vec![0; mesh.unknown_nodes()];
        for (i, &unknown) in unknowns.iter().enumerate() {
            place[unknown as usize] = i;
        }
        let corners = cells.iter().map(|&cell| mesh.cell_unknowns(cell).map(|u| place[u as usize])).collect();
        let indices: Vec<i32> = unknowns
            .iter()
            .map(|&unknown| numbering.global[unknown as usize])
            .flat_map(|node| [2 * node, 2 * node + 1])
            .collect();
        Ok(Self { cells, corners, gathered: indices.len(), gather: Gather::new(layout, &indices)? })
    }
}
