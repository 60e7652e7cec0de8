//! Adds help to diagnostics: advice about a mistake, and an edit that corrects it.

use super::{Diagnostic, Span};

/// An edit that replaces the text of a span. The span is empty if text has to be inserted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edit {
    /// Span of the text to replace.
    pub span: Span,
    /// Text to insert.
    pub replacement: String,
}

/// One line of help.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Help {
    /// A sentence that quotes the text to type in backticks.
    pub text: String,
    /// Edit that corrects the mistake; `None` if the exact text is not known.
    pub edit: Option<Edit>,
}

impl Diagnostic {
    /// Adds a line of help.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(Help { text: text.into(), edit: None });
        self
    }

    /// Adds help that proposes to replace the text of `span`. In `words`, `{}` is a placeholder for the replacement in
    /// backticks.
    #[must_use]
    pub fn fix(mut self, words: &str, span: Span, replacement: impl Into<String>) -> Self {
        let replacement = replacement.into();
        let text = words.replacen("{}", &format!("`{}`", replacement.trim()), 1);
        self.help.push(Help { text, edit: Some(Edit { span, replacement }) });
        self
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Code, SourceId};
    use super::*;

    #[test]
    fn help_prints_the_replacement_of_its_edit() {
        let span = Span::new(SourceId(0), 4, 9);
        let diagnostic = Diagnostic::new(Code::E0104, "m", span, "").help("first").fix("write {}.", span, " 20cm/s");
        let texts: Vec<_> = diagnostic.help.iter().map(|help| help.text.as_str()).collect();
        assert_eq!(texts, ["first", "write `20cm/s`."]);
        assert_eq!(diagnostic.help[1].edit, Some(Edit { span, replacement: " 20cm/s".into() }));
    }
}
