//! Writes diagnostics as JSON for editors and other programs, one object per line (docs/src/reference/interfaces.md,
//! 2).

use serde::Serialize;

use super::{Diagnostic, Label, Severity, Sources};

/// A message. If it has neither a code nor places, it concerns the command instead of the plan.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct JsonMessage<'a> {
    /// Code of the message; `null` if the message has no code.
    pub code: Option<&'static str>,
    /// `error`, `warning` or `note`.
    pub severity: &'static str,
    /// Text of the message.
    pub message: &'a str,
    /// Places in the text: first the place of the mistake, then places that explain it.
    pub spans: Vec<FileRange<'a>>,
    /// Advice for the user.
    pub help: Vec<&'a str>,
}

/// A place in a file. Lines and columns are counted from 1, columns in characters; the end is after the last character.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FileRange<'a> {
    /// Name of the file that contains the place.
    pub file: &'a str,
    /// Line of the start.
    pub line: usize,
    /// Column of the start.
    pub column: usize,
    /// Line of the end.
    pub end_line: usize,
    /// Column of the end.
    pub end_column: usize,
    /// `true` for the place of the mistake, `false` for a place that explains it.
    pub primary: bool,
    /// Text shown beside the place; may be empty.
    pub text: &'a str,
}

impl<'a> JsonMessage<'a> {
    /// Creates a message without a code. Lines of `text` that begin with `help: ` become the help of the message.
    #[must_use]
    pub fn plain(severity: &'static str, text: &'a str) -> Self {
        let mut parts = text.split("\nhelp: ");
        let message = parts.next().unwrap_or(text);
        Self { code: None, severity, message, spans: Vec::new(), help: parts.collect() }
    }

    /// Returns the message as one line of JSON, without the line break.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Serialization fails only for maps with keys that are not strings, and there are none.
        serde_json::to_string(self).unwrap_or_default()
    }
}

impl Sources {
    /// Converts the diagnostic to a message.
    #[must_use]
    pub fn message<'a>(&'a self, diagnostic: &'a Diagnostic) -> JsonMessage<'a> {
        JsonMessage {
            code: Some(diagnostic.code.name()),
            severity: match diagnostic.code.severity() {
                Severity::Warning => "warning",
                Severity::Error => "error",
            },
            message: &diagnostic.message,
            spans: diagnostic.labels.iter().map(|label| self.place(label)).collect(),
            help: diagnostic.help.iter().map(|help| help.text.as_str()).collect(),
        }
    }

    fn place<'a>(&'a self, Label { span, text, primary }: &'a Label) -> FileRange<'a> {
        let (source, range) = self.range(*span);
        let at = |byte| self.line_and_column(source, byte);
        let ((line, column), (end_line, end_column)) = (at(range.start), at(range.end));
        FileRange { file: self.name(source), line, column, end_line, end_column, primary: *primary, text }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Code, Span};
    use super::*;

    #[test]
    fn places_are_lines_and_columns_of_characters() {
        let mut sources = Sources::default();
        let source = sources.add("größe.mdle", "{ Γ_größe\n  stöp }\n");
        let span = |start, end| Span::new(source, start, end);
        let diagnostic =
            Diagnostic::new(Code::E0201, "no `stöp`", span(15, 20), "here").also(span(2, 12), "").help("a").help("b");
        let expected = concat!(
            r#"{"code":"E0201","severity":"error","message":"no `stöp`","spans":["#,
            r#"{"file":"größe.mdle","line":2,"column":3,"end_line":2,"end_column":7,"primary":true,"text":"here"},"#,
            r#"{"file":"größe.mdle","line":1,"column":3,"end_line":1,"end_column":10,"primary":false,"text":""}],"#,
            r#""help":["a","b"]}"#
        );
        assert_eq!(sources.message(&diagnostic).to_json(), expected);
    }

    #[test]
    fn hints_of_a_plain_message_are_its_help() {
        let message = JsonMessage::plain("error", "there is no file `a`\nhelp: there is `a.mdle`");
        assert_eq!((message.message, &*message.help), ("there is no file `a`", &["there is `a.mdle`"][..]));
    }
}
