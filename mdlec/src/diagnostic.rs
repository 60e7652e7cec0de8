//! Diagnostics: a code, what is wrong, where, and what to type instead; rendered with codespan-reporting.

mod excerpt;
mod explain;
mod help;
mod json;
mod shown;
mod sources;

use std::fmt;
use std::ops::Range;

pub use explain::{Example, Explanation};
pub use help::{Edit, Help};
pub use json::{Message, Place};
pub use sources::Sources;

/// A file that was read: where it begins if all files stand one behind the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SourceId(pub u32);

/// A stretch of a source, in bytes of all files one behind the other: trees are half spans, and are read as fast as they are small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// The first byte.
    pub start: u32,
    /// The byte behind the last.
    pub end: u32,
}

impl Span {
    /// The stretch between these two bytes of a file.
    #[must_use]
    pub fn new(source: SourceId, start: usize, end: usize) -> Self {
        let among_all = |byte| source.0.saturating_add(u32::try_from(byte).unwrap_or(u32::MAX));
        Self { start: among_all(start), end: among_all(end) }
    }

    /// The bytes of this file that it is.
    #[must_use]
    pub fn within(self, source: SourceId) -> Range<usize> {
        let in_file = |byte: u32| byte.saturating_sub(source.0) as usize;
        in_file(self.start)..in_file(self.end)
    }

    /// The stretch from the start of this one to the end of `last`, of the same source.
    #[must_use]
    pub fn to(self, last: Self) -> Self {
        Self { end: last.end.max(self.end), ..self }
    }
}

/// How bad it is, in the order in which a message beats another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The plan has a meaning, perhaps not the one that was meant.
    Warning,
    /// The plan has no meaning.
    Error,
}

/// Declares the codes, each with what it is about.
macro_rules! codes {
    ($($name:ident $title:literal,)*) => {
        /// What a diagnostic is about: E stops, W warns.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code { $(#[doc = $title] $name,)* }

        impl Code {
            /// Every code.
            pub const ALL: &[Self] = &[$(Self::$name,)*];

            /// The code as it is printed.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self { $(Self::$name => stringify!($name),)* }
            }

            /// What it is about, in a few words.
            #[must_use]
            pub fn title(self) -> &'static str {
                match self { $(Self::$name => $title,)* }
            }

            /// What `mdlec explain` says of it, from the file of its name.
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
    E0301 "wrong number of arguments",
    E0302 "argument of the wrong type",
    E0303 "unit of the wrong type",
    E0304 "value out of range",
    E0305 "invalid loop count",
    E0401 "missing capability",
    E0402 "value beyond the limits of the robot",
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
    W0301 "loop that can be skipped in one turn",
    W0302 "element that is always skipped",
    W0303 "element that is always true on entry",
    W0401 "number with an implausible unit",
}

impl Code {
    /// Whether it stops the compiler.
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

/// A place that a diagnostic points at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// Where.
    pub span: Span,
    /// What to say there; may be empty.
    pub text: String,
    /// Whether it is the place of the defect, and not one that explains it.
    pub primary: bool,
}

/// One message to the person who wrote the plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// What it is about.
    pub code: Code,
    /// What is wrong, in one line without a full stop.
    pub message: String,
    /// Where: the primary place first.
    pub labels: Vec<Label>,
    /// What to do about it; each a line below the source.
    pub help: Vec<Help>,
}

impl Diagnostic {
    /// A diagnostic at `span`, with `here` written beside the place.
    pub fn new(code: Code, message: impl Into<String>, span: Span, here: impl Into<String>) -> Self {
        let label = Label { span, text: here.into(), primary: true };
        Self { code, message: message.into(), labels: vec![label], help: Vec::new() }
    }

    /// Also points at `span`, which explains the defect.
    #[must_use]
    pub fn also(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into(), primary: false });
        self
    }

    /// The place of the defect.
    #[must_use]
    pub fn span(&self) -> Option<Span> {
        self.labels.first().map(|label| label.span)
    }
}

/// Whether any of these stops the compiler.
#[must_use]
pub fn has_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().any(|diagnostic| diagnostic.code.severity() == Severity::Error)
}

/// Puts diagnostics into the order of the sources.
pub fn sort(diagnostics: &mut [Diagnostic]) {
    diagnostics.sort_by_key(|diagnostic| (diagnostic.span(), diagnostic.code));
}
