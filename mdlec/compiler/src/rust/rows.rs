//! A plan as rows of tables, which the runtime looks up: for plans too long to be code of their own.

use mdle_runtime::{Condition, Fact, Guard, LawRow, MarkRow, Nanos};
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::arguments::{angle, compared, quark_value};
use super::names::quark_type;
use super::scopes::{asks_for_progress, nanometers};
use super::tables::{entries, follows};
use crate::fsm::{self, Machine, Rows};
use crate::plan::{Quark, QuarkId};

/// Emits the plan's type, which delegates to the runtime's type, and its rows.
pub(super) fn machine(plan: &Ident, doc: &str, machine: &Machine, paths: Option<&TokenStream>) -> TokenStream {
    let slots = Literal::usize_unsuffixed(machine.sizes().slots);
    let (entered, begins) = entries(machine);
    let rows = rows(machine, paths);
    let (memory, new) = memory(machine, &begins);
    let (memory_updates, stalled) = (memory_updates(machine), stalled(machine));
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
            #stalled
            #memory_updates
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

/// Returns the function by which the law of a plan with `stuck` reports its progress.
fn stalled(machine: &Machine) -> Option<TokenStream> {
    asks_for_progress(machine).then(|| {
        quote! {
            #[inline(always)]
            fn stalled(&self, y: &Output, t: Nanos) -> Option<Nanos> { runtime::Plan::stalled(&self.0, y, t) }
        }
    })
}

/// Returns the functions by which the machine informs a plan with memories; `None` for a plan without memories.
fn memory_updates(machine: &Machine) -> Option<TokenStream> {
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

/// Emits the type of the plan's memory, if the plan remembers anything, and the expression that creates the plan.
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

/// Emits `static ROWS`: the condition of each bracket with its operands, and the law of each atom.
fn rows(machine: &Machine, paths: Option<&TokenStream>) -> TokenStream {
    let Rows { guards, operands, laws, marks, facts } = fsm::rows(machine);
    let guards = guards.iter().map(|Guard { condition, level, around, follows: after }| {
        let condition = row(condition, machine);
        let (level, around) = (Literal::u16_unsuffixed(*level), Literal::u32_unsuffixed(*around));
        let follows = match after.map(follows) {
            Some(follows) => quote!(Some(#follows)),
            None => quote!(None),
        };
        quote!(runtime::Guard { condition: #condition, level: #level, around: #around, follows: #follows })
    });
    let operands = operands.iter().map(|operand| row(operand, machine));
    let laws = laws.iter().map(|LawRow { control, frame }| {
        let control = variant("AnyControl", machine.quark(*control), machine.quarks());
        let frame = angle(frame.0);
        quote!(runtime::LawRow { control: #control, frame: #frame })
    });
    let (marks, facts) = (marks.iter().map(mark), facts.iter().map(fact));
    quote! {
        #[doc = " The conditions of brackets and the laws of atoms, in the order of the tables below."]
        static ROWS: runtime::Rows<'static, robot::Alphabet> = runtime::Rows {
            fsm: FSM,
            guards: &[#(#guards),*],
            operands: &[#(#operands),*],
            laws: &[#(#laws),*],
            marks: &[#(#marks),*],
            facts: &[#(#facts),*],
            texts: runtime::Texts {
                laws: LAWS, conditions: CONDITIONS, names: NAMES, source: SOURCE, paths: &[#paths],
            },
        };
    }
}

/// Emits `static OPERANDS`: the conditions of a plan that is emitted as code, for reports of the operands that have
/// fired.
pub(super) fn conditions(machine: &Machine) -> TokenStream {
    let rows = fsm::rows(machine);
    let conditions = rows.guards.iter().map(|guard| row(&guard.condition, machine));
    let operands = rows.operands.iter().map(|operand| row(operand, machine));
    quote! {
        #[doc = " The conditions of brackets as rows, for reports of the operands that have fired."]
        static OPERANDS: runtime::Conditions<'static, robot::AnyInterrupt> = runtime::Conditions {
            conditions: &[#(#conditions),*],
            operands: &[#(#operands),*],
        };
    }
}

/// Emits `runtime::MarkRow { … }`.
fn mark(mark: &MarkRow) -> TokenStream {
    let MarkRow { bracket, level, first, count, first_fact, facts } = mark;
    let level = Literal::u16_unsuffixed(*level);
    let [bracket, first, count, first_fact, facts] =
        [bracket, first, count, first_fact, facts].map(|number| Literal::u32_unsuffixed(*number));
    quote! {
        runtime::MarkRow {
            bracket: #bracket, level: #level, first: #first, count: #count, first_fact: #first_fact, facts: #facts,
        }
    }
}

/// Emits `runtime::Fact { memory: 0, operand: Some(1) }`.
fn fact(Fact { memory, operand }: &Fact) -> TokenStream {
    let memory = Literal::u32_unsuffixed(*memory);
    let operand = match operand.map(Literal::u32_unsuffixed) {
        Some(operand) => quote!(Some(#operand)),
        None => quote!(None),
    };
    quote!(runtime::Fact { memory: #memory, operand: #operand })
}

/// Emits a condition or an operand: `runtime::Condition::Or(0, 2)`.
fn row(condition: &Condition<QuarkId>, machine: &Machine) -> TokenStream {
    let variant = match condition {
        Condition::Null => quote!(Null),
        Condition::Quark(id) => {
            let interrupt = interrupt(*id, machine.quarks());
            quote!(Quark(#interrupt))
        }
        Condition::Lasting(id, Nanos(nanos)) => {
            let (interrupt, nanos) = (interrupt(*id, machine.quarks()), Literal::u64_unsuffixed(*nanos));
            quote!(Lasting(#interrupt, Nanos(#nanos)))
        }
        Condition::Wait(Nanos(nanos)) => {
            let nanos = Literal::u64_unsuffixed(*nanos);
            quote!(Wait(Nanos(#nanos)))
        }
        Condition::Elapsed(Nanos(from), Nanos(until)) => {
            let [from, until] = [*from, *until].map(Literal::u64_unsuffixed);
            quote!(Elapsed(Nanos(#from), Nanos(#until)))
        }
        Condition::Driven(from, until) => {
            let [from, until] = [from.0, until.0].map(nanometers);
            quote!(Driven(#from, #until))
        }
        Condition::Or(first, count) => {
            let [first, count] = [*first, *count].map(Literal::u32_unsuffixed);
            quote!(Or(#first, #count))
        }
        Condition::And(first, count) => {
            let [first, count] = [*first, *count].map(Literal::u32_unsuffixed);
            quote!(And(#first, #count))
        }
        Condition::Not(number) => {
            let number = Literal::u32_unsuffixed(*number);
            quote!(Not(#number))
        }
        Condition::Rising(memory, number) => {
            let [memory, number] = [*memory, *number].map(Literal::u32_unsuffixed);
            quote!(Rising(#memory, #number))
        }
        Condition::After(level, memory) => {
            let (level, memory) = (Literal::u16_unsuffixed(*level), Literal::u32_unsuffixed(*memory));
            quote!(After(#level, #memory))
        }
    };
    quote!(runtime::Condition::#variant)
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

/// Emits a quark as a variant of its alphabet's enum: `robot::AnyControl::Go(robot::Go::new(…))`.
fn variant(any: &str, quark: &Quark, quarks: &[Quark]) -> TokenStream {
    let any = quote::format_ident!("{any}");
    let kind = quark_type(&quark.name, quark.overload);
    let value = quark_value(quark, quarks);
    quote!(robot::#any::#kind(#value))
}
