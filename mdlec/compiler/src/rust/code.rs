//! A plan as code: quarks as constants, laws as variants, interrupts as functions that ask the scopes around them
//! first.

use std::collections::BTreeSet;

use mdle_runtime::Printable;
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::arguments::{angle, quark_value, type_of};
use super::conditions::conditions;
use super::meaning::Meaning;
use super::names::{atom_variant, quark_type};
use super::scopes::{asks_for_progress, ending};
use super::tables::entries;
use crate::fsm::{Atom, Machine};
use crate::plan::{Compared, QuarkId, frame_text};

/// The plan's type and its implementation, with an arm for each atom.
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
    /// Emits a constant for each quark that is not a `wait`: `const GO_20_0: robot::Go = robot::Go::new(…);`.
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

    /// The quarks that are no constants by themselves: signals, and comparisons of `t`, which the machine makes.
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

    /// Emits `enum Running`: the law of the current atom with its state.
    pub(super) fn running(&self) -> TokenStream {
        let variants = self.machine.atoms().map(|atom| {
            let kind = quark_type(&atom.law().name, atom.law().overload);
            let variant = atom_variant(atom.index());
            let doc = format!(" `{}`", atom_doc(atom));
            quote! {
                #[doc = #doc]
                #variant(<robot::#kind as runtime::Control<Output>>::Law)
            }
        });
        quote! {
            #[doc = " The law of the current atom, with its state since the atom began."]
            #[derive(Debug)]
            enum Running {
                #[doc = " Before the plan begins."]
                Idle,
                #(#variants,)*
            }
        }
    }

    /// Emits `impl Plan for LabTour`, by which the machine evaluates the plan.
    fn implementation(&self, plan: &Ident, paths: Option<&TokenStream>) -> TokenStream {
        let slots = Literal::usize_unsuffixed(self.machine.sizes().slots);
        let (entered, begins) = entries(self.machine);
        let ([enter, next, input], stalled) = ([self.enter(), self.next(), self.input()], self.stalled());
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

    /// Emits `fn enter`, which makes the law of the atom that is entered. A law may take kilobytes: each arm assigns
    /// the one it makes, which puts it on the stack once, and on a microcontroller only while it is made.
    pub(super) fn enter(&self) -> TokenStream {
        let arms = self.machine.atoms().map(|atom| {
            let number = Literal::usize_unsuffixed(atom.index());
            let variant = atom_variant(atom.index());
            let constant = &self.constants[atom.law_id().0 as usize];
            let begin = beginning(atom.turned());
            quote!(#number => self.running = Running::#variant(runtime::Control::begin(&#constant, y, #begin)))
        });
        quote! {
            #[cfg_attr(target_os = "none", inline(never))]
            fn enter(&mut self, atom: u32, y: &Output, begin: Begin) {
                match atom {
                    #(#arms,)*
                    _ => self.running = Running::Idle,
                }
            }
        }
    }

    /// Emits `fn next`, which evaluates the plan's own interrupt, and then, in an arm for each atom, the interrupts of
    /// the enclosing scopes, the atom's interrupt, and the completion of its law.
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

    /// Emits `fn stalled`, the report of the current atom's law about its progress, for a plan with `stuck`.
    fn stalled(&self) -> Option<TokenStream> {
        let variants = self.machine.atoms().map(|atom| atom_variant(atom.index()));
        asks_for_progress(self.machine).then(|| {
            quote! {
                fn stalled(&self, y: &Output, t: Nanos) -> Option<Nanos> {
                    match &self.running {
                        Running::Idle => None,
                        #(Running::#variants(law) => runtime::Law::stalled(law, y, t),)*
                    }
                }
            }
        })
    }

    /// Emits `fn input`, which applies the law of the current atom.
    pub(super) fn input(&self) -> TokenStream {
        let variants = self.machine.atoms().map(|atom| atom_variant(atom.index()));
        quote! {
            fn input(&mut self, y: &Output, t: Nanos) -> Input {
                match &mut self.running {
                    Running::Idle => Input::default(),
                    #(Running::#variants(law) => runtime::Law::input(law, y, t),)*
                }
            }
        }
    }
}

/// Writes an atom for a comment: `FRAME 90 (Atom (bumper) stop)`. Rust allows neither a lone carriage return nor
/// characters that reverse text in a comment.
pub(super) fn atom_doc(atom: Atom<'_>) -> String {
    let interrupt = atom.element().interrupt().filter(|interrupt| !interrupt.removed);
    let condition = interrupt.map_or("null", |interrupt| &interrupt.text);
    format!("{}(Atom ({}) {})", frame_text(atom.frame()), Printable(condition), Printable(&atom.law().text))
}

/// Emits the call of a scope's function, which ends the turn's evaluation if that scope or an enclosing one ends.
fn enclosing_first(function: &Ident) -> TokenStream {
    quote! {
        if let Some(ending) = #function(cursor, y, t) { return Some(ending); }
    }
}

/// Emits `begin`, or `begin.turned(…)` in a turned frame.
fn beginning(frame: f64) -> TokenStream {
    if frame == 0.0 {
        return quote!(begin);
    }
    let angle = angle(frame);
    quote!(begin.turned(#angle))
}
