//! How the nodes of a face are parted among ranks, and what of them is summed.
//!
//! The nodes of a grid stand line by line. A team gives each rank a run of whole lines, in the order of the ranks, so that a list of
//! all nodes is the lists of the ranks one after the other. Numbers are reduced in that order on every rank: all have the same bits, and
//! whatever is decided by them is decided alike.

use std::cell::Cell;
use std::ops::Range;
use std::rc::Rc;

use mpi::datatype::{Partition, PartitionMut};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Equivalence, Root};

use super::{agree, any};
use crate::error::Result;

/// The ranks that share the nodes of a face.
pub struct Team {
    /// None where this rank has all that there is.
    comm: Option<SimpleCommunicator>,
    rank: usize,
    /// The first line of each rank, and how many there are.
    starts: Vec<usize>,
    /// Nodes of a line.
    columns: usize,
    traffic: Cell<Traffic>,
}

/// What passed between the ranks of a team.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Traffic {
    /// Numbers that were made totals, however many together.
    pub reductions: usize,
    /// Exchanges of lists of all with all.
    pub exchanges: usize,
    /// What this rank sent in them, bytes.
    pub sent: usize,
}

/// Where each of so many ranks begins, of a count that they share evenly, and the count.
pub fn parted(count: usize, ranks: usize) -> Vec<usize> {
    (0..=ranks).map(|rank| rank * count / ranks).collect()
}

impl Team {
    /// Of one rank, which has everything.
    pub fn alone() -> Rc<Self> {
        Rc::new(Self { comm: None, rank: 0, starts: Vec::new(), columns: 0, traffic: Cell::default() })
    }

    /// Of all ranks of `comm`, which share so many lines of so many nodes each. Collective.
    pub fn of(comm: &SimpleCommunicator, [lines, columns]: [usize; 2]) -> Rc<Self> {
        let (ranks, rank) = (comm.size() as usize, comm.rank() as usize);
        let (comm, starts) = (Some(comm.duplicate()), parted(lines, ranks));
        Rc::new(Self { comm, rank, starts, columns, traffic: Cell::default() })
    }

    /// Whether each rank has but a part.
    pub fn is_parted(&self) -> bool {
        self.comm.is_some()
    }

    /// Whether this rank is the first, which writes and has what no node has.
    pub fn is_first(&self) -> bool {
        self.rank == 0
    }

    /// How many ranks there are, and which of them this is.
    pub fn ranks(&self) -> [usize; 2] {
        [self.comm.as_ref().map_or(1, |comm| comm.size() as usize), self.rank]
    }

    /// The lines of a rank.
    pub fn lines_of(&self, rank: usize) -> Range<usize> {
        self.starts[rank]..self.starts[rank + 1]
    }

    /// The lines of this one; none where nothing is parted.
    pub fn lines(&self) -> Option<Range<usize>> {
        self.comm.as_ref().map(|_| self.lines_of(self.rank))
    }

    /// The nodes of this rank among `count`, which are all that it has or, of a parted face, all that there are.
    pub fn nodes(&self, count: usize) -> Range<usize> {
        self.lines().map_or(0..count, |lines| lines.start * self.columns..lines.end * self.columns)
    }

    /// How many nodes there are where this rank has `here`.
    pub fn count(&self, here: usize) -> usize {
        self.starts.last().map_or(here, |lines| lines * self.columns)
    }

    /// What passed between the ranks so far.
    pub fn traffic(&self) -> Traffic {
        self.traffic.get()
    }

    fn note(&self, reductions: usize, exchanged: Option<usize>) {
        let Traffic { reductions: before, exchanges, sent } = self.traffic.get();
        self.traffic.set(Traffic {
            reductions: before + reductions,
            exchanges: exchanges + usize::from(exchanged.is_some()),
            sent: sent + exchanged.unwrap_or(0),
        });
    }

