//! How much a command tells, and what warnings come to.

use clap::Args;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Root};

use super::terminal;
use crate::error::{Error, Result};

/// What commands that solve or check scenes have in common.
#[derive(Args, Clone, Copy)]
pub struct Telling {
    /// Print nothing but errors and warnings
    #[arg(short, long)]
    quiet: bool,
    /// End with exit code 6 if there are warnings; results are kept
    #[arg(long)]
    deny_warnings: bool,
}

impl Telling {
    /// From now on as asked, or quietly.
    pub fn begin(self, quietly: bool) {
        if self.quiet || quietly {
            terminal::be_quiet();
        }
    }

    /// What the `count` warnings of the first rank come to, on all of them. Collective.
    ///
    /// # Errors
    /// As for [`Self::judge`].
    pub fn judge_together(self, comm: &SimpleCommunicator, mut count: usize) -> Result<()> {
        comm.process_at_rank(0).broadcast_into(&mut count);
        self.judge(count)
    }

    /// What `count` warnings come to.
    ///
    /// # Errors
    /// [`Error::Doubtful`] where they are denied.
    pub fn judge(self, count: usize) -> Result<()> {
        match count {
            1.. if self.deny_warnings => Err(Error::Doubtful(format!("{count} warning(s), and --deny-warnings"))),
            _ => Ok(()),
        }
    }
}
