//! Emits a plan's machine as a Rust file. Each function in this module emits one construct of the file. See
//! docs/src/reference/generated_code.md, 4.
//!
//! The file is one Rust module. It contains the conditions and laws of scopes and atoms, as inline code or as table
//! rows, and the machine's tables. The size of the file grows with the text of the plan, and does not depend on loop
//! counts.

mod arguments;
mod bind;
mod bound;
mod code;
mod conditions;
mod laws;
mod layout;
mod meaning;
mod names;
mod quark_functions;
mod rows;
mod scopes;
mod signatures;
mod source;
mod tables;
mod texts;

use mdle_runtime::Printable;
use proc_macro2::TokenStream;
use quote::{format_ident, quote};

use crate::alphabet::Alphabet;
use crate::diagnostic::{Code, Diagnostic, Sources};
use crate::fsm::{self, Element, Machine};
use crate::plan::Nondegenerate;
pub use bind::bind;
pub use names::plan_type;

/// Content of an emitted file's head, and the source texts to which the code refers.
#[derive(Debug, Clone, Copy)]
pub struct Header<'a> {
    /// Texts of the plan and of the files that it uses; reports need them.
    pub sources: &'a Sources,
    /// Name of the plan's file, without folders.
    pub file: &'a str,
    /// Name of the plan.
    pub plan: &'a str,
}

/// Form of an emitted plan; all forms behave the same in every turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Inline code for each atom and scope, which has the fastest turn and is easy to read.
    Code,
    /// Table rows. rustc compiles them almost at once, but they need lookups in every turn. Used for long plans, and
    /// for plans with memories.
    Rows,
}

impl Shape {
    /// Maximum number of scopes, loops and atoms in a plan that is emitted as inline code instead of tables. rustc
    /// compiles about this number in half a second.
    const CODE: usize = 64;
    /// Maximum total number of parts of conditions in a plan that is emitted as inline code. rustc needs about half a
    /// second more for this number.
    const PARTS: usize = 512;

    /// Returns the shape for a plan, which depends on the plan's size.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let is_short = machine.elements().len() <= Self::CODE && parts(machine) <= Self::PARTS;
        if is_short && machine.sizes().memories == 0 { Self::Code } else { Self::Rows }
    }
}

/// Maximum number of scopes, loops, atoms and parts of conditions in an emitted plan. rustc would need minutes for a
/// larger plan.
const EMITTED: usize = 1 << 18;

/// Checks that a plan is not too large to be emitted.
///
/// # Errors
/// Fails with E0501 for a plan for which rustc would need minutes.
pub fn fits(plan: &Nondegenerate) -> Result<(), Diagnostic> {
    let plan = plan.plan();
    let (brackets, parts) = plan.parts().fold((0_usize, 0_usize), |(brackets, parts), part| {
        (brackets + 1, parts + part.interrupt().map_or(0, |interrupt| interrupt.condition.parts()))
    });
    if brackets.saturating_add(parts) <= EMITTED {
        return Ok(());
    }
    let message = format!(
        "this plan has {brackets} atoms, scopes and loops, and conditions of {parts} parts; Rust is emitted for {EMITTED} in all"
    );
    let help = "use a loop where the same is written many times, or cut the plan into several";
    Err(Diagnostic::new(Code::E0501, message, plan.root.span, "this plan").help(help))
}

/// Returns the number of parts of all conditions.
fn parts(machine: &Machine) -> usize {
    machine.elements().filter_map(Element::interrupt).map(|interrupt| interrupt.condition.parts()).sum()
}

/// Writes the file in the shape that the plan's size determines. The text depends only on the arguments and on the
/// version of the compiler.
#[must_use]
pub fn emit(machine: &Machine, header: Header<'_>, alphabet: &Alphabet) -> String {
    emit_as(Shape::of(machine), machine, header, alphabet)
}

