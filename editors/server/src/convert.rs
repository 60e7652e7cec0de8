//! Converts the results of the language features to objects of the protocol.

use std::collections::BTreeMap;
use std::ops::Range;

use mdle_compiler::diagnostic::SourceId;
use serde_json::{Value, json};

use crate::documents::{Documents, Plan};
use mdle_language_service::diagnostics::{FileRange, Finding};
use mdle_language_service::lines::{LineStarts, Position};

/// Converts places in a plan's files to objects of the protocol. The positions of the lines of each file are determined
/// only once.
#[derive(Debug)]
pub(crate) struct Converter<'d> {
    documents: &'d Documents,
    plan: &'d Plan,
    lines: BTreeMap<SourceId, LineStarts>,
}

/// Returns a position as a protocol object.
pub(crate) fn position(at: Position) -> Value {
    json!({ "line": at.line, "character": at.character })
}

/// Returns a range as a protocol object.
pub(crate) fn range(text: &str, lines: &LineStarts, range: &Range<usize>) -> Value {
    let [start, end] = [range.start, range.end].map(|byte| position(lines.position(text, byte)));
    json!({ "start": start, "end": end })
}

impl<'d> Converter<'d> {
    pub(crate) fn new(documents: &'d Documents, plan: &'d Plan) -> Self {
        Self { documents, plan, lines: BTreeMap::new() }
    }

    /// Returns the URI of a file that was read for the plan; `None` for an alphabet file.
    pub(crate) fn uri(&self, source: SourceId) -> Option<String> {
        self.plan.input.path(source).map(|path| self.documents.uri(path))
    }

    /// Converts a range in the document of the plan itself.
    pub(crate) fn own(&mut self, range: &Range<usize>) -> Value {
        self.range(&FileRange { source: self.plan.input.source, range: range.clone() })
    }

    /// Converts the range of a place in its file.
    pub(crate) fn range(&mut self, place: &FileRange) -> Value {
        let text = self.plan.input.sources.text(place.source);
        let lines = self.lines.entry(place.source).or_insert_with(|| LineStarts::of(text));
        range(text, lines, &place.range)
    }

    /// Returns the location of a place, which consists of its file and its range.
    pub(crate) fn location(&mut self, place: &FileRange) -> Option<Value> {
        Some(json!({ "uri": self.uri(place.source)?, "range": self.range(place) }))
    }

    /// Converts a finding to a diagnostic of the protocol. If the address `book` of the documentation is known, the
    /// diagnostic has a link to its explanation.
    pub(crate) fn diagnostic(&mut self, finding: &Finding, book: Option<&str>) -> Value {
        let related = finding.related.iter();
        let related: Vec<_> = related
            .filter_map(|(place, text)| {
                let text = if text.is_empty() { "here" } else { text };
                Some(json!({ "location": self.location(place)?, "message": text }))
            })
            .collect();
        let code = finding.code.name();
        let mut diagnostic = json!({
            "range": self.range(&finding.place),
            "severity": if finding.is_error() { 1 } else { 2 },
            "code": code,
            "source": SOURCE,
            "message": finding.message,
            "relatedInformation": related,
        });
        if let Some(book) = book {
            let page = format!("{}/messages.html#{}", book.trim_end_matches('/'), code.to_lowercase());
            diagnostic["codeDescription"] = json!({ "href": page });
        }
        diagnostic
    }
}

/// Value of the field `source` of all diagnostics.
const SOURCE: &str = "mdlec";

/// Returns a diagnostic without a place in the plan, such as an error in an `mdle.toml`. It is shown at the first
/// character of the document.
pub(crate) fn unplaced(message: &str) -> Value {
    let start = json!({ "line": 0, "character": 0 });
    json!({ "range": { "start": start, "end": start }, "severity": 1, "source": SOURCE, "message": message })
}
