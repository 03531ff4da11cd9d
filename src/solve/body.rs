//! The body as a distributed mesh: its stiffness, and its fields for output.

use mpi::topology::SimpleCommunicator;
use nalgebra::SVector;

use super::BulkFields;
use crate::bulk::Bulk;
use crate::element::conduction::Conduction;
use crate::element::solid::{Answer, Dilatation, Placed, Split, Stress, row_major};
use crate::error::Result;
use crate::mesh::{Cell, Mesh, Numbering, Source};
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

/// A body: where its mesh is had from, and what it is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid<const D: usize> {
    /// The mesh.
    pub source: Source<D>,
    /// How its cells take their dilatation; those of constant strain know but one way.
    pub dilatation: Dilatation,
    /// What its regions are made of.
    pub regions: Vec<Region>,
}

impl<const D: usize> Solid<D> {
    /// Its cells.
    pub fn cells(&self) -> Cells<D> {
        Cells { mesh: self.source.mesh(), dilatation: self.dilatation, regions: self.regions.clone() }
    }

    /// One column of a layer that repeats in all directions of its face, and how many there are along each; none of any other body.
    pub fn column(&self) -> Option<(Cells<D>, Vec<usize>)> {
        let Source::Layer(layer) = &self.source else { return None };
        let column = Self { source: Source::Layer(layer.column()), ..self.clone() };
        layer.periodic_counts().map(|counts| (column.cells(), counts))
    }
}

/// The cells of a mesh and what they are made of.
pub struct Cells<const D: usize> {
    /// The mesh.
    pub mesh: Mesh<D>,
    dilatation: Dilatation,
    regions: Vec<Region>,
}

impl<const D: usize> Cells<D> {
    /// What stands on the diagonal of held rows: a modulus, Pa.
    pub fn diagonal(&self) -> f64 {
        self.regions[0].moduli.shear
    }

    /// What a cell is made of.
    pub fn region(&self, cell: usize) -> Region {
        self.regions[usize::from(self.mesh.regions[cell])]
    }

    /// The split stiffness of a cell.
    pub fn split(&self, cell: usize) -> Split<D> {
        self.placed(cell, |placed| placed.stiffness())
    }

    /// What a cell conducts and holds of heat, for unit conductivity and capacity.
    pub fn conduction(&self, cell: usize) -> Conduction {
        self.placed(cell, |placed| placed.conduction())
    }

