//! Properties of any text. libFuzzer searches for a text that violates them, and a test checks the corpus.
//!
//! Each function panics if a property does not hold.

use std::cell::RefCell;
use std::sync::LazyLock;

use mdle_compiler::alphabet::Alphabet;
use mdle_compiler::analysis::analyze;
use mdle_compiler::diagnostic::{Diagnostic, SourceId, Sources, has_errors};
use mdle_compiler::fsm::{Element, Machine};
use mdle_compiler::plan::{Condition, RecordId};
use mdle_compiler::rust::{Header, Shape, emit_as};
use mdle_compiler::syntax::{arena_for, format, outline::outline, parse as read};
use mdle_compiler::trace::Script;
use mdle_compiler::{Compiled, builtin, compile};

use crate::chance::Chance;
use crate::golden::alphabet;
use crate::pipeline::{Machines, scripted};
use crate::random_script::script;

static SIMULATOR: LazyLock<Alphabet> = LazyLock::new(|| alphabet(Some("sim")));
static EVERYTHING: LazyLock<Alphabet> = LazyLock::new(|| alphabet(None));

/// Maximum number of brackets of a plan for which Rust is emitted. `RUN` is the maximum for a plan that is run.
const EMITTED: usize = 1000;
const RUN: usize = 100;

/// Maximum number of turns of a run. It is small, because each turn may make the maximum number of transitions.
const TURNS: usize = 6;

/// Returns bytes as text, with a replacement character for each invalid sequence.
#[must_use]
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Asserts that a text has a tree or errors, that the errors are inside the text and can be shown, and that an error
/// after the last plan does not change the tree.
pub fn parse(text: &str) {
    let mut sources = Sources::default();
    sources.add("before.mdle", "Γ");
    let id = sources.add("plan.mdle", text);
    let arena = arena_for(text);
    let (file, found) = read(id, text, &arena);
    let tree = outline(&file);
    // A brace can cause two errors: it has no partner, and it belongs to no name.
    assert!(found.len() <= 2 * text.len() + 1, "{} messages", found.len());
    assert!(!file.plans.is_empty() || has_errors(&found), "no plan and no error");
    for label in found.iter().flat_map(|diagnostic| &diagnostic.labels) {
        assert!(text.get(label.span.within(id)).is_some(), "{label:?}");
    }
    shown(&sources, &found);
    if found.is_empty() {
        // An error after the plans does not change their trees.
        let flawed = format!("{text}\n§\n");
        let arena = arena_for(&flawed);
        let (file, found) = read(id, &flawed, &arena);
        assert_eq!(found.iter().map(|found| found.code.name()).collect::<Vec<_>>(), ["E0101"], "{found:?}");
        assert_eq!(outline(&file), tree);
    }
}

/// Asserts that the canonical layout of a text has the same tree and comments as the text, and remains unchanged when
/// it is laid out again. A text with errors must have no layout.
pub fn layout(text: &str) {
    let id = SourceId(0);
    let arena = arena_for(text);
    let (file, found) = read(id, text, &arena);
    let laid_out = match format(id, text) {
        Ok(laid_out) => laid_out,
        Err(errors) => return assert_eq!(errors, found),
    };
    let arena = arena_for(&laid_out);
    let (again, found) = read(id, &laid_out, &arena);
    assert_eq!(found, [], "{laid_out}");
    assert_eq!(outline(&again), outline(&file), "{laid_out}");
    assert_eq!(comments(&laid_out), comments(text), "{laid_out}");
    assert_eq!(format(id, &laid_out).as_ref(), Ok(&laid_out));
}

/// Asserts for several robots that a text has plans that can be analysed, or errors that can be shown. The formal
/// notation of a plan must be an equivalent plan.
pub fn check(text: &str) {
    for alphabet in [&*EVERYTHING, &*SIMULATOR, scripted()] {
        let all = compiled(text, alphabet);
        all.iter().for_each(|compiled| analysed(&compiled.machine));
        for Compiled { plan, machine, .. } in &all {
            let formal = plan.formal();
            let again = compiled(&formal, alphabet);
            assert_eq!(again.len(), 1, "{formal}");
            assert_eq!(again[0].plan.formal(), formal);
            assert_eq!(behavior(&again[0].machine), behavior(machine), "{formal}");
        }
    }
}

/// Asserts that a machine can be analyzed, and that the results are consistent.
fn analysed(machine: &Machine) {
    let analysis = analyze(machine);
    assert_eq!((analysis.states, analysis.atoms.len()), (machine.states(), machine.atoms().len()));
    let is_shorter = analysis.shortest.zip(analysis.longest.seconds).is_none_or(|(short, long)| short <= long);
    assert!(is_shorter && !analysis.to_json().is_empty(), "{}", analysis.to_text());
}

