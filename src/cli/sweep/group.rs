//! The ranks that solve cases together.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::{Duration, Instant};

use mpi::topology::{Color, SimpleCommunicator};
use mpi::traits::{Communicator, CommunicatorCollectives};

use super::super::case::{self, Job};
use super::super::interrupt::Interrupt;
use super::super::origin::{self, Origin};
use super::super::progress::Progress;
use super::super::terminal::warn;
use super::claim::Claim;
use super::folder::Record;
use super::tasks::{Next, Tasks};
use crate::composition::Compliances;
use crate::error::{Error, Result};
use crate::parallel::{agree, any, broadcast};
use crate::petsc::Session;

/// How often a rank that waits looks again.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// Some of the ranks.
pub struct Group {
    comm: SimpleCommunicator,
    /// What cases have in common.
    compliances: Compliances,
}

/// What all ranks of a group do next: the decision of its rank 0.
#[derive(Clone, Copy, PartialEq)]
enum Order {
    Case { case: usize, from: Option<usize> },
    Shared(usize),
    Wait,
    Nothing,
}

impl Group {
    /// Splits all ranks into groups of `ranks`; those that are left over join the last one.
    pub fn split(world: &SimpleCommunicator, ranks: usize) -> Self {
        let groups = (world.size() as usize / ranks).max(1);
        let color = Color::with_value((world.rank() as usize / ranks).min(groups - 1) as i32);
        let comm = world.split_by_color(color).unwrap_or_else(|| world.duplicate());
        Self { comm, compliances: Compliances::default() }
    }

    /// Solves whatever is to be done, until nothing is left or a signal comes.
    ///
    /// # Errors
    /// What makes going on pointless: a directory that cannot be written to, or a library's failure on several ranks.
    pub fn work(&self, session: &Session, interrupt: &Interrupt, mut tasks: Tasks<'_>) -> Result<()> {
        while !any(&self.comm, interrupt.requested()) {
            let (order, claim) = self.decide(&mut tasks)?;
            let claim = claim.map(|claim| Rc::new(RefCell::new(claim)));
            match order {
                Order::Nothing => return Ok(()),
                Order::Wait => std::thread::sleep(LOOK_EVERY),
                Order::Shared(number) => self.solve_shared((session, interrupt), &mut tasks, number, claim.as_ref())?,
                Order::Case { case, from } => {
                    self.solve_case((session, interrupt), &tasks, (case, from), claim.as_ref())?;
                }
            }
            if let Some(claim) = claim {
                claim.borrow_mut().end();
            }
        }
        Ok(())
    }

    /// Rank 0 claims the next piece of work and tells the others.
    fn decide(&self, tasks: &mut Tasks<'_>) -> Result<(Order, Option<Claim>)> {
        let mine = if self.comm.rank() == 0 { tasks.next() } else { Ok(Next::Nothing) };
        let (order, claim) = match agree(&self.comm, mine)? {
            Next::Case { case, from, claim } => (Order::Case { case, from }, Some(claim)),
            Next::Shared { shared, claim } => (Order::Shared(shared), Some(claim)),
            Next::Wait => (Order::Wait, None),
            Next::Nothing => (Order::Nothing, None),
        };
        let mut numbers = match order {
            Order::Nothing => vec![0],
            Order::Wait => vec![1],
            Order::Shared(number) => vec![2, number as u64],
            Order::Case { case, from: None } => vec![3, case as u64],
            Order::Case { case, from: Some(from) } => vec![4, case as u64, from as u64],
        }
        .into_iter()
        .flat_map(u64::to_ne_bytes)
        .collect();
        broadcast(&self.comm, 0, &mut numbers);
        let numbers: Vec<usize> =
            numbers.as_chunks().0.iter().map(|bytes| u64::from_ne_bytes(*bytes) as usize).collect();
        let order = match numbers[..] {
            [1] => Order::Wait,
            [2, number] => Order::Shared(number),
            [3, case] => Order::Case { case, from: None },
            [4, case, from] => Order::Case { case, from: Some(from) },
            _ => Order::Nothing,
        };
        Ok((order, claim))
    }

