//! Bulk fields, written by 1 to 4 ranks into the same file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use std::path::Path;

use common::mpi::Case;
use common::sample;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives};
use mpjr::output::bulk::{self, Frame};
use mpjr::output::{HistoryRow, Plan, Recorder, Status, reader::Results};

const CASES: &[Case] = &[
    Case::new("frames_do_not_depend_on_ranks", &[1, 2, 3, 4], frames_do_not_depend_on_ranks),
    Case::new("errors_reach_every_rank", &[1, 2, 3], errors_reach_every_rank),
    Case { disk: Some(3 << 20), ..Case::new("a_full_disk_loses_no_frame", &[1, 2, 4], a_full_disk_loses_no_frame) },
];

fn main() {
    common::mpi::main(CASES);
}

fn displacement(frame: usize, node: usize) -> [f64; 2] {
    [frame as f64 + node as f64 / 1e3, -(node as f64)]
}

fn stress(frame: usize, node: usize) -> [f64; 4] {
    [1.0, 2.0, 3.0, 4.0].map(|component| component * 1e6 + 1e3 * frame as f64 + node as f64)
}

/// What `rank` of `ranks` holds of a mesh: nodes dealt out like cards, in falling order, and every fifth node also on
/// rank 0.
fn part(rank: usize, ranks: usize, nodes: usize) -> Vec<usize> {
    (0..nodes).rev().filter(|node| node % ranks == rank || (rank == 0 && node % 5 == 0)).collect()
}

fn write(
    world: &SimpleCommunicator,
    recorder: Option<&Recorder>,
    frame: usize,
    nodes: &[usize],
) -> mpjr::error::Result<()> {
    let displacement: Vec<_> = nodes.iter().flat_map(|&node| displacement(frame, node)).collect();
    let stress: Vec<_> = nodes.iter().flat_map(|&node| stress(frame, node)).collect();
    let temperature: Vec<_> = nodes.iter().map(|&node| 293.0 + node as f64).collect();
    let (time, displacement, stress) = (frame as f64, &displacement[..], &stress[..]);
    bulk::write(world, recorder, &Frame { time, nodes, displacement, stress, temperature: &temperature })
}

/// A mesh large enough that two ranks or more write it.
fn plan(frames: usize) -> Plan {
    Plan { bulk: Some(sample::mesh(150, 100, frames)), ..sample::plan(4, 0) }
}

fn create(world: &SimpleCommunicator, path: &Path, frames: usize) -> Option<Recorder> {
    let create = || Recorder::create(path, &sample::metadata(), plan(frames), &HistoryRow::default()).unwrap();
    (world.rank() == 0).then(create)
}

