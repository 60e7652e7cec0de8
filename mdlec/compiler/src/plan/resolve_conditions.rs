//! Resolves conditions, which are quarks joined by AND, OR and NOT, and writes their text
//! (docs/src/reference/semantics.md, 2.1; docs/src/reference/language.md, 7).

use std::num::NonZeroU32;

use super::arguments::written;
use super::labels::Labels;
use super::parameters::DefinitionNames;
use super::quarks::ResolvedQuarks;
use super::{After, Condition, Interrupt, OperandPlace, QuarkId, Value, comparisons};
use crate::alphabet::DeclarationKind;
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::tree::{self, Arg, Call, Compared, ConditionNode, Operand};

/// Context in which conditions are resolved.
pub(super) struct ConditionScope<'r, 'a, 'n> {
    pub(super) quarks: &'r mut ResolvedQuarks<'a>,
    pub(super) names: DefinitionNames<'r, 'n>,
    /// Labels of the definition that contains the condition.
    pub(super) labels: &'r mut Labels,
    pub(super) found: &'r mut Vec<Diagnostic>,
}

/// Resolves the condition of a scope; `scope` is the span of the scope. Returns the interrupt, and the text of each
/// operand of its outermost OR. A scope without a condition gets the null interrupt. A part that cannot be resolved is
/// reported and treated as null.
pub(super) fn interrupt(
    condition: Option<&tree::Condition>,
    scope: Span,
    around: ConditionScope<'_, '_, '_>,
) -> (Interrupt, Vec<String>) {
    let Some(written) = condition else {
        return (Interrupt::none(scope), vec!["null".to_owned()]);
    };
    let mut resolving = Resolving { around, memories: 0 };
    let condition = resolving.condition(written);
    let Resolving { around: ConditionScope { quarks, .. }, mut memories } = resolving;
    let name = |id| quarks.get(id).map(|quark| quark.text.clone()).unwrap_or_default();
    let operands = condition.operands().iter().map(|operand| condition_text(operand, &name)).collect();
    let text = condition_text(&condition, &name);
    let has_nested = condition.any(&|part| matches!(part, Condition::Or(all) if all.iter().any(is_or)));
    let nested = has_nested.then(|| self::text(&condition, &name, Precedence::Or, Ors::Nested).into_boxed_str());
    let mut places = Vec::new();
    joined(written, &mut places);
    for (place, part) in places.iter_mut().zip(condition.joined()) {
        let is_infinite = part.any(&|part| matches!(part, Condition::Wait { nanos: FOR_EVER, .. }));
        place.text = is_infinite.then(|| Box::new(condition_text(part, &name)));
    }
    let mut condition = without_infinite_waits(condition);
    if condition != Condition::Null && constant(&condition) == Some(false) {
        // The condition has no operands left, so reports name it by its whole text.
        places = vec![OperandPlace { span: written.span, signals: [None; 2], text: Some(Box::new(text.clone())) }];
        (condition, memories) = (Condition::Null, 0);
    }
    let places = places.into();
    (Interrupt { condition, text, nested, operands: places, memories, removed: false, span: written.span }, operands)
}

/// Collects the positions of the parts that AND and OR join.
fn joined(written: &tree::Condition, places: &mut Vec<OperandPlace>) {
    match written.node {
        ConditionNode::Or(operands) | ConditionNode::And(operands) => {
            operands.iter().for_each(|operand| joined(operand, places));
        }
        ConditionNode::Not(_) | ConditionNode::Rising(_) | ConditionNode::Call(_) | ConditionNode::Comparison(_) => {
            places.push(OperandPlace { span: written.span, signals: signals(written), text: None });
        }
        ConditionNode::After(_) | ConditionNode::Null | ConditionNode::Broken => {
            places.push(OperandPlace { span: written.span, signals: [None; 2], text: None });
        }
    }
}

/// Returns the offsets in the text at which the signals that an operand compares end.
fn signals(operand: &tree::Condition) -> [Option<NonZeroU32>; 2] {
    match operand.node {
        ConditionNode::Comparison(Compared { left, right: Operand::Signal(right), .. }) => {
            [NonZeroU32::new(left.span.end), NonZeroU32::new(right.span.end)]
        }
        ConditionNode::Comparison(Compared { left, .. }) => [NonZeroU32::new(left.span.end), None],
        ConditionNode::Not(inside) | ConditionNode::Rising(inside) => signals(inside),
        ConditionNode::Or(_) | ConditionNode::And(_) | ConditionNode::Call(_) => [None; 2],
        ConditionNode::After(_) | ConditionNode::Null | ConditionNode::Broken => [None; 2],
    }
}

