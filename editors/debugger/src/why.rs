//! Explains why a condition holds or does not hold, with the values of its operands.

use std::slice::Iter;

use mdle_compiler::plan::{Condition, OperandPlace, Plan, condition_text};
use mdle_compiler::trace::{OpenPart, Reports};

use crate::launch::LaunchedPlan;
use crate::run::DebugRun;
use crate::stack::StackFrame;

/// Value of a condition in a turn, with its operands.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reason {
    /// Text of the condition.
    pub(crate) text: String,
    pub(crate) holds: bool,
    /// Reason for the value, such as the elapsed time; empty if the operands already explain the value.
    pub(crate) detail: String,
    /// `true` for a comparison, whose first word is the name of a number and not a condition.
    is_comparison: bool,
    pub(crate) operands: Vec<Reason>,
}

/// Explains the value of the condition that `expression` selects. `expression` can be the frame's whole condition or a
/// part of it, written as in the file or as conditions are printed. It can also be the first word of an operand: for
/// example, the name of a signal selects all comparisons of this signal. Returns `None` if the frame's condition has no
/// such part.
pub(crate) fn why(
    loaded: &LaunchedPlan,
    run: &DebugRun<'_>,
    frame: &StackFrame,
    expression: &str,
) -> Option<Vec<Reason>> {
    let (plan, reports) = (&loaded.compiled.plan, run.reports());
    let open = run.open().nth(frame.open)?;
    let interrupt = open.part().interrupt()?;
    let meant = plain(expression);
    let whole = reason(plan, open, &interrupt.condition, reports);
    if meant == plain(loaded.slice(interrupt.span)) || meant == interrupt.text {
        return Some(vec![whole]);
    }
    let is_meant = |first: &OperandPlace, last: &OperandPlace| meant == plain(loaded.slice(first.span.to(last.span)));
    if let Some(part) = written(&interrupt.condition, &mut interrupt.operands.iter(), &is_meant) {
        return Some(vec![reason(plan, open, part, reports)]);
    }
    if let Some(named) = whole.find(&|part| part.text == meant) {
        return Some(vec![named.clone()]);
    }
    let leaves = whole.leaves().into_iter();
    let named: Vec<Reason> = leaves.filter(|part| part.text.split(' ').next() == Some(&meant)).cloned().collect();
    let comparisons: Vec<Reason> = named.iter().filter(|part| part.is_comparison).cloned().collect();
    if comparisons.is_empty() { named.into_iter().next().map(|first| vec![first]) } else { Some(comparisons) }
}

/// Returns a sentence about `reasons`. For a single condition, it contains the value. For the comparisons of a number,
/// which itself is neither true nor false, it contains the text and the value of each comparison.
pub(crate) fn sentence(reasons: &[Reason], expression: &str) -> String {
    let expression = plain(expression);
    match reasons {
        [only] if !only.is_comparison || only.text.split(' ').next() != Some(&expression) => only.sentence(),
        _ => reasons.iter().map(|part| format!("`{}` {}", part.text, part.value())).collect::<Vec<_>>().join("; "),
    }
}

/// Returns the first part of a condition that `is_meant` accepts, given the first and the last operand of the part.
fn written<'c, 'p>(
    condition: &'c Condition,
    places: &mut Iter<'p, OperandPlace>,
    is_meant: &impl Fn(&OperandPlace, &OperandPlace) -> bool,
) -> Option<&'c Condition> {
    let first = places.as_slice().first()?;
    let mut last = first;
    if condition.joined().len() == 1 {
        places.next();
    } else {
        for operand in condition.children() {
            let before = places.as_slice();
            if let Some(part) = written(operand, places, is_meant) {
                return Some(part);
            }
            let taken = before.len() - places.as_slice().len();
            last = before.get(taken.saturating_sub(1))?;
        }
    }
    is_meant(first, last).then_some(condition)
}

