//! A plan as code: quarks as constants, laws as variants, interrupts as functions that ask the scopes around them first.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::arguments::{angle, made};
use super::names::{Distinct, atom_variant, quark_type};
use super::tables::{follows, level};
use crate::fsm::{LawMeaning, Lowered};
use crate::plan::{Condition, Quark, QuarkId, frame_text};

/// The plan's type and its implementation.
pub(super) fn machine(plan: &Ident, doc: &str, lowered: &Lowered) -> TokenStream {
    let meaning = Meaning::new(lowered);
    let constants = meaning.constants();
    let running = meaning.running();
    let implementation = implementation(plan, lowered, &meaning);
    let scopes = meaning.scope_functions();
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
        #scopes
    }
}

/// `impl Plan for LabTour`: what the machine asks of a plan.
fn implementation(plan: &Ident, lowered: &Lowered, meaning: &Meaning<'_>) -> TokenStream {
    let [levels, slots] = [lowered.levels, lowered.slots].map(Literal::usize_unsuffixed);
    let enter = meaning.enter();
    let next = meaning.next();
    let input = meaning.input();
    quote! {
        impl runtime::Plan for #plan {
            type Output = Output;
            type Input = Input;
            type Entered = [Nanos; #levels];
            type Left = [u64; #slots];

            fn fsm(&self) -> Fsm<'_> { FSM }
            fn slots(&self) -> (Self::Entered, Self::Left) { ([Nanos::ZERO; #levels], [0; #slots]) }
            #enter
            #next
            #input
            fn law(&self, atom: u32) -> &str { text(LAWS, atom) }
            fn condition(&self, scope: u32) -> &str { text(CONDITIONS, scope) }
            fn name(&self, scope: u32) -> &str { text(NAMES, scope) }
        }

        #[doc = " The cursor of this plan: its levels of scopes and of loops are known."]
        type At = Cursor<[Nanos; #levels], [u64; #slots]>;

        fn text(texts: &'static [&'static str], index: u32) -> &'static str {
            texts.get(index as usize).copied().unwrap_or("")
        }
    }
}

/// A plan's meaning with the names that its constants and functions have.
pub(super) struct Meaning<'a> {
    lowered: &'a Lowered,
    /// The constant of each quark.
    constants: Vec<Ident>,
    /// The function of each bracket that is a scope with atoms inside and an interrupt that can fire.
    functions: Vec<Option<Ident>>,
}

impl<'a> Meaning<'a> {
    pub(super) fn new(lowered: &'a Lowered) -> Self {
        let mut names = Distinct::constants();
        let constants = lowered.quarks.iter().map(|quark| names.constant(&quark.text)).collect();
        let mut names = Distinct::functions();
        let functions = lowered
            .scopes
            .iter()
            .enumerate()
            .map(|(bracket, scope)| {
                let scope = scope.as_ref().filter(|scope| scope.interrupt.condition != Condition::Null)?;
                (!Self::is_atom(lowered, bracket)).then(|| names.scope_function(&scope.name))
            })
            .collect();
        Self { lowered, constants, functions }
    }

    /// `const GO_20_0: robot::Go = robot::Go::new(…);` for each quark that is not a `wait`.
    pub(super) fn constants(&self) -> TokenStream {
        let quarks = self.lowered.quarks.iter().zip(&self.constants).filter(|(quark, _)| quark.name != "wait");
        let constants = quarks.map(|(quark, constant)| {
            let kind = quark_type(&quark.name, quark.overload);
            let value = made(quark);
            let doc = format!(" `{}`", quark.text);
            quote! {
                #[doc = #doc]
                const #constant: robot::#kind = #value;
            }
        });
        quote!(#(#constants)*)
    }

    /// `enum Running`: the law of the current atom with its state.
    pub(super) fn running(&self) -> TokenStream {
        let variants = self.atoms().map(|(atom, law, quark)| {
            let kind = quark_type(&quark.name, quark.overload);
            let variant = atom_variant(atom);
            let doc = format!(" {}", self.atom_text(atom, law, quark));
            quote! {
                #[doc = #doc]
                #variant(<robot::#kind as runtime::Control<Output>>::Law)
            }
        });
        quote! {
            #[doc = " The law of the current atom, with what it remembers since the atom began."]
            #[derive(Debug)]
            enum Running {
                #[doc = " Before the plan begins."]
                Idle,
                #(#variants,)*
            }
        }
    }

    /// `fn enter`: makes the law of the atom that is entered.
    pub(super) fn enter(&self) -> TokenStream {
        let arms = self.atoms().map(|(atom, law, _)| {
            let number = Literal::usize_unsuffixed(atom);
            let variant = atom_variant(atom);
            let constant = &self.constants[law.quark.0 as usize];
            let begin = turned(law.frame);
            quote!(#number => Running::#variant(runtime::Control::begin(&#constant, y, #begin)))
        });
        quote! {
            fn enter(&mut self, atom: u32, y: &Output, begin: Begin) {
                self.running = match atom {
                    #(#arms,)*
                    _ => Running::Idle,
                };
            }
        }
    }

    /// `fn next`: an arm for each atom, which asks the scope around it first and itself last.
    pub(super) fn next(&self) -> TokenStream {
        let arms = self.atoms().map(|(atom, _, quark)| {
            let variant = atom_variant(atom);
            let bracket = self.lowered.atoms[atom].scope;
            let around = self.around(bracket).map(|function| {
                quote! {
                    if let Some(ending) = #function(cursor, y, t) { return Next::Ends(ending); }
                }
            });
            let asked = |question: &TokenStream, cause| {
                let ending = self.ending(bracket, cause);
                quote!(if #question { return runtime::Plan::end(self, cursor, #ending, y, begin, direct); })
            };
            let interrupt = self.condition(bracket).map(|fired| asked(&fired, "Fired"));
            let completion =
                quark.completes.then(|| asked(&quote!(runtime::Completes::completed(law, y, t)), "Completed"));
            let law = if quark.completes { quote!(law) } else { quote!(_) };
            quote!(Running::#variant(#law) => { #around #interrupt #completion })
        });
        quote! {
            #[inline(always)]
            fn next(&mut self, cursor: &mut At, y: &Output, begin: Begin, direct: bool) -> Next {
                let t = begin.now;
                match &self.running {
                    Running::Idle => {}
                    #(#arms)*
                }
                Next::Stays
            }
        }
    }

    /// `fn input`: the law of the current atom.
    pub(super) fn input(&self) -> TokenStream {
        let variants = self.atoms().map(|(atom, _, _)| atom_variant(atom));
        quote! {
            fn input(&mut self, y: &Output, t: Nanos) -> Input {
                match &mut self.running {
                    Running::Idle => Input::default(),
                    #(Running::#variants(law) => runtime::Law::input(law, y, t),)*
                }
            }
        }
    }

    /// For each scope with an interrupt: `fn shake(cursor, y, t) -> Option<runtime::Ending>`.
    pub(super) fn scope_functions(&self) -> TokenStream {
        let functions = self.functions.iter().zip(0_u32..).filter_map(|(function, bracket)| {
            let function = function.as_ref()?;
            let scope = self.lowered.scopes[bracket as usize].as_ref()?;
            let ending = self.ending(bracket, "Fired");
            let fired = self.condition(bracket).map(|fired| quote!(if #fired { return Some(#ending); }));
            let around = self.around(bracket).map(|function| {
                quote! {
                    if let Some(ending) = #function(cursor, y, t) { return Some(ending); }
                }
            });
            let doc = format!(" {} ({}), and the scopes around it first.", scope.name, scope.interrupt.text);
            Some(quote! {
                #[doc = #doc]
                fn #function(cursor: &At, y: &Output, t: Nanos) -> Option<runtime::Ending> { #around #fired None }
            })
        });
        quote!(#(#functions)*)
    }

    /// The function of the nearest scope around this bracket that has an interrupt.
    fn around(&self, bracket: u32) -> Option<&Ident> {
        let mut here = bracket;
        while here != 0 {
            here = self.lowered.brackets[here as usize].parent;
            if let Some(function) = &self.functions[here as usize] {
                return Some(function);
            }
        }
        None
    }

    /// `Cause::Fired(level).then(…)`, or without what follows where that depends on a loop's count.
    fn ending(&self, bracket: u32, cause: &str) -> TokenStream {
        let (cause, level) = (format_ident!("{cause}"), self.level(bracket));
        match self.lowered.tables().follows(bracket).map(follows) {
            Some(follows) => quote!(runtime::Cause::#cause(#level).then(#follows)),
            None => quote!(runtime::Cause::#cause(#level).into()),
        }
    }

    /// Whether the interrupt of this scope has fired; `None` where it never does.
    fn condition(&self, bracket: u32) -> Option<TokenStream> {
        let scope = self.lowered.scopes[bracket as usize].as_ref()?;
        let condition = &scope.interrupt.condition;
        (*condition != Condition::Null).then(|| self.expression(condition, self.level(bracket)))
    }

    fn expression(&self, condition: &Condition, level: u16) -> TokenStream {
        let operand = |operand: &Condition| {
            let inner = self.expression(operand, level);
            match operand {
                Condition::Or(_) | Condition::And(_) | Condition::Wait { .. } => quote!((#inner)),
                Condition::Null | Condition::Quark(_) | Condition::Not(_) => inner,
            }
        };
        match condition {
            Condition::Null => quote!(false),
            Condition::Quark(QuarkId(id)) => {
                let constant = &self.constants[*id as usize];
                quote!(runtime::Interrupt::fired(&#constant, y))
            }
            Condition::Wait { nanos, .. } => {
                let nanos = Literal::u64_unsuffixed(*nanos);
                quote!(cursor.since(#level, t) >= Nanos(#nanos))
            }
            Condition::Or(operands) => joined(operands.iter().map(operand).collect(), &quote!(|)),
            Condition::And(operands) => joined(operands.iter().map(operand).collect(), &quote!(&)),
            Condition::Not(inner) => {
                let inner = operand(inner);
                quote!(!#inner)
            }
        }
    }

    /// The atoms as written: number from 0, meaning, law.
    fn atoms(&self) -> impl Iterator<Item = (usize, &LawMeaning, &Quark)> {
        self.lowered.laws.iter().enumerate().map(|(atom, law)| (atom, law, self.lowered.quark(law.quark)))
    }

    fn atom_text(&self, atom: usize, law: &LawMeaning, quark: &Quark) -> String {
        let bracket = self.lowered.atoms[atom].scope as usize;
        let interrupt = self.lowered.scopes[bracket].as_ref().map(|scope| &scope.interrupt);
        let condition = interrupt.filter(|interrupt| !interrupt.removed).map_or("null", |interrupt| &interrupt.text);
        let frame = frame_text(law.frame);
        format!("`{frame}(Atom ({condition}) {})`", quark.text)
    }

    fn level(&self, bracket: u32) -> u16 {
        level(self.lowered.brackets[bracket as usize].kind)
    }

    fn is_atom(lowered: &Lowered, bracket: usize) -> bool {
        let first = lowered.brackets[bracket].first as usize;
        lowered.atoms.get(first).is_some_and(|atom| atom.scope as usize == bracket)
    }
}

/// Operands with an operator between them, in groups where there are many: Rust's syntax nests operators to the left, and
/// compilers follow it down.
fn joined(operands: Vec<TokenStream>, operator: &TokenStream) -> TokenStream {
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
        let group = joined(group.to_vec(), operator);
        quote!((#group))
    });
    join(&groups.collect::<Vec<_>>())
}

/// `begin`, or `begin` in a frame that is turned.
fn turned(frame: f64) -> TokenStream {
    if frame == 0.0 {
        return quote!(begin);
    }
    let angle = angle(frame);
    quote!(begin.turned(#angle))
}
