//! A plan as rows of tables, which the runtime looks up: for plans too long to be code of their own.

use std::collections::VecDeque;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::arguments::{angle, made};
use super::names::quark_type;
use crate::fsm::Lowered;
use crate::plan::{Condition, Quark};

/// The plan's type, which hands everything on to the runtime's, and its rows.
pub(super) fn machine(plan: &Ident, doc: &str, lowered: &Lowered) -> TokenStream {
    let [levels, slots] = [lowered.levels, lowered.slots].map(Literal::usize_unsuffixed);
    let rows = rows(lowered);
    quote! {
        #[doc = #doc]
        pub struct #plan(runtime::InRows<'static, robot::Alphabet, [Nanos; #levels], [u64; #slots]>);

        impl #plan {
            #[doc = " The plan before it begins."]
            #[must_use]
            pub const fn new() -> Self { Self(runtime::InRows::new(ROWS, [Nanos::ZERO; #levels], [0; #slots])) }
        }

        impl Default for #plan {
            fn default() -> Self { Self::new() }
        }

        impl runtime::Plan for #plan {
            type Output = Output;
            type Input = Input;
            type Entered = [Nanos; #levels];
            type Left = [u64; #slots];

            fn fsm(&self) -> Fsm<'_> { runtime::Plan::fsm(&self.0) }
            fn slots(&self) -> (Self::Entered, Self::Left) { runtime::Plan::slots(&self.0) }
            fn enter(&mut self, atom: u32, y: &Output, begin: Begin) { runtime::Plan::enter(&mut self.0, atom, y, begin); }
            fn fired(&self, cursor: &Cursor<Self::Entered, Self::Left>, y: &Output, t: Nanos) -> Option<Cause> {
                runtime::Plan::fired(&self.0, cursor, y, t)
            }
            fn input(&mut self, y: &Output, t: Nanos) -> Input { runtime::Plan::input(&mut self.0, y, t) }
            fn law(&self, atom: u32) -> &str { runtime::Plan::law(&self.0, atom) }
            fn condition(&self, scope: u32) -> &str { runtime::Plan::condition(&self.0, scope) }
            fn name(&self, scope: u32) -> &str { runtime::Plan::name(&self.0, scope) }
        }

        #rows
    }
}

/// `const ROWS`: the condition of each bracket and behind them their operands, the law of each atom.
fn rows(lowered: &Lowered) -> TokenStream {
    let conditions = conditions(lowered);
    let laws = lowered.laws.iter().map(|law| {
        let control = variant("AnyControl", lowered.quark(law.quark));
        let frame = angle(law.frame);
        quote!(runtime::LawRow { control: #control, frame: #frame })
    });
    quote! {
        #[doc = " What brackets and atoms mean, in the order of the tables below; operands of conditions stand behind them."]
        const ROWS: runtime::Rows<'static, robot::Alphabet> = runtime::Rows {
            fsm: FSM,
            conditions: &[#(runtime::Condition::#conditions),*],
            laws: &[#(#laws),*],
            texts: runtime::Texts { laws: LAWS, conditions: CONDITIONS, names: NAMES },
        };
    }
}

/// The variants of the conditions: breadth first, so that operands stand side by side and behind what they belong to.
fn conditions(lowered: &Lowered) -> Vec<TokenStream> {
    let scopes = lowered.scopes.iter().map(Option::as_ref);
    let mut waiting: VecDeque<_> =
        scopes.map(|scope| scope.map_or(&Condition::Null, |scope| &scope.interrupt.condition)).collect();
    let mut rows = Vec::with_capacity(waiting.len());
    while let Some(condition) = waiting.pop_front() {
        // Behind this row those that wait, and behind those its own operands.
        let first = Literal::usize_unsuffixed(rows.len() + 1 + waiting.len());
        rows.push(match condition {
            Condition::Null => quote!(Null),
            Condition::Quark(id) => {
                let interrupt = variant("AnyInterrupt", lowered.quark(*id));
                quote!(Quark(#interrupt))
            }
            Condition::Wait { nanos, .. } => {
                let nanos = Literal::u64_unsuffixed(*nanos);
                quote!(Wait(Nanos(#nanos)))
            }
            Condition::Or(operands) | Condition::And(operands) => {
                waiting.extend(operands);
                let count = Literal::usize_unsuffixed(operands.len());
                if matches!(condition, Condition::Or(_)) {
                    quote!(Or(#first, #count))
                } else {
                    quote!(And(#first, #count))
                }
            }
            Condition::Not(operand) => {
                waiting.push_back(operand);
                quote!(Not(#first))
            }
        });
    }
    rows
}

/// `robot::AnyControl::Go(robot::Go::new(…))`: a quark as one of its alphabet's.
fn variant(any: &str, quark: &Quark) -> TokenStream {
    let any = quote::format_ident!("{any}");
    let kind = quark_type(&quark.name, quark.overload);
    let value = made(quark);
    quote!(robot::#any::#kind(#value))
}
