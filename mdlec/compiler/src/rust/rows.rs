//! A plan as rows of tables, which the runtime looks up: for plans too long to be code of their own.

use std::collections::VecDeque;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::arguments::{angle, compared, made};
use super::names::quark_type;
use super::scopes::nanometers;
use super::tables::{entries, follows, level};
use crate::fsm::{Element, Machine};
use crate::plan::{Condition, Quark, QuarkId};

/// The plan's type, which hands everything on to the runtime's, and its rows.
pub(super) fn machine(plan: &Ident, doc: &str, machine: &Machine, paths: Option<&TokenStream>) -> TokenStream {
    let slots = Literal::usize_unsuffixed(machine.sizes().slots);
    let (entered, begins) = entries(machine);
    let rows = rows(machine, paths);
    let (memory, new) = memory(machine, &begins);
    let told = told(machine);
    let replayed = paths.map(|_| {
        quote!(
            fn paths(&self) -> &[&'static str] {
                runtime::Plan::paths(&self.0)
            }
        )
    });
    quote! {
        #[doc = #doc]
        pub struct #plan(runtime::InRows<&'static runtime::Rows<'static, robot::Alphabet>, #entered, [u64; #slots] #memory>);

        impl #plan {
            #[doc = " The plan before it begins."]
            #[must_use]
            pub const fn new() -> Self { Self(#new) }
        }

        impl Default for #plan {
            fn default() -> Self { Self::new() }
        }

        impl runtime::Plan for #plan {
            type Output = Output;
            type Input = Input;
            type Entered = #entered;
            type Left = [u64; #slots];

            fn fsm(&self) -> Fsm<'_> { runtime::Plan::fsm(&self.0) }
            fn slots(&self) -> (Self::Entered, Self::Left) { runtime::Plan::slots(&self.0) }
            #[inline(always)]
            fn enter(&mut self, atom: u32, y: &Output, begin: Begin) { runtime::Plan::enter(&mut self.0, atom, y, begin); }
            #[inline(always)]
            fn next(
                &self,
                cursor: &Cursor<Self::Entered, Self::Left>,
                y: &Output,
                t: Nanos,
            ) -> Option<runtime::Ending> {
                runtime::Plan::next(&self.0, cursor, y, t)
            }
            #told
            #[inline(always)]
            fn input(&mut self, y: &Output, t: Nanos) -> Input { runtime::Plan::input(&mut self.0, y, t) }
            fn operands(
                &self,
                cursor: &Cursor<Self::Entered, Self::Left>,
                scope: u32,
                y: &Output,
                t: Nanos,
                tell: &mut dyn FnMut(u32, runtime::Measured),
            ) {
                runtime::Plan::operands(&self.0, cursor, scope, y, t, tell);
            }
            fn source(&self) -> &dyn runtime::Words { runtime::Plan::source(&self.0) }
            fn law(&self, atom: u32) -> &str { runtime::Plan::law(&self.0, atom) }
            fn condition(&self, scope: u32) -> &str { runtime::Plan::condition(&self.0, scope) }
            fn name(&self, scope: u32) -> &str { runtime::Plan::name(&self.0, scope) }
            #replayed
        }

        #rows
    }
}

/// Returns the functions by which the machine informs a plan with memories; `None` for a plan without memories.
fn told(machine: &Machine) -> Option<TokenStream> {
    (machine.sizes().memories > 0).then(|| {
        quote! {
            fn leave(
                &mut self,
                cursor: &Cursor<Self::Entered, Self::Left>,
                cause: runtime::Cause,
                y: &Output,
                t: Nanos,
            ) {
                runtime::Plan::leave(&mut self.0, cursor, cause, y, t);
            }
            fn settle(&mut self, cursor: &Cursor<Self::Entered, Self::Left>, y: &Output, t: Nanos) {
                runtime::Plan::settle(&mut self.0, cursor, y, t);
            }
        }
    })
}

