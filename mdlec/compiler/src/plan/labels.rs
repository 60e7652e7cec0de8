//! Labels in a definition, and the `after` conditions that refer to them (docs/src/reference/semantics.md, 2.3). A plan
//! that is used by name is copied in, so each use of its definition has labels of its own.

use std::collections::{BTreeMap, BTreeSet};

use super::{Fact, Mark, Node, Record, RecordId, Scope};
use crate::alphabet;
use crate::diagnostic::{Code, Diagnostic, Span};
use crate::syntax::tree::Name;

/// The labels of one use of a definition.
#[derive(Debug, Clone)]
pub(super) struct Labels {
    record: RecordId,
    labels: BTreeMap<String, LabelCauses>,
    /// Facts that `after` conditions read, by label and cause. Each entry contains the number of the fact, and the span
    /// of the first condition that reads it.
    asked: BTreeMap<(String, Option<String>), AfterLabel>,
}

/// A label, with the causes that can end its element.
#[derive(Debug, Clone)]
struct LabelCauses {
    span: Span,
    ends: EndCauses,
    /// `true` if another element has the same label.
    is_ambiguous: bool,
}

/// Causes that can end an element.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum EndCauses {
    /// The element ends when one of the operands of its interrupt fires; contains the texts of the operands.
    Operands(Vec<String>),
    /// The element ends together with its last element, because it has no interrupt of its own.
    WithItsLast,
    /// The causes are unknown, because the element uses a plan by name that has not been copied yet, or because two
    /// elements have the same label.
    Unknown,
}

#[derive(Debug, Clone, Copy)]
struct AfterLabel {
    number: u32,
    label: Span,
    cause: Option<Span>,
}

impl Labels {
    /// Creates the labels of a new use of a definition; `record` is the record of this use.
    pub(super) fn new(record: RecordId) -> Self {
        Self { record, labels: BTreeMap::new(), asked: BTreeMap::new() }
    }

    /// Records a label. Reports an error if the label was used before.
    pub(super) fn add(&mut self, label: Name<'_>, found: &mut Vec<Diagnostic>) {
        if let Some(first) = self.labels.get_mut(label.node) {
            // It is unknown which of the elements `after` means.
            (first.ends, first.is_ambiguous) = (EndCauses::Unknown, true);
            let message = format!("there are two labels `{}` in this plan", label.node);
            found.push(
                Diagnostic::new(Code::E0203, message, label.span, "the second one")
                    .also(first.span, "the first one")
                    .help("give one of them another name"),
            );
            return;
        }
        self.labels.insert(
            label.node.to_owned(),
            LabelCauses { span: label.span, ends: EndCauses::WithItsLast, is_ambiguous: false },
        );
    }

    /// Sets the causes that can end the element with the label `label`.
    pub(super) fn ends(&mut self, label: &str, ends: EndCauses) {
        if let Some(label) = self.labels.get_mut(label).filter(|label| !label.is_ambiguous) {
            label.ends = ends;
        }
    }

    /// Returns a mark for the node that ends together with the element of a label.
    pub(super) fn mark(&self, label: &str) -> Mark {
        Mark { record: self.record, label: label.to_owned(), facts: Vec::new() }
    }

    /// Returns the record and the number of the fact that an `after` condition reads. A new fact gets the next number.
    pub(super) fn asked(&mut self, label: Name<'_>, cause: Option<(String, Span)>) -> (RecordId, u32) {
        let (words, span) = cause.unzip();
        let number = u32::try_from(self.asked.len()).unwrap_or(u32::MAX);
        let asked = AfterLabel { number, label: label.span, cause: span };
        let asked = self.asked.entry((label.node.to_owned(), words)).or_insert(asked);
        (self.record, asked.number)
    }

    /// Completes the use of a definition; `scope` is its outermost scope. Adds the facts that `after` reads to the
    /// marks. If `after` reads no label of this use, removes the marks.
    pub(super) fn finish(self, scope: &mut Scope, found: &mut Vec<Diagnostic>) {
        let mut facts: BTreeMap<&str, Vec<Fact>> = BTreeMap::new();
        for ((label, cause), asked) in &self.asked {
            match self.operand(label, cause.as_deref(), *asked) {
                Ok(operand) => {
                    facts.entry(label.as_str()).or_default().push(Fact { number: asked.number, operand });
                }
                Err(wrong) => found.push(for_behavior(*wrong, label, scope)),
            }
        }
        if !self.asked.is_empty() {
            scope.record = Some(Record { id: self.record, facts: u32::try_from(self.asked.len()).unwrap_or(u32::MAX) });
        }
        let is_asked = !self.asked.is_empty();
        if !self.labels.is_empty() {
            visit(&mut scope.body, &mut |marks| {
                for mark in marks.iter_mut().filter(|mark| mark.record == self.record) {
                    mark.facts = facts.get(mark.label.as_str()).cloned().unwrap_or_default();
                }
                marks.retain(|mark| mark.record != self.record || is_asked);
            });
        }
    }