    /// What each rank has, rank by rank.
    fn all<const N: usize>(&self, mine: [f64; N]) -> Vec<[f64; N]> {
        let Some(comm) = &self.comm else { return vec![mine] };
        self.note(1, None);
        let mut all = vec![0.0; N * comm.size() as usize];
        comm.all_gather_into(&mine[..], &mut all[..]);
        all.as_chunks().0.to_vec()
    }

    /// The sums over the ranks. Collective.
    pub fn sum<const N: usize>(&self, mine: [f64; N]) -> [f64; N] {
        if self.comm.is_none() {
            return mine;
        }
        let add = |sum: [f64; N], next: [f64; N]| std::array::from_fn(|i| sum[i] + next[i]);
        self.all(mine).into_iter().fold([0.0; N], add)
    }

    /// The sums over the ranks of lists of the same length. Collective.
    pub fn sum_all(&self, mine: Vec<f64>) -> Vec<f64> {
        let Some(comm) = &self.comm else { return mine };
        self.note(1, None);
        let mut all = vec![0.0; mine.len() * comm.size() as usize];
        comm.all_gather_into(&mine[..], &mut all[..]);
        let mut sums = vec![0.0; mine.len()];
        for list in all.chunks_exact(mine.len()) {
            sums.iter_mut().zip(list).for_each(|(sum, value)| *sum += value);
        }
        sums
    }

    /// Totals so far, to add to and then to [`Self::sum`]: the first rank has them, the others begin at nothing.
    pub fn so_far<const N: usize>(&self, totals: [f64; N]) -> [f64; N] {
        if self.is_first() { totals } else { [0.0; N] }
    }

    /// The largest over the ranks. Collective.
    pub fn most<const N: usize>(&self, mine: [f64; N]) -> [f64; N] {
        if self.comm.is_none() {
            return mine;
        }
        let more = |most: [f64; N], next: [f64; N]| std::array::from_fn(|i| most[i].max(next[i]));
        self.all(mine).into_iter().fold([f64::NEG_INFINITY; N], more)
    }

    /// The smallest over the ranks. Collective.
    pub fn least(&self, mine: f64) -> f64 {
        let [most] = self.most([-mine]);
        -most
    }

    /// Whether any rank says yes. Collective.
    pub fn any(&self, mine: bool) -> bool {
        let Some(comm) = &self.comm else { return mine };
        self.note(1, None);
        any(comm, mine)
    }

    /// Whether all ranks say yes. Collective.
    pub fn all_say(&self, mine: bool) -> bool {
        !self.any(!mine)
    }

    /// Makes an error of any rank that of all. Collective.
    pub fn agree<T>(&self, mine: Result<T>) -> Result<T> {
        match &self.comm {
            Some(comm) => agree(comm, mine),
            None => mine,
        }
    }

    /// The numbers of the first rank, on all. Collective.
    pub fn of_first<const N: usize>(&self, mut numbers: [f64; N]) -> [f64; N] {
        if let Some(comm) = &self.comm {
            comm.process_at_rank(0).broadcast_into(&mut numbers[..]);
        }
        numbers
    }

    /// The lists of all ranks one after the other, on the first; nothing on the others. Collective.
    pub fn collected(&self, mine: Vec<f64>) -> Vec<f64> {
        let Some(comm) = &self.comm else { return mine };
        let counts: Vec<i32> = self.all([mine.len() as f64]).iter().map(|[count]| *count as i32).collect();
        let root = comm.process_at_rank(0);
        if !self.is_first() {
            root.gather_varcount_into(&mine[..]);
            return Vec::new();
        }
        let places = displacements(&counts);
        let mut whole = vec![0.0; counts.iter().map(|count| *count as usize).sum()];
        root.gather_varcount_into_root(&mine[..], &mut PartitionMut::new(&mut whole[..], &counts[..], &places[..]));
        whole
    }