/// Number of nanoseconds that represents `wait inf`. Any other wait must be shorter.
const FOR_EVER: u64 = u64::MAX;

/// Replaces `wait inf` by the null interrupt. Called after the text has been written.
fn without_infinite_waits(condition: Condition) -> Condition {
    condition.map(&|part| if matches!(part, Condition::Wait { nanos: FOR_EVER, .. }) { Condition::Null } else { part })
}

/// Returns the constant value of a condition that consists only of null interrupts and operators; `None` for
/// any other condition.
fn constant(condition: &Condition) -> Option<bool> {
    let all = |operands: &[Condition]| operands.iter().map(constant).collect::<Option<Vec<_>>>();
    match condition {
        Condition::Null => Some(false),
        Condition::Or(operands) => Some(all(operands)?.contains(&true)),
        Condition::And(operands) => Some(!all(operands)?.contains(&false)),
        Condition::Not(operand) => constant(operand).map(|value| !value),
        // RISING of a constant never fires, because the operand never changes from false to true.
        Condition::Rising { operand, .. } => constant(operand).map(|_| false),
        Condition::Quark(_) | Condition::Wait { .. } | Condition::Elapsed { .. } => None,
        Condition::Driven { .. } | Condition::After(_) => None,
    }
}

struct Resolving<'r, 'a, 'n> {
    around: ConditionScope<'r, 'a, 'n>,
    /// Number of RISINGs in this condition that have been resolved so far.
    memories: u32,
}

impl Resolving<'_, '_, '_> {
    fn condition(&mut self, written: &tree::Condition) -> Condition {
        match &written.node {
            ConditionNode::Or(operands) => Condition::Or(self.all(operands)),
            ConditionNode::And(operands) => Condition::And(self.all(operands)),
            ConditionNode::Not(operand) => Condition::Not(Box::new(self.condition(operand))),
            ConditionNode::Rising(operand) => {
                let memory = self.memories;
                self.memories += 1;
                Condition::Rising { memory, operand: Box::new(self.condition(operand)) }
            }
            ConditionNode::Call(call) => self.call(call),
            ConditionNode::Comparison(compared) => self.comparison(compared, written.span),
            ConditionNode::After(after) => self.after(after),
            ConditionNode::Null | ConditionNode::Broken => Condition::Null,
        }
    }

    fn after(&mut self, after: &tree::After) -> Condition {
        // The cause only serves to find an operand of the label's interrupt by its text, so its RISINGs get no memories
        // here.
        let memories = self.memories;
        let is_unknown = |call: &Call| self.around.quarks.alphabet().declarations_of(call.name).next().is_none();
        if let Some(by) = after.cause.as_ref().and_then(|cause| by_word(cause, is_unknown)) {
            self.around.found.push(by);
            return Condition::Null;
        }
        let before = self.around.found.len();
        let cause = after.cause.as_ref().map(|cause| (self.condition(cause), cause));
        self.memories = memories;
        if self.around.found.len() > before {
            // A cause that cannot be resolved cannot be an operand.
            return Condition::Null;
        }
        let cause = cause.map(|(cause, written)| {
            let quarks = &self.around.quarks;
            let words =
                condition_text(&cause, &|id| quarks.get(id).map(|quark| quark.text.clone()).unwrap_or_default());
            let stands_alone = matches!(written.node, ConditionNode::Call(_));
            (written.span, words, stands_alone)
        });
        let label = after.label;
        let words = match &cause {
            None => format!("after {}", label.node),
            Some((_, words, true)) => format!("after {} {words}", label.node),
            Some((_, words, false)) => format!("after {} ({words})", label.node),
        };
        let (record, fact) = self.around.labels.asked(label, cause.map(|(span, words, _)| (words, span)));
        Condition::After(After { record, fact, text: words })
    }

    fn comparison(&mut self, compared: &Compared, span: Span) -> Condition {
        comparisons::resolve(compared, span, self.around.quarks, self.around.names).unwrap_or_else(|found| {
            self.around.found.extend(found);
            Condition::Null
        })
    }

    fn all(&mut self, operands: &[tree::Condition]) -> Vec<Condition> {
        operands.iter().map(|operand| self.condition(operand)).collect()
    }

    fn call(&mut self, call: &Call) -> Condition {
        match self.around.quarks.resolve(call, DeclarationKind::Interrupt, self.around.names) {
            Ok(id) => match self.around.quarks.get(id) {
                Some(quark) if quark.name == "wait" => match quark.args.first() {
                    Some(Value::Quantity { exact, .. }) => {
                        Condition::Wait { nanos: exact.to_nanos().unwrap_or(u64::MAX), quark: id }
                    }
                    Some(_) | None => Condition::Wait { nanos: FOR_EVER, quark: id },
                },
                Some(quark) if quark.name == "stuck" => match quark.args.first() {
                    Some(Value::Quantity { exact, .. }) => Condition::stuck(id, exact.to_nanos().unwrap_or(u64::MAX)),
                    Some(Value::Infinity(_)) => Condition::Wait { nanos: FOR_EVER, quark: id },
                    Some(_) | None => Condition::Quark(id),
                },
                Some(quark) if quark.name == "rendezvous" => Condition::later(id),
                Some(_) | None => Condition::Quark(id),
            },
            Err(found) => {
                self.around.found.extend(found);
                Condition::Null
            }
        }
    }
}

