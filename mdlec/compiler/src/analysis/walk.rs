//! Walks over a machine in the order in which it runs. Finds the atoms that run, are skipped or are never reached, and
//! the operands that can end each scope.
//!
//! One pass over the brackets suffices: [`KnownFacts`] contains the effects of enclosing scopes, and the walk keeps the
//! earliest time at which a position is reached. The body of a loop is visited once, as its first pass.

use std::collections::BTreeMap;
use std::iter;

use serde::Serialize;

use super::choices::{ScopedCondition, When};
use super::facts::PossibleFacts;
use super::known::{Assumptions, KnownFacts};
use crate::fsm::{Element, ElementKind, Machine, Visit};
use crate::plan::{Condition, QuarkId};

/// Reachability of an atom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Reach {
    /// The atom's law may be applied.
    Runs,
    /// The atom may become the current atom, but its own interrupt or the interrupt of an enclosing scope then always
    /// fires at once.
    Skipped,
    /// The atom never becomes the current atom.
    Never,
}

/// Facts about a bracket.
#[derive(Debug, Clone)]
pub(super) struct BracketFacts {
    pub(super) reach: Reach,
    /// Outcome of each operand of the outermost OR of the bracket's interrupt.
    pub(super) operands: Vec<OperandOutcome>,
    /// `true` if the bracket can end because its law completes.
    pub(super) completes: bool,
    /// `true` if the bracket can end because its last element ends.
    pub(super) body_ends: bool,
    /// Reason why the bracket is always skipped; `None` if it is not.
    pub(super) skipped: Option<Skip>,
    /// Number of the previous element if it is the reason why this element is never reached and the text alone does not
    /// show this; `None` otherwise.
    pub(super) cut_off_by: Option<u32>,
}

/// Reason why an element is always skipped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Skip {
    /// The element's interrupt always fires as soon as the element is entered.
    AtOnce,
    /// The element's interrupt always fires as soon as the previous element has ended. Contains the number of the
    /// outermost bracket whose interrupt can end the previous element.
    Behind(u32),
    /// An enclosing element is skipped.
    Inside,
}

/// Result of the analysis of one operand of an interrupt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OperandOutcome {
    /// The operand can make the interrupt fire.
    Possible,
    /// The operand is never true.
    Never,
    /// The operand is true only when the interrupt of this bracket, which is an enclosing scope, has also fired.
    Beaten(u32),
    /// The operand's timer ends later than a timer of this enclosing bracket.
    Late(u32),
    /// The operand is the same as an operand of this bracket's interrupt.
    Repeated(u32),
    /// The operand was not examined, because its scope is never reached.
    Unread,
}

/// Conditions of which at least one has just fired when an element is entered. The list is empty if nothing is known.
type RecentlyFired<'l> = Vec<ScopedCondition<'l>>;

/// A bracket that encloses the current position of the walk.
struct EnclosingBracket {
    reach: Reach,
    /// Earliest time at which the bracket is entered; `None` if it is never entered.
    clock: Option<u64>,
    /// Earliest time at which the scope ends by its own condition or by the completion of its law; `None` if it never
    /// ends in these ways, and for a loop.
    own: Option<u64>,
    added: Assumptions,
    /// `true` if the text alone permits that the element before the bracket ends.
    written: bool,
}

/// Facts about each bracket, and the earliest end of the plan.
pub(super) struct PlanFacts {
    pub(super) found: Vec<BracketFacts>,
    pub(super) shortest: Option<u64>,
}

/// Walks over a machine whose records can contain the facts `facts`. `one_turn` is `true` if every search for the next
/// atom ends within one turn.
pub(super) fn walk(machine: &Machine, one_turn: bool, facts: &PossibleFacts) -> PlanFacts {
    let mut walk = AnalysisWalk {
        world: KnownFacts::new(machine, facts),
        alone: KnownFacts::new(machine, facts),
        open: Vec::new(),
        found: Vec::with_capacity(machine.elements().len()),
        waits: BTreeMap::new(),
        clock: Some(0),
        facts: Vec::new(),
        written: true,
        skipping: false,
        before: None,
        one_turn,
    };
    for visit in machine.walk() {
        match visit {
            Visit::Enter(element) => walk.enter(element),
            Visit::Leave(element) => walk.leave(element),
        }
    }
    PlanFacts { found: walk.found, shortest: walk.clock }
}

pub(super) struct AnalysisWalk<'l> {
    pub(super) world: KnownFacts<'l>,
    /// Facts that are known without enclosing scopes.
    pub(super) alone: KnownFacts<'l>,
    open: Vec<EnclosingBracket>,
    found: Vec<BracketFacts>,
    /// For each timer, the brackets of the enclosing scopes whose interrupts have the timer as an operand.
    pub(super) waits: BTreeMap<QuarkId, Vec<u32>>,
    /// Earliest time at which the next element is entered; `None` if it is never entered.
    pub(super) clock: Option<u64>,
    pub(super) facts: RecentlyFired<'l>,
    /// `true` if the text alone permits that the element before the next element ends.
    written: bool,
    /// `true` if the next element is inside a skipped element.
    skipping: bool,
    /// Number of the element before the next element in the same string; `None` if the next element is the first.
    before: Option<u32>,
    /// `true` if every search for the next atom ends within one turn.
    pub(super) one_turn: bool,
}

