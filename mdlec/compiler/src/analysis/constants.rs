//! Finds conditions that are never true, or that are always true as soon as they are evaluated, regardless of the
//! enclosing scopes (W0203).

use std::collections::BTreeMap;

use super::choices::{ScopedCondition, When};
use super::known::{ConditionQuestion, KnownFacts};
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::fsm::Machine;
use crate::plan::{Condition, Interrupt, condition_text};

/// Evaluates conditions without regard to enclosing scopes, assuming that no signal is NaN.
pub(super) struct ConstantConditions<'l> {
    alone: KnownFacts<'l>,
}

/// Two operands whose conjunction or disjunction always has the same value.
struct Pair {
    one: String,
    other: String,
    /// `true` if the condition could have both values with the other operator: OR instead of AND, or AND instead of OR.
    may_be_joined_otherwise: bool,
}

impl<'l> ConstantConditions<'l> {
    pub(super) fn new(machine: &'l Machine) -> Self {
        Self { alone: KnownFacts::of_numbers(machine) }
    }

    /// Returns `true` if it is possible that the interrupt of this bracket has not fired when the bracket's scope is
    /// entered.
    pub(super) fn stays(&self, bracket: u32, condition: &'l Condition) -> bool {
        self.alone.stays(bracket, condition, When::Entered)
    }

    /// Returns a warning about an interrupt that always fires as soon as its scope is entered, or about an operand that
    /// is never true. There is no warning about `null` and `wait inf`, whose purpose is never to fire.
    pub(super) fn lint(&self, bracket: u32, interrupt: &'l Interrupt) -> Option<Diagnostic> {
        let condition = &interrupt.condition;
        let remembers =
            |part: &Condition| matches!(part, Condition::Quark(id) if self.alone.machine.quark(*id).remembers);
        // Reading a quark with memory may change its value.
        if condition.any(&remembers) {
            return None;
        }
        if !self.stays(bracket, condition) {
            return Some(self.skipped(bracket, interrupt));
        }
        let operands = condition.operands();
        let never = operands.iter().find(|operand| {
            !is_open(operand)
                && **operand != Condition::Null
                && !self.is_possible(bracket, &[(*operand, true)], When::Later)
        })?;
        let text = if operands.len() == 1 { interrupt.text.clone() } else { self.written(never, interrupt) };
        let span = interrupt.span;
        if let Some(Pair { one, other, may_be_joined_otherwise }) = self.pair(bracket, never, true) {
            let message = format!("`{one}` and `{other}` are never true at once");
            let lint = Diagnostic::new(Code::W0203, message, span, "so AND of the two is never true");
            let words = format!("if one of them is enough, join them by OR: `{one} OR {other}`");
            let is_all = matches!(condition, Condition::And(operands) if operands.len() == 2);
            return Some(match may_be_joined_otherwise {
                true if is_all => lint.fix(&words, span, format!("({one} OR {other})")),
                true => lint.help(words),
                false => never_true(lint, operands, &text, span),
            });
        }
        let lint = Diagnostic::new(Code::W0203, format!("`{text}` is never true"), span, "never true");
        Some(never_true(lint, operands, &text, span))
    }

    /// Returns the warning about an interrupt that always fires as soon as its scope is entered.
    fn skipped(&self, bracket: u32, interrupt: &'l Interrupt) -> Diagnostic {
        let (condition, text, span) = (&interrupt.condition, &interrupt.text, interrupt.span);
        let (what, skipped) = self.what(bracket);
        if !self.alone.stays(bracket, condition, When::Later) {
            let lint = |message: String| Diagnostic::new(Code::W0203, message, span, "always true");
            if let Some(Pair { one, other, may_be_joined_otherwise: true }) = self.pair(bracket, condition, false) {
                let words = format!("if both are to hold, join them by AND: `{one} AND {other}`");
                let lint = lint(format!("one of `{one}` and `{other}` is always true, so the {what} {skipped}"));
                let is_all = condition.operands().len() == 2;
                return match is_all {
                    true => lint.fix(&words, span, format!("({one} AND {other})")),
                    false => lint.help(words),
                };
            }
            return lint(format!("`{text}` is always true, so the {what} {skipped}"))
                .help("give it a condition that is not true at once, such as `(wait 1)`, or leave it out");
        }
        let message = format!("`{text}` is true when the {what} is entered, so the {what} {skipped}");
        let lint = Diagnostic::new(Code::W0203, message, span, "true at once");
        match self.opposite(bracket, condition) {
            Some(opposite) => lint.fix(
                &format!("a condition ends the {what}; to run it until this is no longer true, write {{}}"),
                span,
                format!("({opposite})"),
            ),
            None => lint.help(format!("a condition ends the {what}: give it one that is not true at once")),
        }
    }

    /// Returns two phrases for a message: the kind of a bracket's scope, and the effect of an interrupt that has
    /// already fired when the scope is entered.
    fn what(&self, bracket: u32) -> (&'static str, &'static str) {
        match bracket {
            0 => ("plan", "is over before it begins"),
            _ if self.alone.machine.element(bracket).atom().is_some() => ("atom", "is always skipped"),
            _ => ("behavior", "is always skipped"),
        }
    }

