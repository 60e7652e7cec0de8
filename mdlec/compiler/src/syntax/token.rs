//! Kinds of tokens (docs/src/reference/language.md, 2).

use logos::Logos;

use super::scan::{comment, doc, number, string};
use super::source::TextRange;
use crate::alphabet::name;

/// A token with its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Token<'s> {
    /// Kind of the token.
    pub(super) kind: Tok<'s>,
    /// Place of the token in the text.
    pub(super) place: TextRange,
}

/// Kind of a token.
#[derive(Logos, Debug, Clone, Copy, PartialEq)]
#[logos(skip(r"[\s;$\u{feff}]+"))]
#[logos(skip(r"\\\\"))]
#[logos(skip(r"//[^\n]*", allow_greedy = true))]
pub(super) enum Tok<'s> {
    Use,
    Atom,
    ExecPlan,
    Or,
    And,
    Not,
    Rising,
    Null,
    Module,
    After,
    Frame,
    /// The word `here` after `FRAME`; elsewhere it is a name.
    Here,
    #[regex(r"\\sigma_(null|\{\s*null\s*\}|\{\s*\\text\{\s*null\s*\}\s*\})")]
    SigmaNull,
    #[regex(r"[A-Za-z_][A-Za-z0-9_]*", name)]
    #[regex(r"[^\x00-\x7F]", name, priority = 1)]
    Name(&'s str),
    /// `Group` between a plan's brace and a square bracket; anywhere else, it is a name.
    Group,
    /// The dot between a robot and its signal. The parser never receives it.
    #[token(".")]
    Dot,
    /// A name or a command that continues as a label; see [`super::label::label_length`].
    Label(&'s str),
    #[regex(r"[+-]?[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?", number)]
    Number(&'s str),
    #[token("∞")]
    #[token(r"\infty")]
    Infinity,
    #[token("\"", string)]
    Str(&'s str),
    #[token("{")]
    #[token(r"\{")]
    LBrace,
    #[token("}")]
    #[token(r"\}")]
    RBrace,
    #[token("(")]
    LParen,
    /// An opening parenthesis that touches the name before it.
    TouchParen,
    /// The opening parenthesis of a plan's parameters.
    ParamParen,
    /// The opening parenthesis of a plan's condition.
    ConditionParen,
    #[token(")")]
    RParen,
    #[token("[")]
    LBracket,
    #[token("]")]
    RBracket,
    #[token(",")]
    Comma,
    #[token(":")]
    Colon,
    #[token("^")]
    Caret,
    #[token("=")]
    Assign,
    #[token("==")]
    Equal,
    #[token("<")]
    Less,
    #[token("<=")]
    #[token("≤")]
    #[token(r"\leq")]
    LessOrEqual,
    #[token(">")]
    Greater,
    #[token(">=")]
    #[token("≥")]
    #[token(r"\geq")]
    GreaterOrEqual,
    /// A doc comment. The parser never receives it.
    #[regex(r"///[^\n]*", doc, allow_greedy = true, priority = 20)]
    Doc(&'s str),
    /// The start of `\text{…}`. The parser never receives it.
    #[regex(r"\\text\s*\{")]
    Text,
    /// A block comment that is not terminated; terminated comments are skipped.
    #[token("/*", comment)]
    Comment,
    /// The range of a sonar with its number in braces, as in `r_{7}`. The parser receives a name.
    #[regex(r"r_\{\s*[0-9]+\s*\}")]
    TypesetRange,
    /// A typesetting command that is not part of MDLe. The parser never receives it.
    #[regex(r"\\([A-Za-z]+|[,;:!])", priority = 1)]
    Command,
}

impl<'s> Tok<'s> {
    /// Returns the token of a word: a keyword or a name.
    ///
    /// The lexer does not recognize keywords, because `ORé` is a name, and the lexer recognizes ASCII letters only.
    pub(super) fn of_word(word: &'s str) -> Self {
        match word {
            "use" => Self::Use,
            "Atom" => Self::Atom,
            "ExecPlan" => Self::ExecPlan,
            "OR" | "or" => Self::Or,
            "AND" | "and" => Self::And,
            "NOT" | "not" => Self::Not,
            "RISING" | "rising" => Self::Rising,
            "null" => Self::Null,
            "module" => Self::Module,
            "after" => Self::After,
            "FRAME" => Self::Frame,
            "sigma_null" | "σ_null" => Self::SigmaNull,
            "inf" | "infinity" => Self::Infinity,
            name => Self::Name(name),
        }
    }
}

#[cfg(test)]
mod tests {
    use logos::Logos;

    use super::Tok;

    #[test]
    fn a_keyword_that_continues_in_any_script_is_a_name() {
        for keyword in ["use", "or", "OR", "null", "inf", "FRAME", "sigma_null", "σ_null"] {
            for behind in ["é", "中", "٣", "\u{301}", "_", "9"] {
                let text = format!("{keyword}{behind} ≤");
                let name = format!("{keyword}{behind}");
                let tokens: Vec<_> = Tok::lexer(&text).collect();
                assert_eq!(tokens, [Ok(Tok::Name(&name)), Ok(Tok::LessOrEqual)]);
                assert_eq!(Tok::of_word(&name), Tok::Name(&name));
            }
            assert_ne!(Tok::of_word(keyword), Tok::Name(keyword));
        }
    }
}