    /// The same on all ranks. Collective.
    pub fn shared(&self, mine: Vec<f64>) -> Vec<f64> {
        let Some(comm) = &self.comm else { return mine };
        let mut whole = self.collected(mine);
        let mut count = whole.len();
        comm.process_at_rank(0).broadcast_into(&mut count);
        whole.resize(count, 0.0);
        comm.process_at_rank(0).broadcast_into(&mut whole[..]);
        whole
    }

    /// This rank's part of a list of all nodes, so many numbers to each.
    pub fn own<'a>(&self, whole: &'a [f64]) -> &'a [f64] {
        let Some(lines) = self.lines() else { return whole };
        let each = whole.len() / self.starts.last().copied().unwrap_or(1).max(1);
        &whole[lines.start * each..lines.end * each]
    }

    /// Sends what stands for each rank and takes what comes from each: of `sent` and `taken`, so many numbers from their places on. Nothing is
    /// sent to oneself. Collective.
    pub fn exchange<T: Equivalence>(
        &self,
        (from, sent): (&[T], &[Range<usize>]),
        (to, taken): (&mut [T], &[Range<usize>]),
    ) {
        let Some(comm) = &self.comm else { return };
        let of = |ranges: &[Range<usize>]| -> (Vec<i32>, Vec<i32>) {
            let count = |(rank, range): (usize, &Range<usize>)| if rank == self.rank { 0 } else { range.len() as i32 };
            (ranges.iter().enumerate().map(count).collect(), ranges.iter().map(|range| range.start as i32).collect())
        };
        let ((counts, places), (takes, puts)) = (of(sent), of(taken));
        let entries: usize = counts.iter().map(|count| *count as usize).sum();
        self.note(0, Some(entries * size_of::<T>()));
        comm.all_to_all_varcount_into(
            &Partition::new(from, &counts[..], &places[..]),
            &mut PartitionMut::new(to, &takes[..], &puts[..]),
        );
    }

    /// Lines of a field, wherever they are: those that each rank wants, in the order in which it names them. `field` has the lines of this
    /// rank. Collective.
    pub fn fetched(&self, field: &[f64], wanted: impl Fn(usize) -> Vec<usize>) -> Vec<f64> {
        let lines = self.lines_of(self.rank);
        let each = field.len() / lines.len().max(1);
        let line = |line: usize| &field[(line - lines.start) * each..][..each];
        let [ranks, _] = self.ranks();
        let (mut sent, mut places) = (Vec::new(), Vec::with_capacity(ranks));
        for rank in 0..ranks {
            let first = sent.len();
            let theirs = if rank == self.rank { Vec::new() } else { wanted(rank) };
            theirs.into_iter().filter(|at| lines.contains(at)).for_each(|at| sent.extend_from_slice(line(at)));
            places.push(first..sent.len());
        }
        let mine = wanted(self.rank);
        let owner = |at: usize| self.starts.partition_point(|start| *start <= at) - 1;
        let (mut taken, mut length) = (Vec::with_capacity(ranks), 0);
        for rank in 0..ranks {
            let count = mine.iter().filter(|at| owner(**at) == rank && rank != self.rank).count();
            taken.push(length..length + count * each);
            length += count * each;
        }
        let mut came = vec![0.0; length];
        self.exchange((&sent, &places), (&mut came, &taken));
        let mut next: Vec<usize> = taken.iter().map(|range| range.start).collect();
        let mut fetched = Vec::with_capacity(mine.len() * each);
        for at in mine {
            let from = owner(at);
            if from == self.rank {
                fetched.extend_from_slice(line(at));
                continue;
            }
            fetched.extend_from_slice(&came[next[from]..][..each]);
            next[from] += each;
        }
        fetched
    }
}

/// Where each of several lists begins that stand one after the other.
fn displacements(counts: &[i32]) -> Vec<i32> {
    let before = counts.iter().scan(0, |sum, count| {
        let before = *sum;
        *sum += count;
        Some(before)
    });
    before.collect()
}
