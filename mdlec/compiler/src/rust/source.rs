//! Emits the texts of a plan as written, and their line numbers, as constants.

use mdle_runtime::{SourceLine, ValueWords};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::arguments::number;
use super::texts::text_list;
use crate::fsm::PlanWords;

/// Emits `const SOURCE`, which contains the texts of each bracket and of each operand, for reports.
pub(super) fn source(words: &PlanWords) -> TokenStream {
    let PlanWords { files, elements, operands } = words;
    let brackets = elements.iter().map(|bracket| row(bracket.at, bracket.first, bracket.count));
    let conditions = text_list(elements.iter().map(|bracket| &*bracket.condition));
    let rows = operands.iter().scan(0_u32, |first, operand| {
        let count = u32::try_from(operand.values.len()).unwrap_or(u32::MAX);
        let row = row(operand.at, *first, count);
        *first = first.saturating_add(count);
        Some(row)
    });
    let texts = text_list(operands.iter().map(|operand| &*operand.text));
    let written = text_list(operands.iter().map(|operand| &*operand.written));
    let values = operands.iter().flat_map(|operand| &operand.values).map(value);
    quote! {
        #[doc = " The words and lines of the plan's text."]
        const SOURCE: runtime::Source<'static> = runtime::Source {
            files: &[#(#files),*],
            brackets: &[#(#brackets),*],
            conditions: #conditions,
            operands: &[#(#rows),*],
            texts: #texts,
            written: #written,
            values: &[#(#values),*],
        };
    }
}

/// Emits `[0, 7, 1, 2]`: file, line, index of the first operand or value, and number of operands or values.
fn row(SourceLine { file, line }: SourceLine, first: u32, count: u32) -> TokenStream {
    let numbers = [u32::from(file), line, first, count].map(Literal::u32_unsuffixed);
    quote!([#(#numbers),*])
}

/// Emits the position of a value in an operand's text: `runtime::ValueWords { after: 2, unit: "cm", scale: 0.01 }`.
fn value(ValueWords { after, unit, scale }: &ValueWords<'_>) -> TokenStream {
    let (after, scale) = (Literal::u32_unsuffixed(*after), number(*scale));
    quote!(runtime::ValueWords { after: #after, unit: #unit, scale: #scale })
}
