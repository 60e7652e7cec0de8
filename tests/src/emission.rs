//! Emits the Rust of a plan for the target `scripted`, or for a robot with any other alphabet.

use mdle_compiler::alphabet::{Alphabet, combine, read};
use mdle_compiler::diagnostic::{SourceId, Sources};
use mdle_compiler::fsm::Machine;
use mdle_compiler::rust::{Header, Shape, emit, emit_as};

use crate::pipeline::scripted;

/// Returns the emitted file of the plan `Main` for the target `scripted`.
#[must_use]
pub fn emitted(plan: &str) -> String {
    emitted_for(scripted(), plan)
}

/// Returns the emitted file of the plan `Main` for the target `scripted`, in this shape.
#[must_use]
pub fn emitted_as(shape: Shape, plan: &str) -> String {
    let sources = sources(plan);
    emit_as(shape, &machine(scripted(), plan), header(&sources), scripted())
}

/// Returns the emitted file of the plan `Main` for a robot with this alphabet, in the shape that suits the plan.
#[must_use]
pub fn emitted_for(alphabet: &Alphabet, plan: &str) -> String {
    let sources = sources(plan);
    emit(&machine(alphabet, plan), header(&sources), alphabet)
}

/// Returns the alphabet of a robot with these quarks.
///
/// # Panics
/// If the declarations have errors.
#[must_use]
pub fn alphabet(declarations: &str) -> Alphabet {
    let text = format!("target t : crate t, period 1s; {declarations}");
    let (alphabet, found) = combine(read(SourceId(0), &text).0.expect("an alphabet"), &[]);
    assert_eq!(found, []);
    alphabet
}

fn machine(alphabet: &Alphabet, plan: &str) -> Machine {
    let (mut compiled, found) = mdle_compiler::compile(SourceId(0), plan, alphabet, Some("Main"));
    assert!(!compiled.is_empty(), "{plan}: {found:?}");
    compiled.swap_remove(0).machine
}

fn sources(plan: &str) -> Sources {
    let mut sources = Sources::default();
    sources.add("plan.mdle", plan);
    sources
}

fn header(sources: &Sources) -> Header<'_> {
    Header { sources, file: "plan.mdle", plan: "Main" }
}
