//! Warns about conditions whose value is always the same, operands that never end their scope, and elements that are
//! always skipped or never reached (W0202 to W0206, W0302 and W0303).
//!
//! A warning about a plan that is used more than once is reported only if it holds in every use.

use std::collections::{BTreeMap, BTreeSet};

use super::constants::ConstantConditions;
use super::walk::{BracketFacts, OperandOutcome, Skip};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::fsm::{Atom, Element, Exit, Machine};
use crate::plan::{Condition, Interrupt, Quark, condition_text};

/// Returns the warnings about a machine.
pub(super) fn lints(machine: &Machine, found: &[BracketFacts]) -> Vec<Diagnostic> {
    let lints = Lints { machine, constants: ConstantConditions::new(machine) };
    let mut uses: BTreeMap<Span, usize> = BTreeMap::new();
    let mut warnings: BTreeMap<(Span, Code), (usize, Diagnostic)> = BTreeMap::new();
    for (element, found) in machine.elements().zip(found) {
        let Some(interrupt) = element.interrupt() else { continue };
        *uses.entry(interrupt.span).or_default() += 1;
        let mut once = BTreeSet::new();
        for lint in lints.element(element, interrupt, found).into_iter().flatten() {
            // An interrupt gets each warning at most once, even if the warning applies to several of its operands.
            if once.insert(lint.code) {
                warnings.entry((interrupt.span, lint.code)).or_insert((0, lint)).0 += 1;
            }
        }
    }
    let everywhere = |span: &Span, count: usize| uses.get(span).is_some_and(|uses| *uses == count);
    warnings.into_iter().filter(|((span, _), (count, _))| everywhere(span, *count)).map(|(_, (_, lint))| lint).collect()
}

struct Lints<'l> {
    machine: &'l Machine,
    constants: ConstantConditions<'l>,
}

impl<'l> Lints<'l> {
    fn element(&self, element: Element<'l>, interrupt: &'l Interrupt, found: &BracketFacts) -> Vec<Option<Diagnostic>> {
        let operands = interrupt.condition.operands().iter().zip(&found.operands);
        let mut lints: Vec<_> =
            operands.map(|(operand, outcome)| self.operand(element, interrupt, operand, *outcome)).collect();
        let constant = self.constants.lint(element.number(), interrupt);
        lints.push(constant.or_else(|| self.unrecorded(interrupt, found)));
        lints.push(self.skipped(element, interrupt, found));
        lints.push(found.cut_off_by.map(|before| self.cut_off(interrupt, before)));
        lints
    }

    /// Returns the warning about an operand that never ends its scope.
    fn operand(
        &self,
        element: Element<'_>,
        interrupt: &Interrupt,
        operand: &Condition,
        outcome: OperandOutcome,
    ) -> Option<Diagnostic> {
        let text = condition_text(operand, &|id| self.machine.quark(id).text.clone());
        let span = interrupt.span;
        let (code, outer) = match outcome {
            OperandOutcome::Repeated(outer) => (Code::W0204, outer),
            OperandOutcome::Beaten(outer) => (Code::W0205, outer),
            OperandOutcome::Late(outer) => (Code::W0206, outer),
            // W0203 reports operands that are never true.
            OperandOutcome::Possible | OperandOutcome::Never | OperandOutcome::Unread => return None,
        };
        let (whose, outer) = self.whose(outer);
        let why = match outcome {
            OperandOutcome::Repeated(_) => format!("{whose} ends by it first"),
            OperandOutcome::Late(_) => format!("a timer of {whose} always fires first"),
            OperandOutcome::Beaten(_) | OperandOutcome::Possible | OperandOutcome::Never | OperandOutcome::Unread => {
                format!("{whose} always ends first")
            }
        };
        let message = format!("`{text}` can never end this: {why}");
        let lint = Diagnostic::new(code, message, span, format!("`{text}` has no effect"));
        let lint = lint.also(outer, format!("{whose} ends by this"));
        Some(match interrupt.condition.operands() {
            [_] if goes_on(element) => {
                lint.help("give it a condition that can be true earlier, or `(null)` where nothing follows it")
            }
            [_] => lint.fix("write {}, or another condition", span, "(null)"),
            _ => lint.help(format!("remove `{text}`, or write `null` instead of it")),
        })
    }

