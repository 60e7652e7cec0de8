//! Emits conditions as table rows: the operands and operators of every interrupt, as values of the run-time system's
//! type.

use mdle_runtime::{Condition, Nanos};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::arguments::{compared, quark_value};
use super::names::quark_type;
use super::quark_functions::QuarkFunctions;
use super::scopes::nanometers;
use crate::fsm::{self, Machine};
use crate::plan::{Quark, QuarkId};

/// Emits `static OPERANDS`. It contains the conditions of a plan that is emitted as code, so that reports can show the
/// operands that have fired.
pub(super) fn conditions(machine: &Machine) -> TokenStream {
    let rows = fsm::rows(machine);
    let conditions = rows.guards.iter().map(|guard| row(&guard.condition, machine, None));
    let operands = rows.operands.iter().map(|operand| row(operand, machine, None));
    quote! {
        #[doc = " The conditions of brackets as rows, for reports of the operands that have fired."]
        static OPERANDS: runtime::Conditions<'static, robot::AnyInterrupt> = runtime::Conditions {
            conditions: &[#(#conditions),*],
            operands: &[#(#operands),*],
        };
    }
}

/// Emits a condition or an operand: `runtime::Condition::Or(0, 2)`, or `bumper()` if `functions` contains a function
/// for the quark.
pub(super) fn row(
    condition: &Condition<QuarkId>,
    machine: &Machine,
    functions: Option<&QuarkFunctions<'_>>,
) -> TokenStream {
    if let Condition::Quark(id) = condition
        && let Some(call) = functions.and_then(|functions| functions.call(machine.quark(*id)))
    {
        return call;
    }
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

/// Emits an interrupt as a variant of the enum `AnyInterrupt` of its alphabet.
fn interrupt(id: QuarkId, quarks: &[Quark]) -> TokenStream {
    let quark = &quarks[id.0 as usize];
    let Some(comparison) = &quark.comparison else { return variant("AnyInterrupt", quark, quarks) };
    let comparison = compared(comparison, &quote!(robot::AnySignal), |signal| {
        variant("AnySignal", &quarks[signal.0 as usize], quarks)
    });
    quote!(robot::AnyInterrupt::Comparison(#comparison))
}

/// Emits a quark as a variant of an enum of its alphabet: `robot::AnyControl::Go(robot::Go::new(…))`.
pub(super) fn variant(any: &str, quark: &Quark, quarks: &[Quark]) -> TokenStream {
    let any = quote::format_ident!("{any}");
    let kind = quark_type(&quark.name, quark.overload);
    let value = quark_value(quark, quarks);
    quote!(robot::#any::#kind(#value))
}
