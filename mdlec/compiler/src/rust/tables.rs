//! Emits the constant tables of a generated file: the machine, and the texts that traces and messages show.

use mdle_runtime::{Follows, Here};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::arguments::angle;
use super::texts::text_list;
use crate::alphabet::Alphabet;
use crate::fsm::{self, Element, ElementKind, Machine};

/// Emits the constants `FSM`, `LAWS`, `CONDITIONS`, `NAMES`, and `HERE` for a plan with `FRAME here`.
pub(super) fn tables(machine: &Machine) -> TokenStream {
    let brackets = machine.elements().map(bracket);
    let atoms = machine.atoms().map(|atom| {
        let scope = Literal::u32_unsuffixed(atom.element().number());
        let state = Literal::u64_unsuffixed(atom.state());
        quote!(Atom::new(#scope, #state))
    });
    let termination = Literal::u64_unsuffixed(machine.states());
    let laws = text_list(machine.atoms().map(|atom| &*atom.law().text));
    let conditions = text_list(machine.elements().map(Element::condition_text));
    let names = text_list(machine.elements().map(Element::name));
    let frames = frames(machine);
    quote! {
        #[doc = " Scopes and loops in pre-order, the atoms as written, the termination state."]
        const FSM: Fsm<'static> = Fsm {
            brackets: &[#(#brackets),*],
            atoms: &[#(#atoms),*],
            termination: #termination,
        };

        #[doc = " The quark text of each atom's law."]
        const LAWS: runtime::TextList<'static> = #laws;

        #[doc = " The condition text of each bracket; empty for a loop."]
        const CONDITIONS: runtime::TextList<'static> = #conditions;

        #[doc = " The name of each bracket; empty for an atom and a loop."]
        const NAMES: runtime::TextList<'static> = #names;

        #frames
    }
}

/// Emits `const HERE`, which contains the frame of each atom inside a `FRAME here`; `None` for a plan without `FRAME
/// here`.
fn frames(machine: &Machine) -> Option<TokenStream> {
    let frames = machine.frames().iter().map(|here| match here {
        Some(Here { level, turned }) => {
            let (level, turned) = (Literal::u16_unsuffixed(*level), angle(turned.0));
            quote!(Some(runtime::Here { level: #level, turned: #turned }))
        }
        None => quote!(None),
    });
    has_frames(machine).then(|| {
        quote! {
            #[doc = " The frame of each atom that is inside a `FRAME here`."]
            const HERE: &[Option<runtime::Here>] = &[#(#frames),*];
        }
    })
}

fn has_frames(machine: &Machine) -> bool {
    machine.frames().iter().any(Option::is_some)
}

/// Emits the type that stores the entries of scopes, and its initial value.
pub(super) fn entries(machine: &Machine) -> (TokenStream, TokenStream) {
    let levels = Literal::usize_unsuffixed(machine.sizes().levels);
    if machine.sizes().stamps {
        let frames = if has_frames(machine) { quote!(HERE) } else { quote!(&[]) };
        let new = quote!(runtime::Stamps::new([runtime::Stamp::START; #levels], #frames));
        return (quote!(runtime::Stamps<[runtime::Stamp; #levels]>), new);
    }
    (quote!([Nanos; #levels]), quote!([Nanos::ZERO; #levels]))
}

/// Emits a bracket: `Bracket::scope(level, first, last, parent)` or `Bracket::repeat(times, slot, stride, first, last,
/// parent)`.
fn bracket(element: Element<'_>) -> TokenStream {
    let parent = element.parent().unwrap_or(element);
    let [first, last] = [element.first(), element.last()].map(|atom| Literal::u32_unsuffixed(atom.number()));
    let parent = Literal::u32_unsuffixed(parent.number());
    if let (ElementKind::Loop { times }, Some((slot, stride))) = (element.kind(), element.counter()) {
        let [times, stride] = [times.unwrap_or(0), stride].map(Literal::u64_unsuffixed);
        let slot = Literal::u16_unsuffixed(slot);
        return quote!(Bracket::repeat(#times, #slot, #stride, #first, #last, #parent));
    }
    let level = Literal::u16_unsuffixed(level(element));
    quote!(Bracket::scope(#level, #first, #last, #parent))
}

/// Returns the number of scopes that enclose a scope; 0 for a loop.
pub(super) fn level(element: Element<'_>) -> u16 {
    element.level().unwrap_or(0)
}

/// Emits the successor of a scope: `runtime::Follows::new(atom, from, to)`.
pub(super) fn follows(follows: Follows) -> TokenStream {
    let Follows { atom, from, to } = follows;
    let atom = Literal::u32_unsuffixed(atom);
    let [from, to] = [from, to].map(Literal::u16_unsuffixed);
    quote!(runtime::Follows::new(#atom, #from, #to))
}

/// Emits the names of the path files that the laws replay, each listed once; `None` for a plan that replays no paths.
pub(super) fn paths(machine: &Machine, alphabet: &Alphabet) -> Option<TokenStream> {
    let files = fsm::replayed_files(machine, alphabet);
    let files = files.iter();
    (files.len() > 0).then(|| quote!(#(#files),*))
}