/// Writes the file in this shape. A plan with memories is always written as table rows.
#[must_use]
pub fn emit_as(shape: Shape, machine: &Machine, header: Header<'_>, alphabet: &Alphabet) -> String {
    let target = format_ident!("{}", alphabet.crate_name);
    let plan = format_ident!("{}", plan_type(header.plan));
    let doc = format!(" The plan `{}`.", header.plan);
    let paths = tables::paths(machine, alphabet);
    // A plan with memories is always emitted as rows.
    let meaning = match if machine.sizes().memories > 0 { Shape::Rows } else { shape } {
        Shape::Code => code::machine(&plan, &doc, machine, paths.as_ref()),
        Shape::Rows => rows::machine(&plan, &doc, machine, alphabet, paths.as_ref()),
    };
    let same_alphabet = same_alphabet(alphabet);
    let tables = tables::tables(machine);
    let source = source::source(&fsm::words(machine, header.sources, alphabet));
    let file = quote! {
        #[allow(unreachable_pub, reason = "the including module decides the visibility")]
        pub use machine::#plan;

        #[forbid(unsafe_code)]
        #[allow(unreachable_pub, reason = "the including module decides the visibility")]
        #[allow(clippy::approx_constant, reason = "numbers are the plan's own")]
        #[allow(clippy::nonminimal_bool, clippy::eq_op, reason = "conditions are the plan's own")]
        #[allow(unused_variables, reason = "all functions of scopes have the same parameters")]
        mod machine {
            use ::mdle_runtime as runtime;
            use ::mdle_runtime::fsm::{Atom, Bracket};
            use ::mdle_runtime::{Begin, Cursor, Fsm, Nanos};
            use ::#target::alphabet::{self as robot, Input, Output};

            #same_alphabet
            #meaning
            #tables
            #source
        }
    };
    format!("{}{}", heading(header, alphabet), layout::file_text(file))
}

