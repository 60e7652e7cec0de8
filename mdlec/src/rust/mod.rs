//! A plan's machine as a Rust file: one construct of the file for each function here and in the files beside this one.
//!
//! The file is one module: what atoms and scopes mean, as code or as rows, and the machine's tables. It grows with the
//! text, never with loop counts.

mod arguments;
mod bind;
mod code;
mod kinds;
mod names;
mod rows;
mod scopes;
mod shared;
mod signatures;
mod tables;

use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use crate::alphabet::Alphabet;
use crate::diagnostic::{Code, Diagnostic};
use crate::fsm::Lowered;
use crate::plan::Condition;
pub use bind::bind;
use kinds::Atoms;
pub use names::plan_type;

/// What the head of the file says and the code refers to.
#[derive(Debug, Clone, Copy)]
pub struct Header<'a> {
    /// The plan's file, without folders.
    pub file: &'a str,
    /// The plan's name.
    pub plan: &'a str,
}

/// How a plan is written: what a turn does is the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Code for each atom and scope: the fastest turn, and pleasant to read.
    Code,
    /// Code for each kind of atom, and tables of what tells the atoms of a kind apart: as fast, for long plans.
    Shared,
    /// Rows of tables: rustc compiles them in no time, and a turn looks them up.
    Rows,
}

impl Shape {
    /// The most scopes, loops and atoms of a plan that becomes code: what rustc compiles in half a second.
    const CODE: usize = 64;
    /// The most parts that the arms of shared code have in all: what rustc compiles in as much.
    const SHARED: usize = 512;
    /// The most parts of one atom, so that tables do not grow with the depth of the plan.
    const WIDEST: usize = 32;

    /// The shape that suits a plan.
    #[must_use]
    pub fn of(lowered: &Lowered) -> Self {
        if lowered.brackets.len() <= Self::CODE {
            Self::Code
        } else if Atoms::new(lowered).kinds(Self::SHARED, Self::WIDEST).is_some() {
            Self::Shared
        } else {
            Self::Rows
        }
    }
}

/// The forms of a plan that cannot be emitted yet, each as an error.
#[must_use]
pub fn not_yet(lowered: &Lowered) -> Vec<Diagnostic> {
    let form = |condition: &Condition| {
        let has = |is_so: &dyn Fn(&Condition) -> bool| condition.any(&|part| is_so(part));
        if has(&|part| matches!(part, Condition::Quark(id) if lowered.quark(*id).comparison.is_some())) {
            return Some("a comparison of signals");
        }
        if has(&|part| matches!(part, Condition::Rising { .. })) {
            return Some("`RISING`");
        }
        has(&|part| matches!(part, Condition::After(_))).then_some("`after`")
    };
    let interrupts = lowered.scopes.iter().flatten().map(|scope| &scope.interrupt);
    let found = interrupts.filter_map(|interrupt| {
        let message = format!("{} cannot be compiled for a robot yet", form(&interrupt.condition)?);
        let found = Diagnostic::new(Code::E0199, message, interrupt.span, "for a later version");
        Some(found.help("`mdlec trace` runs it"))
    });
    found.collect()
}

/// Writes the file in the shape that suits its size. Its text depends on nothing but the arguments and the version of
/// the compiler.
#[must_use]
pub fn emit(lowered: &Lowered, header: Header<'_>, alphabet: &Alphabet) -> String {
    emit_as(Shape::of(lowered), lowered, header, alphabet)
}

/// Writes the file in this shape.
#[must_use]
pub fn emit_as(shape: Shape, lowered: &Lowered, header: Header<'_>, alphabet: &Alphabet) -> String {
    let target = format_ident!("{}", alphabet.crate_name);
    let plan = format_ident!("{}", plan_type(header.plan));
    let doc = format!(" The plan `{}`.", header.plan);
    let machine = match shape {
        Shape::Code => code::machine(&plan, &doc, lowered),
        Shape::Shared => shared::machine(&plan, &doc, lowered),
        Shape::Rows => rows::machine(&plan, &doc, lowered),
    };
    let same_alphabet = same_alphabet(alphabet);
    let tables = tables::tables(lowered);
    let file = quote! {
        #[allow(unreachable_pub, reason = "who includes this file says how far it reaches")]
        pub use machine::#plan;

        #[forbid(unsafe_code)]
        #[allow(unreachable_pub, reason = "who includes this file says how far it reaches")]
        #[allow(clippy::approx_constant, reason = "numbers are the plan's own")]
        #[allow(clippy::nonminimal_bool, clippy::eq_op, reason = "conditions are the plan's own")]
        #[allow(unused_variables, reason = "a scope is asked with all that any scope may need")]
        mod machine {
            use ::mdle_runtime as runtime;
            use ::mdle_runtime::fsm::{Atom, Bracket};
            use ::mdle_runtime::{Begin, Cursor, Fsm, Nanos, Next};
            use ::#target::alphabet::{self as robot, Input, Output};

            #same_alphabet
            #machine
            #tables
        }
    };
    format!("{}{}", heading(header, alphabet), pretty(file))
}

