//! Emits the law of the current atom as inline code: an enum with a variant for each atom, and the functions that
//! create, query and apply the law.

use mdle_runtime::Printable;
use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::arguments::angle;
use super::meaning::Meaning;
use super::names::{atom_variant, quark_type};
use super::scopes::asks_for_progress;
use crate::fsm::Atom;
use crate::plan::frame_text;

impl Meaning<'_> {
    /// Emits `enum Running`, which contains the law of the current atom with its state, and the function that creates
    /// the law.
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
        let start = self.start();
        quote! {
            #[doc = " The law of the current atom, with its state since the atom began."]
            #[derive(Debug)]
            enum Running {
                #[doc = " Before the plan begins."]
                Idle,
                #(#variants,)*
            }

            impl Running {
                #start
            }
        }
    }

    /// Emits `fn start`, which creates the law of the atom that is entered. A law may need kilobytes of memory. Each
    /// match arm therefore assigns the law that it creates, so that the law is on the stack only once, and on a
    /// microcontroller only while it is being created.
    fn start(&self) -> TokenStream {
        let arms = self.machine.atoms().map(|atom| {
            let number = Literal::usize_unsuffixed(atom.index());
            let variant = atom_variant(atom.index());
            let constant = &self.constants[atom.law_id().0 as usize];
            let begin = beginning(atom.turned());
            quote!(#number => *self = Running::#variant(runtime::Control::begin(&#constant, y, #begin)))
        });
        quote! {
            #[doc = " Becomes the law of an atom that begins."]
            #[cfg_attr(target_os = "none", inline(never))]
            #[cfg_attr(not(target_os = "none"), inline(always))]
            fn start(&mut self, atom: u32, y: &Output, begin: Begin) {
                match atom {
                    #(#arms,)*
                    _ => *self = Running::Idle,
                }
            }
        }
    }

    /// Emits `fn enter`, which starts the law of the atom that is entered. If the stack is large, the law is created
    /// outside the plan and then moved, because LLVM then converts small laws to a table. If match arms wrote to the
    /// plan, LLVM would copy the turn's loop into them, with twice the number of instructions.
    pub(super) fn enter() -> TokenStream {
        quote! {
            #[inline(always)]
            fn enter(&mut self, atom: u32, y: &Output, begin: Begin) {
                if cfg!(target_os = "none") {
                    self.running.start(atom, y, begin);
                } else {
                    let mut running = Running::Idle;
                    running.start(atom, y, begin);
                    self.running = running;
                }
            }
        }
    }

    /// Emits `fn stalled`, with which the law of the current atom reports its progress; `None` for a plan without
    /// `stuck`.
    pub(super) fn stalled(&self) -> Option<TokenStream> {
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

/// Returns the text of an atom for use in a comment: `FRAME 90 (Atom (bumper) stop)`. Rust allows neither a lone
/// carriage return nor characters that reverse text in a comment.
fn atom_doc(atom: Atom<'_>) -> String {
    let interrupt = atom.element().interrupt().filter(|interrupt| !interrupt.removed);
    let condition = interrupt.map_or("null", |interrupt| &interrupt.text);
    format!("{}(Atom ({}) {})", frame_text(atom.frame()), Printable(condition), Printable(&atom.law().text))
}

/// Emits `begin` or, for a turned frame, `begin.turned(…)`.
fn beginning(frame: f64) -> TokenStream {
    if frame == 0.0 {
        return quote!(begin);
    }
    let angle = angle(frame);
    quote!(begin.turned(#angle))
}
