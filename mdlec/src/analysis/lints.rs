//! W0202 to W0206, W0302 and W0303: conditions with one value, operands that never end their scope, and elements that are
//! always skipped or never reached.
//!
//! What stands in a plan that is used more than once is told only if it is so in every use.

use std::collections::{BTreeMap, BTreeSet};

use mdle_runtime::fsm::Atom;

use super::constants::Constants;
use super::walk::{Found, Outcome, Skip};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::fsm::{Machine, ScopeMeaning};
use crate::plan::{Condition, Quark, condition_text};

/// What is suspicious.
pub(super) fn lints(lowered: &Machine, found: &[Found]) -> Vec<Diagnostic> {
    let lints = Lints { lowered, constants: Constants::new(lowered), last: last_atoms(lowered) };
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
    lowered: &'l Machine,
    constants: Constants<'l>,
    /// The brackets of the atoms that nothing follows in what is around them.
    last: BTreeSet<u32>,
}

impl<'l> Lints<'l> {
    fn scope(&self, number: u32, scope: &'l ScopeMeaning, found: &Found) -> Vec<Option<Diagnostic>> {
        let operands = scope.interrupt.condition.operands().iter().zip(&found.operands);
        let mut lints: Vec<_> =
            operands.map(|(operand, outcome)| self.operand(number, scope, operand, *outcome)).collect();
        lints.push(self.constants.lint(number, scope));
        lints.push(self.skipped(number, scope, found));
        lints.push(found.cut_off_by.map(|before| self.cut_off(scope, before)));
        lints
    }

    /// An operand that never ends its scope.
    fn operand(&self, number: u32, scope: &ScopeMeaning, operand: &Condition, outcome: Outcome) -> Option<Diagnostic> {
        let text = condition_text(operand, &|id| self.lowered.quark(id).text.clone());
        let span = scope.interrupt.span;
        let (code, outer) = match outcome {
            Outcome::Repeated(outer) => (Code::W0204, outer),
            Outcome::Beaten(outer) => (Code::W0205, outer),
            Outcome::Late(outer) => (Code::W0206, outer),
            // What is never true is W0203's.
            Outcome::Possible | Outcome::Never | Outcome::Unread => return None,
        };
        let (whose, outer) = self.whose(outer);
        let why = match outcome {
            Outcome::Repeated(_) => format!("{whose} ends by it first"),
            Outcome::Late(_) => format!("a timer of {whose} always fires first"),
            Outcome::Beaten(_) | Outcome::Possible | Outcome::Never | Outcome::Unread => {
                format!("{whose} always ends first")
            }
        };
        let message = format!("`{text}` can never end this: {why}");
        let lint = Diagnostic::new(code, message, span, format!("`{text}` has no effect"));
        let lint = lint.also(outer, format!("{whose} ends by this"));
        Some(match scope.interrupt.condition.operands() {
            [_] if self.goes_on(number) => {
                lint.help("give it a condition that can be true earlier, or `(null)` where nothing follows it")
            }
            [_] => lint.fix("write {}, or another condition", span, "(null)"),
            _ => lint.help(format!("remove `{text}`")),
        })
    }

    /// Returns `true` if a bracket is an atom whose law never completes, and something follows it.
    fn goes_on(&self, number: u32) -> bool {
        self.law(number).is_some_and(|law| !law.completes) && !self.last.contains(&number)
    }

    /// The law of a bracket that is an atom.
    fn law(&self, number: u32) -> Option<&'l Quark> {
        let first = self.lowered.brackets[number as usize].first as usize;
        self.lowered.atoms.get(first).filter(|atom| atom.scope == number)?;
        self.lowered.laws.get(first).map(|law| self.lowered.quark(law.quark))
    }

    /// An element that is always skipped.
    fn skipped(&self, number: u32, scope: &'l ScopeMeaning, found: &Found) -> Option<Diagnostic> {
        let (span, text) = (scope.interrupt.span, &scope.interrupt.text);
        let behind = match found.skipped? {
            Skip::Inside => return None,
            // That is W0203's.
            Skip::AtOnce if !self.constants.stays(number, &scope.interrupt.condition) => return None,
            Skip::AtOnce => {
                let message = format!("`{text}` is true whenever this is entered, so it is always skipped");
                let lint = Diagnostic::new(Code::W0303, message, span, "true at once");
                return Some(lint.help("give it a condition that is not true at once"));
            }
            Skip::Behind(before) => self.lowered.scopes[before as usize].as_ref()?,
        };
        if behind.interrupt.condition == scope.interrupt.condition {
            return Some(self.repeated(number, scope, behind));
        }
        let message = format!("`{text}` is true whenever the element before this ends, so this is always skipped");
        let lint = Diagnostic::new(Code::W0303, message, span, "true at once");
        let lint = lint.also(behind.interrupt.span, "the element before it ends when this is true");
        Some(lint.fix("wait here until it becomes true again: {}", span, format!("(RISING ({text}))")))
    }

    /// An element that is skipped since the one before it ends by the same condition.
    fn repeated(&self, number: u32, scope: &ScopeMeaning, before: &ScopeMeaning) -> Diagnostic {
        let (span, text) = (scope.interrupt.span, &scope.interrupt.text);
        let message = format!("`{text}` ends the element before this as well, so this is always skipped");
        let lint = Diagnostic::new(Code::W0302, message, span, "true at once")
            .also(before.interrupt.span, "the element before it ends when this is true");
        let lint = match self.law(number) {
            Some(Quark { completes: true, name, .. }) => {
                let words = format!("`{name}` completes by itself: to run it until then, write {{}}");
                lint.fix(&words, span, "(null)")
            }
            _ => {
                let opposite =
                    text.strip_prefix("NOT ").filter(|_| matches!(scope.interrupt.condition, Condition::Not(_)));
                let opposite = opposite.map_or_else(|| negated("NOT", scope), str::to_owned);
                lint.fix("to run it while this is true, write {}", span, format!("({opposite})"))
            }
        };
        let rising = format!("({})", negated("RISING", scope));
        lint.fix("or wait here until it becomes true again: {}", span, rising)
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

/// The brackets of the atoms that nothing follows in what is around them.
fn last_atoms(lowered: &Machine) -> BTreeSet<u32> {
    let is_last = |atom: &&Atom| {
        let bracket = &lowered.brackets[atom.scope as usize];
        bracket.last == lowered.brackets[bracket.parent as usize].last
    };
    lowered.atoms.iter().filter(is_last).map(|atom| atom.scope).collect()
}

/// The condition of a scope behind a word that takes one operand.
fn negated(word: &str, ScopeMeaning { interrupt, .. }: &ScopeMeaning) -> String {
    let text = &interrupt.text;
    if matches!(interrupt.condition, Condition::Quark(_)) {
        format!("{word} {text}")
    } else {
        format!("{word} ({text})")
    }
}
