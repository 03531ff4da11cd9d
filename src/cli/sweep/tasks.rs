//! What is still to be done of a sweep, and what a group does next.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::super::origin::is_of;
use super::claim::Claim;
use super::folder::{Folder, State};
use crate::error::Result;
use crate::output::{checkpoint, left};
use crate::scene::Scene;
use crate::scene::sweep::Sweep;

/// The cases of a sweep, seen by one group.
pub struct Tasks<'a> {
    pub sweep: &'a Sweep,
    pub folder: &'a Folder,
    /// Names this start of the program.
    pub run: String,
    /// The cases in the order in which they are tried, and whether nothing is left to do about each.
    order: Vec<(usize, bool)>,
    shared: Vec<Shared>,
    /// For each case, its entry of `shared`.
    of_case: Vec<Option<usize>>,
}

/// Phases at the beginning of several cases.
pub struct Shared {
    /// These phases alone.
    pub scene: Scene,
    /// Their results.
    pub results: PathBuf,
    /// How many phases.
    pub phases: usize,
    cases: Vec<usize>,
    /// They could not be solved: each case finds that out for itself.
    given_up: bool,
}

/// What a group does next.
pub enum Next {
    /// Solve the case; `from` are the shared phases that it goes on from.
    Case { case: usize, from: Option<usize>, claim: Claim },
    /// Solve shared phases.
    Shared { shared: usize, claim: Claim },
    /// Wait for another group to solve shared phases.
    Wait,
    /// Nothing is left.
    Nothing,
}

impl<'a> Tasks<'a> {
    /// The `chosen` cases; those that failed before come last.
    pub fn new(sweep: &'a Sweep, folder: &'a Folder, chosen: &[usize], run: String) -> Self {
        let mut order: Vec<(usize, bool)> = chosen.iter().map(|&case| (case, false)).collect();
        order.sort_by_key(|&(case, _)| matches!(folder.state(sweep, case), State::Failed(_)));
        let (shared, of_case) = shared(sweep, folder);
        Self { sweep, folder, run, order, shared, of_case }
    }

    /// Shared phases by their number.
    pub fn shared(&self, number: usize) -> Option<&Shared> {
        self.shared.get(number)
    }

    /// The shared phases could not be solved.
    pub fn give_up(&mut self, number: usize) {
        if let Some(shared) = self.shared.get_mut(number) {
            shared.given_up = true;
        }
    }

    /// Claims what is to be done next.
    pub fn next(&mut self) -> Result<Next> {
        let mut blocked = false;
        for at in 0..self.order.len() {
            let (case, settled) = self.order[at];
            if settled {
                continue;
            }
            if self.is_settled(case) {
                self.order[at].1 = true;
                continue;
            }
            let mut from = None;
            if let Some(number) = self.of_case[case].filter(|_| !self.has_checkpoint(case)) {
                let shared = &self.shared[number];
                if shared.is_ready(&self.sweep.file) {
                    from = Some(number);
                } else if !shared.given_up && self.pending(shared) > 1 {
                    match Claim::take(&shared.results.with_extension("claim"), &self.run)? {
                        // Another group may have been faster between the two looks.
                        Some(_) if shared.is_ready(&self.sweep.file) => from = Some(number),
                        Some(claim) => return Ok(Next::Shared { shared: number, claim }),
                        None => {
                            blocked = true;
                            continue;
                        }
                    }
                }
            }
            match Claim::take(&self.folder.claim(case), &self.run)? {
                Some(_) if self.is_settled(case) => self.order[at].1 = true,
                Some(claim) => return Ok(Next::Case { case, from, claim }),
                // Whoever has it sees to it.
                None => {}
            }
        }
        Ok(if blocked { Next::Wait } else { Next::Nothing })
    }

    fn state(&self, case: usize) -> State {
        self.folder.state(self.sweep, case)
    }

    /// Whether the case goes on from a state of its own.
    fn has_checkpoint(&self, case: usize) -> bool {
        self.state(case) == State::Stopped && checkpoint::beside(&self.folder.results(case)).exists()
    }

    /// Whether nothing is left to do about the case in this run.
    fn is_settled(&self, case: usize) -> bool {
        match self.state(case) {
            State::Complete => true,
            State::Failed(record) => record.run == self.run,
            _ => false,
        }
    }

    /// How many of the cases that share these phases are not done.
    fn pending(&self, shared: &Shared) -> usize {
        shared.cases.iter().filter(|&&case| !self.is_settled(case)).count()
    }
}

impl Shared {
    /// Whether the state at the end of the phases is there; `file` is that of the scene.
    fn is_ready(&self, file: &Path) -> bool {
        let left = left(&self.results).ok().flatten();
        let complete = left.is_some_and(|left| left.status == "complete" && is_of(&left, &self.scene, file));
        complete && checkpoint::beside(&self.results).exists()
    }
}

/// For each case the longest beginning, short of the whole, that it shares with another.
fn shared(sweep: &Sweep, folder: &Folder) -> (Vec<Shared>, Vec<Option<usize>>) {
    let beginnings = |scene: &Scene| -> Vec<(String, Scene, usize)> {
        let first = |count| scene.first_phases(count).map(|part| (part.to_toml(), part, count));
        (1..scene.phases.len()).rev().filter_map(first).collect()
    };
    let mut users: HashMap<String, usize> = HashMap::new();
    for case in &sweep.cases {
        for (key, ..) in beginnings(&case.scene) {
            *users.entry(key).or_default() += 1;
        }
    }
    let mut list: Vec<Shared> = Vec::new();
    let mut known: HashMap<String, usize> = HashMap::new();
    let mut of_case = Vec::with_capacity(sweep.cases.len());
    for (index, case) in sweep.cases.iter().enumerate() {
        let longest = beginnings(&case.scene).into_iter().find(|(key, ..)| users.get(key).is_some_and(|&n| n > 1));
        of_case.push(longest.map(|(key, scene, phases)| {
            let number = *known.entry(key).or_insert_with_key(|key| {
                let results = folder.shared(key);
                list.push(Shared { scene, results, phases, cases: Vec::new(), given_up: false });
                list.len() - 1
            });
            list[number].cases.push(index);
            number
        }));
    }
    (list, of_case)
}