    /// Returns the warning about an operand that tests a record for a fact that the record never contains.
    fn unrecorded(&self, interrupt: &Interrupt, found: &BracketFacts) -> Option<Diagnostic> {
        let operands = interrupt.condition.operands();
        let asks = |operand: &Condition| operand.any(&|part| matches!(part, Condition::After(_)));
        let never = operands.iter().zip(&found.operands).find(|(_, outcome)| **outcome == OperandOutcome::Never);
        let (operand, _) = never.filter(|(operand, _)| asks(operand))?;
        let text = condition_text(operand, &|id| self.machine.quark(id).text.clone());
        let message = format!("`{text}` is never true: what it asks for never ends before this is read");
        let lint = Diagnostic::new(Code::W0203, message, interrupt.span, "never true");
        Some(
            lint.help(
                "`after` asks for the labelled elements that ended last; ask for one that ends before this is read",
            ),
        )
    }

    /// Returns the warning about an element that is always skipped.
    fn skipped(&self, element: Element<'l>, interrupt: &'l Interrupt, found: &BracketFacts) -> Option<Diagnostic> {
        let (span, text) = (interrupt.span, &interrupt.text);
        let behind = match found.skipped? {
            Skip::Inside => return None,
            // W0203 reports this element.
            Skip::AtOnce if !self.constants.stays(element.number(), &interrupt.condition) => return None,
            Skip::AtOnce => {
                let message = format!("`{text}` is true whenever this is entered, so it is always skipped");
                let lint = Diagnostic::new(Code::W0303, message, span, "true at once");
                return Some(lint.help("give it a condition that is not true at once"));
            }
            Skip::Behind(before) => self.machine.element(before).interrupt()?,
        };
        if behind.condition == interrupt.condition {
            return Some(repeated(element, interrupt, behind));
        }
        let message = format!("`{text}` is true whenever the element before this ends, so this is always skipped");
        let lint = Diagnostic::new(Code::W0303, message, span, "true at once");
        let lint = lint.also(behind.span, "the element before it ends when this is true");
        Some(lint.fix("wait here until it becomes true again: {}", span, format!("(RISING ({text}))")))
    }

    /// Returns the warning about an element that is never reached, because an enclosing scope always ends before the
    /// previous element ends.
    fn cut_off(&self, interrupt: &Interrupt, before: u32) -> Diagnostic {
        let lint = Diagnostic::new(Code::W0202, "this is never reached", interrupt.span, "never runs");
        let before = self.machine.element(before).interrupt().map(|before| before.span);
        let lint = match before {
            Some(before) => lint.also(before, "the element with this never ends before an enclosing scope does"),
            None => lint,
        };
        lint.help("let the element before it end earlier, or the enclosing scope end later")
    }

    /// Returns a phrase for the scope of a bracket, and the span of the scope's interrupt.
    fn whose(&self, bracket: u32) -> (String, Span) {
        let element = self.machine.element(bracket);
        let name = Some(element.name()).filter(|name| !name.is_empty());
        let whose = name.map_or_else(|| "the enclosing scope".to_owned(), |name| format!("`{name}`"));
        (whose, element.interrupt().map_or(Span { start: 0, end: 0 }, |interrupt| interrupt.span))
    }
}

/// Returns `true` if an element is an atom whose law never completes, and another element follows the atom in its
/// string.
fn goes_on(element: Element<'_>) -> bool {
    element.atom().is_some_and(|atom| !atom.law().completes) && matches!(element.exit(), Exit::Next(_))
}

/// Returns the warning about an element that is always skipped, because its condition also ends the element before it.
fn repeated(element: Element<'_>, interrupt: &Interrupt, before: &Interrupt) -> Diagnostic {
    let (span, text) = (interrupt.span, &interrupt.text);
    let message = format!("`{text}` ends the element before this as well, so this is always skipped");
    let lint = Diagnostic::new(Code::W0302, message, span, "true at once")
        .also(before.span, "the element before it ends when this is true");
    let lint = match element.atom().map(Atom::law) {
        Some(Quark { completes: true, name, .. }) => {
            let words = format!("`{name}` completes by itself: to run it until then, write {{}}");
            lint.fix(&words, span, "(null)")
        }
        _ => {
            let opposite = text.strip_prefix("NOT ").filter(|_| matches!(interrupt.condition, Condition::Not(_)));
            let opposite = opposite.map_or_else(|| negated("NOT", interrupt), str::to_owned);
            lint.fix("to run it while this is true, write {}", span, format!("({opposite})"))
        }
    };
    let rising = format!("({})", negated("RISING", interrupt));
    lint.fix("or wait here until it becomes true again: {}", span, rising)
}

/// Returns the text of a scope's condition after the operator `word` (NOT or RISING), in parentheses where needed.
fn negated(word: &str, interrupt: &Interrupt) -> String {
    let text = &interrupt.text;
    if matches!(interrupt.condition, Condition::Quark(_)) {
        format!("{word} {text}")
    } else {
        format!("{word} ({text})")
    }
}
