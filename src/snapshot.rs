//! The state of a run as named lists of numbers, and the order in which distributed vectors stand in it: that of the
//! mesh, whatever the number of ranks.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use crate::error::{Error, Result};
use crate::parallel::{Team, broadcast};
use crate::petsc::{Gather, Vector};

/// Everything that the rest of a run depends on. Rank 0's is whole; the others' lack what only rank 0 gathers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Snapshot {
    fields: Vec<(String, Vec<f64>)>,
}

impl Snapshot {
    /// Adds a list under a name of its own, such as `arm-0`.
    pub fn put(&mut self, name: impl Into<String>, values: Vec<f64>) {
        self.fields.push((name.into(), values));
    }

    /// Whether there is a list of this name.
    pub fn has(&self, name: &str) -> bool {
        self.fields.iter().any(|(other, _)| other == name)
    }

    /// The list of this name.
    pub fn get(&self, name: &str) -> Result<&[f64]> {
        self.fields.iter().find(|(other, _)| other == name).map(|(_, values)| &values[..]).ok_or_else(|| lacking(name))
    }

    /// The list of this name, which must have `N` numbers.
    pub fn numbers<const N: usize>(&self, name: &str) -> Result<[f64; N]> {
        self.get(name)?.try_into().map_err(|_| lacking(name))
    }

    /// The list of this name, which must be as long as `target`, copied there.
    pub fn fill(&self, name: &str, target: &mut [f64]) -> Result<()> {
        self.fill_part(name, 0, target.len(), target)
    }

    /// The part of the list of this name that begins at `first` and is as long as `target`, copied there; the list must have `count` numbers.
    pub fn fill_part(&self, name: &str, first: usize, count: usize, target: &mut [f64]) -> Result<()> {
        let values = self.get(name)?;
        let part = values.get(first..first + target.len()).filter(|_| values.len() == count);
        target.copy_from_slice(part.ok_or_else(|| lacking(name))?);
        Ok(())
    }

    /// This rank's part of the list of this name, which must be as long as `target`, copied there.
    pub fn fill_own(&self, name: &str, team: &Team, target: &mut [f64]) -> Result<()> {
        let part = team.own(self.get(name)?);
        if part.len() != target.len() {
            return Err(lacking(name));
        }
        target.copy_from_slice(part);
        Ok(())
    }

    /// All lists, in the order in which they were added.
    pub fn fields(&self) -> &[(String, Vec<f64>)] {
        &self.fields
    }

    /// Rank 0's snapshot, on every rank. Collective.
    pub fn shared(&self, comm: &SimpleCommunicator) -> Self {
        let mut names = self.fields.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join("\n").into_bytes();
        broadcast(comm, 0, &mut names);
        let names = String::from_utf8_lossy(&names).into_owned();
        let mut all = Self::default();
        for (index, name) in names.lines().enumerate() {
            let mut values = match self.fields.get(index) {
                Some((_, values)) if comm.rank() == 0 => values.iter().flat_map(|value| value.to_ne_bytes()).collect(),
                _ => Vec::new(),
            };
            broadcast(comm, 0, &mut values);
            all.put(name, values.as_chunks().0.iter().map(|bytes| f64::from_ne_bytes(*bytes)).collect());
        }
        all
    }
}

fn lacking(name: &str) -> Error {
    Error::Usage(format!(
        "the checkpoint does not hold what this version needs of {name:?}: another version wrote it; run without \
         --resume"
    ))
}

/// Where the entries of a distributed vector stand in an order that every number of ranks has in common.
pub struct NaturalOrder {
    gather: Gather,
    /// The length on rank 0, nothing elsewhere.
    collected: usize,
    /// For each entry of this rank, its place in the order.
    places: Vec<usize>,
}

impl NaturalOrder {
    /// For vectors laid out like `layout`; `global` gives the entry at each place, `first` this rank's first entry.
    pub fn new(comm: &SimpleCommunicator, layout: &Vector, global: &[i32], first: usize) -> Result<Self> {
        let wanted = if comm.rank() == 0 { global } else { &[] };
        let mut places = vec![0; layout.local_len()];
        for (place, &entry) in global.iter().enumerate() {
            if let Some(local) = (entry as usize).checked_sub(first).and_then(|local| places.get_mut(local)) {
                *local = place;
            }
        }
        Ok(Self { gather: Gather::new(layout, wanted)?, collected: wanted.len(), places })
    }

    /// For vectors whose own order it is, of `count` entries of which this rank's begin at `first`; `collects` on rank 0.
    pub fn as_it_is(layout: &Vector, (first, count): (usize, usize), collects: bool) -> Result<Self> {
        let collected = if collects { count } else { 0 };
        let entries: Vec<i32> = (0..collected as i32).collect();
        let places = (first..first + layout.local_len()).collect();
        Ok(Self { gather: Gather::new(layout, &entries)?, collected, places })
    }

    /// Adds the vector to the snapshot. Collective.
    pub fn save(&mut self, name: impl Into<String>, vector: &Vector, snapshot: &mut Snapshot) -> Result<()> {
        let mut values = vec![0.0; self.collected];
        self.gather.gather(vector, &mut values)?;
        snapshot.put(name, values);
        Ok(())
    }

    /// Takes the vector from a snapshot that is whole on every rank.
    pub fn restore(&self, name: &str, vector: &mut Vector, snapshot: &Snapshot) -> Result<()> {
        let values = snapshot.get(name)?;
        for (entry, &place) in vector.view_mut()?.iter_mut().zip(&self.places) {
            *entry = *values.get(place).ok_or_else(|| lacking(name))?;
        }
        Ok(())
    }
}