    /// What is asked of a cell where it lies.
    fn placed<T>(&self, cell: usize, ask: impl FnOnce(Placed<'_, D>) -> T) -> T {
        let cell = &self.mesh.cells[cell];
        ask(Placed { shape: cell.shape(), corners: &self.mesh.places(cell), dilatation: self.dilatation })
    }
}

/// A solid distributed over the ranks of a communicator.
pub struct Body<const D: usize> {
    cells: Cells<D>,
    numbering: Numbering,
    pattern: Pattern,
    comm: SimpleCommunicator,
    /// What output needs, made when first asked for.
    recovery: Option<Recovery<D>>,
}

/// The cells around this rank's nodes, and the displacements of their corners.
struct Recovery<const D: usize> {
    cells: Vec<usize>,
    /// Per cell, its corners' places in the gathered displacements (by node).
    places: Vec<Cell<D>>,
    gather: Gather,
    gathered: usize,
}

impl<const D: usize> Body<D> {
    /// Distributes the solid.
    pub fn new(comm: SimpleCommunicator, solid: &Solid<D>) -> Result<Self> {
        let cells = solid.cells();
        let numbering = Numbering::new(&comm, &cells.mesh)?;
        let pattern = numbering.pattern(&cells.mesh);
        Ok(Self { cells, numbering, pattern, comm, recovery: None })
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh<D> {
        &self.cells.mesh
    }

    /// The stiffness at the instantaneous moduli.
    pub fn elastic(&self) -> Result<Matrix> {
        let moduli: Vec<Moduli> = self.cells.regions.iter().map(|region| region.moduli).collect();
        self.stiffness(&moduli, self.cells.diagonal())
    }

    /// What it is made of.
    pub fn cells(&self) -> &Cells<D> {
        &self.cells
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
        Vector::new(&self.comm, D * self.numbering.owned.len())
    }

    /// The order of the mesh, for vectors of the unknowns.
    pub fn natural_order(&self, layout: &Vector) -> Result<NaturalOrder> {
        let global = rows_of::<D>(self.numbering.global.iter().copied());
        NaturalOrder::new(&self.comm, layout, &global, D * self.numbering.owned.start)
    }

    /// G K_dev + K K_vol with the moduli of each region, and `diagonal` for the held unknowns.
    ///
    /// A region of zero moduli has its zeros in the matrix, so that all matrices of a body have one pattern.
    pub fn stiffness(&self, moduli: &[Moduli], diagonal: f64) -> Result<Matrix> {
        let mut matrix = Matrix::new(&self.comm, &self.pattern)?;
        for &cell in &self.numbering.cells {
            let Moduli { shear, bulk } = moduli[usize::from(self.cells.mesh.regions[cell])];
            let global = |node: u32| self.numbering.global[self.mesh().unknown[node as usize] as usize];
            let corners: Vec<i32> = self.cells.mesh.cells[cell].corners().iter().map(|&node| global(node)).collect();
            matrix.add_blocks(&corners, &row_major(&self.cells.split(cell).with(shear, bulk)))?;
        }
        matrix.assemble()?;
        matrix.fix(&self.held(), diagonal)?;
        Ok(matrix)
    }

    /// The rigid-body modes' coordinates: those of each of this rank's nodes.
    pub fn coordinates(&self) -> Result<Vector> {
        let mut place = vec![0; self.cells.mesh.unknown_nodes()];
        for (node, &unknown) in self.cells.mesh.unknown.iter().enumerate().rev() {
            place[unknown as usize] = node;
        }
        let mut vector = self.vector()?;
        for (entry, &unknown) in vector.view_mut()?.chunks_exact_mut(D).zip(&self.numbering.unknowns) {
            entry.copy_from_slice(self.cells.mesh.nodes[place[unknown as usize]].as_slice());
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

    fn recovery(&mut self, layout: &Vector) -> Result<&mut Recovery<D>> {
        match &mut self.recovery {
            Some(recovery) => Ok(recovery),
            place => Ok(place.insert(Recovery::new(&self.cells.mesh, &self.numbering, layout)?)),
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
        self.fields_by(u, |_, places, part| {
            let at = |&place: &u32| SVector::from_column_slice(&effective[part][D * place as usize..][..D]);
            places.corners().iter().map(at).collect()
        })
    }

    /// [`Self::fields`] where `of` gives the effective displacement of the corners of a cell, which are at the places in what
    /// [`Self::around`] gives, in a part.
    pub fn fields_by(
        &mut self,
        u: &Vector,
        of: impl Fn(usize, &Cell<D>, usize) -> Vec<SVector<f64, D>>,
    ) -> Result<BulkFields> {
        self.recovery(u)?;
        let Some(recovery) = &self.recovery else { return Ok(BulkFields::default()) };
        let mut sums = vec![(Stress::zeros(), 0.0); self.numbering.owned.len()];
        for (&cell, places) in recovery.cells.iter().zip(&recovery.places) {
            let Region { moduli, shear_part, bulk_part } = self.cells.region(cell);
            let [u, v] = [shear_part, bulk_part].map(|part| of(cell, places, part));
            let [shear, bulk] =
                [(moduli.shear, &u), (moduli.bulk, &v)].map(|(modulus, displacement)| Answer { modulus, displacement });
            let stress = self.cells.placed(cell, |placed| placed.corner_stress(shear, bulk));
            for (&unknown, stress) in self.cells.mesh.cell_unknowns(cell).corners().iter().zip(stress) {
                if let Some(local) = self.numbering.local(unknown) {
                    sums[local].0 += stress;
                    sums[local].1 += 1.0;
                }
            }
        }
        let values = u.view()?;
        let mut fields = BulkFields { in_space: D == 3, ..BulkFields::default() };
        for (node, &unknown) in self.cells.mesh.unknown.iter().enumerate() {
            if let Some(local) = self.numbering.local(unknown) {
                fields.nodes.push(node);
                fields.displacement.push(in_space::<D>(&values[D * local..][..D]));
                fields.stress.push((sums[local].0 / sums[local].1).into());
            }
        }
        Ok(fields)
    }

    /// The held unknowns that this rank owns, as global row numbers.
    pub fn held(&self) -> Vec<i32> {
        let rows = |&unknown: &u32| {
            let (global, held) = (self.numbering.global[unknown as usize], self.cells.mesh.held[unknown as usize]);
            (0..D).filter(move |&component| held[component]).map(move |component| D as i32 * global + component as i32)
        };
        self.numbering.unknowns.iter().flat_map(rows).collect()
    }
}

/// The global rows of nodes, component by component.
pub fn rows_of<const D: usize>(nodes: impl Iterator<Item = i32>) -> Vec<i32> {
    nodes.flat_map(|node| (0..D as i32).map(move |component| D as i32 * node + component)).collect()
}

/// x, y, z of a vector in D dimensions; the plane is that of x and z.
fn in_space<const D: usize>(vector: &[f64]) -> [f64; 3] {
    match D {
        2 => [vector[0], 0.0, vector[1]],
        _ => [vector[0], vector[1], vector[2]],
    }
}

impl<const D: usize> Recovery<D> {
    fn new(mesh: &Mesh<D>, numbering: &Numbering, layout: &Vector) -> Result<Self> {
        let touches = |cell: &usize| mesh.cell_unknowns(*cell).corners().iter().any(|&u| numbering.local(u).is_some());
        let cells: Vec<usize> = (0..mesh.cells.len()).filter(touches).collect();
        let mut unknowns: Vec<u32> =
            cells.iter().flat_map(|&cell| mesh.cell_unknowns(cell).corners().to_vec()).collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        let mut place = vec![0; mesh.unknown_nodes()];
        for (i, &unknown) in unknowns.iter().enumerate() {
            place[unknown as usize] = i as u32;
        }
        let places = cells.iter().map(|&cell| mesh.cell_unknowns(cell).map(|u| place[u as usize])).collect();
        let indices = rows_of::<D>(unknowns.iter().map(|&unknown| numbering.global[unknown as usize]));
        Ok(Self { cells, places, gathered: indices.len(), gather: Gather::new(layout, &indices)? })
    }
}
