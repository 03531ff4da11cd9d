//! Rows on their way into the result file.

use std::time::Instant;

use super::columns::{self, Value};
use super::store::{Store, Table};
use super::xdmf::MeshSize;
use super::{HistoryRow, InterfaceFrame, Plan};
use crate::error::{Error, Result};

/// The file with the rows that are to go into it.
#[derive(Debug)]
pub(super) struct State {
    pub(super) store: Store,
    pub(super) plan: Plan,
    pub(super) version: String,
    pub(super) mesh: Option<MeshSize>,
    pub(super) bulk_times: Vec<f64>,
    pub(super) begun: Instant,
    /// Rows that wait to be written.
    pub(super) history: Vec<HistoryRow>,
    pub(super) interface: Vec<InterfaceFrame>,
    /// What the writer thread met.
    pub(super) failure: Option<Error>,
    pub(super) closing: bool,
}

impl State {
    /// Nothing waits to be written.
    pub(super) fn new(store: Store, plan: Plan, version: String, begun: Instant) -> Self {
        // Coordinates and cells are in the file and are not needed twice.
        let (plan, bulk) = (Plan { bulk: None, ..plan }, plan.bulk);
        Self {
            store,
            plan,
            version,
            mesh: bulk.as_ref().map(MeshSize::of),
            bulk_times: Vec::new(),
            begun,
            history: Vec::new(),
            interface: Vec::new(),
            failure: None,
            closing: false,
        }
    }

    /// The error that the writer thread met, if it did.
    pub(super) fn check(&self) -> Result<()> {
        self.failure.clone().map_or(Ok(()), Err)
    }

    /// Writes all pending rows; on an error they stay pending and the file stays at its last good state.
    pub(super) fn flush(&mut self) -> Result<()> {
        if self.history.is_empty() && self.interface.is_empty() {
            return Ok(());
        }
        self.make_room(Table::History, self.history.len())?;
        self.make_room(Table::Interface, self.interface.len())?;
        let file = self.store.open()?;
        let [mut history, mut interface] = [0_u64; 2];
        for (ahead, mut row) in self.history.iter().copied().enumerate() {
            let directions = self.plan.face.axes() - 1;
            let values: Vec<Vec<u8>> = columns::history(self.plan.extra)
                .map(|column| match column.value {
                    Value::Real(of) => bytes(&[*of(&mut row)]),
                    Value::Count(of) => (*of(&mut row) as i64).to_ne_bytes().to_vec(),
                    Value::Along(of) => bytes(&of.map(|of| *of(&mut row))[..directions]),
                })
                .collect();
            let values: Vec<&[u8]> = values.iter().map(|value| value.as_slice()).collect();
            history = self.store.write_row(&file, Table::History, ahead, &values)?.wrapping_add(history);
        }
        for (ahead, frame) in self.interface.iter().enumerate() {
            let fields = columns::interface(self.plan.face.axes(), self.plan.extra);
            let mut values: Vec<Vec<u8>> = fields.map(|field| bytes((field.values)(frame))).collect();
            values.push(bytes(&[frame.time]));
            let values: Vec<&[u8]> = values.iter().map(Vec::as_slice).collect();
            interface = self.store.write_row(&file, Table::Interface, ahead, &values)?.wrapping_add(interface);
        }
        self.store.set_wall_seconds(&file, self.begun.elapsed().as_secs_f64())?;
        let [rows, frames] = [self.history.len(), self.interface.len()];
        self.store.commit(&file, &[(Table::History, rows, history), (Table::Interface, frames, interface)])?;
        self.history.clear();
        self.interface.clear();
        Ok(())
    }

    /// Sees to it that `count` more rows fit into the table.
    pub(super) fn make_room(&mut self, table: Table, count: usize) -> Result<()> {
        while self.store.rows(table) + count > self.store.capacity(table) {
            self.store = self.store.grown(table)?;
        }
        Ok(())
    }
}

/// The numbers as the file has them.
pub(super) fn bytes(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_ne_bytes()).collect()
}
