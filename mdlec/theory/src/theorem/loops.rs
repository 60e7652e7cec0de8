//! Applies Theorem 1 to machines with endless loops (R4), by a backtracking search for an order of the states. The
//! search abandons a prefix of an order if no next state is possible.

use std::collections::BTreeSet;

use super::beginning::{Before, Beginning, Boundary, OpenScope};
use super::{Broken, Found, InterruptId, Machine, State, TheoremResult};

/// Maximum number of states that are reported as impossible successors of the longest prefix.
const TOLD: usize = 10;

/// Number of steps after which failed prefixes are remembered; most searches end earlier.
const REMEMBERS: u64 = 2_000;

/// A step of the search: a position with a state, and the continuations that have been tried.
struct SearchStep {
    /// Scopes that are open at this position.
    open: Vec<OpenScope>,
    /// Index of the next state to try, in a list that begins with the states to which the last state leads, followed by
    /// all others.
    candidate: usize,
    /// Number, counted from 1, of the open scope that ends here in addition to those that must end; 0 for no scope.
    extra: usize,
    /// Data with which the step can be undone.
    before: Before,
}

struct LoopSearch<'m> {
    machine: &'m Machine,
    /// States in the order in which they are tried.
    candidates: &'m [State],
    /// States to which each state leads, without duplicates.
    next: Vec<Vec<State>>,
    beginning: Beginning<'m>,
    /// Hashes of prefixes that cannot be completed to a string.
    failed: BTreeSet<[u8; 32]>,
    furthest: Furthest,
    leaves: Leaves,
}

/// The longest prefix found, with the reasons why no state can follow it.
#[derive(Default)]
struct Furthest {
    begins: Vec<State>,
    tries: Vec<(State, Broken)>,
    more: usize,
}

/// Cases that a search omits in its first attempt, because most strings are found without them.
#[derive(Debug, Clone, Copy)]
struct Leaves {
    /// The interrupt that fires when a law completes, if the search lets it end only atoms; `None` if every interrupt
    /// may end any scope.
    completed: Option<InterruptId>,
    /// `true` if no scope may end before a state to which its interrupt also leads from later states.
    early_ends: bool,
}

/// Searches for the string of a machine with cycles in at most `steps` steps. States are tried in the order of
/// `candidates`.
pub(super) fn search(machine: &Machine, candidates: &[State], steps: u64) -> TheoremResult {
    let completed = machine.completed();
    let atoms_only = completed.map(|_| completed);
    let mut taken = 0;
    let mut answer = TheoremResult::Stopped(steps);
    for completed in atoms_only.into_iter().chain([None]) {
        for early_ends in [true, false] {
            let search = LoopSearch::new(machine, candidates, Leaves { completed, early_ends });
            (answer, taken) = search.run(taken, steps);
            match answer {
                TheoremResult::String(_) | TheoremResult::Stopped(_) => return answer,
                TheoremResult::None(_) => {}
            }
        }
    }
    answer
}

/// Returns the states to which a state leads, without duplicates. The destination of the last interrupt, which is the
/// innermost interrupt in machines that were made from plans, comes first.
fn successors(machine: &Machine, state: State) -> Vec<State> {
    let mut seen = BTreeSet::new();
    machine.exits(state).iter().rev().map(|exit| exit.to).filter(|to| seen.insert(*to)).collect()
}

impl<'m> LoopSearch<'m> {
    fn new(machine: &'m Machine, candidates: &'m [State], leaves: Leaves) -> Self {
        let states = (0..candidates.len()).map(|place| State(super::number(place)));
        Self {
            machine,
            candidates,
            next: states.map(|state| successors(machine, state)).collect(),
            beginning: Beginning::new(machine, leaves.completed),
            failed: BTreeSet::new(),
            furthest: Furthest::default(),
            leaves,
        }
    }

