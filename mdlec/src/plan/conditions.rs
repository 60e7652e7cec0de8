//! Conditions: quarks joined by AND, OR and NOT, and their text (semantics, section 2; language, section 7).

use super::parameters::Names;
use super::quarks::Quarks;
use super::resolve::not_yet;
use super::{Condition, Interrupt, Value, comparisons};
use crate::alphabet::DeclarationKind;
use crate::diagnostic::{Diagnostic, Span};
use crate::syntax::tree::{self, Call, Compared, ConditionNode};

/// Resolves the condition of a scope at `scope`; without one it is the null interrupt.
/// What cannot be resolved is reported and counts as null.
pub(super) fn interrupt(
    condition: Option<&tree::Condition>,
    scope: Span,
    quarks: &mut Quarks<'_>,
    names: Names<'_, '_>,
    found: &mut Vec<Diagnostic>,
) -> Interrupt {
    let Some(written) = condition else {
        return Interrupt::none(scope);
    };
    let condition = Resolving { quarks, names, found }.condition(written);
    let text = text(&condition, quarks, Precedence::Or);
    Interrupt { condition: without_infinite_waits(condition), text, removed: false, span: written.span }
}

/// The nanoseconds of `wait inf`; no other wait may be as long.
const FOR_EVER: u64 = u64::MAX;

/// `wait inf` is the null interrupt, once its text is made.
fn without_infinite_waits(condition: Condition) -> Condition {
    let all = |operands: Vec<Condition>| operands.into_iter().map(without_infinite_waits).collect();
    match condition {
        Condition::Wait { nanos: FOR_EVER, .. } => Condition::Null,
        Condition::Or(operands) => Condition::Or(all(operands)),
        Condition::And(operands) => Condition::And(all(operands)),
        Condition::Not(operand) => Condition::Not(Box::new(without_infinite_waits(*operand))),
        other @ (Condition::Null | Condition::Quark(_) | Condition::Wait { .. } | Condition::Elapsed { .. }) => other,
    }
}

struct Resolving<'r, 'a> {
    quarks: &'r mut Quarks<'a>,
    names: Names<'r, 'r>,
    found: &'r mut Vec<Diagnostic>,
}

impl Resolving<'_, '_> {
    fn condition(&mut self, written: &tree::Condition) -> Condition {
        let later = match &written.node {
            ConditionNode::Or(operands) => return Condition::Or(self.all(operands)),
            ConditionNode::And(operands) => return Condition::And(self.all(operands)),
            ConditionNode::Not(operand) => return Condition::Not(Box::new(self.condition(operand))),
            ConditionNode::Call(call) => return self.call(call),
            ConditionNode::Comparison(compared) => return self.comparison(compared, written.span),
            ConditionNode::Null | ConditionNode::Broken => return Condition::Null,
            ConditionNode::Rising(_) => "`RISING`",
            ConditionNode::After(_) => "`after`",
        };
        self.found.push(not_yet(later, written.span));
        Condition::Null
    }

    fn comparison(&mut self, compared: &Compared, span: Span) -> Condition {
        comparisons::resolve(compared, span, self.quarks, self.names).unwrap_or_else(|found| {
            self.found.extend(found);
            Condition::Null
        })
    }

    fn all(&mut self, operands: &[tree::Condition]) -> Vec<Condition> {
        operands.iter().map(|operand| self.condition(operand)).collect()
    }

    fn call(&mut self, call: &Call) -> Condition {
        match self.quarks.resolve(call, DeclarationKind::Interrupt, self.names) {
            Ok(id) => match self.quarks.get(id) {
                Some(quark) if quark.name == "wait" => match quark.args.first() {
                    Some(Value::Quantity { exact, .. }) => {
                        Condition::Wait { nanos: exact.to_nanos().unwrap_or(u64::MAX), quark: id }
                    }
                    Some(_) | None => Condition::Wait { nanos: FOR_EVER, quark: id },
                },
                Some(_) | None => Condition::Quark(id),
            },
            Err(found) => {
                self.found.extend(found);
                Condition::Null
            }
        }
    }
}

/// What binds how tightly, loosest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Precedence {
    Or,
    And,
    Test,
}

fn text(condition: &Condition, quarks: &Quarks<'_>, around: Precedence) -> String {
    let join = |operands: &[Condition], word: &str, inside: Precedence| {
        let operands: Vec<_> = operands.iter().map(|operand| text(operand, quarks, inside)).collect();
        operands.join(word)
    };
    let (text, precedence) = match condition {
        Condition::Null => ("null".to_owned(), Precedence::Test),
        Condition::Quark(id) | Condition::Wait { quark: id, .. } | Condition::Elapsed { quark: id, .. } => {
            (quarks.get(*id).map(|quark| quark.text.clone()).unwrap_or_default(), Precedence::Test)
        }
        // An OR inside an OR needs no parentheses: the text is flattened, the condition stays as written.
        Condition::Or(operands) => (join(operands, " OR ", Precedence::Or), Precedence::Or),
        Condition::And(operands) => (join(operands, " AND ", Precedence::And), Precedence::And),
        Condition::Not(operand) => (format!("NOT {}", text(operand, quarks, Precedence::Test)), Precedence::And),
    };
    if precedence < around { format!("({text})") } else { text }
}
