//! Diagnostics: messages with a code, places in the text, and advice. They are rendered with codespan-reporting.

mod excerpt;
mod explain;
mod help;
mod json;
mod printable_file;
mod sources;

use std::fmt;
use std::ops::Range;

pub use explain::{Example, Explanation};
pub use help::{Edit, Help};
pub use json::{FileRange, JsonMessage};
pub use sources::Sources;

/// Identifier of a source file: the byte offset of the file in the concatenation of all files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SourceId(pub u32);

/// A range of a source's text, given by byte offsets in the concatenation of all files. Half of a syntax tree consists
/// of spans, so their small size makes the parser fast.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// Byte offset of the span's start.
    pub start: u32,
    /// Byte offset of the first byte after the span.
    pub end: u32,
}

impl Span {
    /// Creates the span between two byte offsets of a file.
    #[must_use]
    pub fn new(source: SourceId, start: usize, end: usize) -> Self {
        let among_all = |byte| source.0.saturating_add(u32::try_from(byte).unwrap_or(u32::MAX));
        Self { start: among_all(start), end: among_all(end) }
    }

    /// Returns the byte range of the span within this file.
    #[must_use]
    pub fn within(self, source: SourceId) -> Range<usize> {
        let in_file = |byte: u32| byte.saturating_sub(source.0) as usize;
        in_file(self.start)..in_file(self.end)
    }

    /// Returns the span from the start of this span to the end of `last`, in the same source.
    #[must_use]
    pub fn to(self, last: Self) -> Self {
        Self { end: last.end.max(self.end), ..self }
    }
}

/// Severity of a diagnostic, in ascending order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The plan is valid, but may not mean what its author intended.
    Warning,
    /// The plan is invalid.
    Error,
}

/// Declares the codes, each with its title.
macro_rules! codes {
    ($($name:ident $title:literal,)*) => {
        /// Code of a diagnostic. Codes with E are errors, which stop the compiler; codes with W are warnings.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code { $(#[doc = $title] $name,)* }

        impl Code {
            /// Every code.
            pub const ALL: &[Self] = &[$(Self::$name,)*];

            /// Returns the name of the code, as it is printed.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self { $(Self::$name => stringify!($name),)* }
            }

            /// Returns the title of the code, a noun phrase.
            #[must_use]
            pub fn title(self) -> &'static str {
                match self { $(Self::$name => $title,)* }
            }

            /// Returns the text of `mdlec explain`, which comes from the file named after the code.
            #[must_use]
            pub fn explanation(self) -> Explanation {
                Explanation(match self {
                    $(Self::$name => include_str!(concat!("diagnostic/explanations/", stringify!($name), ".md")),)*
                })
            }
        }
    };
}

codes! {
    E0101 "unexpected character",
    E0102 "unexpected token",
    E0103 "unmatched bracket",
    E0104 "malformed number",
    E0105 "unterminated comment or text",
    E0106 "brackets nested too deep",
    E0107 "missing plan",
    E0108 "empty body",
    E0109 "invalid UTF-8",
    E0201 "unknown name",
    E0202 "plan that contains itself",
    E0203 "duplicate name",
    E0204 "quark of the wrong kind",
    E0205 "unusable file",
    E0206 "circular use of files",
    E0207 "invalid cause",
    E0208 "invalid group",
    E0209 "condition that a group cannot read",
    E0301 "wrong number of arguments",
    E0302 "argument of the wrong type",
    E0303 "unit of the wrong type",
    E0304 "value out of range",
    E0305 "invalid loop count",
    E0306 "invalid formation",
    E0401 "missing capability",
    E0402 "value beyond the limits of the robot",
    E0403 "modules in an executable",
    E0501 "too many states",
    E0502 "expanded form too large",
    E0601 "invalid alphabet",
    E0901 "machine that differs from its plan",
    W0101 "repeated interrupt",
    W0201 "plan that never ends",
    W0202 "unreachable element",
    W0203 "condition that is always or never true",
    W0204 "condition shadowed by an outer one",
    W0205 "condition implied by an outer one",
    W0206 "timer that an outer timer precedes",
    W0207 "`FRAME here` without effect",
    W0208 "drive without a limit of time",
    W0209 "wait for a robot without a limit of time",
    W0210 "sonars that cannot be aligned",
    W0301 "loop that can be skipped in one turn",
    W0302 "element that is always skipped",
    W0303 "element that is always true on entry",
    W0401 "number with an implausible unit",
}