/// Reports a word between a label and its cause, as in `after ahead by wait 5`.
fn by_word(cause: &tree::Condition, is_unknown: impl Fn(&Call) -> bool) -> Option<Diagnostic> {
    let ConditionNode::Call(call) = cause.node else { return None };
    let [Arg::Name(name), args @ ..] = call.args else { return None };
    let is_word =
        matches!(call.name, "by" | "because" | "with" | "from" | "due" | "through" | "via") && is_unknown(call);
    let inside = Call { name: name.node, args, span: call.span };
    let message = format!("no word is between a label and its cause, found `{}`", call.name);
    let diagnostic = Diagnostic::new(Code::E0207, message, call.name_span(), "not a cause");
    is_word.then(|| diagnostic.fix("write {}", call.span, written(&inside)))
}

/// Precedence of operators. The operator that binds least tightly comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Precedence {
    Or,
    And,
    Test,
}

/// Layout of an OR that is an operand of another OR.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ors {
    /// The operands of the inner OR are written among the operands of the outer OR.
    Flattened,
    /// The inner OR is written in parentheses, as in the plan.
    Nested,
}

fn is_or(condition: &Condition) -> bool {
    matches!(condition, Condition::Or(_))
}

/// Returns the text of a condition (docs/src/reference/language.md, 7), given the texts of its quarks.
pub fn condition_text(condition: &Condition, quark: &impl Fn(QuarkId) -> String) -> String {
    text(condition, quark, Precedence::Or, Ors::Flattened)
}

fn text(condition: &Condition, quark: &impl Fn(QuarkId) -> String, around: Precedence, ors: Ors) -> String {
    let join = |operands: &[Condition], word: &str, inside: Precedence| {
        let operands: Vec<_> = operands.iter().map(|operand| text(operand, quark, inside, ors)).collect();
        operands.join(word)
    };
    let inside_or = match ors {
        Ors::Flattened => Precedence::Or,
        Ors::Nested => Precedence::And,
    };
    if let Some((id, _)) = condition.lasting() {
        return quark(id);
    }
    let (text, precedence) = match condition {
        Condition::Null => ("null".to_owned(), Precedence::Test),
        Condition::Quark(id)
        | Condition::Wait { quark: id, .. }
        | Condition::Elapsed { quark: id, .. }
        | Condition::Driven { quark: id, .. } => (quark(*id), Precedence::Test),
        // An OR inside an OR needs no parentheses: the text is flattened, the condition stays as written.
        Condition::Or(operands) => (join(operands, " OR ", inside_or), Precedence::Or),
        Condition::And(operands) => (join(operands, " AND ", Precedence::And), Precedence::And),
        Condition::Not(operand) => (format!("NOT {}", text(operand, quark, Precedence::Test, ors)), Precedence::And),
        Condition::Rising { operand, .. } => {
            (format!("RISING {}", text(operand, quark, Precedence::Test, ors)), Precedence::And)
        }
        Condition::After(after) => (after.text.clone(), Precedence::Test),
    };
    if precedence < around { format!("({text})") } else { text }
}
