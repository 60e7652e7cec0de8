//! Tokens of an alphabet file; unlike in a plan, `;` ends a declaration here.

use logos::Logos;

/// A token.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Logos)]
#[logos(skip r"[ \t\r\n\u{FEFF}]+")]
#[logos(skip(r"//([^/\n][^\n]*)?", allow_greedy = true))]
pub(super) enum Token {
    /// `/// …`.
    #[regex(r"///[^\n]*", allow_greedy = true)]
    Doc,
    /// A name, a keyword or a unit such as `cm/s`.
    #[regex(r"[\p{L}_][\p{L}\p{Nd}_]*(/[a-z]+)?")]
    Word,
    /// A number; a unit may touch it.
    #[regex(r"[+-]?[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?")]
    Number,
    /// `:`.
    #[token(":")]
    Colon,
    /// `;`.
    #[token(";")]
    Semicolon,
    /// `,`.
    #[token(",")]
    Comma,
    /// `(`.
    #[token("(")]
    Open,
    /// `)`.
    #[token(")")]
    Close,
    /// `[`.
    #[token("[")]
    OpenBracket,
    /// `]`.
    #[token("]")]
    CloseBracket,
    /// `=`.
    #[token("=")]
    Equals,
    /// `..`.
    #[token("..")]
    To,
}

impl Token {
    /// Name of the token in messages.
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
