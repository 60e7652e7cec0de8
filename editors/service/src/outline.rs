//! The structure of a document: symbols, and ranges that a user can fold and select.

use std::ops::Range;

use mdle_compiler::diagnostic::Span;
use mdle_compiler::syntax::tree::{Condition, ConditionNode, Element, Plan, Primary};

use crate::mentions::inside;
use crate::view::View;

/// Kind of a symbol.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SymbolKind {
    /// A plan of the file.
    Plan,
    /// A behavior written inside a plan.
    Behavior,
    /// An element with a label.
    Labelled,
}

/// A plan, a behavior or a labelled element, with the symbols that it contains.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Symbol {
    /// Kind of the symbol.
    pub kind: SymbolKind,
    /// Name of the plan or behavior, or the label.
    pub name: String,
    /// Interrupt of the plan or behavior; empty for a labelled element.
    pub detail: String,
    /// Byte range of the whole plan, behavior or element.
    pub range: Range<usize>,
    /// Byte range of the name, inside `range`.
    pub name_range: Range<usize>,
    /// Symbols inside this symbol.
    pub children: Vec<Symbol>,
}

/// Returns the symbols of a document.
#[must_use]
pub fn symbols(view: &View<'_>) -> Vec<Symbol> {
    view.own().iter().filter_map(|plan| symbol(view, plan, plan.span, SymbolKind::Plan)).collect()
}

fn symbol(view: &View<'_>, plan: &Plan<'_>, whole: Span, kind: SymbolKind) -> Option<Symbol> {
    Some(Symbol {
        kind,
        name: plan.name.node.to_owned(),
        detail: plan.condition.map(|condition| view.words(condition.span)).unwrap_or_default(),
        range: view.range(whole)?,
        name_range: view.range(plan.name.span)?,
        children: within(view, plan.elements),
    })
    .filter(|symbol| !symbol.name_range.is_empty())
}

fn within(view: &View<'_>, elements: &[Element<'_>]) -> Vec<Symbol> {
    let mut symbols = Vec::new();
    for element in elements {
        let inner = match element.primary {
            Primary::Plan(plan) => symbol(view, plan, plan.span, SymbolKind::Behavior).into_iter().collect(),
            Primary::Atom(_)
            | Primary::Ref(_)
            | Primary::Exec(_)
            | Primary::String(_)
            | Primary::Formal(_)
            | Primary::Broken => within(view, inside(&element.primary)),
        };
        let labelled = element.label().and_then(|label| {
            let (range, name_range) = (view.range(element.span)?, view.range(label.span)?);
            let (name, detail) = (label.node.to_owned(), String::new());
            Some(Symbol { kind: SymbolKind::Labelled, name, detail, range, name_range, children: Vec::new() })
        });
        match labelled {
            Some(labelled) => symbols.push(Symbol { children: inner, ..labelled }),
            None => symbols.extend(inner),
        }
    }
    symbols
}

/// Returns the ranges that can be folded: elements, plans and comments of more than one line.
#[must_use]
pub fn folds(view: &View<'_>) -> Vec<Range<usize>> {
    let mut spans = Vec::new();
    view.own().iter().for_each(|plan| spans_of(plan, &mut spans));
    let is_long = |range: &Range<usize>| view.text.get(range.clone()).is_some_and(|text| text.contains('\n'));
    let mut folds: Vec<_> = spans.into_iter().filter_map(|span| view.range(span)).filter(is_long).collect();
    folds.sort_by_key(|range| (range.start, std::cmp::Reverse(range.end)));
    folds.dedup();
    folds
}

/// Returns the ranges that can be selected at a byte offset, from the smallest to the whole document.
#[must_use]
pub fn selections(view: &View<'_>, byte: usize) -> Vec<Range<usize>> {
    let mut spans = Vec::new();
    view.own().iter().for_each(|plan| spans_of(plan, &mut spans));
    let around = spans.into_iter().filter_map(|span| view.range(span));
    let mut around: Vec<_> = around.filter(|range| range.start <= byte && byte <= range.end).collect();
    around.push(0..view.text.len());
    around.sort_by_key(ExactSizeIterator::len);
    // Each range contains the previous one.
    let mut nested: Vec<Range<usize>> = Vec::new();
    for range in around {
        if nested.last().is_none_or(|inner| range.start <= inner.start && inner.end <= range.end && range != *inner) {
            nested.push(range);
        }
    }
    nested
}

/// Appends the span of a plan and the spans of all its parts.
fn spans_of(plan: &Plan<'_>, spans: &mut Vec<Span>) {
    spans.extend([plan.span, plan.name.span]);
    plan.params.iter().for_each(|param| spans.push(param.name.span.to(param.type_name.span)));
    plan.condition.iter().for_each(|condition| spans_of_condition(condition, spans));
    spans_of_elements(plan.elements, spans);
}

fn spans_of_elements(elements: &[Element<'_>], spans: &mut Vec<Span>) {
    for element in elements {
        spans.push(element.span);
        match element.primary {
            Primary::Plan(plan) => spans_of(plan, spans),
            Primary::Atom(atom) => {
                spans_of_condition(&atom.condition, spans);
                spans.extend([atom.control.span, atom.control.name_span()]);
                spans.extend(atom.control.args.iter().map(|arg| arg.span()));
            }
            Primary::Formal(formal) => {
                spans_of_elements(formal.body, spans);
                spans_of_condition(&formal.condition, spans);
            }
            Primary::Ref(call) => spans.push(call.span),
            Primary::Exec(_) | Primary::String(_) | Primary::Broken => {
                spans_of_elements(inside(&element.primary), spans);
            }
        }
    }
}

fn spans_of_condition(condition: &Condition<'_>, spans: &mut Vec<Span>) {
    spans.push(condition.span);
    match condition.node {
        ConditionNode::Or(operands) | ConditionNode::And(operands) => {
            operands.iter().for_each(|operand| spans_of_condition(operand, spans));
        }
        ConditionNode::Not(operand) | ConditionNode::Rising(operand) => spans_of_condition(operand, spans),
        ConditionNode::Call(call) => {
            spans.push(call.name_span());
            spans.extend(call.args.iter().map(|arg| arg.span()));
        }
        ConditionNode::Comparison(compared) => spans.push(compared.left.span),
        ConditionNode::After(_) | ConditionNode::Null | ConditionNode::Broken => {}
    }
}
