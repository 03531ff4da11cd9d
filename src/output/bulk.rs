//! Bulk fields, written collectively in two phases: values go to the rank that holds their block of nodes, then the
//! ranks write their blocks, all at once. The order of nodes in the file is that of the mesh, whatever the number of
//! ranks.
//!
//! The second phase is a positioned write and not `MPI_File_write_at_all` (which a collective `H5Dwrite` ends in): on
//! a full disk Open MPI 4.1 reports success and a full count to three ranks or more while data are lost. Here every
//! rank sees what became of its own write.

use std::ffi::OsStr;
use std::fs::OpenOptions;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::sync::MutexGuard;

use mpi::Count;
use mpi::collective::SystemOperation;
use mpi::datatype::{Partition, PartitionMut};
use mpi::traits::{Communicator, CommunicatorCollectives, Equivalence};

use super::columns;
use super::state::{State, bytes};
use super::store::{Table, failed, place};
use super::{Recorder, xdmf};
use crate::checksum::row_sum;
use crate::error::{Error, Result};
use crate::parallel::{agree, broadcast};

/// A rank writes at least so many bytes, or nothing: many small writes to one file get in each other's way.
const LEAST_BYTES: usize = 1 << 18;

/// One rank's part of the fields. Each node of the mesh must be given by at least one rank; where several ranks give
/// it, one of them counts.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// Time, s.
    pub time: f64,
    /// Indices into [`BulkPlan::coordinates`](super::BulkPlan::coordinates), in any order.
    pub nodes: &'a [usize],
    /// Displacement of these nodes, m, node after node: x, z (or x, y, z).
    pub displacement: &'a [f64],
    /// Stress at these nodes, Pa, tension positive: xx, zz, yy, xz (or xx, yy, zz, xy, yz, xz).
    pub stress: &'a [f64],
    /// Temperature of these nodes, K; nothing where it is not modelled.
    pub temperature: &'a [f64],
}

impl<'a> Frame<'a> {
    /// Its fields, in the order of the file.
    fn fields(&self) -> [&'a [f64]; 3] {
        [self.displacement, self.stress, self.temperature]
    }
}

/// Where a frame goes; known to the recorder's rank and told to the others.
struct Target {
    path: PathBuf,
    nodes: usize,
    /// Numbers of a node in each field.
    widths: Vec<usize>,
    /// The number of the frame.
    row: usize,
    /// Where each field of the frame begins in the file.
    at: Vec<u64>,
}

/// Adds a frame to `/bulk` and brings the XDMF file up to date. Collective; rank 0 of `comm` gives the recorder.
/// Rows of the history that wait are written first. All ranks return the same outcome.
pub fn write<C>(comm: &C, recorder: Option<&Recorder>, frame: &Frame) -> Result<()>
where
    C: Communicator + CommunicatorCollectives,
{
    let mut held = recorder.filter(|_| comm.rank() == 0).map(Recorder::lock);
    let target = announce(comm, held.as_mut())?;
    let block = agree(comm, check(frame, &target)).map(|()| redistribute(comm, frame, &target))?;
    let block = agree(comm, block)?;
    let written = write_block(&target, &block).map_err(|error| failed(&target.path, error));
    let mine = agree(comm, written)?;
    let mut sum = 0;
    comm.all_reduce_into(&mine, &mut sum, SystemOperation::sum());
    agree(comm, held.as_mut().map_or(Ok(()), |state| commit(state, frame.time, sum)))
}

