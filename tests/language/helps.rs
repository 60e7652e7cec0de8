//! Tests the help of diagnostics: each proposed edit removes its error, and each text that a help quotes can be parsed.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::LazyLock;

use mdle_compiler::alphabet::Alphabet;
use mdle_compiler::diagnostic::{Code, Diagnostic, Edit, SourceId, Sources};
use mdle_compiler::{builtin, compile};
use mdle_tests::golden::alphabet;
use mdle_tests::texts;

static EVERYTHING: LazyLock<Alphabet> = LazyLock::new(|| alphabet(None));

/// Returns the diagnostics of a text, and the identifier of its file.
fn judged(text: &str) -> (SourceId, Vec<Diagnostic>) {
    let mut sources = Sources::default();
    for file in builtin::alphabets() {
        sources.add(file.file, file.text);
    }
    let id = sources.add("plan.mdle", text);
    (id, compile(id, text, &EVERYTHING, None).1)
}

fn all_texts() -> BTreeSet<String> {
    let texts = texts::kept().into_iter().chain(texts::literals()).map(|(_, text)| text);
    texts.filter(|text| text.len() < 20_000).collect()
}

/// Returns the range of a diagnostic after an edit whose replacement has the length `length`. If the range touches the
/// edit, returns the range of the replacement.
fn moved(place: &Range<usize>, edit: &Range<usize>, length: usize) -> Range<usize> {
    if place.end <= edit.start && place.start < edit.start {
        return place.clone();
    }
    if place.start >= edit.end && place.start > edit.start {
        let moved = |at: usize| at + length - edit.len();
        return moved(place.start)..moved(place.end);
    }
    edit.start..edit.start + length
}

/// Returns a diagnostic that the edit should have removed but did not, with the edited text; `None` if there is none.
fn remaining(
    text: &str,
    id: SourceId,
    diagnostic: &Diagnostic,
    edit: &Edit,
    is_only: bool,
) -> Option<(String, Diagnostic)> {
    let range = edit.span.within(id);
    let mut edited = text.to_owned();
    edited.replace_range(range.clone(), &edit.replacement);
    let place = moved(&diagnostic.span()?.within(id), &range, edit.replacement.len());
    let (id, found) = judged(&edited);
    let is_same = |found: &Diagnostic| {
        let here = found.span().map_or(0, |span| span.within(id).start);
        let is_here = (place.start..place.end.max(place.start + 1)).contains(&here);
        // If the diagnostic was the only error of its kind, the edited text must have no such error.
        let is_new = is_only && found.code.is_notation() && found.code != Code::E0108;
        found.code == diagnostic.code && is_here && (found.message == diagnostic.message || !place.is_empty()) || is_new
    };
    let still = found.into_iter().find(is_same)?;
    Some((edited, still))
}

#[test]
fn edits_end_the_defect() {
    let mut edits = 0;
    let mut failures = Vec::new();
    for text in all_texts() {
        let (id, found) = judged(&text);
        let notation = found.iter().filter(|found| found.code.is_notation()).count();
        for diagnostic in &found {
            // When a bracket gets its partner, further errors may appear.
            let is_only = diagnostic.code.is_notation() && diagnostic.code != Code::E0103 && notation == 1;
            for edit in diagnostic.help.iter().filter_map(|help| help.edit.as_ref()) {
                edits += 1;
                if let Some((edited, still)) = remaining(&text, id, diagnostic, edit, is_only) {
                    failures.push(format!(
                        "{text}\n{}: {}\n→ {edited}\n{}: {}",
                        diagnostic.code, diagnostic.message, still.code, still.message
                    ));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{} of {edits}:\n{}", failures.len(), failures.join("\n====\n"));
    assert!(edits > 300, "{edits} edits");
}

/// Returns `true` if a quoted text is valid MDLe in some place of a plan: as a file, an element, a header, a condition
/// or a law.
fn can_be_read(quoted: &str) -> bool {
    let fillings = [" (Atom (wait 5) stop) ", " (wait 5) stop", "wait 5", "stop"];
    let places = [
        "_",
        "{ P _ }",
        "{ P (null) _ }",
        "{ P _ (Atom (wait 5) stop) }",
        "{ P (Atom (_) stop) }",
        "{ P (Atom (null) _) }",
        "{ P (Atom (wait 5) stop)_ }",
        "{ P (_ (wait 5) stop) }",
        "{ Group [robot1 robot2] P (_ OR wait 2min) (Atom (wait 5) stop) }",
    ];
    let is_sound = |text: &str| !judged(text).1.iter().any(|found| found.code.is_notation());
    fillings
        .iter()
        .any(|filling| places.iter().any(|place| is_sound(&place.replace('_', &quoted.replace('…', filling)))))
}

#[test]
fn quoted_examples_can_be_read() {
    let mut quoted = BTreeSet::new();
    for text in all_texts() {
        let helps = judged(&text).1.into_iter().flat_map(|diagnostic| diagnostic.help);
        for help in helps.filter(|help| help.edit.is_none()) {
            let parts = help.text.split('`').skip(1).step_by(2);
            let is_example = |part: &&str| {
                ["(Atom", "ExecPlan", "FRAME", " OR ", " AND ", "NOT ", "RISING "]
                    .iter()
                    .any(|word| part.contains(word))
                    && part.contains(' ')
                    || part.starts_with("{ ")
            };
            // `<v>` is a placeholder for a value that only the author knows.
            quoted.extend(parts.filter(is_example).filter(|part| !part.contains("(<")).map(str::to_owned));
        }
    }
    assert!(quoted.len() > 50, "{} examples", quoted.len());
    let wrong: Vec<_> = quoted.iter().filter(|part| !can_be_read(part)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
