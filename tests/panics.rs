//! A panic, which is always a defect, ends all ranks with a message, whatever the others wait for.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use std::time::{Duration, Instant};

use libtest_mimic::{Arguments, Trial};
use mpi::traits::{Communicator, CommunicatorCollectives};

use common::mpi::mpirun;

/// As what the test itself starts is called.
const PANICKING: &str = "--panicking";

fn main() {
    if std::env::args().nth(1).as_deref() == Some(PANICKING) {
        return panicking();
    }
    let trial = Trial::test("a_panic_ends_all_ranks", || {
        all_are_ended();
        Ok(())
    });
    libtest_mimic::run(&Arguments::from_args(), vec![trial]).exit();
}

/// Rank 1 panics; the other one waits for it.
fn panicking() {
    mpjr::cli::end_on_panic();
    let session = mpjr::petsc::Session::start(&[]).unwrap();
    let world = session.world();
    assert!(world.rank() != 1, "on purpose");
    world.barrier();
}

fn all_are_ended() {
    let begun = Instant::now();
    let output = mpirun(2).arg(std::env::current_exe().unwrap()).arg(PANICKING).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("mpjr: a defect of this program") && said.contains("on purpose"), "{said}");
    assert!(begun.elapsed() < Duration::from_secs(60));
}
