//! Checks that scopes and loops can end after a prefix of an order: no interrupt may lead into the middle of a closed
//! range (Theorem 1, R4).

use super::{Beginning, Boundary};
use crate::theorem::{Broken, InterruptId, State, Stretch};

impl Beginning<'_> {
    /// Checks that each ending scope leads to a position at which a loop can begin, and that it does not lead to a
    /// position before the start of a loop that ends at the same boundary (R4).
    pub(super) fn loops_fit(&self, ending: &Boundary, next: State) -> Result<(), Broken> {
        let here = self.order.len() - 1;
        let stretch = |first: usize, last: usize| Stretch { first: self.order[first], last: self.order[last] };
        for run in &ending.runs {
            let around = ending.loops.partition_point(|begin| run.to <= here && *begin <= run.to);
            // The completion of a law ends the innermost scope first.
            let is_innermost = self.completed == Some(run.interrupt);
            if let Some(begins) =
                ending.loops.get(around).filter(|begins| **begins < run.first + usize::from(is_innermost))
            {
                return Err(Broken::PastALoop {
                    interrupt: run.interrupt,
                    around: stretch(run.first, run.last),
                    to: if run.to > here { next } else { self.order[run.to] },
                    begins: self.order[*begins],
                });
            }
            let before = self.wholes.partition_point(|(first, _)| *first < run.to);
            let whole = before.checked_sub(1).map(|place| self.wholes[place]).filter(|(_, last)| run.to <= *last);
            if let Some((first, last)) = whole {
                return Err(Broken::IntoTheMiddle {
                    interrupt: run.interrupt,
                    from: self.order[here],
                    to: self.order[run.to],
                    whole: stretch(first, last),
                });
            }
        }
        Ok(())
    }

    /// Checks that every state that leads into the middle of an ending or continuing range of positions has a position
    /// in this range, or can still get one (R4).
    pub(super) fn nothing_leads_inside(&self, ending: &Boundary, next: State, widest: usize) -> Result<(), Broken> {
        let here = self.order.len() - 1;
        let inside = self.wholes.partition_point(|(first, _)| *first <= widest);
        let middles = self.wholes[inside..].iter().map(|(first, _)| *first).chain((here > widest).then_some(here));
        for middle in middles {
            if let Some(source) = self.outside(self.order[middle]).next() {
                return Err(self.leads_inside(source, self.order[middle], widest, self.order[here]));
            }
        }
        for source in self.outside(next).filter(|source| *source != next) {
            // `source` will have a later position and lead back to `next`. If it also leads to an earlier position, the
            // scope of that interrupt begins before `next`, so `next` must have the interrupt as well.
            let mut exits = self.machine.exits(source).iter().filter(|exit| self.place(exit.to).is_some());
            let lacking = exits.find(|exit| self.machine.destination(next, exit.interrupt) != Some(exit.to));
            if let Some(exit) = lacking {
                let (interrupt, to) = (exit.interrupt, exit.to);
                let other = self.machine.destination(next, interrupt);
                return Err(Broken::Skips { interrupt, from: source, to, past: next, other });
            }
        }
        for run in &ending.open {
            let apart = |source: &State| self.machine.destination(*source, run.interrupt) != Some(run.to);
            if let Some(source) = self.outside(next).find(apart) {
                return Err(self.leads_inside(source, next, run.first, next));
            }
        }
        Ok(())
    }

    /// Returns the states that lead to `state` and have no position yet.
    pub(super) fn outside(&self, state: State) -> impl Iterator<Item = State> {
        self.sources[state.0 as usize].iter().copied().filter(|source| self.place(*source).is_none())
    }

    /// Returns the condition that the state `from`, which has no position, breaks because it leads to `to` in the
    /// middle of the range that begins at position `first`.
    fn leads_inside(&self, from: State, to: State, first: usize, last: State) -> Broken {
        let exit = self.machine.exits(from).iter().find(|exit| exit.to == to);
        let interrupt = exit.map_or(InterruptId(0), |exit| exit.interrupt);
        Broken::IntoTheMiddle { interrupt, from, to, whole: Stretch { first: self.order[first], last } }
    }
}
