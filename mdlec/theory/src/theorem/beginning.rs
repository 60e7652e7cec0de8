//! The state of the search for an order of a machine's states: a prefix of the order, with its scopes and loops. Also
//! computes the scopes that must end if a given state follows the prefix, and checks that they can end (Theorem 1, R1
//! to R4).
//!
//! When a scope or a loop ends, the range of positions that it encloses is closed. Two invariants hold: any two closed
//! ranges are nested or disjoint, and each state except the last has an interrupt of its own.

mod fits;

use super::{Broken, InterruptId, Loop, Machine, ScopeRun, State, Stretch};

/// A scope that has not ended. Its interrupt leads to the state `to` from each position of the order from `first` on.
#[derive(Debug, Clone, Copy)]
pub(super) struct OpenScope {
    interrupt: InterruptId,
    first: usize,
    to: State,
}

/// Scopes and loops that end between two states.
#[derive(Default)]
pub(super) struct Boundary {
    runs: Vec<ScopeRun>,
    /// First positions of the loops that end at the boundary, in ascending order.
    loops: Vec<usize>,
    /// Scopes that continue after the boundary.
    open: Vec<OpenScope>,
    /// First position of the widest scope or loop that ends at the boundary; `None` if none ends.
    widest: Option<usize>,
}

/// Data with which a step can be undone.
#[derive(Default)]
pub(super) struct Before {
    runs: usize,
    loops: usize,
    /// Closed ranges that the step has enclosed in a wider closed range.
    wholes: Vec<(usize, usize)>,
    has_whole: bool,
}

/// Prefix of an order of a machine's states.
pub(super) struct Beginning<'m> {
    machine: &'m Machine,
    pub(super) order: Vec<State>,
    places: Vec<Option<usize>>,
    /// States that lead to each state.
    sources: Vec<Vec<State>>,
    pub(super) runs: Vec<ScopeRun>,
    pub(super) loops: Vec<Loop>,
    /// First and last position of each closed range that is not inside another closed range.
    wholes: Vec<(usize, usize)>,
    /// The interrupt that fires when a law completes, if the search lets it end only atoms; `None` if every interrupt
    /// may end any scope.
    completed: Option<InterruptId>,
}

impl<'m> Beginning<'m> {
    pub(super) fn new(machine: &'m Machine, completed: Option<InterruptId>) -> Self {
        let places = vec![None; machine.states().len()];
        let mut sources = vec![Vec::new(); places.len()];
        for state in machine.atoms() {
            machine.exits(state).iter().for_each(|exit| sources[exit.to.0 as usize].push(state));
        }
        Self {
            machine,
            order: Vec::new(),
            places,
            sources,
            runs: Vec::new(),
            loops: Vec::new(),
            wholes: Vec::new(),
            completed,
        }
    }

    pub(super) fn place(&self, state: State) -> Option<usize> {
        self.places[state.0 as usize]
    }

    /// Returns the scopes and loops that end if the state `next` follows: those that must end and, if `extra` is given,
    /// the open scope with this index. Returns `None` if the scope `extra` must end anyway, or must not end.
    ///
    /// More than one extra scope is never needed. The reason for ending a scope early is that it provides an interrupt
    /// of its own for the state at this position or at the next position. If two scopes lead back, one of them suffices
    /// for both purposes. If a scope leads to its own start, its two parts could be joined instead.
    ///
    /// # Errors
    /// Returns the condition that `next` breaks.
    pub(super) fn ending(
        &self,
        open: &[OpenScope],
        next: State,
        extra: Option<usize>,
    ) -> Result<Option<Boundary>, Broken> {
        let Some(here) = self.order.len().checked_sub(1) else {
            return Ok(extra.is_none().then(Boundary::default));
        };
        let mut ends = Vec::with_capacity(open.len());
        let mut widest = here + 1;
        for run in open {
            let must_end = self.must_end(*run, next)?;
            ends.push(must_end);
            if must_end {
                widest = widest.min(self.reach(*run, next));
            }
        }
        self.spread(open, next, &mut ends, &mut widest)?;
        if let Some(extra) = extra {
            let run = open[extra];
            if ends[extra] || self.place(run.to).is_none() {
                return Ok(None);
            }
            ends[extra] = true;
            widest = widest.min(self.reach(run, next));
            self.spread(open, next, &mut ends, &mut widest)?;
        }
        self.ended(open, next, &ends, widest).map(Some)
    }

    /// Returns `true` if a scope would end before `next` although its interrupt also leads to `next` from other states
    /// that have no position yet.
    pub(super) fn ends_too_early(&self, open: &[OpenScope], next: State) -> bool {
        let mut ending = open.iter().filter(|run| run.to == next && self.completed != Some(run.interrupt));
        ending.any(|run| {
            let mut others = self.outside(next).filter(|source| *source != next);
            others.any(|source| self.machine.destination(source, run.interrupt) == Some(next))
        })
    }

    /// Returns `true` if the open scope `run` must end before the state `next`. Returns the broken condition if the
    /// scope can neither end nor continue.
    fn must_end(&self, run: OpenScope, next: State) -> Result<bool, Broken> {
        if run.to == next {
            return Ok(true);
        }
        let other = self.machine.destination(next, run.interrupt);
        let is_single = self.completed == Some(run.interrupt) && self.place(run.to).is_some();
        let goes_on = other == Some(run.to) && !is_single;
        if !goes_on && self.place(run.to).is_none() {
            let from = self.order[self.order.len() - 1];
            return Err(Broken::Skips { interrupt: run.interrupt, from, to: run.to, past: next, other });
        }
        Ok(!goes_on)
    }

