//! The velocities of a curve shared over ranks.

use mpi::datatype::PartitionMut;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Root};

use super::{Sliding, State};
use crate::error::Result;
use crate::parallel::agree;

/// Numbers of a state beside its lists.
const SCALARS: usize = 8;

impl Sliding {
    /// The steady states at velocities, on rank 0, each rank having found those of a stretch of them. Collective.
    ///
    /// # Errors
    /// As for [`Sliding::states`], the same on all ranks.
    pub fn curve(&mut self, comm: &SimpleCommunicator, velocities: &[f64]) -> Result<Vec<State>> {
        let (ranks, rank) = (comm.size() as usize, comm.rank() as usize);
        let starts: Vec<usize> = (0..=ranks).map(|rank| rank * velocities.len() / ranks).collect();
        let mine = agree(comm, self.states(&velocities[starts[rank]..starts[rank + 1]]))?;
        let (arms, nodes, directions) = (self.times().len(), self.nodes(), self.directions());
        let length = SCALARS + arms + (2 + directions) * nodes;
        let numbers: Vec<f64> = mine.iter().flat_map(numbers).collect();
        let root = comm.process_at_rank(0);
        if rank != 0 {
            root.gather_varcount_into(&numbers[..]);
            return Ok(Vec::new());
        }
        let counts: Vec<i32> = starts.windows(2).map(|pair| ((pair[1] - pair[0]) * length) as i32).collect();
        let places: Vec<i32> = starts[..ranks].iter().map(|start| (start * length) as i32).collect();
        let mut all = vec![0.0; velocities.len() * length];
        root.gather_varcount_into_root(&numbers[..], &mut PartitionMut::new(&mut all[..], counts, places));
        Ok(all.chunks_exact(length).map(|numbers| state(numbers, arms, [nodes, directions])).collect())
    }
}

fn numbers(state: &State) -> Vec<f64> {
    let State { velocity, approach, normal_force, tangential_force, hysteretic_force, contact_fraction, .. } = *state;
    let [across, hysteretic_across] = state.across;
    let scalars = [
        velocity,
        approach,
        normal_force,
        tangential_force,
        hysteretic_force,
        contact_fraction,
        across,
        hysteretic_across,
    ];
    let lists = [&state.arm_dissipation, &state.pressure, &state.shear, &state.gap];
    scalars.into_iter().chain(lists.into_iter().flatten().copied()).collect()
}

fn state(numbers: &[f64], arms: usize, [nodes, directions]: [usize; 2]) -> State {
    let (scalars, lists) = numbers.split_at(SCALARS);
    let (arm_dissipation, fields) = lists.split_at(arms);
    let (pressure, fields) = fields.split_at(nodes);
    let (shear, gap) = fields.split_at(directions * nodes);
    State {
        velocity: scalars[0],
        approach: scalars[1],
        normal_force: scalars[2],
        tangential_force: scalars[3],
        hysteretic_force: scalars[4],
        contact_fraction: scalars[5],
        across: [scalars[6], scalars[7]],
        arm_dissipation: arm_dissipation.to_vec(),
        pressure: pressure.to_vec(),
        shear: shear.to_vec(),
        gap: gap.to_vec(),
    }
}