    /// Returns the operand that must be the cause of the end; `None` if any cause is accepted.
    fn operand(&self, label: &str, cause: Option<&str>, asked: AfterLabel) -> Result<Option<u32>, Box<Diagnostic>> {
        let Some(known) = self.labels.get(label) else { return Err(self.unknown(label, asked.label).into()) };
        let (Some(cause), Some(span)) = (cause, asked.cause) else { return Ok(None) };
        let here = |text: &str| Diagnostic::new(Code::E0207, text, span, "not a cause").also(known.span, "the label");
        match &known.ends {
            EndCauses::Unknown => Ok(None),
            EndCauses::WithItsLast => {
                let message = format!("`{label}` has no interrupt of its own: only its last element ends it");
                Err(here(&message).help(format!("leave the cause out: `after {label}`")).into())
            }
            EndCauses::Operands(operands) => {
                let place = (0..).zip(operands).find(|(_, operand)| *operand == cause).map(|(place, _)| place);
                place.map(Some).ok_or_else(|| {
                    let message = format!("`{cause}` is not an operand of the interrupt of `{label}`");
                    // An operand that contains `after` with this label is not proposed as a cause, because writing it
                    // would change the operand itself.
                    let itself = format!("after {label}");
                    let meant = operands.iter().filter(|operand| !operand.contains(&itself));
                    let meant: BTreeSet<_> = meant.map(|operand| cause_of(label, operand)).collect();
                    let meant: Vec<_> = meant.into_iter().collect();
                    let help = match meant.as_slice() {
                        [] => format!("leave the cause out: `{itself}`"),
                        meant => format!("write {}, or `{itself}`", meant.join(" or ")),
                    };
                    here(&message).help(help).into()
                })
            }
        }
    }

    fn unknown(&self, label: &str, span: Span) -> Diagnostic {
        let message = format!("there is no label `{label}` in this plan");
        let found = Diagnostic::new(Code::E0201, message, span, "not a label");
        match alphabet::nearest(label, self.labels.keys().map(String::as_str)) {
            Some(near) => found.fix("did you mean {}?", span, near),
            None if self.labels.is_empty() => {
                found.help(format!("a label is written before an element of the same plan: `{label}: (Atom …)`"))
            }
            None => {
                let labels: Vec<_> = self.labels.keys().map(|label| format!("`{label}`")).collect();
                found.help(format!("the labels of this plan are {}", labels.join(", ")))
            }
        }
    }
}

/// Adds help about the right place for a label to a diagnostic, if the label is the name of a behavior in this use.
fn for_behavior(found: Diagnostic, label: &str, scope: &Scope) -> Diagnostic {
    let is_behavior = |node: &Node| matches!(node, Node::Scope(inner) if inner.name == label);
    if found.code != Code::E0201 || !scope.body.iter().any(is_behavior) {
        return found;
    }
    let mut found = found;
    found.help.clear();
    let lower = label.to_lowercase();
    let own = if lower == label { "s1" } else { lower.as_str() };
    found.help(format!(
        "`{label}` is a behavior; give it a label and ask for that: `{own}: {{ {label} … }}`, `after {own}`"
    ))
}

/// Returns a text such as `after s1 bumper`, with parentheses if the operand is more than a quark.
fn cause_of(label: &str, operand: &str) -> String {
    let is_more =
        [" OR ", " AND ", "NOT ", "RISING ", "after ", "<", ">", "=="].iter().any(|word| operand.contains(word));
    if is_more { format!("`after {label} ({operand})`") } else { format!("`after {label} {operand}`") }
}

/// Calls `each` with the marks of each node.
fn visit(body: &mut [Node], each: &mut impl FnMut(&mut Vec<Mark>)) {
    for node in body {
        each(node.marks_mut());
        match node {
            Node::Atom(_) => {}
            Node::Scope(scope) => visit(&mut scope.body, each),
            Node::Loop(repeated) => visit(&mut repeated.body, each),
        }
    }
}