/// Returns a text with single spaces and without its outer parentheses.
fn plain(text: &str) -> String {
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let inner = words.strip_prefix('(').and_then(|text| text.strip_suffix(')')).filter(|text| is_balanced(text));
    inner.map_or_else(|| words.clone(), plain)
}

/// Returns `true` if the parentheses of a text are balanced.
fn is_balanced(text: &str) -> bool {
    let depth = text.chars().try_fold(0_i64, |depth, c| match c {
        '(' => Some(depth + 1),
        ')' => (depth > 0).then_some(depth - 1),
        _ => Some(depth),
    });
    depth == Some(0)
}

/// Evaluates a condition of an open scope or atom in the turn of `reports`, and explains the result.
pub(crate) fn reason(plan: &Plan, part: OpenPart<'_, '_>, condition: &Condition, reports: &Reports) -> Reason {
    let operands = if condition.lasting().is_some() { &[] } else { condition.children() };
    Reason {
        text: condition_text(condition, &|id| plan.quark(id).text.clone()),
        holds: part.holds(condition, reports),
        detail: detail(part, condition, reports),
        is_comparison: match condition {
            Condition::Quark(quark) => plan.quark(*quark).comparison.is_some(),
            Condition::Elapsed { .. } | Condition::Driven { .. } => true,
            Condition::Null
            | Condition::Wait { .. }
            | Condition::Not(_)
            | Condition::Rising { .. }
            | Condition::After(_)
            | Condition::Or(_)
            | Condition::And(_) => false,
        },
        operands: operands.iter().map(|operand| reason(plan, part, operand, reports)).collect(),
    }
}

fn detail(part: OpenPart<'_, '_>, condition: &Condition, reports: &Reports) -> String {
    let time = |nanos: u64| format!("{} s", nanos as f64 / 1e9);
    let passed = || time(part.since(reports).0);
    if let Some((_, nanos)) = condition.lasting() {
        return format!("{} of {} have passed", passed(), time(nanos));
    }
    match condition {
        Condition::Wait { nanos, .. } => format!("{} of {} have passed", passed(), time(*nanos)),
        Condition::Elapsed { .. } => format!("{} have passed", passed()),
        Condition::Driven { .. } => format!("{} m were driven", part.way(reports).0 as f64 / 1e9),
        Condition::Rising { memory, .. } => match part.memories().get(*memory as usize) {
            Some(true) => "its operand was false before".to_owned(),
            Some(false) | None => "its operand was never false before".to_owned(),
        },
        Condition::Null => "null never fires".to_owned(),
        Condition::Quark(_) | Condition::After(_) => String::new(),
        Condition::Or(_) | Condition::And(_) | Condition::Not(_) => String::new(),
    }
}

impl Reason {
    /// Returns the first reason that `is_it` accepts; an operator is tried before its operands.
    fn find(&self, is_it: &impl Fn(&Self) -> bool) -> Option<&Self> {
        if is_it(self) { Some(self) } else { self.operands.iter().find_map(|operand| operand.find(is_it)) }
    }

    /// Returns the value as text, with its detail.
    pub(crate) fn value(&self) -> String {
        let value = if self.holds { "holds" } else { "does not hold" };
        if self.detail.is_empty() { value.to_owned() } else { format!("{value}: {}", self.detail) }
    }

    /// Returns the value as text, followed by the values of the operands that determine it.
    fn sentence(&self) -> String {
        let mut sentence = self.value();
        let operands: Vec<String> =
            self.leaves().iter().map(|leaf| format!("`{}` {}", leaf.text, leaf.value())).collect();
        if !self.operands.is_empty() {
            sentence = format!("{sentence}; {}", operands.join("; "));
        }
        sentence
    }

    /// Returns all nested reasons without operands.
    fn leaves(&self) -> Vec<&Self> {
        match self.operands.as_slice() {
            [] => vec![self],
            operands => operands.iter().flat_map(Self::leaves).collect(),
        }
    }
}