    /// Returns the first position of an ending scope or, if the scope leads back, of the loop to whose start it leads.
    fn reach(&self, run: OpenScope, next: State) -> usize {
        if run.to == next { run.first } else { self.place(run.to).unwrap_or(run.first) }
    }

    /// Marks every scope that begins inside an ending scope as ending too. Returns the broken condition if such a scope
    /// cannot end.
    fn spread(&self, open: &[OpenScope], next: State, ends: &mut [bool], widest: &mut usize) -> Result<(), Broken> {
        for (run, ends) in open.iter().zip(ends).rev() {
            if run.first <= *widest {
                break;
            }
            if !*ends && self.place(run.to).is_none() {
                return Err(self.crossing(*run, open, *widest, next));
            }
            *ends = true;
            *widest = (*widest).min(self.reach(*run, next));
        }
        Ok(())
    }

    /// Returns the condition that is broken if the scope `run` continues although a scope that encloses its first state
    /// ends.
    fn crossing(&self, run: OpenScope, open: &[OpenScope], widest: usize, next: State) -> Broken {
        let around = open.iter().find(|around| around.first == widest || self.place(around.to) == Some(widest));
        let [.., here] = *self.order.as_slice() else { return Broken::NoExit(next) };
        Broken::Crosses {
            interrupt: around.unwrap_or(&run).interrupt,
            around: Stretch { first: self.order[widest], last: here },
            other: run.interrupt,
            begins: self.order[run.first],
            goes_on: next,
        }
    }

    /// Returns the boundary at which the scopes marked in `ends` end, or the condition that is broken if they end
    /// there.
    fn ended(&self, open: &[OpenScope], next: State, ends: &[bool], widest: usize) -> Result<Boundary, Broken> {
        let here = self.order.len() - 1;
        let mut ending = Boundary { widest: Some(widest), ..Boundary::default() };
        for (run, ends) in open.iter().zip(ends) {
            if !ends {
                ending.open.push(*run);
                continue;
            }
            let to = if run.to == next { here + 1 } else { self.place(run.to).unwrap_or(here + 1) };
            if to <= here {
                ending.loops.push(to);
            }
            ending.runs.push(ScopeRun { interrupt: run.interrupt, first: run.first, last: here, to });
        }
        ending.loops.sort_unstable();
        ending.loops.dedup();
        if ending.runs.iter().all(|run| run.first != here) {
            return Err(Broken::NoOwnInterrupt { state: self.order[here], next, shared: None });
        }
        self.loops_fit(&ending, next)?;
        self.nothing_leads_inside(&ending, next, widest)?;
        Ok(ending)
    }

    /// Appends a state; returns the scopes that are open at this state, and the data with which this step can be
    /// undone.
    pub(super) fn fill(&mut self, ending: Boundary, next: State) -> (Vec<OpenScope>, Before) {
        let place = self.order.len();
        let mut before = Before { runs: self.runs.len(), loops: self.loops.len(), ..Before::default() };
        if let (Some(widest), Some(last)) = (ending.widest, place.checked_sub(1)) {
            let inside = self.wholes.partition_point(|(first, _)| *first < widest);
            before.wholes = self.wholes.split_off(inside);
            before.has_whole = true;
            self.wholes.push((widest, last));
            self.loops.extend(ending.loops.iter().map(|first| Loop { first: *first, last }));
        }
        self.runs.extend(ending.runs);
        self.order.push(next);
        self.places[next.0 as usize] = Some(place);
        let mut open = ending.open;
        let mut going: Vec<_> = open.iter().map(|run| run.interrupt).collect();
        going.sort_unstable();
        let begun = self.machine.exits(next).iter().filter(|exit| going.binary_search(&exit.interrupt).is_err());
        open.extend(begun.map(|exit| OpenScope { interrupt: exit.interrupt, first: place, to: exit.to }));
        (open, before)
    }

    /// Returns a hash of all data that determine which states can follow: the states that have a position, the first
    /// states of the closed ranges, the open scopes, and the last state. The order of the states inside a closed range
    /// no longer has an effect.
    pub(super) fn outline(&self, open: &[OpenScope]) -> [u8; 32] {
        let mut placed = vec![0_u8; self.places.len().div_ceil(8)];
        for state in &self.order {
            placed[state.0 as usize / 8] |= 1 << (state.0 % 8);
        }
        let mut hash = blake3::Hasher::new();
        hash.update(&placed);
        let mut put = |number: u32| {
            hash.update(&number.to_le_bytes());
        };
        self.wholes.iter().for_each(|(first, _)| put(self.order[*first].0));
        self.order.iter().last().iter().for_each(|last| put(last.0));
        for run in open {
            let begins = self.wholes.partition_point(|(first, _)| *first < run.first);
            [run.interrupt.0, run.to.0, super::number(begins)].into_iter().for_each(&mut put);
        }
        hash.finalize().into()
    }

    /// Removes the last state.
    pub(super) fn take_back(&mut self, before: Before) {
        if let Some(state) = self.order.pop() {
            self.places[state.0 as usize] = None;
        }
        self.runs.truncate(before.runs);
        self.loops.truncate(before.loops);
        if before.has_whole {
            self.wholes.pop();
            self.wholes.extend(before.wholes);
        }
    }
}
