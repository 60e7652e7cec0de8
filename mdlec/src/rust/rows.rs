//! A plan as rows of tables, which the runtime looks up: for plans too long to be code of their own.

use std::collections::VecDeque;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::arguments::{angle, made};
use super::names::quark_type;
use super::tables::{follows, level};
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
            pub const fn new() -> Self { Self(runtime::InRows::new(&ROWS, [Nanos::ZERO; #levels], [0; #slots])) }
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
            #[inline(always)]
            fn next(
                &mut self,
                cursor: &mut Cursor<Self::Entered, Self::Left>,
                y: &Output,
                begin: Begin,
                direct: bool,
            ) -> Next {
                runtime::Plan::next(&mut self.0, cursor, y, begin, direct)
            }
            fn input(&mut self, y: &Output, t: Nanos) -> Input { runtime::Plan::input(&mut self.0, y, t) }
            fn law(&self, atom: u32) -> &str { runtime::Plan::law(&self.0, atom) }
            fn condition(&self, scope: u32) -> &str { runtime::Plan::condition(&self.0, scope) }
            fn name(&self, scope: u32) -> &str { runtime::Plan::name(&self.0, scope) }
        }

        #rows
    }
}

/// `static ROWS`: when each bracket ends, the operands of their conditions, the law of each atom.
fn rows(lowered: &Lowered) -> TokenStream {
    let mut operands = Operands { lowered, waiting: VecDeque::new(), count: 0 };
    let around = around(lowered);
    let guards: Vec<_> = (0_u32..)
        .zip(&lowered.brackets)
        .map(|(number, bracket)| {
            let condition = operands.row(condition(lowered, number));
            let level = Literal::u16_unsuffixed(level(bracket.kind));
            let around = Literal::u32_unsuffixed(around[number as usize]);
            let follows = match lowered.tables().follows(number).map(follows) {
                Some(follows) => quote!(Some(#follows)),
                None => quote!(None),
            };
            quote!(runtime::Guard { condition: runtime::Condition::#condition, level: #level, around: #around, follows: #follows })
        })
        .collect();
    let operands = operands.rows();
    let laws = lowered.laws.iter().map(|law| {
        let control = variant("AnyControl", lowered.quark(law.quark));
        let frame = angle(law.frame);
        quote!(runtime::LawRow { control: #control, frame: #frame })
    });
    quote! {
        #[doc = " What brackets and atoms mean, in the order of the tables below."]
        static ROWS: runtime::Rows<'static, robot::Alphabet> = runtime::Rows {
            fsm: FSM,
            guards: &[#(#guards),*],
            operands: &[#(runtime::Condition::#operands),*],
            laws: &[#(#laws),*],
            texts: runtime::Texts { laws: LAWS, conditions: CONDITIONS, names: NAMES },
        };
    }
}

/// The condition of a bracket.
fn condition(lowered: &Lowered, bracket: u32) -> &Condition {
    let scope = lowered.scopes[bracket as usize].as_ref();
    scope.map_or(&Condition::Null, |scope| &scope.interrupt.condition)
}

/// For each bracket the nearest one around it whose condition can fire; itself where there is none.
fn around(lowered: &Lowered) -> Vec<u32> {
    let mut around = Vec::with_capacity(lowered.brackets.len());
    for (number, bracket) in (0_u32..).zip(&lowered.brackets) {
        let parent = bracket.parent;
        around.push(if number == parent {
            number
        } else if *condition(lowered, parent) != Condition::Null {
            parent
        } else if around[parent as usize] == parent {
            number
        } else {
            around[parent as usize]
        });
    }
    around
}

/// The operands of conditions, breadth first: so they stand side by side, and behind what they belong to.
struct Operands<'l> {
    lowered: &'l Lowered,
    waiting: VecDeque<&'l Condition>,
    /// How many have been given a number.
    count: usize,
}

impl<'l> Operands<'l> {
    /// The variant of a condition, whose operands are given the next numbers.
    fn row(&mut self, condition: &'l Condition) -> TokenStream {
        let first = Literal::usize_unsuffixed(self.count);
        match condition {
            // What cannot be emitted was refused.
            Condition::Null | Condition::Rising { .. } | Condition::After(_) => quote!(Null),
            Condition::Quark(id) => {
                let interrupt = variant("AnyInterrupt", self.lowered.quark(*id));
                quote!(Quark(#interrupt))
            }
            Condition::Wait { nanos, .. } => {
                let nanos = Literal::u64_unsuffixed(*nanos);
                quote!(Wait(Nanos(#nanos)))
            }
            Condition::Elapsed { from, until, .. } => {
                let [from, until] = [*from, until.unwrap_or(u64::MAX)].map(Literal::u64_unsuffixed);
                quote!(Elapsed(Nanos(#from), Nanos(#until)))
            }
            Condition::Or(operands) | Condition::And(operands) => {
                self.waiting.extend(operands);
                self.count += operands.len();
                let count = Literal::usize_unsuffixed(operands.len());
                if matches!(condition, Condition::Or(_)) {
                    quote!(Or(#first, #count))
                } else {
                    quote!(And(#first, #count))
                }
            }
            Condition::Not(operand) => {
                self.waiting.push_back(operand);
                self.count += 1;
                quote!(Not(#first))
            }
        }
    }

    /// The rows of all that were given a number, in that order.
    fn rows(mut self) -> Vec<TokenStream> {
        let mut rows = Vec::new();
        while let Some(operand) = self.waiting.pop_front() {
            rows.push(self.row(operand));
        }
        rows
    }
}

/// `robot::AnyControl::Go(robot::Go::new(…))`: a quark as one of its alphabet's.
fn variant(any: &str, quark: &Quark) -> TokenStream {
    let any = quote::format_ident!("{any}");
    let kind = quark_type(&quark.name, quark.overload);
    let value = made(quark);
    quote!(robot::#any::#kind(#value))
}
