//! The coverage of a plan as a table: each element with its line, counts and operands.

use std::fmt::Write as _;

use mdle_compiler::fsm::{Element, ElementKind};
use mdle_runtime::Words as _;
use serde::Serialize;

use super::coverage::Coverage;
use super::subject::Subject;

/// The coverage of a plan.
#[derive(Debug, Serialize)]
pub(super) struct CoverageTable {
    /// File and name of the plan.
    file: String,
    plan: String,
    /// Number of atoms that began, and number of all atoms.
    atoms: [usize; 2],
    /// Number of ways to end an element that occurred, and number of all ways. An element can end by its interrupt or
    /// by completion.
    ends: [usize; 2],
    /// Number of operands that were both true and false, and number of all operands.
    operands: [usize; 2],
    elements: Vec<CoveredElement>,
}

/// The coverage of a scope or an atom.
#[derive(Debug, Serialize)]
struct CoveredElement {
    line: u32,
    /// Number of enclosing elements.
    depth: usize,
    /// Law of an atom, or name of a scope.
    name: String,
    /// Number of times that the law began, and, in `skipped`, number of times that the atom was skipped; `None` for a
    /// scope.
    #[serde(skip_serializing_if = "Option::is_none")]
    began: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    skipped: Option<u64>,
    /// Number of times that the law completed; `None` if it cannot complete.
    #[serde(skip_serializing_if = "Option::is_none")]
    completed: Option<u64>,
    /// Number of times that the interrupt ended the element; `None` if it never fires.
    #[serde(skip_serializing_if = "Option::is_none")]
    fired: Option<u64>,
    operands: Vec<CoveredOperand>,
}

/// The coverage of an operand.
#[derive(Debug, Serialize)]
struct CoveredOperand {
    operand: String,
    #[serde(rename = "true")]
    is_true: u64,
    #[serde(rename = "false")]
    is_false: u64,
}

impl CoverageTable {
    /// Returns the coverage of a plan.
    pub(super) fn new(subject: &Subject, coverage: &Coverage) -> Self {
        let machine = subject.machine();
        let elements = machine.elements().filter(|element| !matches!(element.kind(), ElementKind::Loop { .. }));
        let elements: Vec<_> = elements.map(|element| covered(subject, coverage, element)).collect();
        let seen = |counts: Vec<u64>| [counts.iter().filter(|count| **count > 0).count(), counts.len()];
        let atoms = seen(elements.iter().filter_map(|element| element.began).collect());
        let ends = elements.iter().flat_map(|element| [element.fired, element.completed]).flatten();
        let operands = elements.iter().flat_map(|element| &element.operands);
        Self {
            file: subject.file.display().to_string(),
            plan: machine.root().name().to_owned(),
            atoms,
            ends: seen(ends.collect()),
            operands: seen(operands.map(|operand| operand.is_true.min(operand.is_false)).collect()),
            elements,
        }
    }

    /// Returns the table as text; `!` marks parts that were not reached.
    pub(super) fn text(&self) -> String {
        let Self { file, plan, atoms, ends, operands, elements } = self;
        let of = |[seen, all]: &[usize; 2]| format!("{seen} of {all}");
        let mut text = format!(
            "coverage of {plan} ({file}): {} atoms, {} ends, {} operands both ways\n",
            of(atoms),
            of(ends),
            of(operands)
        );
        for element in elements {
            let counts = [
                (element.began, "began"),
                (element.skipped.filter(|skipped| *skipped > 0), "skipped"),
                (element.completed, "completed"),
                (element.fired, "interrupted"),
            ];
            let is_missed = [element.began, element.completed, element.fired].contains(&Some(0));
            let counts = counts.into_iter().filter_map(|(count, word)| count.map(|count| format!("{word} {count}")));
            let counts: Vec<_> = counts.collect();
            let indent = "  ".repeat(element.depth);
            row(&mut text, is_missed, &format!("line {}", element.line), &(indent + &element.name), &counts.join(", "));
            for CoveredOperand { operand, is_true, is_false } in &element.operands {
                let indent = "  ".repeat(element.depth + 1);
                let is_missed = *is_true == 0 || *is_false == 0;
                row(&mut text, is_missed, "", &(indent + operand), &format!("true {is_true}, false {is_false}"));
            }
        }
        text
    }
}

fn row(text: &mut String, is_missed: bool, line: &str, name: &str, counts: &str) {
    let mark = if is_missed { '!' } else { ' ' };
    let row = format!("{mark} {line:<9} {name:<40} {counts}");
    let _ = writeln!(text, "{}", row.trim_end());
}

fn covered(subject: &Subject, coverage: &Coverage, element: Element<'_>) -> CoveredElement {
    let (index, number) = (element.index(), element.number());
    let atom = element.atom();
    let of_atom = |counts: &[u64]| atom.and_then(|atom| counts.get(atom.index()).copied());
    let has_operands = coverage.operands.get(index).is_some_and(|operands| !operands.is_empty());
    let operands = (0..).zip(coverage.operands.get(index).into_iter().flatten());
    let operands = operands.filter_map(|(place, [is_false, is_true])| {
        let operand = subject.words.operand(number, place)?.written.to_owned();
        Some(CoveredOperand { operand, is_true: *is_true, is_false: *is_false })
    });
    let enclosing = element.outwards().skip(1);
    CoveredElement {
        line: subject.words.bracket(number).map_or(0, |bracket| bracket.at.line),
        depth: enclosing.filter(|element| !matches!(element.kind(), ElementKind::Loop { .. })).count(),
        name: atom.map_or_else(|| element.name().to_owned(), |atom| atom.law().text.clone()),
        began: of_atom(&coverage.began),
        skipped: of_atom(&coverage.skipped),
        completed: element.completes().then(|| coverage.completed.get(index).copied().unwrap_or(0)),
        fired: has_operands.then(|| coverage.fired.get(index).copied().unwrap_or(0)),
        operands: operands.collect(),
    }
}