/// Returns the behavior of a machine, without the names of its scopes and the numbers of its records.
fn behavior(machine: &Machine) -> String {
    let place = |record: &RecordId| machine.record(*record).map(|record| (record.level, record.first));
    let marks = machine.elements().flat_map(|element| element.marks().iter().map(move |mark| (element.number(), mark)));
    let marks: Vec<_> = marks.map(|(element, mark)| (element, place(&mark.record), &mark.label, &mark.facts)).collect();
    let asks = |condition: &Condition| {
        let places = RefCell::new(Vec::new());
        condition.any(&|part| {
            if let Condition::After(after) = part {
                places.borrow_mut().push((place(&after.record), after.fact));
            }
            false
        });
        places.into_inner()
    };
    let scopes = machine.elements().filter_map(Element::interrupt);
    let scopes: Vec<_> =
        scopes.map(|own| (&own.text, &own.nested, own.memories, own.removed, asks(&own.condition))).collect();
    let laws: Vec<_> = machine.atoms().map(|atom| (atom.law_id(), atom.frame())).collect();
    let quarks: Vec<_> = machine.quarks().iter().map(|quark| &quark.text).collect();
    format!("{:?} {scopes:?} {laws:?} {marks:?} {} {quarks:?}", machine.tables(), machine.sizes().memories)
}

/// Asserts that the Rust that is emitted for a plan is valid syntax in every shape.
pub fn emit(text: &str) {
    let mut sources = Sources::default();
    sources.add("plan.mdle", text);
    for alphabet in [&*SIMULATOR, scripted()] {
        for Compiled { plan, machine, .. } in compiled(text, alphabet) {
            let header = Header { sources: &sources, file: "plan.mdle", plan: &plan.root.name };
            for shape in [Shape::Code, Shape::Rows] {
                if machine.elements().len() > EMITTED {
                    continue;
                }
                let rust = emit_as(shape, &machine, header, alphabet);
                if let Err(error) = syn::parse_file(&rust) {
                    panic!("{shape:?}: {error}\n{rust}");
                }
            }
        }
    }
}

/// Asserts that all machines print the same trace of a plan. The text is also the random seed of the script.
pub fn run(text: &str) {
    let seed = text.bytes().fold(0_u64, |seed, byte| seed.wrapping_mul(31).wrapping_add(u64::from(byte)));
    let script = script(&mut Chance::new(seed), TURNS);
    let turns = Script::read(&script).expect("a script");
    for plan in compiled(text, scripted()).iter().filter(|plan| plan.machine.elements().len() <= RUN) {
        let machines = Machines::new(plan);
        let traces = machines.traces(&turns);
        let (reference, tree) = &traces[0];
        for (machine, trace) in &traces[1..] {
            assert!(trace == tree, "{reference}:\n{}{machine}:\n{}{script}", lines(tree), lines(trace));
        }
    }
}

fn lines(trace: &[mdle_compiler::trace::TraceLine<'_>]) -> String {
    trace.iter().map(|line| format!("{line}\n")).collect()
}

/// Returns the plans of a text, and asserts that all messages about it can be shown.
fn compiled(text: &str, alphabet: &Alphabet) -> Vec<Compiled> {
    let mut sources = Sources::default();
    for file in builtin::alphabets() {
        sources.add(file.file, file.text);
    }
    let id = sources.add("plan.mdle", text);
    let (compiled, found) = compile(id, text, alphabet, None);
    shown(&sources, &found);
    assert!(compiled.is_empty() || !has_errors(&found), "a plan and an error");
    compiled
}

/// Asserts that the diagnostics are sorted, and that each can be shown as text and as JSON.
fn shown(sources: &Sources, found: &[Diagnostic]) {
    assert!(found.is_sorted_by_key(|found| found.span()), "{found:?}");
    for diagnostic in found {
        assert!(!diagnostic.message.is_empty() && !diagnostic.message.contains('\n'), "{diagnostic:?}");
        let shown = sources.render(diagnostic);
        // A diagnostic without a valid place would begin with its code.
        assert!(shown.starts_with("error[") || shown.starts_with("warning["), "{diagnostic:?}\n{shown}");
        assert!(!sources.message(diagnostic).to_json().is_empty(), "{diagnostic:?}");
    }
}

/// Returns the comments of a text without errors, in order, without spaces.
fn comments(text: &str) -> Vec<String> {
    let mut comments = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find(['/', '"']) {
        let here = &rest[at..];
        let length = if let Some(string) = here.strip_prefix('"') {
            string.find('"').map_or(here.len(), |end| end + 2)
        } else if here.starts_with("//") {
            here.find('\n').unwrap_or(here.len())
        } else if let Some(inside) = here.strip_prefix("/*") {
            inside.find("*/").map_or(here.len(), |end| end + 4)
        } else {
            1
        };
        if length > 1 && here.starts_with('/') {
            comments.push(here[..length].chars().filter(|letter| !letter.is_whitespace()).collect());
        }
        rest = &here[length..];
    }
    comments
}
