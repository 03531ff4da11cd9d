//! The progress of a run: a bar on a terminal, alone and under launchers, within its width and without colours; lines elsewhere.
//! The terminal is that of util-linux's `script`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::process::Command;

use common::program::{Run, output_of};

const SLIDING: &str = include_str!("scenes/sliding.toml");

/// What a run on `ranks` prints on a terminal of 44 columns: `before` stands before the command, and `after` behind it.
fn on_a_terminal(ranks: usize, before: &str, after: &str) -> String {
    let run = Run::new(SLIDING).set("layer.cells=[8,8]").set("friction.regularisation=1e-6").ranks(ranks);
    let command = run.command();
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    let words: Vec<String> = words.map(|word| format!("'{}'", word.to_string_lossy())).collect();
    let line = format!("stty cols 44 rows 24; {before} {} {after}", words.join(" "));
    let mut script = Command::new("script");
    script.args(["--quiet", "--return", "--command", &line, "/dev/null"]).current_dir(run.directory());
    script.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
    // What tests themselves are started with.
    for name in ["NO_COLOR", "OMPI_COMM_WORLD_RANK", "PMI_RANK"] {
        script.env_remove(name);
    }
    output_of(&mut script)
}

/// Each drawing of the bar, without what moves the cursor.
fn drawings(printed: &str) -> Vec<String> {
    let mut plain = String::new();
    let mut rest = printed.chars();
    while let Some(one) = rest.next() {
        match one {
            // ESC [ numbers, a letter: the end of a drawing.
            '\x1b' => {
                rest.by_ref().find(|letter| letter.is_ascii_alphabetic());
                plain.push('\n');
            }
            '\r' => plain.push('\n'),
            one => plain.push(one),
        }
    }
    plain.lines().filter(|line| line.contains(" left")).map(|line| line.trim_end().to_owned()).collect()
}

fn assert_bar(ranks: usize, before: &str) {
    let printed = on_a_terminal(ranks, before, "");
    let bars = drawings(&printed);
    let widest = bars.iter().map(|bar| bar.chars().count()).max();
    assert!(widest.is_some_and(|width| width <= 44), "{before} on {ranks}: {bars:#?}\n{printed:?}");
    // Select Graphic Rendition, which colours are, ends with an m.
    let coloured = printed.split('\x1b').skip(1).any(|code| {
        code.trim_start_matches(['[', ';'])
            .trim_start_matches(|c: char| c.is_ascii_digit() || c == ';')
            .starts_with('m')
    });
    assert!(!coloured, "{before} on {ranks}: {printed:?}");
    assert!(!printed.contains("Newton\r\n"), "{before} on {ranks}: lines beside the bar: {printed:?}");
}

fn assert_lines(ranks: usize, before: &str) {
    let printed = on_a_terminal(ranks, before, "2>&1 | cat");
    assert!(drawings(&printed).is_empty(), "{before} on {ranks}: {printed:?}");
    // One at the end of each of the two phases, and no more in a run of less than five seconds.
    assert_eq!(printed.matches(" Newton\r\n").count(), 2, "{before} on {ranks}: {printed:?}");
}

/// Alone, with and without `NO_COLOR`.
#[test]
fn a_bar_on_a_terminal() {
    assert_bar(1, "");
    assert_bar(1, "NO_COLOR=1");
}

/// Open MPI's mpirun gives its ranks a pseudo-terminal of no size, whatever its own output is.
#[test]
fn a_bar_under_open_mpi() {
    assert_bar(2, "");
    assert_lines(2, "");
}

/// MPICH's mpiexec and Slurm's srun hand on what their processes write into pipes; `srun --pty` gives them its terminal. They
/// are known by the variables that they set.
#[test]
fn lines_under_launchers_with_pipes() {
    for launcher in ["PMI_RANK=0 PMI_SIZE=1", "SLURM_PROCID=0 SLURM_STEP_NUM_TASKS=1", "PMIX_RANK=0"] {
        assert_lines(1, launcher);
    }
    assert_bar(1, "SLURM_PROCID=0 SLURM_STEP_NUM_TASKS=1");
}
