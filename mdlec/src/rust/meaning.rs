//! What the atoms and scopes of a plan mean, as Rust: quarks as constants, laws as variants, interrupts as functions.

use mdle_runtime::fsm::Kind;
use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::names::{Distinct, atom_variant, quark_type};
use crate::alphabet::{self, Alphabet};
use crate::fsm::{LawMeaning, Lowered};
use crate::plan::{Condition, Quark, QuarkId, Value, frame_text, in_degrees};

/// The crate of the target, as Rust writes its name.
pub(super) fn target_crate(alphabet: &Alphabet) -> Ident {
    format_ident!("{}", alphabet.crate_name.replace('-', "_"))
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
            let arguments = quark.args.iter().map(argument);
            let doc = format!(" `{}`", quark.text);
            quote! {
                #[doc = #doc]
                const #constant: robot::#kind = robot::#kind::new(#(#arguments),*);
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
                #variant(<robot::#kind as ::mdle_runtime::Control<Output>>::Law)
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
            quote!(#number => Running::#variant(::mdle_runtime::Control::begin(&#constant, y, #begin)))
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

    /// `fn fired`: an arm for each atom, which asks the scope around it first and itself last.
    pub(super) fn fired(&self) -> TokenStream {
        let arms = self.atoms().map(|(atom, _, quark)| {
            let variant = atom_variant(atom);
            let bracket = self.lowered.atoms[atom].scope;
            let level = self.level(bracket);
            let interrupt =
                self.condition(bracket, level).map(|fired| quote!((#fired).then_some(Cause::Fired(#level))));
            let completion = quark
                .completes
                .then(|| quote!(::mdle_runtime::Completes::completed(law, y, t).then_some(Cause::Completed(#level))));
            let law = if quark.completes { quote!(law) } else { quote!(_) };
            let asked = in_order(self.around(bracket).into_iter().chain(interrupt).chain(completion));
            quote!(Running::#variant(#law) => #asked)
        });
        quote! {
            fn fired(&self, cursor: &At, y: &Output, t: Nanos) -> Option<Cause> {
                match &self.running {
                    Running::Idle => None,
                    #(#arms,)*
                }
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
                    #(Running::#variants(law) => ::mdle_runtime::Law::input(law, y, t),)*
                }
            }
        }
    }

    /// For each scope with an interrupt: `fn shake(cursor, y, t) -> Option<Cause> { dock(…).or_else(|| …) }`.
    pub(super) fn scope_functions(&self) -> TokenStream {
        let functions = self.functions.iter().zip(0_u32..).filter_map(|(function, bracket)| {
            let function = function.as_ref()?;
            let scope = self.lowered.scopes[bracket as usize].as_ref()?;
            let level = self.level(bracket);
            let fired = self.condition(bracket, level).map(|fired| quote!((#fired).then_some(Cause::Fired(#level))));
            let asked = in_order(self.around(bracket).into_iter().chain(fired));
            let doc = format!(" {} ({}), and the scopes around it first.", scope.name, scope.interrupt.text);
            Some(quote! {
                #[doc = #doc]
                fn #function(cursor: &At, y: &Output, t: Nanos) -> Option<Cause> { #asked }
            })
        });
        quote!(#(#functions)*)
    }

    /// The call of the nearest scope around this bracket that has an interrupt.
    fn around(&self, bracket: u32) -> Option<TokenStream> {
        let mut here = bracket;
        while here != 0 {
            here = self.lowered.brackets[here as usize].parent;
            if let Some(function) = &self.functions[here as usize] {
                return Some(quote!(#function(cursor, y, t)));
            }
        }
        None
    }

    /// Whether the interrupt of this scope has fired; `None` where it never does.
    fn condition(&self, bracket: u32, level: u16) -> Option<TokenStream> {
        let scope = self.lowered.scopes[bracket as usize].as_ref()?;
        let condition = &scope.interrupt.condition;
        (*condition != Condition::Null).then(|| self.expression(condition, level))
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
                quote!(::mdle_runtime::Interrupt::fired(&#constant, y))
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
        match self.lowered.brackets[bracket as usize].kind {
            Kind::Scope { level } => level,
            Kind::Loop { .. } => 0,
        }
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

/// Questions in order, each asked only if those before it found nothing: `a.or_else(|| b).or_else(|| c)`.
fn in_order(questions: impl Iterator<Item = TokenStream>) -> TokenStream {
    questions.reduce(|asked, next| quote!(#asked.or_else(|| #next))).unwrap_or_else(|| quote!(None))
}

/// `begin`, or `begin` in a frame that is turned.
fn turned(frame: f64) -> TokenStream {
    if frame == 0.0 {
        return quote!(begin);
    }
    let angle = angle(frame);
    quote!(begin.turned(#angle))
}

/// An angle, in degrees where that gives the same value.
fn angle(radians: f64) -> TokenStream {
    if let Some(degrees) = in_degrees(radians) {
        let degrees = number(degrees);
        return quote!(::mdle_runtime::Radians::from_degrees(#degrees));
    }
    let radians = number(radians);
    quote!(::mdle_runtime::Radians(#radians))
}

/// A number with its sign apart, as Rust's syntax has it.
fn number(value: f64) -> TokenStream {
    let digits = Literal::f64_unsuffixed(value.abs());
    if value.is_sign_negative() { quote!(-#digits) } else { quote!(#digits) }
}

/// An argument as its unit type.
fn argument(value: &Value) -> TokenStream {
    use alphabet::Kind;
    match value {
        Value::Quantity { kind, exact, family } => {
            let si = exact.to_f64() * alphabet::family_to_si(family);
            let number = number(si);
            match kind {
                Kind::Length => quote!(::mdle_runtime::Meters(#number)),
                Kind::Speed => quote!(::mdle_runtime::MetersPerSecond(#number)),
                Kind::Angle => angle(si),
                Kind::AngularRate => quote!(::mdle_runtime::RadiansPerSecond(#number)),
                Kind::Voltage => quote!(::mdle_runtime::Volts(#number)),
                Kind::Time => {
                    let nanos = Literal::u64_unsuffixed(exact.to_nanos().unwrap_or(u64::MAX));
                    quote!(::mdle_runtime::Nanos(#nanos))
                }
                Kind::Frequency
                | Kind::Number
                | Kind::Integer
                | Kind::Count
                | Kind::Bits(_)
                | Kind::Sonar
                | Kind::Robot
                | Kind::Module
                | Kind::File => quote!(#number),
            }
        }
        Value::Infinity(Kind::Time) => quote!(::mdle_runtime::Nanos::MAX),
        Value::Infinity(_) => quote!(u64::MAX),
        Value::Bits(bits) => quote!(::mdle_runtime::Bits([#(#bits),*])),
        Value::Integer(whole) => {
            let digits = Literal::u64_unsuffixed(whole.unsigned_abs());
            if *whole < 0 { quote!(-#digits) } else { quote!(#digits) }
        }
        Value::Sonar(sonar) => {
            let sonar = Literal::u8_unsuffixed(*sonar);
            quote!(::mdle_runtime::SonarId::new(#sonar))
        }
        Value::Name(_, name) => quote!(#name),
    }
}
