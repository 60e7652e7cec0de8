//! Emits the ends of scopes as inline code. Interrupts become expressions; each scope gets a function that first
//! evaluates the enclosing scope.

use mdle_runtime::Printable;
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::meaning::Meaning;
use super::tables::{follows, level};
use crate::fsm::{Element, Machine};
use crate::plan::{Condition, QuarkId};

impl Meaning<'_> {
    /// Emits a function for each scope with an interrupt: `fn shake(cursor, y, t) -> Option<runtime::Ending>`.
    pub(super) fn scope_functions(&self) -> TokenStream {
        let functions = self.machine.elements().filter_map(|element| {
            let function = self.function(element)?;
            let ending = ending(element, &quote!(Fired));
            let fired = self.condition(element).map(|fired| quote!(if #fired { return Some(#ending); }));
            let around = self.around(element).map(|function| {
                quote! {
                    if let Some(ending) = #function(cursor, y, t) { return Some(ending); }
                }
            });
            let order = if around.is_some() { ", after the interrupts of enclosing scopes" } else { "" };
            let name = if element.name().is_empty() { "A scope without a name" } else { element.name() };
            let doc = format!(" {name} ({}){order}.", Printable(element.condition_text()));
            Some(quote! {
                #[doc = #doc]
                fn #function(cursor: &At, y: &Output, t: Nanos) -> Option<runtime::Ending> { #around #fired None }
            })
        });
        quote!(#(#functions)*)
    }

    /// Returns the function of the nearest scope that encloses this element and has an interrupt; `None` if the plan is
    /// the only such scope, because the plan's interrupt has already been evaluated.
    pub(super) fn around(&self, element: Element<'_>) -> Option<&Ident> {
        let mut enclosing = element.outwards().skip(1).filter(|enclosing| enclosing.parent().is_some());
        enclosing.find_map(|enclosing| self.function(enclosing))
    }

    /// Emits an expression that is true when the interrupt of this element has fired; `None` if the interrupt never
    /// fires.
    pub(super) fn condition(&self, element: Element<'_>) -> Option<TokenStream> {
        let condition = element.condition();
        (*condition != Condition::Null).then(|| self.expression(condition, level(element)))
    }

    /// Emits an expression that is true when a condition has fired; `level` is the level of the condition's scope.
    fn expression(&self, condition: &Condition, level: u16) -> TokenStream {
        let operand = |operand: &Condition| {
            let inner = self.expression(operand, level);
            match operand {
                Condition::Or(_) | Condition::And(_) | Condition::Wait { .. } => quote!((#inner)),
                Condition::Elapsed { .. } | Condition::Driven { .. } => quote!((#inner)),
                Condition::Null | Condition::Quark(_) | Condition::Not(_) => inner,
                Condition::Rising { .. } | Condition::After(_) => inner,
            }
        };
        if let Some((QuarkId(id), nanos)) = condition.lasting() {
            let (quark, nanos) = (&self.constants[id as usize], nanoseconds(nanos));
            return quote! {
                runtime::Interrupt::fired_during(&#quark, y, cursor.stalled()) & (cursor.since(#level, t) >= #nanos)
            };
        }
        match condition {
            // `null` never fires; a plan with RISING or `after` is emitted as rows.
            Condition::Null | Condition::Rising { .. } | Condition::After(_) => quote!(false),
            Condition::Quark(QuarkId(id)) => {
                let quark = &self.constants[*id as usize];
                quote!(runtime::Interrupt::fired(&#quark, y))
            }
            Condition::Wait { nanos, .. } => {
                let nanos = nanoseconds(*nanos);
                quote!(cursor.since(#level, t) >= #nanos)
            }
            Condition::Elapsed { from, until, .. } => {
                let [from, until] = [*from, until.unwrap_or(u64::MAX)].map(nanoseconds);
                quote!((#from..#until).contains(&cursor.since(#level, t)))
            }
            Condition::Driven { from, until, .. } => {
                let [from, until] = [*from, until.unwrap_or(u64::MAX)].map(nanometers);
                quote!((#from..#until).contains(&cursor.way(#level)))
            }
            Condition::Or(operands) => operator_chain(operands.iter().map(operand).collect(), &quote!(|)),
            Condition::And(operands) => operator_chain(operands.iter().map(operand).collect(), &quote!(&)),
            Condition::Not(inner) => {
                let inner = operand(inner);
                quote!(!#inner)
            }
        }
    }
}

/// Returns `true` if a condition of the plan depends on the progress of a law.
pub(super) fn asks_for_progress(machine: &Machine) -> bool {
    machine.elements().any(|element| element.condition().lasts())
}

/// Emits the end of an element: `Cause::Fired(level).then(…)`, without `then` if the next atom depends on the counter
/// of a loop.
pub(super) fn ending(element: Element<'_>, cause: &TokenStream) -> TokenStream {
    let level = level(element);
    match element.follows().map(follows) {
        Some(follows) => quote!(runtime::Cause::#cause(#level).then(#follows)),
        None => quote!(runtime::Cause::#cause(#level).into()),
    }
}

/// Emits a time: `Nanos(500)`.
fn nanoseconds(nanos: u64) -> TokenStream {
    let nanos = Literal::u64_unsuffixed(nanos);
    quote!(Nanos(#nanos))
}

/// Emits a length: `runtime::Nanometers(500)`.
pub(super) fn nanometers(length: u64) -> TokenStream {
    let length = Literal::u64_unsuffixed(length);
    quote!(runtime::Nanometers(#length))
}

/// Emits operands joined by an operator. Many operands are divided into groups in parentheses, because Rust nests a
/// chain of operators to the left, and compilers recurse into it.
fn operator_chain(operands: Vec<TokenStream>, operator: &TokenStream) -> TokenStream {
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
        let group = operator_chain(group.to_vec(), operator);
        quote!((#group))
    });
    join(&groups.collect::<Vec<_>>())
}
