//! Which of how many processes this one is, as far as whoever started it says so.

use crate::error::{Error, Result};

/// Whether this process is alone or rank 0 of its launcher: known without MPI, so that what needs no solver starts none.
pub fn is_first_process() -> bool {
    ["OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"]
        .iter()
        .find_map(|name| std::env::var(name).ok())
        .is_none_or(|rank| rank == "0")
}

/// How many processes a launcher says that it started.
pub struct Launch(Option<(usize, &'static str)>);

impl Launch {
    /// To be asked before MPI starts, which sets such variables itself. The innermost launcher comes first: `mpirun -n 1`
    /// within a Slurm job of several tasks starts one process.
    pub fn announced() -> Self {
        const COUNTS: [(&str, &str); 5] = [
            ("OMPI_COMM_WORLD_SIZE", "Open MPI's mpirun"),
            ("PMI_SIZE", "the process manager (PMI)"),
            ("SLURM_STEP_NUM_TASKS", "Slurm's srun"),
            ("SLURM_NTASKS", "Slurm"),
            ("SLURM_NPROCS", "Slurm"),
        ];
        let count = |(name, launcher)| Some((std::env::var(name).ok()?.parse().ok()?, launcher));
        Self(COUNTS.into_iter().find_map(count))
    }

    /// Refuses processes that were to be several, where MPI has each of them alone: all of them would solve everything,
    /// into one file.
    pub fn refuse_if_split(&self, ranks: usize) -> Result<()> {
        match self.0 {
            Some((announced, launcher)) if announced > 1 && ranks == 1 => Err(Error::Usage(format!(
                "{launcher} has {announced} processes, but MPI sees each of them alone, and each would solve everything: \
                 start them with the mpirun of the MPI that mpjr was built with, or with srun --mpi=pmix; one process \
                 is mpirun -n 1 mpjr ..."
            ))),
            _ => Ok(()),
        }
    }
}