    /// Continues the search from step `taken` to at most step `limit`; returns the answer and the total number of
    /// steps.
    fn run(mut self, taken: u64, limit: u64) -> (TheoremResult, u64) {
        let mut steps = taken;
        let mut path = vec![SearchStep { open: Vec::new(), candidate: 0, extra: 0, before: Before::default() }];
        while let Some(step) = path.last_mut() {
            let Some(next) = self.candidate(step) else {
                if let Some(step) = path.pop() {
                    if steps > taken + REMEMBERS {
                        self.failed.insert(self.beginning.outline(&step.open));
                    }
                    self.beginning.take_back(step.before);
                }
                continue;
            };
            steps += 1;
            if steps > limit {
                return (TheoremResult::Stopped(limit), steps);
            }
            let Some(ending) = self.ending(step, next) else { continue };
            let (open, before) = self.beginning.fill(ending, next);
            if !self.failed.is_empty() && self.failed.contains(&self.beginning.outline(&open)) {
                self.beginning.take_back(before);
                continue;
            }
            path.push(SearchStep { open, candidate: 0, extra: 0, before });
            if self.beginning.order.len() == self.candidates.len() {
                let Beginning { order, runs, loops, .. } = self.beginning;
                return (TheoremResult::String(Found { order, runs, loops }), steps);
            }
        }
        let Furthest { begins, tries, more } = self.furthest;
        (TheoremResult::None(vec![Broken::NoOrder { begins, tries, more }]), steps)
    }

    /// Returns the next state to try. States to which the last state leads come first, then all others. After them, in
    /// the same order, come states before which a scope would end although other states of the scope have no position
    /// yet.
    fn candidate(&self, step: &mut SearchStep) -> Option<State> {
        let order = &self.beginning.order;
        let near = order.last().map_or(&[][..], |last| &self.next[last.0 as usize]);
        let leads_back = order.is_empty() || near.iter().any(|to| self.beginning.place(*to).is_some());
        // A state to which the last state does not lead can only follow a loop.
        let far = if leads_back { self.candidates } else { &[] };
        let is_last = order.len() + 1 == self.candidates.len();
        loop {
            let count = near.len() + far.len();
            let (place, is_late) = match step.candidate.checked_sub(count) {
                None => (step.candidate, false),
                Some(place) if place < count && !self.leaves.early_ends => (place, true),
                Some(_) => return None,
            };
            let state = near.get(place).copied().or_else(|| far.get(place - near.len()).copied())?;
            let is_out = self.beginning.place(state).is_some()
                || (state == self.machine.end()) != is_last
                || (place >= near.len() && near.contains(&state))
                || (order.is_empty() && self.machine.start().is_some_and(|first| first != state))
                || self.beginning.ends_too_early(&step.open, state) != is_late;
            if !is_out {
                return Some(state);
            }
            (step.candidate, step.extra) = (step.candidate + 1, 0);
        }
    }

    /// Returns the scopes and loops that end if `next` follows. Each call ends another open scope in addition to those
    /// that must end; the first call ends no additional scope. Returns `None` if they cannot end.
    fn ending(&mut self, step: &mut SearchStep, next: State) -> Option<Boundary> {
        let extra = step.extra.checked_sub(1);
        let result = self.beginning.ending(&step.open, next, extra);
        step.extra += 1;
        if step.extra > step.open.len() {
            (step.candidate, step.extra) = (step.candidate + 1, 0);
        }
        match result {
            Ok(ending) => ending,
            Err(broken) => {
                if extra.is_none() {
                    self.furthest.note(&self.beginning.order, next, broken);
                }
                None
            }
        }
    }
}

impl Furthest {
    fn note(&mut self, order: &[State], next: State, broken: Broken) {
        if order.len() > self.begins.len() || (self.tries.is_empty() && order.is_empty()) {
            *self = Self { begins: order.to_vec(), tries: Vec::new(), more: 0 };
        }
        if order != self.begins || self.tries.iter().any(|known| *known == (next, broken.clone())) {
            return;
        }
        if self.tries.len() < TOLD {
            self.tries.push((next, broken));
        } else {
            self.more += 1;
        }
    }
}
