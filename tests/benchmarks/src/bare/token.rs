//! The tokens of the language (docs/src/reference/language.md, 2), as mdlec has them.

use logos::Logos;

/// Kind of a token, with the text that a parser would process.
#[derive(Logos, Debug, Clone, Copy, PartialEq)]
#[logos(skip(r"[\s;$\u{feff}]+"))]
#[logos(skip(r"\\\\"))]
#[logos(skip(r"//[^\n]*", allow_greedy = true))]
#[logos(skip(r"/\*[^*]*\*+([^/*][^*]*\*+)*/"))]
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
    #[token("sigma_null")]
    #[token("σ_null")]
    #[regex(r"\\sigma_(null|\{\s*null\s*\}|\{\s*\\text\{\s*null\s*\}\s*\})")]
    SigmaNull,
    #[regex(r"[\p{L}_][\p{L}\p{M}\p{Nd}_]*")]
    Name(&'s str),
    #[regex(r"(Γ|\\?Gamma)_([\p{L}\p{M}\p{Nd}_]+|\{\s*(\\text\{)?[\s\p{L}\p{M}\p{Nd}_]+\}?\s*\})(\^([\p{L}\p{M}\p{Nd}_]+|\{\s*(\\text\{)?[\s\p{L}\p{M}\p{Nd}_]+\}?\s*\}))?", priority = 40)]
    Label(&'s str),
    #[regex(
        r"[+-]?[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?(m|cm|mm|in|ft|m/s|cm/s|mm/s|in/s|rad|deg|rad/s|deg/s|s|ms|min|h|V|Hz)?"
    )]
    Number(&'s str),
    #[token("inf")]
    #[token("infinity")]
    #[token("∞")]
    #[token(r"\infty")]
    Infinity,
    #[regex("\"[^\"\n]*\"")]
    Str(&'s str),
    #[token("{")]
    #[token(r"\{")]
    LBrace,
    #[token("}")]
    #[token(r"\}")]
    RBrace,
    #[token("(")]
    LParen,
    /// A parenthesis that touches the name before it.
    TouchParen,
    /// The parenthesis of a plan's parameters.
    ParamParen,
    /// The parenthesis of a plan's condition.
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
}
