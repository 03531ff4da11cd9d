//! The result file is readable after a SIGKILL at any moment: a writer that does nothing but flush is killed again and
//! again.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::io::{Read, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use common::sample;
use libtest_mimic::{Arguments, Failed, Trial};
use mpjr::output::bulk::{self, Frame};
use mpjr::output::{FacePlan, HistoryRow, Plan, Recorder, reader::Results};

/// The argument that makes this executable the writer.
const WRITER: &str = "--writer";
/// Nodes of the contact face: rows longer than a page.
const FACE: usize = 700;

fn main() {
    let mut args = std::env::args().skip_while(|arg| arg != WRITER).skip(1);
    if let (Some(kind), Some(path)) = (args.next(), args.next()) {
        return write_without_end(&kind, Path::new(&path));
    }
    let trials = ["rows", "growth", "creation", "bulk"]
        .map(|kind| Trial::test(format!("killed_during_{kind}"), move || kills(kind)));
    libtest_mimic::run(&Arguments::from_args(), trials.into()).exit();
}

/// What is killed: `rows` has room for all its rows, `growth` must make room all the time, `creation` makes files,
/// `bulk` writes frames.
fn write_without_end(kind: &str, path: &Path) {
    if kind == "bulk" {
        return write_frames(path);
    }
    loop {
        let rows = if kind == "rows" { 100_000 } else { 1 };
        let plan = Plan {
            face: FacePlan::along_x((0..FACE).map(|node| node as f64).collect()),
            ..sample::plan(rows, usize::from(kind == "creation"))
        };
        let recorder = Recorder::create(path, &sample::metadata(), plan, &HistoryRow::default()).unwrap();
        let last = if kind == "creation" { 1 } else { 40_000 };
        for i in 1..=last {
            recorder.history(sample::row(i)).unwrap();
            recorder.interface(sample::frame(i, FACE)).unwrap();
            recorder.flush().unwrap();
            tick();
        }
    }
}

fn write_frames(path: &Path) {
    let universe = mpi::initialize().unwrap();
    let plan = sample::plan(4, 2);
    let nodes: Vec<usize> = (0..plan.bulk.as_ref().unwrap().coordinates.len() / 2).collect();
    let recorder = Recorder::create(path, &sample::metadata(), plan, &HistoryRow::default()).unwrap();
    for frame in 0..10_000 {
        let value = frame as f64;
        let (displacement, stress) = (vec![value; 2 * nodes.len()], vec![value; 4 * nodes.len()]);
        let temperature = &vec![value; nodes.len()];
        let frame = Frame { time: value, nodes: &nodes, displacement: &displacement, stress: &stress, temperature };
        bulk::write(&universe.world(), Some(&recorder), &frame).unwrap();
        tick();
    }
}

/// Tells the other process that one more write is done.
fn tick() {
    let mut out = std::io::stdout().lock();
    out.write_all(b".").and_then(|()| out.flush()).unwrap();
}

/// How often to kill, the most writes to wait for, and the longest wait after them, in microseconds.
fn rhythm(kind: &str) -> (u64, u64, u64) {
    match kind {
        "rows" => (80, 150, 300),
        "growth" => (30, 9, 5_000),
        "creation" => (30, 3, 10_000),
        // MPI takes its time to start.
        _ => (8, 40, 2_000),
    }
}

fn kills(kind: &str) -> Result<(), Failed> {
    let directory = tempfile::tempdir()?;
    let path = directory.path().join("run.h5");
    let (rounds, writes, wait) = rhythm(kind);
    let mut unequal = 0;
    for round in 0..rounds {
        // Every second round overwrites the file of the one before.
        if round % 2 == 0 {
            let _ = std::fs::remove_file(&path);
        }
        let mut writer = Command::new(std::env::current_exe()?)
            .args([WRITER, kind])
            .arg(&path)
            .envs([("OMPI_MCA_ess_singleton_isolated", "1"), ("OMPI_MCA_btl", "self")])
            .stdout(Stdio::piped())
            .spawn()?;
        // Primes, so that neither the number of writes nor the wait comes back soon.
        let mut ticks = vec![0; 1 + (round * 7_919 % writes) as usize];
        let ticked = writer.stdout.as_mut().map_or(Ok(()), |out| out.read_exact(&mut ticks));
        std::thread::sleep(Duration::from_micros(round * 104_729 % wait));
        writer.kill()?;
        writer.wait()?;
        ticked.map_err(|error| format!("round {round}: the writer failed: {error}"))?;
        let (rows, equal) = check(&path).map_err(|error| format!("round {round}: {error}"))?;
        if kind != "creation" && rows < ticks.len() {
            return Err(format!("round {round}: {rows} rows after {} flushes", ticks.len()).into());
        }
        unequal += u64::from(!equal);
        for entry in std::fs::read_dir(directory.path())? {
            let entry = entry?.path();
            if entry != path {
                std::fs::remove_file(entry)?;
            }
        }
    }
    eprintln!("{kind}: {unequal} of {rounds} files have a dataset ahead of another");
    Ok(())
}

/// The number of rows (of frames, where there are any), and whether all datasets have as many. Every row that `time` counts must be right.
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
    let (frames, mut equal) = if file.group("bulk").is_ok() { check_frames(&file)? } else { (0, true) };
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
    equal &= stored.is_empty() || stored.len() + 1 == rows;
    for (f, name) in sample::FIELDS.iter().enumerate() {
        let set = file.dataset(&format!("interface/{name}"))?;
        let values: Vec<f64> = set.read_raw()?;
        equal &= set.shape()[0] == stored.len();
        let wrong = |(at, value): (usize, &f64)| *value != (1000 * (f + 1) * (at / FACE + 1) + at % FACE) as f64;
        if set.shape()[0] < stored.len() || values.iter().enumerate().any(wrong) {
            return Err(format!("{name} has {:?} for {} times, or wrong rows", set.shape(), stored.len()).into());
        }
    }
    Ok((rows.max(frames), equal))
}

/// The number of frames, and whether all bulk datasets have as many; every row that `time` counts must be right.
fn check_frames(file: &hdf5::File) -> Result<(usize, bool), Box<dyn std::error::Error>> {
    let time: Vec<f64> = file.dataset("bulk/time")?.read_raw()?;
    let mut equal = true;
    for name in ["displacement", "stress"] {
        let set = file.dataset(&format!("bulk/{name}"))?;
        let (rows, values): (usize, Vec<f64>) = (set.shape()[0], set.read_raw()?);
        let row = set.shape()[1..].iter().product::<usize>();
        equal &= rows == time.len();
        if rows < time.len() || values.iter().enumerate().any(|(at, value)| *value != (at / row) as f64) {
            return Err(format!("{name} has {rows} rows for {} times, or wrong rows", time.len()).into());
        }
    }
    Ok((time.len(), equal))
}
