//! The signals by which users and batch systems ask a run to stop.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM, SIGUSR1};
use signal_hook::iterator::Signals;
use signal_hook::low_level::emulate_default_handler;

use super::terminal::warn;
use crate::error::{Error, Result};

/// A signal that comes this long after the first one asks again; `timeout` and some batch systems send each twice.
const AGAIN_AFTER: Duration = Duration::from_secs(1);

/// Whether this process was asked to stop: by SIGINT, by SIGTERM, or by SIGUSR1, which mpirun hands on as it is (after
/// the other two it kills its processes within a second or so). Who asks again ends it at once, whatever it is doing.
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Watches for the signals from here on. To be called before anything that takes time, so that none of them kills a
    /// process that is about to start.
    pub fn watch() -> Result<Self> {
        let interrupt = Self::default();
        let requested = Arc::clone(&interrupt.0);
        let fail = |error| Error::Internal(format!("signals cannot be watched: {error}"));
        let mut signals = Signals::new([SIGINT, SIGTERM, SIGUSR1]).map_err(fail)?;
        let watch = move || {
            let mut first: Option<Instant> = None;
            for signal in signals.forever() {
                requested.store(true, Ordering::Relaxed);
                if first.get_or_insert_with(Instant::now).elapsed() >= AGAIN_AFTER {
                    warn("ended at once by a second signal; what was written before is kept");
                    // A signal without a default ends nothing, and none of these is one.
                    let _ = emulate_default_handler(signal);
                }
            }
        };
        std::thread::Builder::new().name("mpjr signals".into()).spawn(watch).map_err(fail)?;
        Ok(interrupt)
    }

    /// Whether one of the signals has come.
    pub fn requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
