//! The progress of a run: a bar on a terminal, plain lines otherwise.

use std::cell::RefCell;
use std::io::IsTerminal;
use std::path::Path;
use std::rc::Rc;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rustix::termios::{tcgetwinsize, tcsetwinsize};

use super::launcher::terminal_of_launcher;
use super::summary::seconds;
use super::sweep::claim::Claim;
use super::terminal::{is_quiet, tell};

/// Plain lines come no closer than this, but for the ends of phases.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Shows how far a run has come.
pub enum Progress {
    /// On ranks that show nothing.
    Silent,
    /// In the claim file of a case of a sweep, for the board to show.
    Claim {
        /// What is being done.
        claim: Rc<RefCell<Claim>>,
        /// Planned steps in all.
        total: usize,
    },
    /// A bar that is redrawn.
    Bar(ProgressBar),
    /// A line now and then.
    Lines {
        /// Planned steps in all.
        total: usize,
        /// When the last line was printed.
        last: Instant,
        /// When the run went on, and from which step.
        begun: Instant,
        from: Option<usize>,
    },
}

/// What is shown of a step.
pub struct Stage<'a> {
    /// Planned steps done.
    pub done: usize,
    /// The phase.
    pub phase: &'a str,
    /// s
    pub time: f64,
    /// N/m, in space N.
    pub normal_force: f64,
    /// The same, along x.
    pub tangential_force: f64,
    /// Newton iterations of the step.
    pub newton: usize,
    /// Whether the phase ends here.
    pub phase_end: bool,
}

impl Progress {
    /// For a run of `total` planned steps; `shown` on one rank.
    pub fn new(total: usize, shown: bool) -> Self {
        if !shown {
            return Self::Silent;
        }
        let Some(target) = terminal() else {
            let now = Instant::now();
            return Self::Lines { total, last: now, begun: now, from: None };
        };
        let bar = ProgressBar::with_draw_target(Some(total as u64), target);
        // Within any width, as a line that wraps leaves pieces behind.
        // A template that is wrong is a defect that the default one survives.
        if let Ok(style) = ProgressStyle::with_template("{bar:12} {pos}/{len}  {eta:>3} left  {wide_msg}") {
            bar.set_style(style);
        }
        bar.tick();
        Self::Bar(bar)
    }

    /// For a case of a sweep; silent on the ranks that have no claim.
    pub fn claim(claim: Option<Rc<RefCell<Claim>>>, total: usize) -> Self {
        claim.map_or(Self::Silent, |claim| Self::Claim { claim, total })
    }

    /// Shows a step.
    pub fn show(&mut self, stage: &Stage<'_>) {
        let Stage { done, phase, time, normal_force, tangential_force, newton, phase_end } = *stage;
        match self {
            Self::Silent => {}
            Self::Claim { claim, total } => claim.borrow_mut().tell(stage.done, *total),
            Self::Bar(bar) => {
                bar.set_position(done as u64);
                bar.set_message(format!("{phase:.10}  N = {normal_force:.3e}  Q = {tangential_force:.3e}"));
            }
            Self::Lines { total, last, begun, from } => {
                let from = *from.get_or_insert(done.saturating_sub(1));
                if phase_end || last.elapsed() >= LINE_EVERY {
                    tell(format_args!(
                        "{done}/{total}  {phase}  t = {time:.4e} s  N = {normal_force:.5e}  Q = {tangential_force:.5e}  \
                         {newton} Newton{}",
                        left(*begun, (done - from, total.saturating_sub(done)))
                    ));
                    *last = Instant::now();
                }
            }
        }
    }

    /// Leaves the terminal as it was.
    pub fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

/// How long the steps that are left take if they take what those that were done did; of a run that takes no time, nothing.
fn left(begun: Instant, (done, left): (usize, usize)) -> String {
    let rest = begun.elapsed().as_secs_f64() / done.max(1) as f64 * left as f64;
    if left == 0 || rest < LINE_EVERY.as_secs_f64() { String::new() } else { format!("  {} left", seconds(rest)) }
}

/// Where a bar can be drawn, unless nothing is to be told: standard error when it is a terminal; under a launcher that
/// gives its processes a pseudo-terminal as standard output, as Open MPI's mpirun does in any case, that output when the
/// launcher's own is a terminal. Elsewhere, as under MPICH's mpiexec and Slurm's srun, which pass on whole lines, there is none.
pub fn terminal() -> Option<ProgressDrawTarget> {
    if is_quiet() {
        return None;
    }
    if std::io::stderr().is_terminal() {
        return Some(ProgressDrawTarget::stderr());
    }
    let launchers = std::io::stdout().is_terminal().then(terminal_of_launcher).flatten()?;
    adopt_size(&launchers);
    Some(ProgressDrawTarget::stdout())
}

/// Gives the pseudo-terminal that a launcher made, which has no size, that of its own terminal: a line that is too long for this one
/// would wrap. Where it cannot be told the bar takes 80 columns.
fn adopt_size(launchers: &Path) {
    let size = std::fs::File::open(launchers).ok().and_then(|terminal| tcgetwinsize(terminal).ok());
    if let Some(size) = size.filter(|size| size.ws_col > 0) {
        // As above.
        let _ = tcsetwinsize(std::io::stdout(), size);
    }
}
