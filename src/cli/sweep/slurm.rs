//! The sbatch script of a sweep.

use std::path::Path;

/// A job array with one task for each of `cases`, each on `ranks` ranks.
pub fn script(sweep: &Path, out: &Path, cases: usize, ranks: usize) -> String {
    let name = sweep.file_stem().unwrap_or_default().to_string_lossy();
    let program = std::env::current_exe().unwrap_or_else(|_| "mpjr".into());
    let last = cases.saturating_sub(1);
    let [program, sweep, out] = [program.as_path(), sweep, out].map(quoted);
    format!(
        r#"#!/bin/sh
# Runs {cases} case(s). Submit it with sbatch; submit it again after a failure or a lost node: what is complete is left
# alone, what was stopped goes on. %K after the range limits how many cases run at once.
#SBATCH --job-name={}
#SBATCH --array=0-{last}
#SBATCH --ntasks={ranks}
#SBATCH --time=24:00:00
# Two minutes before the time is over the case writes a checkpoint and ends with exit code 5.
#SBATCH --signal=B:USR1@120
export OMP_NUM_THREADS=1
exec mpirun -n "$SLURM_NTASKS" {program} sweep {sweep} --out {out} --case "$SLURM_ARRAY_TASK_ID"
"#,
        name.replace(char::is_whitespace, "-")
    )
}

/// A path as a word of the shell.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.to_string_lossy().replace('\'', r"'\''"))
}
