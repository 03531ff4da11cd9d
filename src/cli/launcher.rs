//! Which of how many processes this one is, as far as whoever started it says so.

use std::path::PathBuf;

use crate::error::{Error, Result};

/// Where Open MPI, MPICH and its kin, and Slurm say which rank a process is.
const RANKS: [&str; 4] = ["OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"];

/// The rank of this process, as its launcher has it; none without one. Known without MPI.
fn rank() -> Option<String> {
    RANKS.iter().find_map(|name| std::env::var(name).ok())
}

/// Whether this process is alone or rank 0 of its launcher: known without MPI, so that what needs no solver starts none.
pub fn is_first_process() -> bool {
    rank().is_none_or(|rank| rank == "0")
}

/// The terminal that the standard output of this process's launcher is, if there is a launcher and it has one. The launcher is the
/// first ancestor whose output is another than this process's own, as shells that it started have the same.
pub fn terminal_of_launcher() -> Option<PathBuf> {
    const GENERATIONS: usize = 4;
    rank()?;
    let parent = |process: u32| -> Option<u32> {
        let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
        // After the name, which may hold anything: the state, then the parent.
        stat.rsplit(')').next()?.split_whitespace().nth(1)?.parse().ok()
    };
    let ancestors = std::iter::successors(Some(std::os::unix::process::parent_id()), |&process| parent(process));
    let output_of = |process: &str| std::fs::read_link(format!("/proc/{process}/fd/1")).ok();
    let own = output_of("self")?;
    let mut outputs = ancestors
        .take(GENERATIONS)
        .filter(|&process| process > 1)
        .filter_map(|process| output_of(&process.to_string()));
    let launchers = outputs.find(|output| *output != own)?;
    (launchers.starts_with("/dev/pts") || launchers.starts_with("/dev/tty")).then_some(launchers)
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
