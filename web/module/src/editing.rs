//! Implements features of the page's editor. Positions consist of a line and a column in UTF-16 code units, both
//! counted from 0.

use std::collections::BTreeMap;
use std::ops::Range;

use mdle_compiler::diagnostic::{Diagnostic, SourceId};
use mdle_language_service::completion::{Item, ItemKind, completion, signature_at};
use mdle_language_service::diagnostics::{Finding, findings};
use mdle_language_service::fixes::fixes;
use mdle_language_service::formatting;
use mdle_language_service::hover::hover as about;
use mdle_language_service::lenses::runnables;
use mdle_language_service::lines::{LineStarts, Position};
use mdle_language_service::tokens::{KINDS, tokens};
use serde_json::{Value, json};

use crate::document::Document;
use crate::draft::FILE;

/// Converter between byte offsets in a text and positions.
struct OffsetConverter<'t> {
    text: &'t str,
    lines: LineStarts,
}

impl<'t> OffsetConverter<'t> {
    fn of(text: &'t str) -> Self {
        Self { text, lines: LineStarts::of(text) }
    }

    /// Returns a range as `[line, column, line, column]`, its start and its end.
    fn range(&self, range: &Range<usize>) -> Value {
        let [start, end] = [range.start, range.end].map(|byte| self.lines.position(self.text, byte));
        json!([start.line, start.character, end.line, end.character])
    }

    fn byte(&self, at: Position) -> usize {
        self.lines.byte(self.text, at)
    }
}

/// Returns the data that the editor shows. These are the diagnostics, with their fixes, of the file that is run and of
/// the file in the editor; the names of all plans in the file that is run, and of those that can be run; and the
/// semantic tokens of the file in the editor.
pub(crate) fn diagnose(document: &mut Document<'_>) -> Result<Value, String> {
    let found = document.check();
    let mut diagnostics = diagnostics(document, &found, |_| true);
    let (shown, is_read) = document.shown()?;
    if !is_read {
        // A file that the plan does not use yet.
        let found = document.check_file(shown);
        diagnostics.extend(self::diagnostics(document, &found, |source| source == shown));
    }
    let (plans, roots) = document.view(document.source, |view| {
        let plans: Vec<_> = view.own().iter().map(|plan| plan.name.node.to_owned()).collect();
        let roots: Vec<_> = runnables(view).into_iter().map(|plan| plan.name).collect();
        (plans, roots)
    });
    let text = document.sources.text(shown).to_owned();
    let places = OffsetConverter::of(&text);
    let tokens: Vec<_> = document
        .view(shown, tokens)
        .iter()
        .map(|token| json!([places.range(&token.range), KINDS.get(token.kind).copied().unwrap_or("")]))
        .collect();
    Ok(json!({ "diagnostics": diagnostics, "plans": plans, "roots": roots, "tokens": tokens }))
}

/// Returns the diagnostics that are in files that `is_wanted` accepts.
fn diagnostics(document: &Document<'_>, found: &[Diagnostic], is_wanted: impl Fn(SourceId) -> bool) -> Vec<Value> {
    let mut lines = BTreeMap::new();
    let places = findings(&document.sources, found);
    let numbered = places.iter().enumerate().filter(|(_, finding)| is_wanted(finding.place.source));
    let diagnostic = |(number, finding): (usize, &Finding)| {
        let source = finding.place.source;
        let text = document.sources.text(source);
        let places = lines.entry(source).or_insert_with(|| OffsetConverter::of(text));
        let all = 0..text.len();
        let fixes =
            fixes(&document.sources, found.get(number..=number).unwrap_or(&[]), |place| place.source == source, &all);
        let fixes: Vec<_> = fixes
            .iter()
            .filter(|fix| fix.place.source == source)
            .map(
                |fix| json!({ "title": fix.title, "range": places.range(&fix.place.range), "insert": fix.replacement }),
            )
            .collect();
        // A place in an alphabet is in no file of the page.
        let file = document.place(source);
        let here = if file.is_some() { finding.place.range.clone() } else { 0..0 };
        json!({
            "code": finding.code.name(),
            "title": finding.code.title(),
            "error": finding.is_error(),
            "file": file.unwrap_or(FILE),
            "range": places.range(&here),
            "message": finding.message,
            "fixes": fixes,
        })
    };
    numbered.map(diagnostic).collect()
}

/// Returns the completions at a position.
pub(crate) fn complete(document: &mut Document<'_>, at: Position) -> Result<Value, String> {
    let (shown, _) = document.shown()?;
    let text = document.sources.text(shown).to_owned();
    let places = OffsetConverter::of(&text);
    let completion = document.view(shown, |view| completion(view, places.byte(at)));
    let items: Vec<_> = completion.items.iter().map(item).collect();
    Ok(json!({ "range": places.range(&completion.range), "items": items }))
}

fn item(item: &Item) -> Value {
    let kind = match item.kind {
        ItemKind::Law => "function",
        ItemKind::Interrupt => "event",
        ItemKind::Signal => "variable",
        ItemKind::Plan => "class",
        ItemKind::Unit => "constant",
        ItemKind::Label => "property",
        ItemKind::Parameter => "parameter",
        ItemKind::Type => "type",
        ItemKind::Keyword => "keyword",
        ItemKind::Snippet => "snippet",
    };
    let is_snippet = item.kind == ItemKind::Snippet;
    json!({
        "label": item.label, "kind": kind, "detail": item.detail, "about": item.docs, "insert": item.insert,
        "snippet": is_snippet,
    })
}

/// Returns the hover text at a position, in Markdown, or null.
pub(crate) fn hover(document: &mut Document<'_>, at: Position) -> Result<Value, String> {
    let (shown, _) = document.shown()?;
    let text = document.sources.text(shown).to_owned();
    let places = OffsetConverter::of(&text);
    let found = document.view(shown, |view| about(view, places.byte(at)));
    Ok(found.map_or(Value::Null, |found| json!({ "range": places.range(&found.range), "text": found.text })))
}

/// Returns the signature of the call that encloses a position, or null.
pub(crate) fn signature(document: &mut Document<'_>, at: Position) -> Result<Value, String> {
    let (shown, _) = document.shown()?;
    let text = document.sources.text(shown).to_owned();
    let places = OffsetConverter::of(&text);
    let found = document.view(shown, |view| signature_at(view, places.byte(at)));
    Ok(found.map_or(
        Value::Null,
        |found| json!({ "label": found.label, "about": found.docs, "params": found.params, "active": found.active }),
    ))
}

/// Returns the edits that format a text, or null if it has errors.
pub(crate) fn format(text: &str) -> Value {
    let places = OffsetConverter::of(text);
    let edits = formatting::document(text);
    edits.map_or(Value::Null, |edits| {
        edits.iter().map(|edit| json!({ "range": places.range(&edit.range), "insert": edit.text })).collect()
    })
}
