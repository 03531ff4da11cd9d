//! Tests under `mpirun`: MPI cannot start twice in a process, so each test starts the same executable again on several
//! ranks, with an argument that names the body to run.

use std::path::Path;
use std::process::Command;

use libtest_mimic::{Arguments, Failed, Trial};

/// The argument before the name of the body.
const BODY: &str = "--mpi-body";

/// What every rank does, with the world communicator and a directory that the ranks share and no other case.
pub type Body = fn(&mpi::topology::SimpleCommunicator, &Path);

/// A test: its name, the ranks to run it on, and what every rank does.
pub struct Case {
    pub name: &'static str,
    pub ranks: &'static [usize],
    pub body: Body,
    /// The directory is a disk of so many bytes of its own.
    pub disk: Option<usize>,
    /// PETSc options, separated by spaces.
    pub petsc: &'static str,
}

impl Case {
    /// A case on the common disk.
    pub const fn new(name: &'static str, ranks: &'static [usize], body: Body) -> Self {
        Self { name, ranks, body, disk: None, petsc: "" }
    }
}

/// The `main` of a test with `harness = false`.
pub fn main(cases: &'static [Case]) {
    let mut args = std::env::args().skip_while(|arg| arg != BODY).skip(1);
    if let (Some(name), Some(directory)) = (args.next(), args.next()) {
        return run_body(cases, &name, Path::new(&directory));
    }
    let trials = cases
        .iter()
        .flat_map(|case| case.ranks.iter().map(move |&ranks| (case, ranks)))
        .map(|(case, ranks)| {
            Trial::test(format!("{}_on_{ranks}", case.name), move || launch(case, ranks))
                .with_ignored_flag(case.disk.is_some() && mounting().is_none())
        })
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

fn launch(case: &Case, ranks: usize) -> Result<(), Failed> {
    let directory = tempfile::tempdir()?;
    let mut command = mpirun(ranks);
    command.arg(std::env::current_exe()?).args([BODY, case.name]).arg(directory.path());
    if let (Some(size), Some(mut inside)) = (case.disk, mounting()) {
        let mount = format!("mount -t tmpfs -o size={size} tmpfs \"$0\" && exec \"$@\"");
        inside.args(["sh", "-c", &mount]).arg(directory.path());
        inside.arg(command.get_program()).args(command.get_args());
        inside.envs(command.get_envs().filter_map(|(key, value)| Some((key, value?))));
        command = inside;
    }
    let output = command.output()?;
    if output.status.success() {
        return Ok(());
    }
    let text = [output.stdout, output.stderr].concat();
    Err(format!("{} under mpirun:\n{}", output.status, String::from_utf8_lossy(&text)).into())
}

/// What a command that mounts a disk of its own is to be started by, if that is possible here.
pub fn mounting() -> Option<Command> {
    [&["--user", "--map-root-user", "--mount"][..], &["--mount"]].into_iter().find_map(|how| {
        let mut command = Command::new("unshare");
        let works = command.args(how).args(["sh", "-c", "mount -t tmpfs tmpfs /mnt"]).output();
        let mut command = Command::new("unshare");
        command.args(how);
        works.is_ok_and(|output| output.status.success()).then_some(command)
    })
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
