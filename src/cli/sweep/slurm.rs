//! The sbatch script of a sweep.

use std::path::Path;

use clap::{Args, ValueEnum};

/// What the script asks of Slurm.
#[derive(Args)]
pub struct Batch {
    /// With --slurm: the time of a case, as sbatch takes it
    #[arg(long, value_name = "TIME", default_value = "24:00:00", requires = "slurm", value_parser = word)]
    time: String,
    /// With --slurm: the memory of a case, as sbatch takes it, such as 8G [default: the cluster's]
    #[arg(long, value_name = "SIZE", requires = "slurm", value_parser = word)]
    mem: Option<String>,
    /// With --slurm: what starts the ranks of a case
    #[arg(long, value_enum, default_value_t = Launcher::Mpirun, requires = "slurm")]
    launcher: Launcher,
    /// With --slurm: cores for each rank
    #[arg(long, value_name = "N", requires = "slurm", value_parser = clap::value_parser!(u32).range(1..))]
    cpus: Option<u32>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Launcher {
    Mpirun,
    Srun,
}

/// A word of sbatch: what else it were would be a line of the script.
fn word(text: &str) -> Result<String, String> {
    let is_word = !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || ":-.".contains(c));
    is_word.then(|| text.to_owned()).ok_or_else(|| "must be letters, digits, colons, dots and hyphens".to_owned())
}

/// A job array with one task for each of `cases`, each on `ranks` ranks.
pub fn script(sweep: &Path, out: &Path, (cases, ranks): (usize, usize), batch: &Batch) -> String {
    let name = sweep.file_stem().unwrap_or_default().to_string_lossy();
    let program = std::env::current_exe().unwrap_or_else(|_| "mpjr".into());
    let last = cases.saturating_sub(1);
    let [program, sweep, out] = [program.as_path(), sweep, out].map(quoted);
    let mem = batch.mem.as_ref().map_or_else(String::new, |mem| format!("#SBATCH --mem={mem}\n"));
    let cpus = batch.cpus.map_or_else(String::new, |cpus| format!("#SBATCH --cpus-per-task={cpus}\n"));
    let time = &batch.time;
    // srun has the number of ranks from the job, and starts MPI's processes where it is told which MPI they are of.
    let launcher = match batch.launcher {
        Launcher::Mpirun => "mpirun -n \"$SLURM_NTASKS\"",
        Launcher::Srun => "srun --mpi=pmix",
    };
    format!(
        r#"#!/bin/sh
# Runs {cases} case(s). Submit it with sbatch; submit it again after a failure or a lost node: what is complete is left
# alone, what was stopped goes on. %K after the range limits how many cases run at once.
#SBATCH --job-name={}
#SBATCH --array=0-{last}
#SBATCH --ntasks={ranks}
#SBATCH --time={time}
{mem}{cpus}# Two minutes before the time is over the case writes a checkpoint and ends with exit code 5.
#SBATCH --signal=B:USR1@120
export OMP_NUM_THREADS=1
exec {launcher} {program} sweep {sweep} --out {out} --case "$SLURM_ARRAY_TASK_ID"
"#,
        name.replace(char::is_whitespace, "-")
    )
}

/// A path as a word of the shell.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.to_string_lossy().replace('\'', r"'\''"))
}
