//! `mpjr verify --quick` agrees with the oracle, on one rank and on two, and prints its table once.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

fn table(ranks: usize) -> String {
    let output = common::mpi::mpirun(ranks)
        .arg(env!("CARGO_BIN_EXE_mpjr"))
        .args(["verify", "--quick"])
        .env("OMP_NUM_THREADS", "1")
        .output()
        .unwrap();
    let (text, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{text}\n{errors}");
    text.into_owned()
}

#[test]
fn quick_passes_on_one_and_two_ranks() {
    for ranks in [1, 2] {
        let text = table(ranks);
        assert_eq!(text.matches(" passed, 0 failed").count(), 1, "{text}");
        assert!(text.lines().filter(|line| line.contains("  pass  ")).count() > 75, "{text}");
        assert!(!text.contains("FAIL"), "{text}");
    }
}
