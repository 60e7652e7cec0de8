//! Collects, for reports, the texts of a plan as written and the lines in which they begin.

use std::path::Path;

use mdle_runtime::{BracketWords, OperandWords, Printable, SourceLine, ValueWords, Words};

use super::{Element, Machine};
use crate::alphabet::{Alphabet, Unit};
use crate::diagnostic::{Sources, Span};
use crate::plan::{Compared, Condition, OperandPlace, Quark, QuarkId};
use crate::syntax::one_line;

/// The texts of the brackets and operands of a plan.
#[derive(Debug, Default)]
pub struct PlanWords {
    /// Names of the files, in order of first appearance.
    pub files: Vec<String>,
    /// Texts of each element, in the order of the elements.
    pub elements: Vec<BracketText>,
    /// The operands of all brackets, in the order of the brackets.
    pub operands: Vec<OperandText>,
}

/// The texts of a bracket; see [`BracketWords`].
#[derive(Debug)]
pub struct BracketText {
    /// Line in which the atom or the scope begins; 0 for a loop.
    pub at: SourceLine,
    /// Condition of the scope as written; empty if it has no operands that can fire.
    pub condition: String,
    /// Index of the bracket's first operand among the operands of all brackets.
    pub first: u32,
    /// Number of the bracket's operands.
    pub count: u32,
}

/// The texts of an operand; see [`OperandWords`].
#[derive(Debug)]
pub struct OperandText {
    /// Condition text of the operand, as traces show it.
    pub text: String,
    /// Text of the operand as written in the plan.
    pub written: String,
    /// Line in which the operand begins.
    pub at: SourceLine,
    /// Positions in the operand at which measured values are shown.
    pub values: Vec<ValueWords<'static>>,
}

impl Words for PlanWords {
    fn bracket(&self, bracket: u32) -> Option<BracketWords<'_>> {
        let BracketText { at, condition, first, count } = self.elements.get(bracket as usize)?;
        Some(BracketWords { at: *at, condition, first: *first, count: *count })
    }

    fn operand(&self, bracket: u32, number: u32) -> Option<OperandWords<'_>> {
        let words = self.elements.get(bracket as usize).filter(|words| number < words.count)?;
        let OperandText { text, written, at, values } = self.operands.get(words.first.checked_add(number)? as usize)?;
        Some(OperandWords { text, written, at: *at, values })
    }

    fn file(&self, at: SourceLine) -> &str {
        self.files.get(usize::from(at.file)).map_or("", String::as_str)
    }
}

/// Returns the texts of a machine's plan.
#[must_use]
pub fn words(machine: &Machine, sources: &Sources, alphabet: &Alphabet) -> PlanWords {
    let mut writing = Writing { machine, sources, alphabet, words: PlanWords::default() };
    machine.elements().for_each(|element| writing.bracket(element));
    writing.words
}

struct Writing<'a> {
    machine: &'a Machine,
    sources: &'a Sources,
    alphabet: &'a Alphabet,
    words: PlanWords,
}

impl Writing<'_> {
    /// Appends the texts of a bracket and of its operands.
    fn bracket(&mut self, element: Element<'_>) {
        let machine = self.machine;
        let at = self.line(element.interrupt().map(|_| element.span()));
        let first = number(self.words.operands.len());
        let Some(interrupt) = element.interrupt() else {
            self.words.elements.push(BracketText { at, condition: String::new(), first, count: 0 });
            return;
        };
        let parts = interrupt.condition.joined();
        // A removed interrupt has no operands, and a null interrupt has no operands that can fire.
        let operands = if parts.len() == interrupt.operands.len() { &*interrupt.operands } else { &[] };
        for (number, (part, place)) in parts.iter().zip(operands).enumerate() {
            let text = interrupt.operand_text(number, part, &|id| machine.quark(id).text.clone());
            let operand = self.operand(text, part, place);
            self.words.operands.push(operand);
        }
        let condition = match (operands, self.sources.slice(interrupt.span)) {
            ([], _) => String::new(),
            (_, "") => interrupt.text.clone(),
            (_, words) => printable(&one_line(words, []).0),
        };
        self.words.elements.push(BracketText { at, condition, first, count: number(operands.len()) });
    }

    fn operand(&mut self, text: String, part: &Condition, place: &OperandPlace) -> OperandText {
        let at = self.line(Some(place.span));
        let begins = place.span.start;
        let ends = place.signals.map(|end| end.and_then(|end| end.get().checked_sub(begins)).map(|end| end as usize));
        let (written, ends) = match self.sources.slice(place.span) {
            "" => (text.clone(), [None; 2]),
            words => one_line(words, ends),
        };
        // In formal notation, a timer is written as a time without `wait`.
        let written = if written.starts_with(|letter: char| letter.is_ascii_digit()) {
            format!("wait {written}")
        } else {
            printable(&written)
        };
        let values = ends.into_iter().zip(self.units(part)).filter_map(|(end, unit)| {
            let (after, unit) = (number(end?), unit?);
            Some(ValueWords { after, unit: unit.name, scale: unit.to_si(1.0) })
        });
        OperandText { text, written, at, values: values.collect() }
    }

    /// Returns the units of the signals that an operand compares.
    fn units(&self, part: &Condition) -> [Option<Unit>; 2] {
        let quark = match part {
            Condition::Quark(id) | Condition::Elapsed { quark: id, .. } | Condition::Driven { quark: id, .. } => {
                self.machine.quark(*id)
            }
            Condition::Not(inside) | Condition::Rising { operand: inside, .. } => return self.units(inside),
            Condition::Null | Condition::Wait { .. } | Condition::Or(_) | Condition::And(_) => return [None; 2],
            Condition::After(_) => return [None; 2],
        };
        let Some(comparison) = &quark.comparison else { return [None; 2] };
        let with = match comparison.with {
            Compared::Signal(other) => self.unit(other),
            Compared::Value(_) => None,
        };
        [self.unit(comparison.signal), with]
    }

    fn unit(&self, signal: QuarkId) -> Option<Unit> {
        let Quark { name, overload, .. } = self.machine.quark(signal);
        self.alphabet.declarations_of(name).nth(*overload)?.unit.map(|(unit, _)| unit)
    }

    /// Returns the line in which a span begins, and records the name of the span's file.
    fn line(&mut self, span: Option<Span>) -> SourceLine {
        let Some(span) = span else { return SourceLine { file: 0, line: 0 } };
        let (name, line) = self.sources.line(span);
        let name = Path::new(name).file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
        let name = printable(&name);
        let files = &mut self.words.files;
        let file = files.iter().position(|file| *file == name).unwrap_or_else(|| {
            files.push(name);
            files.len() - 1
        });
        SourceLine { file: u16::try_from(file).unwrap_or(u16::MAX), line: number(line) }
    }
}

fn printable(text: &str) -> String {
    Printable(text).to_string()
}

fn number(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}
