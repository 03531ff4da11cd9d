//! Takes the rows of a run and sees to it that they are in the file within a second.

use std::fs::OpenOptions;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

use super::columns;
use super::reader::Results;
use super::scratch::scratch;
use super::state::State;
use super::store::{Store, failed};
use super::{HistoryRow, InterfaceFrame, Metadata, Plan, Rows, Status, ours, pack, resume, skeleton, xdmf};
use crate::error::{Error, Result};

/// Rows wait no longer than this before they are written.
const FLUSH_EVERY: Duration = Duration::from_secs(1);

/// The result file of a run, on the one rank that writes it.
///
/// Rows are handed over as they come; a thread writes what has gathered once a second, so that they reach the file
/// even while a long step is being solved. What goes wrong there is told at the next call.
#[derive(Debug)]
pub struct Recorder {
    shared: Arc<Shared>,
    writer: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared {
    state: Mutex<State>,
    woken: Condvar,
}

impl Recorder {
    /// Creates the file `path` with `first`, the unloaded state, as row 0 of its history. An existing file is
    /// replaced only if this program wrote it, and only once the new one is complete.
    ///
    /// # Errors
    /// `Error::File` when the directory is missing or not writable, when the file is somebody else's, or when the
    /// disk is full; nothing was changed then.
    pub fn create(path: &Path, metadata: &Metadata, plan: Plan, first: &HistoryRow) -> Result<Self> {
        let path = absolute(path)?;
        ours::make_way(&path)?;
        let scratch = scratch(&path);
        // The system's words on a directory that cannot be written are plainer than the library's.
        let probe = OpenOptions::new().write(true).create_new(true).open(&scratch);
        probe
            .map_err(|error| Error::file(&path, format!("cannot be created: {error}; name another file with --out")))?;
        let made = prepare(&scratch, &path, metadata, plan, first);
        if made.is_err() {
            // The error at hand says more than one about a leftover.
            let _ = std::fs::remove_file(&scratch);
        }
        Self::start(made?)
    }

    /// Goes on with the file `path` that an earlier run left, after its first `rows`; later ones are dropped. `plan` is
    /// that of the run.
    ///
    /// # Errors
    /// `Error::File` when the file cannot be read or does not have these rows; nothing was changed then.
    pub fn resume(path: &Path, plan: Plan, rows: Rows) -> Result<Self> {
        let path = absolute(path)?;
        ours::make_way(&path)?;
        Self::start(resume::reopen(&path, plan, rows)?)
    }

    fn start(state: State) -> Result<Self> {
        let shared = Arc::new(Shared { state: Mutex::new(state), woken: Condvar::new() });
        let theirs = Arc::clone(&shared);
        let writer = std::thread::Builder::new().name("mpjr output".into()).spawn(move || theirs.write_while_open());
        let writer = writer.map_err(|error| Error::Internal(format!("cannot start a thread: {error}")))?;
        Ok(Self { shared, writer: Some(writer) })
    }

    /// Where the file is.
    pub fn path(&self) -> PathBuf {
        self.shared.lock().store.path().to_owned()
    }

    /// Adds a row to the history.
    pub fn history(&self, row: HistoryRow) -> Result<()> {
        let mut state = self.shared.lock();
        state.check()?;
        state.history.push(row);
        Ok(())
    }

    /// Adds a row to the interface fields.
    pub fn interface(&self, frame: InterfaceFrame) -> Result<()> {
        let mut state = self.shared.lock();
        state.check()?;
        let (nodes, axes) = (state.plan.face.nodes(), state.plan.face.axes());
        let numbers = |field: &columns::Field| nodes * field.components.names(axes).len().max(1);
        if let Some(field) =
            columns::interface(axes, state.plan.extra).find(|field| (field.values)(&frame).len() != numbers(field))
        {
            return Err(Error::Internal(format!("interface field {} without a value for each node", field.name)));
        }
        state.interface.push(frame);
        Ok(())
    }

    /// Writes at once all rows handed over so far.
    pub fn flush(&self) -> Result<()> {
        let mut state = self.shared.lock();
        state.check()?;
        state.flush()
    }

    /// Adds all rows of other results to those here, which must be of a run with the same columns and face: `/history`
    /// from its row 1 on.
    pub fn append(&self, results: &Results) -> Result<()> {
        let mut state = self.shared.lock();
        state.check()?;
        state.flush()?;
        resume::append(&mut state, results)
    }

    /// Writes at once all rows handed over so far, forces them to the disk, and says how many there are.
    pub fn sync(&self) -> Result<Rows> {
        let mut state = self.shared.lock();
        state.check()?;
        state.flush()?;
        let store = &state.store;
        store.open()?.sync_data().map_err(|error| failed(store.path(), error))?;
        Ok(store.committed())
    }

