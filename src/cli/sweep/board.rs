//! What is shown of a sweep while it runs: a line per running case and a total. A thread reads what the groups tell in
//! their claim files, so that nobody's solving waits for the showing.

use std::collections::BTreeMap;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::super::progress::terminal;
use super::super::summary::seconds;
use super::super::terminal::tell;
use super::claim::{Told, told};
use super::folder::{Folder, State};
use crate::error::{Error, Result};
use crate::scene::sweep::Sweep;

/// How often the board is brought up to date.
const LOOK_EVERY: Duration = Duration::from_millis(500);
/// Lines about running cases come no closer than this where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);
/// The share of the steps that must be done before the time that is left can be told.
const TELLING: f64 = 0.05;

/// Shown while it lives.
pub struct Board {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

struct View {
    folder: Folder,
    sweep: Sweep,
    run: String,
    /// Cases that are not done.
    open: Vec<usize>,
    total: usize,
    /// Steps of all cases, and of those that were done before.
    steps: usize,
    done_before: usize,
    begun: Instant,
    last_line: Instant,
    bars: Option<Bars>,
}

/// A bar for each case that runs, and below them the one of the whole.
struct Bars {
    all: MultiProgress,
    cases: BTreeMap<usize, ProgressBar>,
    total: ProgressBar,
}

impl Bars {
    fn new(target: ProgressDrawTarget, steps: usize) -> Self {
        let all = MultiProgress::with_draw_target(target);
        let total = styled(all.add(ProgressBar::new(steps as u64)));
        Self { all, cases: BTreeMap::new(), total }
    }

    /// The bar of a case of so many steps.
    fn of(&mut self, case: usize, steps: usize) -> &ProgressBar {
        let made = || styled(self.all.insert_before(&self.total, ProgressBar::new(steps as u64)));
        self.cases.entry(case).or_insert_with(made)
    }
}

impl Board {
    /// Shows the `chosen` cases of the sweep.
    pub fn start(folder: &Folder, sweep: &Sweep, chosen: &[usize], run: &str) -> Result<Self> {
        let is_done = |case: &usize| folder.state(sweep, *case) == State::Complete;
        let steps = |cases: &[usize]| cases.iter().map(|&case| sweep.cases[case].scene.steps()).sum();
        let done: Vec<usize> = chosen.iter().copied().filter(is_done).collect();
        if !done.is_empty() {
            tell(format_args!("{} of {} case(s) were complete before", done.len(), chosen.len()));
        }
        let mut view = View {
            folder: folder.clone(),
            sweep: sweep.clone(),
            run: run.to_owned(),
            open: chosen.iter().copied().filter(|case| !done.contains(case)).collect(),
            total: chosen.len(),
            steps: steps(chosen),
            done_before: steps(&done),
            begun: Instant::now(),
            last_line: Instant::now(),
            bars: terminal().map(|target| Bars::new(target, steps(chosen))),
        };
        let (stop, stopped) = mpsc::channel();
        let thread = std::thread::Builder::new().name("mpjr sweep".into()).spawn(move || {
            while stopped.recv_timeout(LOOK_EVERY) == Err(RecvTimeoutError::Timeout) {
                view.update(false);
            }
            view.update(true);
        });
        let thread = thread.map_err(|error| Error::Internal(format!("cannot start a thread: {error}")))?;
        Ok(Self { stop: Some(stop), thread: Some(thread) })
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // It only shows.
            let _ = thread.join();
        }
    }
}

impl View {
    /// Looks at all open cases once more.
    fn update(&mut self, last: bool) {
        let mut running = Vec::new();
        let (mut ended, mut still) = (Vec::new(), Vec::new());
        for &case in &self.open {
            let told = told(&self.folder.claim(case));
            match told {
                Told { ended: true, ref run, .. } if *run == self.run => ended.push(case),
                Told { ref run, steps, .. } if *run == self.run && steps[1] > 0 => {
                    running.push((case, steps));
                    still.push(case);
                }
                _ => still.push(case),
            }
        }
        self.open = still;
        for case in ended {
            self.tell_end(case);
        }
        if !last {
            self.show(&running);
        } else if let Some(bars) = &self.bars {
            // A terminal that cannot be cleared keeps its lines.
            let _ = bars.all.clear();
        }
    }

    fn tell_end(&mut self, case: usize) {
        let state = self.folder.state(&self.sweep, case);
        let record = self.folder.record(case).unwrap_or_default();
        let reason = if record.reason.is_empty() { String::new() } else { format!(": {}", record.reason) };
        let line = format!(
            "case {case} ({}): {}{reason}, {}",
            self.sweep.label(case),
            state.word(),
            seconds(record.wall_seconds)
        );
        match &mut self.bars {
            Some(bars) => {
                if let Some(bar) = bars.cases.remove(&case) {
                    bar.finish_and_clear();
                }
                // A terminal that takes no line shows the bars only.
                let _ = bars.all.println(line);
            }
            None => tell(line),
        }
    }

    fn show(&mut self, running: &[(usize, [usize; 2])]) {
        let open: usize = self.open.iter().map(|&case| self.sweep.cases[case].scene.steps()).sum();
        let done = (self.steps - open + running.iter().map(|(_, [done, _])| done).sum::<usize>()).min(self.steps);
        let fresh = done.saturating_sub(self.done_before);
        let elapsed = self.begun.elapsed().as_secs_f64();
        // Steps are cheap or dear, and setting up and what cases share are no steps: before this much is done, they tell
        // nothing of the rest.
        let todo = self.steps - self.done_before;
        let left = match fresh as f64 >= TELLING * todo as f64 && fresh > 0 {
            true => format!(", {} left", seconds(elapsed * (self.steps - done) as f64 / fresh as f64)),
            false => String::new(),
        };
        let total = format!("{} of {} case(s) ended{left}", self.total - self.open.len(), self.total);
        let Some(bars) = &mut self.bars else {
            if self.last_line.elapsed() >= LINE_EVERY {
                self.last_line = Instant::now();
                for (case, [done, steps]) in running {
                    tell(format_args!("case {case} ({}): {done}/{steps} steps", self.sweep.label(*case)));
                }
                tell(total);
            }
            return;
        };
        for (case, [done, steps]) in running {
            let bar = bars.of(*case, *steps);
            bar.set_message(format!("case {case} ({})", self.sweep.label(*case)));
            bar.set_position(*done as u64);
        }
        bars.total.set_position(done as u64);
        bars.total.set_message(total);
    }
}

/// Within any width: what is longer is cut.
fn styled(bar: ProgressBar) -> ProgressBar {
    // A template that is wrong is a defect that the default one survives.
    match ProgressStyle::with_template("{bar:12} {pos}/{len}  {wide_msg}") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
