//! The words of a plan as its writer has them, and their lines, as constants.

use mdle_runtime::{SourceLine, ValueWords};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::arguments::number;
use crate::fsm::{BracketText, OperandText, PlanWords};

/// Emits `const SOURCE`: the texts of each bracket and of each operand, for reports.
pub(super) fn source(words: &PlanWords) -> TokenStream {
    let PlanWords { files, elements, operands } = words;
    let brackets = elements.iter().map(bracket);
    let operands = operands.iter().map(operand);
    quote! {
        #[doc = " The words and lines of the plan's text."]
        const SOURCE: runtime::Source<'static> = runtime::Source {
            files: &[#(#files),*],
            brackets: &[#(#brackets),*],
            operands: &[#(#operands),*],
        };
    }
}

/// Emits `runtime::BracketWords { at: …, condition: "bumper OR wait 10min", first: 0, count: 2 }`.
fn bracket(BracketText { at, condition, first, count }: &BracketText) -> TokenStream {
    let at = line(*at);
    let [first, count] = [*first, *count].map(Literal::u32_unsuffixed);
    quote!(runtime::BracketWords { at: #at, condition: #condition, first: #first, count: #count })
}

/// Emits `runtime::OperandWords { text: "r1 < 0.4", written: "r1 < 40cm", at: …, values: &[…] }`.
fn operand(OperandText { text, written, at, values }: &OperandText) -> TokenStream {
    let at = line(*at);
    let values = values.iter().map(|ValueWords { after, unit, scale }| {
        let (after, scale) = (Literal::u32_unsuffixed(*after), number(*scale));
        quote!(runtime::ValueWords { after: #after, unit: #unit, scale: #scale })
    });
    quote!(runtime::OperandWords { text: #text, written: #written, at: #at, values: &[#(#values),*] })
}

/// Emits `runtime::SourceLine { file: 0, line: 7 }`.
fn line(SourceLine { file, line }: SourceLine) -> TokenStream {
    let (file, line) = (Literal::u16_unsuffixed(file), Literal::u32_unsuffixed(line));
    quote!(runtime::SourceLine { file: #file, line: #line })
}
