//! A loaded plan, whose turns can be observed while it runs.

use std::sync::Arc;

use mdle_runtime::{Alphabet, Begin, Cause, Ending, Fsm, Measured, Meeting, ModuleRead, Nanos, Plan, Words};

use super::moments::{PlanMoment, Position, moment};
use super::table::LoadedRows;
use super::{Entered, Loaded};
use crate::fsm::Machine;

/// A loaded plan. It owns all its data, so one thread can load it and another thread can run it.
pub struct LoadedPlan<A: Alphabet> {
    rows: LoadedRows<A>,
    /// The moments that were observed; `None` if the plan is not observed.
    looked_at: Option<Box<LookedAt<A>>>,
    /// `true` if the plan is observed, or needs odometry, progress or memories.
    observes: bool,
    /// `true` if the plan needs odometry or progress.
    has_stamps: bool,
}

/// The observed moments of a plan.
struct LookedAt<A: Alphabet> {
    loaded: Arc<Loaded<A>>,
    machine: Arc<Machine>,
    /// Storage for the entry of each level of scopes, including levels without timers.
    entered: Entered,
    /// Time of the last turn; `None` before the first turn.
    t: Option<Nanos>,
    /// The moments of the last turn, in order.
    moments: Vec<PlanMoment>,
}

impl<A: Alphabet> Loaded<A> {
    /// Creates a run of the plan, which has not begun yet.
    #[must_use]
    pub fn plan(self: &Arc<Self>) -> LoadedPlan<A> {
        LoadedPlan::new(self.rows(), self, self.machine())
    }
}

impl<A: Alphabet> LoadedPlan<A> {
    /// Creates the plan of these rows before it begins. If `machine` is given, the plan is observed.
    fn new(rows: LoadedRows<A>, loaded: &Arc<Loaded<A>>, machine: Option<Arc<Machine>>) -> Self {
        let looked_at = machine.map(|machine| {
            let loaded = Arc::clone(loaded);
            let entered = Entered::observed(&machine);
            Box::new(LookedAt { loaded, machine, entered, t: None, moments: Vec::new() })
        });
        let observes = looked_at.is_some() || loaded.observes();
        Self { rows, looked_at, observes, has_stamps: loaded.has_stamps() }
    }

    /// Stops the observation of the plan, so that the moments of its turns are no longer recorded.
    #[must_use]
    pub fn unobserved(self) -> Self {
        Self { looked_at: None, ..self }
    }

    /// Returns the machine of the plan and the moments of its last turn, in order; `None` if the plan is not
    /// observed.
    #[must_use]
    pub fn looked_at(&self) -> Option<(&Arc<Machine>, &[PlanMoment])> {
        self.looked_at.as_ref().map(|looked_at| (&looked_at.machine, &*looked_at.moments))
    }

    /// Returns a copy of the plan before it begins; `None` if the plan is not observed.
    #[must_use]
    pub fn again(&self) -> Option<Self> {
        self.looked_at.as_ref().map(|looked_at| looked_at.loaded.plan())
    }
}

impl<A: Alphabet> LookedAt<A> {
    /// Records a moment: the state before a transition, or at the end of a turn.
    fn note(&mut self, rows: &LoadedRows<A>, cursor: &Position, cause: Option<Cause>, y: &A::Output, t: Nanos) {
        // A plan that resumes after a suspension may repeat a turn at the same time.
        let is_settled = self.moments.last().is_some_and(|last| last.cause.is_none());
        if self.t.replace(t) != Some(t) || is_settled {
            self.moments.clear();
        }
        self.moments.push(moment(rows, cursor, cause, y, t));
    }
}

impl<A: Alphabet> Plan for LoadedPlan<A> {
    type Output = A::Output;
    type Input = A::Input;
    type Entered = Entered;
    type Left = Box<[u64]>;

    #[inline(always)]
    fn fsm(&self) -> Fsm<'_> {
        self.rows.fsm()
    }

    fn slots(&self) -> (Entered, Box<[u64]>) {
        let (entered, left) = self.rows.slots();
        (self.looked_at.as_ref().map_or(entered, |looked_at| looked_at.entered.clone()), left)
    }

    #[inline(always)]
    fn enter(&mut self, atom: u32, y: &A::Output, begin: Begin) {
        self.rows.enter(atom, y, begin);
    }

    #[inline(always)]
    fn next(&self, cursor: &Position, y: &A::Output, t: Nanos) -> Option<Ending> {
        self.rows.next(cursor, y, t)
    }

    #[inline(always)]
    fn observes(&self) -> bool {
        self.observes
    }

    #[inline(always)]
    fn stalled(&self, y: &A::Output, t: Nanos) -> Option<Nanos> {
        if self.has_stamps { self.rows.stalled(y, t) } else { None }
    }

    #[inline(always)]
    fn leave(&mut self, cursor: &Position, cause: Cause, y: &A::Output, t: Nanos) {
        if let Some(looked_at) = &mut self.looked_at {
            looked_at.note(&self.rows, cursor, Some(cause), y, t);
        }
        self.rows.leave(cursor, cause, y, t);
    }

    #[inline(always)]
    fn settle(&mut self, cursor: &Position, y: &A::Output, t: Nanos) {
        if let Some(looked_at) = &mut self.looked_at {
            looked_at.note(&self.rows, cursor, None, y, t);
        }
        self.rows.settle(cursor, y, t);
    }

    #[inline(always)]
    fn input(&mut self, y: &A::Output, t: Nanos) -> A::Input {
        self.rows.input(y, t)
    }

    fn operands(&self, cursor: &Position, scope: u32, y: &A::Output, t: Nanos, tell: &mut dyn FnMut(u32, Measured)) {
        self.rows.operands(cursor, scope, y, t, tell);
    }

    fn law(&self, atom: u32) -> &str {
        self.rows.law(atom)
    }

    fn condition(&self, scope: u32) -> &str {
        self.rows.condition(scope)
    }

    fn name(&self, scope: u32) -> &str {
        self.rows.name(scope)
    }

    fn source(&self) -> &dyn Words {
        self.rows.source()
    }

    fn paths(&self) -> &[&'static str] {
        self.rows.paths()
    }

    fn reads(&self) -> &'static [ModuleRead] {
        self.rows.reads()
    }

    fn robots(&self) -> &[&'static str] {
        self.rows.robots()
    }

    fn meetings(&self) -> &[Meeting] {
        self.rows.meetings()
    }
}