impl<'l> AnalysisWalk<'l> {
    pub(super) fn element(&self, number: u32) -> Element<'l> {
        self.world.machine.element(number)
    }

    fn enter(&mut self, element: Element<'l>) {
        let (number, condition) = (element.number(), element.condition());
        let reach = match self.clock {
            Some(_) if self.skipping => Reach::Skipped,
            Some(_) => Reach::Runs,
            None => Reach::Never,
        };
        let is_cut_off = reach == Reach::Never && self.written;
        self.world.entered[element.index()] = self.clock.unwrap_or(0);
        let mut found = BracketFacts {
            reach,
            operands: vec![OperandOutcome::Unread; condition.operands().len()],
            completes: false,
            body_ends: false,
            skipped: (reach == Reach::Skipped).then_some(Skip::Inside),
            cut_off_by: self.before.filter(|_| is_cut_off),
        };
        // Of several successive elements that are never reached, only the first is reported.
        let written = self.written && !is_cut_off;
        let mut open = EnclosingBracket { reach, clock: self.clock, own: None, added: Assumptions::default(), written };
        self.written = written;
        match element.kind() {
            ElementKind::Loop { times } if times != Some(1) && reach == Reach::Runs => self.repeat(element),
            ElementKind::Scope | ElementKind::Atom(_) if reach == Reach::Runs => {
                open.own = self.judge(number, &mut found);
                if found.reach == Reach::Skipped {
                    open.reach = Reach::Skipped;
                    self.skipping = true;
                    self.written = false;
                } else if element.is_scope() {
                    open.added = self.world.open(number, condition);
                    self.wait_for(element, true);
                }
            }
            ElementKind::Loop { .. } | ElementKind::Scope | ElementKind::Atom(_) => {}
        }
        self.found.push(found);
        self.open.push(open);
        self.before = None;
    }

    /// Records the conditions that lead from the last element of a loop back to the beginning of its body.
    fn repeat(&mut self, repeated: Element<'l>) {
        let again = self.exit(repeated);
        if self.facts.is_empty() || again.is_empty() {
            self.facts.clear();
        } else {
            self.facts.extend(again);
        }
    }

    pub(super) fn read(&self, condition: &'l Condition, bracket: u32, when: When) -> ScopedCondition<'l> {
        ScopedCondition { condition, bracket, when }
    }

    /// When a scope is opened, adds the timers of its interrupt to the timers of enclosing scopes; when it is closed,
    /// removes them.
    fn wait_for(&mut self, element: Element<'l>, opened: bool) {
        for operand in element.condition().operands() {
            let Condition::Wait { quark, .. } = operand else { continue };
            let brackets = self.waits.entry(*quark).or_default();
            if opened {
                brackets.push(element.number());
            } else {
                brackets.pop();
            }
        }
    }

    /// Returns conditions of which at least one has fired when an element has ended; empty if no such conditions are
    /// known.
    fn exit(&self, element: Element<'l>) -> RecentlyFired<'l> {
        /// Maximum number of nested last elements that are examined because they may end together with the element.
        const ENDING: usize = 8;
        let mut exits = Vec::new();
        for here in iter::successors(Some(element), |here| here.children().last()).take(ENDING) {
            if here.completes() || !self.one_turn {
                return Vec::new();
            }
            if here.interrupt().is_some() {
                exits.push(self.read(here.condition(), here.number(), When::Past));
            }
            if here.atom().is_some() {
                return exits;
            }
        }
        Vec::new()
    }

    /// Leaves the innermost element. The next element can be entered at the earliest when this element ends.
    fn leave(&mut self, element: Element<'l>) {
        let Some(open) = self.open.pop() else { return };
        let inside = self.clock.filter(|_| element.atom().is_none());
        self.found[element.index()].body_ends = inside.is_some();
        let ends_by_itself = element.completes() || *element.condition() != Condition::Null;
        self.written = open.written
            && match element.kind() {
                ElementKind::Atom(_) => ends_by_itself,
                ElementKind::Scope => ends_by_itself || self.written,
                ElementKind::Loop { times } => self.written && times.is_some(),
            };
        self.before = Some(element.number());
        match open.reach {
            Reach::Never => self.clock = None,
            // Of a skipped element, only the first atom is entered, so the element ends only by its own condition.
            Reach::Skipped => self.clock = open.own,
            Reach::Runs => {
                self.clock = match element.kind() {
                    ElementKind::Scope | ElementKind::Atom(_) => [open.own, inside].into_iter().flatten().min(),
                    ElementKind::Loop { times } => passes(open.clock, inside, times),
                };
                if element.is_scope() {
                    self.wait_for(element, false);
                }
                self.world.close(open.added);
            }
        }
        if open.own.is_some() && open.reach == Reach::Skipped {
            self.skipping = false;
            self.written = open.written;
        }
        self.facts = self.exit(element);
    }
}

/// Returns the earliest end of a loop, given the time of its entry and the earliest end of its first pass; `None` if
/// the loop is never entered or never ends.
fn passes(from: Option<u64>, pass: Option<u64>, times: Option<u64>) -> Option<u64> {
    let (from, pass, times) = (from?, pass?, times?);
    Some(from.saturating_add(pass.saturating_sub(from).saturating_mul(times)))
}
