//! The result file is readable after a SIGKILL at any moment: a writer that does nothing but flush is killed again and
//! again.

mod common;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use common::sample;
use libtest_mimic::{Arguments, Failed, Trial};
use mpjr::output::{HistoryRow, Plan, Recorder, reader::Results};

/// The argument that makes this executable the writer.
const WRITER: &str = "--writer";
/// Nodes of the contact face: rows longer than a page.
const FACE: usize = 700;
/// Kills of each kind.
const ROUNDS: u64 = 60;

fn main() {
    let mut args = std::env::args().skip_while(|arg| arg != WRITER).skip(1);
    if let (Some(kind), Some(path)) = (args.next(), args.next()) {
        return write_without_end(&kind, Path::new(&path));
    }
    let trials =
        ["rows", "growth", "creation"].map(|kind| Trial::test(format!("killed_during_{kind}"), move || kills(kind)));
    libtest_mimic::run(&Arguments::from_args(), trials.into()).exit();
}

/// What is killed: `rows` has room for all its rows, `growth` must make room all the time, `creation` makes files.
fn write_without_end(kind: &str, path: &Path) {
    loop {
        let rows = if kind == "rows" { 100_000 } else { 1 };
        let plan = Plan {
            interface_x: (0..FACE).map(|node| node as f64).collect(),
            ..sample::plan(rows, usize::from(kind == "creation"))
        };
        let recorder = Recorder::create(path, &sample::metadata(), plan, &HistoryRow::default()).unwrap();
        let last = if kind == "creation" { 1 } else { 40_000 };
        for i in 1..=last {
            recorder.history(sample::row(i)).unwrap();
            recorder.interface(sample::frame(i, FACE)).unwrap();
            recorder.flush().unwrap();
        }
    }
}

fn kills(kind: &str) -> Result<(), Failed> {
    let directory = tempfile::tempdir()?;
    let path = directory.path().join("run.h5");
    let (mut unequal, mut longest) = (0, 0);
    for round in 0..ROUNDS {
        // Every second round overwrites the file of the one before.
        if round % 2 == 0 {
            let _ = std::fs::remove_file(&path);
        }
        let existed = path.exists();
        let mut writer = Command::new(std::env::current_exe()?)
            .args([WRITER, kind])
            .arg(&path)
            .stdout(Stdio::null())
            .stderr(Stdio::inherit())
            .spawn()?;
        let begun = Instant::now();
        while !path.exists() && begun.elapsed() < Duration::from_secs(10) {
            std::thread::yield_now();
        }
        // Steps that share no factor with the writer's rhythm.
        std::thread::sleep(Duration::from_micros(if existed { 3_000 } else { 0 } + round * 1_237 % 30_000));
        writer.kill()?;
        writer.wait()?;
        let (rows, equal) = check(&path).map_err(|error| format!("round {round}: {error}"))?;
        longest = longest.max(rows);
        unequal += usize::from(!equal);
        for entry in std::fs::read_dir(directory.path())? {
            let entry = entry?.path();
            if entry != path {
                std::fs::remove_file(entry)?;
            }
        }
    }
    eprintln!("{kind}: up to {longest} rows, {unequal} of {ROUNDS} files with a dataset ahead of another");
    let least = match kind {
        "rows" => 50,
        "growth" => 3,
        _ => 1,
    };
    if longest < least {
        return Err(format!("the longest file had {longest} rows: nothing was tried").into());
    }
    Ok(())
}

/// The number of rows, and whether all datasets have as many. Every row that `time` counts must be right.
fn check(path: &Path) -> Result<(usize, bool), Box<dyn std::error::Error>> {
    let results = Results::open(path)?;
    if results.text("status")? != "stopped" {
        return Err("status".into());
    }
    let file = hdf5::File::open(path)?;
    let time: Vec<f64> = file.dataset("history/time")?.read_raw()?;
    let rows = time.len();
    if rows == 0 || (0..rows).any(|i| time[i] != i as f64) {
        return Err(format!("times {time:?}").into());
    }
    let mut equal = true;
    for (name, factor) in sample::COLUMNS {
        let column: Vec<f64> = file.dataset(&format!("history/{name}"))?.read_raw()?;
        equal &= column.len() == rows;
        if column.len() < rows || column.iter().enumerate().any(|(i, value)| *value != factor * i as f64) {
            return Err(format!("{name} has {} rows of {rows}, or wrong ones", column.len()).into());
        }
    }
    let stored: Vec<f64> = file.dataset("interface/time")?.read_raw()?;
    if stored.iter().enumerate().any(|(k, time)| *time != (k + 1) as f64) {
        return Err("interface times".into());
    }
    equal &= stored.len() + 1 == rows;
    for (f, name) in sample::FIELDS.iter().enumerate() {
        let set = file.dataset(&format!("interface/{name}"))?;
        let values: Vec<f64> = set.read_raw()?;
        equal &= set.shape()[0] == stored.len();
        let wrong = |(at, value): (usize, &f64)| *value != (1000 * (f + 1) * (at / FACE + 1) + at % FACE) as f64;
        if set.shape()[0] < stored.len() || values.iter().enumerate().any(wrong) {
            return Err(format!("{name} has {:?} for {} times, or wrong rows", set.shape(), stored.len()).into());
        }
    }
    Ok((rows, equal))
}