/// Makes room for a frame and tells all ranks where it is.
fn announce<C>(comm: &C, held: Option<&mut MutexGuard<State>>) -> Result<Target>
where
    C: Communicator + CommunicatorCollectives,
{
    let mine = match held {
        Some(state) => reserve(state),
        None if comm.rank() == 0 => Err(Error::Internal("bulk fields without a recorder on rank 0".into())),
        None => Ok(Target { path: PathBuf::new(), nodes: 0, widths: Vec::new(), row: 0, at: Vec::new() }),
    };
    let mine = agree(comm, mine)?;
    let mut path = mine.path.as_os_str().as_bytes().to_vec();
    broadcast(comm, 0, &mut path);
    let widths = mine.widths.iter().map(|width| *width as u64);
    let numbers = [mine.nodes as u64, mine.row as u64].into_iter().chain(widths).chain(mine.at);
    let mut bytes: Vec<u8> = numbers.flat_map(u64::to_ne_bytes).collect();
    broadcast(comm, 0, &mut bytes);
    let numbers: Vec<u64> = bytes.as_chunks().0.iter().map(|bytes| u64::from_ne_bytes(*bytes)).collect();
    let number = |index: usize| numbers.get(index).map_or(0, |number| *number as usize);
    let (widths, at) = numbers.get(2..).unwrap_or_default().split_at(numbers.len().saturating_sub(2) / 2);
    Ok(Target {
        path: Path::new(OsStr::from_bytes(&path)).to_owned(),
        nodes: number(0),
        widths: widths.iter().map(|width| *width as usize).collect(),
        row: number(1),
        at: at.to_vec(),
    })
}

fn reserve(state: &mut State) -> Result<Target> {
    state.check()?;
    let Some(mesh) = state.mesh else {
        return Err(Error::Internal("bulk fields that were not planned".into()));
    };
    state.flush()?;
    state.make_room(Table::Bulk, 1)?;
    let store = &state.store;
    // Also checks that the path still leads to the file.
    drop(store.open()?);
    let row = store.rows(Table::Bulk);
    let widths: Vec<usize> = columns::bulk(state.plan.extra).map(|field| field.width(mesh.axes)).collect();
    let at = (0..widths.len()).map(|field| store.row_at(Table::Bulk, field, row)).collect::<Result<_>>()?;
    Ok(Target { path: store.path().to_owned(), nodes: mesh.nodes, widths, row, at })
}

fn check(frame: &Frame, target: &Target) -> Result<()> {
    let (given, nodes) = (frame.nodes.len(), target.nodes);
    let expected = |field: usize| given * target.widths.get(field).unwrap_or(&0);
    if frame.fields().iter().enumerate().any(|(field, values)| values.len() != expected(field)) {
        return Err(Error::Internal("bulk fields and nodes differ in number".into()));
    }
    match frame.nodes.iter().find(|&&node| node >= nodes) {
        Some(node) => Err(Error::Internal(format!("bulk fields at node {node} of {nodes}"))),
        None => Ok(()),
    }
}

/// The nodes that one rank writes.
struct Block {
    first: usize,
    fields: Vec<Vec<f64>>,
}

/// How nodes are dealt out to the ranks that write: blocks of `length` nodes, one on every `stride`-th rank.
#[derive(Debug, Clone, Copy)]
struct Blocks {
    nodes: usize,
    length: usize,
    stride: usize,
}

impl Blocks {
    fn new(nodes: usize, numbers: usize, ranks: usize) -> Self {
        let writers = (nodes * numbers * size_of::<f64>() / LEAST_BYTES).clamp(1, ranks);
        Self { nodes, length: nodes.div_ceil(writers).max(1), stride: ranks / writers }
    }

    /// The rank that writes a node.
    fn writer(self, node: usize) -> usize {
        node / self.length * self.stride
    }

    /// The nodes that a rank writes.
    fn of(self, rank: usize) -> std::ops::Range<usize> {
        if !rank.is_multiple_of(self.stride) {
            return 0..0;
        }
        let first = (rank / self.stride * self.length).min(self.nodes);
        first..(first + self.length).min(self.nodes)
    }
}

