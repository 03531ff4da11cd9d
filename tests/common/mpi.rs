//! Tests under `mpirun`: MPI cannot start twice in a process, so each test starts the same executable again on several
//! ranks, with an argument that names the body to run.

use std::path::Path;
use std::process::Command;

use libtest_mimic::{Arguments, Failed, Trial};

/// The argument before the name of the body.
const BODY: &str = "--mpi-body";

/// A test: its name, the ranks to run it on, PETSc options separated by spaces, and what every rank does.
pub struct Case {
    pub name: &'static str,
    pub ranks: &'static [usize],
    pub petsc: &'static str,
    pub body: fn(&mpi::topology::SimpleCommunicator, &Path),
}

/// The `main` of a test with `harness = false`. Each body gets the world communicator and a directory that its ranks
/// share and no other case.
pub fn main(cases: &'static [Case]) {
    let mut args = std::env::args().skip_while(|arg| arg != BODY).skip(1);
    if let (Some(name), Some(directory)) = (args.next(), args.next()) {
        return run_body(cases, &name, Path::new(&directory));
    }
    let trials = cases
        .iter()
        .flat_map(|case| case.ranks.iter().map(move |&ranks| (case, ranks)))
        .map(|(case, ranks)| Trial::test(format!("{}_on_{ranks}", case.name), move || launch(case.name, ranks)))
        .collect();
    // Two cores: the ranks of one case are enough at a time.
    let arguments = Arguments { test_threads: Some(1), ..Arguments::from_args() };
    libtest_mimic::run(&arguments, trials).exit();
}

fn run_body(cases: &[Case], name: &str, directory: &Path) {
    let case = cases.iter().find(|case| case.name == name).unwrap();
    let options: Vec<String> = case.petsc.split_whitespace().map(str::to_owned).collect();
    let session = mpjr::petsc::Session::start(&options).unwrap();
    let world = session.world();
    // A panic on one rank must end the others too: mpirun sees to that when a process aborts.
    if std::panic::catch_unwind(|| (case.body)(&world, directory)).is_err() {
        std::process::abort();
    }
}

fn launch(name: &str, ranks: usize) -> Result<(), Failed> {
    let directory = tempfile::tempdir()?;
    let output = mpirun(ranks).arg(std::env::current_exe()?).args([BODY, name]).arg(directory.path()).output()?;
    if output.status.success() {
        return Ok(());
    }
    let text = [output.stdout, output.stderr].concat();
    Err(format!("{} under mpirun:\n{}", output.status, String::from_utf8_lossy(&text)).into())
}

/// `mpirun -n RANKS` with what containers, root and few cores need.
pub fn mpirun(ranks: usize) -> Command {
    let mut command = Command::new("mpirun");
    command
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .env("OMPI_MCA_rmaps_base_oversubscribe", "1")
        // Ranks that wait leave the core to those that do not.
        .env("OMPI_MCA_mpi_yield_when_idle", "1")
        .env("OMPI_MCA_hwloc_base_binding_policy", "none")
        .args(["-n", &ranks.to_string()]);
    command
}
