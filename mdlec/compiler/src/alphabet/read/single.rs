//! Reads single tokens of an alphabet file, and reports unexpected tokens.

use super::super::token::Token;
use super::{Defect, Read, Reader};
use crate::diagnostic::{Code, Diagnostic, Span};

impl<'t> Reader<'t> {
    pub(super) fn value(&mut self) -> Read<f64> {
        let (digits, span) = self.number()?;
        match digits.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) | Err(_) => self.defect(span, "this number is too large", ""),
        }
    }

    pub(super) fn number(&mut self) -> Read<(String, Span)> {
        self.text_of(Token::Number)
    }

    pub(super) fn name(&mut self) -> Read<(String, Span)> {
        let (name, span) = self.word()?;
        if name.contains('/') {
            return self.defect(span, &format!("`{name}` cannot be a name"), "only units have a `/`");
        }
        Ok((name, span))
    }

    /// Reads the name of a crate, in the form that cargo and Rust allow.
    pub(super) fn crate_name(&mut self) -> Read<String> {
        let (name, span) = self.word()?;
        let is_ascii = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
        // `gen` is a keyword that syn does not know yet.
        let is_word_of_rust = name == "gen" || syn::parse_str::<syn::Ident>(&name).is_err();
        if is_ascii && !is_word_of_rust {
            return Ok(name);
        }
        let help = "take letters from a to z, digits and `_`, and no word of Rust's own, as in `crate rover_target`";
        self.defect(span, &format!("`{name}` cannot be the name of a crate"), help)
    }

    pub(super) fn word(&mut self) -> Read<(String, Span)> {
        self.text_of(Token::Word)
    }

    pub(super) fn text_of(&mut self, token: Token) -> Read<(String, Span)> {
        match self.tokens.get(self.at) {
            Some((found, span)) if *found == token => {
                self.at += 1;
                Ok((self.slice(*span).to_owned(), *span))
            }
            Some(_) | None => self.unexpected(token.words()),
        }
    }

    pub(super) fn keyword(&mut self, word: &str) -> Read<()> {
        if self.peek_word() == Some(word) {
            self.at += 1;
            return Ok(());
        }
        self.unexpected(&format!("`{word}`"))
    }

    pub(super) fn require(&mut self, token: Token) -> Read<()> {
        if self.take(token) { Ok(()) } else { self.unexpected(token.words()) }
    }

    pub(super) fn take(&mut self, token: Token) -> bool {
        let found = self.tokens.get(self.at).is_some_and(|(found, _)| *found == token);
        self.at += usize::from(found);
        found
    }

    pub(super) fn peek_word(&self) -> Option<&'t str> {
        let (token, span) = self.tokens.get(self.at)?;
        (*token == Token::Word).then(|| self.slice(*span))
    }

    pub(super) fn slice(&self, span: Span) -> &'t str {
        self.text.get(span.within(self.source)).unwrap_or("")
    }

    pub(super) fn unexpected<T>(&mut self, expected: &str) -> Read<T> {
        let end = self.text.len();
        let (span, found) = match self.tokens.get(self.at) {
            Some((_, span)) => (*span, format!("`{}`", self.slice(*span))),
            None => (Span::new(self.source, end, end), "the end of the file".to_owned()),
        };
        self.found.push(Diagnostic::new(Code::E0601, format!("expected {expected}, found {found}"), span, "here"));
        Err(Defect)
    }

    pub(super) fn defect<T>(&mut self, span: Span, message: &str, help: &str) -> Read<T> {
        let report = Diagnostic::new(Code::E0601, message, span, "here");
        self.found.push(if help.is_empty() { report } else { report.help(help) });
        Err(Defect)
    }

    /// Skips all tokens up to the next `;`.
    pub(super) fn skip(&mut self) {
        let rest = self.tokens.get(self.at..).unwrap_or_default();
        let end = rest.iter().position(|(token, _)| *token == Token::Semicolon);
        self.at = end.map_or(self.tokens.len(), |offset| self.at + offset + 1);
    }
}
