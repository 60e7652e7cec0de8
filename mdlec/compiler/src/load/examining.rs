//! A plan that is looked at while it makes its turns: the conditions around its atom before each transition, and at the
//! end of a turn.

use std::cell::{Cell, RefCell};

use mdle_runtime::fsm::Kind;
use mdle_runtime::{
    Alphabet, Begin, Cause, Cursor, Ending, Examined, Fsm, Measured, ModuleRead, Nanometers, Nanos, Plan, Words,
};

use super::{Entered, LoadedPlan};

/// Position in a plan that was loaded.
type Position = Cursor<Entered, Box<[u64]>>;

/// The plan before a transition, or at the end of a turn.
#[derive(Debug, Clone)]
pub struct Moment {
    /// The current atom, as written, from 0.
    pub atom: u32,
    /// Cause of the transition; `None` at the end of a turn.
    pub cause: Option<Cause>,
    /// `true` if the law of the atom is done.
    pub is_completed: bool,
    /// Time for which the law of the turn before has made no progress; `None` if it has no goal.
    pub stalled: Option<Nanos>,
    /// The scopes that enclose the atom, the plan first and the atom's own last.
    pub scopes: Vec<ScopeMoment>,
}

impl Moment {
    /// Returns `true` if the atom was entered in this turn.
    #[must_use]
    pub fn is_new(&self) -> bool {
        self.scopes.last().is_some_and(|own| own.since == Nanos::ZERO)
    }
}

/// A scope at a moment.
#[derive(Debug, Clone)]
pub struct ScopeMoment {
    /// The scope, by its bracket.
    pub bracket: u32,
    /// Number of scopes that enclose it.
    pub level: u16,
    /// Time since it was entered.
    pub since: Nanos,
    /// Length of the path driven since it was entered.
    pub way: Nanometers,
    /// The condition of the scope and all parts of it, each part before its operands.
    pub parts: Vec<Examined>,
    /// The atom that would follow if the scope ended now; `None` if the plan would be over.
    pub leads_to: Option<u32>,
}

/// A plan that is looked at.
pub struct Examining<A: Alphabet> {
    plan: LoadedPlan<A>,
    /// Storage for the entry of each level of scopes, not only of those with timers.
    entered: Entered,
    /// Laws that have to be run, by atom: a law without completion has no part in what runs next.
    runs: Vec<bool>,
    /// The current atom.
    atom: u32,
    /// `true` if moments are wanted in this turn.
    looks: Cell<bool>,
    /// The moments of the turn, in order.
    moments: RefCell<Vec<Moment>>,
}

impl<A: Alphabet> Examining<A> {
    /// A plan before it begins; `runs` tells for each atom whether its law has to be run.
    #[must_use]
    pub fn new(plan: LoadedPlan<A>, entered: Entered, runs: Vec<bool>) -> Self {
        Self { plan, entered, runs, atom: 0, looks: Cell::new(false), moments: RefCell::default() }
    }

    /// Empties the list of moments for a turn that is looked at, or not.
    pub fn look(&self, looks: bool) {
        self.looks.set(looks);
        self.moments.take();
    }

    /// Takes the moments of the turn, in order.
    #[must_use]
    pub fn moments(&self) -> Vec<Moment> {
        self.moments.take()
    }

    fn note(&self, cursor: &Position, cause: Option<Cause>, y: &A::Output, t: Nanos) {
        if !self.looks.get() {
            return;
        }
        let fsm = self.plan.fsm();
        let own = fsm.atoms.get(self.atom as usize).map_or(0, |atom| atom.scope);
        let mut scopes: Vec<_> = fsm
            .outwards(own)
            .filter_map(|(bracket, found)| match found.kind {
                Kind::Scope { level } => Some(self.scope(cursor, (bracket, level), y, t)),
                Kind::Loop { .. } => None,
            })
            .collect();
        scopes.reverse();
        let (is_completed, stalled) = (self.plan.is_completed(y, t), cursor.stalled());
        self.moments.borrow_mut().push(Moment { atom: self.atom, cause, is_completed, stalled, scopes });
    }

    fn scope(&self, cursor: &Position, (bracket, level): (u32, u16), y: &A::Output, t: Nanos) -> ScopeMoment {
        let mut parts = Vec::new();
        self.plan.examine(cursor, bracket, y, t, &mut |part| parts.push(part));
        let mut after = cursor.clone();
        let leads_to = after.end(self.plan.fsm(), level, t).then(|| after.atom());
        ScopeMoment { bracket, level, since: cursor.since(level, t), way: cursor.way(level), parts, leads_to }
    }
}

impl<A: Alphabet> Plan for Examining<A> {
    type Output = A::Output;
    type Input = A::Input;
    type Entered = Entered;
    type Left = Box<[u64]>;

    fn fsm(&self) -> Fsm<'_> {
        self.plan.fsm()
    }

    fn slots(&self) -> (Entered, Box<[u64]>) {
        (self.entered.clone(), self.plan.slots().1)
    }

    fn enter(&mut self, atom: u32, y: &A::Output, begin: Begin) {
        self.atom = atom;
        self.plan.enter(atom, y, begin);
    }

    fn next(&self, cursor: &Position, y: &A::Output, t: Nanos) -> Option<Ending> {
        self.plan.next(cursor, y, t)
    }

    fn stalled(&self, y: &A::Output, t: Nanos) -> Option<Nanos> {
        self.plan.stalled(y, t)
    }

    fn leave(&mut self, cursor: &Position, cause: Cause, y: &A::Output, t: Nanos) {
        self.note(cursor, Some(cause), y, t);
        self.plan.leave(cursor, cause, y, t);
    }

    fn settle(&mut self, cursor: &Position, y: &A::Output, t: Nanos) {
        self.note(cursor, None, y, t);
        self.plan.settle(cursor, y, t);
    }

    fn input(&mut self, y: &A::Output, t: Nanos) -> A::Input {
        if self.runs.get(self.atom as usize).copied().unwrap_or(true) {
            self.plan.input(y, t)
        } else {
            A::Input::default()
        }
    }

    fn operands(&self, cursor: &Position, scope: u32, y: &A::Output, t: Nanos, tell: &mut dyn FnMut(u32, Measured)) {
        self.plan.operands(cursor, scope, y, t, tell);
    }

    fn law(&self, atom: u32) -> &str {
        self.plan.law(atom)
    }

    fn condition(&self, scope: u32) -> &str {
        self.plan.condition(scope)
    }

    fn name(&self, scope: u32) -> &str {
        self.plan.name(scope)
    }

    fn source(&self) -> &dyn Words {
        self.plan.source()
    }

    fn paths(&self) -> &[&'static str] {
        self.plan.paths()
    }

    fn reads(&self) -> &'static [ModuleRead] {
        self.plan.reads()
    }
}
