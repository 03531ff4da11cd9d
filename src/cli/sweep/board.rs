//! What is shown of a sweep while it runs: a line per running case and a total. A thread reads what the groups tell in
//! their claim files, so that nobody's solving waits for the showing.

use std::collections::BTreeMap;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

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
    bars: Option<(MultiProgress, BTreeMap<usize, ProgressBar>)>,
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
            bars: terminal().map(|target| (MultiProgress::with_draw_target(target), BTreeMap::new())),
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
        } else if let Some((all, _)) = &self.bars {
            // A terminal that cannot be cleared keeps its lines.
            let _ = all.clear();
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
            Some((all, bars)) => {
                if let Some(bar) = bars.remove(&case) {
                    bar.finish_and_clear();
                }
                // A terminal that takes no line shows the bars only.
                let _ = all.println(line);
            }
            None => tell(line),
        }
    }

    fn show(&mut self, running: &[(usize, [usize; 2])]) {
        let open: usize = self.open.iter().map(|&case| self.sweep.cases[case].scene.steps()).sum();
        let done = (self.steps - open + running.iter().map(|(_, [done, _])| done).sum::<usize>()).min(self.steps);
        let fresh = done.saturating_sub(self.done_before);
        let elapsed = self.begun.elapsed().as_secs_f64();
        let left = match fresh {
            0 => String::new(),
            _ => format!(", {} left", seconds(elapsed * (self.steps - done) as f64 / fresh as f64)),
        };
        let total = format!("{} of {} case(s) ended{left}", self.total - self.open.len(), self.total);
        let Some((all, bars)) = &mut self.bars else {
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
            let bar = bars.entry(*case).or_insert_with(|| styled(all.add(ProgressBar::new(*steps as u64))));
            bar.set_message(format!("case {case} ({})", self.sweep.label(*case)));
            bar.set_position(*done as u64);
        }
        let bar = bars.entry(usize::MAX).or_insert_with(|| styled(all.add(ProgressBar::new(self.steps as u64))));
        bar.set_position(done as u64);
        bar.set_message(total);
    }
}

fn styled(bar: ProgressBar) -> ProgressBar {
    // A template that is wrong is a defect that the default one survives.
    match ProgressStyle::with_template("{bar:30} {pos}/{len}  {msg}") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
