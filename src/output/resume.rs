//! Going on with a result file, and taking over the rows of another.

use std::path::Path;
use std::time::{Duration, Instant};

use super::columns::{self, Value};
use super::reader::{Field, Results};
use super::state::{State, bytes};
use super::store::{self, Store, Table};
use super::{Plan, Rows, Status, xdmf};
use crate::error::{Error, Result};

/// The state of a recorder of the file at `path`, cut back to `rows`.
pub(super) fn reopen(path: &Path, plan: Plan, rows: Rows) -> Result<State> {
    let results = Results::open(path)?;
    let spent = Duration::try_from_secs_f64(results.number("wall_seconds")?).unwrap_or_default();
    let version = results.text("mpjr_version")?;
    unchanged(&results, &plan)?;
    let mut times = if rows.bulk > 0 { results.bulk("time")?.values } else { Vec::new() };
    times.truncate(rows.bulk);
    drop(results);

    let mut store = Store::reopen(path, &plan, rows)?;
    let file = store.open()?;
    store.set_status(&file, Status::Stopped)?;
    store.show_committed_only(&file)?;
    let begun = Instant::now().checked_sub(spent).unwrap_or_else(Instant::now);
    let mut state = State::new(store, plan, version, begun);
    if let (Some(mesh), false) = (state.mesh, times.is_empty()) {
        xdmf::write(path, &state.version, (mesh, state.plan.extra), &times)?;
    }
    state.bulk_times = times;
    Ok(state)
}

/// Whether the first `rows` of the results at `path` are as they were written.
///
/// # Errors
/// `Error::File` when they are not, or cannot be read.
pub fn intact(path: &Path, rows: Rows) -> Result<()> {
    let results = Results::open(path)?;
    let bulk = results.has("bulk/time").then(super::BulkPlan::default);
    let face = super::FacePlan { in_space: results.has("interface/coordinates"), ..super::FacePlan::default() };
    let plan = Plan { extra: results.extra(), face, bulk, ..Plan::default() };
    drop(results);
    Store::reopen(path, &plan, rows).map(|_| ())
}

/// Refuses results whose nodes or cells are not those of the plan.
fn unchanged(results: &Results, plan: &Plan) -> Result<()> {
    let same = |name: &str, planned: &[f64]| Ok::<_, Error>(results.field(name)?.values == planned);
    let places = if plan.face.in_space { "interface/coordinates" } else { "interface/x" };
    let mut whole = same(places, &plan.face.coordinates)?;
    if let Some(bulk) = &plan.bulk {
        let cells: Vec<f64> = bulk.cells.iter().map(|&node| node as f64).collect();
        whole &= same("bulk/coordinates", &bulk.coordinates)? && same("bulk/cells", &cells)?;
    }
    match whole {
        true => Ok(()),
        false => Err(Error::file(results.path(), store::DAMAGED)),
    }
}

/// Adds all rows of `results` but the unloaded state to the file of `state`.
pub(super) fn append(state: &mut State, results: &Results) -> Result<()> {
    for (table, skip) in [(Table::History, 1), (Table::Interface, 0), (Table::Bulk, 0)] {
        if table == Table::Bulk && (state.mesh.is_none() || !results.has("bulk/time")) {
            continue;
        }
        append_table(state, results, (table, skip))?;
    }
    let Some(mesh) = state.mesh.filter(|_| results.has("bulk/time")) else { return Ok(()) };
    state.bulk_times.extend(results.bulk("time")?.values);
    if state.bulk_times.is_empty() {
        return Ok(());
    }
    xdmf::write(state.store.path(), &state.version, (mesh, state.plan.extra), &state.bulk_times)
}

fn append_table(state: &mut State, results: &Results, (table, skip): (Table, usize)) -> Result<()> {
    // The mesh that `names` looks for is not kept in the plan of a recorder.
    let plan = Plan { bulk: state.mesh.map(|_| super::BulkPlan::default()), ..state.plan.clone() };
    let names = store::names(table, &plan);
    let fields = names.iter().map(|name| results.field(name)).collect::<Result<Vec<Field>>>()?;
    // `time` is the last of its table, and counts the rows that are whole.
    let rows = fields.last().map_or(0, |time| time.rows);
    let counts: Vec<bool> = match table {
        Table::History => columns::history(plan.extra).map(|column| matches!(column.value, Value::Count(_))).collect(),
        _ => vec![false; names.len()],
    };
    let added = rows.saturating_sub(skip);
    state.make_room(table, added)?;
    let file = state.store.open()?;
    let mut sum = 0_u64;
    for row in skip..rows {
        let values: Vec<Vec<u8>> = fields
            .iter()
            .zip(&counts)
            .map(|(field, &count)| match (count, field.row(row)) {
                (true, values) => values.iter().flat_map(|&value| (value as i64).to_ne_bytes()).collect(),
                (false, values) => bytes(values),
            })
            .collect();
        let values: Vec<&[u8]> = values.iter().map(Vec::as_slice).collect();
        sum = state.store.write_row(&file, table, row - skip, &values)?.wrapping_add(sum);
    }
    state.store.commit(&file, &[(table, added, sum)])
}

/// What an earlier run left at a path.
#[derive(Debug, Clone, PartialEq)]
pub struct Left {
    /// How it ended.
    pub status: String,
    /// Its resolved scene.
    pub scene: String,
    /// The content of the files that the scene names, as far as it is known: former versions did not tell.
    pub inputs: String,
    /// When it started.
    pub started: String,
}

/// What is at `path`: none when there is no file.
pub fn left(path: &Path) -> Result<Option<Left>> {
    match std::fs::symlink_metadata(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(Error::file(path, error)),
        Ok(_) => {}
    }
    let results = Results::open(path)?;
    let text = |name| results.text(name);
    let inputs = text("inputs").unwrap_or_default();
    Ok(Some(Left { status: text("status")?, scene: text("scene")?, inputs, started: text("started")? }))
}