/// What does not compile where the target was bound to another alphabet than the plan was checked against.
fn same_alphabet(alphabet: &Alphabet) -> TokenStream {
    let hash = bind::hash(alphabet);
    let message = format!("the crate of target `{}` is bound to another alphabet: run `mdlec bind`", alphabet.name);
    quote!(
        const _: () = assert!(robot::HASH == #hash, #message);
    )
}

fn heading(header: Header<'_>, alphabet: &Alphabet) -> String {
    // A line break in a file's name would end the comment.
    let file = header.file.replace(char::is_control, "?");
    format!(
        "// Generated by mdlec {} from plan {} of {} for target {} (alphabet {:016x}). Do not edit.\n",
        env!("CARGO_PKG_VERSION"),
        header.plan,
        file,
        alphabet.name,
        alphabet.hash(),
    )
}

/// Lays the tokens out, with a blank line behind each item of the file and of its module. Text that does not parse is
/// given as it is, and rustc then says what is wrong with it.
fn pretty(tokens: TokenStream) -> String {
    let text = tokens.to_string();
    let text = syn::parse2(tokens).map_or(text, |file| prettyplease::unparse(&file));
    let mut spaced = String::with_capacity(text.len());
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        spaced.push_str(line);
        spaced.push('\n');
        let ends_item = matches!(line, "}" | "    }");
        if ends_item && lines.peek().is_some_and(|next| !next.ends_with('}')) {
            spaced.push('\n');
        }
    }
    spaced
}

#[cfg(test)]
mod tests {
    use super::{Header, Shape, emit};
    use crate::samples::{alphabet, compiled};

    fn rust(text: &str, file: &str) -> String {
        let compiled = compiled(text).swap_remove(0);
        emit(&compiled.lowered, Header { file, plan: &compiled.plan.root.name }, &alphabet(Some("sim")))
    }

    #[test]
    fn a_condition_of_many_operands_is_not_nested_as_deep() {
        let operands: Vec<_> = (1..=5_000).map(|seconds| format!("wait {seconds}")).collect();
        let rust = rust(&format!("{{ P (Atom ({}) stop) }}", operands.join(" OR ")), "plan.mdle");
        assert!(syn::parse_file(&rust).is_ok());
        let dense: String = rust.split_whitespace().collect();
        assert_eq!(dense.matches("cursor.since(").count(), 5_000);
    }

    #[test]
    fn a_plan_of_more_than_sixty_four_brackets_shares_code_if_its_atoms_are_alike() {
        let shape = |atoms: &str| Shape::of(&compiled(&format!("{{ P {atoms} }}"))[0].lowered);
        let alike = |atoms: usize| shape(&"(Atom (wait 1) stop)".repeat(atoms));
        assert_eq!([63, 64].map(alike), [Shape::Code, Shape::Shared]);
        // No two of these have as many operands.
        let differ = (1..64).map(|count| format!("(Atom ({}) stop)", vec!["wait 1"; count].join(" AND ")));
        assert_eq!(shape(&format!("{} (Atom (wait 1) stop)", differ.collect::<String>())), Shape::Rows);
        // And this is one kind, but too wide for a row.
        let wide = format!("(Atom ({}) stop)", vec!["wait 1"; 32].join(" AND "));
        assert_eq!(shape(&wide.repeat(64)), Shape::Rows);
    }

    #[test]
    fn the_name_of_a_file_stays_in_its_comment() {
        let rust = rust("{ P (Atom (wait 1) stop) }", "a\nfn x() {}.mdle");
        assert!(rust.lines().next().is_some_and(|line| line.ends_with("Do not edit.")), "{rust}");
    }

    #[test]
    fn loop_counts_do_not_change_what_is_emitted_but_for_their_numbers() {
        let lines = |count: &str| {
            rust(&format!("{{ P ExecPlan {count} {{ (Atom (wait 1) stop) (Atom (bumper) stop) }} }}"), "plan.mdle")
                .lines()
                .count()
        };
        assert_eq!(lines("2"), lines("1000000000000"));
    }
}
