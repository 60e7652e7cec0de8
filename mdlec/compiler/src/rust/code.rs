//! Emits a plan as inline code. Quarks become constants, and the interrupts of scopes become functions that first
//! evaluate the enclosing scopes.

use std::collections::BTreeSet;

use mdle_runtime::Printable;
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::arguments::{quark_value, type_of};
use super::conditions::conditions;
use super::meaning::Meaning;
use super::names::atom_variant;
use super::scopes::ending;
use super::tables::entries;
use crate::fsm::Machine;
use crate::plan::{Compared, QuarkId};

/// Emits the type of the plan and its implementation, in which each atom has a match arm.
pub(super) fn machine(plan: &Ident, doc: &str, machine: &Machine, paths: Option<&TokenStream>) -> TokenStream {
    let meaning = Meaning::new(machine);
    let constants = meaning.constants();
    let running = meaning.running();
    let implementation = meaning.implementation(plan, paths);
    let scope_functions = meaning.scope_functions();
    let conditions = conditions(machine);
    quote! {
        #[doc = #doc]
        #[derive(Debug)]
        pub struct #plan { running: Running }

        impl #plan {
            #[doc = " The plan before it begins."]
            #[must_use]
            pub const fn new() -> Self { Self { running: Running::Idle } }
        }

        impl Default for #plan {
            fn default() -> Self { Self::new() }
        }

        #constants
        #running
        #implementation
        #scope_functions
        #conditions
    }
}

impl Meaning<'_> {
    /// Emits a constant for each quark of a law or an interrupt: `const GO_20_0: robot::Go = robot::Go::new(…);`.
    /// `wait` and the quarks that [`Meaning::signals`] returns have no constants.
    pub(super) fn constants(&self) -> TokenStream {
        let signals = self.signals();
        let quarks = (0..).map(QuarkId).zip(self.machine.quarks()).zip(&self.constants);
        let quarks = quarks.filter(|((id, quark), _)| quark.name != "wait" && !signals.contains(id));
        let constants = quarks.map(|((_, quark), constant)| {
            let kind = type_of(quark, self.machine.quarks());
            let value = quark_value(quark, self.machine.quarks());
            let doc = format!(" `{}`", Printable(&quark.text));
            quote! {
                #[doc = #doc]
                const #constant: #kind = #value;
            }
        });
        quote!(#(#constants)*)
    }

    /// Returns the quarks that need no constants of their own. These are signals, which are parts of comparisons, and
    /// comparisons of `t` and `way`, which the machine evaluates.
    fn signals(&self) -> BTreeSet<QuarkId> {
        let mut signals = BTreeSet::new();
        let mut in_conditions = BTreeSet::new();
        for element in self.machine.elements() {
            element.condition().each_quark(&mut |quark| {
                in_conditions.insert(quark);
            });
        }
        for (id, quark) in (0..).map(QuarkId).zip(self.machine.quarks()) {
            let Some(comparison) = &quark.comparison else { continue };
            signals.insert(comparison.signal);
            if let Compared::Signal(other) = comparison.with {
                signals.insert(other);
            }
            if !in_conditions.contains(&id) {
                signals.insert(id);
            }
        }
        signals
    }

    /// Emits `impl Plan for LabTour`, with which the machine evaluates the plan.
    fn implementation(&self, plan: &Ident, paths: Option<&TokenStream>) -> TokenStream {
        let slots = Literal::usize_unsuffixed(self.machine.sizes().slots);
        let (entered, begins) = entries(self.machine);
        let ([enter, next, input], stalled) = ([Self::enter(), self.next(), self.input()], self.stalled());
        let paths = paths.map(|paths| quote!(fn paths(&self) -> &[&'static str] { &[#paths] }));
        quote! {
            impl runtime::Plan for #plan {
                type Output = Output;
                type Input = Input;
                type Entered = #entered;
                type Left = [u64; #slots];

                fn fsm(&self) -> Fsm<'_> { FSM }
                fn slots(&self) -> (Self::Entered, Self::Left) { (#begins, [0; #slots]) }
                #enter
                #next
                #stalled
                #input
                fn operands(
                    &self,
                    cursor: &At,
                    scope: u32,
                    y: &Output,
                    t: Nanos,
                    tell: &mut dyn FnMut(u32, runtime::Measured),
                ) {
                    OPERANDS.fired(FSM, cursor, scope, y, t, tell);
                }
                fn source(&self) -> &dyn runtime::Words { &SOURCE }
                fn law(&self, atom: u32) -> &str { LAWS.text(atom) }
                fn condition(&self, scope: u32) -> &str { CONDITIONS.text(scope) }
                fn name(&self, scope: u32) -> &str { NAMES.text(scope) }
                #paths
            }

            #[doc = " The plan's cursor, with a place for each level of scopes and for each level of loops."]
            type At = Cursor<#entered, [u64; #slots]>;
        }
    }

    /// Emits `fn next`. This function evaluates the plan's own interrupt first. Then, in a match arm for each atom, it
    /// evaluates the interrupts of the enclosing scopes, the atom's interrupt, and the completion of its law.
    pub(super) fn next(&self) -> TokenStream {
        let arms = self.machine.atoms().map(|atom| {
            let (variant, element) = (atom_variant(atom.index()), atom.element());
            let around = self.around(element).map(enclosing_first);
            let exit = |question: &TokenStream, cause: TokenStream| {
                let ending = ending(element, &cause);
                quote!(if #question { return Some(#ending); })
            };
            let completes = atom.law().completes;
            let interrupt = self.condition(element).map(|fired| exit(&fired, quote!(Fired)));
            let completion =
                completes.then(|| exit(&quote!(runtime::Completes::completed(law, y, t)), quote!(Completed)));
            let law = if completes { quote!(law) } else { quote!(_) };
            quote!(Running::#variant(#law) => { #around #interrupt #completion })
        });
        let plan = self.function(self.machine.root()).map(enclosing_first);
        quote! {
            #[inline(always)]
            fn next(&self, cursor: &At, y: &Output, t: Nanos) -> Option<runtime::Ending> {
                #plan
                match &self.running {
                    Running::Idle => {}
                    #(#arms)*
                }
                None
            }
        }
    }
}

/// Emits a call of a scope's function. If this scope or an enclosing one ends, the call ends the turn's evaluation.
fn enclosing_first(function: &Ident) -> TokenStream {
    quote! {
        if let Some(ending) = #function(cursor, y, t) { return Some(ending); }
    }
}
