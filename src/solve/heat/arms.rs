//! What the arms dissipate, cell by cell: the same losses as those of the energy ledger (crate::bulk::springs), which sums them.
//!
//! ```text
//! over a step, in a cell:  sum over arms and moduli of M mu_i (held z_i'K z_i + 2 mixed z_i'K du + fresh du'K du)
//! ```
//!
//! with K the cell's deviatoric or volumetric stiffness and M its modulus. The elongations z_i of the whole body are kept here, by
//! the same recursion as everywhere, because a body that follows its face, or that is known as waves, has none at its nodes.

use mpi::collective::SystemOperation;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Root};
use nalgebra::SVector;

use crate::error::Result;
use crate::rheology::{Factors, Losses};
use crate::snapshot::Snapshot;
use crate::solve::BulkFields;
use crate::solve::body::{Cells, Solid};
use crate::solve::kinds::{Kinds, lost};
use crate::solve::response::Relaxations;

/// The arms of the body at an accepted state, on rank 0.
pub struct ArmHeat<const D: usize> {
    cells: Cells<D>,
    kinds: Kinds<D>,
    relaxations: Relaxations,
    /// Displacements, and elongations of each arm, of each unknown, m.
    u: Vec<SVector<f64, D>>,
    elongations: Vec<Vec<SVector<f64, D>>>,
}

impl<const D: usize> ArmHeat<D> {
    /// At rest.
    pub fn new(solid: &Solid<D>, relaxations: Relaxations) -> Self {
        let (cells, kinds) = Kinds::of(solid);
        let field = vec![SVector::zeros(); cells.mesh.unknown_nodes()];
        let elongations = relaxations.times.iter().map(|_| field.clone()).collect();
        Self { cells, kinds, relaxations, u: field, elongations }
    }

    /// Takes the arms to the end of a step of length `dt` that ends at the displacements `new`; what each unknown's share of the cells
    /// around it dissipated, J/m (J in space).
    pub fn spend(&mut self, dt: f64, new: Vec<SVector<f64, D>>) -> Vec<f64> {
        let Relaxations { times, rule, .. } = &self.relaxations;
        let steps: Vec<(Factors, Losses)> =
            times.iter().map(|time| (rule.factors(dt / time), rule.losses(dt / time))).collect();
        let change: Vec<SVector<f64, D>> = new.iter().zip(&self.u).map(|(new, old)| new - old).collect();
        let mut heat = vec![0.0; new.len()];
        for cell in 0..self.cells.mesh.cells.len() {
            let unknowns = self.cells.mesh.cell_unknowns(cell);
            let lost = self.lost(cell, unknowns.corners(), &change, &steps);
            for (&unknown, share) in unknowns.corners().iter().zip(self.kinds.shares(cell)) {
                heat[unknown as usize] += lost * share;
            }
        }
        for (elongation, (Factors { decay, gain }, _)) in self.elongations.iter_mut().zip(&steps) {
            elongation.iter_mut().zip(&change).for_each(|(z, du)| *z = *z * *decay + du * *gain);
        }
        self.u = new;
        heat
    }

    /// What a cell dissipated, J/m.
    fn lost(&self, cell: usize, corners: &[u32], change: &[SVector<f64, D>], steps: &[(Factors, Losses)]) -> f64 {
        let region = self.cells.region(cell);
        let split = self.kinds.split(cell);
        let of = |field: &[SVector<f64, D>]| -> Vec<SVector<f64, D>> {
            corners.iter().map(|&at| field[at as usize]).collect()
        };
        let du = of(change);
        let parts = [
            (region.moduli.shear, region.shear_part, &split.deviatoric),
            (region.moduli.bulk, region.bulk_part, &split.volumetric),
        ];
        let elongations = || self.elongations.iter().map(|elongation| of(elongation));
        let on = |(modulus, part, stiffness): (f64, usize, &Vec<_>)| match &self.relaxations.series[part] {
            Some(series) => modulus * lost((series, stiffness), elongations(), &du, steps),
            None => 0.0,
        };
        parts.map(on).iter().sum()
    }

    /// Adds the state to a snapshot.
    pub fn save(&self, snapshot: &mut Snapshot) {
        let flat = |field: &[SVector<f64, D>]| field.iter().flatten().copied().collect();
        snapshot.put("heat-displacement", flat(&self.u));
        for (index, elongation) in self.elongations.iter().enumerate() {
            snapshot.put(format!("heat-arm-{index}"), flat(elongation));
        }
    }

    /// Takes it from there.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let names =
            std::iter::once("heat-displacement".to_owned()).chain((0..).map(|index| format!("heat-arm-{index}")));
        for (name, field) in names.zip(std::iter::once(&mut self.u).chain(&mut self.elongations)) {
            let mut flat = vec![0.0; D * field.len()];
            snapshot.fill(&name, &mut flat)?;
            field.iter_mut().zip(flat.chunks_exact(D)).for_each(|(place, values)| place.copy_from_slice(values));
        }
        Ok(())
    }
}

/// The displacement of each unknown, m, on rank 0, of fields that the ranks have of their own nodes; `unknown` is that of each node of
/// the mesh. Collective.
pub fn gathered<const D: usize>(
    comm: &SimpleCommunicator,
    fields: &BulkFields,
    (unknown, count): (&[u32], usize),
) -> Vec<SVector<f64, D>> {
    let mut mine = vec![0.0; D * count];
    for (&node, u) in fields.nodes.iter().zip(&fields.displacement) {
        let place = &mut mine[D * (unknown[node] as usize)..][..D];
        // The plane is that of x and z.
        place.iter_mut().enumerate().for_each(|(i, place)| *place = u[if i + 1 < D { i } else { 2 }]);
    }
    let root = comm.process_at_rank(0);
    if comm.rank() != 0 {
        // No unknown is of two ranks: a sum is what the one has.
        root.reduce_into(&mine[..], SystemOperation::sum());
        return Vec::new();
    }
    let mut all = vec![0.0; mine.len()];
    root.reduce_into_root(&mine[..], &mut all[..], SystemOperation::sum());
    all.chunks_exact(D).map(SVector::from_column_slice).collect()
}