    /// Solves phases that cases share and keeps the state at their end. That it fails is for each case to tell.
    fn solve_shared(
        &self,
        (session, interrupt): (&Session, &Interrupt),
        tasks: &mut Tasks<'_>,
        number: usize,
        claim: Option<&Rc<RefCell<Claim>>>,
    ) -> Result<()> {
        let Some(shared) = tasks.shared(number) else { return Ok(()) };
        let job = Job {
            session,
            comm: &self.comm,
            interrupt,
            scene: &shared.scene,
            file: &tasks.sweep.file,
            out: &shared.results,
            origin: Origin::Rest,
            compliances: &self.compliances,
            keep_state: true,
            doubt: &|_| {},
        };
        let outcome = case::solve(&job, |total| Progress::claim(claim.cloned(), total)).and_then(|done| done.result);
        match outcome {
            Ok(()) | Err(Error::Stopped(_)) => Ok(()),
            Err(error @ Error::Internal(_)) if self.comm.size() > 1 => Err(error),
            Err(_) => {
                tasks.give_up(number);
                Ok(())
            }
        }
    }

    /// Solves a case and keeps how it ended.
    fn solve_case(
        &self,
        (session, interrupt): (&Session, &Interrupt),
        tasks: &Tasks<'_>,
        (case, from): (usize, Option<usize>),
        claim: Option<&Rc<RefCell<Claim>>>,
    ) -> Result<()> {
        let begun = Instant::now();
        let (scene, out) = (&tasks.sweep.cases[case].scene, tasks.folder.results(case));
        let aside = if self.comm.rank() == 0 { tasks.folder.set_aside(case) } else { Ok(None) };
        if let Some(text) = agree(&self.comm, aside)? {
            warn(text);
        }
        // What a run that was stopped left; anything else is begun anew.
        let can_resume =
            self.comm.rank() == 0 && matches!(origin::is_complete(&out, scene, &tasks.sweep.file), Ok(false));
        let shared = from.and_then(|from| tasks.shared(from));
        let damaged = self.comm.rank() == 0 && shared.is_some_and(|shared| origin::is_intact(&shared.results).is_err());
        let origin = match shared.filter(|_| !any(&self.comm, damaged)) {
            _ if any(&self.comm, can_resume) => Origin::Checkpoint,
            Some(shared) => Origin::Shared { results: &shared.results, phases: shared.phases },
            None => Origin::Rest,
        };
        let file = &tasks.sweep.file;
        let job = Job {
            session,
            comm: &self.comm,
            interrupt,
            scene,
            file,
            out: &out,
            origin,
            compliances: &self.compliances,
            keep_state: false,
            // They are in its file, and told of all cases together at the end.
            doubt: &|_| {},
        };
        let outcome = case::solve(&job, |total| Progress::claim(claim.cloned(), total)).and_then(|done| done.result);
        let record = Record {
            run: tasks.run.clone(),
            exit: outcome.as_ref().map_or_else(Error::exit_code, |()| 0),
            reason: outcome.as_ref().map_or_else(ToString::to_string, |()| String::new()),
            wall_seconds: begun.elapsed().as_secs_f64(),
            scene: scene.to_toml(),
        };
        let lost = matches!(outcome, Err(Error::Internal(_))) && self.comm.size() > 1;
        let kept = if self.comm.rank() == 0 || lost { tasks.folder.keep_record(case, &record) } else { Ok(()) };
        match outcome {
            // The other ranks of the group may be anywhere: this ends all groups.
            Err(error) if lost => Err(error),
            _ => agree(&self.comm, kept),
        }
    }
}

/// Waits for all ranks without keeping the processor busy: others may still be at work on it.
pub fn wait_for_all(world: &SimpleCommunicator) {
    let mut barrier = world.immediate_barrier();
    while let Err(pending) = barrier.test() {
        barrier = pending;
        std::thread::sleep(LOOK_EVERY);
    }
}