/// Sends every value to the rank that writes it.
fn redistribute<C>(comm: &C, frame: &Frame, target: &Target) -> Result<Block>
where
    C: Communicator + CommunicatorCollectives,
{
    let (rank, ranks) = (comm.rank() as usize, comm.size() as usize);
    let numbers = target.widths.iter().sum();
    let blocks = Blocks::new(target.nodes, numbers, ranks);
    let mut order: Vec<usize> = (0..frame.nodes.len()).collect();
    order.sort_by_key(|&local| frame.nodes[local]);
    let mut counts = vec![0; ranks];
    let mut indices = Vec::with_capacity(order.len());
    let mut values = Vec::with_capacity(order.len() * numbers);
    for local in order {
        counts[blocks.writer(frame.nodes[local])] += 1;
        indices.push(frame.nodes[local] as u64);
        for (field, width) in frame.fields().iter().zip(&target.widths) {
            values.extend_from_slice(&field[local * width..(local + 1) * width]);
        }
    }
    let mut incoming: Vec<Count> = vec![0; ranks];
    comm.all_to_all_into(&counts[..], &mut incoming[..]);
    let indices = exchange(comm, &indices, &counts, &incoming, 1);
    let values = exchange(comm, &values, &counts, &incoming, numbers);

    let std::ops::Range { start: first, end } = blocks.of(rank);
    let mine = end - first;
    let mut block = Block { first, fields: target.widths.iter().map(|width| vec![f64::NAN; mine * width]).collect() };
    let mut seen = vec![false; mine];
    for (&node, values) in indices.iter().zip(values.chunks_exact(numbers)) {
        let at = node as usize - first;
        let mut rest = values;
        for (field, &width) in block.fields.iter_mut().zip(&target.widths) {
            let (own, others) = rest.split_at(width);
            field[at * width..][..width].copy_from_slice(own);
            rest = others;
        }
        seen[at] = true;
    }
    match seen.iter().position(|seen| !seen) {
        Some(missing) => Err(Error::Internal(format!("no rank has the bulk fields at node {}", first + missing))),
        None => Ok(block),
    }
}

/// All-to-all of `width` numbers for each of `counts` items.
fn exchange<C, T>(comm: &C, out: &[T], counts: &[Count], incoming: &[Count], width: usize) -> Vec<T>
where
    C: Communicator + CommunicatorCollectives,
    T: Equivalence + Default + Clone,
{
    let scaled = |counts: &[Count]| counts.iter().map(|count| count * width as Count).collect::<Vec<_>>();
    let starts = |counts: &[Count]| {
        counts.iter().scan(0, |total, count| Some(std::mem::replace(total, *total + count))).collect::<Vec<Count>>()
    };
    let (counts, incoming) = (scaled(counts), scaled(incoming));
    let mut received = vec![T::default(); incoming.iter().sum::<Count>() as usize];
    let send = Partition::new(out, &counts[..], starts(&counts));
    let displacements = starts(&incoming);
    comm.all_to_all_varcount_into(&send, &mut PartitionMut::new(&mut received[..], &incoming[..], displacements));
    received
}

/// Writes one rank's part; its share of the sum of the frame.
fn write_block(target: &Target, block: &Block) -> std::io::Result<u64> {
    if block.fields.iter().all(Vec::is_empty) {
        return Ok(0);
    }
    let file = OpenOptions::new().write(true).open(&target.path)?;
    let mut sum = 0_u64;
    for (index, (values, width)) in block.fields.iter().zip(&target.widths).enumerate() {
        let (first, bytes) = (block.first * width, bytes(values));
        file.write_all_at(&bytes, target.at[index] + (first * size_of::<f64>()) as u64)?;
        sum = row_sum(place(index, target.row), first, &bytes).wrapping_add(sum);
    }
    // Network file systems tell only now what became of the data.
    file.sync_data()?;
    Ok(sum)
}

/// Makes the frame visible, of which `sum` is that of its fields.
fn commit(state: &mut State, time: f64, sum: u64) -> Result<()> {
    let store = &mut state.store;
    let file = store.open()?;
    let row = store.rows(Table::Bulk);
    let time_at = columns::bulk(state.plan.extra).count();
    let (at, bytes) = (store.row_at(Table::Bulk, time_at, row)?, time.to_ne_bytes());
    file.write_all_at(&bytes, at).map_err(|error| failed(store.path(), error))?;
    let sum = row_sum(place(time_at, row), 0, &bytes).wrapping_add(sum);
    store.commit(&file, &[(Table::Bulk, 1, sum)])?;
    state.bulk_times.push(time);
    state.mesh.map_or(Ok(()), |mesh| {
        xdmf::write(state.store.path(), &state.version, (mesh, state.plan.extra), &state.bulk_times)
    })
}
