//! The words of a plan as its writer has them, and their lines, for reports.

use std::path::Path;

use mdle_runtime::Printable;
use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::arguments::number;
use crate::alphabet::{Alphabet, Unit};
use crate::diagnostic::{Sources, Span};
use crate::fsm::{Element, Machine};
use crate::plan::{Compared, Condition, OperandPlace, Quark, QuarkId};
use crate::syntax::one_line;

/// `const SOURCE`: the words of each bracket, and those of each operand.
pub(super) fn source(machine: &Machine, sources: &Sources, alphabet: &Alphabet) -> TokenStream {
    let mut writing = Writing { machine, sources, alphabet, files: Vec::new(), operands: Vec::new() };
    let brackets: Vec<_> = machine.elements().map(|element| writing.bracket(element)).collect();
    let Writing { files, operands, .. } = writing;
    quote! {
        #[doc = " The words and lines of the plan's text."]
        const SOURCE: runtime::Source<'static> = runtime::Source {
            files: &[#(#files),*],
            brackets: &[#(#brackets),*],
            operands: &[#(#operands),*],
        };
    }
}

struct Writing<'a> {
    machine: &'a Machine,
    sources: &'a Sources,
    alphabet: &'a Alphabet,
    /// The names of the files, in the order in which they are met.
    files: Vec<String>,
    operands: Vec<TokenStream>,
}

impl Writing<'_> {
    /// `runtime::BracketWords { at: …, condition: "bumper OR wait 10min", first: 0, count: 2 }`.
    fn bracket(&mut self, element: Element<'_>) -> TokenStream {
        let machine = self.machine;
        let at = self.line(element.interrupt().map(|_| element.span()));
        let first = Literal::usize_unsuffixed(self.operands.len());
        let Some(interrupt) = element.interrupt() else {
            return quote!(runtime::BracketWords { at: #at, condition: "", first: #first, count: 0 });
        };
        let parts = interrupt.condition.joined();
        // What was removed has no operands, and what is null has none that can fire.
        let operands = if parts.len() == interrupt.operands.len() { &*interrupt.operands } else { &[] };
        let count = Literal::usize_unsuffixed(operands.len());
        for (number, (part, place)) in parts.iter().zip(operands).enumerate() {
            let text = interrupt.operand_text(number, part, &|id| machine.quark(id).text.clone());
            let operand = self.operand(text, part, place);
            self.operands.push(operand);
        }
        let condition = match (operands, self.sources.slice(interrupt.span)) {
            ([], _) => String::new(),
            (_, "") => interrupt.text.clone(),
            (_, words) => printable(&one_line(words, []).0),
        };
        quote!(runtime::BracketWords { at: #at, condition: #condition, first: #first, count: #count })
    }

    /// `runtime::OperandWords { text: "r1 < 0.4", written: "r1 < 40cm", at: …, values: &[…] }`.
    fn operand(&mut self, text: String, part: &Condition, place: &OperandPlace) -> TokenStream {
        let at = self.line(Some(place.span));
        let begins = place.span.start;
        let ends = place.signals.map(|end| end.and_then(|end| end.get().checked_sub(begins)).map(|end| end as usize));
        let (written, ends) = match self.sources.slice(place.span) {
            "" => (text.clone(), [None; 2]),
            words => one_line(words, ends),
        };
        // The timer of formal notation is a time alone.
        let written = if written.starts_with(|letter: char| letter.is_ascii_digit()) {
            format!("wait {written}")
        } else {
            printable(&written)
        };
        let units = self.units(part);
        let values = ends.into_iter().zip(units).filter_map(|(end, unit)| {
            let after = Literal::usize_unsuffixed(end?);
            let unit = unit?;
            let (name, scale) = (unit.name, number(unit.to_si(1.0)));
            Some(quote!(runtime::ValueWords { after: #after, unit: #name, scale: #scale }))
        });
        quote!(runtime::OperandWords { text: #text, written: #written, at: #at, values: &[#(#values),*] })
    }

    /// The units of the signals that an operand compares.
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

    /// `runtime::SourceLine { file: 0, line: 7 }`.
    fn line(&mut self, span: Option<Span>) -> TokenStream {
        let Some(span) = span else { return quote!(runtime::SourceLine { file: 0, line: 0 }) };
        let (name, line) = self.sources.line(span);
        let name = Path::new(name).file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
        let name = printable(&name);
        let known = self.files.iter().position(|file| *file == name);
        let file = Literal::usize_unsuffixed(known.unwrap_or(self.files.len()));
        if known.is_none() {
            self.files.push(name);
        }
        let line = Literal::usize_unsuffixed(line);
        quote!(runtime::SourceLine { file: #file, line: #line })
    }
}

fn printable(text: &str) -> String {
    Printable(text).to_string()
}
