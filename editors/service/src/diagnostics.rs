//! Diagnostics of a document and of the files that it uses, with the same content as in `mdlec check`.

use std::ops::Range;

use mdle_compiler::diagnostic::{Code, Diagnostic, Label, Severity, SourceId, Sources, Span, most_shown};

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileRange {
    /// Identifier of the file.
    pub source: SourceId,
    /// Byte range in the file.
    pub range: Range<usize>,
}

/// A diagnostic in the form that editors show.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Code of the diagnostic.
    pub code: Code,
    /// Place of the error or warning.
    pub place: FileRange,
    /// The message of the diagnostic, the text at the place, and the help, each on its own line.
    pub message: String,
    /// Places that explain the diagnostic, each with a text.
    pub related: Vec<(FileRange, String)>,
}

impl Finding {
    /// Returns `true` for an error, `false` for a warning.
    #[must_use]
    pub fn is_error(&self) -> bool {
        self.code.severity() == Severity::Error
    }
}

/// Returns the place of a span.
#[must_use]
pub fn place(sources: &Sources, span: Span) -> FileRange {
    let (source, range) = sources.range(span);
    FileRange { source, range }
}

/// Converts diagnostics to findings, up to the maximum number that is shown to a user.
#[must_use]
pub fn findings(sources: &Sources, diagnostics: &[Diagnostic]) -> Vec<Finding> {
    let shown = diagnostics.iter().take(most_shown(diagnostics));
    shown.filter_map(|diagnostic| finding(sources, diagnostic)).collect()
}

fn finding(sources: &Sources, diagnostic: &Diagnostic) -> Option<Finding> {
    let mut labels = diagnostic.labels.iter();
    let Label { span, text, .. } = labels.next()?;
    let here = Some(text.clone()).filter(|text| !text.is_empty());
    let help = diagnostic.help.iter().map(|help| format!("help: {}", help.text));
    let message: Vec<_> = std::iter::once(diagnostic.message.clone()).chain(here).chain(help).collect();
    Some(Finding {
        code: diagnostic.code,
        place: place(sources, *span),
        message: message.join("\n"),
        related: labels.map(|label| (place(sources, label.span), label.text.clone())).collect(),
    })
}
