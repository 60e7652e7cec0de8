//! Theorem 1 with loops without end (R4): a search among the orders of the states that gives up a beginning as soon as
//! nothing that could follow it makes it a string.

use std::collections::BTreeSet;

use super::beginning::{Before, Beginning, Ending, Open};
use super::{Answer, Broken, Found, InterruptId, Machine, State};

/// So many ways on from the beginning that gets furthest are told.
const TOLD: usize = 10;

/// What failed is remembered from this step on: most searches never come so far.
const REMEMBERS: u64 = 2_000;

/// A place that is filled, and which ways on from it have been tried.
struct Step {
    /// What is open with this place.
    open: Vec<Open>,
    /// Which state is tried next: those that the last one leads to, then all others.
    candidate: usize,
    /// Which scope is tried to end here besides those that have to: one of those that are open, from 1.
    extra: usize,
    /// What takes it back.
    before: Before,
}

struct Search<'m> {
    machine: &'m Machine,
    /// The states in the order in which they are tried.
    candidates: &'m [State],
    /// What each state leads to, each once.
    next: Vec<Vec<State>>,
    beginning: Beginning<'m>,
    /// The outlines of beginnings that cannot be a string's.
    failed: BTreeSet<[u8; 32]>,
    furthest: Furthest,
    leaves: Leaves,
}

/// The beginning that gets furthest, and why it does not get further.
#[derive(Default)]
struct Furthest {
    begins: Vec<State>,
    tries: Vec<(State, Broken)>,
    more: usize,
}

/// What a search leaves out at first, since most strings are found without.
#[derive(Debug, Clone, Copy)]
struct Leaves {
    /// Laws that are done end anything but atoms: this is their interrupt.
    completed: Option<InterruptId>,
    /// A scope ends though its interrupt leads there from states that come later.
    early_ends: bool,
}

/// Looks for a string of a machine in which something leads back, trying states in the order of `candidates`.
pub(super) fn search(machine: &Machine, candidates: &[State], steps: u64) -> Answer {
    let completed = machine.completed();
    let atoms_only = completed.map(|_| completed);
    let mut taken = 0;
    let mut answer = Answer::Stopped(steps);
    for completed in atoms_only.into_iter().chain([None]) {
        for early_ends in [true, false] {
            let search = Search::new(machine, candidates, Leaves { completed, early_ends });
            (answer, taken) = search.run(taken, steps);
            match answer {
                Answer::String(_) | Answer::Stopped(_) => return answer,
                Answer::None(_) => {}
            }
        }
    }
    answer
}

/// What a state leads to, each once, that of the last interrupt first: it is the innermost in what the lowering writes.
fn successors(machine: &Machine, state: State) -> Vec<State> {
    let mut seen = BTreeSet::new();
    machine.exits(state).iter().rev().map(|exit| exit.to).filter(|to| seen.insert(*to)).collect()
}

impl<'m> Search<'m> {
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

    /// What comes of it, and how many steps have been taken when it does.
    fn run(mut self, taken: u64, limit: u64) -> (Answer, u64) {
        let mut steps = taken;
        let mut path = vec![Step { open: Vec::new(), candidate: 0, extra: 0, before: Before::default() }];
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
                return (Answer::Stopped(limit), steps);
            }
            let Some(ending) = self.ending(step, next) else { continue };
            let (open, before) = self.beginning.fill(ending, next);
            if !self.failed.is_empty() && self.failed.contains(&self.beginning.outline(&open)) {
                self.beginning.take_back(before);
                continue;
            }
            path.push(Step { open, candidate: 0, extra: 0, before });
            if self.beginning.order.len() == self.candidates.len() {
                let Beginning { order, runs, loops, .. } = self.beginning;
                return (Answer::String(Found { order, runs, loops }), steps);
            }
        }
        let Furthest { begins, tries, more } = self.furthest;
        (Answer::None(vec![Broken::NoOrder { begins, tries, more }]), steps)
    }

    /// The next state to be tried: those that the last one leads to, then all others; and at the end, in the same order, those
    /// before which a scope would end though not all that it may hold is there.
    fn candidate(&self, step: &mut Step) -> Option<State> {
        let order = &self.beginning.order;
        let near = order.last().map_or(&[][..], |last| &self.next[last.0 as usize]);
        let leads_back = order.is_empty() || near.iter().any(|to| self.beginning.place(*to).is_some());
        // What nothing leads to can only follow a loop.
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

    /// What ends if this state follows, in the next of the ways that are left; nothing if it cannot.
    fn ending(&mut self, step: &mut Step, next: State) -> Option<Ending> {
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