    /// Returns the text of the condition with a NOT before each operand that is true when the scope is entered; `None`
    /// if there is no such operand, or if such an operand is always true.
    fn opposite(&self, bracket: u32, condition: &'l Condition) -> Option<String> {
        // If each operand by itself may be false at the entry, only the operator that joins them can be the mistake.
        if condition.operands().iter().all(|operand| self.stays(bracket, operand)) {
            return None;
        }
        let opposites = condition.operands().iter().map(|operand| {
            let (text, is_sound) = (self.text(operand), self.alone.stays(bracket, operand, When::Later));
            if self.stays(bracket, operand) {
                return Some(text);
            }
            is_sound.then(|| opposite(operand, &text))
        });
        Some(opposites.collect::<Option<Vec<_>>>()?.join(" OR "))
    }

    /// Returns two operands of an AND that are never true together (`joined` is `true`), or two operands of an OR of
    /// which one is always true (`joined` is `false`).
    fn pair(&self, bracket: u32, condition: &'l Condition, joined: bool) -> Option<Pair> {
        let operands = match (condition, joined) {
            (Condition::And(operands), true) | (Condition::Or(operands), false) => operands,
            _ => return condition.children().iter().find_map(|operand| self.pair(bracket, operand, joined)),
        };
        let pairs = operands
            .iter()
            .enumerate()
            .flat_map(|(at, one)| operands.iter().skip(at + 1).map(move |other| (one, other)));
        let mut pairs = pairs.filter(|(one, other)| {
            let both = |value| self.is_possible(bracket, &[(*one, value), (*other, value)], When::Later);
            let varies = |operand: &&'l Condition| {
                [true, false].iter().all(|value| self.is_possible(bracket, &[(*operand, *value)], When::Later))
            };
            varies(one) && varies(other) && !both(joined)
        });
        let found = pairs.next().map(|(one, other)| Pair {
            one: self.text(one),
            other: self.text(other),
            may_be_joined_otherwise: self.is_possible(bracket, &[(one, !joined), (other, !joined)], When::Entered),
        });
        found.or_else(|| operands.iter().find_map(|operand| self.pair(bracket, operand, joined)))
    }

    /// Returns `true` if the conditions in `values` can have the given values in the same turn.
    fn is_possible(&self, bracket: u32, values: &[(&'l Condition, bool)], when: When) -> bool {
        let wanted = values.iter().map(|(condition, fired)| ConditionQuestion {
            any: vec![ScopedCondition { condition, bracket, when }],
            fired: *fired,
        });
        self.alone.is_possible(&wanted.collect::<Vec<_>>(), &BTreeMap::new())
    }

    /// Returns an operand of the interrupt's OR as written in the plan. This may differ from the text of the condition,
    /// in which, for example, `null` replaces `wait inf`. If the written text does not have the same number of
    /// operands, returns the text of the condition's operand.
    fn written(&self, operand: &Condition, interrupt: &Interrupt) -> String {
        let operands = interrupt.condition.operands();
        let texts = operands_of(&interrupt.text);
        let at =
            operands.iter().position(|other| std::ptr::eq(other, operand)).filter(|_| texts.len() == operands.len());
        at.and_then(|at| texts.get(at)).map_or_else(|| self.text(operand), |text| (*text).to_owned())
    }

    fn text(&self, condition: &Condition) -> String {
        condition_text(condition, &|id| self.alone.machine.quark(id).text.clone())
    }
}

/// Returns the operands of an OR in the text of a condition; ORs inside parentheses are not split.
fn operands_of(text: &str) -> Vec<&str> {
    let (mut depth, mut from, mut found) = (0_u32, 0, Vec::new());
    for (at, letter) in text.char_indices() {
        match letter {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            ' ' if depth == 0 && text.get(at..).is_some_and(|rest| rest.starts_with(" OR ")) => {
                found.extend(text.get(from..at));
                from = at + " OR ".len();
            }
            _ => {}
        }
    }
    found.extend(text.get(from..));
    found
}

/// Returns `true` if it is obvious that a condition can have both values.
fn is_open(condition: &Condition) -> bool {
    matches!(condition, Condition::Quark(_) | Condition::Wait { nanos: 1.., .. } | Condition::After(_))
}

/// Adds to a warning the advice to replace or remove an operand that is never true.
fn never_true(lint: Diagnostic, operands: &[Condition], text: &str, span: Span) -> Diagnostic {
    match operands {
        [_] => lint.fix("if it is never to fire, write {}", span, "(null)"),
        _ => lint.help(format!("remove `{text}`")),
    }
}

/// Returns the text of the negation of `condition`; `text` is the text of the condition.
fn opposite(condition: &Condition, text: &str) -> String {
    #[allow(clippy::wildcard_enum_match_arm, reason = "all other conditions are negated as a whole")]
    match condition {
        Condition::Not(_) => text.strip_prefix("NOT ").unwrap_or(text).to_owned(),
        Condition::Elapsed { .. } | Condition::Driven { .. } => {
            let opposites = [(" < ", " >= "), (" <= ", " > "), (" > ", " <= "), (" >= ", " < ")];
            let opposite = opposites.iter().find(|(operator, _)| text.contains(operator));
            opposite.map_or_else(|| format!("NOT {text}"), |(operator, opposite)| text.replace(operator, opposite))
        }
        _ => format!("NOT ({text})"),
    }
}