    /// Sets the attribute `warnings`, where it does not have these yet. The file is copied for it.
    pub fn set_warnings(&self, warnings: &[String]) -> Result<()> {
        let mut state = self.shared.lock();
        state.check()?;
        state.flush()?;
        if Results::open(state.store.path()).and_then(|results| results.warnings()).is_ok_and(|there| there == warnings)
        {
            return Ok(());
        }
        state.store = state.store.with_warnings(warnings)?;
        Ok(())
    }

    /// Sets the attribute `scene`, where it is another: keys of `[output]` may have changed. The file is copied for it.
    pub fn set_scene(&self, scene: &str) -> Result<()> {
        let mut state = self.shared.lock();
        state.check()?;
        state.flush()?;
        if Results::open(state.store.path()).and_then(|results| results.text("scene")).is_ok_and(|there| there == scene)
        {
            return Ok(());
        }
        state.store = state.store.with_scene(scene)?;
        Ok(())
    }

    /// All rows of the history so far.
    pub fn rows(&self) -> Result<Vec<HistoryRow>> {
        let mut state = self.shared.lock();
        state.check()?;
        state.flush()?;
        Results::open(state.store.path())?.rows(state.plan.extra)
    }

    /// Writes what is left and how the run ended. Without this call the file says "stopped".
    pub fn finish(self, status: Status) -> Result<()> {
        self.close(status)
    }

    /// Writes what is left of a run that is complete, and compresses its fields where that takes little time. No run can
    /// go on from such a file.
    pub fn finish_packed(self) -> Result<()> {
        self.close(Status::Complete)?;
        pack::pack(&self.shared.lock());
        Ok(())
    }

    fn close(&self, status: Status) -> Result<()> {
        let mut state = self.shared.lock();
        state.check()?;
        state.flush()?;
        let file = state.store.open()?;
        state.store.set_status(&file, status)?;
        // Some file systems tell only now that the disk is full.
        file.sync_all().map_err(|error| failed(state.store.path(), error))
    }

    /// The state, for the bulk fields; no row is written while the guard lives.
    pub(super) fn lock(&self) -> MutexGuard<'_, State> {
        self.shared.lock()
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        self.shared.lock().closing = true;
        self.shared.woken.notify_all();
        if let Some(writer) = self.writer.take() {
            // The thread catches its errors; had it panicked, there is nothing left to save.
            let _ = writer.join();
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The writer thread: once a second, and once more at the end.
    fn write_while_open(&self) {
        let mut state = self.lock();
        loop {
            if !state.closing {
                (state, _) = self.woken.wait_timeout(state, FLUSH_EVERY).unwrap_or_else(PoisonError::into_inner);
            }
            if state.failure.is_none() {
                state.failure = state.flush().err();
            }
            if state.closing {
                return;
            }
        }
    }
}

/// Makes the file complete with row 0 under the name `scratch`, then puts it at `path`.
fn prepare(scratch: &Path, path: &Path, metadata: &Metadata, plan: Plan, first: &HistoryRow) -> Result<State> {
    std::fs::remove_file(scratch).map_err(|error| Error::file(path, error))?;

    skeleton::create(scratch, metadata, &plan).map_err(|error| about(path, error))?;
    let mut store = Store::locate(scratch, &plan).map_err(|error| about(path, error))?;
    let file = store.open()?;
    store.show_committed_only(&file)?;
    let waited = SystemTime::now().duration_since(metadata.started).unwrap_or_default();
    let begun = Instant::now().checked_sub(waited).unwrap_or_else(Instant::now);
    let mut state = State::new(store, plan, metadata.version.clone(), begun);
    state.history.push(*first);
    state.flush().map_err(|error| about(path, error))?;
    std::fs::rename(scratch, path).map_err(|error| Error::file(path, error))?;
    state.store.moved_to(path);
    xdmf::remove_stale(path)?;
    Ok(state)
}

/// The same error told about the file that the user named.
fn about(path: &Path, error: Error) -> Error {
    match error {
        Error::File { reason, .. } => Error::file(path, reason),
        other => other,
    }
}

/// The absolute form of a path whose directory exists; a link to a file is followed.
fn absolute(path: &Path) -> Result<PathBuf> {
    let path = std::path::absolute(path).map_err(|error| Error::file(path, error))?;
    let path = path.canonicalize().unwrap_or(path);
    let directory = path.parent().ok_or_else(|| Error::file(&path, "names no file"))?;
    match std::fs::metadata(directory) {
        Ok(about) if about.is_dir() => {}
        Ok(_) => return Err(Error::file(&path, format!("{} is not a directory", directory.display()))),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            let reason =
                format!("the directory {} does not exist; create it or name another with --out", directory.display());
            return Err(Error::file(&path, reason));
        }
        Err(error) => return Err(Error::file(&path, error)),
    }
    Ok(path)
}
