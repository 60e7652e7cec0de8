//! The reason why a condition holds or does not hold, operand by operand.

use std::slice::Iter;

use mdle_compiler::plan::{Condition, OperandPlace, Plan, condition_text};
use mdle_compiler::trace::{OpenPart, Reports};

use crate::launch::Loaded;
use crate::run::Run;
use crate::stack::Frame;

/// A condition in a turn, with its operands.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reason {
    /// Condition text.
    pub(crate) text: String,
    pub(crate) holds: bool,
    /// Reason for the verdict, such as the time that has passed; empty if it is the operands.
    pub(crate) detail: String,
    /// `true` for a comparison, of which the first word is a number and no condition.
    is_comparison: bool,
    pub(crate) operands: Vec<Reason>,
}

/// Returns the reasons for the condition of a frame, or for an operand of it, that `expression` names: by its text in
/// the file, by its condition text, or by its first word. A signal names all its comparisons.
pub(crate) fn why(loaded: &Loaded, run: &Run<'_>, frame: &Frame, expression: &str) -> Option<Vec<Reason>> {
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

/// Returns the sentence about reasons: the value of a single condition, and of comparisons each with its text, since
/// their number has no value that is true or false.
pub(crate) fn sentence(reasons: &[Reason], expression: &str) -> String {
    let expression = plain(expression);
    match reasons {
        [only] if !only.is_comparison || only.text.split(' ').next() != Some(&expression) => only.sentence(),
        _ => reasons.iter().map(|part| format!("`{}` {}", part.text, part.value())).collect::<Vec<_>>().join("; "),
    }
}

/// Returns the part of a condition that `is_meant` accepts by its first and its last operand.
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

/// Returns a text with single spaces and without the parentheses around it.
fn plain(text: &str) -> String {
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let inner = words.strip_prefix('(').and_then(|text| text.strip_suffix(')')).filter(|text| is_balanced(text));
    inner.map_or_else(|| words.clone(), plain)
}

/// Returns `true` if no closing bracket is before its opening one.
fn is_balanced(text: &str) -> bool {
    let depth = text.chars().try_fold(0_i64, |depth, c| match c {
        '(' => Some(depth + 1),
        ')' => (depth > 0).then_some(depth - 1),
        _ => Some(depth),
    });
    depth == Some(0)
}

/// Returns the reason for a condition of an open part in a turn.
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
    /// Returns the first part that `is_it` accepts, an operator before its operands.
    fn find(&self, is_it: &impl Fn(&Self) -> bool) -> Option<&Self> {
        if is_it(self) { Some(self) } else { self.operands.iter().find_map(|operand| operand.find(is_it)) }
    }

    /// Returns the value, with its detail.
    pub(crate) fn value(&self) -> String {
        let value = if self.holds { "holds" } else { "does not hold" };
        if self.detail.is_empty() { value.to_owned() } else { format!("{value}: {}", self.detail) }
    }

    /// Returns the value, followed by those of the operands that decide it.
    fn sentence(&self) -> String {
        let mut sentence = self.value();
        let operands: Vec<String> =
            self.leaves().iter().map(|leaf| format!("`{}` {}", leaf.text, leaf.value())).collect();
        if !self.operands.is_empty() {
            sentence = format!("{sentence}; {}", operands.join("; "));
        }
        sentence
    }

    /// Returns the operands that have no operands themselves.
    fn leaves(&self) -> Vec<&Self> {
        match self.operands.as_slice() {
            [] => vec![self],
            operands => operands.iter().flat_map(Self::leaves).collect(),
        }
    }
}
