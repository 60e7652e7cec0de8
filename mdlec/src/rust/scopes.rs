//! When scopes end, as code: interrupts as expressions, and a function for each scope that asks the one around it first.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::code::Meaning;
use super::tables::{follows, level};
use crate::plan::{Condition, QuarkId};

impl Meaning<'_> {
    /// For each scope with an interrupt: `fn shake(cursor, y, t) -> Option<runtime::Ending>`.
    pub(super) fn scope_functions(&self) -> TokenStream {
        let functions = self.functions.iter().zip(0_u32..).filter_map(|(function, bracket)| {
            let function = function.as_ref()?;
            let scope = self.lowered.scopes[bracket as usize].as_ref()?;
            let ending = self.ending(bracket, "Fired");
            let fired = self.condition(bracket).map(|fired| quote!(if #fired { return Some(#ending); }));
            let around = self.around(bracket).map(|function| {
                quote! {
                    if let Some(ending) = #function(cursor, y, t) { return Some(ending); }
                }
            });
            let doc = format!(" {} ({}), and the scopes around it first.", scope.name, scope.interrupt.text);
            Some(quote! {
                #[doc = #doc]
                fn #function(cursor: &At, y: &Output, t: Nanos) -> Option<runtime::Ending> { #around #fired None }
            })
        });
        quote!(#(#functions)*)
    }

    /// The function of the nearest scope around this bracket that has an interrupt.
    pub(super) fn around(&self, bracket: u32) -> Option<&Ident> {
        let mut here = bracket;
        while here != 0 {
            here = self.lowered.brackets[here as usize].parent;
            if let Some(function) = &self.functions[here as usize] {
                return Some(function);
            }
        }
        None
    }

    /// `Cause::Fired(level).then(…)`, or without what follows where that depends on a loop's count.
    pub(super) fn ending(&self, bracket: u32, cause: &str) -> TokenStream {
        let (cause, level) = (format_ident!("{cause}"), self.level(bracket));
        match self.lowered.tables().follows(bracket).map(follows) {
            Some(follows) => quote!(runtime::Cause::#cause(#level).then(#follows)),
            None => quote!(runtime::Cause::#cause(#level).into()),
        }
    }

    fn level(&self, bracket: u32) -> u16 {
        level(self.lowered.brackets[bracket as usize].kind)
    }

    /// Whether the interrupt of this scope has fired; `None` where it never does.
    pub(super) fn condition(&self, bracket: u32) -> Option<TokenStream> {
        let scope = self.lowered.scopes[bracket as usize].as_ref()?;
        let condition = &scope.interrupt.condition;
        (*condition != Condition::Null).then(|| self.expression(condition, self.level(bracket)))
    }

    fn expression(&self, condition: &Condition, level: u16) -> TokenStream {
        let operand = |operand: &Condition| {
            let inner = self.expression(operand, level);
            match operand {
                Condition::Or(_) | Condition::And(_) | Condition::Wait { .. } => quote!((#inner)),
                Condition::Null | Condition::Quark(_) | Condition::Not(_) => inner,
            }
        };
        match condition {
            Condition::Null => quote!(false),
            Condition::Quark(QuarkId(id)) => {
                let constant = &self.constants[*id as usize];
                quote!(runtime::Interrupt::fired(&#constant, y))
            }
            Condition::Wait { nanos, .. } => {
                let nanos = Literal::u64_unsuffixed(*nanos);
                quote!(cursor.since(#level, t) >= Nanos(#nanos))
            }
            Condition::Or(operands) => joined(operands.iter().map(operand).collect(), &quote!(|)),
            Condition::And(operands) => joined(operands.iter().map(operand).collect(), &quote!(&)),
            Condition::Not(inner) => {
                let inner = operand(inner);
                quote!(!#inner)
            }
        }
    }
}

/// Operands with an operator between them, in groups where there are many: Rust's syntax nests operators to the left, and
/// compilers follow it down.
fn joined(operands: Vec<TokenStream>, operator: &TokenStream) -> TokenStream {
    const GROUP: usize = 64;
    let join = |operands: &[TokenStream]| {
        let (first, others) = operands.split_first().map_or((None, operands), |(first, others)| (Some(first), others));
        quote!(#first #(#operator #others)*)
    };
    if operands.len() <= GROUP {
        return join(&operands);
    }
    let size = operands.len().div_ceil(GROUP).max(GROUP);
    let groups = operands.chunks(size).map(|group| {
        let group = joined(group.to_vec(), operator);
        quote!((#group))
    });
    join(&groups.collect::<Vec<_>>())
}
