//! W0202, W0205, W0206 and W0303: what an analysis finds suspicious that the lints of a plan, which compare texts, do not see.
//!
//! What stands in a plan that is used more than once is told only if it is so in every use.

use std::collections::{BTreeMap, BTreeSet};

use super::choices::When;
use super::walk::{Found, Outcome, Skip};
use super::world::World;
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::fsm::{Lowered, ScopeMeaning};
use crate::plan::{Condition, condition_text};

/// What is suspicious.
pub(super) fn lints(lowered: &Lowered, found: &[Found]) -> Vec<Diagnostic> {
    let lints = Lints { lowered, alone: World::new(lowered) };
    let mut uses: BTreeMap<Span, usize> = BTreeMap::new();
    let mut told: BTreeMap<(Span, Code), (usize, Diagnostic)> = BTreeMap::new();
    for (number, (scope, found)) in (0_u32..).zip(lowered.scopes.iter().zip(found)) {
        let Some(scope) = scope else { continue };
        *uses.entry(scope.interrupt.span).or_default() += 1;
        let mut once = BTreeSet::new();
        for lint in lints.scope(number, scope, found).into_iter().flatten() {
            // What an interrupt says is told once, whichever of its operands are concerned.
            if once.insert(lint.code) {
                told.entry((scope.interrupt.span, lint.code)).or_insert((0, lint)).0 += 1;
            }
        }
    }
    let everywhere = |span: &Span, count: usize| uses.get(span).is_some_and(|uses| *uses == count);
    told.into_iter().filter(|((span, _), (count, _))| everywhere(span, *count)).map(|(_, (_, lint))| lint).collect()
}

struct Lints<'l> {
    lowered: &'l Lowered,
    /// The knowledge about a place that no scope encloses.
    alone: World<'l>,
}

impl<'l> Lints<'l> {
    fn scope(&self, number: u32, scope: &'l ScopeMeaning, found: &Found) -> Vec<Option<Diagnostic>> {
        let operands = scope.interrupt.condition.operands().iter().zip(&found.operands);
        let mut lints: Vec<_> = operands.map(|(operand, outcome)| self.operand(scope, operand, *outcome)).collect();
        lints.push(self.skipped(number, scope, found));
        lints.push(found.cut_off_by.map(|before| self.cut_off(scope, before)));
        lints
    }

    /// An operand that never ends its scope.
    fn operand(&self, scope: &ScopeMeaning, operand: &Condition, outcome: Outcome) -> Option<Diagnostic> {
        let text = condition_text(operand, &|id| self.lowered.quark(id).text.clone());
        let span = scope.interrupt.span;
        let only = scope.interrupt.condition.operands().len() == 1;
        let help = |lint: Diagnostic| match only {
            true => lint.fix("write {}, or another condition", span, "(null)"),
            false => lint.help(format!("remove `{text}`")),
        };
        match outcome {
            Outcome::Beaten(outer) => {
                let (whose, outer) = self.whose(outer);
                let message = format!("`{text}` can never end this: {whose} always ends first");
                let lint = Diagnostic::new(Code::W0205, message, span, format!("`{text}` has no effect"));
                Some(help(lint.also(outer, format!("{whose} ends by this"))))
            }
            Outcome::Late(outer) => {
                let (whose, outer) = self.whose(outer);
                let message = format!("`{text}` can never end this: a timer of {whose} always fires first");
                let lint = Diagnostic::new(Code::W0206, message, span, format!("`{text}` has no effect"));
                Some(help(lint.also(outer, format!("{whose} ends by this"))))
            }
            // The same text is W0204's, what is never true W0203's.
            Outcome::Possible | Outcome::Never | Outcome::Repeated(_) | Outcome::Unread => None,
        }
    }

    /// An element that is always skipped.
    fn skipped(&self, number: u32, scope: &'l ScopeMeaning, found: &Found) -> Option<Diagnostic> {
        let (span, text) = (scope.interrupt.span, &scope.interrupt.text);
        let behind = match found.skipped? {
            Skip::Inside => return None,
            // That is W0203's.
            Skip::AtOnce if !self.alone.stays(number, &scope.interrupt.condition, When::Entered) => {
                return None;
            }
            Skip::AtOnce => {
                let message = format!("`{text}` is true whenever this is entered, so it is always skipped");
                let lint = Diagnostic::new(Code::W0303, message, span, "true at once");
                return Some(lint.help("give it a condition that is not true at once"));
            }
            Skip::Behind(before) => self.lowered.scopes[before as usize].as_ref()?,
        };
        // Where both are the same, and level-triggered, it is W0302's.
        if behind.interrupt.condition == scope.interrupt.condition {
            return None;
        }
        let message = format!("`{text}` is true whenever the element before this ends, so this is always skipped");
        let lint = Diagnostic::new(Code::W0303, message, span, "true at once");
        let lint = lint.also(behind.interrupt.span, "the element before it ends when this is true");
        Some(lint.fix("wait here until it becomes true again: {}", span, format!("(RISING ({text}))")))
    }

    /// An element behind one that never ends before what is around both.
    fn cut_off(&self, scope: &ScopeMeaning, before: u32) -> Diagnostic {
        let place = |scope: &ScopeMeaning| scope.interrupt.span;
        let lint = Diagnostic::new(Code::W0202, "this is never reached", place(scope), "never runs");
        let before = self.lowered.scopes[before as usize].as_ref().map(place);
        let lint = match before {
            Some(before) => lint.also(before, "the element with this never ends before an enclosing scope does"),
            None => lint,
        };
        lint.help("let the element before it end earlier, or the enclosing scope end later")
    }

    /// The scope of a bracket as a sentence names it, and the place of its interrupt.
    fn whose(&self, bracket: u32) -> (String, Span) {
        let scope = self.lowered.scopes[bracket as usize].as_ref();
        let name = scope.map(|scope| scope.name.as_str()).filter(|name| !name.is_empty());
        let whose = name.map_or_else(|| "the enclosing scope".to_owned(), |name| format!("`{name}`"));
        (whose, scope.map_or(Span { start: 0, end: 0 }, |scope| scope.interrupt.span))
    }
}
