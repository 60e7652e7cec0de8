//! A plan as code that alike atoms share: an arm for each kind of atom, and what tells the atoms of a kind apart as rows
//! of its table.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::arguments::{angle, made, type_of};
use super::code::{Parts, atom_doc};
use super::kinds::{Atoms, Kind, Part};
use super::names::{Distinct, kind_table, kind_variant, quark_type};
use super::scopes::{Constant, ending, expression, nanometers, nanoseconds};
use super::tables::{follows, level};
use crate::fsm::Lowered;
use crate::plan::{Condition, Quark};

/// The plan's type and its implementation, with an arm for each kind of atom.
pub(super) fn machine(plan: &Ident, doc: &str, lowered: &Lowered, paths: Option<&TokenStream>) -> TokenStream {
    let shared = Shared::new(lowered);
    let parts = Parts {
        before: shared.running(),
        enter: shared.enter(),
        next: shared.next(),
        input: shared.input(),
        behind: shared.tables(),
    };
    parts.machine(plan, doc, lowered, paths)
}

/// The kinds' variants, tables and arms.
struct Shared<'l> {
    lowered: &'l Lowered,
    atoms: Atoms<'l>,
    kinds: Vec<(Kind, Vec<Column>)>,
}

/// A constant of an arm.
struct Column {
    /// How the arm writes it: `row.limit`, or the constant itself if it is the same in all atoms of the kind.
    written: TokenStream,
    /// The field of the row and its type, if there is one.
    field: Option<(Ident, TokenStream)>,
}

impl<'l> Shared<'l> {
    fn new(lowered: &'l Lowered) -> Self {
        let atoms = Atoms::new(lowered);
        let kinds = atoms.kinds(usize::MAX, usize::MAX).unwrap_or_default();
        let mut shared = Self { lowered, atoms, kinds: Vec::new() };
        shared.kinds = kinds
            .into_iter()
            .map(|kind| {
                let columns = shared.columns(&kind);
                (kind, columns)
            })
            .collect();
        shared
    }

    /// The law of a kind's atoms, with the arguments that it has in the first of them.
    fn law(&self, kind: &Kind) -> &Quark {
        self.lowered.quark(self.lowered.laws[kind.atoms[0]].quark)
    }

    /// The first of a kind's atoms, as written.
    fn text(&self, kind: &Kind) -> String {
        atom_doc(self.lowered, kind.atoms[0])
    }

