//! Checks an open document as `mdlec check` does.

use std::collections::BTreeMap;

use mdle_compiler::alphabet;
use mdle_compiler::diagnostic::Sources;
use mdle_files::{FaultyFile, InputError};
use serde_json::Value;

use crate::convert::{self, Converter};
use crate::documents::{Document, Documents, is_alphabet};
use mdle_language_service::diagnostics::findings;
use mdle_language_service::lines::LineStarts;

/// Diagnostics found by one check.
#[derive(Debug, Default)]
pub(crate) struct CheckResult {
    /// Diagnostics, by the URI of the document in which they are shown.
    pub(crate) diagnostics: BTreeMap<String, Vec<Value>>,
    /// `true` if the document uses other files, or refers to files that cannot be read.
    pub(crate) uses_files: bool,
}

/// Checks the document `uri`; `book` is the address of the documentation, for links to explanations.
pub(crate) fn check(documents: &Documents, uri: &str, document: &Document, book: Option<&str>) -> CheckResult {
    if is_alphabet(&document.path) {
        return CheckResult { diagnostics: [(uri.to_owned(), of_alphabet(document))].into(), uses_files: false };
    }
    let mut plan = match documents.plan(document) {
        Ok(plan) => plan,
        Err(error) => {
            let diagnostics = [(uri.to_owned(), vec![convert::unplaced(&words(error))])];
            return CheckResult { diagnostics: diagnostics.into(), uses_files: false };
        }
    };
    let found = plan.input.check(&plan.target.alphabet);
    let findings = findings(&plan.input.sources, &found);
    let mut converter = Converter::new(documents, &plan);
    let mut diagnostics: BTreeMap<String, Vec<Value>> = BTreeMap::new();
    for finding in &findings {
        let of = converter.uri(finding.place.source).unwrap_or_else(|| uri.to_owned());
        diagnostics.entry(of).or_default().push(converter.diagnostic(finding, book));
    }
    let uses_files = plan.input.files().count() > 1 || found.iter().any(|found| found.code.name() == "E0205");
    CheckResult { diagnostics, uses_files }
}

/// Returns the diagnostics of an alphabet file.
fn of_alphabet(document: &Document) -> Vec<Value> {
    let mut sources = Sources::default();
    let (text, lines) = (document.text.as_str(), LineStarts::of(&document.text));
    let source = sources.add("alphabet.mdle", text);
    let (_, found) = alphabet::read(source, text);
    let diagnostic = |finding: mdle_language_service::diagnostics::Finding| {
        let mut value = convert::unplaced(&finding.message);
        value["range"] = convert::range(text, &lines, &finding.place.range);
        value["code"] = finding.code.name().into();
        value
    };
    findings(&sources, &found).into_iter().map(diagnostic).collect()
}

/// Returns the message about an input that cannot be checked, as `mdlec check` shows it, including the first error in
/// the file.
fn words(error: InputError) -> String {
    let own = Some(error.to_string()).filter(|own| !own.is_empty());
    let first = error.faulty_file().and_then(|FaultyFile { sources, diagnostics, .. }| {
        let first = diagnostics.first()?;
        let (file, line) = first.span().map_or(("", 0), |span| sources.line(span));
        Some(format!("{file}:{line}: {}", first.message))
    });
    own.into_iter().chain(first).collect::<Vec<_>>().join("\n")
}
