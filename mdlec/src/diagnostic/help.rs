//! Help: what to do about a defect, and the edit that does it.

use super::{Diagnostic, Span};

/// Replaces the text of a span, which is empty where something is missing.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edit {
    /// The text to replace.
    pub span: Span,
    /// The text to put there.
    pub replacement: String,
}

/// One line of help.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Help {
    /// A sentence; it quotes what to type between backticks.
    pub text: String,
    /// The edit that ends the defect, where the help knows it to the letter.
    pub edit: Option<Edit>,
}

impl Diagnostic {
    /// Also says what to do.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help.push(Help { text: text.into(), edit: None });
        self
    }

    /// Also proposes to replace what `span` holds. In `words`, `{}` stands for the replacement between backticks.
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
