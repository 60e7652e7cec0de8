//! Diagnostics: a code, what is wrong, where, and what to type instead; rendered with codespan-reporting.

mod explain;
mod json;
mod shown;
mod sources;

use std::fmt;
use std::ops::Range;

pub use explain::{Example, Explanation};
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
    E0101 "a character that no MDLe text has",
    E0102 "something else could stand here",
    E0103 "a bracket without its partner",
    E0104 "a number that touches what follows it",
    E0105 "a comment or string that does not end",
    E0106 "brackets nested too deep",
    E0107 "a file without a plan",
    E0108 "nothing to run",
    E0109 "text that is not UTF-8",
    E0201 "an unknown name",
    E0202 "a plan that contains itself",
    E0203 "a name that stands for two things",
    E0204 "a quark of the other kind",
    E0205 "a file that cannot be used",
    E0206 "files that use each other",
    E0207 "a cause that is none",
    E0301 "the wrong number of arguments",
    E0302 "an argument of the wrong type",
    E0303 "a unit of the wrong kind",
    E0304 "a value out of range",
    E0305 "a loop count that is none",
    E0401 "a robot that has not what this needs",
    E0402 "a value that this robot cannot do",
    E0501 "a plan of too many states",
    E0502 "an expanded form that is too large",
    E0601 "an alphabet that makes no sense",
    E0901 "a machine that is not that of its plan",
    W0101 "an interrupt that an outer one repeats",
    W0201 "a plan that nothing ever ends",
    W0202 "something that is never reached",
    W0203 "a condition that is always or never true",
    W0204 "a condition that an outer one shadows",
    W0205 "a condition that is true only when an outer one is",
    W0206 "a timer that an outer timer always beats",
    W0301 "a loop that can be skipped whole in one turn",
    W0302 "a neighbour that is always skipped",
    W0303 "an element that is true at once wherever it is entered",
    W0401 "a number that looks like another unit",
}

impl Code {
    /// Whether it stops the compiler.
    #[must_use]
    pub fn severity(self) -> Severity {
        if self.name().starts_with('W') { Severity::Warning } else { Severity::Error }
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
    pub help: Vec<String>,
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

    /// Also says what to do.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(text.into());
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
