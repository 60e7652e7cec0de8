//! The constant tables of a generated file: the machine and the texts that traces and messages show.

use std::collections::BTreeSet;

use mdle_runtime::fsm::{Bracket, Kind};
use mdle_runtime::{Follows, Here};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::arguments::angle;
use crate::alphabet::{Alphabet, Kind as ValueKind};
use crate::fsm::Machine;
use crate::plan::{Quark, Value};

/// `const FSM`, `LAWS`, `CONDITIONS`, `NAMES`, and `HERE` for a plan with `FRAME here`.
pub(super) fn tables(lowered: &Machine) -> TokenStream {
    let brackets = lowered.brackets.iter().map(bracket);
    let atoms = lowered.atoms.iter().map(|atom| {
        let (scope, state) = (Literal::u32_unsuffixed(atom.scope), Literal::u64_unsuffixed(atom.state));
        quote!(Atom::new(#scope, #state))
    });
    let termination = Literal::u64_unsuffixed(lowered.termination);
    let laws = lowered.laws.iter().map(|law| &lowered.quark(law.quark).text);
    let scopes = || lowered.scopes.iter().map(Option::as_ref);
    let conditions = scopes().map(|scope| scope.map_or("", |scope| &scope.interrupt.text));
    let names = scopes().map(|scope| scope.map_or("", |scope| &scope.name));
    let frames = frames(lowered);
    quote! {
        #[doc = " Scopes and loops in pre-order, the atoms as written, the termination state."]
        const FSM: Fsm<'static> = Fsm {
            brackets: &[#(#brackets),*],
            atoms: &[#(#atoms),*],
            termination: #termination,
        };

        #[doc = " The quark text of each atom's law."]
        const LAWS: &[&str] = &[#(#laws),*];

        #[doc = " The condition text of each bracket; empty for a loop."]
        const CONDITIONS: &[&str] = &[#(#conditions),*];

        #[doc = " The name of each bracket; empty for an atom and a loop."]
        const NAMES: &[&str] = &[#(#names),*];

        #frames
    }
}

/// `const HERE`: the frame of each atom that is inside a `FRAME here`; nothing for a plan without.
fn frames(lowered: &Machine) -> Option<TokenStream> {
    let frames = lowered.frames.iter().map(|here| match here {
        Some(Here { level, turned }) => {
            let (level, turned) = (Literal::u16_unsuffixed(*level), angle(turned.0));
            quote!(Some(runtime::Here { level: #level, turned: #turned }))
        }
        None => quote!(None),
    });
    has_frames(lowered).then(|| {
        quote! {
            #[doc = " The frame of each atom that is inside a `FRAME here`."]
            const HERE: &[Option<runtime::Here>] = &[#(#frames),*];
        }
    })
}

fn has_frames(lowered: &Machine) -> bool {
    lowered.frames.iter().any(Option::is_some)
}

/// The type that keeps the entries of scopes, and its initial value.
pub(super) fn entries(lowered: &Machine) -> (TokenStream, TokenStream) {
    let levels = Literal::usize_unsuffixed(lowered.sizes().levels);
    if lowered.sizes().stamps {
        let frames = if has_frames(lowered) { quote!(HERE) } else { quote!(&[]) };
        let new = quote!(runtime::Stamps::new([runtime::Stamp::START; #levels], #frames));
        return (quote!(runtime::Stamps<'static, [runtime::Stamp; #levels]>), new);
    }
    (quote!([Nanos; #levels]), quote!([Nanos::ZERO; #levels]))
}

/// `Bracket::scope(level, first, last, parent)` or `Bracket::repeat(times, slot, stride, first, last, parent)`.
fn bracket(bracket: &Bracket) -> TokenStream {
    let [first, last, parent] = [bracket.first, bracket.last, bracket.parent].map(Literal::u32_unsuffixed);
    match bracket.kind {
        Kind::Scope { level } => {
            let level = Literal::u16_unsuffixed(level);
            quote!(Bracket::scope(#level, #first, #last, #parent))
        }
        Kind::Loop { times, slot, stride } => {
            let [times, stride] = [times, stride].map(Literal::u64_unsuffixed);
            let slot = Literal::u16_unsuffixed(slot);
            quote!(Bracket::repeat(#times, #slot, #stride, #first, #last, #parent))
        }
    }
}

/// How many scopes are around a scope.
pub(super) fn level(kind: Kind) -> u16 {
    match kind {
        Kind::Scope { level } => level,
        Kind::Loop { .. } => 0,
    }
}

/// `runtime::Follows::new(atom, from, to)`.
pub(super) fn follows(follows: Follows) -> TokenStream {
    let Follows { atom, from, to } = follows;
    let atom = Literal::u32_unsuffixed(atom);
    let [from, to] = [from, to].map(Literal::u16_unsuffixed);
    quote!(runtime::Follows::new(#atom, #from, #to))
}

/// `fn paths`: the files whose paths laws replay, each once; nothing for a plan that replays none.
pub(super) fn paths(lowered: &Machine, alphabet: &Alphabet) -> Option<TokenStream> {
    let replays = |quark: &Quark| {
        let declaration = alphabet.declarations_of(&quark.name).nth(quark.overload);
        declaration.is_some_and(|declaration| declaration.needs.iter().any(|need| need.name == "paths"))
    };
    let laws = lowered.laws.iter().map(|law| lowered.quark(law.quark)).filter(|quark| replays(quark));
    let files: BTreeSet<_> = laws.flat_map(|quark| quark.args.iter().filter_map(file)).collect();
    let files = files.iter();
    (files.len() > 0).then(|| quote!(fn paths(&self) -> &[&'static str] { &[#(#files),*] }))
}

/// The name of the file that an argument is.
fn file(argument: &Value) -> Option<&str> {
    match argument {
        Value::Name(ValueKind::File, name) => Some(name),
        Value::Name(..)
        | Value::Quantity { .. }
        | Value::Infinity(_)
        | Value::Bits(_)
        | Value::Integer(_)
        | Value::Sonar(_) => None,
    }
}
