//! Which rank owns what: cells by graph partitioning, nodes by the cells around them.

use std::collections::HashMap;
use std::ops::Range;

use mpi::traits::{Communicator, CommunicatorCollectives};
use mpi::{datatype::PartitionMut, topology::SimpleCommunicator};

use super::Mesh;
use crate::error::Result;
use crate::petsc;

/// The global numbering of the unknowns: each rank's are contiguous.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbering {
    /// Global node number of each unknown of the mesh.
    pub global: Vec<i32>,
    /// Global node numbers that this rank owns.
    pub owned: Range<usize>,
    /// Cells that this rank assembles.
    pub cells: Vec<usize>,
    /// Unknowns that this rank owns, in the order of their global numbers.
    pub unknowns: Vec<u32>,
}

impl Numbering {
    /// Distributes the mesh over the ranks of `comm`.
    pub fn new<const D: usize>(comm: &SimpleCommunicator, mesh: &Mesh<D>) -> Result<Self> {
        let part = cell_parts(comm, mesh)?;
        let mut owner = vec![i32::MAX; mesh.unknown_nodes()];
        for (cell, &rank) in part.iter().enumerate() {
            for &unknown in mesh.cell_unknowns(cell).corners() {
                let entry = &mut owner[unknown as usize];
                *entry = rank.min(*entry);
            }
        }
        let ranks = comm.size() as usize;
        let mut starts = vec![0; ranks + 1];
        for &rank in &owner {
            starts[rank as usize + 1] += 1;
        }
        for rank in 0..ranks {
            starts[rank + 1] += starts[rank];
        }
        let me = comm.rank() as usize;
        let owned = starts[me]..starts[me + 1];
        let mut next = starts;
        let mut global = Vec::with_capacity(owner.len());
        for &rank in &owner {
            global.push(next[rank as usize] as i32);
            next[rank as usize] += 1;
        }
        let mine = |list: &[i32]| -> Vec<usize> { (0..list.len()).filter(|&i| list[i] as usize == me).collect() };
        let unknowns = mine(&owner).into_iter().map(|i| i as u32).collect();
        Ok(Self { global, owned, cells: mine(&part), unknowns })
    }

    /// The place of an unknown among those that this rank owns.
    pub fn local(&self, unknown: u32) -> Option<usize> {
        let global = self.global[unknown as usize] as usize;
        self.owned.contains(&global).then(|| global - self.owned.start)
    }

    /// The blocks of each row of this rank: itself and its neighbours, own columns and others.
    pub fn pattern<const D: usize>(&self, mesh: &Mesh<D>) -> petsc::Pattern {
        let mut neighbours: Vec<Vec<i32>> = vec![Vec::new(); self.owned.len()];
        for cell in 0..mesh.cells.len() {
            let cell = mesh.cell_unknowns(cell);
            let corners = || cell.corners().iter().map(|&unknown| self.global[unknown as usize]);
            for row in corners() {
                if self.owned.contains(&(row as usize)) {
                    neighbours[row as usize - self.owned.start].extend(corners());
                }
            }
        }
        let is_own = |column: &&i32| self.owned.contains(&(**column as usize));
        let (own, other) = neighbours
            .iter_mut()
            .map(|row| {
                row.sort_unstable();
                row.dedup();
                let own = row.iter().filter(is_own).count();
                (own as i32, (row.len() - own) as i32)
            })
            .unzip();
        petsc::Pattern { block: D, own, other }
    }
}

/// The part of every cell, on every rank.
fn cell_parts<const D: usize>(comm: &SimpleCommunicator, mesh: &Mesh<D>) -> Result<Vec<i32>> {
    let (ranks, total) = (comm.size() as usize, mesh.cells.len());
    if ranks == 1 {
        return Ok(vec![0; total]);
    }
    let start = |rank: usize| total * rank / ranks;
    let me = comm.rank() as usize;
    let mine = petsc::partition(comm, total, &neighbours(mesh, start(me)..start(me + 1)))?;
    let counts: Vec<i32> = (0..ranks).map(|rank| (start(rank + 1) - start(rank)) as i32).collect();
    let starts: Vec<i32> = (0..ranks).map(|rank| start(rank) as i32).collect();
    let mut parts = vec![0_i32; total];
    comm.all_gather_varcount_into(&mine[..], &mut PartitionMut::new(&mut parts[..], counts, &starts[..]));
    Ok(parts)
}

/// For each cell of the run, the cells that share a side with it.
fn neighbours<const D: usize>(mesh: &Mesh<D>, run: Range<usize>) -> Vec<Vec<i32>> {
    let sides = |cell: usize| {
        let sorted = |mut side: Vec<u32>| {
            side.sort_unstable();
            side
        };
        mesh.cell_unknowns(cell).sides().map(sorted).collect::<Vec<_>>()
    };
    let mut sharing: HashMap<Vec<u32>, Vec<i32>> = HashMap::new();
    for side in run.clone().flat_map(sides) {
        sharing.entry(side).or_default();
    }
    for cell in 0..mesh.cells.len() {
        for side in sides(cell) {
            if let Some(list) = sharing.get_mut(&side) {
                list.push(cell as i32);
            }
        }
    }
    run.map(|cell| {
        let mut list: Vec<i32> = sides(cell).iter().flat_map(|side| sharing[side].iter().copied()).collect();
        list.sort_unstable();
        list.dedup();
        list.retain(|&other| other as usize != cell);
        list
    })
    .collect()
}
