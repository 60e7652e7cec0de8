//! Emits a plan as table rows, in which the run-time system looks up conditions and laws. This form is used for plans
//! that are too long for inline code, and for plans with memories.

use mdle_runtime::{Fact, Follows, Guard, LawRow, MarkRow, Radians};
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::arguments::{angle, exact_degrees, number};
use super::conditions::{row, variant};
use super::quark_functions::QuarkFunctions;
use super::scopes::asks_for_progress;
use super::tables::entries;
use crate::alphabet::Alphabet;
use crate::fsm::{self, Machine, Rows};

/// Emits the rows of a plan, and the plan's type, which delegates to the type of the run-time system.
pub(super) fn machine(
    plan: &Ident,
    doc: &str,
    machine: &Machine,
    alphabet: &Alphabet,
    paths: Option<&TokenStream>,
) -> TokenStream {
    let slots = Literal::usize_unsuffixed(machine.sizes().slots);
    let (entered, begins) = entries(machine);
    let rows = rows(machine, alphabet, paths);
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

/// Emits the function with which the law of a plan with `stuck` reports its progress; `None` for a plan without
/// `stuck`.
fn stalled(machine: &Machine) -> Option<TokenStream> {
    asks_for_progress(machine).then(|| {
        quote! {
            #[inline(always)]
            fn stalled(&self, y: &Output, t: Nanos) -> Option<Nanos> { runtime::Plan::stalled(&self.0, y, t) }
        }
    })
}

/// Emits the functions with which the machine informs a plan with memories of each transition and of the end of a turn;
/// `None` for a plan without memories.
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

/// Emits the type of the plan's memory (`None` for a plan without memories), and the expression that creates the plan.
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

/// Emits `static ROWS`, which contains the condition of each bracket with its operands, and the law of each atom. The
/// rows are calls of the short functions that precede them.
fn rows(machine: &Machine, alphabet: &Alphabet, paths: Option<&TokenStream>) -> TokenStream {
    let rows = fsm::rows(machine);
    let functions = QuarkFunctions::new(machine, &rows, alphabet);
    let (quark_functions, row_functions) = (functions.items(), row_functions(&rows));
    let Rows { guards, operands, laws, marks, facts } = rows;
    let guards = guards.iter().map(|Guard { condition, level, around, follows }| {
        let condition = row(condition, machine, Some(&functions));
        let (level, around) = (Literal::u16_unsuffixed(*level), Literal::u32_unsuffixed(*around));
        let follows = follows.map_or_else(|| quote!(None), follower);
        quote!(guard(#condition, #level, #around, #follows))
    });
    let operands = operands.iter().map(|operand| row(operand, machine, Some(&functions)));
    let laws = laws.iter().map(|LawRow { control, frame }| {
        let quark = machine.quark(*control);
        let control = functions.call(quark).unwrap_or_else(|| variant("AnyControl", quark, machine.quarks()));
        let frame = turn(*frame);
        quote!(law(#control, #frame))
    });
    let (marks, facts) = (marks.iter().map(mark), facts.iter().map(fact));
    quote! {
        #quark_functions
        #row_functions

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

/// Emits the functions that create rows; functions that no row calls are omitted.
fn row_functions(rows: &Rows) -> TokenStream {
    let follows = rows.guards.iter().any(|guard| guard.follows.is_some()).then(|| {
        quote! {
            #[doc = " The atom that follows a scope, and the levels of scopes that begin with it."]
            const fn follows(atom: u32, from: u16, to: u16) -> Option<runtime::Follows> {
                Some(runtime::Follows::new(atom, from, to))
            }
        }
    });
    let degrees = rows.laws.iter().any(|law| exact_degrees(law.frame.0).is_some()).then(|| {
        quote! {
            #[doc = " An angle."]
            const fn degrees(angle: f64) -> runtime::Radians { runtime::Radians::from_degrees(angle) }
        }
    });
    quote! {
        #[doc = " The condition of a bracket, its level, the next bracket around it, and what follows it."]
        const fn guard(
            condition: runtime::Condition<robot::AnyInterrupt>,
            level: u16,
            around: u32,
            follows: Option<runtime::Follows>,
        ) -> runtime::Guard<robot::AnyInterrupt> {
            runtime::Guard { condition, level, around, follows }
        }

        #[doc = " The law of an atom, and the angle by which its frame is turned."]
        const fn law(control: robot::AnyControl, frame: runtime::Radians) -> runtime::LawRow<robot::AnyControl> {
            runtime::LawRow { control, frame }
        }

        #follows
        #degrees
    }
}

/// Emits the successor of a scope: `follows(1, 1, 2)`.
fn follower(Follows { atom, from, to }: Follows) -> TokenStream {
    let atom = Literal::u32_unsuffixed(atom);
    let [from, to] = [from, to].map(Literal::u16_unsuffixed);
    quote!(follows(#atom, #from, #to))
}

/// Emits the angle by which a frame is turned. If a number of degrees with at most six decimals converts to exactly
/// this angle, emits `degrees(90.0)`; otherwise, emits radians.
fn turn(Radians(radians): Radians) -> TokenStream {
    let Some(degrees) = exact_degrees(radians).map(number) else { return angle(radians) };
    quote!(degrees(#degrees))
}

/// Emits a label of an element: `runtime::MarkRow { … }`.
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

/// Emits a fact that `after` reads: `runtime::Fact { memory: 0, operand: Some(1) }`.
fn fact(Fact { memory, operand }: &Fact) -> TokenStream {
    let memory = Literal::u32_unsuffixed(*memory);
    let operand = match operand.map(Literal::u32_unsuffixed) {
        Some(operand) => quote!(Some(#operand)),
        None => quote!(None),
    };
    quote!(runtime::Fact { memory: #memory, operand: #operand })
}
