//! Tokens of an alphabet file. Unlike in a plan, `;` ends a declaration.

use logos::{Lexer, Logos};

use super::name::name;

/// Kind of a token.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Logos)]
#[logos(skip r"[ \t\r\n\u{FEFF}]+")]
#[logos(skip(r"//([^/\n][^\n]*)?", allow_greedy = true))]
pub(super) enum Token {
    /// A doc comment, `/// …`.
    #[regex(r"///[^\n]*", allow_greedy = true)]
    Doc,
    /// A name, a keyword or a unit such as `cm/s`.
    #[regex(r"[A-Za-z_][A-Za-z0-9_]*", with_unit)]
    #[regex(r"[^\x00-\x7F]", with_unit, priority = 1)]
    Word,
    /// A number, with the unit that directly follows it.
    #[regex(r"[+-]?[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?")]
    Number,
    /// The sign `:`.
    #[token(":")]
    Colon,
    /// The sign `;`.
    #[token(";")]
    Semicolon,
    /// The sign `,`.
    #[token(",")]
    Comma,
    /// The sign `(`.
    #[token("(")]
    Open,
    /// The sign `)`.
    #[token(")")]
    Close,
    /// The sign `[`.
    #[token("[")]
    OpenBracket,
    /// The sign `]`.
    #[token("]")]
    CloseBracket,
    /// The sign `=`.
    #[token("=")]
    Equals,
    /// The sign `..`, between the ends of a range.
    #[token("..")]
    To,
}

/// Reads the rest of a word: its letters outside of ASCII, and the second part of a unit such as `cm/s`.
fn with_unit(lexer: &mut Lexer<'_, Token>) -> Result<(), ()> {
    name(lexer)?;
    let per = lexer.remainder().strip_prefix('/').unwrap_or("");
    let letters = per.len() - per.trim_start_matches(|c: char| c.is_ascii_lowercase()).len();
    lexer.bump(if letters > 0 { 1 + letters } else { 0 });
    Ok(())
}

impl Token {
    /// Returns the name of the token for use in messages.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Doc => "a doc comment",
            Self::Word => "a name",
            Self::Number => "a number",
            Self::Colon => "`:`",
            Self::Semicolon => "`;`",
            Self::Comma => "`,`",
            Self::Open => "`(`",
            Self::Close => "`)`",
            Self::OpenBracket => "`[`",
            Self::CloseBracket => "`]`",
            Self::Equals => "`=`",
            Self::To => "`..`",
        }
    }
}
