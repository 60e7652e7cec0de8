//! Kinds of tokens (docs/src/reference/language.md, 2).

use logos::Logos;

use super::scan::{comment, doc, number, string};
use super::source::TextRange;

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
    #[token("use")]
    Use,
    #[token("Atom")]
    Atom,
    #[token("ExecPlan")]
    ExecPlan,
    #[token("OR")]
    #[token("or")]
    Or,
    #[token("AND")]
    #[token("and")]
    And,
    #[token("NOT")]
    #[token("not")]
    Not,
    #[token("RISING")]
    #[token("rising")]
    Rising,
    #[token("null")]
    Null,
    #[token("module")]
    Module,
    #[token("after")]
    After,
    #[token("FRAME")]
    Frame,
    /// The word `here` after `FRAME`; elsewhere it is a name.
    Here,
    #[token("sigma_null")]
    #[token("σ_null")]
    #[regex(r"\\sigma_(null|\{\s*null\s*\}|\{\s*\\text\{\s*null\s*\}\s*\})")]
    SigmaNull,
    #[regex(r"[\p{L}_][\p{L}\p{M}\p{Nd}_]*")]
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
    #[token("inf")]
    #[token("infinity")]
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
    /// A typesetting command that is not part of MDLe. The parser never receives it.
    #[regex(r"\\[A-Za-z]+", priority = 1)]
    Command,
}
