//! Emits functions that create the quarks in a plan's rows. rustc compiles the call of such a function in half the time
//! that it needs for the constructors of a quark and of the enclosing types.

use std::collections::BTreeSet;

use mdle_runtime::Condition;
use proc_macro2::TokenStream;
use quote::quote;

use super::arguments::arguments;
use super::bound::Bound;
use super::names::quark_type;
use super::signatures::argument_type;
use crate::alphabet::{Alphabet, DeclarationKind};
use crate::fsm::{Machine, Rows};
use crate::plan::Quark;

/// The quarks that a plan's rows use, each with the generated function that constructs it.
pub(super) struct QuarkFunctions<'a>(Vec<Bound<'a>>);

impl<'a> QuarkFunctions<'a> {
    /// Chooses a function name for each quark that is a condition, an operand or a law by itself.
    pub(super) fn new(machine: &Machine, rows: &Rows, alphabet: &'a Alphabet) -> Self {
        let conditions = rows.guards.iter().map(|guard| &guard.condition).chain(&rows.operands);
        let interrupts = conditions.filter_map(|condition| match condition {
            Condition::Quark(id) => Some(*id),
            Condition::Null | Condition::Wait(_) | Condition::Lasting(..) | Condition::Elapsed(..) => None,
            Condition::Driven(..) | Condition::Or(..) | Condition::And(..) | Condition::Not(_) => None,
            Condition::Rising(..) | Condition::After(..) => None,
        });
        let quarks = interrupts.chain(rows.laws.iter().map(|law| law.control)).map(|id| machine.quark(id));
        let kinds: BTreeSet<_> = quarks.map(|quark| quark_type(&quark.name, quark.overload)).collect();
        Self(Bound::all(alphabet).into_iter().filter(|bound| kinds.contains(&bound.kind)).collect())
    }

    /// Emits the functions: `const fn go(speed: …, rate: …) -> robot::AnyControl`.
    pub(super) fn items(&self) -> TokenStream {
        let functions = self.0.iter().map(|bound| {
            let (kind, function, doc) = (&bound.kind, &bound.function, bound.doc());
            let (names, kinds): (Vec<_>, Vec<_>) = bound.parameters().unzip();
            let types = kinds.into_iter().map(argument_type);
            let quark = quote!(robot::#kind::new(#(#names),*));
            let (result, value) = match bound.declaration.kind {
                DeclarationKind::Control => (quote!(robot::AnyControl), quote!(robot::AnyControl::#kind(#quark))),
                DeclarationKind::Interrupt | DeclarationKind::Signal => (
                    quote!(runtime::Condition<robot::AnyInterrupt>),
                    quote!(runtime::Condition::Quark(robot::AnyInterrupt::#kind(#quark))),
                ),
            };
            quote! {
                #[doc = #doc]
                const fn #function(#(#names: #types),*) -> #result { #value }
            }
        });
        quote!(#(#functions)*)
    }

    /// Emits the call that creates a quark: `go(runtime::MetersPerSecond(0.2), …)`; `None` for a comparison, and for a
    /// quark without a function.
    pub(super) fn call(&self, quark: &Quark) -> Option<TokenStream> {
        if quark.comparison.is_some() {
            return None;
        }
        let kind = quark_type(&quark.name, quark.overload);
        let function = &self.0.iter().find(|bound| bound.kind == kind)?.function;
        let arguments = arguments(quark);
        Some(quote!(#function(#(#arguments),*)))
    }
}
