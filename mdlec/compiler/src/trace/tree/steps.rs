//! Makes single steps of the walk, and the state of its open elements, available to a debugger.

use mdle_runtime::{Nanometers, Nanos, TRANSITIONS_PER_TURN};

use super::{ElementSituation, EnteredElement, Fired, NodeKind, Reports, ScriptedInput, TreeWalk};
use crate::diagnostic::Span;
use crate::plan::{Condition, PlanPart};

/// A step of a turn.
#[derive(Debug, Clone, PartialEq)]
pub enum TreeStep<'p> {
    /// A scope has ended, and its successor was entered.
    Transition {
        /// The transition, as a trace shows it.
        fired: Fired<'p>,
        /// Number of open elements that enclosed the scope that has ended.
        ended: usize,
        /// Number of open elements that have stayed open. This step entered all elements after them.
        kept: usize,
    },
    /// The turn is over; contains the input that was applied.
    End(ScriptedInput<'p>),
}

/// A scope, loop or atom of the tree that has been entered and has not ended yet.
#[derive(Debug, Clone, Copy)]
pub struct OpenPart<'t, 'p> {
    tree: &'t TreeWalk<'p>,
    open: &'t EnteredElement,
}

impl<'p> TreeWalk<'p> {
    /// Enters the plan in the first turn, which has these reports. Has no effect if the plan has already been entered.
    pub fn begin(&mut self, reports: &Reports) {
        if !std::mem::replace(&mut self.has_begun, true) {
            self.enter(0, 1, reports.moment());
        }
    }

    /// Executes the next step of a turn; `made` is the number of transitions so far in this turn.
    /// [`begin`](Self::begin) must be called first.
    pub fn step(&mut self, reports: &Reports, made: usize) -> TreeStep<'p> {
        match self.fired(reports) {
            Some(mut ending) if made < TRANSITIONS_PER_TURN as usize => {
                let operands = std::mem::take(&mut ending.operands);
                let fired = Fired { from: self.state(), level: ending.level, by: ending.by, operands };
                let kept = self.leave(&ending, reports.moment());
                TreeStep::Transition { fired, ended: ending.place, kept }
            }
            cut => {
                self.settle(reports);
                let law = || self.law().map_or(ScriptedInput::Over, |law| ScriptedInput::Law(&law.text));
                TreeStep::End(cut.map_or_else(law, |_| ScriptedInput::Cut))
            }
        }
    }

    /// Returns the open elements, from the plan to the current atom; empty before the first turn and after the plan has
    /// ended.
    pub fn open(&self) -> impl DoubleEndedIterator<Item = OpenPart<'_, 'p>> + ExactSizeIterator {
        self.open.iter().map(|open| OpenPart { tree: self, open })
    }

    /// Returns the spans of the operands that are true in the interrupt that ends a scope in the next step. The list is
    /// empty if the step ends no scope, or if the law has completed.
    #[must_use]
    pub fn firing(&self, reports: &Reports) -> Vec<Span> {
        let fired = |part: &OpenPart<'_, 'p>| {
            part.part().interrupt().is_some_and(|interrupt| part.holds(&interrupt.condition, reports))
        };
        let Some(part) = self.open().find(fired) else { return Vec::new() };
        let Some(interrupt) = part.part().interrupt() else { return Vec::new() };
        let operands = interrupt.condition.joined().into_iter().zip(&interrupt.operands);
        operands.filter(|(operand, _)| part.holds(operand, reports)).map(|(_, place)| place.span).collect()
    }
}

impl<'t, 'p> OpenPart<'t, 'p> {
    /// Returns the open element as a part of the plan.
    #[must_use]
    pub fn part(self) -> PlanPart<'p> {
        match self.tree.elements[self.open.element].kind {
            NodeKind::Scope(scope) => PlanPart::Scope(scope),
            NodeKind::Loop(repeated) => PlanPart::Loop(repeated),
            NodeKind::Atom(atom) => PlanPart::Atom(atom),
        }
    }

    /// Returns the time since the part was entered.
    #[must_use]
    pub fn since(self, reports: &Reports) -> Nanos {
        self.open.entered.since(reports)
    }

    /// Returns the length of the path driven since the part was entered.
    #[must_use]
    pub fn way(self, reports: &Reports) -> Nanometers {
        self.open.entered.way_since(reports)
    }

    /// Returns the number of a loop's current pass, counted from 1.
    #[must_use]
    pub fn pass(self) -> u64 {
        self.open.pass
    }

    /// Returns the memories of RISING in the part's interrupt. A memory is `true` once its operand was false.
    #[must_use]
    pub fn memories(self) -> &'t [bool] {
        &self.open.memories
    }

    /// Returns, for a plan that uses `after`, a list that contains `true` for each fact in the plan's record that is
    /// true.
    #[must_use]
    pub fn facts(self) -> &'t [bool] {
        &self.open.facts
    }

    /// Returns `true` if `condition` is true. This is the condition of the part's interrupt, or a part of that
    /// condition.
    #[must_use]
    pub fn holds(self, condition: &Condition, reports: &Reports) -> bool {
        condition.fired(&ElementSituation { tree: self.tree, open: self.open, reports })
    }
}
