//! Tests plans that are loaded at run time: the memory that they own, and plans that are refused.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::sync::Arc;

use mdle_compiler::fsm;
use mdle_compiler::load::{self, LoadError, Loaded};
use mdle_runtime::Plan as _;
use mdle_scripted::alphabet::Alphabet;
use mdle_tests::pipeline::{compile, scripted, sources};

/// Compiles and loads the plan `Main` of a text.
fn loaded(text: &str) -> Result<Arc<Loaded<Alphabet>>, LoadError> {
    let machine = compile(text).expect("a plan").machine;
    load::load(&machine, &sources(text), scripted()).map(Arc::new)
}

#[test]
fn a_loaded_plan_has_its_texts_and_words() {
    let plan = loaded("{ Main (a OR\n wait 2) { Sub (b) (Atom (c) seek) } (Atom (wait 1) idle) }").unwrap().plan();
    assert_eq!((plan.law(0), plan.law(1), plan.name(1), plan.condition(0)), ("seek", "idle", "Sub", "a OR wait 2"));
    assert_eq!((plan.law(9), plan.name(9), plan.condition(9)), ("", "", ""));
    let source = plan.source();
    let operands: Vec<_> = source.operands_of(0).map(|operand| (operand.written, operand.at.line)).collect();
    assert_eq!(operands, [("a", 1), ("wait 2", 2)]);
    assert_eq!(source.file(source.bracket(0).unwrap().at), "plan.mdle");
    assert_eq!((source.operand(0, 2), source.operand(9, 0), source.bracket(9)), (None, None, None));
}

#[test]
fn a_loaded_plan_runs_on_any_thread() {
    let plan = loaded("{ Main (Atom (wait 1) idle) }").unwrap();
    let law = std::thread::spawn(move || plan.plan().law(0).to_owned()).join().unwrap();
    assert_eq!(law, "idle");
}

#[test]
fn a_plan_for_another_alphabet_is_refused() {
    let text = "{ Main (Atom (a) seek) }";
    let machine = compile(text).expect("a plan").machine;
    let refused = load::load::<mdle_sim::alphabet::Alphabet>(&machine, &sources(text), scripted()).err().unwrap();
    assert_eq!(refused.to_string(), "the crate of target `sim` is bound to another alphabet: run `mdlec bind`");
    let words = fsm::words(&machine, &sources(text), scripted());
    let unbound = load::with_rows::<mdle_sim::alphabet::Alphabet>(fsm::rows(&machine), words, &machine, scripted());
    let unbound = unbound.err().unwrap();
    assert_eq!(unbound.to_string(), "the crate of the target makes no quark `a`: run `mdlec bind`");
}

#[test]
fn memories_grow_with_depth_and_not_with_length() {
    let rising: String = (0..100).map(|_| "(Atom (RISING a) seek)").collect();
    let text = format!("{{ Main {rising} }}");
    let machine = compile(&text).expect("a plan").machine;
    assert_eq!((machine.depth(), machine.sizes().memories, machine.elements().len()), (2, 1, 101));
    let size = loaded(&text).unwrap().memories();
    assert_eq!(size, 2);
}