    /// The constants of an arm, in the order in which it writes them.
    fn columns(&self, kind: &Kind) -> Vec<Column> {
        let mut members = kind.atoms.iter().map(|atom| self.constants(*atom));
        let Some(first) = members.next() else { return Vec::new() };
        let mut differ = vec![false; first.len()];
        for member in members {
            for (differs, (here, there)) in differ.iter_mut().zip(first.iter().zip(&member)) {
                *differs |= here != there;
            }
        }
        let mut names = Distinct::parameters();
        let columns = first.iter().zip(differ).map(|(part, differs)| {
            let (name, kind, value) = self.constant(*part);
            if !differs {
                return Column { written: value, field: None };
            }
            let name = names.parameter(name);
            Column { written: quote!(row.#name), field: Some((name, kind)) }
        });
        columns.collect()
    }

    /// The parts of an atom that have a constant.
    fn constants(&self, atom: usize) -> Vec<Part> {
        let mut parts = self.atoms.parts(atom, usize::MAX).unwrap_or_default();
        parts.retain(|part| match part {
            Part::Quark(_) | Part::Wait(_) | Part::Way(_) | Part::Follows(Some(_)) | Part::Law(_) => true,
            Part::Frame(angle) => *angle != 0.0,
            Part::Scope { .. } | Part::Null | Part::Elapsed | Part::Driven => false,
            Part::Or(_) | Part::And(_) | Part::Not | Part::Follows(None) => false,
        });
        parts
    }

    /// What a row calls a constant, its type and its value.
    fn constant(&self, part: Part) -> (&str, TokenStream, TokenStream) {
        match part {
            Part::Quark(id) | Part::Law(id) => {
                let (quark, quarks) = (self.lowered.quark(id), &self.lowered.quarks);
                let name = if quark.comparison.is_some() { "compared" } else { quark.name.as_str() };
                (name, type_of(quark, quarks), made(quark, quarks))
            }
            Part::Wait(nanos) => ("wait", quote!(Nanos), nanoseconds(nanos)),
            Part::Way(length) => ("way", quote!(runtime::Nanometers), nanometers(length)),
            Part::Follows(Some(follows)) => {
                let atom = Literal::u32_unsuffixed(follows.atom);
                ("next", quote!(u32), quote!(#atom))
            }
            Part::Frame(radians) => ("frame", quote!(runtime::Radians), angle(radians)),
            Part::Follows(None)
            | Part::Scope { .. }
            | Part::Null
            | Part::Elapsed
            | Part::Driven
            | Part::Or(_)
            | Part::And(_)
            | Part::Not => unreachable!("what has no constant is left out"),
        }
    }

    /// `struct Kind1` and `static KIND_1`, for each kind whose atoms differ, and which row of which kind an atom is.
    fn tables(&self) -> TokenStream {
        let mut places = vec![(0, 0); self.lowered.atoms.len()];
        let tables = self.kinds.iter().zip(1_usize..).map(|((kind, columns), number)| {
            for (row, atom) in kind.atoms.iter().enumerate() {
                places[*atom] = (number, row);
            }
            self.table(kind, columns, number)
        });
        let tables: TokenStream = tables.flatten().collect();
        let places = places.into_iter().map(|(kind, row)| {
            let [kind, row] = [kind, row].map(Literal::usize_unsuffixed);
            quote!((#kind, #row))
        });
        quote! {
            #tables
            #[doc = " The kind of each atom, and its row in the kind's table."]
            static PLACES: &[(u16, u32)] = &[#(#places),*];
        }
    }

    fn table(&self, kind: &Kind, columns: &[Column], number: usize) -> Option<TokenStream> {
        let (names, types): (Vec<_>, Vec<_>) =
            columns.iter().filter_map(|column| column.field.as_ref()).map(|(name, kind)| (name, kind)).unzip();
        if names.is_empty() {
            return None;
        }
        let (variant, table) = (kind_variant(number), kind_table(number));
        let rows = kind.atoms.iter().map(|atom| {
            let constants = self.constants(*atom);
            let fields = constants.iter().zip(columns).filter_map(|(part, column)| {
                let (name, _) = column.field.as_ref()?;
                let (_, _, value) = self.constant(*part);
                Some(quote!(#name: #value))
            });
            quote!(#variant { #(#fields),* })
        });
        let doc = format!(" What tells the atoms of {variant} apart.");
        let text = format!(" Atoms like `{}`.", self.text(kind));
        Some(quote! {
            #[doc = #doc]
            #[derive(Debug)]
            struct #variant { #(#names: #types),* }

            #[doc = #text]
            static #table: &[#variant] = &[#(#rows),*];
        })
    }

    /// `enum Running`: the law of the current atom with its state, and the atom's row.
    fn running(&self) -> TokenStream {
        let variants = self.kinds.iter().zip(1_usize..).map(|((kind, columns), number)| {
            let variant = kind_variant(number);
            let quark = self.law(kind);
            let law = quark_type(&quark.name, quark.overload);
            let row = has_rows(columns).then(|| quote!(&'static #variant,));
            let more = match kind.atoms.len() {
                1 => String::new(),
                count => format!(", and {} more like it", count - 1),
            };
            let doc = format!(" `{}`{more}", self.text(kind));
            quote! {
                #[doc = #doc]
                #variant(#row <robot::#law as runtime::Control<Output>>::Law)
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
    fn enter(&self) -> TokenStream {
        let arms = self.kinds.iter().zip(1_usize..).map(|((kind, columns), number)| {
            let (variant, table) = (kind_variant(number), kind_table(number));
            let number = Literal::usize_unsuffixed(number);
            let turned = self.lowered.turned(kind.atoms[0]) != 0.0;
            let mut last = columns.iter().rev();
            let frame = if turned { last.next() } else { None };
            let begin = frame.map_or(quote!(begin), |frame| {
                let frame = &frame.written;
                quote!(begin.turned(#frame))
            });
            let law = last.next().map(|law| &law.written);
            let law = quote!(runtime::Control::begin(&#law, y, #begin));
            if has_rows(columns) {
                quote!(#number => #table.get(row as usize).map(|row| Running::#variant(row, #law)))
            } else {
                quote!(#number => Some(Running::#variant(#law)))
            }
        });
        quote! {
            fn enter(&mut self, atom: u32, y: &Output, begin: Begin) {
                let (kind, row) = PLACES.get(atom as usize).copied().unwrap_or((0, 0));
                let running = match kind {
                    #(#arms,)*
                    _ => None,
                };
                self.running = running.unwrap_or(Running::Idle);
            }
        }
    }

    /// `fn next`: asks the plan's own interrupt, then has an arm for each kind, which asks the scopes inwards.
    fn next(&self) -> TokenStream {
        let arms = self.kinds.iter().zip(1_usize..).map(|((kind, columns), number)| {
            let variant = kind_variant(number);
            let law = if self.law(kind).completes { quote!(ref law) } else { quote!(_) };
            let row = has_rows(columns).then(|| quote!(row,));
            let questions = self.questions(kind, columns);
            quote!(Running::#variant(#row #law) => { #questions })
        });
        let plan = self.plan();
        quote! {
            #[inline(always)]
            fn next(&mut self, cursor: &mut At, y: &Output, begin: Begin, direct: bool) -> Next {
                let t = begin.now;
                #plan
                match self.running {
                    Running::Idle => {}
                    #(#arms)*
                }
                Next::Stays
            }
        }
    }

    /// Whether the plan's own interrupt has fired.
    fn plan(&self) -> Option<TokenStream> {
        let condition = self.atoms.condition(0);
        let mut constant = |constant: Constant| match constant {
            Constant::Quark(id) => made(self.lowered.quark(id), &self.lowered.quarks),
            Constant::Wait(nanos) => nanoseconds(nanos),
            Constant::Way(length) => nanometers(length),
        };
        let fired = (*condition != Condition::Null).then(|| expression(condition, 0, &mut constant))?;
        let ending = ending(&quote!(Fired), 0, self.atoms.follows(0).map(follows));
        Some(quote!(if #fired { return Next::Ends(#ending); }))
    }

    /// Whether the interrupts around an atom have fired, one after the other, and whether its law is done.
    fn questions(&self, kind: &Kind, columns: &[Column]) -> TokenStream {
        let atom = kind.atoms[0];
        let own = self.lowered.atoms[atom].scope;
        let mut written = columns.iter().map(|column| &column.written);
        let scopes = self.atoms.scopes(atom).into_iter().rev().map(|bracket| {
            let level = level(self.lowered.brackets[bracket as usize].kind);
            let condition = self.atoms.condition(bracket);
            let fired = (*condition != Condition::Null)
                .then(|| expression(condition, level, &mut |_: Constant| written.next().cloned().unwrap_or_default()));
            let follows = self.atoms.follows(bracket).map(|follows| {
                let next = written.next();
                let [from, to] = [follows.from, follows.to].map(Literal::u16_unsuffixed);
                quote!(runtime::Follows::new(#next, #from, #to))
            });
            let ending = |cause| ending(&cause, level, follows.clone());
            let fired = fired.map(|fired| (fired, ending(quote!(Fired))));
            if bracket != own {
                return fired
                    .map(|(fired, ending)| quote!(if #fired { return Next::Ends(#ending); }))
                    .unwrap_or_default();
            }
            let completed = self
                .law(kind)
                .completes
                .then(|| (quote!(runtime::Completes::completed(law, y, t)), ending(quote!(Completed))));
            let asked = fired.into_iter().chain(completed).map(|(question, ending)| {
                quote!(if #question { return runtime::Plan::end(self, cursor, #ending, y, begin, direct); })
            });
            asked.collect()
        });
        scopes.collect()
    }

    /// `fn input`: the law of the current atom.
    fn input(&self) -> TokenStream {
        let patterns = self.kinds.iter().zip(1_usize..).map(|((_, columns), number)| {
            let variant = kind_variant(number);
            let row = has_rows(columns).then(|| quote!(_,));
            quote!(Running::#variant(#row law))
        });
        quote! {
            fn input(&mut self, y: &Output, t: Nanos) -> Input {
                match &mut self.running {
                    Running::Idle => Input::default(),
                    #(#patterns => runtime::Law::input(law, y, t),)*
                }
            }
        }
    }
}

fn has_rows(columns: &[Column]) -> bool {
    columns.iter().any(|column| column.field.is_some())
}