impl Code {
    /// Returns the severity of the code: an error stops the compiler.
    #[must_use]
    pub fn severity(self) -> Severity {
        if self.name().starts_with('W') { Severity::Warning } else { Severity::Error }
    }
}

impl Code {
    /// Returns `true` for errors in the notation: text that is not MDLe.
    #[must_use]
    pub fn is_notation(self) -> bool {
        self.name().starts_with("E01")
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A place in the text to which a diagnostic refers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// Span of the place.
    pub span: Span,
    /// Text shown beside the place; may be empty.
    pub text: String,
    /// `true` for the place of the mistake, `false` for a place that explains it.
    pub primary: bool,
}

/// A message to the author of the plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// Code of the diagnostic.
    pub code: Code,
    /// Description of the mistake, in one line without a full stop.
    pub message: String,
    /// Places, the primary one first.
    pub labels: Vec<Label>,
    /// Advice for the user; each entry is a line below the source.
    pub help: Vec<Help>,
}

impl Diagnostic {
    /// Creates a diagnostic at `span`; `here` is the text that is shown beside this place.
    pub fn new(code: Code, message: impl Into<String>, span: Span, here: impl Into<String>) -> Self {
        let label = Label { span, text: here.into(), primary: true };
        Self { code, message: message.into(), labels: vec![label], help: Vec::new() }
    }

    /// Adds a further place to the diagnostic. The text at `span` explains the mistake.
    #[must_use]
    pub fn also(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into(), primary: false });
        self
    }

    /// Returns the place of the mistake; `None` if the diagnostic has no places.
    #[must_use]
    pub fn span(&self) -> Option<Span> {
        self.labels.first().map(|label| label.span)
    }
}

/// Returns `true` if at least one of the diagnostics is an error.
#[must_use]
pub fn has_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().any(|diagnostic| diagnostic.code.severity() == Severity::Error)
}

/// Maximum number of diagnostics that are shown to people.
const SHOWN: usize = 100;
/// Maximum number of diagnostics that are shown to people if there are more errors of notation than this number. The
/// file is then probably not a plan.
const SHOWN_OF_NO_PLAN: usize = 10;

/// Returns the number of these diagnostics that may be shown to people.
#[must_use]
pub fn most_shown(diagnostics: &[Diagnostic]) -> usize {
    let notation = diagnostics.iter().filter(|diagnostic| diagnostic.code.is_notation()).count();
    if notation > SHOWN_OF_NO_PLAN { SHOWN_OF_NO_PLAN } else { SHOWN }
}

/// Decides whether a plan with these diagnostics may be used. It must have no errors and, if `deny_warnings` is `true`,
/// no warnings.
///
/// # Errors
/// Returns the number of errors, or of denied warnings, as text.
pub fn judged(diagnostics: &[Diagnostic], deny_warnings: bool) -> Result<(), String> {
    let count = |severity| diagnostics.iter().filter(|found| found.code.severity() == severity).count();
    match (count(Severity::Error), count(Severity::Warning)) {
        (0, warnings) if deny_warnings && warnings > 0 => {
            Err(format!("{}, and `--deny-warnings` counts them as errors", number(warnings, "warning")))
        }
        (0, _) => Ok(()),
        (errors, _) => Err(number(errors, "error")),
    }
}

/// Returns a number followed by its noun: `1 error`, `2 errors`.
fn number(count: usize, thing: &str) -> String {
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
}

/// Sorts diagnostics in the order of the sources.
pub fn sort(diagnostics: &mut [Diagnostic]) {
    diagnostics.sort_by_key(|diagnostic| (diagnostic.span(), diagnostic.code));
}