/// Three frames where two were planned, between rows of the history.
fn frames_do_not_depend_on_ranks(world: &SimpleCommunicator, directory: &Path) {
    let path = directory.join("run.h5");
    let recorder = create(world, &path, 2);
    let nodes = plan(2).bulk.unwrap().coordinates.len() / 2;
    let mine = part(world.rank() as usize, world.size() as usize, nodes);
    for frame in 0..3 {
        if let Some(recorder) = &recorder {
            recorder.history(sample::row(2 * frame + 1)).unwrap();
        }
        write(world, recorder.as_ref(), frame, &mine).unwrap();
        if let Some(recorder) = &recorder {
            // The rows before a frame are in the file with it.
            let results = Results::open(&path).unwrap();
            assert_eq!(results.bulk("stress").unwrap().rows, frame + 1);
            assert_eq!(results.history("time").unwrap().last(), Some(&(2.0 * frame as f64 + 1.0)));
            recorder.history(sample::row(2 * frame + 2)).unwrap();
        }
    }
    if let Some(recorder) = recorder {
        recorder.finish(Status::NotConverged).unwrap();
        let results = Results::open(&path).unwrap();
        assert_eq!(results.text("status").unwrap(), "not converged");
        assert_eq!(results.history("time").unwrap(), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(results.bulk("time").unwrap().values, [0.0, 1.0, 2.0]);
        let (u, s) = (results.bulk("displacement").unwrap(), results.bulk("stress").unwrap());
        assert_eq!((u.rows, u.columns, s.columns), (3, nodes * 2, nodes * 4));
        for frame in 0..3 {
            let expected: Vec<f64> = (0..nodes).flat_map(|node| displacement(frame, node)).collect();
            assert_eq!(u.row(frame), expected);
            let expected: Vec<f64> = (0..nodes).flat_map(|node| stress(frame, node)).collect();
            assert_eq!(s.row(frame), expected);
        }
        let xdmf = std::fs::read_to_string(directory.join("run.xdmf")).unwrap();
        assert_eq!(xdmf.matches("<Time ").count(), 3);
        assert_eq!(std::fs::read_dir(directory).unwrap().count(), 2);
    }
    world.barrier();
}

/// Wrong parts, a missing node and a file that went away are errors on every rank, the same ones, and nothing hangs.
fn errors_reach_every_rank(world: &SimpleCommunicator, directory: &Path) {
    let path = directory.join("run.h5");
    let recorder = create(world, &path, 2);
    let (rank, ranks) = (world.rank() as usize, world.size() as usize);
    let nodes = plan(2).bulk.unwrap().coordinates.len() / 2;
    let complete = part(rank, ranks, nodes);

    let mut outside = complete.clone();
    if rank == ranks - 1 {
        outside.push(nodes);
    }
    let message = write(world, recorder.as_ref(), 0, &outside).unwrap_err().to_string();
    assert!(message.contains(&format!("node {nodes} of {nodes}")), "{message}");

    let missing: Vec<usize> = complete.iter().copied().filter(|&node| node != 7).collect();
    let message = write(world, recorder.as_ref(), 0, &missing).unwrap_err().to_string();
    assert!(message.contains("node 7"), "{message}");

    write(world, recorder.as_ref(), 0, &complete).unwrap();
    world.barrier();
    if rank == 0 {
        std::fs::remove_file(&path).unwrap();
    }
    world.barrier();
    let error = write(world, recorder.as_ref(), 1, &complete).unwrap_err();
    assert_eq!(error.exit_code(), 4);
}

/// Frames until the disk is full: the error is the same on all ranks, what was told to be written is there, and a new
/// file is refused without a trace.
fn a_full_disk_loses_no_frame(world: &SimpleCommunicator, directory: &Path) {
    let path = directory.join("run.h5");
    let recorder = create(world, &path, 10);
    let nodes = plan(10).bulk.unwrap().coordinates.len() / 2;
    let mine = part(world.rank() as usize, world.size() as usize, nodes);
    let (written, error) = (0..10)
        .find_map(|frame| write(world, recorder.as_ref(), frame, &mine).err().map(|error| (frame, error)))
        .expect("ten frames do not fit");
    assert_eq!(error.exit_code(), 4);
    assert!(error.to_string().contains("No space left") && error.to_string().contains("--out"), "{error}");
    world.barrier();
    if let Some(recorder) = recorder {
        // Rows need no new block here, or fail the same way.
        let _ = recorder.history(sample::row(1)).and_then(|()| recorder.flush());
        let results = Results::open(&path).unwrap();
        assert!(written > 0);
        let (u, s) = (results.bulk("displacement").unwrap(), results.bulk("stress").unwrap());
        assert_eq!((u.rows, s.rows), (written, written));
        for frame in 0..written {
            assert!(u.row(frame).iter().copied().eq((0..nodes).flat_map(|node| displacement(frame, node))));
            assert!(s.row(frame).iter().copied().eq((0..nodes).flat_map(|node| stress(frame, node))));
        }
        // Fill the last blocks.
        let _ = std::fs::write(directory.join("rest"), vec![1; 3 << 20]);
        let other = directory.join("other.h5");
        let error = Recorder::create(&other, &sample::metadata(), plan(1), &HistoryRow::default()).unwrap_err();
        assert_eq!(error.exit_code(), 4);
        assert!(error.to_string().ends_with("No space left on device"), "{error}");
        let mut left: Vec<_> = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        left.sort();
        assert_eq!(left, ["rest", "run.h5", "run.xdmf"]);
    }
    world.barrier();
}