/// The type of the plan's memory, none for a plan that remembers nothing, and how the plan is made.
fn memory(machine: &Machine, begins: &TokenStream) -> (Option<TokenStream>, TokenStream) {
    let slots = Literal::usize_unsuffixed(machine.sizes().slots);
    let slots = quote!(#begins, [0; #slots]);
    if machine.sizes().memories == 0 {
        return (None, quote!(runtime::InRows::new(&ROWS, #slots)));
    }
    let size = Literal::usize_unsuffixed(machine.depth() * machine.sizes().memories);
    let width = Literal::usize_unsuffixed(machine.sizes().memories);
    let new = quote!(runtime::InRows::remembering(&ROWS, #slots, runtime::Memories::new(#width, [false; #size])));
    (Some(quote!(, runtime::Memories<[bool; #size]>)), new)
}

/// Returns the labels of what ends with a bracket, and their facts.
fn marks(machine: &Machine) -> (Vec<TokenStream>, Vec<TokenStream>) {
    let (mut rows, mut all) = (Vec::new(), Vec::new());
    for element in machine.elements() {
        for mark in element.marks() {
            let Some(record) = machine.record(mark.record) else { continue };
            let facts = mark.facts.iter().map(|fact| {
                let memory = Literal::u32_unsuffixed(record.first.saturating_add(fact.number));
                let operand = match fact.operand.map(Literal::u32_unsuffixed) {
                    Some(operand) => quote!(Some(#operand)),
                    None => quote!(None),
                };
                quote!(runtime::Fact { memory: #memory, operand: #operand })
            });
            let [bracket, first, count] = [element.number(), record.first, record.facts].map(Literal::u32_unsuffixed);
            let level = Literal::u16_unsuffixed(record.level);
            let [first_fact, facts_of_mark] = [all.len(), mark.facts.len()].map(Literal::usize_unsuffixed);
            all.extend(facts);
            rows.push(quote! {
                runtime::MarkRow {
                    bracket: #bracket, level: #level, first: #first, count: #count,
                    first_fact: #first_fact, facts: #facts_of_mark,
                }
            });
        }
    }
    (rows, all)
}

/// `static ROWS`: when each bracket ends, the operands of their conditions, the law of each atom.
fn rows(machine: &Machine, paths: Option<&TokenStream>) -> TokenStream {
    let (marks, facts) = marks(machine);
    let mut operands = Operands::new(machine);
    let guards: Vec<_> = machine
        .elements()
        .map(|element| {
            let condition = operands.row(element.condition());
            let level = Literal::u16_unsuffixed(level(element));
            let around = Literal::u32_unsuffixed(around(element).number());
            let follows = match element.follows().map(follows) {
                Some(follows) => quote!(Some(#follows)),
                None => quote!(None),
            };
            quote!(runtime::Guard { condition: runtime::Condition::#condition, level: #level, around: #around, follows: #follows })
        })
        .collect();
    let operands = operands.rows();
    let laws = machine.atoms().map(|atom| {
        let control = variant("AnyControl", atom.law(), machine.quarks());
        let frame = angle(atom.turned());
        quote!(runtime::LawRow { control: #control, frame: #frame })
    });
    quote! {
        #[doc = " What brackets and atoms mean, in the order of the tables below."]
        static ROWS: runtime::Rows<'static, robot::Alphabet> = runtime::Rows {
            fsm: FSM,
            guards: &[#(#guards),*],
            operands: &[#(runtime::Condition::#operands),*],
            laws: &[#(#laws),*],
            marks: &[#(#marks),*],
            facts: &[#(#facts),*],
            texts: runtime::Texts {
                laws: LAWS, conditions: CONDITIONS, names: NAMES, source: SOURCE, paths: &[#paths],
            },
        };
    }
}

/// `static OPERANDS`: the conditions of a plan that is code, for reports of the ones that fired.
pub(super) fn conditions(machine: &Machine) -> TokenStream {
    let mut operands = Operands::new(machine);
    let conditions: Vec<_> = machine.elements().map(|element| operands.row(element.condition())).collect();
    let operands = operands.rows();
    quote! {
        #[doc = " The conditions of brackets once more, read when somebody asks what has fired."]
        static OPERANDS: runtime::Conditions<'static, robot::AnyInterrupt> = runtime::Conditions {
            conditions: &[#(runtime::Condition::#conditions),*],
            operands: &[#(runtime::Condition::#operands),*],
        };
    }
}

/// Returns the nearest enclosing element whose condition can fire; the element itself where there is none.
fn around(element: Element<'_>) -> Element<'_> {
    let can_fire = |enclosing: &Element<'_>| *enclosing.condition() != Condition::Null;
    element.outwards().skip(1).find(can_fire).unwrap_or(element)
}

/// The operands of conditions, breadth first: so the operands of one condition are consecutive, and after the
/// condition.
struct Operands<'l> {
    machine: &'l Machine,
    waiting: VecDeque<&'l Condition>,
    /// Number of conditions that have been given a number.
    count: usize,
}

impl<'l> Operands<'l> {
    fn new(machine: &'l Machine) -> Self {
        Self { machine, waiting: VecDeque::new(), count: 0 }
    }

    /// Returns the variant of a condition, and gives its operands the next numbers.
    fn row(&mut self, condition: &'l Condition) -> TokenStream {
        let first = Literal::usize_unsuffixed(self.count);
        match condition {
            Condition::Null => quote!(Null),
            Condition::Rising { memory, operand } => {
                self.waiting.push_back(operand);
                self.count += 1;
                let memory = Literal::u32_unsuffixed(*memory);
                quote!(Rising(#memory, #first))
            }
            Condition::After(after) => match self.machine.record(after.record) {
                Some(record) => {
                    let level = Literal::u16_unsuffixed(record.level);
                    let memory = Literal::u32_unsuffixed(record.first.saturating_add(after.fact));
                    quote!(After(#level, #memory))
                }
                None => quote!(Null),
            },
            Condition::Quark(id) => {
                let interrupt = interrupt(*id, self.machine.quarks());
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
            Condition::Driven { from, until, .. } => {
                let [from, until] = [*from, until.unwrap_or(u64::MAX)].map(nanometers);
                quote!(Driven(#from, #until))
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

/// An interrupt as one of its alphabet's.
fn interrupt(id: QuarkId, quarks: &[Quark]) -> TokenStream {
    let quark = &quarks[id.0 as usize];
    let Some(comparison) = &quark.comparison else { return variant("AnyInterrupt", quark, quarks) };
    let comparison = compared(comparison, &quote!(robot::AnySignal), |signal| {
        variant("AnySignal", &quarks[signal.0 as usize], quarks)
    });
    quote!(robot::AnyInterrupt::Comparison(#comparison))
}

/// `robot::AnyControl::Go(robot::Go::new(…))`: a quark as one of its alphabet's.
fn variant(any: &str, quark: &Quark, quarks: &[Quark]) -> TokenStream {
    let any = quote::format_ident!("{any}");
    let kind = quark_type(&quark.name, quark.overload);
    let value = made(quark, quarks);
    quote!(robot::#any::#kind(#value))
}
