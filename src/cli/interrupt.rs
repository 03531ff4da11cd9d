//! The signals by which users and batch systems ask a run to stop.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM, SIGUSR1};

use crate::error::{Error, Result};

/// Whether this process was asked to stop: by SIGINT, by SIGTERM, or by SIGUSR1, which mpirun hands on as it is (after
/// the other two it kills its processes within a second or so).
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Watches for the signals from here on; to be called once MPI and PETSc have set handlers of their own.
    pub fn watch() -> Result<Self> {
        let interrupt = Self::default();
        for signal in [SIGINT, SIGTERM, SIGUSR1] {
            signal_hook::flag::register(signal, Arc::clone(&interrupt.0))
                .map_err(|error| Error::Internal(format!("signals cannot be watched: {error}")))?;
        }
        Ok(interrupt)
    }

    /// Whether one of the signals has come.
    pub fn requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
