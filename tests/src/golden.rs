//! Results of the compiler for the plans in `plans/`, as text for snapshots.

use std::fmt::Write;

use mdle_compiler::alphabet::{self, Alphabet};
use mdle_compiler::diagnostic::{SourceId, Sources};
use mdle_compiler::rust::{Header, Shape, emit_as};
use mdle_compiler::syntax::{Arena, outline::outline, parse};
use mdle_compiler::{Compiled, builtin, compile, fsm};

use crate::repository::TextFile;

/// Returns the alphabet of a built-in target or, if `target` is `None`, of a robot with every capability.
#[must_use]
pub fn alphabet(target: Option<&str>) -> Alphabet {
    let mut sources = Sources::default();
    let placed = builtin::alphabets().iter().map(|file| (sources.add(file.file, file.text), file));
    let read = |(source, file): (SourceId, &builtin::Alphabet)| alphabet::read(source, file.text).0.expect(file.file);
    let (targets, shared): (Vec<_>, Vec<_>) = placed.partition(|(_, file)| file.target);
    let mut shared: Vec<_> = shared.into_iter().map(read).collect();
    match target.map(|name| targets.into_iter().find(|(_, file)| file.name == name).expect(name)) {
        None => Alphabet::shared(shared.swap_remove(0)),
        Some(own) => alphabet::combine(read(own), &shared).0,
    }
}

/// Compiles a file for a robot; returns its plans and the messages.
#[must_use]
pub fn judge(file: &TextFile, target: Option<&str>) -> (Vec<Compiled>, String) {
    let (sources, source) = sources(file);
    let (compiled, found) = compile(source, &file.text, &alphabet(target), None);
    let message = found.iter().map(|diagnostic| sources.render(diagnostic)).collect();
    (compiled, message)
}

/// Returns sources that contain the files of the alphabets and then this file, with the identifier of the file.
#[must_use]
pub fn sources(file: &TextFile) -> (Sources, SourceId) {
    let mut sources = Sources::default();
    for alphabet in builtin::alphabets() {
        sources.add(alphabet.file, alphabet.text);
    }
    let source = sources.add(&file.path, &file.text);
    (sources, source)
}

/// Returns the tree of a file as an outline.
#[must_use]
pub fn tree(file: &TextFile) -> String {
    outline(&parse(SourceId(0), &file.text, &Arena::new()).0)
}

/// Returns the machine of a plan as text: its states with their laws, and a line with the transitions of each
/// interrupt.
#[must_use]
pub fn machine(compiled: &Compiled) -> String {
    let file = fsm::fsm_file(&compiled.nondegenerate).expect("a small plan");
    let mut text = format!("{} states, the last of them `{}`\n", file.states.len(), file.states.last().unwrap());
    for (state, law) in file.states.iter().zip(&file.laws) {
        writeln!(text, "{state}: {law}").unwrap();
    }
    for interrupt in &file.interrupts {
        let never = if file.never.contains(&interrupt.name) { " (never)" } else { "" };
        let moves: Vec<_> = interrupt.moves.0.iter().map(|(from, to)| format!("{from}→{to}")).collect();
        writeln!(text, "{} = {}{never}: {}", interrupt.name, interrupt.text, moves.join(" ")).unwrap();
    }
    text
}

/// Returns the Rust that is emitted for a plan for the simulator.
#[must_use]
pub fn rust(file: &TextFile, compiled: &Compiled, shape: Shape) -> String {
    let name = file.path.rsplit('/').next().unwrap();
    let sources = sources(file).0;
    let header = Header { sources: &sources, file: name, plan: &compiled.plan.root.name };
    emit_as(shape, &compiled.machine, header, &alphabet(Some("sim")))
}