/// Emits an assertion that does not compile if the target was built with an alphabet other than the one against which
/// the plan was checked.
fn same_alphabet(alphabet: &Alphabet) -> TokenStream {
    let hash = bind::hash(alphabet);
    let message = format!("the crate of target `{}` is bound to another alphabet: run `mdlec bind`", alphabet.name);
    quote!(
        const _: () = assert!(robot::HASH == #hash, #message);
    )
}

fn heading(header: Header<'_>, alphabet: &Alphabet) -> String {
    format!(
        "// Generated by mdlec {} from plan {} of {} for target {} (alphabet {:016x}). Do not edit.\n",
        env!("CARGO_PKG_VERSION"),
        header.plan,
        // A line break would end the comment.
        Printable(header.file),
        alphabet.name,
        alphabet.hash(),
    )
}

#[cfg(test)]
mod tests {
    use super::{Header, Shape, bind, emit, emit_as};
    use crate::diagnostic::Sources;
    use crate::samples::{alphabet, compiled, sources};

    /// A plan with every operator of conditions, nested in each other, and with frames.
    const OPERATORS: &str = "{ P (bumper AND (wait 1 OR NOT wait 2) OR NOT bumper AND t < 3)
  (Atom (atIsection 1000 AND (r3 < r5 OR NOT atIsection 0100)) stop)
  { Q (null) FRAME 90deg (Atom (null) rotate 10) }
}";

    #[test]
    fn conditions_in_every_shape() {
        let compiled = compiled(OPERATORS).swap_remove(0);
        for shape in [Shape::Code, Shape::Rows] {
            let sources = Sources::default();
            let header = Header { sources: &sources, file: "plan.mdle", plan: "P" };
            let rust = emit_as(shape, &compiled.machine, header, &alphabet(Some("sim")));
            let body = rust.split_once("/// The plan `P`.").expect("a plan").1;
            insta::assert_snapshot!(format!("conditions-{shape:?}"), body.split_once("const FSM").expect("tables").0);
        }
    }

    #[test]
    fn a_plan_says_once_which_paths_it_replays() {
        let text = "{ P (bumper) (Atom (null) path hall) (Atom (null) path \"a b.csv\") (Atom (wait 5) path(hall)) }";
        let compiled = compiled(text).swap_remove(0);
        for (shape, before) in
            [(Shape::Code, "fnpaths(&self)->&[&'staticstr]{&["), (Shape::Rows, "source:SOURCE,paths:&[")]
        {
            let sources = Sources::default();
            let header = Header { sources: &sources, file: "plan.mdle", plan: "P" };
            let rust = emit_as(shape, &compiled.machine, header, &alphabet(Some("sim")));
            let dense: String = rust.split_whitespace().collect();
            assert!(dense.contains(&format!("{before}\"ab.csv\",\"hall\"]")), "{shape:?}: {rust}");
            assert!(dense.contains("fnpaths(&self)->&[&'staticstr]{"), "{shape:?}: {rust}");
        }
        assert!(!rust("{ P (Atom (wait 1) stop) }", "plan.mdle").contains("fn paths"));
    }

    #[test]
    fn quarks_of_one_name_are_numbered() {
        let text = "target t : crate t; control go(to: length m); control go(to: module); control go(to: angle deg);";
        let own = crate::alphabet::read(crate::diagnostic::SourceId(0), text).0.expect("an alphabet");
        let bound = bind(&crate::alphabet::combine(own, &[]).0);
        let line = |quark: &str| bound.contains(&format!("        \"go\" => {quark},\n"));
        assert_eq!(["Go(go)", "Go2(go2)", "Go3(go3)", "Go4(go4)"].map(line), [true, true, true, false]);
    }

    #[test]
    fn what_is_remembered_is_in_rows() {
        let rust =
            rust("{ P L: (Atom (RISING (bumper OR wait 4)) stop) (Atom (after L OR wait 1) stop) }", "plan.mdle");
        let rows = rust.split_once("static ROWS").expect("rows").1;
        insta::assert_snapshot!(rows.split_once("texts:").expect("texts").0);
    }

    fn rust(text: &str, file: &str) -> String {
        let compiled = compiled(text).swap_remove(0);
        let (mut sources, name) = (sources(), &compiled.plan.root.name);
        sources.add("plan.mdle", text);
        emit(&compiled.machine, Header { sources: &sources, file, plan: name }, &alphabet(Some("sim")))
    }

    #[test]
    fn a_condition_of_many_operands_is_not_nested_as_deep() {
        let operands: Vec<_> = (1..=5_000).map(|seconds| format!("wait {seconds}")).collect();
        let compiled = compiled(&format!("{{ P (Atom ({}) stop) }}", operands.join(" OR "))).swap_remove(0);
        let sources = Sources::default();
        let header = Header { sources: &sources, file: "plan.mdle", plan: "P" };
        // `emit` would choose rows for this plan.
        let rust = emit_as(Shape::Code, &compiled.machine, header, &alphabet(Some("sim")));
        assert!(syn::parse_file(&rust).is_ok());
        let dense: String = rust.split_whitespace().collect();
        assert_eq!(dense.matches("cursor.since(").count(), 5_000);
    }

    #[test]
    fn long_plans_and_memories_are_rows() {
        let shape = |atoms: &str| Shape::of(&compiled(&format!("{{ P {atoms} }}"))[0].machine);
        let atoms = |count: usize| shape(&"(Atom (wait 1) stop)".repeat(count));
        assert_eq!([63, 64].map(atoms), [Shape::Code, Shape::Rows]);
        let operands = |count| shape(&format!("(Atom ({}) stop)", vec!["wait 1"; count].join(" OR ")));
        // An operator, the operands, and the plan's own null interrupt.
        assert_eq!([510, 511].map(operands), [Shape::Code, Shape::Rows]);
        assert_eq!(shape("(Atom (RISING bumper) stop)"), Shape::Rows, "a memory in a short plan");
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
