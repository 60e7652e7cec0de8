//! Compiles the plans of unit tests.

use mdle_compiler::alphabet::{self, Alphabet};
use mdle_compiler::diagnostic::{Sources, has_errors};
use mdle_compiler::{Compiled, builtin, compile};

/// Compiles a text without errors, for a robot with every capability.
pub(crate) fn compiled(text: &str) -> Vec<Compiled> {
    let mut sources = Sources::default();
    let atoms = builtin::alphabets().iter().find(|file| !file.target).unwrap();
    let (shared, found) = alphabet::read(sources.add(atoms.file, atoms.text), atoms.text);
    assert_eq!(found, []);
    let source = sources.add("plan.mdle", text);
    let (compiled, found) = compile(source, text, &Alphabet::shared(shared.unwrap()), None);
    assert!(!has_errors(&found), "{found:?}");
    compiled
}
