//! Compiles plans for the workload's robot, from their text to the Rust that mdlec emits.

use std::fmt::Write;

use mdle_compiler::alphabet::{self, Alphabet};
use mdle_compiler::diagnostic::Sources;
use mdle_compiler::rust::{Header, Shape, emit_as};

const ALPHABET: &str = include_str!("../alphabet.mdle");

/// Returns the text of T(N): a plan with an interrupt and N atoms, each with an end condition and a law that writes two
/// numbers.
pub fn written_out(atoms: u32) -> String {
    format!("{{ T (halt)\n{}}}\n", lines(0..atoms))
}

/// Returns the text of T(N) in which the plan's interrupt fires only when the switch is turned on.
pub fn rising(atoms: u32) -> String {
    format!("{{ T (RISING halt)\n{}}}\n", lines(0..atoms))
}

/// Returns the text of a plan with a loop of `passes` passes through two atoms.
pub fn looped(passes: u64) -> String {
    format!("{{ T (halt)\nExecPlan {passes} {{\n{}}}\n}}\n", lines(0..2))
}

fn lines(atoms: std::ops::Range<u32>) -> String {
    atoms.fold(String::new(), |mut text, atom| {
        writeln!(text, "  (Atom (reached {}) write {}.25 {atom}.5)", atom + 1, atom + 1).expect("a text takes all");
        text
    })
}

fn robot() -> Alphabet {
    let (file, found) = alphabet::read(Sources::default().add("", ""), ALPHABET);
    assert_eq!(found, [], "the workload's alphabet");
    let (alphabet, found) = alphabet::combine(file.expect("an alphabet"), &[]);
    assert_eq!(found, [], "the workload's alphabet");
    alphabet
}

/// Returns the Rust of the plan `T` in `text`, in the shape that suits its size.
pub fn emitted(text: &str) -> String {
    emitted_as(None, text)
}

/// Returns the Rust of the plan `T` in `text`, as rows of tables.
pub fn rows(text: &str) -> String {
    emitted_as(Some(Shape::Rows), text)
}

fn emitted_as(shape: Option<Shape>, text: &str) -> String {
    let robot = robot();
    let mut sources = Sources::default();
    sources.add("alphabet.mdle", ALPHABET);
    let source = sources.add("T.mdle", text);
    let (compiled, found) = mdle_compiler::compile(source, text, &robot, Some("T"));
    let messages: String = found.iter().map(|diagnostic| sources.render(diagnostic)).collect();
    let compiled = compiled.first().unwrap_or_else(|| panic!("{messages}"));
    let shape = shape.unwrap_or_else(|| Shape::of(&compiled.machine));
    emit_as(shape, &compiled.machine, Header { sources: &sources, file: "T.mdle", plan: "T" }, &robot)
}
